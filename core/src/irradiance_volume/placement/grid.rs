//! Where illuminance is measured: points on a plane, or on the top of an object.

use crate::scene::{MeasuringPlane, geometry::Geometry};
use glam::{Vec2, Vec3};

/// Largest number of points an axis.
pub const MOST_POINTS: u32 = 200;

/// Cosine of the steepest slope that still is a top.
const LEVEL: f32 = 0.94;

/// Surfaces whose heights differ by less belong to one top, m.
const SAME_HEIGHT_M: f32 = 0.005;

/// Points in the middles of the cells of a grid over a rectangle.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuringGrid {
    /// Corner of the rectangle, m.
    pub corner: Vec3,
    /// First edge, m.
    pub edge_u: Vec3,
    /// Second edge, m.
    pub edge_v: Vec3,
    /// Unit normal of the side that is measured, `edge_u × edge_v`.
    pub normal: Vec3,
    /// Cells along the first edge.
    pub nx: u32,
    /// Cells along the second edge.
    pub ny: u32,
    /// Points row by row, the first edge fastest; `None` where there is nothing to measure.
    pub points: Vec<Option<Vec3>>,
    /// The object whose top it is.
    pub object: Option<u32>,
}

/// Largest distance between points on a field whose longer side is `longer_m`, m:
/// p = 0.2 · 5^(log₁₀ d), at most 10 m (EN 12464-1:2011, 4.4).
pub fn standard_spacing_m(longer_m: f32) -> f32 {
    (0.2 * 5f32.powf(longer_m.max(1e-3).log10())).min(10.0)
}

/// Cells along each edge: as many as the standard asks for, times `finer`.
fn cells(u_m: f32, v_m: f32, finer: u32) -> [u32; 2] {
    let spacing = standard_spacing_m(u_m.max(v_m));
    // A whole number of steps that rounding makes a little more of stays that number.
    [u_m, v_m].map(|d| (((d / spacing - 1e-3).ceil() as u32).max(2) * finer.max(1)).min(MOST_POINTS))
}

impl MeasuringGrid {
    /// A grid over a plane, `finer` times as fine along each edge as EN 12464-1 asks for.
    pub fn on_plane(plane: &MeasuringPlane, finer: u32) -> Self {
        let [nx, ny] = cells(plane.edge_u.length(), plane.edge_v.length(), finer);
        let mut grid = Self {
            corner: plane.corner,
            edge_u: plane.edge_u,
            edge_v: plane.edge_v,
            normal: plane.edge_u.cross(plane.edge_v).normalize_or(Vec3::Y),
            nx,
            ny,
            points: Vec::new(),
            object: None,
        };
        grid.points = (0..nx * ny).map(|i| Some(grid.middle(i % nx, i / nx))).collect();
        grid
    }

    /// A grid over the top of an object: of its level surfaces that face up, the height that has the
    /// largest area (the seat of a chair, the plate of a desk). `None` where nothing faces up.
    ///
    /// The rectangle is turned as the object is; its points lie on the surface.
    pub fn on_top(geometry: &Geometry, object: usize, finer: u32) -> Option<Self> {
        let top = top_triangles(geometry, object)?;
        let axis = Vec3::from(geometry.world_from_object[object].matrix3.x_axis);
        let u = Vec3::new(axis.x, 0.0, axis.z).normalize_or(Vec3::X);
        let v = Vec3::Y.cross(u);
        let corners: Vec<[Vec3; 3]> = top.iter().map(|&t| geometry.positions[t as usize]).collect();
        let flat = |p: Vec3| Vec2::new(p.dot(u), p.dot(v));
        let (mut low, mut high, mut height) = (Vec2::INFINITY, Vec2::NEG_INFINITY, f32::NEG_INFINITY);
        for p in corners.iter().flatten() {
            (low, high, height) = (low.min(flat(*p)), high.max(flat(*p)), height.max(p.y));
        }
        let size = high - low;
        let [nx, ny] = cells(size.x, size.y, finer);
        let mut grid = Self {
            corner: u * low.x + v * low.y + Vec3::Y * height,
            edge_u: u * size.x,
            edge_v: v * size.y,
            normal: Vec3::Y,
            nx,
            ny,
            points: Vec::new(),
            object: Some(object as u32),
        };
        grid.points = (0..nx * ny)
            .map(|i| {
                let middle = grid.middle(i % nx, i / nx);
                let heights = corners.iter().filter_map(|t| height_in(t.map(flat), t, flat(middle)));
                heights.reduce(f32::max).map(|y| Vec3::new(middle.x, y, middle.z))
            })
            .collect();
        Some(grid)
    }

    /// Middle of a cell, m.
    pub fn middle(&self, i: u32, j: u32) -> Vec3 {
        let share = |i: u32, n: u32| (i as f32 + 0.5) / n as f32;
        self.corner + self.edge_u * share(i, self.nx) + self.edge_v * share(j, self.ny)
    }

    /// Distances between points along the two edges, m.
    pub fn spacing_m(&self) -> [f32; 2] {
        [self.edge_u.length() / self.nx as f32, self.edge_v.length() / self.ny as f32]
    }
}

/// Triangles of the level surface of the largest area that faces up.
fn top_triangles(geometry: &Geometry, object: usize) -> Option<Vec<u32>> {
    let mut level: Vec<(f32, f32, u32)> = geometry
        .object_triangles
        .get(object)?
        .clone()
        .filter_map(|t| {
            let normal = geometry.area_normal(t);
            let [a, b, c] = geometry.positions[t as usize];
            let up = normal.y > LEVEL * normal.length() && normal.y > 0.0;
            up.then_some(((a.y + b.y + c.y) / 3.0, 0.5 * normal.length(), t))
        })
        .collect();
    level.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    let groups = level.chunk_by(|a, b| b.0 - a.0 < SAME_HEIGHT_M);
    let area = |group: &[(f32, f32, u32)]| group.iter().map(|t| t.1).sum::<f32>();
    let largest = groups.max_by(|a, b| area(a).total_cmp(&area(b)))?;
    Some(largest.iter().map(|t| t.2).collect())
}

/// Height of a triangle above a point of the ground plane; `None` beside it.
fn height_in([a, b, c]: [Vec2; 3], corners: &[Vec3; 3], at: Vec2) -> Option<f32> {
    let whole = (b - a).perp_dot(c - a);
    let (v, w) = ((at - a).perp_dot(c - a) / whole, (b - a).perp_dot(at - a) / whole);
    // Points on the seam of two triangles belong to both rather than to none.
    let inside = v >= -1e-4 && w >= -1e-4 && v + w <= 1.0 + 1e-4;
    inside.then(|| corners[0].y * (1.0 - v - w) + corners[1].y * v + corners[2].y * w)
}
