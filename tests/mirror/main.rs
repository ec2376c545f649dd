//! Specular reflection: materials, mirrors, glossy surfaces.

mod brdf;
mod planar;
