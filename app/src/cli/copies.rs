//! `copies`: one object twice, side by side, lit by two volumes at once.

use super::{
    Common, parse_point, parse_size,
    render::{Backend, auto_display, picture, write_png},
    solve,
};
use crate::copies::{Copies, CopiesRequest, CopyLight, CopyVolume};
use anyhow::{Context, bail};
use clap::Args;
use glam::Vec3;
use lumenscope_core::{
    irradiance_volume::{IrradianceVolume, VolumeSettings, dynamic_object::Detail},
    math::{colour::luminance, image::LinearImage, part::Part},
    transport::LightTransportSolution,
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Options of `copies`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Name of the object that is copied.
    #[arg(long)]
    object: String,
    /// Folder for `copies.png` and `copies.json`.
    #[arg(long)]
    out: PathBuf,
    /// Volume and light of the left copy: rows of bins a hemisphere or a volume's file, then all, direct or
    /// indirect, such as 5:all or office.volume:indirect.
    #[arg(long, value_parser = parse_light, default_value = "5:all")]
    left: Light,
    /// Volume and light of the right copy.
    #[arg(long, value_parser = parse_light, default_value = "17:all")]
    right: Light,
    /// The place midway between the copies, m; the middle of the scene by default.
    #[arg(long, value_parser = parse_point, allow_hyphen_values = true)]
    at: Option<Vec3>,
    /// Picture size.
    #[arg(long, default_value = "960x540", value_parser = parse_size)]
    size: [u32; 2],
}

/// What lights a copy.
#[derive(Clone, Debug, PartialEq)]
struct Light {
    volume: Volume,
    part: Part,
}

/// Where its volume comes from.
#[derive(Clone, Debug, PartialEq)]
enum Volume {
    /// Built with so many rows of bins a hemisphere.
    Rows(u32),
    /// Read from a file.
    File(PathBuf),
}

/// `N:PART` or `FILE.volume:PART`.
fn parse_light(text: &str) -> Result<Light, String> {
    let wrong = || {
        format!(
            "`{text}` is not N:PART with N from 1 to 64 or FILE.volume:PART, PART all, direct or indirect"
        )
    };
    let (volume, part) = text.rsplit_once(':').ok_or_else(wrong)?;
    let part = match part {
        "all" => Part::All,
        "direct" => Part::Direct,
        "indirect" => Part::Indirect,
        _ => return Err(wrong()),
    };
    let rows = volume.parse().ok().filter(|n| (1..=64).contains(n)).map(Volume::Rows);
    let file = volume.ends_with(".volume").then(|| Volume::File(volume.into()));
    Ok(Light { volume: rows.or(file).ok_or_else(wrong)?, part })
}

/// Solves, puts the copies in, writes the picture, prints how they differ.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let Some(object) = loaded.scene.objects.iter().position(|o| o.name == options.object) else {
        bail!("{}: no object is named \"{}\"", options.scene.display(), options.object);
    };
    let bare = solve::solve(&loaded, true)?;
    let (shown, report) = draw(options, &bare, object, common.seed)?;
    write_png(&options.out.join("copies.png"), &shown, &auto_display(&shown))?;
    let report = serde_json::to_string_pretty(&report)?;
    solve::write(&options.out.join("copies.json"), &report)?;
    println!("{report}");
    Ok(())
}

/// The picture of a solution with two copies of an object in it, and how the light on them differs.
///
/// # Errors
/// Where there is no volume, or one of the two cannot be built.
pub fn draw(
    options: &Options,
    bare: &LightTransportSolution,
    object: usize,
    seed: u64,
) -> anyhow::Result<(LinearImage, serde_json::Value)> {
    let present = bare.volume.clone().context("the plan built no volume")?;
    let sides = [&options.left, &options.right];
    let mut volumes = Vec::new();
    for side in sides {
        volumes.push(match &side.volume {
            Volume::File(path) => Arc::new(IrradianceVolume::load(path)?),
            Volume::Rows(n) if *n == present.settings().bins_n => present.clone(),
            Volume::Rows(n) => {
                let settings = VolumeSettings { bins_n: *n, ..present.settings().clone() };
                Arc::new(solve::watched(|p| {
                    IrradianceVolume::build(&bare.world, &*bare.radiosity, &settings, p)
                })?)
            }
        });
    }
    let mut copies = Copies::of(&bare.scene, object);
    copies.at = options.at.unwrap_or(copies.at);
    copies.lights = sides.map(|s| CopyLight { volume: CopyVolume::Present, part: s.part });
    let request = CopiesRequest { copies, volumes: [0, 1].map(|i| Some(volumes[i].clone())) };
    let dressed = request.dress(bare, None)?;
    let (layers, _) = picture(&dressed, options.size, 8, Backend::Cpu, seed)?;
    let shown = layers.total();
    let [left, right] = [0, 1].map(|i| node_light(&dressed, i));
    let mean = |v: &[f32]| v.iter().map(|e| f64::from(*e)).sum::<f64>() / v.len().max(1) as f64;
    let mut off: Vec<f32> =
        left.iter().zip(&right).filter(|(_, r)| **r > 0.0).map(|(l, r)| (l / r - 1.0).abs()).collect();
    off.sort_by(f32::total_cmp);
    let at = |share: f64| off.get((share * off.len().saturating_sub(1) as f64) as usize).copied();
    let side = |i: usize, light: &[f32]| {
        serde_json::json!({
            "bins": volumes[i].bins().len(),
            "part": format!("{:?}", sides[i].part).to_lowercase(),
            "mean_illuminance_lx": mean(light),
        })
    };
    let report = serde_json::json!({
        "scene": options.scene,
        "object": options.object,
        "left": side(0, &left),
        "right": side(1, &right),
        "nodes": left.len(),
        "relative_difference_median": at(0.5),
        "relative_difference_95th": at(0.95),
    });
    Ok((shown, report))
}

impl Options {
    /// Two copies of the office's chair over a desk, for the tour.
    pub fn for_tour(scene: &Path, size: [u32; 2]) -> Self {
        Self {
            scene: scene.to_path_buf(),
            object: "Chair".into(),
            out: PathBuf::new(),
            left: Light { volume: Volume::Rows(5), part: Part::All },
            right: Light { volume: Volume::Rows(17), part: Part::All },
            at: Some(Vec3::new(0.2, 1.45, 0.9)),
            size,
        }
    }
}

/// Illuminance at the nodes of a guest, from its own volume, lx.
fn node_light(solution: &LightTransportSolution, guest: usize) -> Vec<f32> {
    let guest = &solution.guests[guest];
    let (geometry, object) = (&solution.world.geometry, guest.object as usize);
    let wanted = [Part::Direct, Part::Indirect].map(|part| guest.part.holds(part));
    let light = guest.known.irradiance(&guest.volume, geometry, object, wanted, 1.0, Detail::Fine);
    light.into_iter().map(|[direct, indirect]| luminance(direct) + luminance(indirect)).collect()
}
