//! `bake`: our irradiance as a lightmap.

use super::{Common, parse_size, solve};
use crate::lightmaps::coordinates;
use anyhow::{Context, bail};
use clap::Args;
use glam::Vec2;
use lumenscope_core::{
    io::exr,
    math::part::Part,
    radiosity::{
        atlas,
        texels::{self, Coverage},
    },
    scene::{geometry::Geometry, world::World},
};
use std::{fmt::Write as _, path::PathBuf};

/// Largest width and height.
const MOST_TEXELS: u32 = 8192;

/// Options of `bake`.
#[derive(Args)]
pub struct Options {
    /// Scene, with texture coordinates for lightmaps: the second set of a glTF file, or the first of any.
    scene: PathBuf,
    /// `.exr` to write: irradiance of the fronts, lx.
    #[arg(long)]
    out: PathBuf,
    /// Columns and rows.
    #[arg(long, default_value = "1024x1024", value_parser = parse_size)]
    size: [u32; 2],
    /// Texels around each chart that repeat its border.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=64))]
    padding: u32,
    /// `.obj` to write: the scene with coordinates packed here, a texel a node of flat regions and a small chart a triangle that is curved or small; `lightmap --coordinates` reads it.
    #[arg(long, conflicts_with = "size")]
    atlas: Option<PathBuf>,
}

/// Solves, bakes and writes.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    if let Some(side) = options.size.into_iter().find(|s| *s > MOST_TEXELS) {
        bail!("--size: {side} is more than {MOST_TEXELS} texels");
    }
    let loaded = solve::load(&options.scene, common)?;
    let map = match &options.atlas {
        None => {
            // What cannot be baked onto is told before anything is solved.
            let world = World::new(&loaded.scene);
            let coverage = Coverage::new(&world, &coordinates(&world), options.size).with_context(|| {
                format!("{} (--atlas packs coordinates of its own)", options.scene.display())
            })?;
            let radiosity = &solve::solve(&loaded, false)?.radiosity;
            solve::watched(|p| texels::bake(&world, radiosity, &coverage, options.padding, p))?
        }
        Some(path) => {
            let solution = solve::solve(&loaded, false)?;
            let geometry = &solution.world.geometry;
            let (map, uvs) = atlas::bake(geometry, &solution.radiosity, Part::All, options.padding);
            solve::write(path, &obj(geometry, &uvs))?;
            let mapped = uvs.iter().flatten().count();
            println!("{}: {mapped} of {} triangles have coordinates", path.display(), uvs.len());
            map
        }
    };
    exr::write_layers(&options.out, &[("", &map)], "irradiance, lx")?;
    println!("{}: {} × {} texels", options.out.display(), map.width, map.height);
    Ok(())
}

/// The triangles with their texture coordinates, v up, as Wavefront files have it; a triangle without any at the
/// map's corner, since a file has them for all or for none.
fn obj(geometry: &Geometry, uvs: &[Option<[Vec2; 3]>]) -> String {
    let mut text = String::new();
    for (t, uvs) in uvs.iter().enumerate() {
        // Writing to a string cannot fail.
        for p in geometry.positions[t] {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        for uv in uvs.unwrap_or_default() {
            let _ = writeln!(text, "vt {} {}", uv.x, 1.0 - uv.y);
        }
        let [a, b, c] = [1, 2, 3].map(|corner| 3 * t + corner);
        let _ = writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}");
    }
    text
}
