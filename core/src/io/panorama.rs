//! Panoramas and lightmaps read from OpenEXR, Radiance HDR and other pictures.

use super::{IoError, exr};
use crate::math::image::LinearImage;
use glam::Vec3;
use std::path::Path;

/// Reads a latitude–longitude picture as [`read_as_written`] does. Values are taken as radiance in cd/m²;
/// negative ones and those that are not finite become black.
///
/// # Errors
/// [`IoError::Read`] naming the file and the cause.
pub fn read(path: &Path) -> Result<LinearImage, IoError> {
    let mut image = read_as_written(path)?;
    image.clear_invalid();
    Ok(image)
}

/// Reads the first RGB layer of an `.exr` file, or another picture, with the values it holds.
///
/// # Errors
/// [`IoError::Read`] naming the file and the cause.
pub fn read_as_written(path: &Path) -> Result<LinearImage, IoError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        let first = exr::read_layers(path)?.into_iter().next();
        return Ok(first.ok_or_else(|| IoError::read(path, "it has no layer"))?.1);
    }
    let picture = image::open(path).map_err(|cause| IoError::read(path, cause))?.into_rgb32f();
    Ok(LinearImage {
        width: picture.width(),
        height: picture.height(),
        pixels: picture.pixels().map(|p| Vec3::from_array(p.0)).collect(),
    })
}
