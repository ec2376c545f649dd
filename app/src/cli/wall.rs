//! `wall`: a generated cinder-block wall put into a solved scene, streamed by and lit from the volume.

use super::{
    Common, parse_point, parse_size,
    render::{Backend, auto_display, peak_bytes, picture, write_png},
    solve,
};
use anyhow::{Context, bail};
use clap::Args;
use glam::Vec3;
use lumenscope_core::{
    math::image::LinearImage,
    superposition::{
        gbuffer::GBuffer,
        pass::PassSettings,
        streamed::{StreamedPicture, Strip},
    },
    transport::LightTransportSolution,
};
use lumenscope_scenes::wall::Wall;
use std::{path::PathBuf, time::Instant};

/// Options of `wall`.
#[derive(Args)]
pub struct Options {
    /// Scene file; the light is solved without the wall.
    scene: PathBuf,
    /// Folder for `wall.png` and `wall.json`.
    #[arg(long)]
    out: PathBuf,
    /// Triangles at least.
    #[arg(long, default_value_t = 612_000, value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
    polygons: u32,
    /// Lower left corner of the wall seen from its front, m; by default before the office's left wall.
    #[arg(long, value_parser = parse_point, default_value = "-3.985,0,3", allow_hyphen_values = true)]
    corner: Vec3,
    /// Its edge along the courses, m.
    #[arg(long, value_parser = parse_point, default_value = "0,0,-6", allow_hyphen_values = true)]
    edge_u: Vec3,
    /// Its edge upwards, m; the front looks along `edge_u × edge_v`.
    #[arg(long, value_parser = parse_point, default_value = "0,2.8,0", allow_hyphen_values = true)]
    edge_v: Vec3,
    /// Diffuse reflectance, one number for all channels.
    #[arg(long, default_value_t = 0.55)]
    reflectance: f32,
    /// Rows of quadrilaterals held at a time.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    rows: u32,
    /// Shadow rays an area emitter and pixel for the wall's direct light; 0 takes it from the volume too.
    #[arg(long, default_value_t = 16)]
    shadow_rays: u32,
    /// Picture size.
    #[arg(long, default_value = "960x540", value_parser = parse_size)]
    size: [u32; 2],
    /// Where the eye is, m; the scene's camera by default.
    #[arg(long, value_parser = parse_point, allow_hyphen_values = true)]
    eye: Option<Vec3>,
    /// What it looks at, m.
    #[arg(long, value_parser = parse_point, allow_hyphen_values = true)]
    target: Option<Vec3>,
}

/// Solves, streams the wall, writes the picture, prints what it took.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    if options.edge_u.cross(options.edge_v).length() < 1e-6 {
        bail!("the wall's edges {} and {} span no area", options.edge_u, options.edge_v);
    }
    if !(0.0..1.0).contains(&options.reflectance) {
        bail!("--reflectance {} must lie between 0 and 1", options.reflectance);
    }
    solve::output_folder(&options.out)?;
    let mut loaded = solve::load(&options.scene, common)?;
    let scene = std::sync::Arc::make_mut(&mut loaded.scene);
    scene.camera.eye = options.eye.unwrap_or(scene.camera.eye);
    scene.camera.target = options.target.unwrap_or(scene.camera.target);
    let solution = solve::solve(&loaded, true)?;
    let (shown, report) = draw(options, &solution, common.seed)?;
    write_png(&options.out.join("wall.png"), &shown, &auto_display(&shown))?;
    let report = serde_json::to_string_pretty(&report)?;
    solve::write(&options.out.join("wall.json"), &report)?;
    println!("{report}");
    Ok(())
}

/// The picture of a solution with the wall in it, and what it took.
///
/// # Errors
/// Where there is no volume to light the wall.
pub fn draw(
    options: &Options,
    solution: &LightTransportSolution,
    seed: u64,
) -> anyhow::Result<(LinearImage, serde_json::Value)> {
    let camera = solution.scene.camera;
    let volume = solution.volume.as_deref().context("the plan built no volume")?;
    let [width, height] = options.size;
    let (layers, _) = picture(solution, options.size, 8, Backend::Cpu, seed)?;
    let mut shown = layers.total();
    let size = glam::UVec2::new(width, height);
    let buffer = GBuffer::new(&solution.world, &camera, size, PassSettings::default().subpixel());
    let before = peak_bytes();

    let (u, v) = (options.edge_u.as_dvec3(), options.edge_v.as_dvec3());
    let wall = Wall::new(options.corner.as_dvec3(), u, v, options.polygons);
    let mut streamed = StreamedPicture::new(&buffer, &camera, volume, Vec3::splat(options.reflectance));
    let start = Instant::now();
    for strip in wall.strips(options.rows) {
        streamed.draw(&Strip {
            positions: &strip.positions,
            normals: &strip.normals,
            triangles: &strip.triangles,
        });
    }
    let streaming = start.elapsed();
    let start = Instant::now();
    streamed.composite(&mut shown, &solution.world, options.shadow_rays);
    let direct = start.elapsed();
    let counts = streamed.counts();
    let report = serde_json::json!({
        "scene": options.scene,
        "polygons": counts.polygons,
        "vertices": counts.vertices,
        "threads": rayon::current_num_threads(),
        "shading_seconds": counts.shading.as_secs_f64(),
        "drawing_seconds": counts.drawing.as_secs_f64(),
        "generating_seconds": (streaming - counts.shading - counts.drawing).as_secs_f64(),
        "direct_light_seconds": direct.as_secs_f64(),
        "pixels": streamed.pixels(),
        "peak_bytes_before": before,
        "peak_bytes": peak_bytes(),
    });
    Ok((shown, report))
}

impl Options {
    /// A wall of the default make along the left side of a scene, as high as that is.
    pub fn beside(solution: &LightTransportSolution, size: [u32; 2]) -> Self {
        let (low, high) = solution.world.geometry.bounds();
        let clearance = 0.002 * (high - low).x;
        Self {
            scene: PathBuf::from(&solution.scene.name),
            out: PathBuf::new(),
            polygons: 612_000,
            corner: Vec3::new(low.x + clearance, low.y, high.z),
            edge_u: Vec3::NEG_Z * (high - low).z,
            edge_v: Vec3::Y * (high - low).y,
            reflectance: 0.55,
            rows: 8,
            shadow_rays: 16,
            size,
            eye: None,
            target: None,
        }
    }
}
