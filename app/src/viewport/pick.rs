//! Picking: what lies under the cursor, in numbers.

use glam::{Vec2, Vec3};
use lumenscope_core::scene::Target;

/// Everything known about the point under a click.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    /// Position, m.
    pub position: Vec3,
    /// Interpolated normal on the side seen.
    pub normal: Vec3,
    /// Triangle number in the scene's geometry.
    pub triangle: u32,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec2,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Whether the back is seen.
    pub back: bool,
    /// The object, or the lamp whose glyph was hit.
    pub target: Target,
    /// Whether the target may be dragged.
    pub movable: bool,
    /// Name of the object or lamp.
    pub object: String,
    /// Name of the material; empty for a lamp's glyph.
    pub material: String,
    /// Reflectance of the side seen, per channel.
    pub reflectance: Vec3,
    /// Radiance towards the eye by layer (emitted, direct, indirect), cd/m² per channel.
    pub radiance: [Vec3; 3],
    /// Direct irradiance, lx per channel.
    pub irradiance_direct: Vec3,
    /// Indirect irradiance, lx per channel.
    pub irradiance_indirect: Vec3,
    /// Luminance towards the eye, all layers with weight 1, cd/m².
    pub luminance: f32,
    /// Volume samples that light this point, heaviest first; empty without a volume.
    pub volume_samples: Vec<PickedSample>,
}

/// One volume sample that lights a picked point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PickedSample {
    /// Number of the sample.
    pub id: u32,
    /// Where it is, m.
    pub position: Vec3,
    /// Its share, in [0, 1].
    pub weight: f32,
    /// Whether it lies in open air; one inside a solid has no say.
    pub valid: bool,
}

impl Pick {
    /// Radiance towards the eye, all layers with weight 1, cd/m² per channel.
    pub fn total_radiance(&self) -> Vec3 {
        self.radiance.iter().sum()
    }
}
