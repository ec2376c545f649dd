//! Specular reflection: materials, mirrors, glossy surfaces.

mod brdf;
mod glossy;
mod planar;
mod thrown;
mod views;
