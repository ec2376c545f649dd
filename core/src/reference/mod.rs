//! The path tracer: ground truth for everything else in the program.
//!
//! Next-event estimation with multiple importance sampling over the same triangles, normals and
//! emitters that the fast methods use, so that a difference is the method's and not the scene's.
//! It converges as 1/√N and never goes wrong by more than its own standard error; it is not meant to
//! be fast enough to look around with. [`brute`] is a second estimator that shares no sampling
//! code with the first: a z-test between the two guards against a lost factor.
//!
//! Plain Monte Carlo and not bidirectional or Metropolis sampling: nearly all surfaces are diffuse and
//! lamps are found by next-event estimation, and independent samples make the error estimate honest.
//! Scenes without specular lobes take the short way of [`path`]; [`scatter`] has the general one.

pub mod brute;
pub mod expression;
pub mod irradiance;
pub mod lights;
pub mod path;
pub mod picture;
pub mod radiance;
pub mod scatter;

use glam::{DVec3, Vec3};

/// A mean and how far it may be off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Mean of the samples, in the quantity's unit.
    pub mean: Vec3,
    /// Standard error of the mean; infinite where a single sample cannot tell.
    pub standard_error: Vec3,
    /// Degrees of freedom of the standard error: independent values less one.
    pub degrees_of_freedom: u32,
}

impl Estimate {
    /// Mean of independent values and its standard error, √(Σ(x − x̄)² / (n (n − 1))).
    pub fn from_values(values: &[DVec3]) -> Self {
        let n = values.len().max(1) as f64;
        let mean = values.iter().sum::<DVec3>() / n;
        let squares = values.iter().map(|v| (v - mean) * (v - mean)).sum::<DVec3>();
        let standard_error = if values.len() < 2 {
            Vec3::INFINITY
        } else {
            (squares / (n * (n - 1.0))).map(f64::sqrt).as_vec3()
        };
        Self {
            mean: mean.as_vec3(),
            standard_error,
            degrees_of_freedom: values.len().saturating_sub(1) as u32,
        }
    }
}

/// A well-mixed word from a seed and an item, so that streams of neighbouring items share nothing.
///
/// SplitMix64's finaliser (Steele, Lea and Flood 2014).
pub(crate) fn stream_seed(seed: u64, item: u64) -> u64 {
    let mut z = seed.wrapping_add(item.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
