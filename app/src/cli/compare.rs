//! `compare`: how far two pictures are from each other.

use super::{compare_volumes, render::auto_display, solve};
use anyhow::Context;
use clap::Args;
use lumenscope_core::{
    io::{exr, png},
    math::{
        colour::{luminance, srgb8},
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    measure::picture::PictureError,
    superposition::composite,
};
use std::path::{Path, PathBuf};

/// Options of `compare`.
#[derive(Args)]
pub struct Options {
    /// Picture or irradiance volume (`.volume`) under test.
    a: PathBuf,
    /// Picture or volume to compare it with.
    b: PathBuf,
    /// Folder for the difference in false colour and as numbers, and for the map of FLIP; of volumes a map of A − B on
    /// three planes and a histogram.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Layer to compare; the picture itself by default.
    #[arg(long, default_value = "")]
    layer: String,
}

/// Compares and prints JSON.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options) -> anyhow::Result<()> {
    if [&options.a, &options.b].iter().all(|p| p.extension().is_some_and(|e| e == "volume")) {
        return compare_volumes::run(&options.a, &options.b, options.out.as_deref());
    }
    let (a, b) = (layer(&options.a, &options.layer)?, layer(&options.b, &options.layer)?);
    let display = auto_display(&b);
    let (error, flip) = PictureError::new(&a, &b, |image| composite::display(image, &display))?;
    let worst = error.worst;
    let report = serde_json::json!({
        "mse": error.mse,
        "rel_mse": error.rel_mse,
        "smape": error.smape,
        "mean_signed": error.mean_signed.to_array(),
        "flip": error.flip,
        "perceptual": error.perceptual,
        "worst_pixel": { "x": worst.x, "y": worst.y, "difference": worst.difference },
    });
    println!("{}", serde_json::to_string_pretty(&report)?);
    let Some(out) = &options.out else { return Ok(()) };
    solve::output_folder(out)?;
    let difference = LinearImage::from_fn(a.width, a.height, |x, y| (a.at(x, y) - b.at(x, y)).abs());
    let high = difference.pixels.iter().map(|p| luminance(*p)).fold(0.0, f32::max);
    let false_colour = FalseColour { palette: Default::default(), low: 0.0, high, logarithmic: false };
    let shown = composite::Display { false_colour: Some(false_colour), ..display };
    png::write_png(&out.join("difference.png"), a.width, a.height, &composite::display(&difference, &shown))?;
    let inferno = FalseColour::over([0.0, 1.0], Palette::Inferno);
    let noticed: Vec<[u8; 3]> = flip.map.iter().map(|v| srgb8(inferno.colour(*v))).collect();
    png::write_png(&out.join("flip.png"), a.width, a.height, &noticed)?;
    exr::write_layers(&out.join("difference.exr"), &[("", &difference)], "absolute difference, cd/m2")?;
    eprintln!(
        "{}: absolute luminance difference, 0 to {high:.3} cd/m²",
        out.join("difference.png").display()
    );
    Ok(())
}

fn layer(path: &Path, name: &str) -> anyhow::Result<LinearImage> {
    let layers = exr::read_layers(path)?;
    let names: Vec<String> = layers.iter().map(|(n, _)| format!("`{n}`")).collect();
    let found = layers.into_iter().find(|(n, _)| n == name);
    Ok(found.with_context(|| format!("{}: no layer `{name}`, only {}", path.display(), names.join(", ")))?.1)
}
