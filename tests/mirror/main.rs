//! Specular reflection: materials, mirrors, what they throw.

mod brdf;
mod culling;
mod glass;
mod image_holes;
mod image_moves;
mod image_pictures;
mod image_splats;
mod images;
mod planar;
mod thrown;
mod views;
