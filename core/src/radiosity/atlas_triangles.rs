//! Triangles that are lit at their corners, as charts of an atlas: right triangles, two to a rectangle.
//!
//! The corner across the longest edge is the right angle; its legs have a texel a spacing, at least one, more where
//! that keeps their proportion. The second triangle is the first turned by 180°. Corners lie on middles of texels and
//! light is linear between them, so that bilinear lookup gives what the solver does: texels beyond the diagonal that
//! a lookup inside reaches continue the plane, cut off at zero.
//!
//! Not two neighbours that share a diagonal: texels on it would be of both, and rounding would make them overlap.
//! Limit: a triangle much smaller than the spacing takes 2 × 2 texels and its padding all the same.

use super::lookup::SideMap;
use crate::scene::geometry::Geometry;
use glam::{IVec2, UVec2, Vec2, Vec3};

/// Texels along a leg, at most.
const MOST_TEXELS: u32 = 1024;
/// Texels up to which a leg grows for its proportion to the other.
const PROPORTION: f32 = 8.0;

/// A triangle on its chart.
#[derive(Clone, Copy, Debug)]
struct Legs {
    triangle: u32,
    /// Corner of the right angle; the next one lies down from it, the one after to its right.
    right_angle: usize,
    /// Texels from the right angle to the right and down.
    texels: UVec2,
}

/// One or two triangles with the same legs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    first: Legs,
    second: Option<Legs>,
}

/// A pair with the light at its corners: at the right angle, to its right and down from it.
pub(super) struct LitPair {
    pair: Pair,
    light: [[Vec3; 3]; 2],
}

impl Pair {
    /// Pairs of all triangles whose fronts are lit at their corners.
    pub fn all(geometry: &Geometry, fronts: &[SideMap], spacing_m: f32) -> Vec<Self> {
        let lit = fronts.iter().zip(0u32..).filter(|(side, _)| **side != SideMap::NONE && side.size == 0);
        let mut legs: Vec<Legs> = lit.map(|(_, t)| Legs::new(geometry, t, spacing_m)).collect();
        legs.sort_by_key(|l| (l.texels.y, l.texels.x, l.triangle));
        let alike = legs.chunk_by(|a, b| a.texels == b.texels);
        alike
            .flat_map(|same| same.chunks(2))
            .map(|p| Self { first: p[0], second: p.get(1).copied() })
            .collect()
    }

    /// Texels of its rectangle, with twice the padding between the two.
    pub fn size(&self, padding: u32) -> UVec2 {
        let legs = self.first.texels;
        let widest = (0..=legs.y).map(|row| last(legs, row) + last(legs, legs.y - row)).max().unwrap_or(0);
        let width = if self.second.is_some() { widest + 2 + 2 * padding } else { legs.x + 1 };
        UVec2::new(width, legs.y + 1)
    }

    /// Each triangle with its corners, in texels from the middle of the rectangle's first.
    pub fn corners(&self, padding: u32) -> impl Iterator<Item = (u32, [Vec2; 3])> + use<> {
        let end = (self.size(padding) - 1).as_vec2();
        let second = self.second.map(|l| (l.triangle, l.corners().map(|c| end - c)));
        std::iter::once((self.first.triangle, self.first.corners())).chain(second)
    }

    /// The pair in the light of its triangles' corners, lx.
    pub fn lit(&self, light: impl Fn(u32) -> [Vec3; 3]) -> LitPair {
        let of = |legs: Legs| {
            let light = light(legs.triangle);
            [0, 2, 1].map(|next| light[(legs.right_angle + next) % 3])
        };
        LitPair { pair: *self, light: [of(self.first), self.second.map_or([Vec3::ZERO; 3], of)] }
    }
}

impl Legs {
    fn new(geometry: &Geometry, triangle: u32, spacing_m: f32) -> Self {
        let p = geometry.positions[triangle as usize];
        let edge = |i: usize| p[(i + 1) % 3].distance(p[(i + 2) % 3]);
        let right_angle = (1..3).fold(0, |best, i| if edge(i) > edge(best) { i } else { best });
        let lengths = [2, 1].map(|next| p[(right_angle + next) % 3].distance(p[right_angle]));
        let shorter = lengths[0].min(lengths[1]).max(f32::MIN_POSITIVE);
        let texels = lengths.map(|length| {
            let plain = (length / spacing_m).ceil();
            (length / shorter.min(spacing_m)).round().min(plain.max(PROPORTION)).max(1.0) as u32
        });
        Self { triangle, right_angle, texels: UVec2::from(texels.map(|n| n.min(MOST_TEXELS))) }
    }

    fn corners(&self) -> [Vec2; 3] {
        let mut corners = [Vec2::ZERO; 3];
        corners[(self.right_angle + 1) % 3].y = self.texels.y as f32;
        corners[(self.right_angle + 2) % 3].x = self.texels.x as f32;
        corners
    }
}

/// The last texel of a row that bilinear lookup inside a right triangle reaches.
fn last(legs: UVec2, row: u32) -> u32 {
    (legs.x * (legs.y - row.saturating_sub(1))).div_ceil(legs.y)
}

impl LitPair {
    /// Light of a texel of the rectangle or of the padding around it, lx.
    pub fn texel(&self, at: IVec2, padding: u32) -> Vec3 {
        let legs = self.pair.first.texels;
        let row = |y: i32| y.clamp(0, legs.y as i32) as u32;
        let own = self.pair.second.is_none() || at.x <= (last(legs, row(at.y)) + padding) as i32;
        let end = (self.pair.size(padding) - 1).as_ivec2();
        let (at, [corner, right, down]) = if own { (at, self.light[0]) } else { (end - at, self.light[1]) };
        let mut share = at.as_vec2() / legs.as_vec2();
        let reached = at.min_element() >= 0 && at.y <= legs.y as i32 && at.x <= last(legs, row(at.y)) as i32;
        if !reached {
            share = share.max(Vec2::ZERO);
            share /= share.element_sum().max(1.0);
        }
        (corner + (right - corner) * share.x + (down - corner) * share.y).max(Vec3::ZERO)
    }
}
