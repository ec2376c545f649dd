//! `volume`: builds and saves the irradiance volume.

use super::{Common, report, solve};
use anyhow::Context;
use clap::Args;
use std::path::PathBuf;

/// Options of `volume`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// File to write.
    #[arg(long)]
    out: PathBuf,
}

/// Builds, saves, and prints what it took.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let loaded = solve::load(&options.scene, common)?;
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
    println!(
        "{}",
        serde_json::to_string_pretty(&serde_json::json!({ "build_seconds": seconds, "volume": report }))?
    );
    Ok(())
}
