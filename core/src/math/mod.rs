//! The mathematics every room shares: frames, sphere mappings, spherical harmonics, random numbers, colour, images.

pub mod colour;
pub mod false_colour;
pub mod fourier;
pub mod frame;
pub mod image;
pub mod moment;
pub mod part;
pub mod progress;
pub mod random;
pub mod relative;
pub mod sphere_map;
pub mod sphere_values;
pub mod spherical_harmonics;
