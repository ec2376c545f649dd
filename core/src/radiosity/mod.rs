//! Radiosity: diffuse interreflection on surfaces, solved once, shown from anywhere.

use crate::math::part::Part;
use glam::{Vec2, Vec3};

/// Irradiance on every surface element of a scene.
#[derive(Clone, Debug, Default)]
pub struct RadiositySolution {
    /// Direct irradiance of each element, lx per channel.
    pub direct: Vec<Vec3>,
    /// Indirect irradiance of each element, lx per channel.
    pub indirect: Vec<Vec3>,
}

impl RadiositySolution {
    /// Irradiance at barycentric weights of a triangle, on its front or back, lx per channel.
    pub fn irradiance(&self, _triangle: u32, _barycentric: Vec2, _back: bool, _part: Part) -> Vec3 {
        Vec3::ZERO
    }
}
