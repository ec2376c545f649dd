//! Panoramas read from OpenEXR and Radiance HDR files.

use super::{IoError, exr};
use crate::math::image::LinearImage;
use glam::Vec3;
use std::path::Path;

/// Reads a latitude–longitude picture: the first RGB layer of an `.exr` file, or an `.hdr` file. Values are
/// taken as radiance in cd/m²; negative ones and those that are not finite become black.
///
/// # Errors
/// [`IoError::Read`] naming the file and the cause.
pub fn read(path: &Path) -> Result<LinearImage, IoError> {
    let is_exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    let mut image = if is_exr {
        let first = exr::read_layers(path)?.into_iter().next();
        first.ok_or_else(|| IoError::read(path, "it has no layer"))?.1
    } else {
        let picture = image::open(path).map_err(|cause| IoError::read(path, cause))?.into_rgb32f();
        LinearImage {
            width: picture.width(),
            height: picture.height(),
            pixels: picture.pixels().map(|p| Vec3::from_array(p.0)).collect(),
        }
    };
    for pixel in &mut image.pixels {
        *pixel = if pixel.is_finite() { pixel.max(Vec3::ZERO) } else { Vec3::ZERO };
    }
    Ok(image)
}
