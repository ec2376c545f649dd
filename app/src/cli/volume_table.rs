//! The error of the irradiance volume over its settings, as a table.

use super::{
    solve::{self, Loaded},
    table,
};
use anyhow::bail;
use lumenscope_core::{
    irradiance_volume::VolumeSettings,
    measure::{
        irradiance::ErrorStatistics,
        volume::{ReferencePoints, VolumeRow, points_in_the_air, slope, volume_row},
    },
    scene::{direct::Receiver, world::World},
};
use std::path::Path;

/// Rows of bins a hemisphere of the table.
const BINS: [u32; 5] = [3, 5, 9, 17, 29];

/// Samples that the grids of the table stay within.
const SAMPLES: [u32; 5] = [36, 144, 576, 2_287, 9_200];

/// Where the light comes from that volumes are held to.
pub enum Truth<'a> {
    /// A table of indirect light.
    File(&'a Path),
    /// The path tracer.
    Traced {
        /// Points in the air.
        points: usize,
        /// Paths from each.
        paths: u32,
        /// Seed of the points and paths.
        seed: u64,
    },
}

impl Truth<'_> {
    fn at_points(&self, loaded: &Loaded, world: &World) -> anyhow::Result<ReferencePoints> {
        match *self {
            Self::File(path) => {
                let rows = table::read_reference(path)?;
                let receivers = rows.iter().map(|(p, _)| Receiver::new(p.position, p.normal)).collect();
                let column = |i: usize| rows.iter().map(|(_, values)| values[i]).collect();
                Ok(ReferencePoints::with_indirect(world, receivers, column(0), column(1)))
            }
            Self::Traced { points, paths, seed } => {
                let receivers = points_in_the_air(world, points, seed);
                if receivers.len() < points {
                    bail!(
                        "{}: only {} of {points} points lie in the air",
                        loaded.scene.name,
                        receivers.len()
                    );
                }
                Ok(solve::watched(|p| ReferencePoints::trace(world, receivers, paths, seed, p))?)
            }
        }
    }
}

/// Builds a volume a row and prints how far it is from the path tracer: first more bins on one grid, then
/// more samples with one number of bins.
///
/// # Errors
/// When a solver fails, or the scene has no open air to measure in.
pub fn print(loaded: &Loaded, truth: &Truth<'_>) -> anyhow::Result<()> {
    let solution = solve::solve(loaded, false)?;
    let world = &solution.world;
    let truth = truth.at_points(loaded, world)?;
    let settings = loaded.plan.solve.volume.clone().unwrap_or_default();
    println!(
        "{} points and directions, known to a median standard error of {:.2} % of max(E, 5 % of mean)",
        truth.receivers.len(),
        100.0 * truth.median_noise()?
    );
    println!("|E - E_ref| / max(E_ref, 5 % of the mean); direct light exact, and in `both` interpolated too");
    let rows = |all: &[VolumeSettings]| {
        all.iter()
            .map(|s| Ok(solve::watched(|p| volume_row(world, &*solution.radiosity, s, &truth, p))?))
            .collect::<anyhow::Result<Vec<VolumeRow>>>()
    };
    header();
    let by_bins = rows(&BINS.map(|bins_n| VolumeSettings { bins_n, ..settings.clone() }))?;
    by_bins.iter().for_each(line);
    slopes("median ~ n^", &by_bins, |r| f64::from(r.bins_n));
    header();
    let by_samples =
        rows(&SAMPLES.map(|target_samples| VolumeSettings { target_samples, ..settings.clone() }))?;
    by_samples.iter().for_each(line);
    slopes("median ~ spacing^", &by_samples, |r| f64::from(r.spacing_m));
    Ok(())
}

fn header() {
    println!(
        "\n{:>3} {:>7} {:>8} {:>8} {:>9} | {:^22} | {:^22} | {:^22}",
        "n", "samples", "spacing", "build", "bytes", "bins", "9 harmonics", "bins, both"
    );
    let each = "median   95th  signed";
    println!("{:>3} {:>7} {:>8} {:>8} {:>9} | {each:^22} | {each:^22} | {each:^22}", "", "", "m", "s", "");
}

fn line(row: &VolumeRow) {
    let e = |e: &ErrorStatistics| {
        format!(
            "{:5.2} % {:5.1} % {:+5.1} %",
            100.0 * e.median,
            100.0 * e.percentile_95,
            100.0 * e.mean_signed
        )
    };
    println!(
        "{:>3} {:>7} {:>8.3} {:>8.3} {:>9} | {:^22} | {:^22} | {:^22}",
        row.bins_n,
        row.samples,
        row.spacing_m,
        row.build_seconds,
        row.bytes,
        e(&row.bins),
        e(&row.harmonics),
        e(&row.interpolated)
    );
}

fn slopes(name: &str, rows: &[VolumeRow], x: impl Fn(&VolumeRow) -> f64) {
    let of = |y: &dyn Fn(&VolumeRow) -> f64| slope(&rows.iter().map(|r| (x(r), y(r))).collect::<Vec<_>>());
    println!(
        "{name}: bins {:+.2}, harmonics {:+.2}, both {:+.2}",
        of(&|r| r.bins.median),
        of(&|r| r.harmonics.median),
        of(&|r| r.interpolated.median)
    );
}
