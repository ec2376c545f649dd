//! `screenshots`: every picture of the tour, made by the program.

use crate::examples::{self, Example};

use super::{
    Common, copies,
    page::{INK, Page},
    probe::looking_from,
    reflectance,
    render::{self, Backend, auto_display},
    small_png, solve, view, wall,
};
use crate::{wall::WallSettings, widgets::resolutions::ROWS};
use anyhow::Context;
use clap::Args;
use glam::Vec3;
use lumenscope_core::{
    inspection::colours::ColourSettings,
    irradiance_volume::{
        IrradianceVolume,
        difference::Difference,
        ignored::Ignored,
        inspect::VolumeView,
        probe::{Probe, Quantity},
    },
    math::{colour::srgb8, image::LinearImage, part::Part, sphere_values::SphereValues},
    registry::VIEWS,
    scene::{accel::Ray, geometry::Surface},
    superposition::{
        composite,
        layers::{Layer, Layers},
    },
    transport::LightTransportSolution,
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Options of `screenshots`.
#[derive(Args)]
pub struct Options {
    /// Folder with one folder a room.
    #[arg(long, default_value = "screenshots")]
    out: PathBuf,
    /// One example alone, as in `example:NAME`.
    #[arg(long)]
    only: Option<String>,
}

/// Size of the tour's pictures, pixels.
const SIZE: [u32; 2] = [640, 360];

/// Writes the tour.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let only = match &options.only {
        None => None,
        Some(name) => Some(
            Example::every()
                .find(|e| e.key().strip_prefix("example:") == Some(name))
                .with_context(|| format!("--only {name}: there is no such example"))?,
        ),
    };
    // What looks like another: the tour shows its edges, its texture or its kernel.
    let shown_by_tour = |e: &Example| matches!(e, Example::Quadtrees | Example::Ball | Example::Phong);
    let all = || Example::ALL.into_iter().filter(|e| !shown_by_tour(e)).collect();
    let wanted = only.map_or_else(all, |only| vec![only]);
    for example in wanted {
        let path = examples::resolve(Path::new(example.key()))?;
        let folder = options.out.join(path.file_stem().unwrap_or_default());
        solve::output_folder(&folder)?;
        let loaded = solve::load(&path, common)?;
        let solution = solve::solve(&loaded, true)?;
        let (layers, _) = render::picture(&solution, SIZE, 16, Backend::Cpu, common.seed)?;
        write_pictures(&solution, &layers, &folder, small_png::write)?;
        if example == Example::Pyramid {
            copper_and_gold(&solution, &folder, common.seed)?;
        }
        // Before the open front of the Cornell box there is little to see.
        if example == Example::Office {
            resolutions(&solution, &folder)?;
            put_in(&path, &solution, &folder, common.seed)?;
        }
    }
    super::tour::write(&options.out.join("program"), only)
}

/// How copper and gold reflect by angle, and what that makes of a mirror image.
fn copper_and_gold(solution: &LightTransportSolution, folder: &Path, seed: u64) -> anyhow::Result<()> {
    let gold = Vec3::new(0.63, 0.56, 0.37);
    let sheet = reflectance::sheet(&reflectance::shown(&solution.world.geometry, &[gold]));
    let mirrored = reflectance::mirrored(solution, SIZE, seed).map(|m| m.triptych());
    for (name, page) in [("reflectance.png", Some(sheet)), ("mirrored.png", mirrored)] {
        let Some(page) = page else { continue };
        small_png::write(&folder.join(name), page.width as u32, page.height as u32, &page.pixels)?;
    }
    Ok(())
}

/// What is put into the office after the solve: the wall, and two copies of a chair.
fn put_in(path: &Path, solution: &LightTransportSolution, folder: &Path, seed: u64) -> anyhow::Result<()> {
    let write = |name: &str, shown: &LinearImage, words: &[String]| {
        let pixels = composite::display(shown, &auto_display(shown));
        let mut page = Page::over(shown.width as usize, shown.height as usize, pixels);
        let step = shown.width as f32 / words.len() as f32;
        for (i, words) in words.iter().enumerate() {
            page.plate((i as f32 + 0.5) * step, shown.height as f32 - 14.0, words, GROUND);
        }
        small_png::write(&folder.join(name), shown.width, shown.height, &page.pixels)
    };
    let settings = WallSettings::beside(solution);
    let (shown, report) = wall::draw(&settings, solution, SIZE, seed)?;
    let polygons = &report["polygons"];
    write("wall.png", &shown, &[format!("a wall of {polygons} polygons, lit from the volume")])?;
    let Some(chair) = solution.scene.objects.iter().position(|o| o.name == "Chair") else { return Ok(()) };
    let (shown, report) = copies::draw(&copies::Options::for_tour(path, SIZE), solution, chair, seed)?;
    let lit = ["left", "right"].map(|side| format!("lit by {} bins", report[side]["bins"]));
    write("copies.png", &shown, &lit)
}

/// Diameter of a ball in the picture of all resolutions, pixels.
const BALL: usize = 200;
/// Height of the words above.
const WORDS: usize = 24;
/// Ground of words over a picture.
const GROUND: [u8; 3] = [28, 28, 30];

/// The light at one point at every resolution of the thesis, coarsest first: radiance above, irradiance
/// below, each as it would look on the display.
fn resolutions(solution: &LightTransportSolution, folder: &Path) -> anyhow::Result<()> {
    let at = |n| Probe::at(&solution.world, &*solution.radiosity, probed(solution), n, 4, 1);
    let mut page = Page::new(ROWS.len() * BALL, 2 * (BALL + WORDS));
    let side = looking_from(solution.scene.camera.eye - solution.scene.camera.target);
    for (column, n) in ROWS.into_iter().enumerate() {
        let probe = at(n)?;
        for (row, quantity) in [Quantity::Radiance, Quantity::Irradiance].into_iter().enumerate() {
            let values = probe.values(quantity, Part::All);
            let shown = LinearImage { width: values.len() as u32, height: 1, pixels: values.clone() };
            let display = auto_display(&shown);
            let sphere = SphereValues { bins: probe.bins, values: &values };
            let ball = sphere.ball(side, BALL, false, |v| {
                let [r, g, b, _] = display.pixel(v);
                [r, g, b]
            });
            let (left, top) = (column * BALL, row * (BALL + WORDS));
            page.text(left + 8, top + 8, 1, &format!("{}, {} bins", quantity.name(), values.len()), INK);
            for (i, [r, g, b, _]) in ball.into_iter().enumerate().filter(|(_, p)| p[3] > 0) {
                page.put(left + i % BALL, top + WORDS + i / BALL, [r, g, b]);
            }
        }
    }
    small_png::write(&folder.join("resolutions.png"), page.width as u32, page.height as u32, &page.pixels)
}

/// Where the tour's spheres stand: before the camera, above what it looks at.
pub(super) fn probed(solution: &LightTransportSolution) -> Vec3 {
    let camera = &solution.scene.camera;
    camera.eye + (camera.target - camera.eye) * 0.6
}

/// Writes display pixels to a file.
pub type WritePixels = fn(&Path, u32, u32, &[[u8; 4]]) -> anyhow::Result<()>;

/// The picture, every layer and every view of a solution.
///
/// # Errors
/// One line naming the file and the cause.
pub fn write_pictures(
    solution: &LightTransportSolution,
    layers: &Layers,
    folder: &Path,
    write: WritePixels,
) -> anyhow::Result<()> {
    let sum = layers.total();
    let display = auto_display(&sum);
    let (width, height) = (sum.width, sum.height);
    write(&folder.join("picture.png"), width, height, &composite::display(&sum, &display))?;
    for layer in Layer::ALL {
        if layers.get(layer).pixels.iter().all(|p| *p == Vec3::ZERO) {
            continue;
        }
        // Exposed for itself: indirect light would be lost in the dark of the whole picture's exposure.
        let pixels = composite::display(layers.get(layer), &auto_display(layers.get(layer)));
        write(&folder.join(format!("layer_{}.png", layer.name())), width, height, &pixels)?;
    }
    let ground = view::ground(solution, composite::display(&sum, &display), [width, height]);
    let shown = view::Shown::new(solution, None)?;
    let cut = VolumeView { slice: across(solution), ..VolumeView::default() };
    let mut legends = serde_json::Map::new();
    for view in VIEWS {
        let mut input = shown.input(solution);
        if view.id.contains("slice") {
            input.volume = &cut;
        }
        let Some(scene) = (view.build)(&input) else { continue };
        if scene.is_beside_the_scene() {
            continue;
        }
        let page = ground.framed(view.title, &scene, &scene.colours(&ColourSettings::default()));
        let path = folder.join(format!("view_{}.png", view.id));
        write(&path, page.width as u32, page.height as u32, &page.pixels)?;
        for (i, named) in scene.images.iter().enumerate().filter(|_| view.id == "mirror.images") {
            let pixels = named.image.pixels.iter().map(|p| {
                let [r, g, b] = srgb8(*p);
                [r, g, b, 255]
            });
            let path = folder.join(format!("view_{}_{i}.png", view.id));
            write(&path, named.image.width, named.image.height, &pixels.collect::<Vec<_>>())?;
        }
        if let Some(legend) = &scene.legend {
            let range = serde_json::json!({ "title": view.title, "quantity": legend.quantity, "unit": legend.unit, "range": legend.range });
            legends.insert(view.id.into(), range);
        }
    }
    solve::write(&folder.join("legends.json"), &serde_json::to_string_pretty(&legends)?)
}

/// A plane through the middle of the volume that the camera looks at more than along.
fn across(solution: &LightTransportSolution) -> Option<(u8, f32)> {
    let (low, high) = solution.volume.as_ref()?.grid().bounds();
    let camera = &solution.scene.camera;
    let axis = (camera.target - camera.eye).abs().max_position();
    Some((axis as u8, 0.5 * (low + high)[axis]))
}

/// The surface in the middle of the picture.
fn looked_at(solution: &LightTransportSolution) -> Option<Surface> {
    let camera = &solution.scene.camera;
    let towards = (camera.target - camera.eye).normalize();
    let hit = solution.world.accel.trace(&Ray::new(camera.eye, towards))?;
    Some(solution.world.geometry.surface(hit.triangle, hit.barycentric, towards))
}

/// The point there, and its normal.
pub(super) fn point_looked_at(solution: &LightTransportSolution) -> Option<(Vec3, Vec3)> {
    looked_at(solution).map(|s| (s.position, s.normal))
}

/// The element there.
pub(super) fn element_looked_at(solution: &LightTransportSolution) -> Option<u32> {
    let surface = looked_at(solution)?;
    Some(solution.radiosity.element_at(surface.triangle, surface.barycentric, surface.back))
}

/// The volume without the light that comes straight from whatever sends most into the air: the light of
/// several is their sum, so the mean over all samples and directions says which.
pub(super) fn without_main_emitter(solution: &LightTransportSolution) -> Option<IrradianceVolume> {
    let volume = solution.volume.as_ref()?;
    let targets: BTreeSet<_> = solution.world.emitters.list.iter().map(|e| e.target()).collect();
    let without = targets.into_iter().filter_map(|target| {
        let without = volume.ignoring(&solution.world, &*solution.radiosity, Ignored::of([target]))?;
        Some((Difference::new(volume, &without, Part::Direct).statistics().mean_lx, without))
    });
    without.max_by(|a, b| a.0.total_cmp(&b.0)).map(|w| w.1)
}
