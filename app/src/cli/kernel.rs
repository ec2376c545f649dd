//! `kernel`: the kernel of one glossy point: its footprint in the scene, its image, its lobe, its spectrum, its numbers.

use super::{
    Common,
    page::{INK, Page},
    parse_point, parse_size,
    render::auto_display,
    solve,
};
use crate::{panels::kernel::rows, widgets::number};
use anyhow::{Context, bail};
use clap::Args;
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    glossy::{inspect::KernelView, inspect_point::KernelPoint},
    inspection::Curve,
    math::{
        colour::srgb8,
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    mirror::reflectors::Reflectors,
    scene::{camera::Camera, world::World},
    superposition::{PassSettings, composite, gbuffer::GBuffer, mean_of_frames, overlay},
    transport::LightTransportSolution,
};
use std::path::PathBuf;

/// Options of `kernel`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Folder for `kernel.png`, `kernel.json` and `spectrum.csv`.
    #[arg(long)]
    out: PathBuf,
    /// The point of a flat glossy surface nearest to this place, m; by default what is glossy nearest to a place below
    /// the middle of the picture.
    #[arg(long, value_parser = parse_point, conflicts_with = "pixel", allow_hyphen_values = true)]
    at: Option<Vec3>,
    /// What the camera sees at this column and row from the top left, flat or curved.
    #[arg(long, value_parser = parse_pixel)]
    pixel: Option<UVec2>,
    /// Size of the scene's picture.
    #[arg(long, default_value = "960x540", value_parser = parse_size)]
    size: [u32; 2],
    /// Frames averaged of the scene's picture.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
}

fn parse_pixel(text: &str) -> Result<UVec2, String> {
    let parsed =
        text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    parsed.map(UVec2::from).ok_or_else(|| format!("`{text}` is not COLUMN,ROW"))
}

const MARGIN: usize = 16;
/// Side of the kernel's image, and width of the plots, pixels.
const SIDE: usize = 256;
const HEAD: usize = 30;
const ROW: usize = 16;
const FAINT: [u8; 3] = [74, 74, 80];
const COLOURS: [[u8; 3]; 2] = [[86, 180, 233], [230, 159, 0]];

/// Draws and writes.
///
/// # Errors
/// One line naming the file and the cause; also where the place is not glossy.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let loaded = solve::load(&options.scene, common)?;
    let world = World::new(&loaded.scene);
    let view = view(options, &world, &loaded.scene.camera)?;
    solve::output_folder(&options.out)?;
    let solution = solve::solve(&loaded, false)?;
    let picture = scene_picture(&solution, options, &view, common)?;
    let page = sheet(options.size, &picture, &view);
    page.write(&options.out.join("kernel.png"))?;
    let n = &view.numbers;
    let report = serde_json::json!({
        "at_m": view.point.position.to_array(),
        "lobe": n.lobe.name(),
        "roughness": n.roughness,
        "view_degrees": n.view_degrees,
        "albedo": n.albedo,
        "support_degrees": n.support_degrees,
        "reach_m": n.reach_m,
        "footprint_m": n.footprint_m,
        "band_cycles_per_radian": n.band,
        "samples_per_radian": n.samples_a_radian(),
        "spacing_degrees": n.spacing_degrees(),
    });
    let text = serde_json::to_string_pretty(&report)?;
    println!("{text}");
    solve::write(&options.out.join("kernel.json"), &text)?;
    let spectra: Vec<&Curve> = view.scene.curves.iter().filter(|c| !c.radial).collect();
    let mut table = String::from("cycles_per_radian,in_plane,across\n");
    if let [a, b] = spectra[..] {
        for (p, q) in a.points.iter().zip(&b.points) {
            table += &format!("{},{},{}\n", p.x, p.y, q.y);
        }
    }
    solve::write(&options.out.join("spectrum.csv"), &table)
}

/// The kernel that is asked for.
fn view(options: &Options, world: &World, camera: &Camera) -> anyhow::Result<KernelView> {
    let geometry = &world.geometry;
    let file = options.scene.display();
    let size = UVec2::from(options.size);
    let buffer = || GBuffer::new(world, camera, size, Vec2::splat(0.5));
    let at_pixel = |buffer: &GBuffer, pixel: UVec2| {
        let surface = buffer.surface(world, camera, (pixel.y * size.x + pixel.x) as usize)?;
        KernelPoint::on(geometry, &surface, camera.eye)
    };
    let point = match (options.pixel, options.at) {
        (Some(pixel), _) => {
            if pixel.cmpge(size).any() {
                bail!("--pixel {},{} lies outside of {}x{}", pixel.x, pixel.y, size.x, size.y);
            }
            let point = at_pixel(&buffer(), pixel);
            point
                .with_context(|| format!("{file}: nothing glossy is seen at pixel {},{}", pixel.x, pixel.y))?
        }
        (None, Some(place)) => {
            KernelPoint::near(geometry, &Reflectors::new(geometry), camera.eye, Some(place))
                .with_context(|| format!("{file}: no flat glossy surface faces the camera"))?
        }
        (None, None) => {
            let buffer = buffer();
            // Low in the picture, where tables and floors are, before what stands on them touches them.
            let wanted = (size.as_vec2() * Vec2::new(0.5, 0.85)).as_ivec2();
            let mut pixels: Vec<UVec2> =
                (0..size.x * size.y).step_by(7).map(|i| UVec2::new(i % size.x, i / size.x)).collect();
            pixels.sort_by_key(|p| (p.as_ivec2() - wanted).length_squared());
            let found = pixels.into_iter().find_map(|pixel| at_pixel(&buffer, pixel));
            found.with_context(|| format!("{file}: nothing glossy is seen"))?
        }
    };
    Ok(KernelView::new(world, point, camera.eye))
}

/// The scene as its camera shows it, with the footprint, the lobe and the mirrored ray.
fn scene_picture(
    solution: &LightTransportSolution,
    options: &Options,
    view: &KernelView,
    common: &Common,
) -> anyhow::Result<Vec<[u8; 4]>> {
    let camera = &solution.scene.camera;
    let settings = PassSettings { seed: common.seed, ..PassSettings::default() };
    let layers =
        solve::watched(|p| mean_of_frames(solution, camera, options.size, options.frames, &settings, p))?;
    let sum = layers.total();
    let mut pixels = composite::display(&sum, &auto_display(&sum));
    let buffer = GBuffer::new(&solution.world, camera, options.size.into(), Vec2::splat(0.5));
    overlay::draw(&mut pixels, &buffer, camera, &view.scene, &weights());
    Ok(pixels)
}

/// Colours of weights over the peak.
fn weights() -> FalseColour {
    FalseColour::over([0.0, 1.0], Palette::Inferno)
}

/// The scene, beside it the kernel's image, its lobe and its spectra, below it its numbers.
fn sheet([width, height]: [u32; 2], picture: &[[u8; 4]], view: &KernelView) -> Page {
    let (width, height) = (width as usize, height as usize);
    let numbers = rows(&view.numbers);
    let lines = numbers.len().div_ceil(2);
    let below = HEAD + height + MARGIN + lines * ROW + MARGIN;
    let beside = HEAD + 3 * (SIDE / 4 * 3 + HEAD) + SIDE / 4;
    let mut page = Page::new(width + SIDE + 3 * MARGIN, below.max(beside));
    page.text(
        MARGIN,
        10,
        1,
        "Footprint of the lobe, its solid and the mirrored ray; weight over the peak",
        INK,
    );
    for (i, [r, g, b, _]) in picture.iter().enumerate() {
        page.put(MARGIN + i % width, HEAD + i / width, [*r, *g, *b]);
    }
    let left = width + 2 * MARGIN;
    let mut top = HEAD;
    for image in &view.scene.images {
        page.text(left, top - 20, 1, &image.name, INK);
        draw_image(&mut page, [left, top], SIDE, &image.image);
        top += SIDE + HEAD;
    }
    let (lobes, spectra): (Vec<&Curve>, Vec<&Curve>) = view.scene.curves.iter().partition(|c| c.radial);
    let plot = SIDE / 8 * 5;
    for (title, curves) in [("lobe in the plane of incidence", lobes), ("spectrum, cycles a radian", spectra)]
    {
        page.text(left, top - 20, 1, title, INK);
        draw_curves(&mut page, [left, top], [SIDE, plot], &curves, &view.numbers.band);
        top += plot + HEAD;
    }
    let first = HEAD + height + MARGIN;
    for (i, row) in numbers.iter().enumerate() {
        let x = MARGIN + (i / lines) * (width / 2);
        let values: Vec<String> = row.values.iter().map(|v| number::short(*v)).collect();
        let words = format!("{:<18} {} {}", row.name, values.join("  "), row.unit);
        page.text(x, first + (i % lines) * ROW, 1, &words, INK);
    }
    page
}

/// An image in false colour, its pixels enlarged evenly.
fn draw_image(page: &mut Page, [left, top]: [usize; 2], side: usize, image: &LinearImage) {
    for y in 0..side {
        for x in 0..side {
            let at = |v: usize, n: u32| (v * n as usize / side) as u32;
            let value = image.at(at(x, image.width), at(y, image.height)).x;
            // Square root: the tail of a lobe is most of its width.
            page.put(left + x, top + y, srgb8(weights().colour(value.max(0.0).sqrt())));
        }
    }
}

/// Curves in a frame; of spectra the frequencies above which nothing passes too.
fn draw_curves(
    page: &mut Page,
    [left, top]: [usize; 2],
    [width, height]: [usize; 2],
    curves: &[&Curve],
    bands: &[f32; 2],
) {
    let points = || curves.iter().flat_map(|c| &c.points);
    let radial = curves.iter().any(|c| c.radial);
    let (mut low, mut high) =
        points().fold((Vec2::ZERO, Vec2::splat(1e-6)), |(l, h), p| (l.min(*p), h.max(*p)));
    if radial {
        // One scale for both axes, the surface along the bottom.
        let half = (0.5 * (high.x - low.x)).max(0.5 * high.y * width as f32 / height as f32);
        let middle = 0.5 * (low.x + high.x);
        (low, high) = (
            Vec2::new(middle - half, 0.0),
            Vec2::new(middle + half, 2.0 * half * height as f32 / width as f32),
        );
    } else {
        high.x = high.x.min(2.0 * bands[0].max(bands[1]).max(1e-3));
    }
    let place = |p: Vec2| {
        let share = ((p - low) / (high - low)).clamp(Vec2::ZERO, Vec2::ONE);
        [
            left as f32 + share.x * (width - 1) as f32,
            (top + height - 1) as f32 - share.y * (height - 2) as f32,
        ]
    };
    if radial {
        page.line(place(Vec2::ZERO), place(Vec2::new(0.0, high.y)), FAINT);
    }
    let corners = [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)].map(place);
    for i in 0..4 {
        page.line(corners[i], corners[(i + 1) % 4], FAINT);
    }
    for (i, curve) in curves.iter().enumerate() {
        if !radial {
            let band = bands[i.min(1)];
            page.line(place(Vec2::new(band, 0.0)), place(Vec2::new(band, 0.3 * high.y)), FAINT);
        }
        for pair in curve.points.windows(2).filter(|p| radial || p[0].x <= high.x) {
            page.line(place(pair[0]), place(pair[1]), COLOURS[i.min(1)]);
        }
        if !radial {
            let name = if i == 0 { "in the plane" } else { "across it" };
            page.text(left + width - 8 * name.len() - 6, top + 8 + 14 * i, 1, name, COLOURS[i.min(1)]);
        }
    }
    if !radial {
        page.text(left, top + height + 4, 1, "0", INK);
        let end = format!("{:.0}", high.x);
        page.text(left + width - 8 * end.len(), top + height + 4, 1, &end, INK);
    }
}
