//! The solution: one scene's light, with where it came from.

use super::guests::Guest;
use crate::{
    glossy::{GlossyMethod, environment::Environments, particles::light::ParticleLight},
    irradiance_volume::{
        IrradianceVolume,
        dynamic_object::{Detail, DynamicObject, Gloss},
        moments::Order,
    },
    mirror::images::MirrorImages,
    radiosity::RadiositySolution,
    reference::expression::Expression,
    scene::{
        Scene,
        lookup::{Lookup, Reconstruction},
        world::World,
    },
};
use std::{collections::BTreeMap, sync::Arc};

/// One scene's light: immutable, cheap to clone, safe to show while the next one is computed.
#[derive(Clone)]
pub struct LightTransportSolution {
    /// The scene it was solved for.
    pub scene: Arc<Scene>,
    /// Its triangles, trees and emitters.
    pub world: Arc<World>,
    /// Light on surfaces.
    pub radiosity: Arc<RadiositySolution>,
    /// Light in the air, if the plan asks for it.
    pub volume: Option<Arc<IrradianceVolume>>,
    /// Objects away from where they were when the transport was solved: lit from the volume.
    pub moved_objects: Vec<u32>,
    /// What movable objects need to be lit from the volume; one that is missing is lit at its vertices.
    pub dynamic_objects: Arc<BTreeMap<u32, DynamicObject>>,
    /// Things put in after the solve, each lit from a volume of its own.
    pub guests: Arc<Vec<Guest>>,
    /// The light around curved reflectors.
    pub environments: Arc<Environments>,
    /// What flat reflectors mirror, if the plan shows it from images-with-depth; it holds whatever the light, and follows what moves.
    pub mirror_images: Option<Arc<MirrorImages>>,
    /// Light on glossy surfaces as particles, if the plan makes their layer of it.
    pub particles: Option<Arc<ParticleLight>>,
    /// How finely the moved objects ask the volume.
    pub detail: Detail,
    /// How the movable objects shine; `None` where they are diffuse.
    pub gloss: Option<Gloss>,
    /// What it was made with.
    pub provenance: Provenance,
}

impl LightTransportSolution {
    /// How its pictures look up what is stored on surfaces.
    pub fn lookup(&self) -> Lookup {
        self.scene.plan.lookup.unwrap_or_default()
    }

    /// The particles that pictures make the layer `glossy` of, if they do.
    pub fn particle_light(&self) -> Option<&Arc<ParticleLight>> {
        self.particles.as_ref().filter(|_| self.scene.plan.glossy == Some(GlossyMethod::Particles))
    }

    /// How they make it of the mirror image otherwise; before there are particles, without blurring it.
    pub fn glossy_of_image(&self) -> GlossyMethod {
        match self.scene.plan.glossy.unwrap_or_default() {
            GlossyMethod::Particles => GlossyMethod::Sharp,
            method => method,
        }
    }

    /// What becomes of what is stored on surfaces before pictures look it up.
    pub fn reconstruction(&self) -> Reconstruction {
        self.scene.plan.reconstruction.unwrap_or_default()
    }

    /// The same light as pictures show it: reconstructed as the plan has it. To be shown, not to be lit again.
    pub fn reconstructed(&self) -> Self {
        Self { radiosity: self.radiosity.reconstructed(self.reconstruction()), ..self.clone() }
    }

    /// The same light with movable objects that shine, or are diffuse again; an order that the volume does
    /// not hold changes nothing.
    pub fn with_gloss(&self, gloss: Option<Gloss>) -> Self {
        let held = |g: &Gloss| {
            let volume = self.volume.as_deref();
            volume.is_some_and(|v| g.order == Order::IRRADIANCE || v.orders().contains(&g.order))
        };
        Self { gloss: gloss.filter(held), ..self.clone() }
    }

    /// Whether pictures ask the volume at their pixels, which a graphics device does not have: then the processor
    /// makes them.
    pub fn is_asked_at_pixels(&self) -> bool {
        let asks = self.gloss.is_some() || !self.moved_objects.is_empty() || !self.guests.is_empty();
        asks && self.detail == Detail::Pixels
    }

    /// The same light with moved objects that ask the volume as finely as said; as finely as they do without.
    pub fn with_detail(&self, detail: Option<Detail>) -> Self {
        Self { detail: detail.unwrap_or(self.detail), ..self.clone() }
    }

    /// The same light with only the indirect part that an expression means, and whether each term is shown then:
    /// emitted, direct, indirect, specular. `None` where only the path tracer tells the expression's light apart:
    /// where something is specular and it is no sum of terms.
    ///
    /// Of single bounces objects that were moved show none: their light is the volume's, which does not know them.
    pub fn with_paths(&self, expression: &Expression) -> Option<(Self, [bool; 4])> {
        if let Some(terms) = expression.of_terms() {
            return Some((self.clone(), terms));
        }
        let bounces = expression.bounces();
        let radiosity = Arc::new(self.radiosity.of_bounces(&bounces)?);
        Some((Self { radiosity, volume: None, ..self.clone() }, bounces.terms()))
    }
}

/// What a solution was made with, and how far it is.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Provenance {
    /// Seed of every random number.
    pub seed: u64,
    /// Counts up with every change that reached the solution.
    pub revision: u64,
    /// Whether nothing better is on its way.
    pub state: State,
    /// Seconds spent in each stage, in order.
    pub stage_seconds: Vec<(String, f64)>,
}

/// How far a solution is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub enum State {
    /// The scene has changed since.
    Stale,
    /// Correct but coarse; a finer one is on its way.
    Refining,
    /// As good as the plan asks.
    #[default]
    Settled,
}
