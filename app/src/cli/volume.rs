//! `volume`: builds and saves the irradiance volume.

use super::{Common, report, solve, volume_options::VolumeOptions};
use anyhow::Context;
use clap::Args;
use lumenscope_core::math::part::Part;
use std::path::PathBuf;

/// Options of `volume`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// File to write.
    #[arg(long)]
    out: PathBuf,
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
    options.volume.apply(loaded.plan.volume_settings());
    let solution = solve::solve(&loaded, true)?;
    let volume = solution.volume.context("the plan built no volume")?;
    volume.save(&options.out)?;
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
