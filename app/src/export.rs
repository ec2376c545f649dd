//! What can be written to a file, and how: pictures, layers, spheres and panoramas.

use crate::{lightmaps::coordinates, wall::WallSettings, widgets::Probe};
use anyhow::{Context as _, Result};
use glam::Vec3;
use lumenscope_core::{
    io::{exr, panorama as files, png, probe::write_probe},
    irradiance_volume::moments::{Order, beside_irradiance},
    math::progress::Progress,
    radiosity::texels::{self, Coverage},
    scene::camera::Camera,
    superposition::{
        PassSettings,
        composite::{DirectQuality, Display, display},
        layers::{Layer, Layers, Weights},
        mean_of_frames,
        panorama::panorama,
    },
    transport::LightTransportSolution,
};
use std::{path::PathBuf, sync::Arc};

/// What a file can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Export {
    /// The picture as it is shown, as PNG.
    Picture,
    /// The picture with a cinder-block wall streamed into it, as PNG.
    Wall,
    /// Its layers, as multi-layer EXR.
    Layers,
    /// Our irradiance as a lightmap over the scene's texture coordinates, as EXR.
    Lightmap,
    /// The open spheres, as EXR.
    Spheres,
    /// The radiance that arrives where they are from all around, as a latitude–longitude EXR.
    Panorama,
}

impl Export {
    /// What the file dialog asks for.
    pub fn title(self) -> &'static str {
        match self {
            Self::Picture => "Export the picture",
            Self::Wall => "Export the picture with a wall",
            Self::Layers => "Export the layers",
            Self::Lightmap => "Bake a lightmap",
            Self::Spheres => "Export the spheres",
            Self::Panorama => "Export a panorama",
        }
    }

    /// The name a file is given unless the user says otherwise.
    pub fn file_name(self, scene: &str) -> String {
        let extension = self.format().1;
        match self {
            Self::Picture | Self::Layers => format!("{scene}.{extension}"),
            Self::Wall => format!("{scene}-wall.{extension}"),
            Self::Lightmap => format!("{scene}-lightmap.{extension}"),
            Self::Spheres => format!("{scene}-spheres.{extension}"),
            Self::Panorama => format!("{scene}-panorama.{extension}"),
        }
    }

    /// Name of the format, and its files' extension.
    pub fn format(self) -> (&'static str, &'static str) {
        match self {
            Self::Picture | Self::Wall => ("PNG", "png"),
            Self::Layers | Self::Lightmap | Self::Spheres | Self::Panorama => ("OpenEXR", "exr"),
        }
    }
}

/// A file to write.
#[derive(Clone)]
pub struct ExportRequest {
    /// What is written.
    pub what: Export,
    /// Where.
    pub path: PathBuf,
    /// What is shown.
    pub solution: Arc<LightTransportSolution>,
    /// Camera.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Weight of each layer.
    pub weights: Weights,
    /// From radiance to the display.
    pub display: Display,
    /// Shadow rays a pixel and area emitter.
    pub shadow_rays: u32,
    /// The open spheres.
    pub probe: Option<Arc<Probe>>,
    /// Orders of the moments that are shown of them.
    pub orders: Vec<Order>,
    /// Where they are, m; they may be on their way.
    pub at: Option<Vec3>,
}

/// Why what shows the light at a point cannot be written.
const NO_SPHERES: &str = "no spheres are open: click a point in the scene first";

/// Frames averaged: each looks through another place in the pixels, so that edges are smooth.
const FRAMES: u32 = 8;

/// Height of a panorama in pixels, and rays along each edge of one.
const PANORAMA: (u32, u32) = (512, 2);

/// Texels along each edge of a lightmap, and around each chart that repeat its border.
const LIGHTMAP: (u32, u32) = (1024, 4);

/// Writes what was asked for.
///
/// # Errors
/// With the file's name, if it cannot be written; [`Cancelled`](lumenscope_core::math::progress::Cancelled).
pub fn write(request: &ExportRequest, progress: &Progress) -> Result<()> {
    let solution = &request.solution;
    match request.what {
        Export::Spheres => {
            let probe = request.probe.as_deref().context(NO_SPHERES)?;
            Ok(write_probe(&request.path, probe, &beside_irradiance(&request.orders), true)?)
        }
        Export::Panorama => {
            let at = request.at.context(NO_SPHERES)?;
            let image = panorama(solution, at, PANORAMA.0, PANORAMA.1, progress)?;
            Ok(files::write(&request.path, &image, at)?)
        }
        Export::Lightmap => {
            let (side, padding) = LIGHTMAP;
            let world = &solution.world;
            let coverage = Coverage::new(world, &coordinates(world), [side; 2])
                .context("nothing to bake onto (`lumenscope bake --atlas` packs coordinates of its own)")?;
            let map = texels::bake(world, &solution.radiosity, &coverage, padding, progress)?;
            Ok(exr::write_layers(&request.path, &[("", &map)], "irradiance, lx")?)
        }
        Export::Picture => write_png(request, &layers(request, progress)?),
        Export::Wall => {
            let mut layers = layers(request, progress)?;
            let wall = WallSettings { shadow_rays: request.shadow_rays, ..WallSettings::beside(solution) };
            wall.draw(solution, &request.camera, &mut layers, progress)?;
            write_png(request, &layers)
        }
        Export::Layers => {
            let layers = layers(request, progress)?;
            let named: Vec<_> = Layer::ALL.iter().map(|&l| (l.name(), layers.get(l))).collect();
            let note = format!("{}: radiance by layer, cd/m²", solution.scene.name);
            Ok(exr::write_layers(&request.path, &named, &note)?)
        }
    }
}

fn layers(request: &ExportRequest, progress: &Progress) -> Result<Layers> {
    let direct = match request.shadow_rays {
        0 => DirectQuality::Elements,
        rays => DirectQuality::PerPixel(rays.div_ceil(FRAMES)),
    };
    let settings = PassSettings { direct, ..PassSettings::default() };
    Ok(mean_of_frames(
        &request.solution.reconstructed(),
        &request.camera,
        request.size,
        FRAMES,
        &settings,
        progress,
    )?)
}

fn write_png(request: &ExportRequest, layers: &Layers) -> Result<()> {
    let picture = layers.sum(request.weights);
    let pixels = display(&picture, &request.display);
    Ok(png::write_png(&request.path, picture.width, picture.height, &pixels)?)
}
