//! The glossy layer of one frame by particles.

use super::splat::SplatMap;
use crate::{
    math::{image::LinearImage, random::Rng},
    reference::{expression::Automaton, path::PathTracer, stream_seed},
    scene::{camera::Camera, geometry::Surface, world::World},
    superposition::{gbuffer::GBuffer, pass::PassSettings},
};
use glam::Vec3;
use rayon::prelude::*;

/// What straight light does at a point, evaluated there: the "optimised rendering" of §7.3.2.1.
///
/// Emitters and the lobe are both sampled, weighted by the balance heuristic: exact but for their noise.
pub struct DirectLobes<'a> {
    tracer: PathTracer<'a>,
    /// What counts light that met one specular surface, and nothing else.
    automaton: Automaton,
    samples: u32,
}

impl<'a> DirectLobes<'a> {
    /// Prepares a world for so many samples a pixel.
    pub fn new(world: &'a World, samples: u32) -> Self {
        Self { tracer: PathTracer::new(world), automaton: Automaton::highlights(), samples: samples.max(1) }
    }

    /// One sample of the straight light that a surface's lobe sends along `wo`, cd/m².
    fn sample(&self, surface: &Surface, wo: Vec3, rng: &mut Rng) -> Vec3 {
        let selection = self.tracer.first_selection();
        self.tracer.reflected(surface, wo, selection, &self.automaton, rng).total()
    }
}

/// Radiance that glossy surfaces send to the eye, cd/m²: from the particles, with straight light evaluated apart where
/// that is given; then the particles should leave it out.
pub fn glossy_layer(
    world: &World,
    map: &SplatMap,
    direct: Option<&DirectLobes>,
    buffer: &GBuffer,
    camera: &Camera,
    settings: &PassSettings,
) -> LinearImage {
    let pixels = (0..buffer.triangle.len())
        .into_par_iter()
        .map(|pixel| {
            let Some(surface) = buffer.surface(world, camera, pixel) else { return Vec3::ZERO };
            if world.geometry.brdf(&surface).specular.is_none_or(|s| s.is_mirror()) {
                return Vec3::ZERO;
            }
            let [_, by_particles] = map.radiance(world, &surface, camera.eye);
            let Some(direct) = direct else { return by_particles };
            let wo = (camera.eye - surface.position).normalize_or(surface.normal);
            let item = u64::from(settings.scramble(pixel as u32));
            let mut rng = Rng::new(stream_seed(settings.seed, item), item);
            let sum: Vec3 = (0..direct.samples).map(|_| direct.sample(&surface, wo, &mut rng)).sum();
            by_particles + sum / direct.samples as f32
        })
        .collect();
    LinearImage { width: buffer.width, height: buffer.height, pixels }
}
