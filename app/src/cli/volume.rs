//! `volume`: builds and saves the irradiance volume.

use super::{Common, report, solve, volume_options::VolumeOptions, volume_table};
use anyhow::{Context, bail};
use clap::Args;
use lumenscope_core::{irradiance_volume::ignored::Ignored, math::part::Part, scene::Scene};
use std::{path::PathBuf, sync::Arc};

/// Options of `volume`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// File to write.
    #[arg(long, required_unless_present = "table")]
    out: Option<PathBuf>,
    /// Objects, lamps and materials whose light is left out, by name.
    #[arg(long, value_delimiter = ',')]
    ignore: Vec<String>,
    /// Take what the bins see from the path tracer instead, with this many paths a bin.
    #[arg(long)]
    reference: Option<u32>,
    /// Print the error against the path tracer over bins and samples, with slopes, instead of saving a volume.
    #[arg(long)]
    table: bool,
    /// Points and directions of the table.
    #[arg(long, default_value_t = 1000)]
    points: usize,
    /// Paths a point of the table.
    #[arg(long, default_value_t = 4096)]
    spp: u32,
    /// Compare every basis with the exact sum over the radiance bins, at up to 500 samples and 40 normals each.
    #[arg(long)]
    compare_bases: bool,
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
    settings.ignored = ignored(&loaded.scene, &options.ignore)?;
    if options.table {
        return volume_table::print(&loaded, options.points, options.spp, common.seed);
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
    println!("{}", serde_json::to_string_pretty(&printed)?);
    Ok(())
}

/// Objects, lamps and materials by name; one name may mean several.
///
/// # Errors
/// When nothing has a name.
fn ignored(scene: &Scene, names: &[String]) -> anyhow::Result<Ignored> {
    fn of<'a>(names: impl Iterator<Item = &'a str>, wanted: &str) -> Vec<u32> {
        names.enumerate().filter(|(_, name)| *name == wanted).map(|(i, _)| i as u32).collect()
    }
    let mut ignored = Ignored::default();
    for name in names {
        let objects = of(scene.objects.iter().map(|o| o.name.as_str()), name);
        let lamps = of(scene.lamps.iter().map(|l| l.name.as_str()), name);
        let materials = of(scene.materials.iter().map(|m| m.name.as_str()), name);
        if objects.is_empty() && lamps.is_empty() && materials.is_empty() {
            bail!("--ignore {name}: the scene has no object, lamp or material of that name");
        }
        ignored.objects.extend(objects);
        ignored.lamps.extend(lamps);
        ignored.materials.extend(materials);
    }
    Ok(ignored)
}
