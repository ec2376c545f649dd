//! Pictures and layers as files.

use crate::worker::ExportRequest;
use anyhow::{Context as _, Result, bail};
use lumenscope_core::{
    math::progress::Progress,
    superposition::{
        PassSettings,
        accumulator::Accumulator,
        composite::{DirectQuality, Display, display},
        layers::Layers,
        render,
    },
};

/// Frames averaged: each looks through another place in the pixels, so that edges are smooth.
const FRAMES: u32 = 8;

/// Writes what was asked for.
///
/// # Errors
/// With the file's name, if it cannot be written; [`Cancelled`](lumenscope_core::math::progress::Cancelled).
pub fn write(request: &ExportRequest, progress: &Progress) -> Result<()> {
    progress.begin("picture");
    let mut sum = Accumulator::new();
    for frame in 0..FRAMES {
        progress.report(frame as f32 / FRAMES as f32)?;
        let direct = match request.shadow_rays {
            0 => DirectQuality::Elements,
            rays => DirectQuality::PerPixel(rays.div_ceil(FRAMES)),
        };
        let settings = PassSettings { direct, frame, jitter: true, ..PassSettings::default() };
        let [width, height] = request.size;
        sum.add(&render(&request.solution, &request.camera, width, height, &settings).1);
    }
    progress.begin("writing");
    let layers = sum.mean();
    match &request.display {
        Some(shown) => write_png(request, &layers, shown),
        None => bail!("{}: EXR cannot be written yet", request.path.display()),
    }
}

fn write_png(request: &ExportRequest, layers: &Layers, shown: &Display) -> Result<()> {
    let picture = layers.sum(request.weights);
    let bytes: Vec<u8> = display(&picture, shown).into_iter().flatten().collect();
    image::save_buffer_with_format(
        &request.path,
        &bytes,
        picture.width,
        picture.height,
        image::ColorType::Rgba8,
        image::ImageFormat::Png,
    )
    .with_context(|| format!("{}: the picture cannot be written", request.path.display()))
}
