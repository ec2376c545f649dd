//! Panoramas and lightmaps as files: OpenEXR, Radiance HDR and other pictures.
//!
//! OpenEXR has an attribute for latitude–longitude maps and with it +z in the middle; a picture without
//! the attribute is taken to have −z there, as [`panorama`](crate::irradiance_volume::panorama) has it.

use super::{
    IoError,
    exr::{self, Part},
};
use crate::{irradiance_volume::panorama::half_turned, math::image::LinearImage};
use glam::Vec3;
use std::path::Path;

/// Writes a panorama taken at a point, m, as an OpenEXR environment map that any viewer shows the right way.
///
/// # Errors
/// [`IoError::Write`] naming the file and the cause.
pub fn write(path: &Path, image: &LinearImage, at: Vec3) -> Result<(), IoError> {
    let turned = half_turned(image);
    let note =
        format!("latitude-longitude panorama at {at} m, radiance in cd/m2; +z in the middle, +x left of it");
    exr::write_parts(
        path,
        &[Part { layers: &[("", &turned)], note: &note, is_environment: true, ..Part::default() }],
    )
}

/// Reads a latitude–longitude picture, turned so that −z is in the middle. Values are taken as radiance in
/// cd/m²; negative ones and those that are not finite become black.
///
/// # Errors
/// [`IoError::Read`] naming the file and the cause.
pub fn read(path: &Path) -> Result<LinearImage, IoError> {
    let (image, is_environment) = read_first(path)?;
    let mut image = if is_environment { half_turned(&image) } else { image };
    image.clear_invalid();
    Ok(image)
}

/// Reads the first RGB layer of an `.exr` file, or another picture, with the values it holds.
///
/// # Errors
/// [`IoError::Read`] naming the file and the cause.
pub fn read_as_written(path: &Path) -> Result<LinearImage, IoError> {
    Ok(read_first(path)?.0)
}

fn read_first(path: &Path) -> Result<(LinearImage, bool), IoError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        return exr::read_first(path);
    }
    let picture = image::open(path).map_err(|cause| IoError::read(path, cause))?.into_rgb32f();
    let (width, height) = picture.dimensions();
    let pixels = picture.pixels().map(|p| Vec3::from_array(p.0)).collect();
    Ok((LinearImage { width, height, pixels }, false))
}
