//! `wall`: a generated cinder-block wall put into a solved scene, streamed by and lit from the volume.

use super::{
    Common, parse_point, parse_size,
    render::{Backend, auto_display, peak_bytes, picture, write_png},
    solve,
};
use crate::wall::{POLYGONS, WallSettings};
use clap::Args;
use glam::Vec3;
use lumenscope_core::{math::image::LinearImage, transport::LightTransportSolution};
use std::path::PathBuf;

/// Options of `wall`.
#[derive(Args)]
pub struct Options {
    /// Scene file; the light is solved without the wall.
    scene: PathBuf,
    /// Folder for `wall.png` and `wall.json`.
    #[arg(long)]
    out: PathBuf,
    /// Triangles at least.
    #[arg(long, default_value_t = POLYGONS, value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
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

impl Options {
    fn wall(&self) -> WallSettings {
        WallSettings {
            polygons: self.polygons,
            corner: self.corner,
            edge_u: self.edge_u,
            edge_v: self.edge_v,
            reflectance: self.reflectance,
            rows: self.rows,
            shadow_rays: self.shadow_rays,
        }
    }
}

/// Solves, streams the wall, writes the picture, prints what it took.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    options.wall().check()?;
    solve::output_folder(&options.out)?;
    let mut loaded = solve::load(&options.scene, common)?;
    let scene = std::sync::Arc::make_mut(&mut loaded.scene);
    scene.camera.eye = options.eye.unwrap_or(scene.camera.eye);
    scene.camera.target = options.target.unwrap_or(scene.camera.target);
    let solution = solve::solve(&loaded, true)?;
    let (shown, mut report) = draw(&options.wall(), &solution, options.size, common.seed)?;
    write_png(&options.out.join("wall.png"), &shown, &auto_display(&shown))?;
    report["scene"] = serde_json::json!(options.scene);
    let report = serde_json::to_string_pretty(&report)?;
    solve::write(&options.out.join("wall.json"), &report)?;
    println!("{report}");
    Ok(())
}

/// The picture of a solution, seen by its scene's camera, with the wall in it, and what that took.
///
/// # Errors
/// Where there is no volume to light the wall, or it is none.
pub fn draw(
    wall: &WallSettings,
    solution: &LightTransportSolution,
    size: [u32; 2],
    seed: u64,
) -> anyhow::Result<(LinearImage, serde_json::Value)> {
    let (mut layers, _) = picture(solution, size, 8, Backend::Cpu, seed)?;
    let before = peak_bytes();
    let camera = &solution.scene.camera;
    let took = solve::watched(|progress| wall.draw(solution, camera, &mut layers, progress))?;
    let report = serde_json::json!({
        "polygons": took.counts.polygons,
        "vertices": took.counts.vertices,
        "threads": rayon::current_num_threads(),
        "shading_seconds": took.counts.shading.as_secs_f64(),
        "drawing_seconds": took.counts.drawing.as_secs_f64(),
        "generating_seconds": took.generating.as_secs_f64(),
        "direct_light_seconds": took.direct.as_secs_f64(),
        "pixels": took.pixels,
        "peak_bytes_before": before,
        "peak_bytes": peak_bytes(),
    });
    Ok((layers.total(), report))
}
