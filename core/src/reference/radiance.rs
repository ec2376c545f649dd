//! Radiance along a ray, with its standard error.

use super::{
    Estimate,
    irradiance::{irradiance_with, sets_of},
    path::PathTracer,
    stream_seed,
};
use crate::{
    math::{part::Part, random::Rng},
    scene::{accel::Ray, direct::Receiver, world::World},
};
use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Radiance that arrives at a ray's origin from along it, cd/m² per channel: L = Lₑ + ρ E / π.
///
/// The surface met is the same for every sample, so only the irradiance there is estimated, or what it
/// reflects where it has a specular lobe.
pub fn radiance(world: &World, ray: &Ray, samples: u32, seed: u64) -> Estimate {
    radiance_with(&PathTracer::new(world), ray, samples, seed)
}

/// [`radiance`] with a tracer that many rays share.
pub fn radiance_with(tracer: &PathTracer<'_>, ray: &Ray, samples: u32, seed: u64) -> Estimate {
    let exact = |mean: Vec3| Estimate { mean, standard_error: Vec3::ZERO, degrees_of_freedom: 0 };
    let Some(surface) = tracer.surface(ray) else { return exact(Vec3::ZERO) };
    let geometry = &tracer.world().geometry;
    if geometry.brdf(&surface).specular.is_some() {
        let (sets, per_set) = sets_of(samples);
        let values: Vec<DVec3> = (0..sets)
            .map(|set| {
                let mut rng = Rng::new(stream_seed(seed, u64::from(set)), u64::from(set));
                let sum = (0..per_set).fold(DVec3::ZERO, |sum, _| {
                    let (selection, terms) = (tracer.first_selection(), tracer.terms());
                    let found = tracer.reflected(&surface, -ray.direction, selection, terms, &mut rng);
                    let value = found.total().as_dvec3();
                    if value.is_finite() { sum + value } else { sum }
                });
                geometry.emission(&surface).as_dvec3() + sum / f64::from(per_set)
            })
            .collect();
        return Estimate::from_values(&values);
    }
    let emitted = geometry.emission(&surface);
    let scale = geometry.reflectance(&surface).min(Vec3::ONE) * FRAC_1_PI;
    if scale == Vec3::ZERO {
        return exact(emitted);
    }
    let arriving = irradiance_with(tracer, &Receiver::of(&surface), Part::All, samples, seed);
    Estimate {
        mean: emitted + scale * arriving.mean,
        standard_error: scale * arriving.standard_error,
        degrees_of_freedom: arriving.degrees_of_freedom,
    }
}
