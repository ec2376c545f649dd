//! `chart`: every method at many settings, seconds against error.

use super::{
    Common, irradiance, parse_size,
    plot::{Panel, Plot},
    solve,
    table::{self, PointRow},
};
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use lumenscope_core::{
    irradiance_volume::VolumeSettings,
    measure::{
        chart::{Point, Saving, front, saving},
        irradiance::{ErrorStatistics, points_on_surfaces},
        sweep::{Row, Sweep},
        volume::ReferencePoints,
    },
    radiosity::{RadiositySettings, RadiositySolution, subdivide::Subdivision, surface_map::ElementLayout},
    scene::{direct::Receiver, geometry::Surface, world::World},
};
use std::{fmt::Write, path::PathBuf};

/// Options of `chart`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Folder for `chart.csv`, `chart.svg`, `chart.png`, `pareto.json` and, where it is traced, the light that
    /// methods are held to, `reference.csv`.
    #[arg(long)]
    out: PathBuf,
    /// Points of surfaces at which light is compared.
    #[arg(long, default_value_t = 1000)]
    points: usize,
    /// Paths from each point for the light that others are held to.
    #[arg(long, default_value_t = 16_384, value_parser = clap::value_parser!(u32).range(2..))]
    spp: u32,
    /// Indirect light known already, a `reference.csv` of an earlier run, instead of points and paths of this one.
    #[arg(long)]
    truth: Option<PathBuf>,
    /// Size of the picture whose pixels are asked for after a solve.
    #[arg(long, default_value = "640x360", value_parser = parse_size)]
    size: [u32; 2],
    /// Methods to sweep.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Method::ALL)]
    methods: Vec<Method>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Uniform grids: spacing of elements, then rays of each.
    Radiosity,
    /// Quadtrees split a posteriori, by the spacing of their roots.
    Quadtrees,
    /// The irradiance volume: bins, then samples.
    Volume,
    /// The path tracer: paths a point.
    Paths,
}

impl Method {
    const ALL: [Self; 4] = [Self::Radiosity, Self::Quadtrees, Self::Volume, Self::Paths];
}

/// Rays an element as factors on the planned ones; a line each for uniform grids and for quadtrees.
const RAYS: [f32; 3] = [0.25, 1.0, 4.0];
/// The planned ones among them.
const PLANNED: usize = 1;
/// Spacings as factors on the planned one.
const SPACINGS: [f32; 6] = [4.0, 2.83, 2.0, 1.41, 1.0, 0.71];
/// Spacings of roots.
const ROOTS: [f32; 5] = [5.66, 4.0, 2.83, 2.0, 1.41];
const BIN_ROWS: [u32; 4] = [3, 5, 9, 17];
const SAMPLE_COUNTS: [u32; 4] = [36, 144, 576, 9_200];
const PATH_COUNTS: [u32; 6] = [1, 4, 16, 64, 256, 1024];

/// Lines of the chart, by their first number.
const UNIFORM: usize = 0;
const TREES: usize = UNIFORM + RAYS.len();
const BINS: usize = TREES + RAYS.len();
const SAMPLES: usize = BINS + 1;
const PATHS: usize = SAMPLES + 1;

fn rays(planned: u32, factor: f32) -> u32 {
    ((planned as f32 * factor) as u32).max(1)
}

/// Names of the lines.
fn names(planned: u32) -> Vec<String> {
    let of =
        |what: &'static str| RAYS.map(|factor| format!("{what}, {} rays, by spacing", rays(planned, factor)));
    let others = ["volume, by bins", "volume, by samples", "path tracer, by paths"].map(String::from);
    of("uniform grids").into_iter().chain(of("quadtrees")).chain(others).collect()
}

/// One point of the chart.
struct Measured {
    line: usize,
    setting: String,
    row: Row,
}

/// Sweeps the methods; writes table, chart and fronts, and prints what adaptive elements save.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let world = World::new(&loaded.scene);
    let (surfaces, truth) = truth(options, &world, common.seed)?;
    let noise = truth.median_noise()?;
    println!("{} points, known to a median standard error of {:.2} %", surfaces.len(), 100.0 * noise);
    let sweep = Sweep { world: &world, surfaces, truth, pixels: options.size[0] * options.size[1] };
    let settings = &loaded.plan.solve;
    let mut all: Vec<Measured> = Vec::new();
    println!(
        "{:<34} {:<16} {:>8} {:>8} {:>8} | {:>7} {:>7} {:>8} | {:>7} | {:>7} {:>7}",
        "line",
        "setting",
        "size",
        "solve s",
        "total s",
        "picture",
        "95th",
        "signed",
        "bicubic",
        "stored",
        "95th"
    );
    let names = names(settings.radiosity.gather_rays);
    let mut keep = |line: usize, setting: String, row: Row| {
        println!("{}", words(&names[line], &setting, &row));
        all.push(Measured { line, setting, row });
    };
    let planned = radiosity(&sweep, &settings.radiosity, &options.methods, &mut keep)?;
    if options.methods.contains(&Method::Volume) {
        let planned = match planned {
            Some(planned) => planned,
            None => measured(&sweep, &settings.radiosity)?,
        };
        let light = (&planned.1, planned.0.solve_seconds);
        let base = settings.volume.clone().unwrap_or_default();
        let bins =
            BIN_ROWS.map(|bins_n| (BINS, format!("n = {bins_n}"), VolumeSettings { bins_n, ..base.clone() }));
        let grids = SAMPLE_COUNTS.map(|target_samples| {
            let settings = VolumeSettings { target_samples, samples: None, ..base.clone() };
            (SAMPLES, format!("<= {target_samples}"), settings)
        });
        for (line, name, settings) in bins.into_iter().chain(grids) {
            keep(line, name, solve::watched(|p| sweep.volume(light, &settings, p))?);
        }
    }
    if options.methods.contains(&Method::Paths) {
        for paths in PATH_COUNTS {
            keep(
                PATHS,
                format!("{paths} paths"),
                solve::watched(|p| {
                    p.begin("path tracer");
                    sweep.paths(paths, common.seed)
                })?,
            );
        }
    }
    write(options, &loaded.scene.name, names, &all, noise)
}

/// Points and the light there.
fn truth(options: &Options, world: &World, seed: u64) -> anyhow::Result<(Vec<Surface>, ReferencePoints)> {
    if let Some(path) = &options.truth {
        let rows = table::read_reference(path)?;
        let under = |(i, (point, _)): (usize, &(PointRow, _))| {
            irradiance::surface_under(world, point)
                .with_context(|| format!("{}: point {} lies on no surface", path.display(), i + 1))
        };
        let surfaces = rows.iter().enumerate().map(under).collect::<anyhow::Result<Vec<_>>>()?;
        let receivers = surfaces.iter().map(Receiver::of).collect();
        let column = |i: usize| rows.iter().map(|(_, values)| values[i]).collect();
        let truth = ReferencePoints::with_indirect(world, receivers, column(0), column(1));
        return Ok((surfaces, truth));
    }
    let surfaces = points_on_surfaces(world, options.points, seed);
    if surfaces.is_empty() {
        bail!("{}: no point lies on a lit surface", options.scene.display());
    }
    let receivers = surfaces.iter().map(Receiver::of).collect();
    let truth = solve::watched(|p| ReferencePoints::trace(world, receivers, options.spp, seed, p))?;
    let rows: Vec<PointRow> =
        truth.receivers.iter().map(|r| PointRow { position: r.position, normal: r.normal }).collect();
    let mut columns = irradiance::rgb_columns(&truth.indirect);
    columns.extend(irradiance::error_columns(&truth.standard_error));
    solve::write(&options.out.join("reference.csv"), &table::format_points(&rows, &columns))?;
    Ok((surfaces, truth))
}

fn measured(sweep: &Sweep<'_>, settings: &RadiositySettings) -> anyhow::Result<(Row, RadiositySolution)> {
    Ok(solve::watched(|p| sweep.radiosity(settings, p))?)
}

/// Sweeps the radiosity; hands back the planned settings' row and solution where they were among it.
fn radiosity(
    sweep: &Sweep<'_>,
    planned: &RadiositySettings,
    methods: &[Method],
    keep: &mut dyn FnMut(usize, String, Row),
) -> anyhow::Result<Option<(Row, RadiositySolution)>> {
    let spacing = ElementLayout::new(&sweep.world.geometry, planned.element_spacing_m).spacing_m;
    let subdivision = planned.subdivision.unwrap_or(Subdivision { levels: 2, ..Subdivision::default() });
    let settings = |rays_factor: f32, factor: f32, subdivision| RadiositySettings {
        element_spacing_m: Some(factor * spacing),
        gather_rays: rays(planned.gather_rays, rays_factor),
        subdivision,
        ..*planned
    };
    let mut found = None;
    for (line, rays_factor) in RAYS.into_iter().enumerate() {
        for factor in SPACINGS.into_iter().filter(|_| methods.contains(&Method::Radiosity)) {
            let (row, solution) = measured(sweep, &settings(rays_factor, factor, None))?;
            keep(UNIFORM + line, format!("{:.4} m", factor * spacing), row.clone());
            if line == PLANNED && factor == 1.0 {
                found = Some((row, solution));
            }
        }
    }
    for (line, rays_factor) in RAYS.into_iter().enumerate() {
        for factor in ROOTS.into_iter().filter(|_| methods.contains(&Method::Quadtrees)) {
            let (row, _) = measured(sweep, &settings(rays_factor, factor, Some(subdivision)))?;
            keep(TREES + line, format!("{:.4} m / {}", factor * spacing, 1 << subdivision.levels), row);
        }
    }
    Ok(found)
}

fn words(name: &str, setting: &str, row: &Row) -> String {
    let percent = |e: f64| format!("{:5.2} %", 100.0 * e);
    let Row { size, solve_seconds, seconds, picture, bicubic, stored, .. } = row;
    format!(
        "{name:<34} {setting:<16} {size:>8} {solve_seconds:>8.3} {seconds:>8.3} | {} {} {:>8} | {:>7} | {} {}",
        percent(picture.median),
        percent(picture.percentile_95),
        format!("{:+.2} %", 100.0 * picture.mean_signed),
        bicubic.map_or(String::new(), |b| percent(b.median)),
        percent(stored.median),
        percent(stored.percentile_95),
    )
}

type Error = fn(&Row) -> Option<ErrorStatistics>;
type Cost = fn(&Row) -> f64;

/// The two ways of showing that a chart has a panel for.
const SHOWN: [(&str, Error, &str); 2] = [
    ("picture", |r| Some(r.picture), "as pictures show it: direct light exact"),
    ("stored", |r| Some(r.stored), "direct light by the method too"),
];

/// (cost, median error) of the settings of some lines, cheapest first.
fn curve(all: &[Measured], lines: std::ops::Range<usize>, cost: Cost, error: Error) -> Vec<Point> {
    let of_lines = all.iter().filter(|m| lines.contains(&m.line));
    let mut points: Vec<Point> =
        of_lines.filter_map(|m| Some([cost(&m.row), error(&m.row)?.median])).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// What uniform grids cost over quadtrees: elements and rays at the planned rays an element, seconds by whatever rays
/// serve best.
fn savings(all: &[Measured]) -> Vec<(&'static str, &'static str, Option<Saving>)> {
    let planned = |first: usize| first + PLANNED..first + PLANNED + 1;
    let any = |first: usize| first..first + RAYS.len();
    let mut found = Vec::new();
    for (shown, error, _) in SHOWN {
        let mut add = |name, lines: &dyn Fn(usize) -> std::ops::Range<usize>, cost: Cost| {
            let of = |first| curve(all, lines(first), cost, error);
            found.push((shown, name, saving(&of(UNIFORM), &of(TREES))));
        };
        add("elements", &planned, |r| r.size as f64);
        add("seconds at as many rays an element", &planned, |r| r.solve_seconds);
        add("rays", &any, |r| r.rays as f64);
        add("seconds", &any, |r| r.solve_seconds);
    }
    found
}

fn write(
    options: &Options,
    scene: &str,
    names: Vec<String>,
    all: &[Measured],
    noise: f64,
) -> anyhow::Result<()> {
    let [width, height] = options.size;
    let panels = SHOWN.map(|(_, error, title)| {
        let mut lines: Vec<Vec<Point>> =
            (UNIFORM..=PATHS).map(|line| curve(all, line..line + 1, |r| r.seconds, error)).collect();
        lines.iter_mut().flatten().for_each(|p| p[1] *= 100.0);
        let level = Some((100.0 * noise, "the reference's own standard error".into()));
        let axes = [format!("solving and asking at {width}x{height} pixels, s"), "median error, %".into()];
        Panel { title: title.into(), axes, lines, level, front: true }
    });
    let plot = Plot {
        title: format!(
            "{scene}: seconds against error at {} points of surfaces",
            all.first().map_or(0, |m| m.row.picture.count)
        ),
        names: names.clone(),
        panels: panels.into(),
    };
    plot.write(&options.out, "chart")?;
    solve::write(&options.out.join("chart.csv"), &csv(&names, all))?;
    let compared = savings(all);
    for (shown, cost, saved) in &compared {
        match saved {
            Some(s) => println!(
                "{shown}: uniform grids take {:.2} times the {cost} of quadtrees at equal median error ({:.2} to \
                 {:.2} for errors of {:.2} to {:.2} %)",
                s.factor,
                s.least,
                s.most,
                100.0 * s.errors[0],
                100.0 * s.errors[1]
            ),
            None => println!("{shown}: uniform grids and quadtrees reach no error in common, {cost}"),
        }
    }
    let fronts: serde_json::Map<String, serde_json::Value> = SHOWN
        .into_iter()
        .map(|(shown, error, _)| {
            let points: Vec<Point> = all
                .iter()
                .map(|m| [m.row.seconds, error(&m.row).map_or(f64::NAN, |e| e.median)])
                .collect();
            let on_front = front(&points).into_iter().map(|i| {
                serde_json::json!({ "line": names[all[i].line], "setting": all[i].setting, "row": all[i].row })
            });
            (shown.to_owned(), on_front.collect())
        })
        .collect();
    let json = serde_json::json!({
        "scene": options.scene,
        "reference_median_standard_error": noise,
        "pareto_front": fronts,
        "uniform_over_quadtrees": compared
            .iter()
            .map(|(shown, cost, saved)| serde_json::json!({ "shown": shown, "cost": cost, "saving": saved }))
            .collect::<Vec<_>>(),
    });
    solve::write(&options.out.join("pareto.json"), &serde_json::to_string_pretty(&json)?)
}

fn csv(names: &[String], all: &[Measured]) -> String {
    let mut text = String::from(
        "line,setting,size,rays,solve_seconds,seconds,picture_median,picture_95,picture_signed,bicubic_median,bicubic_95,\
         stored_median,stored_95,stored_signed\n",
    );
    for Measured { line, setting, row } in all {
        let (p, s) = (row.picture, row.stored);
        let bicubic = row.bicubic.map_or(",".into(), |b| format!("{},{}", b.median, b.percentile_95));
        let _ = writeln!(
            text,
            "\"{}\",{setting},{},{},{},{},{},{},{},{bicubic},{},{},{}",
            names[*line],
            row.size,
            row.rays,
            row.solve_seconds,
            row.seconds,
            p.median,
            p.percentile_95,
            p.mean_signed,
            s.median,
            s.percentile_95,
            s.mean_signed
        );
    }
    text
}
