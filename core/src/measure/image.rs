//! Differences between pictures, pixel by pixel, and FLIP.
//!
//! Means run over pixels and channels in `f64`. The linear measures take radiance as it is; FLIP
//! models an observer of a display and takes display-encoded pixels.

use super::{MeasureError, check};
use crate::math::{colour::srgb8, image::LinearImage};
use glam::{DVec3, Vec3};

/// Share of the reference's mean that steadies the relative error in the dark.
const DARK_SHARE: f64 = 0.1;

/// Mean squared error, (cd/m²)².
///
/// # Errors
/// [`MeasureError`] if sizes differ, there are no pixels, or one is not finite; so for all here.
pub fn mse(image: &LinearImage, reference: &LinearImage) -> Result<f64, MeasureError> {
    mean_over_channels(image, reference, |x, r| (x - r) * (x - r))
}

/// Relative mean squared error, (x − r)² / (r² + ε), ε = (0.1 r̄)² with r̄ the mean of the reference.
///
/// Rousselle, Knaus and Zwicker (2011) take ε = 0.01 for pictures whose mean is near 1; ours are in
/// cd/m², so ε follows the mean and the figure does not depend on the exposure.
///
/// # Errors
/// As [`mse`].
pub fn rel_mse(image: &LinearImage, reference: &LinearImage) -> Result<f64, MeasureError> {
    let mean = mean_over_channels(image, reference, |_, r| r)?;
    let epsilon = (DARK_SHARE * mean).powi(2).max(f64::MIN_POSITIVE);
    mean_over_channels(image, reference, |x, r| (x - r) * (x - r) / (r * r + epsilon))
}

/// [`rel_mse`] of the pixels that count, less what the reference's own noise makes of it:
/// mean of ((x − r)² − Var r) / (r² + ε), with `variance` that of each pixel of the reference, (cd/m²)².
///
/// Without bias where the noise of the two is independent, so that a few pixels may come out below zero; 0 where no
/// pixel counts.
///
/// # Errors
/// As [`mse`], the sizes of the variance included.
pub fn rel_mse_without_noise(
    image: &LinearImage,
    reference: &LinearImage,
    variance: &LinearImage,
    counts: impl Fn(usize) -> bool,
) -> Result<f64, MeasureError> {
    check(image, reference)?;
    check(variance, reference)?;
    let counted: Vec<usize> = (0..reference.pixels.len()).filter(|&i| counts(i)).collect();
    let mean_of = |value: &dyn Fn(usize, usize) -> f64| {
        let sum: f64 =
            counted.iter().flat_map(|&i| (0..3).map(move |c| (i, c))).map(|(i, c)| value(i, c)).sum();
        sum / (3 * counted.len()).max(1) as f64
    };
    let of = |image: &LinearImage, i: usize, c: usize| f64::from(image.pixels[i][c]);
    let mean = mean_of(&|i, c| of(reference, i, c));
    let epsilon = (DARK_SHARE * mean).powi(2).max(f64::MIN_POSITIVE);
    Ok(mean_of(&|i, c| {
        let (x, r) = (of(image, i, c), of(reference, i, c));
        ((x - r).powi(2) - of(variance, i, c)) / (r * r + epsilon)
    }))
}

/// Symmetric mean absolute percentage error as a fraction, 2 |x − r| / (|x| + |r|), in [0, 2].
///
/// # Errors
/// As [`mse`].
pub fn smape(image: &LinearImage, reference: &LinearImage) -> Result<f64, MeasureError> {
    mean_over_channels(image, reference, |x, r| {
        let size = x.abs() + r.abs();
        if size > 0.0 { 2.0 * (x - r).abs() / size } else { 0.0 }
    })
}

/// Mean of x − r per channel, cd/m²: bias, where noise cancels.
///
/// # Errors
/// As [`mse`].
pub fn mean_signed(image: &LinearImage, reference: &LinearImage) -> Result<Vec3, MeasureError> {
    check(image, reference)?;
    let sum = image
        .pixels
        .iter()
        .zip(&reference.pixels)
        .fold(DVec3::ZERO, |s, (x, r)| s + x.as_dvec3() - r.as_dvec3());
    Ok((sum / image.pixels.len() as f64).as_vec3())
}

/// Peak signal-to-noise ratio, 10 log₁₀(peak² / MSE), dB; infinite for equal images.
///
/// # Errors
/// As [`mse`].
pub fn psnr(image: &LinearImage, reference: &LinearImage, peak: f32) -> Result<f64, MeasureError> {
    Ok(10.0 * (f64::from(peak).powi(2) / mse(image, reference)?).log10())
}

/// The pixel that is furthest off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstPixel {
    /// Column.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Largest |x − r| over its channels, cd/m².
    pub difference: f32,
    /// Its value, cd/m².
    pub image: Vec3,
    /// The reference's value, cd/m².
    pub reference: Vec3,
}

/// The pixel with the largest difference in any channel; the first of equals.
///
/// # Errors
/// As [`mse`].
pub fn worst_pixel(image: &LinearImage, reference: &LinearImage) -> Result<WorstPixel, MeasureError> {
    check(image, reference)?;
    let difference = |i: usize| (image.pixels[i] - reference.pixels[i]).abs().max_element();
    let worst = (1..image.pixels.len()).fold(0, |w, i| if difference(i) > difference(w) { i } else { w });
    Ok(WorstPixel {
        x: worst as u32 % image.width,
        y: worst as u32 / image.width,
        difference: difference(worst),
        image: image.pixels[worst],
        reference: reference.pixels[worst],
    })
}

/// FLIP: what an observer flipping between two displayed pictures would notice.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// Mean over pixels, 0 (equal) to 1.
    pub mean: f64,
    /// Difference of each pixel in [0, 1], row-major.
    pub map: Vec<f32>,
}

/// Pixels per degree of visual angle of FLIP's default viewer: 0.7 m from a 0.7 m wide 3840-pixel screen.
pub const PIXELS_PER_DEGREE: f32 = nv_flip::DEFAULT_PIXELS_PER_DEGREE;

/// FLIP (Andersson et al. 2020) of two linear pictures shown as sRGB after multiplying by `exposure`,
/// m²/cd, and clipping at 1.
///
/// # Errors
/// As [`mse`].
pub fn flip(
    image: &LinearImage,
    reference: &LinearImage,
    exposure: f32,
    pixels_per_degree: f32,
) -> Result<Flip, MeasureError> {
    check(image, reference)?;
    let bytes = |i: &LinearImage| i.pixels.iter().flat_map(|p| srgb8(*p * exposure)).collect::<Vec<u8>>();
    let size = (image.width, image.height);
    Ok(flip_bytes(&bytes(image), &bytes(reference), size, pixels_per_degree))
}

/// FLIP of two display-encoded sRGB pictures of `width` columns; alpha is ignored.
///
/// # Errors
/// [`MeasureError`] if their lengths differ or are no multiple of `width`, or there are no pixels.
pub fn flip_displayed(
    image: &[[u8; 4]],
    reference: &[[u8; 4]],
    width: u32,
    pixels_per_degree: f32,
) -> Result<Flip, MeasureError> {
    let columns = width as usize;
    if image.is_empty() || columns == 0 {
        return Err(MeasureError::Empty);
    }
    if image.len() != reference.len() || !image.len().is_multiple_of(columns) {
        return Err(MeasureError::LengthMismatch { found: image.len(), reference: reference.len() });
    }
    let bytes = |pixels: &[[u8; 4]]| pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect::<Vec<u8>>();
    let size = (width, (image.len() / columns) as u32);
    Ok(flip_bytes(&bytes(image), &bytes(reference), size, pixels_per_degree))
}

fn flip_bytes(image: &[u8], reference: &[u8], (w, h): (u32, u32), pixels_per_degree: f32) -> Flip {
    let of = |data: &[u8]| nv_flip::FlipImageRgb8::with_data(w, h, data);
    let map = nv_flip::flip(of(reference), of(image), pixels_per_degree).to_vec();
    let mean = map.iter().map(|&v| f64::from(v)).sum::<f64>() / map.len() as f64;
    Flip { mean, map }
}

/// Second difference at every pixel, the sum of its four neighbours less four times itself: what makes Mach
/// bands, in the image's unit a pixel². Zero on the border.
pub fn second_difference(image: &LinearImage) -> LinearImage {
    let (w, h) = (image.width, image.height);
    LinearImage::from_fn(w, h, |x, y| {
        if x == 0 || y == 0 || x + 1 >= w || y + 1 >= h {
            return Vec3::ZERO;
        }
        let around = image.at(x - 1, y) + image.at(x + 1, y) + image.at(x, y - 1) + image.at(x, y + 1);
        around - 4.0 * image.at(x, y)
    })
}

fn mean_over_channels(
    image: &LinearImage,
    reference: &LinearImage,
    error: impl Fn(f64, f64) -> f64,
) -> Result<f64, MeasureError> {
    check(image, reference)?;
    let sum: f64 = image
        .pixels
        .iter()
        .zip(&reference.pixels)
        .map(|(x, r)| (0..3).map(|c| error(f64::from(x[c]), f64::from(r[c]))).sum::<f64>())
        .sum();
    Ok(sum / (3 * image.pixels.len()) as f64)
}
