//! A picture held against its reference in every measure at once, as `compare` prints and the window shows.

use super::{
    MeasureError,
    image::{
        Flip, PIXELS_PER_DEGREE, WorstPixel, flip_displayed, mean_signed, mse, rel_mse, smape, worst_pixel,
    },
    perceptual,
};
use crate::math::image::LinearImage;
use glam::Vec3;
use std::fmt::Write as _;

/// How far a picture is from its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureError {
    /// Mean squared error, (cd/m²)².
    pub mse: f64,
    /// Relative mean squared error.
    pub rel_mse: f64,
    /// Symmetric mean absolute percentage error as a fraction.
    pub smape: f64,
    /// Mean of the differences per channel, cd/m².
    pub mean_signed: Vec3,
    /// Mean FLIP of the two as they are displayed, 0 to 1.
    pub flip: f64,
    /// Perceptual difference of the report.
    pub perceptual: f64,
    /// The pixel that is furthest off.
    pub worst: WorstPixel,
}

impl PictureError {
    /// Judges a picture; `display` brings one to sRGB bytes as it is looked at. With the map of FLIP.
    ///
    /// # Errors
    /// [`MeasureError`] if sizes differ, there are no pixels, or one is not finite.
    pub fn new(
        image: &LinearImage,
        reference: &LinearImage,
        display: impl Fn(&LinearImage) -> Vec<[u8; 4]>,
    ) -> Result<(Self, Flip), MeasureError> {
        let worst = worst_pixel(image, reference)?;
        let flip = flip_displayed(&display(image), &display(reference), image.width, PIXELS_PER_DEGREE)?;
        let error = Self {
            mse: mse(image, reference)?,
            rel_mse: rel_mse(image, reference)?,
            smape: smape(image, reference)?,
            mean_signed: mean_signed(image, reference)?,
            flip: flip.mean,
            perceptual: perceptual::difference(image, reference, PIXELS_PER_DEGREE)?,
            worst,
        };
        Ok((error, flip))
    }

    /// Name, number and unit of each measure, with what it means.
    pub fn rows(&self) -> [(&'static str, f64, &'static str, &'static str); 6] {
        let unit = "cd/m²";
        [
            (
                "MSE",
                self.mse,
                "(cd/m²)²",
                "Mean squared error over pixels and channels: weighs what is far off",
            ),
            (
                "relMSE",
                self.rel_mse,
                "",
                "Mean of (x − r)² / (r² + ε), ε a tenth of the mean, squared: weighs shadows",
            ),
            ("sMAPE", 100.0 * self.smape, "%", "Mean of 2 |x − r| / (|x| + |r|)"),
            (
                "FLIP",
                self.flip,
                "",
                "What an observer notices who flips between the two, mean over the picture",
            ),
            (
                "perceptual",
                self.perceptual,
                "",
                "Difference of lightness, each frequency weighted by the eye's contrast sensitivity",
            ),
            (
                "worst pixel",
                f64::from(self.worst.difference),
                unit,
                "Largest |x − r| over pixels and channels",
            ),
        ]
    }

    /// The numbers, tab-separated: name, value, unit; the worst pixel with its column and row.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (name, value, unit, _) in self.rows() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name}\t{value}\t{unit}");
        }
        let WorstPixel { x, y, image, reference, .. } = self.worst;
        let _ = writeln!(text, "worst at column, row\t{x}\t{y}");
        for (name, v) in
            [("its value", image), ("the reference's", reference), ("mean x − r", self.mean_signed)]
        {
            let _ = writeln!(text, "{name}\t{} {} {}\tcd/m²", v.x, v.y, v.z);
        }
        text
    }
}
