//! From a point on a triangle to the elements that light it.
//!
//! One record a triangle and side, no chart table and no world position: a triangle carries the
//! grid coordinates of its own corners, so the answer does not change when its object moves. The
//! function is small and in `f32` because the shading kernel has its twin.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;

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
    let (u, v) = (barycentric.x, barycentric.y);
    let w = 1.0 - u - v;
    let c = side.corners;
    if side.size == 0 {
        return ElementBlend { elements: [c[0], c[1], c[2], c[2]], weights: [w, u, v, 0.0] };
    }
    let (nx, ny) = (side.size & 0xFFFF, side.size >> 16);
    let f = f32::from_bits;
    let x = (f(c[0]) * w + f(c[2]) * u + f(c[4]) * v).clamp(0.0, (nx - 1) as f32);
    let y = (f(c[1]) * w + f(c[3]) * u + f(c[5]) * v).clamp(0.0, (ny - 1) as f32);
    let (x0, y0) = ((x as u32).min(nx.max(2) - 2), (y as u32).min(ny.max(2) - 2));
    let (x1, y1) = ((x0 + 1).min(nx - 1), (y0 + 1).min(ny - 1));
    let (fx, fy) = (x - x0 as f32, y - y0 as f32);
    ElementBlend {
        elements: [
            side.first + y0 * nx + x0,
            side.first + y0 * nx + x1,
            side.first + y1 * nx + x0,
            side.first + y1 * nx + x1,
        ],
        weights: [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy],
    }
}

impl ElementBlend {
    /// Weighted sum of a value an element.
    pub fn sum(&self, values: &[glam::Vec3]) -> glam::Vec3 {
        let mut sum = glam::Vec3::ZERO;
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
