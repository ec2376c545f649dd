//! From a direction to the bins that answer for it, quickly.
//!
//! The same map as [`DirectionBins::square`], with a polynomial in place of the arc tangent, and the
//! four bins around each corner of the bin grid in a table that fits the first-level cache.

use crate::math::sphere_map::DirectionBins;
use glam::{Vec2, Vec3};

/// Bins and their weights for one direction; the weights sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinWeights {
    /// Bin numbers.
    pub bins: [u16; 4],
    /// Their weights.
    pub weights: [f32; 4],
}

/// Lookup of bins by direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    bins: DirectionBins,
    /// The four bins around each corner of the bin grid, (n+1)² a hemisphere.
    around: Vec<[u16; 4]>,
}

impl Directions {
    /// Tables for a number of bins.
    ///
    /// Across the edge of a hemisphere's square lies the same cell of the other hemisphere, because
    /// the lower half of the sphere is the upper one mirrored at its equator. Across a corner lies the cell
    /// itself: only two cells meet there, the corner's own and the one across either edge.
    pub fn new(bins: DirectionBins) -> Self {
        let n = bins.n() as i32;
        let mut around = Vec::with_capacity(2 * ((n + 1) * (n + 1)) as usize);
        for lower in [0, 1] {
            for row in 0..=n {
                for column in 0..=n {
                    around.push(std::array::from_fn(|i| {
                        let (c, r) = (column - 1 + (i as i32 & 1), row - 1 + (i as i32 >> 1));
                        let crossed = [c, r].iter().filter(|i| !(0..n).contains(*i)).count() as i32;
                        let side = (lower + crossed) % 2;
                        (side * n * n + r.clamp(0, n - 1) * n + c.clamp(0, n - 1)) as u16
                    }));
                }
            }
        }
        Self { bins, around }
    }

    /// The bins it answers for.
    pub fn bins(&self) -> DirectionBins {
        self.bins
    }

    /// The bin that holds a unit direction.
    pub fn nearest(&self, direction: Vec3) -> usize {
        let n = self.bins.n();
        let (u, lower) = square(direction);
        let cell = |v: f32| ((v * n as f32) as u32).min(n - 1);
        (cell(u.y) * n + cell(u.x) + lower * n * n) as usize
    }

    /// The four bins whose centres surround a unit direction on its hemisphere's square, bilinear.
    pub fn interpolated(&self, direction: Vec3) -> BinWeights {
        let n = self.bins.n();
        let (u, lower) = square(direction);
        let axis = |v: f32| {
            let q = v * n as f32 + 0.5;
            let cell = (q as u32).min(n);
            (cell, q - cell as f32)
        };
        let ((c, x), (r, y)) = (axis(u.x), axis(u.y));
        let bins = self.around[((lower * (n + 1) + r) * (n + 1) + c) as usize];
        let weights = [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y];
        BinWeights { bins, weights }
    }
}

/// [`DirectionBins::square`] to 2e-6, and 1 for the lower hemisphere; NaN gives a corner.
fn square(d: Vec3) -> (Vec2, u32) {
    let lower = u32::from(d.y < 0.0);
    // The disc point is (x, z) / √(1 + |y|) and its radius √(1 − |y|); only ratios enter the angle.
    let radius = (1.0 - d.y.abs()).max(0.0).sqrt();
    let (ax, az) = (d.x.abs(), d.z.abs());
    let (long, short) = if ax > az { (ax, az) } else { (az, ax) };
    let minor = radius * eighth_turns(short / long.max(f32::MIN_POSITIVE));
    let (px, pz) = if ax > az { (radius, minor) } else { (minor, radius) };
    let place = |p: f32, sign: f32| {
        let q = 0.5 + 0.5 * p.copysign(sign);
        if q > 0.0 { q.min(1.0) } else { 0.0 }
    };
    (Vec2::new(place(px, d.x), place(pz, d.z)), lower)
}

/// atan(t) / (π/4) for t in [0, 1], to 1e-6: an odd polynomial through equally good points.
fn eighth_turns(t: f32) -> f32 {
    let s = t * t;
    let p = ATAN.iter().rev().fold(0.0f32, |p, c| p.mul_add(s, *c));
    (t * p).min(1.0)
}

/// Least-squares fit at Chebyshev points of atan(√s) / √s · 4/π over s in [0, 1].
const ATAN: [f32; 7] =
    [1.273_238_7, -0.424_324_58, 0.253_118_4, -0.171_637_86, 0.106_623_06, -0.046_980_79, 0.009_963_71];
