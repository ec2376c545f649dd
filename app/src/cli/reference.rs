//! `reference`: the path-traced picture.

use super::{Common, parse_size, solve};
use clap::Args;
use lumenscope_core::{
    io::exr,
    reference::{expression::Expression, picture::ReferencePicture},
    scene::world::World,
    superposition::layers::Layer,
};
use std::{path::PathBuf, sync::Arc};

/// Options of `reference`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// EXR to write: the picture, its layers and the variance of every pixel's mean.
    #[arg(long)]
    out: PathBuf,
    /// Paths a pixel.
    #[arg(long, default_value_t = 64)]
    spp: u32,
    /// Picture size.
    #[arg(long, default_value = "1280x720", value_parser = parse_size)]
    size: [u32; 2],
    /// Only the light of these paths, from the light L to the eye E by diffuse D and specular S reflections:
    /// LDE, "L(D|S)*SE", "LD{2}E".
    #[arg(long)]
    paths: Option<Expression>,
}

/// Renders and writes it.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let loaded = solve::load(&options.scene, common)?;
    let world = Arc::new(World::new(&loaded.scene));
    let mut picture =
        ReferencePicture::new(world, loaded.scene.camera, options.size[0], options.size[1], common.seed);
    if let Some(paths) = &options.paths {
        picture = picture.of_paths(paths.clone());
    }
    solve::watched(|progress| {
        progress.begin("reference");
        picture.add_samples(options.spp, progress)
    })?;
    let (mean, variance, layers) = (picture.mean(), picture.variance_of_mean(), picture.layers());
    let mut named = vec![("", &mean), ("variance", &variance)];
    if options.paths.is_none() {
        named.extend(Layer::ALL.iter().zip(&layers).map(|(l, image)| (l.name(), image)));
    }
    let paths = options.paths.as_ref().map_or(String::new(), |p| format!(", paths {p}"));
    let note = format!("path traced{paths}, {} paths a pixel, seed {}, cd/m2", options.spp, common.seed);
    exr::write_layers(&options.out, &named, &note)?;
    eprintln!("{}: {} paths a pixel", options.out.display(), options.spp);
    Ok(())
}
