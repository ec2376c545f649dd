//! From a point on a triangle to the elements that light it.
//!
//! One record a triangle and side, no chart table and no world position: a triangle carries the
//! grid coordinates of its own corners, so the answer does not change when its object moves. The
//! function is small and in `f32` because the shading kernel has its twin.
//!
//! Light is looked up bilinearly wherever it is solved with. Pictures may ask for [`Lookup::Mitchell`]: the
//! 4 × 4 nodes around a point instead of 2 × 2, for no creases along the lines of nodes.

pub use crate::scene::lookup::Lookup;

use super::{
    surface_map::{BURIED, Element},
    texture::display::mitchell_weights,
};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};

/// [`SideMap::first`] of a side that has no elements: the black back of a single-sided surface.
pub const NO_ELEMENTS: u32 = u32::MAX;

/// Where the elements of one side of one triangle are. Record `2 · triangle + back` of the table.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct SideMap {
    /// First element of the grid; 0 for vertex elements; [`NO_ELEMENTS`] for none.
    pub first: u32,
    /// Grid nodes along u in the low, along v in the high 16 bits; 0 for vertex elements.
    pub size: u32,
    /// A grid: bits of the `f32` grid coordinates (u, v) of corners 0, 1, 2, in nodes.
    /// Vertex elements: the three element numbers, then zeros.
    pub corners: [u32; 6],
}

impl SideMap {
    /// A side without elements.
    pub const NONE: Self = Self { first: NO_ELEMENTS, size: 0, corners: [0; 6] };

    /// A side whose elements are a grid of `nx` × `ny` nodes.
    pub fn grid(first: u32, nx: u32, ny: u32, corners: [Vec2; 3]) -> Self {
        let [a, b, c] = corners;
        Self { first, size: nx | (ny << 16), corners: [a.x, a.y, b.x, b.y, c.x, c.y].map(f32::to_bits) }
    }

    /// A side with one element a corner.
    pub fn vertices([a, b, c]: [u32; 3]) -> Self {
        Self { first: 0, size: 0, corners: [a, b, c, 0, 0, 0] }
    }

    /// The grid's cell at barycentric weights; coordinates outside the grid are clamped to it.
    fn cell(&self, barycentric: Vec2) -> Cell {
        let (u, v) = (barycentric.x, barycentric.y);
        let w = 1.0 - u - v;
        let c = self.corners.map(f32::from_bits);
        let size = UVec2::new(self.size & 0xFFFF, self.size >> 16);
        let last = size - 1;
        let at = Vec2::new(c[0] * w + c[2] * u + c[4] * v, c[1] * w + c[3] * u + c[5] * v)
            .clamp(Vec2::ZERO, last.as_vec2());
        let low = at.as_uvec2().min(size.max(UVec2::splat(2)) - 2);
        Cell { size, low, high: (low + 1).min(last), at: at - low.as_vec2() }
    }
}

/// A cell of a grid and a point in it.
struct Cell {
    /// Nodes of the grid.
    size: UVec2,
    /// Node at its lower corner.
    low: UVec2,
    /// Node at its upper corner: the lower one where the grid is a single node wide.
    high: UVec2,
    /// Place between the two, 0 to 1.
    at: Vec2,
}

/// Elements and their weights; the weights sum to 1, or are all 0 where there is nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementBlend {
    /// Element numbers.
    pub elements: [u32; 4],
    /// Weights.
    pub weights: [f32; 4],
}

/// Elements and weights at barycentric weights (of corners 1 and 2) on a side.
///
/// Bilinear between the four nodes of the grid cell, or barycentric between the three vertex
/// elements. Coordinates outside the grid are clamped to it.
pub fn blend(side: &SideMap, barycentric: Vec2) -> ElementBlend {
    if side.first == NO_ELEMENTS {
        return ElementBlend::default();
    }
    if side.size == 0 {
        let (c, Vec2 { x: u, y: v }) = (side.corners, barycentric);
        return ElementBlend { elements: [c[0], c[1], c[2], c[2]], weights: [1.0 - u - v, u, v, 0.0] };
    }
    let Cell { size: UVec2 { x: nx, .. }, low, high, at } = side.cell(barycentric);
    let first = |y: u32| side.first + y * nx;
    ElementBlend {
        elements: [
            first(low.y) + low.x,
            first(low.y) + high.x,
            first(high.y) + low.x,
            first(high.y) + high.x,
        ],
        weights: [(1.0 - at.x) * (1.0 - at.y), at.x * (1.0 - at.y), (1.0 - at.x) * at.y, at.x * at.y],
    }
}

/// Sums of values an element at barycentric weights on a side, by Mitchell and Netravali's filter: over the
/// 4 × 4 nodes around a point of a grid, of which the outermost stand again beyond its border. Vertex elements
/// blend as in [`blend`].
///
/// The four nodes around the point are taken as they are; of the twelve beyond, those under something that
/// stands on the surface ([`BURIED`]) are dark and would show as a halo beside it: the nearest of the four stands
/// for each. The negative lobes may take a sum below zero beside a bright node; it is cut off there.
pub fn mitchell<const N: usize>(
    side: &SideMap,
    barycentric: Vec2,
    elements: &[Element],
    values: [&[Vec3]; N],
) -> [Vec3; N] {
    if side.first == NO_ELEMENTS || side.size == 0 {
        let blend = blend(side, barycentric);
        return values.map(|v| blend.sum(v));
    }
    let Cell { size, low, high, at } = side.cell(barycentric);
    let columns = [low.x.max(1) - 1, low.x, high.x, (high.x + 1).min(size.x - 1)];
    let rows = [low.y.max(1) - 1, low.y, high.y, (high.y + 1).min(size.y - 1)];
    let (across, down) = (mitchell_weights(at.x), mitchell_weights(at.y));
    let mut sums = [Vec3::ZERO; N];
    for (j, row) in rows.into_iter().enumerate() {
        for (i, column) in columns.into_iter().enumerate() {
            let node = side.first + row * size.x + column;
            let dark = elements[node as usize].flags & BURIED != 0;
            let node =
                if dark { side.first + rows[j.clamp(1, 2)] * size.x + columns[i.clamp(1, 2)] } else { node };
            for (sum, values) in sums.iter_mut().zip(values) {
                *sum += values[node as usize] * (across[i] * down[j]);
            }
        }
    }
    sums.map(|sum| sum.max(Vec3::ZERO))
}

impl ElementBlend {
    /// Weighted sum of a value an element.
    pub fn sum(&self, values: &[Vec3]) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for (&element, &weight) in self.elements.iter().zip(&self.weights) {
            if weight != 0.0 {
                sum += values[element as usize] * weight;
            }
        }
        sum
    }

    /// The element with the largest weight, or [`NO_ELEMENTS`].
    pub fn nearest(&self) -> u32 {
        let mut best = (NO_ELEMENTS, 0.0);
        for (&element, &weight) in self.elements.iter().zip(&self.weights) {
            if weight > best.1 {
                best = (element, weight);
            }
        }
        best.0
    }

    /// One element drawn with its weight as probability, from `xi` in [0, 1), or [`NO_ELEMENTS`].
    pub fn draw(&self, xi: f32) -> u32 {
        let mut sum = 0.0;
        for (&element, &weight) in self.elements.iter().zip(&self.weights) {
            sum += weight;
            if xi < sum {
                return element;
            }
        }
        self.nearest()
    }
}
