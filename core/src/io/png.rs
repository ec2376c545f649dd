//! Display-encoded pictures as PNG.

use super::{IoError, write_file};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::path::Path;

/// Writes an eight-bit sRGB picture, row-major from the top left; `N` is 3 (RGB) or 4 (RGBA).
///
/// # Errors
/// [`IoError::Write`] naming the file and the cause, a wrong number of pixels included.
pub fn write_png<const N: usize>(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[u8; N]],
) -> Result<(), IoError> {
    const { assert!(N == 3 || N == 4, "a pixel has 3 or 4 channels") };
    if width == 0 || height == 0 || pixels.len() != width as usize * height as usize {
        let cause = format!("{} pixels do not make {width}x{height}", pixels.len());
        return Err(IoError::write(path, cause));
    }
    let kind = if N == 3 { ExtendedColorType::Rgb8 } else { ExtendedColorType::Rgba8 };
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(pixels.as_flattened(), width, height, kind)
        .map_err(|cause| IoError::write(path, cause))?;
    write_file(path, &bytes)
}
