//! Real spherical harmonics of bands 0 to 2, and the clamped cosine in them.
//!
//! Nine functions Y of a unit direction, orthonormal over solid angle. Irradiance is radiance convolved
//! with max(0, cos θ), which multiplies band l by Â_l: π, 2π/3, π/4 and nothing else below band 4, so nine
//! coefficients hold 99 % of any irradiance's energy (Ramamoorthi and Hanrahan 2001, *An Efficient
//! Representation for Irradiance Environment Maps*). Band 4 has −π/24: what is left out of the light of
//! one far lamp is at most 9.4 % of its normal irradiance, seen from behind the terminator.

use glam::Vec3;
use std::f32::consts::PI;

/// Number of functions in bands 0 to 2.
pub const COUNT: usize = 9;

/// Â_l for l = 0, 1, 2: by how much convolution with max(0, cos θ) scales a band, sr (Ramamoorthi and
/// Hanrahan 2001, Eq. 8: Â_l = √(4π / (2l + 1)) A_l).
pub const CLAMPED_COSINE: [f32; 3] = [PI, 2.0 * PI / 3.0, PI / 4.0];

/// Band of each function.
pub const BAND: [usize; COUNT] = [0, 1, 1, 1, 2, 2, 2, 2, 2];

/// Y₀₀, constant.
pub const CONSTANT: f32 = 0.282_094_8;

const LINEAR: f32 = 0.488_602_5;
const QUADRATIC: f32 = 1.092_548_4;
const AXIAL: f32 = 0.315_391_57;
const DIFFERENCE: f32 = 0.546_274_2;

/// The nine functions in a unit direction: Y₀₀; Y₁ in y, z, x; Y₂ in xy, yz, 3z² − 1, xz, x² − y².
pub fn basis(d: Vec3) -> [f32; COUNT] {
    [
        CONSTANT,
        LINEAR * d.y,
        LINEAR * d.z,
        LINEAR * d.x,
        QUADRATIC * d.x * d.y,
        QUADRATIC * d.y * d.z,
        AXIAL * (3.0 * d.z * d.z - 1.0),
        QUADRATIC * d.x * d.z,
        DIFFERENCE * (d.x * d.x - d.y * d.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sphere_map::DirectionBins;

    #[test]
    fn functions_are_orthonormal() {
        let bins = DirectionBins::new(64);
        let mut gram = [[0.0f64; COUNT]; COUNT];
        for b in 0..bins.len() {
            let y = basis(bins.centre(b)).map(f64::from);
            for (row, yi) in gram.iter_mut().zip(y) {
                for (g, yj) in row.iter_mut().zip(y) {
                    *g += yi * yj * f64::from(bins.solid_angle());
                }
            }
        }
        for (i, row) in gram.iter().enumerate() {
            for (j, g) in row.iter().enumerate() {
                // Mid-point rule over 8,192 equal bins: the error falls with the square of a bin's 0.039 rad.
                assert!((g - f64::from(u8::from(i == j))).abs() < 2e-3, "{i} {j}: {g}");
            }
        }
    }

    #[test]
    fn clamped_cosine_has_these_bands() {
        // Σ_m Y_lm(d) Y_lm(n) = (2l + 1)/4π P_l(cos θ), so Â_l = 2π ∫ max(0, x) P_l(x) dx.
        let legendre: [fn(f64) -> f64; 3] = [|_| 1.0, |x| x, |x| 1.5 * x * x - 0.5];
        for (l, p) in legendre.into_iter().enumerate() {
            let steps = 100_000;
            let x = |i: u32| (f64::from(i) + 0.5) / f64::from(steps);
            let sum: f64 = (0..steps).map(|i| x(i) * p(x(i))).sum::<f64>() / f64::from(steps);
            assert!((std::f64::consts::TAU * sum - f64::from(CLAMPED_COSINE[l])).abs() < 1e-6);
            let n = Vec3::new(0.6, 0.0, 0.8);
            let d = Vec3::new(0.48, 0.6, 0.64);
            let addition: f32 = (0..COUNT).filter(|&i| BAND[i] == l).map(|i| basis(d)[i] * basis(n)[i]).sum();
            let exact = (2 * l + 1) as f64 / (4.0 * std::f64::consts::PI) * p(f64::from(d.dot(n)));
            assert!((f64::from(addition) - exact).abs() < 1e-6);
        }
    }
}
