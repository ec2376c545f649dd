//! `probe`: the spheres at one point.

use super::{
    Common, parse_point,
    render::{auto_display, write_png},
    solve,
};
use anyhow::bail;
use clap::Args;
use glam::Vec3;
use lumenscope_core::{
    io::exr,
    irradiance_volume::probe::Probe,
    math::{colour::luminance, image::LinearImage, part::Part, sphere_map::DirectionBins},
};
use std::path::PathBuf;

/// Options of `probe`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Point, m.
    #[arg(long, value_parser = parse_point)]
    at: Vec3,
    /// Folder for `probe.exr` (the bins), `radiance.png`, `irradiance.png` and `probe.json`.
    #[arg(long)]
    out: PathBuf,
    /// Bins over the sphere: 2n² for a whole n, such as 162, 578, 1682, 3362, 4802.
    #[arg(long, default_value_t = 1682)]
    bins: u32,
}

/// Side of the sphere pictures, pixels.
const SPHERE_PIXELS: u32 = 512;

/// Probes and writes.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let n = (f64::from(options.bins) / 2.0).sqrt().round() as u32;
    if n == 0 || 2 * n * n != options.bins {
        bail!("--bins {}: not 2n² for a whole n; the nearest is {}", options.bins, 2 * n.max(1) * n.max(1));
    }
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let solution = solve::solve(&loaded, false)?;
    let probe = Probe::at(&solution.world, &*solution.radiosity, options.at, n, 4, common.seed)?;
    let bins = DirectionBins::new(n);
    let radiance = sphere(&probe.radiance, bins);
    let irradiance = sphere(&probe.irradiance(Part::All), bins);
    write_png(&options.out.join("radiance.png"), &radiance, &auto_display(&radiance))?;
    write_png(&options.out.join("irradiance.png"), &irradiance, &auto_display(&irradiance))?;
    let [upper, lower] = unfolded(&probe.radiance, n);
    let [upper_e, lower_e] = unfolded(&probe.irradiance(Part::All), n);
    let images = [
        ("radiance_upper", &upper),
        ("radiance_lower", &lower),
        ("irradiance_upper", &upper_e),
        ("irradiance_lower", &lower_e),
    ];
    let note = format!("{} bins at {} m: radiance in cd/m2, irradiance in lx", options.bins, options.at);
    exr::write_layers(&options.out.join("probe.exr"), &images, &note)?;
    let axes = [
        ("+x", Vec3::X),
        ("-x", Vec3::NEG_X),
        ("+y", Vec3::Y),
        ("-y", Vec3::NEG_Y),
        ("+z", Vec3::Z),
        ("-z", Vec3::NEG_Z),
    ];
    let at = |part: Part| {
        let values = probe.irradiance(part);
        axes.iter()
            .map(|(name, d)| ((*name).to_owned(), serde_json::json!(luminance(values[bins.bin(*d)]))))
            .collect::<serde_json::Map<_, _>>()
    };
    let report = serde_json::json!({
        "at_m": options.at.to_array(), "bins": options.bins,
        "irradiance_lx": { "all": at(Part::All), "direct": at(Part::Direct), "indirect": at(Part::Indirect) },
    });
    let text = serde_json::to_string_pretty(&report)?;
    println!("{text}");
    solve::write(&options.out.join("probe.json"), &text)
}

/// The sphere seen along −z, each pixel the bin its normal falls in.
fn sphere(values: &[Vec3], bins: DirectionBins) -> LinearImage {
    let half = SPHERE_PIXELS as f32 / 2.0;
    LinearImage::from_fn(SPHERE_PIXELS, SPHERE_PIXELS, |x, y| {
        let p = Vec3::new((x as f32 + 0.5 - half) / half, (half - y as f32 - 0.5) / half, 0.0) * 1.05;
        let z2 = 1.0 - p.length_squared();
        if z2 < 0.0 { Vec3::ZERO } else { values[bins.bin(p.with_z(z2.sqrt()))] }
    })
}

/// Both hemispheres as n×n images of the equal-area square.
fn unfolded(values: &[Vec3], n: u32) -> [LinearImage; 2] {
    let side = |offset: u32| LinearImage {
        width: n,
        height: n,
        pixels: values[offset as usize..(offset + n * n) as usize].to_vec(),
    };
    [side(0), side(n * n)]
}
