//! `volume`: builds and saves the irradiance volume.

use super::{
    Common,
    leaks::{self, parse_box},
    report, solve,
    volume_options::VolumeOptions,
    volume_table,
};
use anyhow::{Context, bail};
use clap::Args;
use glam::Vec3;
use lumenscope_core::{
    irradiance_volume::{Basis, IrradianceVolume, ignored::Ignored},
    math::{frame::uniform_direction, part::Part, random::Rng},
    scene::Scene,
};
use std::{path::PathBuf, sync::Arc, time::Instant};

/// Two corners of a box, m.
type Box3 = [Vec3; 2];

/// Options of `volume`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// File to write.
    #[arg(long, required_unless_present_any = ["table", "lit"])]
    out: Option<PathBuf>,
    /// Print how much light leaks from this box, X,Y,Z:X,Y,Z in metres, into a dark one, by repair and guard, instead
    /// of saving a volume.
    #[arg(long, value_parser = parse_box, allow_hyphen_values = true, requires = "dark")]
    lit: Option<Box3>,
    /// The box that no light reaches.
    #[arg(long, value_parser = parse_box, allow_hyphen_values = true, requires = "lit")]
    dark: Option<Box3>,
    /// Objects, lamps and materials whose light is left out, by name.
    #[arg(long, value_delimiter = ',')]
    ignore: Vec<String>,
    /// Take what the bins see from the path tracer instead, with this many paths a bin.
    #[arg(long)]
    reference: Option<u32>,
    /// Print the error against the path tracer over bins and samples, with slopes, instead of saving a volume.
    #[arg(long)]
    table: bool,
    /// Indirect light at the points of the table, as `irradiance --method reference --part indirect` wrote it;
    /// traced at random points in the air if not given.
    #[arg(long)]
    truth: Option<PathBuf>,
    /// Points and directions of the table.
    #[arg(long, default_value_t = 1000)]
    points: usize,
    /// Paths a point of the table.
    #[arg(long, default_value_t = 4096)]
    spp: u32,
    /// Compare every basis with the exact sum over the radiance bins, at up to 500 samples and 40 normals each.
    #[arg(long)]
    compare_bases: bool,
    /// Time this many queries at random points and normals on one thread, in every basis.
    #[arg(long)]
    queries: Option<usize>,
    #[command(flatten)]
    volume: VolumeOptions,
}

/// Samples, and normals at each, at which bases are compared.
const COMPARED: (usize, u64) = (500, 40);

/// Builds, saves, and prints what it took.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let mut loaded = solve::load(&options.scene, common)?;
    let settings = loaded.plan.volume_settings();
    options.volume.apply(settings);
    if !options.ignore.is_empty() {
        settings.ignored = ignored(&loaded.scene, &options.ignore)?;
    }
    if options.table {
        let truth = match &options.truth {
            Some(file) => volume_table::Truth::File(file),
            None => {
                volume_table::Truth::Traced { points: options.points, paths: options.spp, seed: common.seed }
            }
        };
        return volume_table::print(&loaded, &truth);
    }
    if let (Some(lit), Some(dark)) = (options.lit, options.dark) {
        return leaks::print(&loaded, lit, dark);
    }
    let solution = solve::solve(&loaded, true)?;
    let mut volume = solution.volume.context("the plan built no volume")?;
    if let Some(paths) = options.reference {
        let traced = solve::watched(|progress| volume.of_reference(&solution.world, paths, progress))?;
        volume = Arc::new(traced);
    }
    if let Some(out) = &options.out {
        volume.save(out)?;
    }
    let seconds = solution
        .provenance
        .stage_seconds
        .iter()
        .find(|(name, _)| name == "irradiance volume")
        .map_or(0.0, |s| s.1);
    let report = report::volume(&volume);
    let mut printed = serde_json::json!({ "build_seconds": seconds, "volume": report });
    if options.compare_bases {
        let (samples, normals) = COMPARED;
        let parts = [("all", Part::All), ("direct", Part::Direct), ("indirect", Part::Indirect)];
        let errors = parts.map(|(name, part)| {
            (name, volume.compare_bases(&solution.world, &*solution.radiosity, part, samples, normals))
        });
        for (name, errors) in &errors {
            eprintln!("{name:<9}{:>9}{:>9}{:>9}{:>9}{:>12}", "median", "95th", "worst", "signed", "bytes");
            for e in errors {
                let [a, b, c, d] = [e.median, e.percentile_95, e.worst, e.mean_signed].map(|v| 100.0 * v);
                eprintln!("  {:<20} {a:.2} % {b:8.2} % {c:8.2} % {d:+8.2} % {:9}", e.basis.name(), e.bytes);
            }
        }
        printed["basis_errors"] = serde_json::to_value(std::collections::BTreeMap::from(errors))?;
    }
    if let Some(count) = options.queries {
        printed["queries_per_second"] = rates(&volume, count.max(1), common.seed);
    }
    println!("{}", serde_json::to_string_pretty(&printed)?);
    Ok(())
}

/// Objects, lamps and materials by name; one name may mean several.
///
/// # Errors
/// When nothing has a name.
pub(super) fn ignored(scene: &Scene, names: &[String]) -> anyhow::Result<Ignored> {
    match Ignored::named(scene, names) {
        (ignored, None) => Ok(ignored),
        (_, Some(name)) => bail!("--ignore {name}: the scene has no object, lamp or material of that name"),
    }
}

/// Repetitions of which the quickest counts: the others were disturbed.
const REPEATED: u32 = 5;

/// Queries a second on one thread, in batches and one by one.
fn rates(volume: &IrradianceVolume, count: usize, seed: u64) -> serde_json::Value {
    let (low, high) = volume.grid().bounds();
    let queries: Vec<(Vec3, Vec3)> = (0..count as u64)
        .map(|i| {
            let mut rng = Rng::new(seed, i);
            let at = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            (low + (high - low) * at, uniform_direction(rng.next_vec2()))
        })
        .collect();
    let mut answers = vec![Vec3::ZERO; count];
    let mut rate = |ask: &dyn Fn(&mut [Vec3])| {
        let seconds = (0..REPEATED).map(|_| {
            let start = Instant::now();
            ask(&mut answers);
            start.elapsed().as_secs_f64()
        });
        count as f64 / seconds.fold(f64::INFINITY, f64::min)
    };
    let mut rows = serde_json::Map::new();
    for basis in Basis::ALL {
        let volume = volume.with_basis(basis);
        let batch = rate(&|out| volume.irradiance_batch(&queries, Part::Indirect, out));
        let single = rate(&|out| {
            for ((p, n), out) in queries.iter().zip(out) {
                *out = volume.irradiance(*p, *n, Part::Indirect);
            }
        });
        let row = serde_json::json!({ "batch": batch.round(), "one_by_one": single.round() });
        eprintln!(
            "{:<20}{:>7.1} M/s in batches{:>7.1} M/s one by one",
            basis.name(),
            batch / 1e6,
            single / 1e6
        );
        rows.insert(basis.name().into(), row);
    }
    rows.into()
}
