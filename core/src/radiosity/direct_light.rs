//! Direct irradiance of the elements, one table an emitter, so that one lamp can change alone.
//!
//! Tables hold the light at dimmer 1; dimming is a factor. The light is averaged over points of the
//! element's footprint, because it is its flux that is passed on: at one point, an element in front
//! of a lamp gets far too much or too little. All shadow rays are always cast: stopping early where
//! the first ones agree takes the faint edge off every penumbra, several per cent of the flux.

use super::gather::Transport;
use super::{
    RadiosityError,
    surface_map::{FOOTPRINT, UNSOLVED},
};
use crate::{
    math::{
        progress::{Cancelled, Progress},
        random::hash2,
    },
    scene::{direct, emitters::Emitter, world::World},
};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Direct light of one emitter on every element.
#[derive(Clone, Debug)]
pub(super) struct EmitterLight {
    placement: Affine3A,
    dimmer: f32,
    /// Irradiance at dimmer 1, lx; `None` when it was never needed.
    at_full: Option<Arc<Vec<Vec3>>>,
}

impl EmitterLight {
    /// Light of an emitter.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`].
    pub fn new(
        world: &World,
        transport: &Transport,
        emitter: &Emitter,
        shadow_rays: u32,
        seed: u64,
        progress: &Progress,
    ) -> Result<Self, RadiosityError> {
        let (placement, dimmer) = state(world, emitter);
        let at_full = if dimmer > 0.0 {
            Some(Arc::new(irradiance(
                world,
                transport,
                &at_full(world, emitter),
                shadow_rays,
                seed,
                progress,
            )?))
        } else {
            None
        };
        let at_full = match (at_full, emitter) {
            // A texture is read with the dimmer applied.
            (Some(table), Emitter::Area(area)) if area.textured => {
                Some(Arc::new(table.iter().map(|e| *e / dimmer).collect()))
            }
            (table, _) => table,
        };
        Ok(Self { placement, dimmer, at_full })
    }

    /// An emitter whose light has not been computed.
    pub fn unlit(world: &World, emitter: &Emitter) -> Self {
        let (placement, _) = state(world, emitter);
        Self { placement, dimmer: 0.0, at_full: None }
    }

    /// The light after the emitter may have changed: a factor if it was only dimmed, new rays if it
    /// moved or `again` asks for them.
    pub fn follow(
        &self,
        world: &World,
        transport: &Transport,
        emitter: &Emitter,
        again: bool,
        shadow_rays: u32,
        seed: u64,
    ) -> Self {
        let (placement, dimmer) = state(world, emitter);
        if !(again && dimmer > 0.0)
            && placement == self.placement
            && (self.at_full.is_some() || dimmer == 0.0)
        {
            return Self { dimmer, ..self.clone() };
        }
        // Nobody cancels silent progress.
        Self::new(world, transport, emitter, shadow_rays, seed, &Progress::silent())
            .unwrap_or_else(|_| self.clone())
    }

    /// Adds this light to `sum`, lx.
    pub fn add_to(&self, sum: &mut [Vec3]) {
        if let Some(table) = &self.at_full {
            for (sum, e) in sum.iter_mut().zip(table.iter()) {
                *sum += *e * self.dimmer;
            }
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.at_full.as_ref().map_or(0, |t| size_of_val(&t[..]))
    }
}

/// Placement and dimmer of an emitter.
fn state(world: &World, emitter: &Emitter) -> (Affine3A, f32) {
    match emitter {
        Emitter::Lamp { lamp, .. } => (lamp.world_from_lamp, lamp.dimmer),
        Emitter::Area(area) => {
            let object = area.object as usize;
            (world.geometry.world_from_object[object], world.geometry.dimmer[object])
        }
    }
}

/// The emitter with its dimmer at 1.
fn at_full(world: &World, emitter: &Emitter) -> Emitter {
    let mut emitter = emitter.clone();
    match &mut emitter {
        Emitter::Lamp { lamp, .. } => lamp.dimmer = 1.0,
        Emitter::Area(area) if !area.textured => {
            area.radiance =
                area.triangles.first().map_or(Vec3::ZERO, |&t| world.geometry.material_of(t).emission);
        }
        Emitter::Area(_) => {}
    }
    emitter
}

fn irradiance(
    world: &World,
    transport: &Transport,
    emitter: &Emitter,
    shadow_rays: u32,
    seed: u64,
    progress: &Progress,
) -> Result<Vec<Vec3>, Cancelled> {
    const BLOCK: usize = 4096;
    let seed = seed as u32 ^ (seed >> 32) as u32;
    let elements = &transport.map.elements;
    let mut table = Vec::with_capacity(elements.len());
    for (block, chunk) in elements.chunks(BLOCK).enumerate() {
        progress.report((block * BLOCK) as f32 / elements.len() as f32)?;
        table.par_extend(chunk.par_iter().enumerate().with_min_len(64).map(|(i, element)| {
            if element.flags & UNSOLVED != 0 {
                return Vec3::ZERO;
            }
            let footprint = transport.map.footprint(block * BLOCK + i);
            // Fewer rays than points, as while something moves: only as many points, evenly chosen.
            let points = FOOTPRINT.min(shadow_rays.max(1) as usize);
            let rays = shadow_rays.div_ceil(points as u32);
            let receivers = (0..points).map(|point| {
                let k = point * FOOTPRINT / points;
                (&footprint[k], hash2(((block * BLOCK + i) * FOOTPRINT + k) as u32, seed))
            });
            direct::mean_irradiance(world, emitter, receivers, rays)
        }));
    }
    Ok(table)
}
