//! Stage 3: from texels to a value anywhere (Bastos §5.5.3.3).
//!
//! Bilinear lookup is what every graphics card does, and creases along the lines of texels. The bicubic filter of
//! Mitchell and Netravali (1988) with B = C = 1/3 is C¹; it keeps linear functions, is no interpolation
//! (a texel's own value is blurred by its neighbours'), and has negative lobes: beside a bright texel the
//! result may fall below zero by up to 1/27 of it along each axis.

use super::{RadiosityTexture, triangle::zero_order_texel};
use glam::{Vec2, Vec3};

/// How texels become a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// The texel of the leaf that covers a point of a triangle, of a texture of zero order.
    NearestInTriangle,
    /// Bilinear.
    Bilinear,
    /// Mitchell and Netravali's bicubic (1/3, 1/3).
    Mitchell,
}

impl RadiosityTexture {
    /// Value at a point of the unit square.
    pub fn sample(&self, uv: Vec2, filter: Filter) -> Vec3 {
        let p = (uv - self.first) / self.step;
        match filter {
            Filter::Nearest => {
                let nearest = (p + Vec2::splat(0.5)).floor();
                self.texel(nearest.x as i64, nearest.y as i64)
            }
            Filter::NearestInTriangle => {
                let texel = zero_order_texel(self.image.width, uv);
                self.texel(texel.x.into(), texel.y.into())
            }
            Filter::Bilinear => self.weighted(p, 0, |d| [1.0 - d, d]),
            Filter::Mitchell => self.weighted(p, 1, mitchell_weights),
        }
    }

    fn weighted<const N: usize>(&self, p: Vec2, before: i64, weights: impl Fn(f32) -> [f32; N]) -> Vec3 {
        let base = p.floor();
        let (a, b) = (weights(p.x - base.x), weights(p.y - base.y));
        let (i, j) = (base.x as i64 - before, base.y as i64 - before);
        let mut sum = Vec3::ZERO;
        for (dj, b) in (0..).zip(b) {
            for (di, a) in (0..).zip(a) {
                sum += self.texel(i + di, j + dj) * (a * b);
            }
        }
        sum
    }
}

/// Weights of the texels at −1, 0, 1 and 2 for a point between those at 0 and 1.
pub fn mitchell_weights(at: f32) -> [f32; 4] {
    [mitchell(1.0 + at), mitchell(at), mitchell(1.0 - at), mitchell(2.0 - at)]
}

/// Mitchell and Netravali's piecewise cubic k(x) for B = C = 1/3, x ≥ 0 in texels:
/// (7x³ − 12x² + 16/3)/6 below 1, (−7x³/3 + 12x² − 20x + 32/3)/6 up to 2, 0 beyond.
pub fn mitchell(x: f32) -> f32 {
    if x < 1.0 {
        ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0
    } else if x < 2.0 {
        (((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0) / 6.0
    } else {
        0.0
    }
}
