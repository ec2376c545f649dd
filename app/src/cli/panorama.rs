//! `panorama` and `panoramas`: a picture of everything around a point, and a volume from such pictures.

use super::{Common, parse_point, report, solve};
use crate::panoramas;
use clap::Args;
use glam::Vec3;
use lumenscope_core::{
    io::panorama as files,
    irradiance_volume::{IrradianceVolume, VolumeSettings},
    superposition::panorama::panorama,
};
use std::path::PathBuf;

/// Options of `panorama`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Point, m.
    #[arg(long, value_parser = parse_point, allow_hyphen_values = true)]
    at: Vec3,
    /// OpenEXR environment map to write, cd/m²: +z in the middle, +x to the left of it, as OpenEXR defines it.
    #[arg(long)]
    out: PathBuf,
    /// Height in pixels, from 1 to 8192; the width is twice that.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=8192))]
    height: u32,
    /// Rays along each edge of a pixel, from 1 to 16.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=16))]
    rays: u32,
}

/// Renders and writes a panorama.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let loaded = solve::load(&options.scene, common)?;
    let solution = solve::solve(&loaded, false)?;
    let image =
        solve::watched(|progress| panorama(&solution, options.at, options.height, options.rays, progress))?;
    files::write(&options.out, &image, options.at)?;
    let mean = image.mean();
    eprintln!("{}: mean {:.3} {:.3} {:.3} cd/m²", options.out.display(), mean.x, mean.y, mean.z);
    Ok(())
}

/// Options of `panoramas`.
#[derive(Args)]
pub struct VolumeOptions {
    /// RON list of nodes: `[(position: (x, y, z), file: "p.exr"), …]`; files beside the list, .exr or .hdr.
    nodes: PathBuf,
    /// Volume to write.
    #[arg(long)]
    out: PathBuf,
    /// Samples an axis as `X,Y,Z`; as many as the nodes have different coordinates if not given.
    #[arg(long, value_delimiter = ',', num_args = 3)]
    samples: Vec<u32>,
    /// Rows and columns of bins a hemisphere.
    #[arg(long, default_value_t = 17)]
    bins_n: u32,
}

/// Reads panoramas, makes a volume of them and writes it.
///
/// # Errors
/// One line naming the file and the cause.
pub fn volume(options: &VolumeOptions) -> anyhow::Result<()> {
    let nodes = panoramas::read(&options.nodes)?;
    let samples = <[u32; 3]>::try_from(&options.samples[..]).ok();
    let settings = VolumeSettings { samples, bins_n: options.bins_n, ..VolumeSettings::default() };
    let volume = solve::watched(|progress| IrradianceVolume::from_panoramas(&nodes, &settings, progress))?;
    volume.save(&options.out)?;
    println!("{}", serde_json::to_string_pretty(&report::volume(&volume))?);
    Ok(())
}
