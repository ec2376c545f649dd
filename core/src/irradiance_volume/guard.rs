//! What stands in the way of samples, and what of it is remembered.
//!
//! A cell whose box no standing triangle meets is convex and empty, so all its samples see all its points.
//! Any other cell is cut into parts: a sample at its corner sees all of a part if no standing triangle meets
//! the box around both. Only for the others a ray is cast at each query. Not remembered is who sees nothing
//! of a part: to take that from its corners made the office 0.2 % too bright.

use super::{
    Sample,
    grid::{BilevelGrid, NONE, cells_with_geometry},
    trust::SampleState,
};
use crate::scene::{
    accel::{Accel, Blockers, Ray},
    world::World,
};
use glam::{UVec3, Vec3};
use std::sync::{Arc, OnceLock};

/// Parts along each edge of a cell; 4³ are the bits of a word.
pub(super) const PARTS: u32 = 4;

/// Parts of a whole grid that are looked through when a guard is made, at most: a byte each.
pub(super) const MOST_PARTS: u64 = 1 << 28;

/// A cell as the guard knows it.
pub(super) struct Watched {
    pub low: Vec3,
    pub size: Vec3,
    /// Bits of the parts whose boxes standing triangles meet.
    held: u64,
    /// Bits of the samples that are at its corners; others were relocated.
    corners: u8,
    /// For each part whether no sample far and wide sees its corners or its middle; found when first asked.
    pub dark: OnceLock<Box<[OnceLock<bool>]>>,
}

impl Watched {
    /// The part that holds a point: its place along each axis, and its number.
    pub fn part(&self, point: Vec3) -> (UVec3, usize) {
        let at = ((point - self.low) / self.size * PARTS as f32).as_uvec3().min(UVec3::splat(PARTS - 1));
        (at, ((at.z * PARTS + at.y) * PARTS + at.x) as usize)
    }
}

/// Bits of the parts in the box around each part and each corner of a cell.
fn boxes() -> Box<[[u64; 8]]> {
    let between = |part: u32, corner: u32, other: u32| {
        (0..3).all(|axis| {
            let along = |i: u32| i / PARTS.pow(axis) % PARTS;
            if corner >> axis & 1 == 1 { along(other) >= along(part) } else { along(other) <= along(part) }
        })
    };
    let bits = |part, corner| {
        (0..PARTS.pow(3)).fold(0, |bits, other| bits | u64::from(between(part, corner, other)) << other)
    };
    (0..PARTS.pow(3)).map(|part| std::array::from_fn(|corner| bits(part, corner as u32))).collect()
}

/// What stands in the way of samples.
#[derive(Clone)]
pub struct Guard {
    standing: Arc<Accel>,
    pub(super) cells: Arc<Vec<Watched>>,
    boxes: Arc<[[u64; 8]]>,
    /// For each first-level cell the valid samples in it and around it, found when first asked.
    pub(super) near: Arc<Vec<OnceLock<Vec<u32>>>>,
}

impl std::fmt::Debug for Guard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Guard of {} cells", self.cells.len())
    }
}

impl Guard {
    /// Whether a grid of `size` cells, each cut in `inner` an axis, has few enough parts, [`MOST_PARTS`].
    pub(super) fn fits(size: UVec3, inner: u32) -> bool {
        (size * inner * PARTS).to_array().iter().map(|n| u64::from(*n)).product::<u64>() <= MOST_PARTS
    }

    /// Of what stands still in a world.
    pub(super) fn new(world: &World, grid: &BilevelGrid, samples: &[Sample]) -> Self {
        let geometry = &world.geometry;
        let standing: Vec<[Vec3; 3]> = (0..geometry.len())
            .filter(|&t| !geometry.movable[geometry.object[t] as usize])
            .map(|t| geometry.positions[t])
            .collect();
        let (low, high) = grid.bounds();
        let (size, inner) = (grid.size(), grid.inner());
        let unflat = |i: u32, size: UVec3| UVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y));
        let all_parts = size * inner * PARTS;
        let holding = cells_with_geometry(low, high, all_parts, &standing);
        let holds = |at: UVec3| holding[((at.z * all_parts.y + at.y) * all_parts.x + at.x) as usize];
        // A cell that begins at a part of the second level, each of its own parts `wide` of those wide.
        let watched = |origin: UVec3, wide: u32, samples: &[u32; 8], all: &[Sample]| {
            let held = |part: u32| {
                let first = origin + unflat(part, UVec3::splat(PARTS)) * wide;
                (0..wide.pow(3)).any(|i| holds(first + unflat(i, UVec3::splat(wide))))
            };
            let size = grid.cell_size() / inner as f32 * wide as f32;
            let place = |&s: &u32| all[s as usize].state != SampleState::Relocated;
            Watched {
                low: low + origin.as_vec3() / (inner * PARTS) as f32 * grid.cell_size(),
                size,
                held: (0..PARTS.pow(3)).fold(0, |bits, part| bits | u64::from(held(part)) << part),
                corners: samples.iter().zip(0..).fold(0, |bits, (s, i)| bits | u8::from(place(s)) << i),
                dark: OnceLock::new(),
            }
        };
        let corners = |cell: usize| &grid.cells()[cell].samples;
        let first_level = size.element_product();
        let mut cells: Vec<Watched> = (0..first_level)
            .map(|c| watched(unflat(c, size) * inner * PARTS, inner, corners(c as usize), samples))
            .collect();
        // Second-level grids follow in the order of their first cells.
        let mut grids: Vec<(u32, u32)> =
            grid.second().iter().zip(0..).filter(|(s, _)| **s != NONE).map(|(s, c)| (*s, c)).collect();
        grids.sort_unstable();
        for (first, c) in grids {
            assert_eq!(first as usize, cells.len(), "grids of the second level follow each other");
            let origin = unflat(c, size) * inner;
            cells.extend((0..inner.pow(3)).map(|s| {
                let at = origin + unflat(s, UVec3::splat(inner));
                watched(at * PARTS, 1, corners((first + s) as usize), samples)
            }));
        }
        let near = (0..size.element_product()).map(|_| OnceLock::new()).collect();
        Self {
            standing: Arc::new(world.accel.standing()),
            cells: Arc::new(cells),
            boxes: boxes().into(),
            near: Arc::new(near),
        }
    }

    #[inline(always)]
    pub(super) fn is_open(&self, cell: u32) -> bool {
        let cell = &self.cells[cell as usize];
        cell.held == 0 && cell.corners == u8::MAX
    }

    /// Which of a cell's samples see a point of it.
    pub(super) fn seen(
        &self,
        cell: u32,
        samples: [Vec3; 8],
        point: Vec3,
        blockers: &mut Blockers,
    ) -> [bool; 8] {
        let watched = &self.cells[cell as usize];
        let boxes = &self.boxes[watched.part(point).1];
        let mut seen = [true; 8];
        for (i, seen) in seen.iter_mut().enumerate() {
            let free = watched.corners >> i & 1 == 1 && watched.held & boxes[i] == 0;
            *seen = free || self.sees(samples[i], point, blockers);
        }
        seen
    }

    /// Whether nothing that stands lies between a sample and a point, ends not counted; what hides one
    /// sample of a point is asked first about the next.
    pub(super) fn sees(&self, sample: Vec3, point: Vec3, blockers: &mut Blockers) -> bool {
        // From the sample: the ray stops just short of the point, which may lie on a surface.
        let ray = Ray::between(sample, point);
        ray.is_degenerate() || !self.standing.occluded_past(&ray, blockers)
    }
}
