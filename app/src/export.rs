//! Pictures, layers and panoramas as files.

use crate::{
    cli::wall,
    worker::{ExportRequest, Exported},
};
use anyhow::Result;
use lumenscope_core::{
    io::{exr, png},
    math::{image::LinearImage, progress::Progress},
    scene::Scene,
    superposition::{
        PassSettings,
        accumulator::Accumulator,
        composite::{DirectQuality, Display, display},
        layers::Layer,
        panorama::panorama,
        render,
    },
    transport::LightTransportSolution,
};
use std::sync::Arc;

/// Frames averaged: each looks through another place in the pixels, so that edges are smooth.
const FRAMES: u32 = 8;

/// Height of a panorama in pixels, and rays along each edge of one.
const PANORAMA: (u32, u32) = (512, 2);

/// Writes what was asked for.
///
/// # Errors
/// With the file's name, if it cannot be written; [`Cancelled`](lumenscope_core::math::progress::Cancelled).
pub fn write(request: &ExportRequest, progress: &Progress) -> Result<()> {
    if let Exported::Panorama(at) = request.what {
        let image = panorama(&request.solution, at, PANORAMA.0, PANORAMA.1, progress)?;
        return crate::cli::panorama::write(&request.path, &image, at);
    }
    progress.begin("picture");
    if let Exported::Wall(shown) = &request.what {
        let scene = Arc::new(Scene { camera: request.camera, ..(*request.solution.scene).clone() });
        let solution = LightTransportSolution { scene, ..(*request.solution).clone() };
        let (picture, _) = wall::draw(&wall::Options::beside(&solution, request.size), &solution, 1)?;
        return write_png(request, &picture, shown);
    }
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
    match &request.what {
        Exported::Picture(shown) | Exported::Wall(shown) => {
            write_png(request, &layers.sum(request.weights), shown)
        }
        Exported::Layers | Exported::Panorama(_) => {
            let named: Vec<_> = Layer::ALL.iter().map(|&l| (l.name(), layers.get(l))).collect();
            let note = format!("{}: radiance by layer, cd/m²", request.solution.scene.name);
            Ok(exr::write_layers(&request.path, &named, &note)?)
        }
    }
}

fn write_png(request: &ExportRequest, picture: &LinearImage, shown: &Display) -> Result<()> {
    let pixels = display(picture, shown);
    Ok(png::write_png(&request.path, picture.width, picture.height, &pixels)?)
}
