//! Irradiance at a receiver, with its standard error.
//!
//! Sixty-four independent sets of samples: within a set the first direction and the points on
//! emitters follow the R₂ sequence under a random shift, which fills the hemisphere evenly; between
//! sets the shifts are independent, so the spread of the set means is an honest standard error.

use super::{
    Estimate,
    path::{FirstVertex, PathTracer},
    stream_seed,
};
use crate::{
    math::{
        part::Part,
        random::{Rng, hash2, r2_point},
    },
    scene::{direct::Receiver, world::World},
};
use glam::DVec3;

/// Independent sets of samples behind an estimate; fewer when fewer samples are asked for.
pub const SETS: u32 = 64;

/// Irradiance at a receiver, lx per channel, from at least `samples` paths.
///
/// E = ∫ L(ω) cos θ dω (Greger 1996, Eq. 3.1), or the part of it asked for. The samples are rounded up to
/// whole sets. Equal arguments give equal results.
pub fn irradiance(world: &World, receiver: &Receiver, part: Part, samples: u32, seed: u64) -> Estimate {
    irradiance_with(&PathTracer::new(world), receiver, part, samples, seed)
}

/// [`irradiance`] with a tracer that many receivers share.
pub fn irradiance_with(
    tracer: &PathTracer<'_>,
    receiver: &Receiver,
    part: Part,
    samples: u32,
    seed: u64,
) -> Estimate {
    let (sets, per_set) = sets_of(samples);
    let values: Vec<DVec3> = (0..sets)
        .map(|set| {
            let stream = stream_seed(seed, u64::from(set));
            let scramble = (stream >> 32) as u32;
            let mut rng = Rng::new(stream, u64::from(set));
            let sum = (0..per_set).fold(DVec3::ZERO, |sum, j| {
                let first = FirstVertex {
                    direction: r2_point(j, scramble),
                    light: |n: usize| r2_point(j, hash2(scramble, n as u32 + 1)),
                };
                let incident = tracer.incident(receiver, part, first, &mut rng);
                let value = (incident.direct + incident.indirect).as_dvec3();
                if value.is_finite() { sum + value } else { sum }
            });
            sum / f64::from(per_set)
        })
        .collect();
    Estimate::from_values(&values)
}

/// Number of sets and samples in each for at least `samples` samples.
pub(super) fn sets_of(samples: u32) -> (u32, u32) {
    let sets = samples.clamp(1, SETS);
    (sets, samples.max(1).div_ceil(sets))
}
