//! `reflectance`: how polished materials reflect by angle, as maps, graphs and a table, and what that makes of a
//! mirror image (Bastos 1999, Fig. 6.23 and 6.24).

use super::{
    Common, parse_size,
    render::{auto_display, write_layers, write_png},
    solve,
};
use anyhow::bail;
use clap::Args;
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    inspection::{Curve, InspectionScene},
    io::png,
    math::image::LinearImage,
    mirror::{inspect, pass::mirror_image, reflectors::Reflectors},
    scene::{brdf::Specular, geometry::Geometry},
    superposition::{
        PassSettings,
        composite::{DirectQuality, Display, ToneCurve, white_luminance},
        layers::Layer,
        pass::Shading,
        render,
    },
};
use std::{fmt::Write as _, path::PathBuf};

/// Options of `reflectance`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Folder for maps and graphs, `reflectance.csv` and the pictures of the mirrors.
    #[arg(long)]
    out: PathBuf,
    /// Size of the pictures.
    #[arg(long, default_value = "480x360", value_parser = parse_size)]
    size: [u32; 2],
    /// A metal's reflectance at normal incidence, R,G,B, to show besides the scene's: gold is 0.63,0.56,0.37.
    #[arg(long, value_parser = parse_reflectance)]
    metal: Vec<Vec3>,
}

fn parse_reflectance(text: &str) -> Result<Vec3, String> {
    let wrong = || format!("`{text}` is not R,G,B, each from 0 to 1");
    let channels: Vec<f32> = text.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    match channels[..] {
        [r, g, b] if text.split(',').count() == 3 && channels.iter().all(|c| (0.0..=1.0).contains(c)) => {
            Ok(Vec3::new(r, g, b))
        }
        _ => Err(wrong()),
    }
}

/// Width and height of a graph, pixels.
const GRAPH: [u32; 2] = [260, 180];

/// Writes everything and prints the notes.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let mut shown = inspect::reflectance(&Geometry::new(&loaded.scene)).unwrap_or_default();
    for &metal in &options.metal {
        let specular = Specular { metal, metallic: 1.0, ..Specular::default() };
        let name = format!("metal {}", metal.to_array().map(|c| c.to_string()).join(" "));
        inspect::add_reflectance(&mut shown, &name, &specular);
    }
    if shown.images.is_empty() {
        bail!("{}: nothing is polished", options.scene.display());
    }
    maps(options, &shown)?;

    let solution = solve::solve(&loaded, false)?;
    let (world, camera) = (&solution.world, &solution.scene.camera);
    let settings =
        PassSettings { direct: DirectQuality::PerPixel(16), seed: common.seed, ..PassSettings::default() };
    let [width, height] = options.size;
    let (buffer, layers) = render(&solution, camera, width, height, &settings);
    let reflectors = Reflectors::new(&world.geometry);
    let shading = Shading::new(&solution, &settings);
    let Some(mirrored) = mirror_image(&shading, &reflectors, &buffer, camera, &settings) else {
        println!("the scene's camera sees no flat mirror: no pictures");
        return Ok(());
    };
    let arriving = LinearImage { width, height, pixels: mirrored.radiance };
    let display = auto_display(&layers.total());
    let pictures =
        [("mirrored", &arriving), ("modulated", layers.get(Layer::Mirror)), ("final", &layers.total())];
    for (name, picture) in pictures {
        write_png(&options.out.join(format!("{name}.png")), picture, &display)?;
    }
    let size = UVec2::from(options.size);
    let beside =
        LinearImage::from_fn(3 * size.x, size.y, |x, y| pictures[(x / size.x) as usize].1.at(x % size.x, y));
    write_png(&options.out.join("triptych.png"), &beside, &display)?;
    write_layers(&options.out.join("layers.exr"), &layers)
}

/// Maps, graphs and the table of a view.
fn maps(options: &Options, shown: &InspectionScene) -> anyhow::Result<()> {
    // Reflectance 1 is white.
    let display =
        Display { ev100: (1.0 / white_luminance(0.0)).log2(), tone: ToneCurve::Linear, false_colour: None };
    let mut table = String::from("material,radius,degrees,r,g,b\n");
    for (image, curves) in shown.images.iter().zip(shown.curves.chunks(3)) {
        let name: String = image.name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
        write_png(&options.out.join(format!("{name}_map.png")), &image.image, &display)?;
        let [width, height] = GRAPH;
        png::write_png(&options.out.join(format!("{name}_graph.png")), width, height, &graph(curves))?;
        for (i, at) in curves[0].points.iter().enumerate().filter(|(_, at)| at.x >= 0.0) {
            let [r, g, b] = [0, 1, 2].map(|channel: usize| curves[channel].points[i].y);
            let degrees = at.x.min(1.0).asin().to_degrees();
            let _ = writeln!(table, "{},{},{degrees},{r},{g},{b}", image.name, at.x);
        }
    }
    for note in &shown.notes {
        println!("{note}");
    }
    solve::write(&options.out.join("reflectance.csv"), &table)
}

/// Reflectance from 0 to 1 over the line through a map's middle.
fn graph(curves: &[Curve]) -> Vec<[u8; 3]> {
    let [width, height] = GRAPH;
    let mut pixels = vec![[255; 3]; (width * height) as usize];
    let size = Vec2::new(width as f32 - 1.0, height as f32 - 1.0);
    let mut dot = |at: Vec2, ink: [u8; 3]| {
        let place = (Vec2::new(0.5 * (at.x + 1.0), 1.0 - at.y).clamp(Vec2::ZERO, Vec2::ONE) * size)
            .round()
            .as_uvec2();
        pixels[(place.y * width + place.x) as usize] = ink;
    };
    for i in 0..=4 * width {
        let x = i as f32 / (2 * width) as f32 - 1.0;
        for level in [0.0, 0.25, 0.5, 0.75, 1.0] {
            dot(Vec2::new(x, level), [222; 3]);
        }
    }
    for (curve, ink) in curves.iter().zip([[210, 40, 30], [30, 150, 60], [40, 80, 210]]) {
        for ends in curve.points.windows(2) {
            for step in 0..=64 {
                dot(ends[0].lerp(ends[1], step as f32 / 64.0), ink);
            }
        }
    }
    pixels
}
