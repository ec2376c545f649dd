//! The layers of one frame on the CPU: the specification of the GPU's shading pass.
//!
//! At each pixel the radiance towards the eye is L = Lₑ + ρ/π · (E_direct + E_indirect): emitted,
//! direct and indirect are the three layers. Direct light is evaluated at every pixel, for crisp
//! shadows, or read from the radiosity elements while things move; indirect light is always read.

use super::{composite::DirectQuality, gbuffer::GBuffer, layers::Layers, moved::MovedLight};
use crate::{
    math::{
        part::Part,
        random::{hash2, r2_point},
    },
    scene::{
        camera::Camera,
        direct::{Receiver, total_irradiance},
        geometry::Surface,
    },
    transport::LightTransportSolution,
};
use glam::{UVec2, Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// How one frame is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassSettings {
    /// How direct light is evaluated.
    pub direct: DirectQuality,
    /// Number of the frame: frames differ in their shadow rays, and their mean converges.
    pub frame: u32,
    /// Whether frames also differ in the place inside the pixels that they look through.
    pub jitter: bool,
    /// Seed of every random number.
    pub seed: u64,
}

impl Default for PassSettings {
    fn default() -> Self {
        Self { direct: DirectQuality::PerPixel(4), frame: 0, jitter: false, seed: 1 }
    }
}

impl PassSettings {
    /// Place inside every pixel that this frame looks through; the centre without jitter.
    pub fn subpixel(&self) -> Vec2 {
        if self.jitter { r2_point(self.frame, self.seed as u32) } else { Vec2::splat(0.5) }
    }

    /// Scramble of this frame's shadow rays at a pixel.
    pub fn scramble(&self, pixel: u32) -> u32 {
        hash2(pixel, hash2(self.frame, self.seed as u32))
    }
}

/// Renders one frame: what each pixel sees, and the three layers in cd/m².
///
/// The same arguments give the same bytes at any thread count.
pub fn render(
    solution: &LightTransportSolution,
    camera: &Camera,
    width: u32,
    height: u32,
    settings: &PassSettings,
) -> (GBuffer, Layers) {
    use rayon::prelude::*;
    let buffer = GBuffer::new(&solution.world, camera, UVec2::new(width, height), settings.subpixel());
    let moved = MovedLight::new(solution, settings.direct == DirectQuality::Elements);
    let shaded: Vec<[Vec3; 3]> = (0..buffer.triangle.len())
        .into_par_iter()
        .map(|pixel| match buffer.surface(&solution.world, camera, pixel) {
            Some(surface) => shade(solution, &moved, &surface, settings, pixel as u32),
            None => [Vec3::ZERO; 3],
        })
        .collect();
    let mut layers = Layers::new(width, height);
    for (i, image) in layers.images.iter_mut().enumerate() {
        image.pixels = shaded.iter().map(|p| p[i]).collect();
    }
    (buffer, layers)
}

/// Radiance of a surface towards the eye, layer by layer, cd/m².
fn shade(
    solution: &LightTransportSolution,
    moved: &MovedLight,
    surface: &Surface,
    settings: &PassSettings,
    pixel: u32,
) -> [Vec3; 3] {
    let geometry = &solution.world.geometry;
    let emitted = geometry.emission(surface);
    let reflectance = geometry.reflectance(surface);
    if reflectance == Vec3::ZERO {
        return [emitted, Vec3::ZERO, Vec3::ZERO];
    }
    let stored = |part: Part| {
        moved.irradiance(solution, surface.triangle, surface.barycentric, surface.back, part).unwrap_or_else(
            || solution.radiosity.irradiance(surface.triangle, surface.barycentric, surface.back, part),
        )
    };
    let object = geometry.object[surface.triangle as usize];
    let direct = match settings.direct {
        DirectQuality::Elements => stored(Part::Direct),
        DirectQuality::PerPixel(_) if moved.stored_direct.contains(&object) => stored(Part::Direct),
        DirectQuality::PerPixel(samples) => {
            let receiver = Receiver {
                position: surface.position,
                normal: surface.normal,
                geometric_normal: surface.geometric_normal,
            };
            total_irradiance(&solution.world, &receiver, samples, settings.scramble(pixel))
        }
    };
    let brdf = reflectance * FRAC_1_PI;
    [emitted, brdf * direct, brdf * stored(Part::Indirect)]
}
