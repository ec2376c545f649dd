//! The compact basis: nine spherical-harmonic coefficients a sample and channel instead of 2n² bins.
//!
//! A sample's irradiance is projected onto bands 0 to 2 by least squares over its bins, which for what
//! those bands can hold is exact: E_lm = Â_l L_lm (Ramamoorthi and Hanrahan 2001). A query blends the
//! coefficients of eight samples and evaluates nine polynomials once. A sample is two cache lines (128
//! bytes, a third of a megabyte for an office) where 578 bins are 4.6 kB, so queries stay in the second-level cache.
//!
//! Single-precision numbers and not half-precision ones: the two lines of a sample are read whole anyway,
//! and unpacking 27 halves costs more than the lines they would save.
//!
//! Limits: band 4 and above are cut off. Light from one small lamp errs by up to 9 % of its largest value
//! and may ring below zero behind it, where it is clamped; see [`super::bases`] for the error in a scene.

use super::codec::{Texel, decode_rgb};
use crate::math::{
    part::Part,
    sphere_map::DirectionBins,
    spherical_harmonics::{CONSTANT, COUNT, basis},
};
use glam::{Vec3, Vec3A, Vec4};
use std::sync::Arc;

/// Irradiance of one sample in bands 0 to 2, lx.
///
/// Rows of four: bands 1 and 2 of red (two rows), green, blue; then the three constants, Y₀₀ applied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(128))]
pub struct Coefficients([[f32; 4]; 7]);

impl Coefficients {
    /// From coefficients in the order of [`basis`].
    pub fn new(c: [Vec3; COUNT]) -> Self {
        let mut rows = [[0.0; 4]; 7];
        for channel in 0..3 {
            for i in 0..COUNT - 1 {
                rows[2 * channel + i / 4][i % 4] = c[i + 1][channel];
            }
            rows[6][channel] = c[0][channel] * CONSTANT;
        }
        Self(rows)
    }

    /// Coefficients in the order of [`basis`], lx.
    pub fn get(&self) -> [Vec3; COUNT] {
        std::array::from_fn(|i| match i {
            0 => Vec3::from_slice(&self.0[6]) / CONSTANT,
            i => Vec3::from_array(std::array::from_fn(|c| self.0[2 * c + (i - 1) / 4][(i - 1) % 4])),
        })
    }
}

/// Blends eight samples and evaluates them for a unit normal, lx per channel, not below 0.
#[inline(always)]
pub(super) fn evaluate(
    table: &[Coefficients],
    ids: &[u32; 8],
    weights: &[f32; 8],
    towards: &[Vec4; 2],
) -> Vec3 {
    let mut sums = [Vec4::ZERO; 7];
    for i in 0..8 {
        let rows = &table[ids[i] as usize].0;
        let weight = Vec4::splat(weights[i]);
        for (sum, row) in sums.iter_mut().zip(rows) {
            *sum = Vec4::from_array(*row).mul_add(weight, *sum);
        }
    }
    let channel = |c: usize| (sums[2 * c] * towards[0] + sums[2 * c + 1] * towards[1]).element_sum();
    (sums[6] + Vec4::new(channel(0), channel(1), channel(2), 0.0)).max(Vec4::ZERO).truncate()
}

/// Bands 1 and 2 in a direction, as [`evaluate`] wants them; NaN gives zeros.
#[inline(always)]
pub(super) fn towards(normal: Vec3) -> [Vec4; 2] {
    let y = basis(normal);
    let rows = [Vec4::new(y[1], y[2], y[3], y[4]), Vec4::new(y[5], y[6], y[7], y[8])];
    if rows[0].is_finite() && rows[1].is_finite() { rows } else { [Vec4::ZERO; 2] }
}

/// Coefficients of every sample, by part of the light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Harmonics {
    parts: [Arc<Vec<Coefficients>>; 3],
}

impl Harmonics {
    /// Projects the bins of every sample. On one thread: whoever waits for it may hold the others.
    pub fn new(bins: DirectionBins, direct: &[Texel], indirect: &[Texel]) -> Self {
        let projection = Projection::new(bins);
        let project = |table: &[Texel]| -> Vec<[Vec3; COUNT]> {
            table.chunks(bins.len()).map(|texels| projection.project(texels)).collect()
        };
        let (direct, indirect) = (project(direct), project(indirect));
        let both = direct.iter().zip(&indirect).map(|(d, i)| std::array::from_fn(|k| d[k] + i[k]));
        let packed = |list: &[[Vec3; COUNT]]| Arc::new(list.iter().map(|c| Coefficients::new(*c)).collect());
        let all = Arc::new(both.map(Coefficients::new).collect());
        Self { parts: [packed(&direct), packed(&indirect), all] }
    }

    /// One entry a sample.
    pub fn of(&self, part: Part) -> &[Coefficients] {
        match part {
            Part::Direct => &self.parts[0],
            Part::Indirect => &self.parts[1],
            Part::All => &self.parts[2],
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.parts.iter().map(|p| size_of_val(&p[..])).sum()
    }
}

/// Least-squares projection of bins onto the nine functions.
///
/// With fewer than 18 bins, band 2 cannot be told from band 0 and stays empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    bins: DirectionBins,
    /// Weights of each upper bin; those of the opposite bin are the same, negated in band 1.
    rows: Vec<[f32; COUNT]>,
}

impl Projection {
    /// For a number of bins.
    pub fn new(bins: DirectionBins) -> Self {
        let count = if bins.len() < 18 { 4 } else { COUNT };
        let values: Vec<[f64; COUNT]> =
            (0..bins.len()).map(|b| basis(bins.centre(b)).map(f64::from)).collect();
        let mut gram = [[0.0f64; COUNT]; COUNT];
        for y in &values {
            for i in 0..count {
                for j in 0..count {
                    gram[i][j] += y[i] * y[j];
                }
            }
        }
        // Two bins do not see x and z: a trace of the diagonal keeps those coefficients at 0.
        for (i, row) in gram.iter_mut().enumerate() {
            row[i] += if i < count { 1e-12 * bins.len() as f64 } else { 1.0 };
        }
        let side = bins.len() / 2;
        let rows = values[..side]
            .iter()
            .map(|y| {
                let y = std::array::from_fn(|i| if i < count { y[i] } else { 0.0 });
                solve(gram, y).map(|w| w as f32)
            })
            .collect();
        Self { bins, rows }
    }

    /// Coefficients of one sample's bins, lx.
    ///
    /// # Panics
    /// If there is not one texel a bin.
    pub fn project(&self, texels: &[Texel]) -> [Vec3; COUNT] {
        assert_eq!(texels.len(), self.bins.len(), "one texel a bin");
        let (upper, lower) = texels.split_at(self.rows.len());
        let mut sums = [Vec3A::ZERO; COUNT];
        for ((row, u), l) in self.rows.iter().zip(upper).zip(lower.iter().rev()) {
            let (u, l) = (Vec3A::from(decode_rgb(*u)), Vec3A::from(decode_rgb(*l)));
            let (even, odd) = (u + l, u - l);
            for (i, (sum, weight)) in sums.iter_mut().zip(row).enumerate() {
                *sum += if (1..4).contains(&i) { odd } else { even } * *weight;
            }
        }
        sums.map(Vec3::from)
    }
}

/// Solves a symmetric positive definite system by elimination.
fn solve(mut a: [[f64; COUNT]; COUNT], mut b: [f64; COUNT]) -> [f64; COUNT] {
    for pivot in 0..COUNT {
        let scale = 1.0 / a[pivot][pivot];
        a[pivot].iter_mut().for_each(|v| *v *= scale);
        b[pivot] *= scale;
        let (row, value) = (a[pivot], b[pivot]);
        for i in (0..COUNT).filter(|&i| i != pivot) {
            let factor = a[i][pivot];
            for (v, p) in a[i].iter_mut().zip(row) {
                *v -= factor * p;
            }
            b[i] -= factor * value;
        }
    }
    b
}
