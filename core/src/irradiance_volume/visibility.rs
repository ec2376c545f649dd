//! Queries with care: only samples that see the point, and points outside the grid.
//!
//! Trilinear weights know nothing of walls: a point in a dark room is lit by the samples beyond a thin one.
//! With [`super::VolumeSettings::guard`] a query asks, for each of its eight samples, whether the segment
//! to the point is free of standing geometry, and shares the weight of the hidden ones among the others.
//! In a pocket the sample that it has of its own answers alone ([`pockets`](super::pockets)).
//! Where all eight are hidden, the nearest sample around that sees the point answers alone; where none
//! does, the point is dark and its state says so, because light from behind a wall would be wrong
//! without a sign.
//!
//! Rays, and not distances remembered by the samples: the mean distance in a direction with Chebyshev's
//! bound (Majercik et al. 2019) lets some per cent through and must blur over a bin 8° wide. What rays find is
//! remembered, see [`guard`](super::guard) and `sight`.
//!
//! Limits: objects that can be moved do not hide samples, wherever they stand, so that an object is not
//! hidden from the light by itself. Where a sample comes into sight, the interpolated light jumps.

use super::{
    IrradianceVolume, VolumeSettings,
    grid::{Cell, NONE, trilinear},
    guard::{Guard, MARGIN},
    query::{Corners, alike, kept, usable},
    sight::Look,
};
use crate::scene::{accel::Blockers, world::World};
use glam::{UVec3, Vec3};

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

/// Cells beyond the grid over which a query fades from its border to the nearest sample: from, to.
const FADE: [f32; 2] = [MARGIN, 1.0 + MARGIN];

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
            let find = |p: Vec3| self.seen_from(guard, p, cell, usable);
            let look = match guard.look(cell, point, find) {
                Look::Ask => find(point),
                look => look,
            };
            match look {
                Look::Samples(bits) => {
                    seen = std::array::from_fn(|i| bits >> i & 1 == 1);
                    corners.weights = shared(corners.weights, bits, usable);
                }
                Look::Lender(sample) => {
                    corners = Corners::alone(sample);
                    state = PointState::Borrowed;
                }
                Look::Nothing | Look::Ask => {
                    (corners.weights, seen) = ([0.0; 8], [false; 8]);
                    state = PointState::Unseen;
                }
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

    /// Samples and weights of a point of a cell that holds geometry, asked by rays and not remembered.
    pub(super) fn corners_by_rays(&self, point: Vec3) -> Corners {
        let at = self.grid.locate(point);
        let Cell { samples, valid } = self.grid.cells()[at.cell as usize];
        let weights = usable(trilinear(at.offset), valid);
        let Some(guard) = &self.guard else { return Corners { ids: samples, weights } };
        match self.seen_from(guard, point, at.cell, valid) {
            Look::Samples(bits) => Corners { ids: samples, weights: shared(weights, bits, valid) },
            Look::Lender(sample) => Corners::alone(sample),
            Look::Nothing | Look::Ask => Corners { ids: samples, weights: [0.0; 8] },
        }
    }

    /// What rays tell of a point: the sample of its pocket, or those of its cell that see it, or else one around.
    #[cold]
    fn seen_from(&self, guard: &Guard, point: Vec3, cell: u32, usable: u8) -> Look {
        let mut blockers = Blockers::default();
        if let Some(own) = self.grid.pocket(cell, point)
            && self.samples[own as usize].valid
            && guard.sees(self.samples[own as usize].position, point, &mut blockers)
            && guard.alike(self.samples[own as usize].position, point)
        {
            return Look::Lender(own);
        }
        let ids = self.grid.cells()[cell as usize].samples;
        let seen = (0..8).fold(0u8, |bits, i| {
            let sample = self.samples[ids[i] as usize].position;
            bits | u8::from(guard.sees(sample, point, &mut blockers)) << i
        });
        if seen & usable != 0 {
            return Look::Samples(seen);
        }
        self.lender(guard, point, &mut blockers).map_or(Look::Nothing, Look::Lender)
    }

    /// The nearest sample in the first-level cells around a point that sees it, of a few.
    fn lender(&self, guard: &Guard, point: Vec3, blockers: &mut Blockers) -> Option<u32> {
        let (low, high) = self.grid.bounds();
        let size = self.grid.size();
        let at = ((point.clamp(low, high) - low) / self.grid.cell_size()).as_uvec3().min(size - 1);
        let cell = (at.z * size.y + at.y) * size.x + at.x;
        let near = guard.near[cell as usize].get_or_init(|| self.around(at));
        let distance = |id: u32| self.samples[id as usize].position.distance_squared(point);
        let mut found: Vec<(f32, u32)> = near.iter().map(|&id| (distance(id), id)).collect();
        let order = |a: &(f32, u32), b: &(f32, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if found.len() > ASKED {
            found.select_nth_unstable_by(ASKED, order);
            found.truncate(ASKED);
        }
        // As a rule none sees the point: no need to sort those that do not.
        let sees = |id: u32, blockers: &mut Blockers| {
            guard.sees(self.samples[id as usize].position, point, blockers)
        };
        let nearer = |best: Option<(f32, u32)>, one: (f32, u32)| {
            let asked = best.is_none_or(|best| order(&one, &best).is_lt());
            if asked && sees(one.1, blockers) { Some(one) } else { best }
        };
        found.into_iter().fold(None, nearer).map(|f| f.1)
    }

    /// Valid samples of a first-level cell and those around it.
    fn around(&self, at: UVec3) -> Vec<u32> {
        let grid = &self.grid;
        let (from, to) = (at.saturating_sub(UVec3::ONE), (at + 1).min(grid.size() - 1));
        let mut found: Vec<u32> = Vec::new();
        let mut add = |cell: u32| {
            found.extend(grid.cells()[cell as usize].samples);
            found.extend(grid.pockets_of(cell));
        };
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                for x in from.x..=to.x {
                    let cell = (z * grid.size().y + y) * grid.size().x + x;
                    add(cell);
                    let second = grid.second()[cell as usize];
                    if second != NONE {
                        (second..second + grid.inner().pow(3)).for_each(&mut add);
                    }
                }
            }
        }
        found.retain(|&id| self.samples[id as usize].valid);
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// Weights shared among the samples that see a point, of which one is usable at least: as without a guard, to the
/// last bit, where the others weigh nothing.
#[inline(always)]
pub(super) fn shared(weights: [f32; 8], seen: u8, usable: u8) -> [f32; 8] {
    // On a face whose samples are hidden: the others of the cell, alike.
    kept(&weights, seen).unwrap_or_else(|| alike(seen & usable))
}
