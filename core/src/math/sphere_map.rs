//! Equal-area maps between squares and the sphere of directions, and the 2n² direction bins built on them.
//!
//! Shirley and Chiu's concentric map takes the unit square to the disc; lifting the disc by
//! z = 1 − r² keeps areas, so an n×n grid on the square gives n² bins of equal solid angle on a
//! hemisphere (Greger 1996, §4.2.1). Not latitude–longitude: its bins differ in area and shape.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Concentric map of [0, 1]² onto the unit disc, keeping relative area (Shirley and Chiu 1997).
pub fn disc_from_square(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (r, phi) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y))
    };
    let (sin, cos) = phi.sin_cos();
    r * Vec2::new(cos, sin)
}

/// Inverse of [`disc_from_square`].
pub fn square_from_disc(d: Vec2) -> Vec2 {
    let r = d.length();
    if r == 0.0 {
        return Vec2::splat(0.5);
    }
    let p = if d.x.abs() > d.y.abs() {
        let a = r.copysign(d.x);
        Vec2::new(a, a * (d.y / d.x).atan() / FRAC_PI_4)
    } else {
        let b = r.copysign(d.y);
        Vec2::new(b * (d.x / d.y).atan() / FRAC_PI_4, b)
    };
    (0.5 * p + Vec2::splat(0.5)).clamp(Vec2::ZERO, Vec2::ONE)
}

/// The 2n² direction bins of a sample: bins 0‥n² cover the upper (+y) hemisphere, n²‥2n² the lower,
/// each row-major in (u, v). Every bin has solid angle 4π / 2n².
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct DirectionBins {
    n: u32,
}

impl DirectionBins {
    /// Bins with `n` rows and columns a hemisphere; the thesis uses n = 9, 17, 29, 41, 49.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn new(n: u32) -> Self {
        assert!(n > 0, "a sphere of directions needs at least one bin a hemisphere");
        Self { n }
    }

    /// Rows and columns a hemisphere.
    pub fn n(self) -> u32 {
        self.n
    }

    /// Number of bins, 2n².
    pub fn len(self) -> usize {
        2 * (self.n * self.n) as usize
    }

    /// Never true; here because `len` is.
    pub fn is_empty(self) -> bool {
        false
    }

    /// Solid angle of each bin in sr: 4π / 2n² (Greger Eq. 4.2).
    pub fn solid_angle(self) -> f32 {
        4.0 * PI / self.len() as f32
    }

    /// Unit direction through position `jitter` in [0, 1)² of a bin; (½, ½) is its centre.
    pub fn direction(self, bin: usize, jitter: Vec2) -> Vec3 {
        let per_side = (self.n * self.n) as usize;
        let (cell, lower) = (bin % per_side, bin >= per_side);
        let (column, row) = (cell as u32 % self.n, cell as u32 / self.n);
        let u = (Vec2::new(column as f32, row as f32) + jitter) / self.n as f32;
        let disc = disc_from_square(u);
        let r2 = disc.length_squared();
        let planar = disc * (2.0 - r2).max(0.0).sqrt();
        let height = 1.0 - r2;
        Vec3::new(planar.x, if lower { -height } else { height }, planar.y)
    }

    /// Direction through the centre of a bin.
    pub fn centre(self, bin: usize) -> Vec3 {
        self.direction(bin, Vec2::splat(0.5))
    }

    /// Position of a unit direction on its hemisphere's square, and whether it is on the lower one.
    pub fn square(self, direction: Vec3) -> (Vec2, bool) {
        let lower = direction.y < 0.0;
        let r2 = 1.0 - direction.y.abs();
        let scale = 1.0 / (2.0 - r2).max(f32::MIN_POSITIVE).sqrt();
        let disc = Vec2::new(direction.x, direction.z) * scale;
        (square_from_disc(disc), lower)
    }

    /// Bin that holds a unit direction.
    pub fn bin(self, direction: Vec3) -> usize {
        let (u, lower) = self.square(direction);
        let cell = |v: f32| ((v * self.n as f32) as u32).min(self.n - 1);
        let index = cell(u.y) * self.n + cell(u.x);
        (index + if lower { self.n * self.n } else { 0 }) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bin_centres_come_back_to_their_bin_and_sum_to_zero() {
        for n in [1, 2, 9, 17, 29, 41, 49] {
            let bins = DirectionBins::new(n);
            let mut sum = Vec3::ZERO;
            for bin in 0..bins.len() {
                let d = bins.centre(bin);
                assert!((d.length() - 1.0).abs() < 1e-5);
                assert_eq!(bins.bin(d), bin, "n = {n}");
                sum += d;
            }
            assert!(sum.length() < 1e-3 * bins.len() as f32, "n = {n}: {sum}");
        }
    }

    #[test]
    fn bins_have_equal_solid_angle() {
        let bins = DirectionBins::new(5);
        let mut count = vec![0u32; bins.len()];
        let total = 200_000;
        for i in 0..total {
            let mut rng = crate::math::random::Rng::new(1, i);
            count[bins.bin(crate::math::frame::uniform_direction(rng.next_vec2()))] += 1;
        }
        // 4000 expected a bin, standard deviation 63: five of them.
        assert!(count.iter().all(|&c| (c as f32 - 4000.0).abs() < 320.0), "{count:?}");
    }
}
