//! A second estimator of irradiance that shares no sampling code with the path tracer.
//!
//! Directions are uniform over the hemisphere, emission counts only where a ray happens to hit it,
//! and Russian roulette follows the reflectance alone. It never meets the one direction of an ideal mirror.
//! Slow on purpose: it exists for a z-test
//! against [`super::irradiance`]. Lamps without a surface cannot be hit, so their light is missing.

use super::{Estimate, irradiance::sets_of, stream_seed};
use crate::{
    math::{frame::uniform_direction, part::Part, random::Rng},
    scene::{accel::Ray, direct::Receiver, geometry::Surface, world::World},
};
use glam::{DVec3, Vec3};
use std::f32::consts::TAU;

/// Irradiance at a receiver from emissive surfaces, lx per channel, from at least `samples` paths.
///
/// E ≈ 2π cos θ L(ω) with ω uniform over the hemisphere, density 1/2π.
pub fn irradiance_brute(world: &World, receiver: &Receiver, part: Part, samples: u32, seed: u64) -> Estimate {
    let (sets, per_set) = sets_of(samples);
    let values: Vec<DVec3> = (0..sets)
        .map(|set| {
            let mut rng = Rng::new(stream_seed(seed, u64::from(set)), u64::from(set));
            let sum = (0..per_set).fold(DVec3::ZERO, |sum, _| sum + path(world, *receiver, part, &mut rng));
            sum / f64::from(per_set)
        })
        .collect();
    Estimate::from_values(&values)
}

fn path(world: &World, mut vertex: Receiver, part: Part, rng: &mut Rng) -> DVec3 {
    let (mut sum, mut throughput) = (DVec3::ZERO, Vec3::ONE);
    let mut from: Option<(Surface, Vec3)> = None;
    for bounce in 0..super::path::MAX_BOUNCES {
        let mut wi = uniform_direction(rng.next_vec2());
        if wi.dot(vertex.normal) < 0.0 {
            wi = -wi;
        }
        if wi.dot(vertex.geometric_normal) <= 0.0 {
            break;
        }
        throughput *= TAU * wi.dot(vertex.normal);
        if let Some((surface, wo)) = &from {
            let [diffuse, lobe] = world.geometry.brdf(surface).value(surface.normal, wi, *wo);
            throughput *= diffuse + lobe;
        }
        let Some(hit) = world.accel.trace(&Ray::new(vertex.origin(), wi)) else { break };
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, wi);
        let counts = match part {
            Part::All => true,
            Part::Direct => bounce == 0,
            Part::Indirect => bounce > 0,
        };
        if counts {
            sum += (throughput * world.geometry.emission(&surface)).as_dvec3();
        }
        let brdf = world.geometry.brdf(&surface);
        let lobe = brdf.specular.map_or(Vec3::ZERO, |s| s.reflectance(-wi.dot(surface.normal)));
        let survival = (brdf.diffuse + lobe).max_element().min(1.0);
        if part == Part::Direct || rng.next_f32() >= survival {
            break;
        }
        throughput /= survival;
        vertex = Receiver::of(&surface);
        from = Some((surface, -wi));
    }
    sum
}
