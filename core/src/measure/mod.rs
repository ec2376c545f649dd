//! How far pictures and irradiances are from each other.
//!
//! Several numbers and not one: squared errors weigh fireflies, relative ones weigh shadows, FLIP and
//! the perceptual difference weigh what is seen, signed ones tell bias from noise.

mod ball_texture;
pub mod chart;
pub mod grid_orders;
pub mod grid_texture;
pub mod image;
pub mod irradiance;
pub mod leak;
pub mod lightmap;
pub mod perceptual;
pub mod picture;
pub mod reconstruction;
pub mod significance;
pub mod sweep;
mod triangle_texture;
mod tube_texture;
pub mod volume;

use crate::math::image::LinearImage;

/// What keeps two things from being compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// Two images differ in size.
    #[error(
        "cannot compare an image of {image_width}x{image_height} pixels with a reference of {reference_width}x{reference_height}"
    )]
    SizeMismatch {
        /// Width of the image.
        image_width: u32,
        /// Height of the image.
        image_height: u32,
        /// Width of the reference.
        reference_width: u32,
        /// Height of the reference.
        reference_height: u32,
    },
    /// Two lists differ in length.
    #[error("cannot compare {found} values with {reference} reference values")]
    LengthMismatch {
        /// Values.
        found: usize,
        /// Reference values.
        reference: usize,
    },
    /// There is nothing to compare.
    #[error("cannot compare empty images or lists")]
    Empty,
    /// A value is NaN or infinite.
    #[error("value {index} of the {which} is not finite")]
    NotFinite {
        /// "image" or "reference".
        which: &'static str,
        /// Its row-major index.
        index: usize,
    },
}

/// Checks that two images can be compared.
fn check(image: &LinearImage, reference: &LinearImage) -> Result<(), MeasureError> {
    if (image.width, image.height) != (reference.width, reference.height) {
        return Err(MeasureError::SizeMismatch {
            image_width: image.width,
            image_height: image.height,
            reference_width: reference.width,
            reference_height: reference.height,
        });
    }
    check_values(&image.pixels, &reference.pixels)
}

/// Checks that two lists of values can be compared.
fn check_values(found: &[glam::Vec3], reference: &[glam::Vec3]) -> Result<(), MeasureError> {
    if found.len() != reference.len() {
        return Err(MeasureError::LengthMismatch { found: found.len(), reference: reference.len() });
    }
    if found.is_empty() {
        return Err(MeasureError::Empty);
    }
    for (which, values) in [("image", found), ("reference", reference)] {
        if let Some(index) = values.iter().position(|v| !v.is_finite()) {
            return Err(MeasureError::NotFinite { which, index });
        }
    }
    Ok(())
}
