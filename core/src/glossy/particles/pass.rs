//! The glossy layer of one frame by particles: the specification of [`super::gpu`].

use super::{splat::SplatMap, straight::straight_light};
use crate::{
    math::image::LinearImage,
    scene::{camera::Camera, geometry::Surface, world::World},
    superposition::{composite::DirectQuality, gbuffer::GBuffer, pass::PassSettings},
};
use glam::Vec3;
use rayon::prelude::*;

/// Samples of straight light a pixel and emitter where the picture's own direct light needs none.
pub const LEAST_SAMPLES: u32 = 4;

/// Samples of straight light a pixel, emitter and lobe.
pub fn straight_samples(direct: DirectQuality) -> u32 {
    match direct {
        DirectQuality::Elements | DirectQuality::PerPixel(0) => LEAST_SAMPLES,
        DirectQuality::PerPixel(samples) => samples,
    }
}

/// Radiance that a glossy surface sends along `wo` to an eye, cd/m²: from the particles, with straight light
/// evaluated apart by so many samples; then the particles should leave it out. `None` where it is not glossy.
pub fn reflected(
    world: &World,
    map: &SplatMap,
    straight: Option<u32>,
    surface: &Surface,
    eye: Vec3,
    scramble: u32,
) -> Option<Vec3> {
    world.geometry.brdf(surface).specular.filter(|s| !s.is_mirror())?;
    let wo = (eye - surface.position).normalize_or(surface.normal);
    let [_, by_particles] = map.radiance(world, surface, eye);
    let apart = straight.map(|samples| straight_light(world, surface, wo, samples, scramble));
    Some(by_particles + apart.unwrap_or(Vec3::ZERO))
}

/// Radiance that glossy surfaces send to the eye, cd/m², as [`reflected`] says.
pub fn glossy_layer(
    world: &World,
    map: &SplatMap,
    straight: Option<u32>,
    buffer: &GBuffer,
    camera: &Camera,
    settings: &PassSettings,
) -> LinearImage {
    let pixels = (0..buffer.triangle.len())
        .into_par_iter()
        .map(|pixel| {
            let surface = buffer.surface(world, camera, pixel)?;
            reflected(world, map, straight, &surface, camera.eye, settings.scramble(pixel as u32))
        })
        .map(Option::unwrap_or_default)
        .collect();
    LinearImage { width: buffer.width, height: buffer.height, pixels }
}
