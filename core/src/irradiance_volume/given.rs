//! Volumes whose radiance is given and not looked up on surfaces: from the path tracer, from pictures.
//!
//! They answer queries and are shown like any other. They cannot be relit: nothing says which surface
//! the light in a bin came from.

use super::{
    IrradianceVolume, Sample, Tables, VolumeError, VolumeSettings, cache::Solver, direct::Arrivals,
    directions::Directions, grid::BilevelGrid,
};
use crate::{
    math::{
        progress::Progress,
        random::{Rng, hash2, r2_point},
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
        let radiance: Vec<Vec<Vec3>> = (0..count)
            .into_par_iter()
            .map(|s| {
                progress.report(0.95 * done.fetch_add(1, Ordering::Relaxed) as f32 / count as f32)?;
                let mut radiance = vec![Vec3::ZERO; bins.len()];
                for (bin, radiance) in radiance.iter_mut().enumerate() {
                    let item = (s * bins.len() + bin) as u64;
                    let mut rng = Rng::new(seed ^ 0x0F0E_D5A3, item);
                    let scramble = hash2(item as u32, seed as u32 ^ (item >> 32) as u32);
                    for k in 0..paths {
                        let direction = bins.direction(bin, r2_point(k, scramble));
                        let ray = Ray::new(self.samples[s].position, direction);
                        let reflected = tracer.radiance(&ray, &mut rng).reflected();
                        *radiance += if reflected.is_finite() { reflected } else { Vec3::ZERO };
                    }
                    *radiance /= paths as f32;
                }
                Ok(radiance)
            })
            .collect::<Result<_, VolumeError>>()?;
        let settings = VolumeSettings {
            direct_samples: self.settings.direct_samples.max(REFERENCE_DIRECT_SAMPLES),
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
        Ok(Self::given(settings, self.grid.clone(), self.samples.clone(), arrivals, &radiance)
            .with_guard(guard))
    }

    /// A volume of radiance that is given, cd/m², one value a bin of every sample.
    pub(super) fn given(
        settings: VolumeSettings,
        grid: Arc<BilevelGrid>,
        samples: Arc<Vec<Sample>>,
        arrivals: Vec<Arc<Arrivals>>,
        radiance: &[Vec<Vec3>],
    ) -> Self {
        let bins = DirectionBins::new(settings.bins_n);
        let heard: Vec<&Arrivals> = arrivals.iter().map(|a| &**a).collect();
        let solver = Solver::new(bins);
        let direct = solver.direct(samples.len(), &heard, |_| None);
        let indirect = solver.indirect(samples.len(), |s, out| out.copy_from_slice(&radiance[s]));
        let tables = Tables::new(bins, Arc::new(direct), Arc::new(indirect));
        Self {
            settings,
            grid,
            samples,
            directions: Arc::new(Directions::new(bins)),
            transport: None,
            arrivals,
            kernels: Arc::default(),
            fills: Arc::default(),
            guard: None,
            relights: 0,
            tables,
        }
    }
}
