//! The mathematics every room shares: frames, sphere mappings, random numbers, colour, images.

pub mod colour;
pub mod false_colour;
pub mod frame;
pub mod image;
pub mod part;
pub mod progress;
pub mod random;
pub mod sphere_map;
