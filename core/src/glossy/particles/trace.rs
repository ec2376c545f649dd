//! Particles on their ways: the part that does not depend on the eye.

use super::emission::{Emission, placement, sphere_around};
use crate::{
    math::{
        colour::luminance,
        progress::{Cancelled, Progress},
        random::Rng,
    },
    reference::stream_seed,
    scene::{
        accel::Ray,
        emitters::Emitter,
        geometry::{Surface, offset_origin},
        world::World,
    },
};
use glam::{Affine3A, DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// A particle ends here at the latest; at reflectance 0.999 what is cut off is 4.5e-5 of the light.
const MOST_BOUNCES: u32 = 10_000;

/// Particles traced between two looks at whether to go on.
const BATCH: u32 = 1 << 14;

/// Where a particle met a surface that reflects, other than an ideal mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleHit {
    /// Triangle.
    pub triangle: u32,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec2,
    /// Unit direction to where it came from.
    pub wi: Vec3,
    /// What is left of it per channel, ρ of Eq. 7.4.
    pub attenuation: Vec3,
    /// Surfaces that it was reflected by before.
    pub bounces: u32,
}

/// The particles of one emitter.
#[derive(Clone, Debug, PartialEq)]
pub struct Sent {
    /// Flux Φ that they share, lm per channel.
    pub flux: Vec3,
    /// How many there are so far, m.
    pub count: u32,
    /// Their hits, particle by particle; shared by what is lit alike.
    pub hits: Arc<Vec<ParticleHit>>,
    /// Where the emitter stood.
    from: Affine3A,
}

impl Sent {
    fn nothing(world: &World, emitter: &Emitter, bounds: (Vec3, f32)) -> Self {
        let flux = Emission::new(bounds, emitter).flux;
        Self { flux, count: 0, hits: Arc::default(), from: placement(world, emitter) }
    }

    /// Flux of a hit: φ = Φ ρ / m, lm per channel (Eq. 7.4).
    pub fn power(&self, hit: &ParticleHit) -> Vec3 {
        self.flux * hit.attenuation / self.count.max(1) as f32
    }
}

/// Light as particles; more can be added at any time.
#[derive(Clone, Debug, PartialEq)]
pub struct Particles {
    /// By emitter of the world.
    pub sent: Vec<Sent>,
    seed: u64,
    /// Sphere that parallel light is sent through: middle and radius, m.
    bounds: (Vec3, f32),
}

impl Particles {
    /// No particles yet.
    pub fn new(world: &World, seed: u64) -> Self {
        let bounds = sphere_around(&world.geometry);
        let sent = |emitter| Sent::nothing(world, emitter, bounds);
        Self { sent: world.emitters.list.iter().map(sent).collect(), seed, bounds }
    }

    /// Takes over how bright and where the emitters are now: a particle keeps what is left of it, so one that is
    /// dimmed costs nothing, and of one that was moved the particles are sent anew by the next
    /// [`trace`](Self::trace). Where anything else was moved they stay as they are.
    pub fn follow(&mut self, world: &World) {
        for (sent, emitter) in self.sent.iter_mut().zip(&world.emitters.list) {
            let now = Sent::nothing(world, emitter, self.bounds);
            if now.from == sent.from {
                sent.flux = now.flux;
            } else {
                *sent = now;
            }
        }
    }

    /// Particles of all emitters.
    pub fn count(&self) -> u32 {
        self.sent.iter().map(|s| s.count).sum()
    }

    /// Hits of all emitters' particles, each with its flux, lm per channel.
    pub fn hits(&self) -> impl Iterator<Item = (&ParticleHit, Vec3)> {
        self.sent.iter().flat_map(|s| s.hits.iter().map(move |hit| (hit, s.power(hit))))
    }

    /// Flux that arrives at what reflects after some bounces, lm per channel.
    pub fn arriving(&self, bounces: u32) -> DVec3 {
        self.hits().filter(|(hit, _)| hit.bounces == bounces).map(|(_, power)| power.as_dvec3()).sum()
    }

    /// Goes on until there are about `total` particles, shared among the emitters by their luminous flux (at least
    /// one for each that shines). However many steps it takes there, they are the same particles.
    ///
    /// # Errors
    /// [`Cancelled`]; the particles so far stay.
    pub fn trace(&mut self, world: &World, total: u32, progress: &Progress) -> Result<(), Cancelled> {
        progress.begin("particles");
        let all: f64 = self.sent.iter().map(|s| f64::from(luminance(s.flux))).sum();
        let wanted =
            |s: &Sent| (f64::from(total) * f64::from(luminance(s.flux)) / all.max(1e-300)).ceil() as u32;
        let in_all: u64 = self.sent.iter().map(|s| u64::from(wanted(s))).sum();
        let mut before = 0;
        for (number, (sent, emitter)) in self.sent.iter_mut().zip(&world.emitters.list).enumerate() {
            let emission = Emission::new(self.bounds, emitter);
            let wanted = wanted(sent);
            while sent.count < wanted {
                progress.report((before + u64::from(sent.count)) as f32 / in_all as f32)?;
                let batch = sent.count..wanted.min(sent.count.saturating_add(BATCH));
                let item = |k: u32| (number as u64) << 32 | u64::from(k);
                let hits: Vec<ParticleHit> = batch
                    .clone()
                    .into_par_iter()
                    .flat_map_iter(|k| {
                        way(
                            world,
                            emitter,
                            &emission,
                            &mut Rng::new(stream_seed(self.seed, item(k)), item(k)),
                        )
                    })
                    .collect();
                Arc::make_mut(&mut sent.hits).extend(hits);
                sent.count = batch.end;
            }
            before += u64::from(wanted);
        }
        progress.report(1.0)
    }
}

/// The hits of one particle, as long as it carries anything. It goes on with the probability that the scattered
/// direction's weight has.
fn way(world: &World, emitter: &Emitter, emission: &Emission, rng: &mut Rng) -> Vec<ParticleHit> {
    let geometry = &world.geometry;
    let (mut ray, mut attenuation) = emission.send(geometry, emitter, rng);
    let mut hits = Vec::new();
    for bounces in 0..MOST_BOUNCES {
        if emission.flux * attenuation == Vec3::ZERO {
            break;
        }
        let Some(hit) = world.accel.trace(&ray) else { break };
        let surface = geometry.surface(hit.triangle, hit.barycentric, ray.direction);
        let (brdf, wi) = (geometry.brdf(&surface), -ray.direction);
        if brdf.is_black() {
            break;
        }
        if !brdf.specular.is_some_and(|s| s.is_mirror()) {
            let (triangle, barycentric) = (hit.triangle, hit.barycentric);
            hits.push(ParticleHit { triangle, barycentric, wi, attenuation, bounces });
        }
        let (part, u) = (rng.next_f32(), rng.next_vec2());
        let Some(drawn) = brdf.sample(surface.normal, wi, part, u) else { break };
        if surface.geometric_normal.dot(drawn.wi) <= 0.0 {
            break;
        }
        let weight = (drawn.diffuse + drawn.specular) * (tilt(&surface, wi) / tilt(&surface, drawn.wi));
        let survival = weight.max_element().min(1.0);
        if !survival.is_finite() || rng.next_f32() >= survival {
            break;
        }
        attenuation *= weight / survival;
        ray = Ray::new(offset_origin(surface.position, surface.geometric_normal), drawn.wi);
    }
    hits
}

/// How much more a surface takes of light from `wi` about its shading normal than about its plane's: a lobe's
/// cosine refers to the one, the number of particles to the other (Veach 1997, §5.3.2). 1 on flat surfaces.
pub fn tilt(surface: &Surface, wi: Vec3) -> f32 {
    let plane = surface.geometric_normal.dot(wi);
    if plane > 0.0 { surface.normal.dot(wi).max(0.0) / plane } else { 0.0 }
}
