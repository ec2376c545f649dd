//! How much light a volume lets through walls, by what is done about it, as a table.

use super::solve::{self, Loaded};
use anyhow::Context;
use glam::Vec3;
use lumenscope_core::{
    irradiance_volume::{IrradianceVolume, VolumeSettings, trust::Repair},
    measure::leak::leak,
};

/// A box, m: `X,Y,Z:X,Y,Z`.
pub fn parse_box(text: &str) -> Result<[Vec3; 2], String> {
    let corners = text.split_once(':').map(|(a, b)| (super::parse_point(a), super::parse_point(b)));
    match corners {
        Some((Ok(a), Ok(b))) => Ok([a.min(b), a.max(b)]),
        _ => Err(format!("`{text}` is not X,Y,Z:X,Y,Z, two corners of a box in metres")),
    }
}

/// Builds a volume for each repair and prints what leaks from one place into another, unguarded and guarded.
///
/// # Errors
/// When a solver fails, or the place that should be lit is dark.
pub fn print(loaded: &Loaded, lit: [Vec3; 2], dark: [Vec3; 2]) -> anyhow::Result<()> {
    let solution = solve::solve(loaded, false)?;
    let settings = loaded.plan.solve.volume.clone().unwrap_or_default();
    println!("illuminance at 2,000 points and directions of the dark place over the mean of the lit one");
    println!(
        "{:<10} {:>8} {:>10} {:>10} {:>10} {:>10}",
        "repair", "samples", "plain", "worst", "guarded", "worst"
    );
    for repair in Repair::ALL {
        let settings = VolumeSettings { repair, guard: false, ..settings.clone() };
        let plain =
            solve::watched(|p| IrradianceVolume::build(&solution.world, &*solution.radiosity, &settings, p))?;
        let guarded = plain.with_guard(Some(&solution.world));
        let of = |v: &IrradianceVolume| leak(v, lit, dark).context("--lit: no light reaches that place");
        let (a, b) = (of(&plain)?, of(&guarded)?);
        let [a, aw, b, bw] = [a.mean, a.worst, b.mean, b.worst].map(|v| 100.0 * v);
        println!(
            "{:<10} {:>8} {a:>8.3} % {aw:>8.2} % {b:>8.3} % {bw:>8.2} %",
            repair.name(),
            plain.samples().len()
        );
    }
    Ok(())
}
