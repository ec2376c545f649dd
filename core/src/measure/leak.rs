//! Light that a volume lets through walls: what it answers in a dark place over what it answers in a lit one.

use crate::{
    irradiance_volume::IrradianceVolume,
    math::{colour::luminance, frame::uniform_direction, part::Part, random::Rng},
};
use glam::Vec3;

/// Random points and directions in each place.
const POINTS: u64 = 2000;

/// Illuminance at random points of a box and in random directions.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct LightIn {
    /// Mean, lx.
    pub mean_lx: f32,
    /// Largest, lx.
    pub most_lx: f32,
}

/// A leak, over the mean illuminance of the lit place.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Leak {
    /// Mean of the dark place.
    pub mean: f32,
    /// Largest value there.
    pub worst: f32,
}

/// Light at 2,000 random points and directions of a box, m.
pub fn light_in(volume: &IrradianceVolume, [low, high]: [Vec3; 2]) -> LightIn {
    let (mut sum, mut most_lx) = (0.0f64, 0.0f32);
    for i in 0..POINTS {
        let mut rng = Rng::new(12, i);
        let at = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let normal = uniform_direction(rng.next_vec2());
        let e = luminance(volume.irradiance(low + (high - low) * at, normal, Part::All));
        sum += f64::from(e);
        most_lx = most_lx.max(e);
    }
    LightIn { mean_lx: (sum / POINTS as f64) as f32, most_lx }
}

/// The light of a box that should be dark over the mean of a lit one; `None` where that is dark too.
pub fn leak(volume: &IrradianceVolume, lit: [Vec3; 2], dark: [Vec3; 2]) -> Option<Leak> {
    let (lit, dark) = (light_in(volume, lit).mean_lx, light_in(volume, dark));
    (lit > 0.0).then(|| Leak { mean: dark.mean_lx / lit, worst: dark.most_lx / lit })
}
