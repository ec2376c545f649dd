//! Specular reflection: materials, mirrors, what they throw.

mod brdf;
mod culling;
mod images;
mod planar;
mod thrown;
mod views;
