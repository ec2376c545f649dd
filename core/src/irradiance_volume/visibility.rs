//! Queries with care: only samples that see the point, and points outside the grid.
//!
//! Trilinear weights know nothing of walls: a point in a dark room is lit by the samples beyond a thin one.
//! With [`super::VolumeSettings::guard`] a query asks, for each of its eight samples, whether the segment
//! to the point is free of standing geometry, and shares the weight of the hidden ones among the others.
//! Where all eight are hidden, the nearest sample around that sees the point answers alone; where none
//! does, the point is dark and its state says so, because light from behind a wall would be wrong
//! without a sign.
//!
//! Rays, and not distances remembered by the samples: the mean distance in a direction with Chebyshev's
//! bound (Majercik et al. 2019) lets some per cent through and must blur over a bin 8° wide, while eight
//! rays are exact. They are rarely needed: a cell whose box no standing triangle meets is convex and empty,
//! so all its samples see all its points, and its queries cost what they did before.
//!
//! Limits: objects that can be moved do not hide samples, wherever they stand, so that an object is not
//! hidden from the light by itself. Where a sample comes into sight, the interpolated light jumps.

use super::{
    IrradianceVolume, Sample, VolumeSettings,
    grid::{BilevelGrid, NONE, cells_with_geometry},
    query::Corners,
    trust::SampleState,
};
use crate::scene::{
    accel::{Accel, Ray},
    world::World,
};
use glam::{UVec3, Vec3};
use std::sync::Arc;

/// Whether the samples of a query could be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PointState {
    /// Between samples that may light it.
    #[default]
    Inside,
    /// This far outside the grid, m: lit by the nearest samples.
    Outside(f32),
    /// None of the eight samples around sees it: lit by the nearest that does.
    Borrowed,
    /// No sample near it sees it: dark, for want of anything to know it by.
    Unseen,
}

/// What stands in the way of samples.
#[derive(Clone)]
pub struct Guard {
    standing: Arc<Accel>,
    /// For each cell of the grid, whether no standing triangle meets its box.
    open: Arc<Vec<bool>>,
}

impl std::fmt::Debug for Guard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Guard of {} cells", self.open.len())
    }
}

impl Guard {
    /// Of what stands still in a world.
    fn new(world: &World, grid: &BilevelGrid, samples: &[Sample]) -> Self {
        let geometry = &world.geometry;
        let standing: Vec<[Vec3; 3]> = (0..geometry.len())
            .filter(|&t| !geometry.movable[geometry.object[t] as usize])
            .map(|t| geometry.positions[t])
            .collect();
        let (low, high) = grid.bounds();
        let (size, inner) = (grid.size(), grid.inner());
        let coarse = cells_with_geometry(low, high, size, &standing);
        let fine_size = size * inner;
        let fine = cells_with_geometry(low, high, fine_size, &standing);
        let flat = |at: UVec3, size: UVec3| ((at.z * size.y + at.y) * size.x + at.x) as usize;
        let unflat = |i: u32, size: UVec3| UVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y));
        let mut open: Vec<bool> = coarse.iter().map(|holds| !holds).collect();
        open.resize(grid.cells().len(), true);
        for (c, &first) in grid.second().iter().enumerate().filter(|(_, s)| **s != NONE) {
            let origin = unflat(c as u32, size) * inner;
            for s in 0..inner.pow(3) {
                let at = origin + unflat(s, UVec3::splat(inner));
                open[(first + s) as usize] = !fine[flat(at, fine_size)];
            }
        }
        // A relocated sample is no corner of its cell: nothing is known without a ray.
        for (open, cell) in open.iter_mut().zip(grid.cells()) {
            *open &= cell.samples.iter().all(|&s| samples[s as usize].state != SampleState::Relocated);
        }
        Self { standing: Arc::new(world.accel.standing()), open: Arc::new(open) }
    }

    #[inline(always)]
    pub(super) fn is_open(&self, cell: u32) -> bool {
        self.open[cell as usize]
    }

    /// Whether nothing that stands lies between a sample and a point, ends not counted.
    fn sees(&self, sample: Vec3, point: Vec3) -> bool {
        // From the sample: the ray stops just short of the point, which may lie on a surface.
        let ray = Ray::between(sample, point);
        ray.is_degenerate() || !self.standing.occluded(&ray)
    }
}

/// Cells beyond the grid over which a query fades from its border to the nearest sample: from, to. The
/// first part is where walls are, since the grid keeps a little away from them.
const FADE: [f32; 2] = [0.25, 1.25];

/// Samples around a point asked at most when all eight of its cell are hidden.
const ASKED: usize = 64;

/// What a careful query found.
pub(super) struct Careful {
    pub corners: Corners,
    pub seen: [bool; 8],
    pub state: PointState,
}

impl IrradianceVolume {
    /// The same volume whose queries use only samples that see the point, past what stands still in
    /// `world`; `None` takes the guard away.
    pub fn with_guard(&self, world: Option<&World>) -> Self {
        let guard = world.map(|w| Guard::new(w, &self.grid, &self.samples));
        let settings = VolumeSettings { guard: guard.is_some(), ..self.settings.clone() };
        Self { guard, settings, ..self.clone() }
    }

    /// How far the farthest of some points lies outside the grid, m; `None` where all lie inside or so little
    /// outside that the grid's border still answers for them.
    pub fn beyond(&self, points: impl Iterator<Item = Vec3>) -> Option<f32> {
        let (low, high) = self.grid.bounds();
        let cell = self.grid.cell_size();
        points
            .map(|p| (p - p.clamp(low, high)).abs())
            .filter(|d| (*d / cell).max_element() > FADE[0])
            .map(Vec3::length)
            .reduce(f32::max)
    }

    /// Weights of a point outside the grid or in a cell that holds geometry. `usable` has a bit for each
    /// sample that may be used.
    #[cold]
    #[inline(never)]
    pub(super) fn careful(&self, point: Vec3, mut corners: Corners, cell: u32, usable: u8) -> Careful {
        let (low, high) = self.grid.bounds();
        let beyond = (point - point.clamp(low, high)).abs();
        let outside = beyond.length();
        let over = (beyond / self.grid.cell_size()).max_element();
        let mut seen = [true; 8];
        let mut state = if outside > 0.0 { PointState::Outside(outside) } else { PointState::Inside };
        if let Some(guard) = &self.guard
            && point.is_finite()
            // Far outside, where no sample can be seen for the walls, the nearest one answers.
            && over <= FADE[0]
            && (outside > 0.0 || !guard.is_open(cell))
        {
            let sees = |id: u32| guard.sees(self.samples[id as usize].position, point);
            seen = corners.ids.map(sees);
            let hidden = (0..8).any(|i| !seen[i] && corners.weights[i] > 0.0);
            let kept: [f32; 8] = std::array::from_fn(|i| if seen[i] { corners.weights[i] } else { 0.0 });
            let sum: f32 = kept.iter().sum();
            let may = |i: usize| seen[i] && usable >> i & 1 == 1;
            if !hidden {
                // As without a guard, to the last bit.
            } else if sum > 0.0 {
                corners.weights = kept.map(|w| w / sum);
            } else if (0..8).any(may) {
                // On a face whose samples are hidden: the others of the cell, alike.
                let count = (0..8).filter(|&i| may(i)).count() as f32;
                corners.weights = std::array::from_fn(|i| if may(i) { 1.0 / count } else { 0.0 });
            } else if let Some(near) = self.around(point).find(|&id| sees(id)) {
                corners = Corners::alone(near);
                seen = [true; 8];
                state = PointState::Borrowed;
            } else {
                corners.weights = [0.0; 8];
                state = PointState::Unseen;
            }
        }
        let fade = ((over - FADE[0]) / (FADE[1] - FADE[0])).clamp(0.0, 1.0);
        if fade > 0.0 && corners.weights.iter().any(|&w| w > 0.0) {
            let distance = |i: usize| self.samples[corners.ids[i] as usize].position.distance_squared(point);
            let nearest = (0..8)
                .filter(|&i| seen[i] && (usable >> i & 1 == 1 || corners.weights[i] > 0.0))
                .min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
            if let Some(nearest) = nearest {
                corners.weights.iter_mut().for_each(|w| *w *= 1.0 - fade);
                corners.weights[nearest] += fade;
            }
        }
        Careful { corners, seen, state }
    }

    /// Valid samples of the first-level cells around a point, nearest first.
    fn around(&self, point: Vec3) -> impl Iterator<Item = u32> + use<> {
        let grid = &self.grid;
        let (low, high) = grid.bounds();
        let last = grid.size().as_ivec3() - 1;
        let at = ((point.clamp(low, high) - low) / grid.cell_size()).floor().as_ivec3();
        let (from, to) = ((at - 1).max(glam::IVec3::ZERO), (at + 1).min(last));
        let mut found: Vec<(f32, u32)> = Vec::new();
        let mut add = |cell: u32| {
            for &id in &grid.cells()[cell as usize].samples {
                let sample = &self.samples[id as usize];
                if sample.valid {
                    found.push((sample.position.distance_squared(point), id));
                }
            }
        };
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                for x in from.x..=to.x {
                    let size = grid.size();
                    let cell = (z as u32 * size.y + y as u32) * size.x + x as u32;
                    add(cell);
                    let second = grid.second()[cell as usize];
                    if second != NONE {
                        (second..second + grid.inner().pow(3)).for_each(&mut add);
                    }
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.dedup();
        found.into_iter().take(ASKED).map(|f| f.1)
    }
}
