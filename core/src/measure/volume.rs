//! Error of the irradiance volume against the path tracer, setting by setting.

use super::{
    MeasureError,
    irradiance::{ErrorStatistics, relative_errors},
};
use crate::{
    irradiance_volume::{IrradianceVolume, SurfaceLight, VolumeError, VolumeSettings},
    math::{
        frame::uniform_direction,
        part::Part,
        progress::{Cancelled, Progress},
        random::Rng,
        sphere_map::DirectionBins,
    },
    reference::{irradiance::irradiance_with, path::PathTracer},
    scene::{
        accel::Ray,
        direct::{Receiver, total_irradiance},
        world::World,
    },
};
use glam::Vec3;
use rayon::prelude::*;
use std::{
    sync::atomic::{AtomicUsize, Ordering},
    time::Instant,
};

/// Points in the air with directions, and the light there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferencePoints {
    /// Where, and which way a surface there faces.
    pub receivers: Vec<Receiver>,
    /// Direct irradiance, a closed form times visibility, lx per channel.
    pub direct: Vec<Vec3>,
    /// Indirect irradiance by path tracing, lx per channel.
    pub indirect: Vec<Vec3>,
    /// Standard error of `indirect`, lx per channel.
    pub standard_error: Vec<Vec3>,
}

/// Shadow rays a luminous surface and point of the direct light that errors are measured with.
const DIRECT_RAYS: u32 = 64;

/// Points tried for each that is wanted, before a scene counts as having no open air.
const MOST_TRIES: usize = 1000;

/// Points uniform in a scene's bounds, none of whose 288 rays meets the back of a surface, with directions
/// uniform on the sphere; fewer than `count` where a scene has hardly any open air.
pub fn points_in_the_air(world: &World, count: usize, seed: u64) -> Vec<Receiver> {
    let bins = DirectionBins::new(12);
    let (low, high) = world.geometry.bounds();
    let open = |p: Vec3| {
        (0..bins.len()).all(|b| {
            let direction = bins.centre(b);
            world.accel.trace(&Ray::new(p, direction)).is_none_or(|hit| {
                let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
                world.geometry.is_lit(&surface)
            })
        })
    };
    (0..count.saturating_mul(MOST_TRIES) as u64)
        .map(|i| {
            let mut rng = Rng::new(seed, i);
            let at = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            Receiver::new(low + (high - low) * at, uniform_direction(rng.next_vec2()))
        })
        .filter(|r| open(r.position))
        .take(count)
        .collect()
}

impl ReferencePoints {
    /// Traces `paths` paths from every receiver.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn trace(
        world: &World,
        receivers: Vec<Receiver>,
        paths: u32,
        seed: u64,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        progress.begin("reference points");
        let tracer = PathTracer::new(world);
        let done = AtomicUsize::new(0);
        let rows: Vec<[Vec3; 3]> = receivers
            .par_iter()
            .enumerate()
            .map(|(i, r)| {
                let item = seed.wrapping_add(i as u64);
                let indirect = irradiance_with(&tracer, r, Part::Indirect, paths, item);
                let count = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress.report(count as f32 / receivers.len() as f32)?;
                let direct = total_irradiance(world, r, DIRECT_RAYS, item as u32);
                Ok([direct, indirect.mean, indirect.standard_error])
            })
            .collect::<Result<_, Cancelled>>()?;
        let column = |i: usize| rows.iter().map(|r| r[i]).collect();
        Ok(Self { direct: column(0), indirect: column(1), standard_error: column(2), receivers })
    }

    /// Indirect light that is known already, with its standard error, lx per channel; direct light is added.
    ///
    /// # Panics
    /// If there is not one value a receiver.
    pub fn with_indirect(
        world: &World,
        receivers: Vec<Receiver>,
        indirect: Vec<Vec3>,
        standard_error: Vec<Vec3>,
    ) -> Self {
        let count = receivers.len();
        assert!(indirect.len() == count && standard_error.len() == count, "one value a receiver");
        let direct =
            receivers.par_iter().enumerate().map(|(i, r)| total_irradiance(world, r, DIRECT_RAYS, i as u32));
        Self { direct: direct.collect(), receivers, indirect, standard_error }
    }

    /// All the light, lx per channel.
    pub fn total(&self) -> Vec<Vec3> {
        self.direct.iter().zip(&self.indirect).map(|(d, i)| *d + *i).collect()
    }

    /// Median standard error over max(E, 5 % of its mean), by the same rule as errors.
    ///
    /// # Errors
    /// [`MeasureError`] without points or with values that are not finite.
    pub fn median_noise(&self) -> Result<f64, MeasureError> {
        let total = self.total();
        let off: Vec<Vec3> = total.iter().zip(&self.standard_error).map(|(t, e)| *t + *e).collect();
        Ok(relative_errors(&off, &total)?.median)
    }
}

/// One setting of the volume, and how far it is off.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct VolumeRow {
    /// Rows of bins a hemisphere.
    pub bins_n: u32,
    /// First-level samples an axis.
    pub first_level: [u32; 3],
    /// Samples over both levels.
    pub samples: usize,
    /// Cube root of the volume of the grid a sample: the mean distance of samples, m.
    pub spacing_m: f32,
    /// Time to build it, s.
    pub build_seconds: f64,
    /// Bytes of one part in bins.
    pub bytes: usize,
    /// Indirect light from the bins, direct light exact.
    pub bins: ErrorStatistics,
    /// Indirect light from nine harmonics, direct light exact.
    pub harmonics: ErrorStatistics,
    /// Both parts from the bins.
    pub interpolated: ErrorStatistics,
}

/// Why there is no row.
#[derive(Debug, thiserror::Error)]
pub enum VolumeRowError {
    /// The volume failed.
    #[error(transparent)]
    Volume(#[from] VolumeError),
    /// The errors could not be measured.
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

/// Builds a volume and measures it.
///
/// # Errors
/// [`VolumeRowError`].
pub fn volume_row(
    world: &World,
    light: &impl SurfaceLight,
    settings: &VolumeSettings,
    points: &ReferencePoints,
    progress: &Progress,
) -> Result<VolumeRow, VolumeRowError> {
    let start = Instant::now();
    let volume = IrradianceVolume::build(world, light, settings, progress)?;
    let build_seconds = start.elapsed().as_secs_f64();
    let total = points.total();
    let errors = |of: &dyn Fn(&Receiver) -> Vec3, exact_direct: bool| {
        let found: Vec<Vec3> = points
            .receivers
            .iter()
            .zip(&points.direct)
            .map(|(r, d)| of(r) + if exact_direct { *d } else { Vec3::ZERO })
            .collect();
        relative_errors(&found, &total)
    };
    let (low, high) = volume.grid().bounds();
    let samples = volume.samples().len();
    Ok(VolumeRow {
        bins_n: settings.bins_n,
        first_level: (volume.grid().size() + glam::UVec3::ONE).to_array(),
        samples,
        spacing_m: ((high - low).element_product() / samples as f32).cbrt(),
        build_seconds,
        bytes: volume.table_bytes(),
        bins: errors(&|r| volume.irradiance_bins(r.position, r.normal, Part::Indirect), true)?,
        harmonics: errors(&|r| volume.irradiance_harmonics(r.position, r.normal, Part::Indirect), true)?,
        interpolated: errors(&|r| volume.irradiance_bins(r.position, r.normal, Part::All), false)?,
    })
}

/// Exponent p of the power law y = c xᵖ that fits best: least squares of log y over log x. NaN for fewer
/// than two different x; points that are not positive are passed over.
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> =
        points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let (mx, my) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / count, b + y / count));
    let (top, bottom) = logs
        .iter()
        .fold((0.0, 0.0), |(top, bottom), (x, y)| (top + (x - mx) * (y - my), bottom + (x - mx) * (x - mx)));
    top / bottom
}
