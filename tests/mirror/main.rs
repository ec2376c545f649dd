//! Specular reflection: materials, mirrors, glossy surfaces.

mod brdf;
mod culling;
mod environment;
mod glossy;
mod images;
mod particles;
mod planar;
mod thrown;
mod views;
