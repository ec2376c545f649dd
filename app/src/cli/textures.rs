//! `textures`: ways of reconstructing radiosity from few samples, in numbers and pictures; of a spot whose light is
//! known, or of a surface of a scene.

use super::{
    Common,
    page::{INK, Page},
    parse_point,
    plot::{Panel, Plot},
    solve, surface_texture,
};
use anyhow::bail;
use clap::Args;
use glam::{Vec2, Vec3};
use lumenscope_core::{
    io::exr,
    math::{
        colour::srgb8,
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    measure::{
        grid_texture::{Prefilter, StageSettings},
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
    /// Subdivision depths of the chart, 1 to 6: 3, 5, 9, 17, 33 and 65 samples a side; 0 draws none.
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(..=6))]
    depths: u32,
    /// Scene, one of whose surfaces is looked at instead of the spot, at its three stages against the path tracer.
    #[arg(long, requires = "at")]
    scene: Option<PathBuf>,
    /// A point on or beside that surface, m.
    #[arg(long, value_parser = parse_point, allow_hyphen_values = true, requires = "scene")]
    at: Option<Vec3>,
    /// Texels of the Hermite stage a step between nodes, 1 to 4.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4))]
    factor: u32,
    /// Width of the Gaussian prefilter in texels, 1 (none) to 6; as narrow as light needs it by default.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=6))]
    prefilter: Option<u32>,
    /// Height of the lamp over the square, in sides of it: the size of the spot.
    #[arg(long, default_value_t = Spot::default().height)]
    height: f32,
}

/// Prints the table; writes `table.csv`, and for each number of samples `textures_N.exr` with what is shown
/// and `sheet_N.png` with textures, pictures, differences and second differences; and `depths.csv`, `.svg` and
/// `.png` with error against texels and seconds over the depth of subdivision.
///
/// # Errors
/// One line naming the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    if let (Some(scene), Some(at)) = (&options.scene, options.at) {
        let settings = StageSettings {
            factor: options.factor,
            prefilter: options.prefilter.map_or(Prefilter::Adaptive, Prefilter::Gaussian),
            ..StageSettings::default()
        };
        return surface_texture::run(scene, at, &settings, &options.out, common);
    }
    if let Some(bad) = options.samples.iter().find(|n| !is_sampling(**n)) {
        bail!("--samples {bad} is not a power of two plus 1 from 3 to 257");
    }
    if !(options.height > 0.0 && options.height.is_finite()) {
        bail!("--height must be positive, got {}", options.height);
    }
    solve::output_folder(&options.out)?;
    let spot = Spot { height: options.height, ..Spot::default() };
    let mut csv = String::from(HEADER);
    for &samples in &options.samples {
        let rows = reconstructions(&spot, samples)?;
        println!("{samples} x {samples} samples of a spot, height {} of the side", spot.height);
        header();
        for r in &rows {
            row(&mut csv, samples, r);
        }
        let reference = spot.picture();
        let mut layers: Vec<(String, &LinearImage)> = vec![("reference".into(), &reference)];
        layers.extend(rows.iter().map(|r| (r.way.name.replace([' ', ','], "_"), &r.picture)));
        let layers: Vec<(&str, &LinearImage)> = layers.iter().map(|(n, i)| (n.as_str(), *i)).collect();
        exr::write_layers(&options.out.join(format!("textures_{samples}.exr")), &layers, "irradiance, lx")?;
        let page = sheet(&spot, &reference, &rows);
        let path = options.out.join(format!("sheet_{samples}.png"));
        page.write(&path)?;
    }
    solve::write(&options.out.join("table.csv"), &csv)?;
    if options.depths > 0 { depths(options, &spot) } else { Ok(()) }
}

const HEADER: &str =
    "samples,way,texels,build_seconds,show_seconds,mse_lx2,rel_mse,smape,flip,perceptual,crease_lx\n";

fn header() {
    println!(
        "{:<42} {:>7} {:>9} {:>9} {:>7} {:>7} {:>10} {:>8} {:>8} {:>8}",
        "way", "texels", "MSE lx2", "relMSE", "sMAPE", "FLIP", "perceptual", "crease", "build ms", "show ms"
    );
}

/// Prints a way and adds it to a table.
fn row(csv: &mut String, samples: u32, r: &Reconstruction) {
    let (name, texels) = (&r.way.name, texels(r));
    let seconds = [r.way.build_seconds, r.show_seconds];
    let numbers @ [mse, rel_mse, smape, flip, perceptual, crease] =
        [r.mse, r.rel_mse, r.smape, r.flip, r.perceptual, r.crease];
    let [build, show] = seconds.map(|s| 1e3 * s);
    println!(
        "{name:<42} {texels:>7} {mse:>9.2} {rel_mse:>9.2e} {smape:>7.5} {flip:>7.5} {perceptual:>10.6} {crease:>8.4} \
         {build:>8.2} {show:>8.2}"
    );
    let numbers = seconds.iter().chain(&numbers).map(f64::to_string).collect::<Vec<_>>().join(",");
    let _ = writeln!(csv, "{samples},\"{name}\",{texels},{numbers}");
}

/// Every way at every depth of subdivision, as table and chart.
fn depths(options: &Options, spot: &Spot) -> anyhow::Result<()> {
    let mut csv = String::from(HEADER);
    let mut lines: Vec<(String, Vec<Reconstruction>)> = Vec::new();
    for depth in 1..=options.depths {
        let samples = (1 << depth) + 1;
        println!("depth {depth}: {samples} x {samples} samples");
        header();
        for r in reconstructions(spot, samples)? {
            row(&mut csv, samples, &r);
            let r = Reconstruction { picture: LinearImage::new(0, 0), ..r };
            match lines.iter_mut().find(|(kind, _)| *kind == r.way.kind) {
                Some((_, line)) => line.push(r),
                None => lines.push((r.way.kind.clone(), vec![r])),
            }
        }
    }
    solve::write(&options.out.join("depths.csv"), &csv)?;
    type Number = fn(&Reconstruction) -> f64;
    let panel = |title: &str, axes: [&str; 2], x: Number, y: Number| Panel {
        title: title.into(),
        axes: axes.map(String::from),
        lines: lines.iter().map(|(_, line)| line.iter().map(|r| [x(r), y(r)]).collect()).collect(),
        level: None,
        front: true,
    };
    let seconds: Number = |r| r.way.build_seconds + r.show_seconds;
    let plot = Plot {
        title: format!(
            "Reconstructions of a bright spot, height {} of the side, from 3 x 3 samples on: a point a depth, 1 to {}",
            spot.height, options.depths
        ),
        names: lines.iter().map(|(kind, _)| kind.clone()).collect(),
        panels: vec![
            panel("error against memory", ["texels", "relMSE"], |r| texels(r) as f64, |r| r.rel_mse),
            panel(
                "error against time",
                ["building and showing 513 x 513 points, s", "relMSE"],
                seconds,
                |r| r.rel_mse,
            ),
            panel("creases against memory", ["texels", "crease, lx"], |r| texels(r) as f64, |r| r.crease),
        ],
    };
    plot.write(&options.out, "depths")
}

fn texels(r: &Reconstruction) -> usize {
    r.way.texture.image.pixels.len()
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
        let (name, way) = r.way.name.split_once(", ").unwrap_or((&r.way.name, ""));
        let words = [
            name.to_owned(),
            way.to_owned(),
            format!("relMSE {:.5}", r.rel_mse),
            format!("perceptual {:.5}", r.perceptual),
            format!("FLIP {:.4}   crease {:.3} lx", r.flip, r.crease),
        ];
        row(i + 1, &|p| r.way.texture.sample(p, Filter::Nearest), &r.picture, &words);
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
