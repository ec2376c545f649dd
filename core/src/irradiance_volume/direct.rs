//! Direct light at a sample, as a short list of directions with how much comes from each.
//!
//! Emitters are not left to the radiance bins: a bin is 8° wide at n = 17, and a small luminaire would be
//! missed or counted whole (Greger §4.2.2 names this the one large error). Every emitter is asked by
//! itself instead. A lamp gives one [`Arrival`]; a luminous surface is cut into leaves, each with its
//! exact vector irradiance. The irradiance of a bin is then Σ weight · max(0, ω·direction), and a lamp that moves
//! touches nobody else's list.

use super::{
    VolumeSettings,
    leaves::{Leaves, Piece},
};
use crate::{
    math::{
        colour::luminance,
        random::{fold, r2_point},
    },
    scene::{
        accel::{Ray, Shaft},
        emitters::{AreaEmitter, Emitter, Facing},
        lamp::Lamp,
        world::World,
    },
};
use glam::{IVec2, Vec2, Vec3};
use rayon::prelude::*;

/// Light that reaches a sample from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Unit direction it comes from.
    pub direction: Vec3,
    /// Irradiance on a surface facing it, lx per channel.
    pub normal_irradiance: Vec3,
}

/// What every sample receives from one emitter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrivals {
    /// First entry of each sample, and one past the last.
    pub offsets: Vec<u32>,
    /// The entries, sample by sample.
    pub entries: Vec<Arrival>,
}

impl Arrivals {
    /// Asks one emitter from every position.
    pub fn gather(world: &World, emitter: &Emitter, positions: &[Vec3], settings: &VolumeSettings) -> Self {
        Self::gather_by(world, emitter, positions, &Asking::at_rest(settings))
    }

    /// Asks one emitter from every position, as closely as said.
    pub(super) fn gather_by(world: &World, emitter: &Emitter, positions: &[Vec3], asking: &Asking) -> Self {
        /// Samples asked in turn by one thread.
        const TOGETHER: usize = 32;
        let chunks: Vec<Self> = positions
            .par_chunks(TOGETHER)
            .map(|positions| {
                let mut asked = Asked::new(world, emitter);
                let mut found = Self { offsets: vec![0], entries: Vec::new() };
                for &position in positions {
                    found.entries.extend(asked.from(position, asking));
                    found.offsets.push(found.entries.len() as u32);
                }
                found
            })
            .collect();
        let mut all = Self {
            offsets: Vec::with_capacity(positions.len() + 1),
            entries: Vec::with_capacity(chunks.iter().map(|c| c.entries.len()).sum()),
        };
        all.offsets.push(0);
        chunks.iter().for_each(|chunk| all.append(chunk));
        all
    }

    /// Adds samples after these.
    pub(super) fn append(&mut self, other: &Self) {
        let first = self.entries.len() as u32;
        self.offsets.extend(other.offsets[1..].iter().map(|offset| first + offset));
        self.entries.extend(&other.entries);
    }

    /// Entries of one sample.
    pub fn of(&self, sample: usize) -> &[Arrival] {
        &self.entries[self.offsets[sample] as usize..self.offsets[sample + 1] as usize]
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.offsets[..]) + size_of_val(&self.entries[..])
    }
}

/// How closely an emitter is asked.
pub(super) struct Asking {
    /// Shadow rays to a luminous surface, at least.
    rays: u32,
    /// Widest leaf, m of edge a metre of distance.
    widest: f32,
    seed: u64,
}

impl Asking {
    /// As the settings have it.
    pub fn at_rest(settings: &VolumeSettings) -> Self {
        Self { rays: settings.direct_samples, widest: WIDEST, seed: settings.seed }
    }

    /// While the emitter is being moved: by a quarter of the leaves and shadow rays. What a leaf in full
    /// view sends stays exact above its horizon; edges of shadows come in steps twice as wide.
    pub fn moving(settings: &VolumeSettings) -> Self {
        Self { rays: settings.direct_samples.div_ceil(4), widest: 2.0 * WIDEST, seed: settings.seed }
    }
}

/// Arrivals from nearly the same direction, becoming one.
struct Near {
    cell: IVec2,
    /// Direction of the first.
    first: Vec3,
    merged: Arrival,
}

/// Makes one of arrivals from nearly the same direction: 20 cells along an axis of the octahedral map, 8° each.
///
/// The vector irradiance stays what it was, so every normal with the whole cell above its horizon gets the
/// same light; it takes two thirds of the arrivals away, whose cosines with all the bins are what a drag
/// waits for.
fn merge(list: &mut Vec<Arrival>, near: &mut Vec<Near>) {
    const CELLS: f32 = 10.0;
    let cell = |d: Vec3| {
        let p = d.truncate() / d.abs().element_sum();
        let folded = (Vec2::ONE - Vec2::new(p.y, p.x).abs()) * Vec2::ONE.copysign(p);
        ((if d.z < 0.0 { folded } else { p } + Vec2::ONE) * CELLS).as_ivec2()
    };
    if list.len() < 2 {
        return;
    }
    near.clear();
    for Arrival { direction, normal_irradiance } in list.iter() {
        let (cell, weighted) = (cell(*direction), *direction * luminance(*normal_irradiance));
        match near.iter_mut().find(|n| n.cell == cell) {
            Some(near) => near.merged.direction += weighted,
            None => {
                let merged = Arrival { direction: weighted, normal_irradiance: Vec3::ZERO };
                near.push(Near { cell, first: *direction, merged });
            }
        }
    }
    for Near { first, merged, .. } in near.iter_mut() {
        merged.direction = merged.direction.normalize_or(*first);
    }
    for Arrival { direction, normal_irradiance } in list.drain(..) {
        let cell = cell(direction);
        if let Some(Near { merged, .. }) = near.iter_mut().find(|n| n.cell == cell) {
            merged.normal_irradiance += normal_irradiance * direction.dot(merged.direction);
        }
    }
    list.extend(near.iter().map(|n| n.merged));
}

/// Visible light from one emitter at a point in the air.
pub fn arrivals(world: &World, emitter: &Emitter, position: Vec3, settings: &VolumeSettings) -> Vec<Arrival> {
    Asked::new(world, emitter).from(position, &Asking::at_rest(settings)).to_vec()
}

/// Luminous surfaces of more triangles than this are sampled over their area, not cut.
const MESHED: usize = 64;

/// Shadow rays to an emitter from which on what may stand in their way is found first.
const MANY: u32 = 8;

/// Widest leaf, m of edge a metre of distance: the mid-point cosine then errs by under 1 %.
const WIDEST: f32 = 0.35;

/// An emitter that is asked from one point after another.
struct Asked<'a> {
    world: &'a World,
    emitter: &'a Emitter,
    /// Corners of a box around a luminous surface, m.
    bounds: [Vec3; 2],
    shaft: Shaft,
    list: Vec<Arrival>,
    near: Vec<Near>,
    hidden: Vec<bool>,
}

impl<'a> Asked<'a> {
    fn new(world: &'a World, emitter: &'a Emitter) -> Self {
        let mut bounds = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        if let Emitter::Area(area) = emitter {
            for p in area.triangles.iter().flat_map(|&t| world.geometry.positions[t as usize]) {
                bounds = [bounds[0].min(p), bounds[1].max(p)];
            }
        }
        let shaft = Shaft::default();
        Self { world, emitter, bounds, shaft, list: Vec::new(), near: Vec::new(), hidden: Vec::new() }
    }

    /// What arrives at a point.
    fn from(&mut self, position: Vec3, asking: &Asking) -> &[Arrival] {
        self.list.clear();
        match self.emitter {
            Emitter::Lamp { lamp, .. } => self.list.extend(of_lamp(self.world, lamp, position)),
            Emitter::Area(area) if area.radiance == Vec3::ZERO => {}
            Emitter::Area(area) => {
                // A shaft costs about as much as half a dozen rays.
                if self.world.glass || asking.rays < MANY {
                    self.shaft.unknown();
                } else {
                    self.world.accel.look(position, self.bounds, &mut self.shaft);
                }
                if area.triangles.len() > MESHED {
                    self.sample(area, position, asking);
                } else {
                    self.cut(area, position, asking);
                }
                merge(&mut self.list, &mut self.near);
            }
        }
        &self.list
    }

    fn cut(&mut self, area: &AreaEmitter, position: Vec3, asking: &Asking) {
        let world = self.world;
        let rays = asking.rays.max(1);
        let mut depth = 0;
        while (area.triangles.len() as u32) << (2 * depth) < rays && depth < 4 {
            depth += 1;
        }
        for &triangle in &area.triangles {
            let corners = world.geometry.positions[triangle as usize];
            let facing = world.geometry.area_normal(triangle).dot(position - corners[0]);
            if facing > 0.0 || (area.double_sided && facing < 0.0) {
                let widest = asking.widest;
                let Self { list, shaft, hidden, .. } = self;
                Leaves { world, area, triangle, position, widest, list, shaft, hidden }.cut(
                    &Piece::whole(corners),
                    depth,
                    6,
                );
            }
        }
    }

    /// Points spread over a finely meshed emitter, weighted so that together they have its exact solid angle.
    fn sample(&mut self, area: &AreaEmitter, position: Vec3, asking: &Asking) {
        let world = self.world;
        let count = 2 * asking.rays.max(4);
        let mut total = 0.0f64;
        for j in 0..count {
            let point = area.point(&world.geometry, r2_point(j, fold(asking.seed)));
            let Some(Facing { wi: direction, d2, cosine, .. }) = area.facing(&point, position) else {
                continue;
            };
            total += f64::from(cosine / d2);
            let ray = Ray::between(position, point.position);
            let seen = if world.glass {
                world.transmittance(&ray)
            } else {
                Vec3::splat(f32::from(u8::from(!world.accel.occluded_in(&ray, &mut self.shaft))))
            };
            let normal_irradiance = point.radiance * seen * (cosine / d2);
            if normal_irradiance != Vec3::ZERO {
                self.list.push(Arrival { direction, normal_irradiance });
            }
        }
        let exact: f64 = area
            .triangles
            .iter()
            .map(|&t| world.geometry.positions[t as usize].map(|p| p - position))
            .filter(|c| area.double_sided || (c[1] - c[0]).cross(c[2] - c[0]).dot(c[0]) < 0.0)
            .map(solid_angle)
            .sum();
        let scale = if total > 0.0 { (exact / total) as f32 } else { 0.0 };
        self.list.iter_mut().for_each(|a| a.normal_irradiance *= scale);
    }
}

fn of_lamp(world: &World, lamp: &Lamp, position: Vec3) -> Option<Arrival> {
    let (direction, normal_irradiance) = lamp.arriving(position);
    if normal_irradiance == Vec3::ZERO || !normal_irradiance.is_finite() {
        return None;
    }
    let normal_irradiance = normal_irradiance * world.transmittance(&lamp.ray_from(position));
    (normal_irradiance != Vec3::ZERO).then_some(Arrival { direction, normal_irradiance })
}

/// Solid angle of a triangle seen from the origin, sr (van Oosterom and Strackee 1983).
pub fn solid_angle(corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let below = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
    2.0 * a.dot(b.cross(c)).abs().atan2(below)
}
