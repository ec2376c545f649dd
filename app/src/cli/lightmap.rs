//! `lightmap`: a lightmap baked elsewhere, held against our light.

use super::{Common, solve};
use anyhow::bail;
use clap::Args;
use glam::Vec3;
use lumenscope_core::{
    io::{exr, panorama, png},
    math::{
        colour::{linear_from_srgb, luminance, srgb8},
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    measure::irradiance::relative_errors,
    radiosity::lightmap::{LightmapReport, judge},
};
use std::path::PathBuf;

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
    /// Irradiance of white in a `.png`, or of 1 in the others, lx.
    #[arg(long, default_value_t = 1.0)]
    white: f32,
    /// Folder for our light, the difference and the faults, in the lightmap's texels.
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
    let mut map = panorama::read(&options.map)?;
    let encoded = options.map.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    for pixel in &mut map.pixels {
        let linear = if encoded { Vec3::from(pixel.to_array().map(linear_from_srgb)) } else { *pixel };
        *pixel = linear * options.white;
    }
    let loaded = solve::load(&options.scene, common)?;
    let solution = solve::solve(&loaded, false)?;
    let uvs: Vec<_> = solution.world.geometry.uvs.iter().map(|uvs| Some(*uvs)).collect();
    let report = judge(&solution.world, &solution.radiosity, &map, &uvs);
    if report.texels.is_empty() {
        bail!("{}: its texture coordinates cover no texel", options.scene.display());
    }
    println!("{}", serde_json::to_string_pretty(&summary(&report)?)?);
    let Some(out) = &options.out else { return Ok(()) };
    solve::output_folder(out)?;
    let (ours, difference, faults) = pictures(&report, &map);
    exr::write_layers(&out.join("ours.exr"), &[("", &ours)], "irradiance, lx")?;
    for (name, pixels) in [("difference.png", difference), ("faults.png", faults)] {
        png::write_png(&out.join(name), map.width, map.height, &pixels)?;
    }
    Ok(())
}

fn summary(report: &LightmapReport) -> anyhow::Result<serde_json::Value> {
    let column = |value: fn(&lumenscope_core::radiosity::lightmap::JudgedTexel) -> Vec3| {
        report.texels.iter().map(value).collect::<Vec<_>>()
    };
    let places = |list: &[usize]| -> Vec<[f32; 3]> {
        list.iter().take(LISTED).map(|&i| report.texels[i].position.to_array()).collect()
    };
    Ok(serde_json::json!({
        "texels": report.texels.len(),
        "relative_error": relative_errors(&column(|t| t.found), &column(|t| t.ours))?,
        "unmapped_triangles": report.unmapped.len(),
        "overlapping_texels": report.overlapping.len(),
        "stretched_triangles": report.stretched.len(),
        "triangles_of_uneven_density": report.uneven.len(),
        "seams": report.seams.len(),
        "first_seams_m": report.seams.iter().take(LISTED).map(|s| s.map(|p| p.to_array())).collect::<Vec<_>>(),
        "dark_texels": report.dark.len(),
        "first_dark_m": places(&report.dark),
        "leaking_texels": report.leaks.len(),
        "first_leaks_m": places(&report.leaks),
    }))
}

/// Our light; the difference, red where the lightmap has more; and the faults: dark blue, leaks orange,
/// overlaps magenta, over the lightmap in grey.
fn pictures(report: &LightmapReport, map: &LinearImage) -> (LinearImage, Vec<[u8; 3]>, Vec<[u8; 3]>) {
    let mut ours = LinearImage::new(map.width, map.height);
    let place = |at: [u32; 2]| (at[1] * map.width + at[0]) as usize;
    let mut difference = vec![[28, 28, 30]; map.pixels.len()];
    let mean = report.texels.iter().map(|t| luminance(t.ours)).sum::<f32>() / report.texels.len() as f32;
    let colours = FalseColour::over([-mean, mean], Palette::Diverging);
    let mut faults: Vec<[u8; 3]> = map
        .pixels
        .iter()
        .map(|p| srgb8(Vec3::splat(luminance(*p) / (2.0 * mean.max(f32::MIN_POSITIVE)))))
        .collect();
    for texel in &report.texels {
        ours.pixels[place(texel.at)] = texel.ours;
        difference[place(texel.at)] = srgb8(colours.colour(luminance(texel.found - texel.ours)));
    }
    for (list, colour) in [(&report.dark, [40, 90, 255]), (&report.leaks, [255, 140, 0])] {
        list.iter().for_each(|&i| faults[place(report.texels[i].at)] = colour);
    }
    report.overlapping.iter().for_each(|&at| faults[place(at)] = [255, 0, 220]);
    (ours, difference, faults)
}
