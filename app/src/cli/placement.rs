//! `placement`: illuminance on a plane or an object's top, as numbers, table and map.

use super::{Common, placement_map, solve};
use crate::placement::csv;
use anyhow::{Context, bail};
use clap::Args;
use lumenscope_core::{
    irradiance_volume::placement::{
        MeasureSettings, Measurement,
        grid::MeasuringGrid,
        measure,
        requirement::{PRESETS, Requirement, preset},
    },
    scene::Scene,
    transport::LightTransportSolution,
};
use std::path::PathBuf;

/// Options of `placement`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Name of a measuring plane of the scene, or of an object: then its top is measured.
    #[arg(long)]
    plane: String,
    /// Folder for `placement.csv`, `placement.png` and `placement.json`.
    #[arg(long)]
    out: PathBuf,
    /// Task whose requirement is held against the light; `list` prints them all.
    #[arg(long)]
    task: Option<String>,
    /// Smallest mean illuminance, lx; instead of the task's.
    #[arg(long)]
    mean_lx: Option<f32>,
    /// Smallest illuminance anywhere, lx.
    #[arg(long)]
    min_lx: Option<f32>,
    /// Largest illuminance anywhere, lx.
    #[arg(long)]
    max_lx: Option<f32>,
    /// Smallest uniformity E_min / E_mean.
    #[arg(long)]
    uniformity: Option<f32>,
    /// Points along each edge, in those that EN 12464-1 asks for.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=16))]
    finer: u32,
    /// Illuminance kept in use over that of new, clean lamps.
    #[arg(long, default_value_t = 1.0)]
    maintenance_factor: f32,
    /// Rays that gather the indirect light of a point; 0 asks the irradiance volume.
    #[arg(long, default_value_t = 1024)]
    gather_rays: u32,
    /// Shadow rays an area emitter and point.
    #[arg(long, default_value_t = 64)]
    shadow_rays: u32,
}

/// Measures, writes and prints.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let requirement = requirement(options)?;
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    if !(0.01..=1.0).contains(&options.maintenance_factor) {
        bail!("--maintenance-factor {} must lie between 0.01 and 1", options.maintenance_factor);
    }
    let settings = MeasureSettings {
        shadow_rays: options.shadow_rays,
        gather_rays: options.gather_rays,
        maintenance_factor: options.maintenance_factor,
        seed: common.seed,
    };
    // Named before anything is solved: a wrong name is told at once.
    find(&loaded.scene, &options.plane).with_context(|| options.scene.display().to_string())?;
    let solution = solve::solve(&loaded, options.gather_rays == 0)?;
    let measured = measured(&solution, &options.plane, options.finer, &settings)?;
    let statistics = measured.statistics();
    let short = requirement.shortfalls(statistics.as_ref());
    solve::write(&options.out.join("placement.csv"), &csv(&measured))?;
    placement_map::write(&options.out.join("placement.png"), &measured, &requirement)?;
    let [du, dv] = measured.grid.spacing_m();
    let report = serde_json::json!({
        "scene": options.scene,
        "measured": measured.name,
        "points_u": measured.grid.nx,
        "points_v": measured.grid.ny,
        "spacing_m": [du, dv],
        "points_inside_things": measured.inside,
        "maintenance_factor": options.maintenance_factor,
        "gather_rays": measured.gather_rays,
        "statistics": statistics,
        "requirement": requirement,
        "warnings": short.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "sufficient": short.is_empty(),
    });
    solve::write(&options.out.join("placement.json"), &serde_json::to_string_pretty(&report)?)?;
    println!("{}", text(&measured));
    for shortfall in &short {
        println!("warning: {shortfall}");
    }
    if short.is_empty() && !requirement.is_empty() {
        println!("enough light for: {}", requirement.task.to_lowercase());
    }
    Ok(())
}

/// A place that can be measured.
#[derive(Clone, Copy)]
enum Place {
    Plane(usize),
    Top(usize),
}

fn find(scene: &Scene, name: &str) -> anyhow::Result<Place> {
    let planes = || scene.planes.iter().map(|p| p.name.as_str());
    let plane = planes().position(|p| p == name).map(Place::Plane);
    let object = scene.objects.iter().position(|o| o.name == name).map(Place::Top);
    plane.or(object).with_context(|| {
        let known: Vec<&str> = planes().collect();
        format!("no measuring plane and no object is named \"{name}\"; planes: {}", known.join(", "))
    })
}

/// Measures a plane or the top of an object, by name.
///
/// # Errors
/// Where there is none of that name, or nothing of the object faces up.
pub fn measured(
    solution: &LightTransportSolution,
    name: &str,
    finer: u32,
    settings: &MeasureSettings,
) -> anyhow::Result<Measurement> {
    let (scene, world) = (&solution.scene, &solution.world);
    let grid = match find(scene, name)? {
        Place::Plane(i) => MeasuringGrid::on_plane(&scene.planes[i], finer),
        Place::Top(i) => MeasuringGrid::on_top(&world.geometry, i, finer)
            .with_context(|| format!("object \"{name}\" has no level surface that faces up"))?,
    };
    let volume = solution.volume.as_deref();
    Ok(measure(world, &*solution.radiosity, volume, name, grid, settings))
}

fn requirement(options: &Options) -> anyhow::Result<Requirement> {
    let mut wanted = match &options.task {
        None => Requirement::default(),
        Some(task) => preset(task)
            .with_context(|| {
                let known: Vec<String> = PRESETS.iter().map(|p| format!("\"{}\"", p.task)).collect();
                format!("no task is named \"{task}\"; known are {}", known.join(", "))
            })?
            .requirement(),
    };
    wanted.mean_lx = options.mean_lx.or(wanted.mean_lx);
    wanted.min_lx = options.min_lx.or(wanted.min_lx);
    wanted.max_lx = options.max_lx.or(wanted.max_lx);
    wanted.uniformity = options.uniformity.or(wanted.uniformity);
    if !wanted.is_finite() {
        bail!("what is asked of the light must be positive numbers");
    }
    Ok(wanted)
}

/// The numbers of a measurement, one a line.
pub fn text(measured: &Measurement) -> String {
    let Some(s) = measured.statistics() else { return format!("{}: nothing was measured", measured.name) };
    format!(
        "{}: {} points\nminimum    {:8.1} lx\nmean       {:8.1} lx\nmaximum    {:8.1} lx\n\
         uniformity {:8.2}    E_min / E_mean\ndiversity  {:8.2}    E_min / E_max",
        measured.name, s.points, s.min_lx, s.mean_lx, s.max_lx, s.uniformity, s.diversity
    )
}
