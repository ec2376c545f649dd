//! Picture files to linear textures.

use crate::math::{colour::linear_from_srgb, image::LinearImage};
use glam::Vec3;
use image::{DynamicImage, ImageReader};
use std::io::Cursor;

/// Decodes PNG and JPEG as sRGB, and Radiance HDR as linear values.
///
/// # Errors
/// With the cause in words, if the bytes are no picture or hold none.
pub fn decode(bytes: &[u8]) -> Result<LinearImage, String> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let picture = reader.decode().map_err(|e| e.to_string())?;
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err("it has no pixels".into());
    }
    let pixels = match &picture {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => picture
            .to_rgb32f()
            .pixels()
            .map(|p| Vec3::from(p.0).map(|v| if v.is_finite() { v.max(0.0) } else { 0.0 }))
            .collect(),
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            picture.to_rgb32f().pixels().map(|p| Vec3::from(p.0).map(linear_from_srgb)).collect()
        }
        _ => {
            let table: Vec<f32> = (0..256).map(|v| linear_from_srgb(v as f32 / 255.0)).collect();
            let linear = |v: u8| table[usize::from(v)];
            picture.to_rgb8().pixels().map(|p| Vec3::from(p.0.map(linear))).collect()
        }
    };
    Ok(LinearImage { width, height, pixels })
}
