//! Volumes whose radiance is given and not looked up on surfaces: from the path tracer, from pictures.
//!
//! They answer queries and are shown like any other. They cannot be relit: nothing says which surface
//! the light in a bin came from.

use super::{
    IrradianceVolume, Sample, Tables, VolumeError, VolumeSettings,
    cache::{Solver, spread},
    direct::Arrivals,
    directions::Directions,
    grid::BilevelGrid,
    ignored::Ignored,
    moments::{MomentKernel, beside_irradiance, light_moment},
    trust::Fills,
};
use crate::{
    math::{
        progress::Progress,
        random::{Rng, fold, hash2, r2_point},
        sphere_map::DirectionBins,
    },
    reference::path::PathTracer,
    scene::{accel::Ray, world::World},
};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::{
    Arc,
    atomic::{AtomicUsize, Ordering},
};

/// Shadow rays a luminous surface from each sample of a volume of the reference: its direct light should
/// err by less than what it is compared with.
const REFERENCE_DIRECT_SAMPLES: u32 = 256;

/// Radiance that comes to each sample from each bin, cd/m².
#[derive(Default)]
pub(super) struct Radiance {
    /// After at least one bounce.
    pub reflected: Vec<Vec<Vec3>>,
    /// Straight from emitters that are seen: what the moment of order ∞ shows of them.
    pub emitted: Vec<Vec<Vec3>>,
}

impl IrradianceVolume {
    /// The volume that another one approximates: at the same samples and in the same bins, what comes
    /// after a bounce by path tracing, `paths` through random points of each bin, and direct light by 256
    /// shadow rays a luminous surface. What it leaves out as a source of light is left out here not.
    ///
    /// # Errors
    /// [`VolumeError::Cancelled`]; [`VolumeError::Setting`] for no path or more than 65,536.
    pub fn of_reference(&self, world: &World, paths: u32, progress: &Progress) -> Result<Self, VolumeError> {
        if !(1..=65_536).contains(&paths) {
            return Err(VolumeError::Setting {
                name: "paths a bin",
                value: paths.to_string(),
                range: "1 to 65,536",
            });
        }
        progress.begin("reference volume");
        let (bins, seed) = (self.bins(), self.settings.seed);
        let tracer = PathTracer::new(world);
        let done = AtomicUsize::new(0);
        let count = self.samples.len();
        let (reflected, emitted) = (0..count)
            .into_par_iter()
            .map(|s| {
                progress.report(0.95 * done.fetch_add(1, Ordering::Relaxed) as f32 / count as f32)?;
                let mut radiance = [vec![Vec3::ZERO; bins.len()], vec![Vec3::ZERO; bins.len()]];
                for bin in 0..bins.len() {
                    let item = (s * bins.len() + bin) as u64;
                    let mut rng = Rng::new(seed ^ 0x0F0E_D5A3, item);
                    let scramble = hash2(item as u32, fold(seed) ^ (item >> 32) as u32);
                    for k in 0..paths {
                        let direction = bins.direction(bin, r2_point(k, scramble));
                        let ray = Ray::new(self.samples[s].position, direction);
                        let found = tracer.radiance(&ray, &mut rng);
                        for (sum, value) in radiance.iter_mut().zip([found.reflected(), found.emitted]) {
                            sum[bin] += if value.is_finite() { value / paths as f32 } else { Vec3::ZERO };
                        }
                    }
                }
                let [reflected, emitted] = radiance;
                Ok((reflected, emitted))
            })
            .collect::<Result<Vec<_>, VolumeError>>()?
            .into_iter()
            .unzip();
        let settings = VolumeSettings {
            direct_samples: self.settings.direct_samples.max(REFERENCE_DIRECT_SAMPLES),
            ignored: Ignored::default(),
            ..self.settings.clone()
        };
        let positions: Vec<Vec3> = self.samples.iter().map(|s| s.position).collect();
        let arrivals: Vec<Arc<Arrivals>> = world
            .emitters
            .list
            .iter()
            .map(|e| Arc::new(Arrivals::gather(world, e, &positions, &settings)))
            .collect();
        progress.report(1.0)?;
        let guard = settings.guard.then_some(world);
        let radiance = Radiance { reflected, emitted };
        Ok(Self::given(settings, self.grid.clone(), self.samples.clone(), arrivals, &radiance)
            .with_guard(guard))
    }

    /// A volume of radiance that is given; dilated samples are filled from their neighbours whatever it says
    /// of them.
    pub(super) fn given(
        settings: VolumeSettings,
        grid: Arc<BilevelGrid>,
        samples: Arc<Vec<Sample>>,
        arrivals: Vec<Arc<Arrivals>>,
        radiance: &Radiance,
    ) -> Self {
        let (bins, count) = (DirectionBins::new(settings.bins_n), samples.len());
        let heard: Vec<&Arrivals> = arrivals.iter().map(|a| &**a).collect();
        let solver = Solver::new(bins);
        let fills = Fills::of(&grid, &samples);
        let mut direct = solver.direct(count, &heard, |_| None);
        let reflected = |s: usize, out: &mut [Vec3]| out.copy_from_slice(&radiance.reflected[s]);
        let emitted = |s: usize, out: &mut [Vec3]| {
            if let Some(emitted) = radiance.emitted.get(s) {
                out.copy_from_slice(emitted);
            }
        };
        let mut indirect = solver.indirect(count, |samples, out| {
            radiance.reflected[samples].iter().enumerate().for_each(|(lane, one)| spread(one, lane, out));
        });
        for table in [&mut direct, &mut indirect] {
            fills.apply(table, bins.len());
        }
        let mut tables = Tables::new(bins, Arc::new(direct), Arc::new(indirect));
        let moments = beside_irradiance(&settings.moments);
        let kernels: Vec<MomentKernel> = moments.iter().map(|o| MomentKernel::new(bins, *o)).collect();
        tables.moments = kernels
            .iter()
            .map(|k| light_moment(k, count, reflected, emitted, &heard).filled(&fills, bins))
            .collect();
        let settings = VolumeSettings { moments, ..settings };
        let ages = Arc::new(vec![0; count]);
        Self {
            settings,
            grid,
            samples,
            directions: Arc::new(Directions::new(bins)),
            transport: None,
            arrivals,
            kernels: Arc::new(kernels),
            fills: Arc::new(fills),
            guard: None,
            ages,
            tables,
        }
    }
}
