//! Radiance along a ray, with its standard error.

use super::{
    Estimate,
    irradiance::irradiance_with,
    path::{PathTracer, receiver_of},
};
use crate::{
    math::part::Part,
    scene::{accel::Ray, world::World},
};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Radiance that arrives at a ray's origin from along it, cd/m² per channel: L = Lₑ + ρ E / π.
///
/// The surface met is the same for every sample, so only the irradiance there is estimated.
pub fn radiance(world: &World, ray: &Ray, samples: u32, seed: u64) -> Estimate {
    radiance_with(&PathTracer::new(world), ray, samples, seed)
}

/// [`radiance`] with a tracer that many rays share.
pub fn radiance_with(tracer: &PathTracer<'_>, ray: &Ray, samples: u32, seed: u64) -> Estimate {
    let exact = |mean: Vec3| Estimate { mean, standard_error: Vec3::ZERO, degrees_of_freedom: 0 };
    let Some(surface) = tracer.surface(ray) else { return exact(Vec3::ZERO) };
    let geometry = &tracer.world().geometry;
    let emitted = geometry.emission(&surface);
    let scale = geometry.reflectance(&surface).min(Vec3::ONE) * FRAC_1_PI;
    if scale == Vec3::ZERO {
        return exact(emitted);
    }
    let arriving = irradiance_with(tracer, &receiver_of(&surface), Part::All, samples, seed);
    Estimate {
        mean: emitted + scale * arriving.mean,
        standard_error: scale * arriving.standard_error,
        degrees_of_freedom: arriving.degrees_of_freedom,
    }
}
