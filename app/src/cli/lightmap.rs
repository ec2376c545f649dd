//! `lightmap`: a lightmap baked elsewhere, held against our light.

use super::{Common, solve};
use crate::lightmaps::{JudgedLightmap, LightmapFile};
use anyhow::bail;
use clap::Args;
use lumenscope_core::{
    io::{exr, png},
    math::colour::srgb8,
    scene::{import, world::World},
};
use std::{path::PathBuf, sync::Arc};

/// Faults of a kind that are listed with their place.
const LISTED: usize = 5;

/// Options of `lightmap`.
#[derive(Args)]
pub struct Options {
    /// Scene whose texture coordinates the lightmap uses.
    scene: PathBuf,
    /// Lightmap: `.exr` or `.hdr` with irradiance in lx, or `.png`.
    #[arg(long)]
    map: PathBuf,
    /// Model file whose texture coordinates are used instead of the scene's, triangle by triangle, as `bake --atlas` writes one.
    #[arg(long, value_name = "FILE")]
    coordinates: Option<PathBuf>,
    /// Irradiance of white in a `.png`, or of 1 in the others, lx.
    #[arg(long, default_value_t = 1.0)]
    white: f32,
    /// Hold the lightmap and our light against the path tracer too, by this many paths a texel, 1 to 65536.
    #[arg(long, value_name = "PATHS", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    reference: Option<u32>,
    /// Folder for our light, the path tracer's where asked for, the difference and the faults, in the lightmap's texels.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Compares, prints JSON, writes pictures.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    if !(options.white > 0.0 && options.white.is_finite()) {
        bail!("--white must be positive, got {}", options.white);
    }
    let file = LightmapFile {
        path: options.map.clone(),
        white: options.white,
        paths: options.reference.unwrap_or(0),
    };
    // A missing file is told before anything is solved.
    file.read()?;
    let loaded = solve::load(&options.scene, common)?;
    let mut solution = solve::solve(&loaded, false)?;
    if let Some(path) = &options.coordinates {
        let uvs = World::new(&import::load(path)?).geometry.lightmap_uvs;
        let world = Arc::make_mut(&mut solution.world);
        let (found, wanted) = (uvs.len(), world.geometry.len());
        if found != wanted {
            bail!("{}: {found} triangles; the scene has {wanted}", path.display());
        }
        world.geometry.lightmap_uvs = uvs;
    }
    let judged = solve::watched(|progress| JudgedLightmap::new(&file, &solution, progress))?;
    println!("{}", serde_json::to_string_pretty(&summary(&judged))?);
    let Some(out) = &options.out else { return Ok(()) };
    solve::output_folder(out)?;
    exr::write_layers(&out.join("ours.exr"), &[("", &judged.ours())], "irradiance, lx")?;
    if let Some(reference) = judged.reference() {
        exr::write_layers(
            &out.join("reference.exr"),
            &[("", &reference)],
            "irradiance by the path tracer, lx",
        )?;
    }
    let colours = judged.difference_colours();
    let coloured = |d: Option<f32>| d.map_or(crate::widgets::field::UNKNOWN, |d| srgb8(colours.colour(d)));
    let difference = judged.difference().into_iter().map(coloured).collect();
    for (name, pixels) in [("difference.png", difference), ("faults.png", judged.fault_pixels())] {
        png::write_png(&out.join(name), judged.map.width, judged.map.height, &pixels)?;
    }
    Ok(())
}

fn summary(judged: &JudgedLightmap) -> serde_json::Value {
    let report = &judged.report;
    let places = |list: &[usize]| -> Vec<[f32; 3]> {
        list.iter().take(LISTED).map(|&i| report.texels[i].position.to_array()).collect()
    };
    let traced = judged.traced.as_ref().map(|t| {
        serde_json::json!({
            "paths": t.paths,
            "relative_standard_error": t.noise,
            "relative_error_of_map": t.of_map,
            "relative_error_of_ours": t.of_ours,
        })
    });
    serde_json::json!({
        "texels": report.texels.len(),
        "relative_error": judged.errors,
        "reference": traced,
        "unmapped_triangles": report.unmapped.len(),
        "overlapping_texels": report.overlapping.len(),
        "stretched_triangles": report.stretched.len(),
        "triangles_of_uneven_density": report.uneven.len(),
        "seams": report.seams.len(),
        "first_seams_m": report.seams.iter().take(LISTED).map(|s| s.ends.map(|p| p.to_array())).collect::<Vec<_>>(),
        "not_finite_texels": report.not_finite.len(),
        "dark_texels": report.dark.len(),
        "first_dark_m": places(&report.dark),
        "leaking_texels": report.leaks.len(),
        "first_leaks_m": places(&report.leaks),
    })
}
