//! `reflectance`: how polished materials reflect by angle, as maps, graphs and a table, and what that makes of a
//! mirror image (Bastos 1999, Fig. 6.23 and 6.24).

use super::{
    Common,
    page::{INK, Page},
    parse_size,
    render::{auto_display, write_layers, write_png},
    solve,
};
use anyhow::bail;
use clap::Args;
use glam::{Vec2, Vec3};
use lumenscope_core::{
    inspection::{Curve, InspectionScene},
    math::{colour::srgb8, image::LinearImage},
    mirror::{inspect, pass::mirror_image, reflectors::Reflectors},
    scene::{brdf::Specular, geometry::Geometry},
    superposition::{
        PassSettings,
        composite::{self, DirectQuality, Display},
        layers::{Layer, Layers},
        pass::Shading,
        render,
    },
    transport::LightTransportSolution,
};
use std::{fmt::Write as _, path::PathBuf};

/// Options of `reflectance`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Folder for `reflectance.png` and `.csv`, and the pictures of the mirrors.
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

/// Side of a map and height of its graph, width of a graph, and what is left between them, pixels.
const SIDE: usize = 195;
const GRAPH: usize = 360;
const MARGIN: usize = 40;
const FAINT: [u8; 3] = [74, 74, 80];

/// Writes everything and prints the notes.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let shown = shown(&Geometry::new(&loaded.scene), &options.metal);
    if shown.images.is_empty() {
        bail!("{}: nothing is polished", options.scene.display());
    }
    maps(options, &shown)?;

    let solution = solve::solve(&loaded, false)?;
    let Some(mirrored) = mirrored(&solution, options.size, common.seed) else {
        println!("the scene's camera sees no flat mirror: no pictures");
        return Ok(());
    };
    for (name, picture) in mirrored.pictures() {
        write_png(&options.out.join(format!("{name}.png")), picture, &mirrored.display)?;
    }
    mirrored.triptych().write(&options.out.join("triptych.png"))?;
    write_layers(&options.out.join("layers.exr"), &mirrored.layers)
}

/// The view of what a scene's materials reflect, and of metals besides.
pub(super) fn shown(geometry: &Geometry, metals: &[Vec3]) -> InspectionScene {
    let mut shown = inspect::reflectance(geometry).unwrap_or_default();
    for &metal in metals {
        let specular = Specular { metal, metallic: 1.0, ..Specular::default() };
        let name = format!("metal {}", metal.to_array().map(|c| c.to_string()).join(" "));
        inspect::add_reflectance(&mut shown, &name, &specular);
    }
    shown
}

/// What the mirrors of a picture show.
pub(super) struct Mirrored {
    arriving: LinearImage,
    layers: Layers,
    total: LinearImage,
    display: Display,
}

/// `None` where the scene's camera sees no flat mirror.
pub(super) fn mirrored(
    solution: &LightTransportSolution,
    [width, height]: [u32; 2],
    seed: u64,
) -> Option<Mirrored> {
    let camera = &solution.scene.camera;
    let settings = PassSettings { direct: DirectQuality::PerPixel(16), seed, ..PassSettings::default() };
    let (buffer, layers) = render(solution, camera, width, height, &settings);
    let reflectors = Reflectors::new(&solution.world.geometry);
    let shading = Shading::new(solution, &settings);
    let pixels = mirror_image(&shading, &reflectors, &buffer, camera, &settings)?.radiance;
    let total = layers.total();
    let display = auto_display(&total);
    Some(Mirrored { arriving: LinearImage { width, height, pixels }, layers, total, display })
}

impl Mirrored {
    /// What arrives, that times the reflectance, and the whole picture.
    fn pictures(&self) -> [(&'static str, &LinearImage); 3] {
        let modulated = self.layers.get(Layer::Mirror);
        [("mirrored", &self.arriving), ("modulated", modulated), ("final", &self.total)]
    }

    /// Side by side, each with its name above it.
    pub(super) fn triptych(&self) -> Page {
        const HEAD: usize = 20;
        let (width, height) = (self.total.width as usize, self.total.height as usize);
        let mut page = Page::new(3 * width, height + HEAD);
        for (i, (name, picture)) in self.pictures().into_iter().enumerate() {
            page.text(i * width + 6, 6, 1, name, INK);
            for (k, [r, g, b, _]) in composite::display(picture, &self.display).into_iter().enumerate() {
                page.put(i * width + k % width, HEAD + k / width, [r, g, b]);
            }
        }
        page
    }
}

/// The sheet and the table of a view.
fn maps(options: &Options, shown: &InspectionScene) -> anyhow::Result<()> {
    sheet(shown).write(&options.out.join("reflectance.png"))?;
    let mut table = String::from("material,degrees,r,g,b\n");
    for (image, curves) in shown.images.iter().zip(shown.curves.chunks(3)) {
        for (i, at) in curves[0].points.iter().enumerate() {
            let [r, g, b] = [0, 1, 2].map(|channel: usize| curves[channel].points[i].y);
            let _ = writeln!(table, "{},{},{r},{g},{b}", image.name, at.x);
        }
    }
    for note in &shown.notes {
        println!("{note}");
    }
    solve::write(&options.out.join("reflectance.csv"), &table)
}

/// Of each material its map, as a sphere that mirrors white would look, and its graph over the angle.
pub(super) fn sheet(shown: &InspectionScene) -> Page {
    let block = SIDE + 2 * MARGIN;
    let words = shown.notes.iter().map(|n| 8 * n.chars().count()).max().unwrap_or(0);
    let mut page =
        Page::new(MARGIN + words.max(SIDE + GRAPH + 3 * MARGIN), shown.images.len() * block + MARGIN);
    page.text(
        MARGIN / 2,
        8,
        1,
        "reflectance of a sphere: its middle is seen along the normal, its rim at 90°",
        INK,
    );
    for (i, (image, curves)) in shown.images.iter().zip(shown.curves.chunks(3)).enumerate() {
        let top = i * block + 2 * MARGIN;
        page.text(MARGIN / 2, top - MARGIN / 2, 1, shown.notes.get(i).map_or("", String::as_str), INK);
        for (x, y) in (0..SIDE * SIDE).map(|k| (k % SIDE, k / SIDE)) {
            let texel = |v: usize, n: u32| (v * n as usize / SIDE) as u32;
            let at = image.image.at(texel(x, image.image.width), texel(y, image.image.height));
            if at != Vec3::ZERO {
                page.put(MARGIN / 2 + x, top + y, srgb8(at));
            }
        }
        graph(&mut page, [SIDE + 2 * MARGIN, top], curves);
    }
    page
}

/// Reflectance from 0 to 1 over angles from 0° to 90°.
fn graph(page: &mut Page, [left, top]: [usize; 2], curves: &[Curve]) {
    let place = |p: Vec2| {
        let share = Vec2::new(p.x / 90.0, 1.0 - p.y).clamp(Vec2::ZERO, Vec2::ONE);
        [left as f32 + share.x * GRAPH as f32, top as f32 + share.y * SIDE as f32]
    };
    for level in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let [_, y] = place(Vec2::new(0.0, level));
        page.line([left as f32, y], [(left + GRAPH) as f32, y], FAINT);
        page.text(left - MARGIN, y as usize - 4, 1, &format!("{level:.2}"), INK);
    }
    for degrees in [0, 15, 30, 45, 60, 75, 90] {
        let [x, y] = place(Vec2::new(degrees as f32, 0.0));
        page.line([x, top as f32], [x, y], FAINT);
        page.text(x as usize - 12, y as usize + 8, 1, &format!("{degrees}°"), INK);
    }
    for (curve, ink) in curves.iter().zip([[240, 80, 70], [60, 200, 90], [90, 140, 255]]) {
        for ends in curve.points.windows(2) {
            page.line(place(ends[0]), place(ends[1]), ink);
        }
    }
}
