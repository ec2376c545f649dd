//! Particles as a part of a solution: followed, not sent anew, when lamps change.

use super::{
    splat::{SplatMap, SplatSettings},
    trace::Particles,
};
use crate::{
    glossy::GlossyMethod,
    math::progress::{Cancelled, Progress},
    scene::{file::PlanOverrides, geometry::Geometry, world::World},
};

/// Particles of all emitters, if the plan does not say.
pub const PARTICLES: u32 = 400_000;

/// The same, at most: some three hits each of 48 bytes.
pub const MOST_PARTICLES: u32 = 20_000_000;

/// Particles of an emitter that is being moved, as a share.
const WHILE_MOVING: u32 = 8;

/// How many particles a plan asks for; `None` where glossy surfaces are not made of particles, or there are none.
pub fn wanted(plan: &PlanOverrides, geometry: &Geometry) -> Option<u32> {
    let by_particles = plan.glossy == Some(GlossyMethod::Particles);
    let used = || geometry.material.iter().any(|&m| geometry.materials[m as usize].is_glossy());
    (by_particles && used()).then(|| plan.glossy_particles.unwrap_or(PARTICLES).clamp(1, MOST_PARTICLES))
}

/// A scene's light as particles, without what comes straight from the emitters: [`super::straight`] adds that.
#[derive(Clone, Debug)]
pub struct ParticleLight {
    /// All particles.
    pub particles: Particles,
    /// Those on glossy surfaces.
    pub map: SplatMap,
}

impl ParticleLight {
    /// Sends about `count` particles.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(world: &World, count: u32, seed: u64, progress: &Progress) -> Result<Self, Cancelled> {
        Self::refined(Particles::new(world, seed), world, count, progress)
    }

    /// The light of emitters that were dimmed or moved; those that were moved send an eighth of `count` for now.
    pub fn followed(&self, world: &World, count: u32) -> Self {
        let count = (count / WHILE_MOVING).max(1);
        let mut particles = self.particles.clone();
        particles.follow(world);
        match Self::refined(particles, world, count, &Progress::silent()) {
            Ok(followed) => followed,
            // Nobody can stop it.
            Err(Cancelled) => self.clone(),
        }
    }

    /// Sends more until there are about `count`; the same light as if there had been so many from the first, as long
    /// as no emitter was dimmed: one that was keeps the number it had a right to.
    ///
    /// # Errors
    /// [`Cancelled`]; this light stays.
    pub fn settled(&self, world: &World, count: u32, progress: &Progress) -> Result<Self, Cancelled> {
        let mut particles = self.particles.clone();
        particles.follow(world);
        Self::refined(particles, world, count, progress)
    }

    fn refined(
        mut particles: Particles,
        world: &World,
        count: u32,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        particles.trace(world, count, progress)?;
        let map = SplatMap::new(world, &particles, &SplatSettings { least_bounces: 1, ..Default::default() });
        Ok(Self { particles, map })
    }
}
