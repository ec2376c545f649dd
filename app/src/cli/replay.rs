//! `replay`: a recorded drag, step by step: how soon each update came, and how wrong it was.

use super::{Common, solve};
use anyhow::{Context, bail};
use clap::Args;
use glam::{Affine3A, Quat, Vec2, Vec3};
use lumenscope_core::{
    math::{part::Part, progress::Progress, random::Rng},
    measure::irradiance::relative_errors,
    scene::{Scene, Target},
    transport::{LightTransportSolution, live::LiveTransport},
};
use serde::Deserialize;
use std::{path::PathBuf, sync::Arc, time::Instant};

/// Options of `replay`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// RON file with the drag.
    #[arg(long)]
    script: PathBuf,
    /// Folder for `replay.csv` and `replay.json`.
    #[arg(long)]
    out: PathBuf,
}

/// A recorded drag: the named object or lamp, and where it is at each step relative to the start.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Script {
    target: String,
    steps: Vec<Step>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Step {
    translate: Vec3,
    rotate_y_deg: f32,
    dimmer: f32,
}

impl Default for Step {
    fn default() -> Self {
        Self { translate: Vec3::ZERO, rotate_y_deg: 0.0, dimmer: 1.0 }
    }
}

/// Surface points at which updates are compared.
const POINTS: usize = 1_000;

/// Replays and writes the table.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    solve::output_folder(&options.out)?;
    let text = std::fs::read_to_string(&options.script)
        .with_context(|| format!("cannot read {}", options.script.display()))?;
    let script: Script = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(&text)
        .with_context(|| options.script.display().to_string())?;
    let loaded = solve::load(&options.scene, common)?;
    let target = find(&loaded.scene, &script.target).with_context(|| options.script.display().to_string())?;
    let mut live = solve::live(&loaded, false)?;
    let points = surface_points(live.current(), common.seed);

    let mut csv = String::from(
        "step,first_seconds,first_error_median,first_error_p95,settled_seconds,settled_error_median\n",
    );
    let mut rows = Vec::new();
    for (i, step) in script.steps.iter().enumerate() {
        let scene = Arc::new(placed(&loaded.scene, target, step));
        let start = Instant::now();
        let first = live.follow(scene.clone()).clone();
        let first_seconds = start.elapsed().as_secs_f64();
        while live.refine(&Progress::silent())?.is_some() {}
        let settled_seconds = start.elapsed().as_secs_f64();
        let settled = live.current().clone();
        let fresh = LiveTransport::solve(scene, loaded.plan.solve.clone(), &Progress::silent(), &mut |_| {})?;
        let truth = illuminance(fresh.current(), &points);
        let (first_median, first_p95) = error(&illuminance(&first, &points), &truth)?;
        let (settled_median, _) = error(&illuminance(&settled, &points), &truth)?;
        csv += &format!(
            "{i},{first_seconds:.4},{first_median:.5},{first_p95:.5},{settled_seconds:.4},{settled_median:.5}\n"
        );
        eprintln!(
            "step {i}: first update {:.0} ms, {:.2} % off; settled {:.2} s",
            first_seconds * 1e3,
            first_median * 100.0,
            settled_seconds
        );
        rows.push(serde_json::json!({
            "first_seconds": first_seconds, "first_error_median": first_median, "first_error_p95": first_p95,
            "settled_seconds": settled_seconds, "settled_error_median": settled_median,
        }));
    }
    solve::write(&options.out.join("replay.csv"), &csv)?;
    let report = serde_json::json!({ "scene": options.scene, "target": script.target, "threads": rayon::current_num_threads(), "steps": rows });
    solve::write(&options.out.join("replay.json"), &serde_json::to_string_pretty(&report)?)
}

fn find(scene: &Scene, name: &str) -> anyhow::Result<Target> {
    let lamp = scene.lamps.iter().position(|l| l.name == name).map(Target::Lamp);
    let object = scene.objects.iter().position(|o| o.name == name);
    match (lamp, object) {
        (Some(target), _) => Ok(target),
        (None, Some(i)) if scene.objects[i].movable => Ok(Target::Object(i)),
        (None, Some(_)) => bail!("`{name}` is not movable"),
        (None, None) => bail!("no object or lamp is called `{name}`"),
    }
}

fn placed(scene: &Scene, target: Target, step: &Step) -> Scene {
    let mut scene = scene.clone();
    let start = scene.placement(target);
    let turn = Quat::from_rotation_y(step.rotate_y_deg.to_radians());
    let moved = Affine3A::from_translation(step.translate) * start * Affine3A::from_quat(turn);
    scene.place(target, moved);
    match target {
        Target::Object(i) => scene.objects[i].dimmer = step.dimmer,
        Target::Lamp(i) => scene.lamps[i].dimmer = step.dimmer,
    }
    scene
}

/// Random points on what stands still, uniform over area.
fn surface_points(solution: &LightTransportSolution, seed: u64) -> Vec<(u32, Vec2)> {
    let geometry = &solution.world.geometry;
    let mut total = 0.0f64;
    let cumulative: Vec<f64> = (0..geometry.len() as u32)
        .map(|t| {
            let still = !geometry.movable[geometry.object[t as usize] as usize];
            total += if still { f64::from(geometry.area_normal(t).length()) } else { 0.0 };
            total
        })
        .collect();
    (0..POINTS as u64)
        .map(|i| {
            let mut rng = Rng::new(seed, i);
            let wanted = f64::from(rng.next_f32()) * total;
            let triangle = cumulative.partition_point(|&a| a <= wanted).min(geometry.len() - 1) as u32;
            let u = rng.next_vec2();
            let root = u.x.sqrt();
            (triangle, Vec2::new(root * (1.0 - u.y), root * u.y))
        })
        .collect()
}

fn illuminance(solution: &LightTransportSolution, points: &[(u32, Vec2)]) -> Vec<Vec3> {
    points.iter().map(|&(t, b)| solution.radiosity.irradiance(t, b, false, Part::All)).collect()
}

/// Median and 95th percentile of |E − E_ref| / max(E_ref, 5 % of the mean).
fn error(values: &[Vec3], truth: &[Vec3]) -> anyhow::Result<(f64, f64)> {
    let statistics = relative_errors(values, truth)?;
    Ok((statistics.median, statistics.percentile_95))
}
