//! The irradiance volume: light at points in the air, for every direction.

use crate::math::part::Part;
use glam::Vec3;

/// Irradiance at points in the air for every direction, on a bilevel grid.
#[derive(Clone, Debug, Default)]
pub struct IrradianceVolume {}

impl IrradianceVolume {
    /// Irradiance at a point on a surface facing `normal`, lx per channel.
    pub fn irradiance(&self, _position: Vec3, _normal: Vec3, _part: Part) -> Vec3 {
        Vec3::ZERO
    }
}
