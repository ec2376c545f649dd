//! The bilevel grid: where the samples are, and which eight surround a point.
//!
//! A first-level grid spans the scene's bounds, a little inside them so that its outermost samples do
//! not lie in the walls. A first-level cell that holds geometry carries a second-level grid (Greger
//! 1996, §4.1). Samples, cells and grids are separate structures (§4.3): a sample is one corner of a
//! fine integer lattice and exists once, however many cells of either level share it.
//!
//! Two levels and not a tree: a lookup costs the same everywhere, and one step more where there is
//! geometry. The price is the thesis's: where a refined cell meets a plain one the interpolated value
//! jumps, because the refined side has samples on the shared face that the plain side does not use.

use super::{directions::clamped, overlap::triangle_meets_box, pockets::POCKET_LEVEL};
use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;
use wide::f32x8;

/// No second-level grid, or no sample.
pub const NONE: u32 = u32::MAX;

/// The box between eight samples; corner bit 0 is x, bit 1 y, bit 2 z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Sample at each corner.
    pub samples: [u32; 8],
    /// Bit i is set when sample i may be used: it does not lie inside a solid.
    pub valid: u8,
}

/// Where a lookup ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// Cell number.
    pub cell: u32,
    /// Fractional offset in the cell, each in [0, 1] (Greger Eq. 4.6).
    pub offset: Vec3,
    /// 1 or 2.
    pub level: u8,
}

/// Where some lookups ended, one entry a lookup.
pub(super) struct Locations<const N: usize> {
    /// Cell number.
    pub cell: [u32; N],
    /// Fractional offset in the cell, axis by axis.
    pub offset: [[f32; N]; 3],
    /// Whether the cell is one of the second level.
    pub refined: [bool; N],
}

impl<const N: usize> Locations<N> {
    /// One of them.
    #[inline(always)]
    pub fn of(&self, i: usize) -> Location {
        let offset = Vec3::from_array(self.offset.each_ref().map(|o| o[i]));
        Location { cell: self.cell[i], offset, level: 1 + u8::from(self.refined[i]) }
    }
}

/// One sample's place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplePlace {
    /// Position, m.
    pub position: Vec3,
    /// 1 when it is a corner of the first-level grid, 3 in the middle of an eighth of a cell, else 2.
    pub level: u8,
}

/// Samples, cells and the two levels of grids.
#[derive(Clone, Debug, PartialEq)]
pub struct BilevelGrid {
    low: Vec3,
    high: Vec3,
    /// First-level cells an axis.
    size: UVec3,
    /// Second-level cells an axis.
    inner: u32,
    /// First-level cells per metre.
    scale: Vec3,
    /// First cell of each first-level cell's second-level grid, or [`NONE`].
    second: Vec<u32>,
    /// First-level cells (x fastest), then those of each second-level grid.
    cells: Vec<Cell>,
    places: Vec<SamplePlace>,
    /// Eighths of cells with a sample of their own (8 × cell + corner) and its number, in order.
    pockets: Vec<(u32, u32)>,
}

impl BilevelGrid {
    /// A grid with `samples` first-level samples an axis over a box; the first-level cells where
    /// `subdivided` (x fastest) is true carry `second_level`³ samples.
    ///
    /// # Panics
    /// If an axis or `second_level` has fewer than 2 samples, or `subdivided` has another length than
    /// there are first-level cells.
    pub fn new(low: Vec3, high: Vec3, samples: UVec3, second_level: u32, subdivided: &[bool]) -> Self {
        assert!(samples.min_element() >= 2 && second_level >= 2, "a cell needs two samples an axis");
        let size = samples - UVec3::ONE;
        let count = size.element_product() as usize;
        assert_eq!(subdivided.len(), count, "one flag a first-level cell");
        let inner = second_level - 1;
        let mut lattice = Lattice::new(low, high, size * inner);
        let mut cells = Vec::with_capacity(count);
        for k in 0..samples.z {
            for j in 0..samples.y {
                for i in 0..samples.x {
                    lattice.sample(UVec3::new(i, j, k) * inner, 1);
                }
            }
        }
        for c in 0..count as u32 {
            cells.push(lattice.cell(unflatten(c, size) * inner, inner));
        }
        let mut second = vec![NONE; count];
        for c in (0..count).filter(|&c| subdivided[c]) {
            second[c] = cells.len() as u32;
            let origin = unflatten(c as u32, size) * inner;
            for s in 0..inner.pow(3) {
                cells.push(lattice.cell(origin + unflatten(s, UVec3::splat(inner)), 1));
            }
        }
        let scale = size.as_vec3() / (high - low);
        Self { low, high, size, inner, scale, second, cells, places: lattice.places, pockets: Vec::new() }
    }

    /// Corners of the box it spans, m.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    /// First-level cells an axis.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Second-level cells an axis in each refined first-level cell.
    pub fn inner(&self) -> u32 {
        self.inner
    }

    /// Edges of a first-level cell, m.
    pub fn cell_size(&self) -> Vec3 {
        (self.high - self.low) / self.size.as_vec3()
    }

    /// First cell of each first-level cell's second-level grid, or [`NONE`]; x fastest.
    pub fn second(&self) -> &[u32] {
        &self.second
    }

    /// All cells: the first level (x fastest), then each second-level grid.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Where the samples are.
    pub fn places(&self) -> &[SamplePlace] {
        &self.places
    }

    /// Cells that lookups end in: all but those of the first level that are refined.
    pub(super) fn ends(&self) -> impl Iterator<Item = u32> + '_ {
        let refined = |&cell: &u32| self.second.get(cell as usize).is_some_and(|s| *s != NONE);
        (0..self.cells.len() as u32).filter(move |cell| !refined(cell))
    }

    /// Middle of an eighth of a cell, 8 × cell + corner, m.
    pub(super) fn middle_of_eighth(&self, eighth: u32) -> Vec3 {
        let [low, high] = self.box_of(eighth / 8);
        let corner = Vec3::from_array([1, 2, 4].map(|bit| if eighth & bit == 0 { 0.25 } else { 0.75 }));
        low + corner * (high - low)
    }

    /// Puts samples into the middles of eighths of cells that have none, given in order.
    ///
    /// # Panics
    /// If there are some already, or if they are not in order.
    pub(super) fn add_pockets(&mut self, eighths: &[u32]) {
        assert!(self.pockets.is_empty() && eighths.is_sorted(), "added once and in order");
        for &eighth in eighths {
            self.pockets.push((eighth, self.places.len() as u32));
            let position = self.middle_of_eighth(eighth);
            self.places.push(SamplePlace { position, level: POCKET_LEVEL });
        }
    }

    /// Eighths of cells with a sample of their own, 8 × cell + corner, in order.
    pub(super) fn pockets(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.pockets.iter().map(|p| p.0)
    }

    /// The sample of its own of the eighth of a cell that holds a point.
    pub fn pocket(&self, cell: u32, point: Vec3) -> Option<u32> {
        if self.pockets.is_empty() {
            return None;
        }
        let [low, high] = self.box_of(cell);
        let eighth = 8 * cell + point.cmpgt(0.5 * (low + high)).bitmask();
        self.pockets.binary_search_by_key(&eighth, |p| p.0).ok().map(|i| self.pockets[i].1)
    }

    /// Samples of their own of all eighths of a cell.
    pub(super) fn pockets_of(&self, cell: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.pockets.partition_point(|p| p.0 < 8 * cell);
        self.pockets[first..].iter().take_while(move |p| p.0 < 8 * cell + 8).map(|p| p.1)
    }

    /// Corners of a cell's box, m.
    fn box_of(&self, cell: u32) -> [Vec3; 2] {
        let corners = self.cells[cell as usize].samples;
        [0, 7].map(|i| self.places[corners[i] as usize].position)
    }

    /// Number of second-level grids.
    pub fn second_level_grids(&self) -> usize {
        self.second.iter().filter(|&&s| s != NONE).count()
    }

    /// Marks in every cell which of its samples may be used.
    pub fn set_valid(&mut self, valid: &[bool]) {
        for cell in &mut self.cells {
            cell.valid = (0..8).fold(0, |m, i| m | (u8::from(valid[cell.samples[i] as usize]) << i));
        }
    }

    /// The cell that holds a point, and where in it: Greger Eq. 4.4 to 4.6, at the first level and
    /// then, where there is one, at the second. A point outside is moved to the nearest one inside.
    pub fn locate(&self, point: Vec3) -> Location {
        self.locate_each(&point.to_array().map(|p| [p])).of(0)
    }

    /// As [`Self::locate`] for points given axis by axis, so that the arithmetic runs over vectors. Numbers of
    /// cells stay floats until the last: 200 cells an axis are exact.
    #[inline]
    pub(super) fn locate_each<const N: usize>(&self, points: &[[f32; N]; 3]) -> Locations<N> {
        let (size, inner) = (self.size.as_vec3(), Vec3::splat(self.inner as f32));
        let (mut at, mut offset) = ([[0.0; N]; 3], [[0.0; N]; 3]);
        for axis in 0..3 {
            let (low, scale) = (self.low[axis], self.scale[axis]);
            for i in 0..N {
                (at[axis][i], offset[axis][i]) = along((points[axis][i] - low) * scale, size[axis]);
            }
        }
        let number = |at: &[[f32; N]; 3], size: Vec3| -> [u32; N] {
            std::array::from_fn(|i| ((at[2][i] * size.y + at[1][i]) * size.x + at[0][i]) as u32)
        };
        let first = number(&at, size);
        let second = first.map(|cell| self.second[cell as usize]);
        for axis in 0..3 {
            for i in 0..N {
                let (within, fine) = along(offset[axis][i] * inner.x, inner.x);
                at[axis][i] = within;
                offset[axis][i] = if second[i] == NONE { offset[axis][i] } else { fine };
            }
        }
        let within = number(&at, inner);
        let cell = std::array::from_fn(|i| if second[i] == NONE { first[i] } else { second[i] + within[i] });
        Locations { cell, offset, refined: second.map(|s| s != NONE) }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.second[..])
            + size_of_val(&self.cells[..])
            + size_of_val(&self.places[..])
            + size_of_val(&self.pockets[..])
    }
}

/// Weights of a cell's eight corners at an offset: products of o and 1 − o; they sum to 1.
#[inline(always)]
pub fn trilinear(o: Vec3) -> [f32; 8] {
    // Of all corners at once: 1 − o where a corner is the low one of an axis, and o.
    let along = |o: f32, sign: [f32; 8]| {
        let sign = f32x8::new(sign);
        let low = sign.simd_lt(f32x8::ZERO).select(f32x8::ONE, f32x8::ZERO);
        sign.mul_add(f32x8::splat(o), low)
    };
    let x = along(o.x, [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0]);
    let y = along(o.y, [-1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0]);
    let z = along(o.z, [-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0]);
    (x * (y * z)).to_array()
}

/// Which first-level cells of a grid hold any of the triangles, x fastest.
pub fn cells_with_geometry(low: Vec3, high: Vec3, size: UVec3, triangles: &[[Vec3; 3]]) -> Vec<bool> {
    let cell = (high - low) / size.as_vec3();
    let last = size.as_ivec3() - IVec3::ONE;
    let reached = |triangle: &[Vec3; 3]| {
        let (a, b) = bounds(triangle);
        let from = ((a - low) / cell).floor().as_ivec3().clamp(IVec3::ZERO, last);
        let to = ((b - low) / cell).floor().as_ivec3().min(last);
        let mut found = Vec::new();
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                for x in from.x..=to.x {
                    let at = UVec3::new(x as u32, y as u32, z as u32);
                    let centre = low + (at.as_vec3() + Vec3::splat(0.5)) * cell;
                    if triangle_meets_box(*triangle, centre, 0.5 * cell) {
                        found.push((at.z * size.y + at.y) * size.x + at.x);
                    }
                }
            }
        }
        found
    };
    let lists: Vec<Vec<u32>> =
        triangles.par_chunks(4096).map(|chunk| chunk.iter().flat_map(reached).collect()).collect();
    let mut flags = vec![false; size.element_product() as usize];
    for c in lists.into_iter().flatten() {
        flags[c as usize] = true;
    }
    flags
}

fn bounds(triangle: &[Vec3; 3]) -> (Vec3, Vec3) {
    let [a, b, c] = *triangle;
    (a.min(b).min(c), a.max(b).max(c))
}

/// Cell number and fractional offset of Eq. 4.5 and 4.6, clamped to the grid; NaN counts as 0.
#[inline(always)]
fn along(q: f32, cells: f32) -> (f32, f32) {
    let q = clamped(q, cells);
    let cell = clamped(q.floor(), cells - 1.0);
    (cell, q - cell)
}

/// Place of a number in a box of so many, x fastest.
pub(super) fn unflatten(index: u32, size: UVec3) -> UVec3 {
    UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y))
}

/// The fine lattice that both levels' samples lie on.
struct Lattice {
    low: Vec3,
    step: Vec3,
    size: UVec3,
    sample: Vec<u32>,
    places: Vec<SamplePlace>,
}

impl Lattice {
    fn new(low: Vec3, high: Vec3, steps: UVec3) -> Self {
        let size = steps + UVec3::ONE;
        let sample = vec![NONE; size.element_product() as usize];
        Self { low, step: (high - low) / steps.as_vec3(), size, sample, places: Vec::new() }
    }

    fn sample(&mut self, at: UVec3, level: u8) -> u32 {
        let slot = ((at.z * self.size.y + at.y) * self.size.x + at.x) as usize;
        if self.sample[slot] == NONE {
            self.sample[slot] = self.places.len() as u32;
            self.places.push(SamplePlace { position: self.low + at.as_vec3() * self.step, level });
        }
        self.sample[slot]
    }

    fn cell(&mut self, origin: UVec3, edge: u32) -> Cell {
        let samples = std::array::from_fn(|i| {
            let corner = UVec3::new(i as u32 & 1, i as u32 >> 1 & 1, i as u32 >> 2);
            self.sample(origin + corner * edge, 2)
        });
        Cell { samples, valid: u8::MAX }
    }
}
