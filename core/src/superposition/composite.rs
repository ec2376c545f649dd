//! From layers to display: weights, exposure, tone curve or false colour.

use crate::math::{
    colour::{luminance, srgb8},
    false_colour::FalseColour,
    image::LinearImage,
};
use glam::Vec3;

/// What a pixel that is not a number is shown as.
pub const FAULT: [u8; 4] = [255, 0, 255, 255];

/// How the picture is brought to the display. Has a twin in `shaders/superposition/composite.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Display {
    /// Exposure value at ISO 100: a luminance of 1.2 · 2^EV cd/m² becomes display 1.
    pub ev100: f32,
    /// Curve from exposed radiance to display.
    pub tone: ToneCurve,
    /// Luminance as false colour instead of the picture; its range is in cd/m².
    pub false_colour: Option<FalseColour>,
}

/// Curve from exposed radiance to display.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ToneCurve {
    /// Clipped at 1.
    Linear,
    /// Narkowicz's fit of the ACES curve, a shoulder that keeps highlights.
    #[default]
    Filmic,
}

impl Default for Display {
    fn default() -> Self {
        Self { ev100: 7.0, tone: ToneCurve::Filmic, false_colour: None }
    }
}

/// How direct light is evaluated for each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum DirectQuality {
    /// Read from the radiosity elements: soft, and as fine as they are.
    Elements,
    /// Shadow rays at every pixel, this many an area emitter.
    PerPixel(u32),
}

/// How the difference of two pictures is shown, by luminance in cd/m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DifferenceDisplay {
    /// |a − b| on a palette.
    Absolute(FalseColour),
    /// a − b from blue (−range) over white to red (+range).
    Signed {
        /// Luminance difference at the ends, cd/m².
        range: f32,
    },
}

/// Luminance that becomes display 1 at an exposure value, cd/m²: 1.2 · 2^EV (ISO 2720, K = 12.5, as
/// Lagarde and de Rousiers, *Moving Frostbite to PBR*, 2014, sum it up).
pub fn white_luminance(ev100: f32) -> f32 {
    1.2 * ev100.exp2()
}

/// Exposure value that brings the log-average luminance of a picture to display 0.18 (Reinhard et
/// al. 2002, Eq. 1). Black and non-finite pixels do not count; `None` where no other is left.
pub fn auto_exposure(picture: &LinearImage) -> Option<f32> {
    let (mut sum, mut count) = (0.0f64, 0u32);
    for pixel in &picture.pixels {
        let y = luminance(*pixel);
        if y.is_finite() && y > 0.0 {
            sum += f64::from(y).ln();
            count += 1;
        }
    }
    (count > 0).then(|| {
        let log_average = (sum / f64::from(count)).exp() as f32;
        (log_average / (0.18 * 1.2)).log2()
    })
}

impl ToneCurve {
    /// Display value in [0, 1], linear, of an exposed value.
    ///
    /// Filmic: (x(2.51x + 0.03)) / (x(2.43x + 0.59) + 0.14), Narkowicz, *ACES Filmic Tone Mapping
    /// Curve*, 2016, whose exposed 0.6 is our 1, as he says.
    pub fn apply(self, exposed: Vec3) -> Vec3 {
        let x = exposed.max(Vec3::ZERO);
        match self {
            Self::Linear => x.min(Vec3::ONE),
            Self::Filmic => {
                // Beyond 1e4 the curve is flat to the last bit and x² might overflow.
                let x = (x * 0.6).min(Vec3::splat(1e4));
                let y = (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
                y.clamp(Vec3::ZERO, Vec3::ONE)
            }
        }
    }
}

impl Display {
    /// Linear display colour in [0, 1] of a radiance, cd/m².
    pub fn linear(&self, radiance: Vec3) -> Vec3 {
        match &self.false_colour {
            Some(false_colour) => false_colour.colour(luminance(radiance)),
            None => self.tone.apply(radiance / white_luminance(self.ev100)),
        }
    }

    /// Eight-bit sRGB of a radiance, cd/m²; [`FAULT`] where it is not finite.
    pub fn pixel(&self, radiance: Vec3) -> [u8; 4] {
        if !radiance.is_finite() {
            return FAULT;
        }
        let [r, g, b] = srgb8(self.linear(radiance));
        [r, g, b, 255]
    }
}

/// A picture in cd/m² brought to the display: eight-bit sRGB with opaque alpha, row-major.
pub fn display(picture: &LinearImage, display: &Display) -> Vec<[u8; 4]> {
    use rayon::prelude::*;
    picture.pixels.par_iter().map(|p| display.pixel(*p)).collect()
}

/// The difference of two pictures brought to the display.
///
/// # Panics
/// If the pictures differ in size.
pub fn difference(a: &LinearImage, b: &LinearImage, display: &DifferenceDisplay) -> Vec<[u8; 4]> {
    assert_eq!((a.width, a.height), (b.width, b.height), "pictures of different size");
    a.pixels
        .iter()
        .zip(&b.pixels)
        .map(|(a, b)| {
            let difference = luminance(*a) - luminance(*b);
            if !difference.is_finite() {
                return FAULT;
            }
            let colour = match display {
                DifferenceDisplay::Absolute(palette) => palette.colour(difference.abs()),
                DifferenceDisplay::Signed { range } => diverging(difference / range.max(f32::MIN_POSITIVE)),
            };
            let [r, g, b] = srgb8(colour);
            [r, g, b, 255]
        })
        .collect()
}

/// Blue at −1, white at 0, red at 1; linear RGB.
pub fn diverging(t: f32) -> Vec3 {
    const NEGATIVE: Vec3 = Vec3::new(0.02, 0.1, 0.55);
    const POSITIVE: Vec3 = Vec3::new(0.55, 0.03, 0.03);
    let end = if t < 0.0 { NEGATIVE } else { POSITIVE };
    Vec3::ONE.lerp(end, t.abs().min(1.0))
}
