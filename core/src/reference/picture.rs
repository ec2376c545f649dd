//! The reference picture: it gains samples as long as it is asked to, and knows its own variance.
//!
//! Box filter, jittered in the pixel. Sample s of pixel p draws its numbers from (seed, p, s), and a
//! pixel's samples are summed in order in `f64`: the bytes depend neither on the number of threads
//! nor on how the samples were spread over calls.

use super::{
    expression::Expression,
    path::{PathTracer, Terms},
    stream_seed,
};
use crate::{
    math::{
        colour::luminance,
        image::LinearImage,
        progress::{Cancelled, Progress},
        random::Rng,
    },
    scene::{accel::Ray, camera::Camera, world::World},
};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

/// Samples a pixel gets before the work so far is kept and a cancellation is heeded for good.
const PASS: u32 = 4;

/// A path-traced picture that is refined step by step.
#[derive(Clone)]
pub struct ReferencePicture {
    world: Arc<World>,
    camera: Camera,
    width: u32,
    height: u32,
    seed: u64,
    samples: u32,
    rejected: u64,
    vertices: u64,
    pixels: Vec<PixelSums>,
    paths: Option<Expression>,
}

/// Sums over the samples of one pixel.
#[derive(Clone, Copy, Debug, Default)]
struct PixelSums {
    /// Radiance of each term, cd/m².
    terms: [DVec3; 5],
    /// Square of the total radiance.
    squares: DVec3,
    /// Square of the total luminance.
    luminance_squares: f64,
}

impl PixelSums {
    fn total(&self) -> DVec3 {
        self.terms.iter().sum()
    }
}

impl ReferencePicture {
    /// A picture without samples yet.
    pub fn new(world: Arc<World>, camera: Camera, width: u32, height: u32, seed: u64) -> Self {
        let pixels = vec![PixelSums::default(); width as usize * height as usize];
        Self { world, camera, width, height, seed, samples: 0, rejected: 0, vertices: 0, pixels, paths: None }
    }

    /// The same picture, of the paths of an expression only; all of it is in the first of
    /// [`layers`](Self::layers).
    pub fn of_paths(self, paths: Expression) -> Self {
        Self { paths: Some(paths), ..self }
    }

    /// Adds `spp` samples to every pixel.
    ///
    /// # Errors
    /// [`Cancelled`] when the watcher asked to stop; whole passes done by then are kept, and the
    /// picture stays even: every pixel has [`samples`](Self::samples) samples.
    pub fn add_samples(&mut self, spp: u32, progress: &Progress) -> Result<(), Cancelled> {
        progress.begin("reference picture");
        if self.pixels.is_empty() {
            self.samples += spp;
            return Ok(());
        }
        let rows_done = AtomicU64::new(0);
        let rows_total = u64::from(self.height) * u64::from(spp.div_ceil(PASS));
        let mut left = spp;
        while left > 0 {
            let count = left.min(PASS);
            let tracer = PathTracer::new(&self.world);
            let rows: Vec<Row> = self
                .pixels
                .par_chunks(self.width as usize)
                .enumerate()
                .map(|(y, row)| {
                    let row = self.row(&tracer, y as u32, row, count);
                    let done = rows_done.fetch_add(1, Ordering::Relaxed) + 1;
                    progress.report(done as f32 / rows_total as f32)?;
                    Ok(row)
                })
                .collect::<Result<_, Cancelled>>()?;
            for (target, row) in self.pixels.chunks_mut(self.width as usize).zip(rows) {
                target.copy_from_slice(&row.pixels);
                self.rejected += row.rejected;
                self.vertices += row.vertices;
            }
            self.samples += count;
            left -= count;
        }
        Ok(())
    }

    /// One row with `count` more samples a pixel.
    fn row(&self, tracer: &PathTracer<'_>, y: u32, sums: &[PixelSums], count: u32) -> Row {
        let mut row = Row { pixels: sums.to_vec(), rejected: 0, vertices: 0 };
        let size = Vec2::new(self.width as f32, self.height as f32);
        for (x, sums) in row.pixels.iter_mut().enumerate() {
            let pixel = u64::from(y) * u64::from(self.width) + x as u64;
            let stream = stream_seed(self.seed, pixel);
            for s in self.samples..self.samples + count {
                let mut rng = Rng::new(stream_seed(stream, u64::from(s)), pixel);
                let uv = (Vec2::new(x as f32, y as f32) + rng.next_vec2()) / size;
                let ray = Ray::new(self.camera.eye, self.camera.ray_direction(uv, size.x / size.y));
                let terms = match &self.paths {
                    None => tracer.radiance(&ray, &mut rng),
                    Some(paths) => {
                        Terms { emitted: tracer.radiance_by(&ray, paths, &mut rng), ..Terms::default() }
                    }
                };
                row.vertices += u64::from(terms.vertices);
                let total: Vec3 = terms.all().iter().sum();
                if !total.is_finite() {
                    row.rejected += 1;
                    continue;
                }
                for (sum, term) in sums.terms.iter_mut().zip(terms.all()) {
                    *sum += term.as_dvec3();
                }
                sums.squares += total.as_dvec3() * total.as_dvec3();
                sums.luminance_squares += f64::from(luminance(total)).powi(2);
            }
        }
        row
    }

    /// The picture, cd/m² per channel.
    pub fn mean(&self) -> LinearImage {
        self.image(|p, n| p.total() / n)
    }

    /// Emitted, direct, indirect, mirrored and glossy radiance, cd/m² per channel; they sum to
    /// [`mean`](Self::mean).
    pub fn layers(&self) -> [LinearImage; 5] {
        std::array::from_fn(|i| self.image(|p, n| p.terms[i] / n))
    }

    /// Variance of each pixel's mean, (cd/m²)² per channel; infinite below two samples.
    pub fn variance_of_mean(&self) -> LinearImage {
        let spread = self.samples >= 2;
        self.image(|p, n| {
            if !spread {
                return DVec3::INFINITY;
            }
            let total = p.total();
            (p.squares - total * total / n).max(DVec3::ZERO) / (n * (n - 1.0))
        })
    }

    /// Variance of the mean luminance of each pixel, (cd/m²)², row-major; infinite below two samples.
    pub fn luminance_variance_of_mean(&self) -> Vec<f32> {
        let n = f64::from(self.samples);
        let variance = |p: &PixelSums| {
            let total = p.total().dot(crate::math::colour::LUMINANCE_WEIGHTS.as_dvec3());
            ((p.luminance_squares - total * total / n).max(0.0) / (n * (n - 1.0))) as f32
        };
        self.pixels.iter().map(|p| if self.samples < 2 { f32::INFINITY } else { variance(p) }).collect()
    }

    /// Samples every pixel has.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Samples that were not finite and count as black; anything but 0 deserves a warning.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Surface points at which light was gathered so far.
    pub fn path_vertices(&self) -> u64 {
        self.vertices
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The camera it is seen from.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    fn image(&self, value: impl Fn(&PixelSums, f64) -> DVec3) -> LinearImage {
        let n = f64::from(self.samples.max(1));
        let pixels = self.pixels.iter().map(|p| value(p, n).as_vec3()).collect();
        LinearImage { width: self.width, height: self.height, pixels }
    }
}

struct Row {
    pixels: Vec<PixelSums>,
    rejected: u64,
    vertices: u64,
}
