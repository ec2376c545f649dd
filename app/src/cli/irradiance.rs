//! `irradiance`: illuminance at listed points, by the method of choice.

use super::{
    Common, parse_point, solve,
    table::{self, Column, PointRow},
    volume_options::VolumeOptions,
};
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use glam::Vec3;
use lumenscope_core::{
    irradiance_volume::lighting::Lighting,
    math::{colour::luminance, part::Part},
    reference,
    scene::{
        accel::Ray,
        direct::{self, Receiver},
        geometry::Surface,
        world::World,
    },
    transport::LightTransportSolution,
};
use rayon::prelude::*;
use std::path::PathBuf;

/// Options of `irradiance`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// CSV with the header `x,y,z,nx,ny,nz`, metres.
    #[arg(long, required_unless_present = "at", requires = "out")]
    points: Option<PathBuf>,
    /// One point, m, instead of a list: its irradiance is printed.
    #[arg(long, value_parser = parse_point, allow_hyphen_values = true, conflicts_with = "points")]
    at: Option<Vec3>,
    /// What a surface at that point faces; up by default.
    #[arg(long, value_parser = parse_point, allow_hyphen_values = true, requires = "at")]
    normal: Option<Vec3>,
    /// Print which samples of the volume light that point: their weights, the cell, the place in it, their states.
    #[arg(long, requires = "at")]
    weights: bool,
    /// Method.
    #[arg(long, value_enum, default_value_t = Method::Volume)]
    method: Method,
    /// CSV to write: the same columns, then `E_r,E_g,E_b` in lx.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Part of the light.
    #[arg(long, value_enum, default_value_t = PartOption::All)]
    part: PartOption,
    /// Paths a point, for the reference.
    #[arg(long, default_value_t = 4096)]
    spp: u32,
    #[command(flatten)]
    volume: VolumeOptions,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Direct light at the point and indirect light from the radiosity elements; points lie on surfaces.
    Radiosity,
    /// Interpolated in the irradiance volume; points lie anywhere.
    Volume,
    /// Path traced, with standard errors.
    Reference,
}

#[derive(Clone, Copy, ValueEnum)]
enum PartOption {
    /// Direct and indirect.
    All,
    /// Straight from the emitters.
    Direct,
    /// After at least one bounce.
    Indirect,
}

impl From<PartOption> for Part {
    fn from(option: PartOption) -> Self {
        match option {
            PartOption::All => Self::All,
            PartOption::Direct => Self::Direct,
            PartOption::Indirect => Self::Indirect,
        }
    }
}

/// Distance within which a point is taken to lie on a surface, m.
const ON_SURFACE_M: f32 = 0.01;

/// Computes and writes the table.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let points = match (&options.points, options.at) {
        (Some(list), _) => table::read_points(list)?,
        (None, Some(position)) => {
            let normal = options.normal.unwrap_or(Vec3::Y);
            let normal = normal.try_normalize().context("--normal 0,0,0: faces no direction")?;
            vec![PointRow { position, normal }]
        }
        (None, None) => bail!("--points or --at: nothing to compute"),
    };
    if options.weights && options.method != Method::Volume {
        bail!("--weights: only --method volume has samples");
    }
    let mut loaded = solve::load(&options.scene, common)?;
    let part = Part::from(options.part);
    let mut report = serde_json::json!({});
    let columns = match options.method {
        Method::Reference => {
            reference_columns(&World::new(&loaded.scene), &points, part, options.spp, common.seed)?
        }
        Method::Radiosity => {
            let solution = solve::solve(&loaded, false)?;
            rgb_columns(&radiosity(&solution, &points, part)?)
        }
        Method::Volume => {
            options.volume.apply(loaded.plan.volume_settings());
            let solution = solve::solve(&loaded, true)?;
            let volume = solution.volume.context("the plan built no volume")?;
            if options.weights {
                report = weights(&volume.lighting(points[0].position, points[0].normal, part));
            }
            rgb_columns(
                &points.iter().map(|p| volume.irradiance(p.position, p.normal, part)).collect::<Vec<_>>(),
            )
        }
    };
    if let Some(at) = options.at {
        report["at_m"] = at.to_array().into();
        report["normal"] = points[0].normal.to_array().into();
        for (name, values) in &columns {
            report[format!("{name}_lx")] = values[0].into();
        }
        println!("{}", serde_json::to_string_pretty(&report)?);
    }
    match &options.out {
        Some(out) => solve::write(out, &table::format_points(&points, &columns)),
        None => Ok(()),
    }
}

/// Cell, offset, state and samples of a point; and the same as a table on stderr.
fn weights(lighting: &Lighting) -> serde_json::Value {
    eprintln!("{}", lighting.place());
    for s in &lighting.samples {
        let p = s.position;
        eprintln!(
            "#{:<6}{:>7.2} %{:>9.2} % trilinear  {:>8.3} {:>8.3} {:>8.3} m{:>12.4} lx  {}",
            s.id,
            100.0 * s.weight,
            100.0 * s.trilinear,
            p.x,
            p.y,
            p.z,
            luminance(s.irradiance),
            s.word()
        );
    }
    let samples: Vec<_> = lighting
        .samples
        .iter()
        .map(|s| {
            serde_json::json!({
                "sample": s.id, "weight": s.weight, "trilinear": s.trilinear, "at_m": s.position.to_array(),
                "state": s.word(), "E_lx": s.irradiance.to_array(),
            })
        })
        .collect();
    serde_json::json!({
        "cell": lighting.cell, "level": lighting.level, "offset": lighting.offset.to_array(),
        "notice": lighting.notice(), "samples": samples,
    })
}

/// Irradiance, lx.
pub fn rgb_columns(values: &[Vec3]) -> Vec<Column> {
    columns(["E_r", "E_g", "E_b"], values)
}

/// Standard errors, lx.
pub fn error_columns(values: &[Vec3]) -> Vec<Column> {
    columns(["stderr_r", "stderr_g", "stderr_b"], values)
}

fn columns(names: [&'static str; 3], values: &[Vec3]) -> Vec<Column> {
    let channel = |i: usize| values.iter().map(|v| v[i]).collect();
    names.into_iter().enumerate().map(|(i, name)| (name, channel(i))).collect()
}

fn reference_columns(
    world: &World,
    points: &[PointRow],
    part: Part,
    samples: u32,
    seed: u64,
) -> anyhow::Result<Vec<Column>> {
    let estimates = solve::watched(|progress| {
        progress.begin("reference");
        let done = std::sync::atomic::AtomicUsize::new(0);
        points
            .par_iter()
            .enumerate()
            .map(|(i, p)| {
                let receiver = Receiver::new(p.position, p.normal);
                let estimate = reference::irradiance::irradiance(
                    world,
                    &receiver,
                    part,
                    samples,
                    seed.wrapping_add(i as u64),
                );
                let count = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
                progress.report(count as f32 / points.len() as f32).map(|()| estimate)
            })
            .collect::<Result<Vec<_>, _>>()
    })?;
    let mut columns = rgb_columns(&estimates.iter().map(|e| e.mean).collect::<Vec<_>>());
    columns.extend(error_columns(&estimates.iter().map(|e| e.standard_error).collect::<Vec<_>>()));
    Ok(columns)
}

/// The surface that a point lies on, seen from where its normal points.
pub fn surface_under(world: &World, point: &PointRow) -> Option<Surface> {
    let from = point.position + point.normal * ON_SURFACE_M;
    let ray = Ray { t_max: 2.0 * ON_SURFACE_M, ..Ray::new(from, -point.normal) };
    let hit = world.accel.trace(&ray)?;
    Some(world.geometry.surface(hit.triangle, hit.barycentric, ray.direction))
}

/// Direct light at the point itself, indirect light from the element under it, as a picture's pixels do.
fn radiosity(
    solution: &LightTransportSolution,
    points: &[PointRow],
    part: Part,
) -> anyhow::Result<Vec<Vec3>> {
    let world = &solution.world;
    let mut values = Vec::with_capacity(points.len());
    for (i, point) in points.iter().enumerate() {
        let Some(surface) = surface_under(world, point) else {
            bail!(
                "point {} at {} lies on no surface (none within {ON_SURFACE_M} m): use --method volume",
                i + 1,
                point.position
            );
        };
        let mut value = Vec3::ZERO;
        if part != Part::Indirect {
            let receiver = Receiver {
                position: point.position,
                normal: point.normal,
                geometric_normal: surface.geometric_normal,
            };
            value += direct::total_irradiance(world, &receiver, 64, i as u32);
        }
        if part != Part::Direct {
            let Surface { triangle, barycentric, back, .. } = surface;
            value += solution.radiosity.irradiance(triangle, barycentric, back, Part::Indirect);
        }
        values.push(value);
    }
    Ok(values)
}
