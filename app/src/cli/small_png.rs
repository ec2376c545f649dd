//! Pictures of the tour as small PNG files: 64 levels a channel, compressed as well as PNG can.
//!
//! What a picture of a window loses is the last two bits, two levels of 255 at most: less than the grain
//! of the picture in it, which is what would not compress. Text stays sharp. Not a palette: 256 colours
//! draw bands on a wall. Measurements and exports never come this way.

use anyhow::{Context, bail};
use lumenscope_core::io::write_file;
use std::path::Path;

/// Steps between the levels of a channel, black and white included.
const STEPS: u32 = 63;

/// Writes an opaque sRGB picture, row-major from the top left; alpha is passed over.
///
/// # Errors
/// One line naming the file and the cause.
pub fn write(path: &Path, width: u32, height: u32, pixels: &[[u8; 4]]) -> anyhow::Result<()> {
    if width == 0 || pixels.len() != width as usize * height as usize {
        bail!("{}: {} pixels do not make {width}x{height}", path.display(), pixels.len());
    }
    let levels: Vec<u8> = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b].map(level)).collect();
    let mut smallest: Option<Vec<u8>> = None;
    for filter in [png::Filter::NoFilter, png::Filter::Adaptive] {
        let bytes = encoded(width, height, &levels, filter)
            .with_context(|| format!("cannot write {}", path.display()))?;
        if smallest.as_ref().is_none_or(|s| bytes.len() < s.len()) {
            smallest = Some(bytes);
        }
    }
    Ok(write_file(path, &smallest.unwrap_or_default())?)
}

/// The nearest of the levels kept.
fn level(value: u8) -> u8 {
    let step = (u32::from(value) * STEPS + 127) / 255;
    ((step * 255 + STEPS / 2) / STEPS) as u8
}

fn encoded(width: u32, height: u32, rgb: &[u8], filter: png::Filter) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(filter);
    encoder.write_header()?.write_image_data(rgb)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_comes_back_within_two_levels_black_and_white_whole() {
        assert_eq!((level(0), level(255)), (0, 255));
        let folder = std::env::temp_dir().join(format!("lumenscope-small-png-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a scratch folder");
        let path = folder.join("picture.png");
        let pixels: Vec<[u8; 4]> =
            (0..256 * 16).map(|i| [(i % 256) as u8, (i / 16) as u8, 255 - (i % 256) as u8, 255]).collect();
        write(&path, 256, 16, &pixels).expect("it is written");
        let read = image::open(&path).expect("it opens").to_rgba8();
        let worst = read.as_raw().iter().zip(pixels.as_flattened()).map(|(a, b)| a.abs_diff(*b)).max();
        // Levels stand 255/63 apart: half of that, rounded.
        assert!(worst <= Some(2), "{worst:?}");
        std::fs::remove_dir_all(&folder).expect("the scratch folder goes");
    }
}
