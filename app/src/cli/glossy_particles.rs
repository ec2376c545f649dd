//! Rows of `glossy` that are made of particles: in object space, not in the picture.

use anyhow::Result;
use lumenscope_core::{
    glossy::particles::{
        pass::{LEAST_SAMPLES, glossy_layer},
        splat::{SplatMap, SplatSettings},
        trace::Particles,
    },
    math::image::LinearImage,
    scene::{camera::Camera, world::World},
    superposition::{PassSettings, gbuffer::GBuffer},
};
use std::time::Instant;

/// What is wanted of particles.
pub struct Wanted<'a> {
    /// Numbers of particles, ascending: each goes on from the one before.
    pub counts: &'a [u32],
    /// C of Eq. 7.6.
    pub scale: f32,
    /// Picture size.
    pub size: [u32; 2],
    /// Frames averaged.
    pub frames: u32,
    /// Seed of every random number.
    pub seed: u64,
}

/// The glossy layer by so many particles.
pub struct Row {
    /// What it is called in the table.
    pub name: String,
    /// The layer, cd/m².
    pub picture: LinearImage,
    /// Milliseconds that one frame's sum takes.
    pub milliseconds: f64,
    /// Seconds that tracing and sorting took, all particles before included.
    pub build_seconds: f64,
}

/// Two rows for each number of particles: all light by particles, and straight light apart.
pub fn rows(world: &World, camera: &Camera, wanted: &Wanted) -> Result<Vec<Row>> {
    let mut particles = Particles::new(world, wanted.seed);
    let (mut rows, mut traced_seconds) = (Vec::new(), 0.0);
    for &count in wanted.counts {
        let start = Instant::now();
        super::solve::watched(|progress| particles.trace(world, count, progress))?;
        traced_seconds += start.elapsed().as_secs_f64();
        for (name, least_bounces) in [("particles", 0), ("indirect", 1)] {
            let start = Instant::now();
            let settings = SplatSettings { scale: wanted.scale, least_bounces, ..SplatSettings::default() };
            let map = SplatMap::new(world, &particles, &settings);
            let build_seconds = traced_seconds + start.elapsed().as_secs_f64();
            let apart = (least_bounces > 0).then_some(LEAST_SAMPLES);
            let (picture, milliseconds) = mean(world, camera, &map, apart, wanted);
            rows.push(Row { name: format!("{name} {count}"), picture, milliseconds, build_seconds });
        }
    }
    Ok(rows)
}

/// Mean of the frames, and milliseconds of one.
fn mean(
    world: &World,
    camera: &Camera,
    map: &SplatMap,
    straight: Option<u32>,
    wanted: &Wanted,
) -> (LinearImage, f64) {
    let mut sum = LinearImage::new(wanted.size[0], wanted.size[1]);
    let mut seconds = 0.0;
    for frame in 0..wanted.frames {
        let settings =
            PassSettings { frame, jitter: wanted.frames > 1, seed: wanted.seed, ..PassSettings::default() };
        let buffer = GBuffer::new(world, camera, wanted.size.into(), settings.subpixel());
        let start = Instant::now();
        let layer = glossy_layer(world, map, straight, &buffer, camera, &settings);
        seconds += start.elapsed().as_secs_f64();
        let share = 1.0 / wanted.frames as f32;
        sum.pixels.iter_mut().zip(&layer.pixels).for_each(|(sum, pixel)| *sum += *pixel * share);
    }
    (sum, 1e3 * seconds / f64::from(wanted.frames))
}
