//! `screenshots`: every picture of the tour, made by the program.

use crate::examples::{self, Example};

use super::{
    Common,
    render::{self, Backend, auto_display, write_png},
    solve,
};
use clap::Args;
use lumenscope_core::{
    inspection::InspectionScene,
    io::png::write_png as write_pixels,
    irradiance_volume::{
        IrradianceVolume,
        ignored::Ignored,
        inspect::VolumeView,
        placement::{
            MeasureSettings,
            requirement::{PRESETS, Preset},
        },
        probe::Probe,
    },
    math::{colour::luminance, false_colour::FalseColour},
    registry::{VIEWS, ViewInput},
    superposition::{
        composite::{self, DirectQuality},
        layers::{Layer, Layers},
        overlay,
        pass::{self, PassSettings},
    },
    transport::LightTransportSolution,
};
use std::path::{Path, PathBuf};

/// Options of `screenshots`.
#[derive(Args)]
pub struct Options {
    /// Folder with one folder a room.
    #[arg(long, default_value = "screenshots")]
    out: PathBuf,
}

/// Size of the tour's pictures, pixels.
const SIZE: [u32; 2] = [960, 540];

/// Writes the tour.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    for example in Example::ALL {
        let path = examples::resolve(Path::new(example.key()))?;
        let folder = options.out.join(path.file_stem().unwrap_or_default());
        solve::output_folder(&folder)?;
        let loaded = solve::load(&path, common)?;
        let solution = solve::solve(&loaded, true)?;
        let (layers, _) = render::picture(&solution, SIZE, 16, Backend::Cpu, common.seed)?;
        write_pictures(&solution, &layers, &folder)?;
    }
    super::tour::write(&options.out.join("program"))
}

/// The picture, every layer and every view of a solution, as PNG.
///
/// # Errors
/// One line naming the file and the cause.
pub fn write_pictures(
    solution: &LightTransportSolution,
    layers: &Layers,
    folder: &Path,
) -> anyhow::Result<()> {
    let sum = layers.sum([1.0; 3]);
    let display = auto_display(&sum);
    write_png(&folder.join("picture.png"), &sum, &display)?;
    for layer in Layer::ALL {
        write_png(&folder.join(format!("layer_{}.png", layer.name())), layers.get(layer), &display)?;
    }
    let (width, height) = (sum.width, sum.height);
    let camera = &solution.scene.camera;
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let (buffer, _) = pass::render(solution, camera, width, height, &settings);
    let look = camera.target - camera.eye;
    let probe = Probe::at(&solution.world, &*solution.radiosity, camera.eye + look * 0.6, 17, 1, 1)?;
    let plane = solution.scene.planes.first().map_or("", |p| &p.name);
    let measured = super::placement::measured(solution, plane, 3, &MeasureSettings::default()).ok();
    let writing = PRESETS.iter().find(|p| p.mean_lx == Some(500.0)).map(Preset::requirement);
    let without_main = without_main_emitter(solution);
    let input = ViewInput {
        solution,
        probe: Some(&probe),
        volume: &VolumeView::default(),
        against: without_main.as_ref(),
        placement: measured.as_ref().zip(writing.as_ref()),
    };
    let mut legends = serde_json::Map::new();
    for view in VIEWS {
        let Some(scene) = (view.build)(&input) else { continue };
        let mut pixels = composite::display(&sum, &display);
        overlay::draw(&mut pixels, &buffer, camera, &scene, &false_colour(&scene));
        write_pixels(&folder.join(format!("view_{}.png", view.id)), width, height, &pixels)?;
        if let Some(legend) = &scene.legend {
            let range = serde_json::json!({ "title": view.title, "quantity": legend.quantity, "unit": legend.unit, "range": legend.range });
            legends.insert(view.id.into(), range);
        }
    }
    solve::write(&folder.join("legends.json"), &serde_json::to_string_pretty(&legends)?)
}

/// The volume without the light that comes straight from whatever gives the most.
fn without_main_emitter(solution: &LightTransportSolution) -> Option<IrradianceVolume> {
    let list = &solution.world.emitters.list;
    let main = list.iter().max_by(|a, b| a.flux().total_cmp(&b.flux()))?;
    let ignored = Ignored::of([main.target()]);
    solution.volume.as_ref()?.ignoring(&solution.world, &*solution.radiosity, ignored)
}

/// Palette over a view's own range.
pub fn false_colour(scene: &InspectionScene) -> FalseColour {
    let largest = || scene.sphere_bins.iter().map(|b| luminance(*b)).fold(0.0, f32::max);
    let range = scene.legend.as_ref().map_or_else(|| [0.0, largest()], |l| l.range);
    FalseColour::over(range, Default::default())
}
