//! `textures`: ways of reconstructing radiosity from few samples, in numbers and pictures.

use super::{
    page::{INK, Page},
    solve,
};
use anyhow::bail;
use clap::Args;
use glam::{Vec2, Vec3};
use lumenscope_core::{
    io::{exr, png},
    math::{
        colour::srgb8,
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    measure::{
        image::second_difference,
        reconstruction::{REFERENCE_SIDE, Reconstruction, Spot, is_sampling, reconstructions},
    },
    radiosity::texture::display::Filter,
};
use std::{fmt::Write, path::PathBuf};

/// Side of a picture on the sheet, pixels.
const TILE: usize = 150;
const MARGIN: usize = 12;
const HEAD: usize = 40;
const WORDS: usize = 380;

/// Options of `textures`.
#[derive(Args)]
pub struct Options {
    /// Folder for the table, the pictures and the textures.
    #[arg(long)]
    out: PathBuf,
    /// Samples a side, a power of two plus 1, from 3 to 257; several with commas.
    #[arg(long, default_value = "5", value_delimiter = ',')]
    samples: Vec<u32>,
    /// Height of the lamp over the square, in sides of it: the size of the spot.
    #[arg(long, default_value_t = Spot::default().height)]
    height: f32,
}

/// Prints the table; writes `table.csv`, and for each number of samples `textures_N.exr` with what is shown
/// and `sheet_N.png` with textures, pictures, differences and second differences.
///
/// # Errors
/// One line naming the cause.
pub fn run(options: &Options) -> anyhow::Result<()> {
    if let Some(bad) = options.samples.iter().find(|n| !is_sampling(**n)) {
        bail!("--samples {bad} is not a power of two plus 1 from 3 to 257");
    }
    if !(options.height > 0.0 && options.height.is_finite()) {
        bail!("--height must be positive, got {}", options.height);
    }
    solve::output_folder(&options.out)?;
    let spot = Spot { height: options.height, ..Spot::default() };
    let mut csv = String::from("samples,way,texels,mse_lx2,rel_mse,smape,flip,perceptual,crease_lx\n");
    for &samples in &options.samples {
        let rows = reconstructions(&spot, samples)?;
        println!("{samples} x {samples} samples of a spot, height {} of the side", spot.height);
        println!(
            "{:<42} {:>7} {:>9} {:>9} {:>7} {:>7} {:>10} {:>8}",
            "way", "texels", "MSE lx2", "relMSE", "sMAPE", "FLIP", "perceptual", "crease"
        );
        for r in &rows {
            let (name, texels) = (&r.name, texels(r));
            let numbers @ [mse, rel_mse, smape, flip, perceptual, crease] =
                [r.mse, r.rel_mse, r.smape, r.flip, r.perceptual, r.crease];
            println!(
                "{name:<42} {texels:>7} {mse:>9.2} {rel_mse:>9.6} {smape:>7.5} {flip:>7.5} {perceptual:>10.6} \
                 {crease:>8.4}"
            );
            let numbers = numbers.map(|n| n.to_string()).join(",");
            let _ = writeln!(csv, "{samples},\"{name}\",{texels},{numbers}");
        }
        let reference = spot.picture();
        let mut layers: Vec<(String, &LinearImage)> = vec![("reference".into(), &reference)];
        layers.extend(rows.iter().map(|r| (r.name.replace([' ', ','], "_"), &r.picture)));
        let layers: Vec<(&str, &LinearImage)> = layers.iter().map(|(n, i)| (n.as_str(), *i)).collect();
        exr::write_layers(&options.out.join(format!("textures_{samples}.exr")), &layers, "irradiance, lx")?;
        let page = sheet(&spot, &reference, &rows);
        let path = options.out.join(format!("sheet_{samples}.png"));
        png::write_png(&path, page.width as u32, page.height as u32, &page.pixels)?;
    }
    solve::write(&options.out.join("table.csv"), &csv)
}

fn texels(r: &Reconstruction) -> usize {
    r.texture.image.pixels.len()
}

/// The reference, then a row a way: its texels, what is shown, the difference and the second difference.
fn sheet(spot: &Spot, reference: &LinearImage, rows: &[Reconstruction]) -> Page {
    let mut page = Page::new(WORDS + 4 * (TILE + MARGIN) + MARGIN, HEAD + (rows.len() + 1) * (TILE + MARGIN));
    let bends = second_difference(reference);
    let largest = |image: &LinearImage| image.pixels.iter().map(|p| p.x.abs()).fold(0.0, f32::max);
    let most = rows.iter().fold(0.0, |most: f32, r| most.max(largest(&minus(&r.picture, reference))));
    let (most, bend) = (0.5 * most, 4.0 * largest(&bends));
    let signed = |range: f32| FalseColour::over([-range, range], Palette::Diverging);
    let grey = |v: Vec3| srgb8(v / spot.peak_lx);
    for (column, title) in ["texels", "shown", "difference", "second difference"].iter().enumerate() {
        page.text(WORDS + column * (TILE + MARGIN), 8, 1, title, INK);
    }
    let ranges = format!("difference +-{most:.0} lx, second +-{bend:.2} lx");
    page.text(MARGIN, 8, 1, &ranges, INK);
    let mut row = |i: usize, texels: &dyn Fn(Vec2) -> Vec3, picture: &LinearImage, words: &[String]| {
        let top = HEAD + i * (TILE + MARGIN);
        for (line, words) in words.iter().enumerate() {
            page.text(MARGIN, top + 16 * line, 1, words, INK);
        }
        let (off, bends) = (minus(picture, reference), second_difference(picture));
        for y in 0..TILE {
            for x in 0..TILE {
                let p = Vec2::new(x as f32, y as f32) / (TILE - 1) as f32;
                let at = (p * (REFERENCE_SIDE - 1) as f32).as_uvec2();
                let colours = [
                    grey(texels(p)),
                    grey(picture.at(at.x, at.y)),
                    srgb8(signed(most).colour(off.at(at.x, at.y).x)),
                    srgb8(signed(bend).colour(strongest(&bends, at.x, at.y))),
                ];
                for (column, colour) in colours.into_iter().enumerate() {
                    page.put(WORDS + column * (TILE + MARGIN) + x, top + y, colour);
                }
            }
        }
    };
    row(0, &|p| spot.irradiance(p), reference, &["reference".into()]);
    for (i, r) in rows.iter().enumerate() {
        let (name, way) = r.name.split_once(", ").unwrap_or((&r.name, ""));
        let words = [
            name.to_owned(),
            way.to_owned(),
            format!("relMSE {:.5}", r.rel_mse),
            format!("perceptual {:.5}", r.perceptual),
            format!("FLIP {:.4}   crease {:.3} lx", r.flip, r.crease),
        ];
        row(i + 1, &|p| r.texture.sample(p, Filter::Nearest), &r.picture, &words);
    }
    page
}

fn minus(a: &LinearImage, b: &LinearImage) -> LinearImage {
    LinearImage::from_fn(a.width, a.height, |x, y| a.at(x, y) - b.at(x, y))
}

/// The value furthest from zero in the 4 × 4 pixels from (x, y) on: a crease is one pixel wide.
fn strongest(image: &LinearImage, x: u32, y: u32) -> f32 {
    let mut found = 0f32;
    for v in y..(y + 4).min(image.height) {
        for u in x..(x + 4).min(image.width) {
            let value = image.at(u, v).x;
            if value.abs() > found.abs() {
                found = value;
            }
        }
    }
    found
}
