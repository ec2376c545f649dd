//! From a direction to the bins that answer for it, quickly.
//!
//! The same map as [`DirectionBins::square`], with a polynomial in place of the arc tangent, and the
//! four bins around each corner of the bin grid in a table that fits the first-level cache.

use crate::math::sphere_map::DirectionBins;
use glam::Vec3;

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

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.around[..])
    }

    /// The bin that holds a unit direction.
    pub fn nearest(&self, direction: Vec3) -> usize {
        self.nearest_each(&direction.to_array().map(|d| [d]))[0] as usize
    }

    /// The four bins whose centres surround a unit direction on its hemisphere's square, bilinear.
    pub fn interpolated(&self, direction: Vec3) -> BinWeights {
        self.interpolated_each(&direction.to_array().map(|d| [d]))[0]
    }

    /// As [`Self::nearest`] for directions given axis by axis, so that the arithmetic runs over vectors.
    #[inline]
    pub(super) fn nearest_each<const N: usize>(&self, directions: &[[f32; N]; 3]) -> [u32; N] {
        let n = self.bins.n() as f32;
        std::array::from_fn(|i| {
            let [u, v, lower] = square(directions.each_ref().map(|d| d[i]));
            let cell = |v: f32| clamped((v * n).floor(), n - 1.0);
            ((lower * n + cell(v)) * n + cell(u)) as u32
        })
    }

    /// As [`Self::interpolated`] for directions given axis by axis.
    #[inline]
    pub(super) fn interpolated_each<const N: usize>(&self, directions: &[[f32; N]; 3]) -> [BinWeights; N] {
        let n = self.bins.n() as f32;
        let (mut corner, mut right, mut down) = ([0; N], [0.0; N], [0.0; N]);
        for i in 0..N {
            let [u, v, lower] = square(directions.each_ref().map(|d| d[i]));
            let [column, row] = [u, v].map(|v| clamped((v * n + 0.5).floor(), n));
            corner[i] = ((lower * (n + 1.0) + row) * (n + 1.0) + column) as u32;
            (right[i], down[i]) = (u * n + 0.5 - column, v * n + 0.5 - row);
        }
        std::array::from_fn(|i| {
            let (x, y) = (right[i], down[i]);
            let weights = [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y];
            BinWeights { bins: self.around[corner[i] as usize], weights }
        })
    }
}

/// A value between 0 and a limit, by comparisons that are one instruction each; NaN gives 0.
#[inline(always)]
pub(super) fn clamped(v: f32, limit: f32) -> f32 {
    let v = if v > 0.0 { v } else { 0.0 };
    if v < limit { v } else { limit }
}

/// [`DirectionBins::square`] to 2e-6, and 1 for the lower hemisphere; NaN gives a corner.
#[inline(always)]
fn square([x, y, z]: [f32; 3]) -> [f32; 3] {
    // The disc point is (x, z) / √(1 + |y|) and its radius √(1 − |y|); only ratios enter the angle.
    let radius = clamped(1.0 - y.abs(), 1.0).sqrt();
    let (ax, az) = (x.abs(), z.abs());
    let (long, short) = if ax > az { (ax, az) } else { (az, ax) };
    let long = if long > f32::MIN_POSITIVE { long } else { f32::MIN_POSITIVE };
    let minor = radius * eighth_turns(short / long);
    let (px, pz) = if ax > az { (radius, minor) } else { (minor, radius) };
    let place = |p: f32, sign: f32| clamped(0.5 + 0.5 * p.copysign(sign), 1.0);
    [place(px, x), place(pz, z), if y < 0.0 { 1.0 } else { 0.0 }]
}

/// atan(t) / (π/4) for t in [0, 1], to 1e-6: an odd polynomial through equally good points.
#[inline(always)]
fn eighth_turns(t: f32) -> f32 {
    let s = t * t;
    let p = t * ATAN.iter().rev().fold(0.0f32, |p, c| p.mul_add(s, *c));
    if p < 1.0 { p } else { 1.0 }
}

/// Least-squares fit at Chebyshev points of atan(√s) / √s · 4/π over s in [0, 1].
const ATAN: [f32; 7] =
    [1.273_238_7, -0.424_324_58, 0.253_118_4, -0.171_637_86, 0.106_623_06, -0.046_980_79, 0.009_963_71];
