//! Irradiance of the elements straight from the emitters and by way of polished surfaces, two tables an emitter,
//! so that one lamp can change alone.
//!
//! Tables hold the light at dimmer 1; dimming is a factor. The light is averaged over points of the
//! element's footprint, because it is its flux that is passed on: at one point, an element in front
//! of a lamp gets far too much or too little. All shadow rays are always cast: stopping early where
//! the first ones agree takes the faint edge off every penumbra, several per cent of the flux.

use super::gather::Transport;
use super::{
    RadiosityError,
    specular::{PLACES, PLACES_MOVING, first_of},
    surface_map::{FOOTPRINT, UNSOLVED},
};
use crate::{
    math::{
        progress::{Cancelled, Progress},
        random::{fold, hash2},
    },
    mirror::thrown::Images,
    scene::{
        direct::{self, Receiver},
        emitters::Emitter,
        world::World,
    },
};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Light of one emitter on every element.
#[derive(Clone, Debug)]
pub(super) struct EmitterLight {
    placement: Affine3A,
    dimmer: f32,
    /// Irradiance at dimmer 1, lx; `None` when it was never needed.
    at_full: Option<Arc<Tables>>,
}

#[derive(Debug)]
struct Tables {
    direct: Vec<Vec3>,
    /// By way of specular lobes, and the variance of its luminance; empty where there are none.
    passed_on: Vec<(Vec3, f32)>,
}

/// What emitters shine into, and how well it is asked for.
pub(super) struct Lighting<'a> {
    pub world: &'a World,
    pub transport: &'a Transport,
    /// The flat mirrors where they stand now.
    pub images: &'a Images,
    /// Shadow rays an area emitter and element.
    pub shadow_rays: u32,
    /// Whether something moves: fewer places on lobes are asked.
    pub moving: bool,
    pub seed: u64,
}

impl EmitterLight {
    /// Light of an emitter.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`].
    pub fn new(lighting: &Lighting, emitter: &Emitter, progress: &Progress) -> Result<Self, RadiosityError> {
        let Lighting { world, transport, images, shadow_rays, moving, seed } = *lighting;
        let (placement, dimmer) = state(world, emitter);
        if dimmer <= 0.0 {
            return Ok(Self { placement, dimmer, at_full: None });
        }
        let full = at_full(world, emitter);
        progress.begin("direct light");
        let mut tables = Tables {
            direct: irradiance(transport, shadow_rays, seed, progress, |_, receivers, rays| {
                direct::mean_irradiance(world, &full, receivers.iter().copied(), rays)
            })?,
            passed_on: Vec::new(),
        };
        let lobes = &transport.lobes;
        if lobes.any() {
            progress.begin("light by way of lobes");
            let places: usize = transport.seen.iter().flatten().map(|s| s.places()).sum();
            let stride = places.div_ceil(if moving { PLACES_MOVING } else { PLACES }).max(1);
            let seed32 = fold(seed);
            tables.passed_on =
                irradiance(transport, shadow_rays, seed, progress, |element, receivers, rays| {
                    let by_images = images.mean_irradiance(world, &full, receivers, rays);
                    let Some(seen) = &transport.seen[element] else { return (by_images, 0.0) };
                    let first = first_of(stride, element, seed32);
                    let scramble = hash2(element as u32, seed32 ^ 0x51EC);
                    let (sum, squares) = lobes.irradiance(world, &full, seen, (first, stride), scramble);
                    let rays = transport.row(element as u32).len().max(1) as f32;
                    (by_images + sum / rays, squares / (rays * rays))
                })?;
        }
        if matches!(emitter, Emitter::Area(area) if area.textured) {
            // A texture is read with the dimmer applied.
            tables.direct.iter_mut().for_each(|e| *e /= dimmer);
            tables.passed_on.iter_mut().for_each(|(e, v)| (*e, *v) = (*e / dimmer, *v / (dimmer * dimmer)));
        }
        let at_full = Some(Arc::new(tables));
        Ok(Self { placement, dimmer, at_full })
    }

    /// An emitter whose light has not been computed.
    pub fn unlit(world: &World, emitter: &Emitter) -> Self {
        let (placement, _) = state(world, emitter);
        Self { placement, dimmer: 0.0, at_full: None }
    }

    /// The light after the emitter may have changed: a factor if it was only dimmed, new rays if it
    /// moved or `again` asks for them.
    pub fn follow(&self, lighting: &Lighting, emitter: &Emitter, again: bool) -> Self {
        let (placement, dimmer) = state(lighting.world, emitter);
        if again && dimmer <= 0.0 {
            return Self { placement, dimmer, at_full: None };
        }
        if !again && placement == self.placement && (self.at_full.is_some() || dimmer == 0.0) {
            return Self { dimmer, ..self.clone() };
        }
        // Nobody cancels silent progress.
        Self::new(lighting, emitter, &Progress::silent()).unwrap_or_else(|_| self.clone())
    }

    /// Adds this light to what arrives directly, to what arrives by way of lobes and to the variance of that, lx.
    pub fn add_to(&self, direct: &mut [Vec3], passed_on: &mut [Vec3], variance: &mut [f32]) {
        let Some(tables) = &self.at_full else { return };
        direct.iter_mut().zip(&tables.direct).for_each(|(sum, e)| *sum += *e * self.dimmer);
        for ((sum, variance), (e, v)) in passed_on.iter_mut().zip(variance).zip(&tables.passed_on) {
            *sum += *e * self.dimmer;
            *variance += v * self.dimmer * self.dimmer;
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.at_full.as_ref().map_or(0, |t| size_of_val(&t.direct[..]) + size_of_val(&t.passed_on[..]))
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

/// One value an element: what `light` makes of its number, points of its footprint and rays a point.
fn irradiance<T: Default + Send>(
    transport: &Transport,
    shadow_rays: u32,
    seed: u64,
    progress: &Progress,
    light: impl Fn(usize, &[(&Receiver, u32)], u32) -> T + Sync,
) -> Result<Vec<T>, Cancelled> {
    const BLOCK: usize = 4096;
    let seed = fold(seed);
    let elements = &transport.map.elements;
    let mut table = Vec::with_capacity(elements.len());
    for (block, chunk) in elements.chunks(BLOCK).enumerate() {
        progress.report((block * BLOCK) as f32 / elements.len() as f32)?;
        table.par_extend(chunk.par_iter().enumerate().with_min_len(64).map(|(i, element)| {
            if element.flags & UNSOLVED != 0 {
                return T::default();
            }
            let number = block * BLOCK + i;
            let footprint = transport.map.footprint(number);
            // Fewer rays than points, as while something moves: only as many points, evenly chosen.
            let points = FOOTPRINT.min(shadow_rays.max(1) as usize);
            let rays = shadow_rays.div_ceil(points as u32);
            let receivers: [(&Receiver, u32); FOOTPRINT] = std::array::from_fn(|point| {
                let k = point * FOOTPRINT / points % FOOTPRINT;
                (&footprint[k], hash2((number * FOOTPRINT + k) as u32, seed))
            });
            light(number, &receivers[..points], rays)
        }));
    }
    Ok(table)
}
