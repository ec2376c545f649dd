//! What stands in the way of samples.
//!
//! A cell whose box no standing triangle meets is convex and empty, so all its samples see all its points. In
//! any other cell what is seen from where is found by rays, once for each of its leaves (`sight`), and remembered.

use super::{
    Sample,
    grid::{BilevelGrid, NONE, unflatten},
    overlap::triangle_meets_box,
    sight::{Look, Sight},
    trust::SampleState,
};
use crate::{
    math::sphere_map::DirectionBins,
    scene::{
        accel::{Accel, Blockers, Ray},
        world::World,
    },
};
use glam::{UVec3, Vec3};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// First-level cells beyond the grid within which its samples are asked whether they see a point: where walls
/// are, since the grid keeps a little away from them.
pub(super) const MARGIN: f32 = 0.25;

/// A cell as the guard knows it.
#[derive(Default)]
struct Watched {
    /// Corner of the cell, at the grid's border moved outwards by [`MARGIN`].
    low: Vec3,
    /// The corner opposite.
    high: Vec3,
    /// Standing triangles that meet the box.
    triangles: Vec<u32>,
    sight: OnceLock<Sight>,
}

/// What stands in the way of samples.
#[derive(Clone)]
pub struct Guard {
    standing: Arc<Accel>,
    triangles: Arc<Vec<[Vec3; 3]>>,
    cells: Arc<Vec<Watched>>,
    /// Whether nothing stands in a cell and its samples are at its corners.
    open: Arc<Vec<bool>>,
    /// For each first-level cell the valid samples in it and around it, found when first asked.
    pub(super) near: Arc<Vec<OnceLock<Vec<u32>>>>,
}

impl std::fmt::Debug for Guard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Guard of {} cells", self.cells.len())
    }
}

/// Rows of bins a hemisphere in whose directions two places are compared.
const COMPARED_N: u32 = 4;

/// Share of the directions in which two places must see the same for one to speak for the other.
const ALIKE: f32 = 0.75;

impl Guard {
    /// Of what stands still in a world.
    pub(super) fn new(world: &World, grid: &BilevelGrid, samples: &[Sample]) -> Self {
        let geometry = &world.geometry;
        let triangles: Vec<[Vec3; 3]> = (0..geometry.len())
            .filter(|&t| !geometry.movable[geometry.object[t] as usize])
            .map(|t| geometry.positions[t])
            .collect();
        let mut cells = boxes(grid);
        let at_corners = |id: &u32| samples[*id as usize].state != SampleState::Relocated;
        let mut open: Vec<bool> = grid.cells().iter().map(|c| c.samples.iter().all(at_corners)).collect();
        let meetings: Vec<Vec<Meeting>> = triangles
            .par_chunks(1024)
            .enumerate()
            .map(|(chunk, triangles)| {
                let mut met = Vec::new();
                for (triangle, i) in triangles.iter().zip(1024 * chunk as u32..) {
                    meet(grid, &cells, i, triangle, &mut met);
                }
                met
            })
            .collect();
        for Meeting { cell, triangle, within } in meetings.into_iter().flatten() {
            cells[cell as usize].triangles.push(triangle);
            open[cell as usize] &= !within;
        }
        Self {
            standing: Arc::new(world.accel.standing()),
            triangles: Arc::new(triangles),
            cells: Arc::new(cells),
            open: Arc::new(open),
            near: Arc::new(grid.second().iter().map(|_| OnceLock::new()).collect()),
        }
    }

    /// Whether all samples of a cell see all of it.
    #[inline(always)]
    pub(super) fn is_open(&self, cell: u32) -> bool {
        self.open[cell as usize]
    }

    /// Bytes held by now, without the tree that rays are asked of: it is the scene's.
    pub(super) fn bytes(&self) -> usize {
        let of = |cell: &Watched| {
            size_of::<Watched>()
                + size_of_val(&cell.triangles[..])
                + cell.sight.get().map_or(0, |s| s.bytes())
        };
        let near =
            |near: &OnceLock<Vec<u32>>| size_of_val(near) + near.get().map_or(0, |n| size_of_val(&n[..]));
        size_of_val(&self.triangles[..])
            + size_of_val(&self.open[..])
            + self.near.iter().map(near).sum::<usize>()
            + self.cells.iter().map(of).sum::<usize>()
    }

    /// What is known of a point of a cell or beside it; `find` tells what holds at a place, where nobody asked
    /// before.
    #[inline]
    pub(super) fn look(&self, cell: u32, point: Vec3, find: impl Fn(Vec3) -> Look) -> Look {
        let watched = &self.cells[cell as usize];
        let sight = watched.sight.get_or_init(|| {
            let triangles: Vec<_> = watched.triangles.iter().map(|&t| self.triangles[t as usize]).collect();
            Sight::new([watched.low, watched.high], &triangles)
        });
        sight.look(point, find)
    }

    /// What was found before of a point of a cell, if anything was.
    #[inline(always)]
    pub(super) fn known(&self, cell: u32, point: Vec3) -> Look {
        self.cells[cell as usize].sight.get().map_or(Look::Ask, |sight| sight.known(point))
    }

    /// Whether nothing that stands lies between a sample and a point, ends not counted; what hides one
    /// sample of a point is asked first about the next.
    pub(super) fn sees(&self, sample: Vec3, point: Vec3, blockers: &mut Blockers) -> bool {
        // From the sample: the ray stops just short of the point, which may lie on a surface.
        let ray = Ray::between(sample, point);
        ray.is_degenerate() || !self.standing.occluded_past(&ray, blockers)
    }

    /// Whether two places see the same, mostly: in a direction they do where what they see lies no more than twice
    /// as far apart as they do.
    pub(super) fn alike(&self, a: Vec3, b: Vec3) -> bool {
        let bins = DirectionBins::new(COMPARED_N);
        let shift = b - a;
        let apart = |bin: usize| {
            let direction = bins.centre(bin);
            let [a, b] = [a, b].map(|p| self.standing.trace(&Ray::new(p, direction)).map(|hit| hit.t));
            let (Some(a), Some(b)) = (a, b) else { return a.is_some() != b.is_some() };
            (shift + direction * (b - a)).length_squared() > 4.0 * shift.length_squared()
        };
        let apart = (0..bins.len()).filter(|&bin| apart(bin)).count();
        apart as f32 <= (1.0 - ALIKE) * bins.len() as f32
    }
}

/// Boxes of the cells that lookups end in; those of refined cells stay empty.
fn boxes(grid: &BilevelGrid) -> Vec<Watched> {
    let (low, high) = grid.bounds();
    let margin = MARGIN * grid.cell_size();
    let mut cells: Vec<Watched> = grid.cells().iter().map(|_| Watched::default()).collect();
    let mut put = |cell: u32, at: UVec3, parts: u32| {
        let corner = |at: UVec3| low + at.as_vec3() / parts as f32 * grid.cell_size();
        let size = (grid.size() * parts).as_vec3();
        let (first, last) = (at.as_vec3().cmpeq(Vec3::ZERO), (at + 1).as_vec3().cmpeq(size));
        let watched = &mut cells[cell as usize];
        watched.low = Vec3::select(first, low - margin, corner(at));
        watched.high = Vec3::select(last, high + margin, corner(at + 1));
    };
    let inner = grid.inner();
    for (c, &second) in (0..).zip(grid.second()) {
        let at = unflatten(c, grid.size());
        if second == NONE {
            put(c, at, 1);
            continue;
        }
        for s in 0..inner.pow(3) {
            put(second + s, at * inner + unflatten(s, UVec3::splat(inner)), inner);
        }
    }
    cells
}

/// A triangle that meets a cell's box, and whether it meets the cell itself.
struct Meeting {
    cell: u32,
    triangle: u32,
    within: bool,
}

/// The cells whose boxes a triangle meets.
fn meet(grid: &BilevelGrid, cells: &[Watched], number: u32, triangle: &[Vec3; 3], met: &mut Vec<Meeting>) {
    let [a, b, c] = *triangle;
    let (from, to) = (a.min(b).min(c), a.max(b).max(c));
    let (low, high) = grid.bounds();
    let last = grid.size() - 1;
    let cell_at = |p: Vec3| ((p - low) / grid.cell_size()).max(Vec3::ZERO).as_uvec3().min(last);
    let (first, end) = (cell_at(from), cell_at(to));
    for z in first.z..=end.z {
        for y in first.y..=end.y {
            for x in first.x..=end.x {
                let c = (z * grid.size().y + y) * grid.size().x + x;
                let second = grid.second()[c as usize];
                let parts = if second == NONE { c..c + 1 } else { second..second + grid.inner().pow(3) };
                for cell in parts {
                    let watched = &cells[cell as usize];
                    let meets = |low: Vec3, high: Vec3| {
                        (from.cmple(high) & to.cmpge(low)).all()
                            && triangle_meets_box(*triangle, 0.5 * (low + high), 0.5 * (high - low))
                    };
                    if meets(watched.low, watched.high) {
                        let within = meets(watched.low.max(low), watched.high.min(high));
                        met.push(Meeting { cell, triangle: number, within });
                    }
                }
            }
        }
    }
}
