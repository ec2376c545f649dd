//! Irradiance of every bin from the radiance of every bin: Greger Eq. 4.3, exactly, at a twelfth of its cost.
//!
//! The specification is the N×N product H(ωᵢ) = 4π/N Σⱼ L(ωⱼ) max(0, ωᵢ·ωⱼ), [`irradiance_by_definition`].
//! [`Quadrature`] computes the same sum from the symmetries of the bins:
//!
//! 1. max(0, x) = (x + |x|) / 2. The x half is a dot product with the vector irradiance Σ Lω. The |x|
//!    half is the same for ω and −ω, so opposite bins are added first: n² unknowns and not 2n².
//! 2. |ωᵢ·ωⱼ| does not change when both directions are mirrored in x or in z. Splitting the data into
//!    parts even and odd under the two mirrors leaves four independent products of ⌈n/2⌉² unknowns.
//!
//! At n = 17 that is 26,244 multiplications a channel instead of 334,084. Not spherical harmonics: they
//! would cost as much at order 6 and cut the clamped cosine off there.
//!
//! Each row is scaled so that Σⱼ 4π/N max(0, ωᵢ·ωⱼ) is π exactly, which the mid-point rule misses by up to
//! 1 % at n = 9: constant radiance L then gives πL in every direction.

use crate::math::sphere_map::DirectionBins;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use wide::f32x8;

/// Samples worked on together.
pub const BLOCK: usize = 8;
/// Columns of a block: samples times channels; sample s, channel c is column `c * BLOCK + s`.
pub const LANES: usize = 3 * BLOCK;
/// One bin's values in a block.
pub type Lanes = [f32; LANES];

/// Parts by parity, before and after their products.
pub(super) type Room = [[Vec<Lanes>; 4]; 2];

/// The factored matrix of Eq. 4.3, shared by all samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Quadrature {
    bins: DirectionBins,
    /// ⌈n/2⌉: rows and columns of a quarter of the square.
    half: usize,
    /// Kernel of each parity (x even/odd + 2 × z even/odd), row-major.
    kernels: [Vec<f32>; 4],
    /// Centres of the upper bins.
    centres: Vec<Vec3>,
    /// 4π/N ½ and each row's normalisation, for the upper bins; the lower ones are the same.
    scale: Vec<f32>,
}

/// Eq. 4.3 with normalised rows, written as it stands: irradiance, lx, of radiance in cd/m², one a bin.
///
/// # Panics
/// If there is not one radiance a bin.
pub fn irradiance_by_definition(bins: DirectionBins, radiance: &[Vec3]) -> Vec<Vec3> {
    assert_eq!(radiance.len(), bins.len(), "one radiance a bin");
    let centres: Vec<DVec3> = (0..bins.len()).map(|b| bins.centre(b).as_dvec3()).collect();
    centres
        .iter()
        .map(|wi| {
            let (mut sum, mut cosines) = (DVec3::ZERO, 0.0);
            for (wj, l) in centres.iter().zip(radiance) {
                let cosine = wi.dot(*wj).max(0.0);
                cosines += cosine;
                sum += l.as_dvec3() * cosine;
            }
            (sum * (PI / cosines)).as_vec3()
        })
        .collect()
}

impl Quadrature {
    /// Factors the matrix for a number of bins.
    pub fn new(bins: DirectionBins) -> Self {
        let n = bins.n() as usize;
        let half = n.div_ceil(2);
        let centres: Vec<Vec3> = (0..n * n).map(|b| bins.centre(b)).collect();
        let exact: Vec<DVec3> = centres.iter().map(|c| c.as_dvec3()).collect();
        let kernels = std::array::from_fn(|parity| {
            let mut kernel = Vec::with_capacity(half.pow(4));
            for a in 0..half * half {
                let wa = exact[a / half * n + a % half];
                for b in 0..half * half {
                    let images = images(b % half, b / half, n);
                    let mut sum = 0.0;
                    for (i, &image) in images.iter().enumerate() {
                        if !images[..i].contains(&image) {
                            sum += f64::from(sign(parity, i)) * wa.dot(exact[image]).abs();
                        }
                    }
                    kernel.push(sum as f32);
                }
            }
            kernel
        });
        let scale = exact
            .iter()
            .map(|wi| {
                // Σ max(0, ·) over a bin and its opposite is |·|.
                let cosines: f64 = exact.iter().map(|wj| wi.dot(*wj).abs()).sum();
                (0.5 * PI / cosines) as f32
            })
            .collect();
        Self { bins, half, kernels, centres, scale }
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let kernels: usize = self.kernels.iter().map(|k| size_of_val(&k[..])).sum();
        kernels + size_of_val(&self.centres[..]) + size_of_val(&self.scale[..])
    }

    /// The bins it is for.
    pub fn bins(&self) -> DirectionBins {
        self.bins
    }

    /// Irradiance of a block of samples, lx, from their radiance, cd/m²: one [`Lanes`] a bin.
    ///
    /// # Panics
    /// If there is not one entry a bin on both sides.
    pub fn irradiance(&self, radiance: &[Lanes], out: &mut [Lanes]) {
        assert_eq!(radiance.len(), out.len(), "one entry a bin");
        self.each(radiance, &mut self.room(), |bin, rgb| out[bin] = bytemuck::cast(rgb));
    }

    /// Room that [`Self::each`] works in.
    pub(super) fn room(&self) -> Room {
        [(); 2].map(|()| [(); 4].map(|()| vec![[0.0; LANES]; self.half * self.half]))
    }

    /// As [`Self::irradiance`], bin by bin: its number, and of each channel the samples'. A bin on a mirror's plane
    /// comes twice.
    ///
    /// # Panics
    /// If there is not one entry a bin.
    #[inline]
    pub(super) fn each(
        &self,
        radiance: &[Lanes],
        [split, parts]: &mut Room,
        mut put: impl FnMut(usize, [f32x8; 3]),
    ) {
        let (n, half) = (self.bins.n() as usize, self.half);
        let side = n * n;
        assert_eq!(radiance.len(), 2 * side, "one entry a bin");
        let (upper, lower) = radiance.split_at(side);
        let of = |lanes: &Lanes| -> [f32x8; 3] { bytemuck::cast(*lanes) };

        let mut vector = [[f32x8::ZERO; 3]; 3];
        for (bin, centre) in self.centres.iter().enumerate() {
            let (u, l) = (of(&upper[bin]), of(&lower[side - 1 - bin]));
            for c in 0..3 {
                let difference = u[c] - l[c];
                for axis in 0..3 {
                    vector[axis][c] = f32x8::splat(centre[axis]).mul_add(difference, vector[axis][c]);
                }
            }
        }

        let quarter = half * half;
        for b in 0..quarter {
            let folded = images(b % half, b / half, n).map(|i| {
                let (u, l) = (of(&upper[i]), of(&lower[side - 1 - i]));
                [0, 1, 2].map(|c| f32x8::splat(0.25) * (u[c] + l[c]))
            });
            for (part, sum) in split.iter_mut().zip(mirrored(folded)) {
                part[b] = bytemuck::cast(sum);
            }
        }
        for parity in 0..4 {
            product(&self.kernels[parity], &split[parity], &mut parts[parity]);
        }

        for a in 0..quarter {
            let evens = mirrored(parts.each_ref().map(|part| of(&part[a])));
            for (even, image) in evens.into_iter().zip(images(a % half, a / half, n)) {
                let (w, scale) = (self.centres[image], f32x8::splat(self.scale[image]));
                let [x, y, z] = w.to_array().map(f32x8::splat);
                let odd =
                    [0, 1, 2].map(|c| x.mul_add(vector[0][c], y.mul_add(vector[1][c], z * vector[2][c])));
                put(image, [0, 1, 2].map(|c| (scale * (even[c] + odd[c])).max(f32x8::ZERO)));
                put(2 * side - 1 - image, [0, 1, 2].map(|c| (scale * (even[c] - odd[c])).max(f32x8::ZERO)));
            }
        }
    }
}

/// Values at a cell and its images, split into parts by parity; and the sum of such parts at the images.
#[inline(always)]
fn mirrored([a, b, c, d]: [[f32x8; 3]; 4]) -> [[f32x8; 3]; 4] {
    let by = |f: fn(f32x8, f32x8) -> f32x8, g: fn(f32x8, f32x8) -> f32x8| {
        [0, 1, 2].map(|i| f(g(a[i], b[i]), g(c[i], d[i])))
    };
    let (add, sub) = (|x, y| x + y, |x, y| x - y);
    [by(add, add), by(add, sub), by(sub, add), by(sub, sub)]
}

/// A cell of the square and its mirror images: itself, in x, in z, in both.
#[inline(always)]
fn images(column: usize, row: usize, n: usize) -> [usize; 4] {
    let (mc, mr) = (n - 1 - column, n - 1 - row);
    [row * n + column, row * n + mc, mr * n + column, mr * n + mc]
}

/// Sign that image `i` has in a part of the given parity.
#[inline(always)]
const fn sign(parity: usize, i: usize) -> f32 {
    if matches!(parity & i, 0 | 3) { 1.0 } else { -1.0 }
}

/// Dense product, a few rows at a time so that the sums stay in registers.
pub(super) fn product(kernel: &[f32], data: &[Lanes], out: &mut [Lanes]) {
    const ROWS: usize = 4;
    let columns = data.len();
    for (rows, out) in kernel.chunks(ROWS * columns).zip(out.chunks_mut(ROWS)) {
        // The last rows may be fewer: they are computed as often as there is room, and kept once.
        let row: [&[f32]; ROWS] = std::array::from_fn(|r| &rows[r.min(out.len() - 1) * columns..][..columns]);
        let mut sums = [[f32x8::ZERO; 3]; ROWS];
        for (i, lanes) in data.iter().enumerate() {
            let lanes: [f32x8; 3] = bytemuck::cast(*lanes);
            for (sum, row) in sums.iter_mut().zip(row) {
                let k = f32x8::splat(row[i]);
                *sum = std::array::from_fn(|c| k.mul_add(lanes[c], sum[c]));
            }
        }
        for (out, sum) in out.iter_mut().zip(sums) {
            *out = bytemuck::cast(sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Rng;

    #[test]
    fn factored_product_is_the_definition() {
        for n in [1, 2, 3, 9, 16, 17] {
            let bins = DirectionBins::new(n);
            let mut rng = Rng::new(7, u64::from(n));
            let columns: Vec<Vec<Vec3>> = (0..BLOCK)
                .map(|_| {
                    (0..bins.len()).map(|_| Vec3::from_array([(); 3].map(|()| rng.next_f32()))).collect()
                })
                .collect();
            let radiance: Vec<Lanes> = (0..bins.len())
                .map(|b| std::array::from_fn(|lane| columns[lane % BLOCK][b][lane / BLOCK]))
                .collect();
            let mut out = vec![[0.0; LANES]; bins.len()];
            Quadrature::new(bins).irradiance(&radiance, &mut out);
            for (s, column) in columns.iter().enumerate() {
                for (b, wanted) in irradiance_by_definition(bins, column).into_iter().enumerate() {
                    for c in 0..3 {
                        // Sums of some hundred terms in f32.
                        let got = out[b][c * BLOCK + s];
                        assert!((got - wanted[c]).abs() < 2e-5, "n = {n}, bin {b}: {got} for {}", wanted[c]);
                    }
                }
            }
        }
    }

    #[test]
    fn constant_radiance_reads_pi_times_itself() {
        for n in [1, 9, 17, 29] {
            let bins = DirectionBins::new(n);
            let mut out = vec![[0.0; LANES]; bins.len()];
            Quadrature::new(bins).irradiance(&vec![[2.0; LANES]; bins.len()], &mut out);
            for value in out.iter().flatten() {
                assert!((value / (2.0 * std::f32::consts::PI) - 1.0).abs() < 1e-5, "n = {n}: {value}");
            }
        }
    }
}
