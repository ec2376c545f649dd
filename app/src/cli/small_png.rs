//! Pictures of the tour as small PNG files: a palette of 256 colours, chosen for each picture.
//!
//! Photographs of a window are flat panels, text and a few soft gradients: an eight-bit palette keeps
//! text sharp and is a quarter of the bytes before compression. Not dithered: grain does not compress.
//! Measurements and exports never come this way.

use anyhow::{Context, bail};
use color_quant::NeuQuant;
use lumenscope_core::io::write_file;
use std::{collections::HashMap, path::Path};

/// Colours of a palette.
const COLOURS: usize = 256;
/// Every how many pixels the palette learns from: 1 is best and slowest, 30 fastest.
const STRIDE: i32 = 7;

/// Writes an opaque sRGB picture, row-major from the top left; alpha is passed over.
///
/// # Errors
/// One line naming the file and the cause.
pub fn write(path: &Path, width: u32, height: u32, pixels: &[[u8; 4]]) -> anyhow::Result<()> {
    if width == 0 || pixels.len() != width as usize * height as usize {
        bail!("{}: {} pixels do not make {width}x{height}", path.display(), pixels.len());
    }
    let opaque: Vec<[u8; 4]> = pixels.iter().map(|&[r, g, b, _]| [r, g, b, 255]).collect();
    let (palette, indices) = indexed(&opaque);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette);
    encoder.set_compression(png::Compression::High);
    // Neighbouring indices are no neighbouring colours: there is nothing to predict.
    encoder.set_filter(png::Filter::NoFilter);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&indices))
        .with_context(|| format!("cannot write {}", path.display()))?;
    Ok(write_file(path, &bytes)?)
}

/// A palette as RGB bytes, and the entry of every pixel. Exact where the colours fit.
fn indexed(pixels: &[[u8; 4]]) -> (Vec<u8>, Vec<u8>) {
    let mut known: HashMap<[u8; 4], u8> = HashMap::new();
    let mut order: Vec<[u8; 4]> = Vec::new();
    for &pixel in pixels {
        if order.len() > COLOURS {
            break;
        }
        known.entry(pixel).or_insert_with(|| {
            order.push(pixel);
            (order.len() - 1) as u8
        });
    }
    if order.len() <= COLOURS {
        let palette = order.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        return (palette, pixels.iter().map(|p| known[p]).collect());
    }
    known.clear();
    let quantiser = NeuQuant::new(STRIDE, COLOURS, pixels.as_flattened());
    let nearest = |p: [u8; 4]| quantiser.index_of(&p) as u8;
    let indices = pixels.iter().map(|&p| *known.entry(p).or_insert_with(|| nearest(p))).collect();
    (quantiser.color_map_rgb(), indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_stay_as_they_are_and_many_come_near() {
        let folder = std::env::temp_dir().join(format!("lumenscope-small-png-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a scratch folder");
        let path = folder.join("picture.png");
        let few: Vec<[u8; 4]> =
            (0..64 * 32).map(|i| [(i % 9) as u8 * 20, 40, (i / 700) as u8, 255]).collect();
        write(&path, 64, 32, &few).expect("it is written");
        let read = image::open(&path).expect("it opens").to_rgba8();
        assert_eq!(read.as_raw().as_slice(), few.as_flattened());

        let soft: Vec<[u8; 4]> =
            (0..256 * 128).map(|i| [(i % 256) as u8, (i / 256) as u8, 128, 255]).collect();
        write(&path, 256, 128, &soft).expect("it is written");
        let read = image::open(&path).expect("it opens").to_rgba8();
        let off: u64 =
            read.as_raw().iter().zip(soft.as_flattened()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        // 256 colours over 256 × 128 levels stand 11 apart at best, a quarter of that off on average in
        // either channel; the palette is learnt, not laid out, and may be twice as far.
        let mean = off as f32 / (2 * soft.len()) as f32;
        assert!(mean < 6.0, "{mean} levels off on average");
        std::fs::remove_dir_all(&folder).expect("the scratch folder goes");
    }
}
