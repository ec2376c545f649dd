//! Stage 2: a low pass over the texels, so that bilinear display shows no creases (Bastos §5.5.3.2).
//!
//! The Gaussian of k × k texels is the binomial one of order k − 1, "5 × 5, 4th order": weights
//! C(k−1, i) / 2^(k−1) along each axis, variance (k − 1)/4 texels². An even one has its middle between
//! texels: its texture lies half a texel aside and has one texel more, so that nothing is shifted.
//!
//! A wide filter loses what is small. The adaptive one takes, texel by texel, the widest filter up to 5 × 5
//! that moves the value by no more than a share of it: flat light is smoothed and the top of a small spot
//! stays. Between the widths it mixes, which mixes their variances too; weights sum
//! to 1 at every texel, so a constant stays constant.

use super::{Border, RadiosityTexture};
use crate::math::{colour::luminance, image::LinearImage};
use glam::Vec3;

/// Widest Gaussian, texels.
pub const WIDEST: u32 = 6;

/// A texture through a Gaussian of `width` × `width` texels, 1 to [`WIDEST`]; 1 leaves it as it is. The poles of a
/// sphere stay one value each.
///
/// # Panics
/// For another width, and for an even one on what goes round, whose texels cannot lie aside.
pub fn gaussian(texture: &RadiosityTexture, width: u32) -> RadiosityTexture {
    assert!((1..=WIDEST).contains(&width), "a Gaussian of {width} texels, 1 to {WIDEST}");
    let weights: Vec<f32> =
        (0..width).map(|i| binomial(width - 1, i) / (1u32 << (width - 1)) as f32).collect();
    let closed = texture.border != Border::Clamp;
    assert!(!closed || width % 2 == 1, "an even Gaussian of {width} texels on what goes round");
    let (more, reach) = (u32::from(width.is_multiple_of(2)), i64::from(width / 2));
    let (w, h) = (texture.image.width + more, texture.image.height + more);
    let mut image = LinearImage::from_fn(w, h, |x, y| {
        let mut sum = Vec3::ZERO;
        for (dy, b) in (0..).zip(&weights) {
            for (dx, a) in (0..).zip(&weights) {
                sum += texture.texel(i64::from(x) + dx - reach, i64::from(y) + dy - reach) * (a * b);
            }
        }
        sum
    });
    if texture.border == Border::Sphere {
        one_value_a_pole(&mut image);
    }
    let first = texture.first - 0.5 * more as f32 * texture.step;
    RadiosityTexture { image, first, ..texture.clone() }
}

/// A texture through the widest Gaussian, at most 5 × 5, that moves no texel's luminance by more than
/// `tolerance` of it.
pub fn adaptive(texture: &RadiosityTexture, tolerance: f32) -> RadiosityTexture {
    let levels = [texture.clone(), gaussian(texture, 3), gaussian(texture, 5)];
    let pixels = (0..texture.image.pixels.len()).map(|i| {
        let [own, narrow, wide] = [0, 1, 2].map(|level| levels[level].image.pixels[i]);
        let most = tolerance * luminance(own).abs();
        let [near, far] = [narrow, wide].map(|v| luminance(v - own).abs());
        if near > most {
            own.lerp(narrow, most / near)
        } else if far > most {
            narrow.lerp(wide, ((most - near) / (far - near).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0))
        } else {
            wide
        }
    });
    RadiosityTexture { image: LinearImage { pixels: pixels.collect(), ..texture.image }, ..texture.clone() }
}

/// Gives every texel of the first and of the last row the mean of its row.
fn one_value_a_pole(image: &mut LinearImage) {
    let w = image.width as usize;
    let last = image.pixels.len() - w;
    for row in [0..w, last..last + w] {
        let mean = image.pixels[row.clone()].iter().sum::<Vec3>() / w as f32;
        image.pixels[row].fill(mean);
    }
}

/// n over k.
fn binomial(n: u32, k: u32) -> f32 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f32 / (i + 1) as f32)
}
