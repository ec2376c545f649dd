//! The perceptual difference of the reconstruction work the program follows: the first model of
//! Rushmeier, Ward, Piatko, Sanders and Rust, *Comparing Real and Synthetic Images: Some Ideas about
//! Metrics* (1995), after Mannos and Sakrison (1974).
//!
//! Each image is divided by its own mean luminance (so exposure does not count), each pixel replaced
//! by its cube root, both are taken to the frequency domain and weighted by the eye's contrast
//! sensitivity, and the root of the mean squared difference is the figure. Choices the source leaves
//! open: luminance only; the result is per pixel (Parseval's 1/N² applied) in units of the cube root
//! of the mean luminance; the discrete transform wraps at the borders, so a ramp across the picture
//! leaks. FLIP and not this one knows colour and edges; this one keeps published figures comparable.

use super::{MeasureError, check};
use crate::math::{colour::luminance, fourier::transform, image::LinearImage};
use rustfft::num_complex::Complex;

/// Contrast sensitivity at `frequency`, cycles/degree, relative to a peak near 1 at 8 cycles/degree:
/// A(f) = 2.6 (0.0192 + 0.114 f) exp(−(0.114 f)^1.1) (Mannos and Sakrison 1974).
pub fn contrast_sensitivity(frequency: f64) -> f64 {
    let scaled = 0.114 * frequency.abs();
    2.6 * (0.0192 + scaled) * (-scaled.powf(1.1)).exp()
}

/// Perceptual difference of two linear pictures: 0 for equal ones, symmetric.
///
/// # Errors
/// [`MeasureError`] if sizes differ, there are no pixels, or one is not finite.
pub fn difference(
    image: &LinearImage,
    reference: &LinearImage,
    pixels_per_degree: f32,
) -> Result<f64, MeasureError> {
    check(image, reference)?;
    let (a, b) = (lightness(image), lightness(reference));
    let mut spectrum: Vec<Complex<f64>> = a.iter().zip(&b).map(|(a, b)| Complex::new(a - b, 0.0)).collect();
    let (w, h) = (image.width as usize, image.height as usize);
    transform(&mut spectrum, w, h, true);
    let frequency = |i: usize, n: usize| {
        let signed = if 2 * i > n { i as f64 - n as f64 } else { i as f64 };
        signed / n as f64 * f64::from(pixels_per_degree)
    };
    let mut power = 0.0;
    for (y, row) in spectrum.chunks(w).enumerate() {
        for (x, value) in row.iter().enumerate() {
            let sensitivity = contrast_sensitivity(frequency(x, w).hypot(frequency(y, h)));
            power += sensitivity * sensitivity * value.norm_sqr();
        }
    }
    Ok(power.sqrt() / (w * h) as f64)
}

/// Cube root of luminance over mean luminance; zero for a black image.
fn lightness(image: &LinearImage) -> Vec<f64> {
    let values: Vec<f64> = image.pixels.iter().map(|p| f64::from(luminance(*p))).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let scale = if mean > 0.0 { 1.0 / mean } else { 0.0 };
    values.iter().map(|v| (v * scale).cbrt()).collect()
}
