//! Samples that cannot be trusted as they stand: found, marked, and repaired by choice.
//!
//! A sample inside a solid sees backs. [`Repair`] says what becomes of it: left out of every query, filled
//! from its neighbours, or moved to free air nearby. Its [`SampleState`] says what was done, and every
//! read-out shows it.

pub use crate::scene::volume::Repair;

use super::{
    Sample,
    codec::{Texel, decode_rgb, encode_rgb},
    grid::BilevelGrid,
};
use crate::{
    math::sphere_map::DirectionBins,
    scene::{accel::Ray, world::World},
};
use glam::Vec3;
use rayon::prelude::*;

/// How a sample came to its light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleState {
    /// In free air, where the grid has it.
    #[default]
    Free,
    /// Was inside a solid; moved to free air.
    Relocated,
    /// Inside a solid; holds the light of its neighbours.
    Dilated,
    /// Inside a solid; not used while a neighbour is.
    Masked,
}

impl SampleState {
    /// Every state; a state's place is its number in files and false colours.
    pub const ALL: [Self; 4] = [Self::Free, Self::Relocated, Self::Dilated, Self::Masked];

    /// Names on screen, in the same order.
    pub const NAMES: [&'static str; 4] = ["valid", "relocated", "dilated", "masked"];

    /// Name on screen.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// Rows of the bins in whose directions a way out is looked for.
const WAYS: u32 = 8;

/// Share of the smallest edge of a cell that a relocated sample keeps from the surface it came through.
const CLEARANCE: f32 = 0.05;

/// The nearest free point around a sample inside a solid, within `reach` (m an axis): half a cell, so that
/// samples keep their order along every axis and the grid its topology.
///
/// Candidates lie just beyond the back faces the sample sees, nearest first (as the probes of Majercik et
/// al. 2019 leave walls); the first from which no more than `limit` of the rays meet backs is taken.
pub fn relocated(world: &World, position: Vec3, reach: Vec3, limit: f32) -> Option<Vec3> {
    let bins = DirectionBins::new(WAYS);
    let clearance = CLEARANCE * 2.0 * reach.min_element();
    let mut ways: Vec<(f32, Vec3)> = (0..bins.len())
        .filter_map(|b| {
            let direction = bins.centre(b);
            let (t, back) = seen(world, position, direction)?;
            let step = direction * (t + clearance);
            (back && step.abs().cmple(reach).all()).then_some((t, position + step))
        })
        .collect();
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    ways.into_iter().map(|(_, p)| p).find(|&p| {
        let met: Vec<(f32, bool)> = (0..bins.len()).filter_map(|b| seen(world, p, bins.centre(b))).collect();
        let backs = met.iter().filter(|(_, back)| *back).count();
        let nearest = met.iter().map(|m| m.0).fold(f32::INFINITY, f32::min);
        backs as f32 <= limit * bins.len() as f32 && nearest > 0.25 * clearance
    })
}

/// Distance to the first surface along a ray, and whether its unlit back is seen.
pub(super) fn seen(world: &World, origin: Vec3, direction: Vec3) -> Option<(f32, bool)> {
    let hit = world.accel.trace(&Ray::new(origin, direction))?;
    let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
    Some((hit.t, !world.geometry.is_lit(&surface)))
}

/// Which samples are filled from which others: an entry may name samples filled before it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fills(Vec<(u32, Vec<(u32, f32)>)>);

impl Fills {
    /// Plans the filling of every sample that is not valid and has, over other such samples, a valid one
    /// in reach of shared cells. Weights go with 1/d² and sum to 1.
    pub fn plan(grid: &BilevelGrid, positions: &[Vec3], valid: &[bool]) -> Self {
        let mut neighbours = vec![Vec::new(); valid.len()];
        for cell in grid.cells() {
            for &s in cell.samples.iter().filter(|&&s| !valid[s as usize]) {
                neighbours[s as usize].extend(cell.samples.iter().copied().filter(|&o| o != s));
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        let mut known = valid.to_vec();
        let mut fills = Vec::new();
        loop {
            let first = fills.len();
            for (s, list) in neighbours.iter().enumerate().filter(|(s, _)| !known[*s]) {
                let mut sources: Vec<(u32, f32)> = list
                    .iter()
                    .filter(|&&o| known[o as usize])
                    .map(|&o| (o, 1.0 / positions[s].distance_squared(positions[o as usize]).max(1e-12)))
                    .collect();
                let sum: f32 = sources.iter().map(|(_, w)| w).sum();
                sources.iter_mut().for_each(|(_, w)| *w /= sum);
                if !sources.is_empty() {
                    fills.push((s as u32, sources));
                }
            }
            if fills.len() == first {
                return Self(fills);
            }
            fills[first..].iter().for_each(|(s, _)| known[*s as usize] = true);
        }
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.0[..]) + self.0.iter().map(|(_, sources)| size_of_val(&sources[..])).sum::<usize>()
    }

    /// What filled the dilated ones among some samples, planned anew.
    pub fn of(grid: &BilevelGrid, samples: &[Sample]) -> Self {
        if samples.iter().all(|s| s.state != SampleState::Dilated) {
            return Self::default();
        }
        let known = |s: &Sample| matches!(s.state, SampleState::Free | SampleState::Relocated);
        let (positions, known): (Vec<_>, Vec<_>) = samples.iter().map(|s| (s.position, known(s))).unzip();
        Self::plan(grid, &positions, &known)
    }

    /// Whether there is nothing to fill.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Samples that are filled.
    pub fn samples(&self) -> impl Iterator<Item = u32> + '_ {
        self.0.iter().map(|(s, _)| *s)
    }

    /// Fills a table of `bins` texels a sample.
    pub(super) fn apply(&self, table: &mut [Texel], bins: usize) {
        for (sample, sources) in &self.0 {
            let filled: Vec<Texel> = (0..bins)
                .into_par_iter()
                .with_min_len(256)
                .map(|b| {
                    let of = |(s, w): &(u32, f32)| decode_rgb(table[*s as usize * bins + b]) * *w;
                    encode_rgb(sources.iter().map(of).sum())
                })
                .collect();
            table[*sample as usize * bins..][..bins].copy_from_slice(&filled);
        }
    }
}
