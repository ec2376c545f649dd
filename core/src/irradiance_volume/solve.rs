//! Building: rays from every sample into every bin, once; then light through them, as often as it changes.
//!
//! A ray's result is not a radiance but the number of the surface element it met. Radiance is that
//! element's B/π, so when the light changes nothing is traced again but the shadow rays of the emitters
//! that did. The radiosity B holds reflected light alone: what an emitter sends straight to the sample
//! comes from [`super::direct`], never from a bin.

use super::{
    IrradianceVolume, Sample, Tables, VolumeError, VolumeSettings, adaptive,
    cache::{Before, Met, Solver, Transport},
    codec::Texel,
    direct::{Arrivals, Asking},
    directions::Directions,
    ignored::Ignored,
    rays::{Patch, PointHits, Targets, trace_point},
    trust::{Fills, Repair, SampleState, relocated},
};
use crate::{
    math::{progress::Progress, sphere_map::DirectionBins},
    scene::{Target, world::World},
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::sync::{
    Arc,
    atomic::{AtomicUsize, Ordering},
};

/// What the volume asks of light on surfaces: a number for every place, and the radiosity there.
pub trait SurfaceLight: Sync {
    /// Element at barycentric weights of a triangle, on its front or back.
    fn element_at(&self, triangle: u32, barycentric: Vec2, back: bool) -> u32;

    /// Radiosity of every element, reflected light only, lx per channel.
    fn radiosity(&self) -> &[Vec3];

    /// Where an element lies, if it is flat; `None` keeps rays from being aimed at it.
    fn patch(&self, element: u32) -> Option<Patch> {
        let _ = element;
        None
    }
}

impl IrradianceVolume {
    /// Places the samples, traces their rays and lights them.
    ///
    /// # Errors
    /// [`VolumeError`] for settings out of range, bounds that are not finite, and cancellation.
    pub fn build(
        world: &World,
        light: &impl SurfaceLight,
        settings: &VolumeSettings,
        progress: &Progress,
    ) -> Result<Self, VolumeError> {
        progress.begin("irradiance volume");
        let mut grid = match settings.refine_tolerance {
            Some(tolerance) => adaptive::grid(world, light, settings, tolerance, progress)?,
            None => settings.grid(world)?,
        };
        settings.check_grid(&grid)?;
        let bins = DirectionBins::new(settings.bins_n);
        let targets = if settings.informed_rays > 0 { Targets::new(light) } else { Targets::default() };
        let done = AtomicUsize::new(0);
        let count = grid.places().len();
        let hits: Vec<PointHits> = grid
            .places()
            .par_iter()
            .enumerate()
            .map(|(i, place)| {
                progress.report(0.8 * done.fetch_add(1, Ordering::Relaxed) as f32 / count as f32)?;
                Ok(trace_point(world, light, bins, settings, &targets, place.position, i as u32))
            })
            .collect::<Result<_, VolumeError>>()?;
        let mut samples: Vec<Sample> = grid
            .places()
            .iter()
            .zip(&hits)
            .map(|(place, hit)| {
                let valid = hit.back_face_fraction <= settings.back_face_limit;
                let state = if valid { SampleState::Free } else { SampleState::Masked };
                let (position, level) = (place.position, place.level);
                Sample { position, level, back_face_fraction: hit.back_face_fraction, valid, state }
            })
            .collect();
        let mut hits = hits;
        if settings.repair == Repair::Relocate {
            let cell = 0.5 * grid.cell_size();
            let inner = grid.inner() as f32;
            samples.par_iter_mut().zip(&mut hits).enumerate().filter(|(_, (s, _))| !s.valid).for_each(
                |(i, (sample, hits))| {
                    let reach = if sample.level == 1 { cell } else { cell / inner };
                    let found = relocated(world, sample.position, reach, settings.back_face_limit);
                    let traced =
                        found.map(|p| (p, trace_point(world, light, bins, settings, &targets, p, i as u32)));
                    let free = |h: &PointHits| h.back_face_fraction <= settings.back_face_limit;
                    if let Some((position, found)) = traced.filter(|(_, h)| free(h)) {
                        let (valid, state) = (true, SampleState::Relocated);
                        let back_face_fraction = found.back_face_fraction;
                        *sample = Sample { position, valid, state, back_face_fraction, ..*sample };
                        *hits = found;
                    }
                },
            );
        }
        let mut fills = Fills::default();
        if settings.repair == Repair::Dilate {
            let (positions, valid): (Vec<_>, Vec<_>) = samples.iter().map(|s| (s.position, s.valid)).unzip();
            fills = Fills::plan(&grid, &positions, &valid);
            for s in fills.samples() {
                (samples[s as usize].valid, samples[s as usize].state) = (true, SampleState::Dilated);
            }
        }
        grid.set_valid(&samples.iter().map(|s| s.valid).collect::<Vec<_>>());

        let positions: Vec<Vec3> = samples.iter().map(|s| s.position).collect();
        let mut arrivals = Vec::with_capacity(world.emitters.len());
        for (i, emitter) in world.emitters.list.iter().enumerate() {
            arrivals.push(Arc::new(Arrivals::gather(world, emitter, &positions, settings)));
            progress.report(0.8 + 0.1 * (i + 1) as f32 / world.emitters.len() as f32)?;
        }
        let met = Met::new(bins, settings, hits);
        let transport = Arc::new(Transport { met, solver: Solver::new(bins) });
        let seen = transport.met.seen(world, light.radiosity(), &settings.ignored);
        let tables = transport.tables(&seen, &arrivals, &fills, None);
        let ages = Arc::new(vec![0; samples.len()]);
        let mut volume = Self {
            settings: settings.clone(),
            grid: Arc::new(grid),
            samples: Arc::new(samples),
            directions: Arc::new(Directions::new(bins)),
            transport: Some(transport),
            arrivals,
            kernels: Arc::default(),
            fills: Arc::new(fills),
            guard: None,
            ages,
            tables,
        };
        volume.add_pockets(world, light, &targets, progress)?;
        progress.report(1.0)?;
        Ok(volume.with_moments(&settings.moments, world, light).with_guard(settings.guard.then_some(world)))
    }

    /// The same samples under changed light; a new volume would also refine where a lamp now is. No radiance
    /// ray is traced: bins keep the elements they saw.
    ///
    /// Direct light is asked again of the emitters named by `changed`, or of all of them where something
    /// changed that does not emit, because it may shadow any. What a moved object reflected from where it
    /// was stays in the bins until the volume is built anew. A volume that came from a file keeps all its light.
    pub fn relight(&self, world: &World, light: &impl SurfaceLight, changed: &[Target]) -> Self {
        self.relight_moving(world, light, changed, &[])
    }

    /// As [`Self::relight`] while some emitters are being moved: those of the changed that are `moving` are
    /// asked by a quarter of the shadow rays, until [`Self::relight`] is told of them again.
    pub fn relight_moving(
        &self,
        world: &World,
        light: &impl SurfaceLight,
        changed: &[Target],
        moving: &[Target],
    ) -> Self {
        let Some(transport) = &self.transport else { return self.clone() };
        let emits = |t: &Target| world.emitters.list.iter().any(|e| e.target() == *t);
        let all = self.arrivals.len() != world.emitters.len() || !changed.iter().all(emits);
        let positions: Vec<Vec3> = self.samples.iter().map(|s| s.position).collect();
        let arrivals: Vec<Arc<Arrivals>> = world
            .emitters
            .list
            .iter()
            .enumerate()
            .map(|(i, emitter)| {
                let target = emitter.target();
                if all || changed.contains(&target) {
                    let as_set = if moving.contains(&target) { Asking::moving } else { Asking::at_rest };
                    Arc::new(Arrivals::gather_by(world, emitter, &positions, &as_set(&self.settings)))
                } else {
                    self.arrivals[i].clone()
                }
            })
            .collect();
        let seen = transport.met.seen(world, light.radiosity(), &self.settings.ignored);
        let before = Before { arrivals: &self.arrivals, direct: &self.tables.direct };
        let tables = transport.tables(&seen, &arrivals, &self.fills, Some(before));
        let ages = self.aged(&tables);
        Self { arrivals, tables, ages, ..self.clone() }.with_moments(&self.settings.moments, world, light)
    }

    /// Ages of the samples once they hold other light.
    fn aged(&self, tables: &Tables) -> Arc<Vec<u32>> {
        let bins = self.bins().len();
        let same = |a: &[Texel], b: &[Texel], s: usize| a[s * bins..][..bins] == b[s * bins..][..bins];
        let ages = self.ages.par_iter().enumerate().map(|(s, age)| {
            let kept = same(&self.tables.indirect, &tables.indirect, s)
                && (Arc::ptr_eq(&self.tables.direct, &tables.direct)
                    || same(&self.tables.direct, &tables.direct, s));
            if kept { *age } else { age + 1 }
        });
        Arc::new(ages.collect())
    }

    /// The same rays under other settings of queries: basis, guard, moments. `None` where any other setting
    /// differs, or where the volume came from a file.
    pub fn asked_otherwise(
        &self,
        settings: &VolumeSettings,
        world: &World,
        light: &impl SurfaceLight,
    ) -> Option<Self> {
        let VolumeSettings { basis, guard, ref moments, .. } = *settings;
        let alike = VolumeSettings { basis, guard, moments: moments.clone(), ..self.settings.clone() };
        let other_pockets = guard != self.settings.guard && settings.pocket_samples > 0;
        if alike != *settings || other_pockets || !self.can_relight() {
            return None;
        }
        let mut volume = self.with_basis(basis);
        if guard != self.settings.guard {
            volume = volume.with_guard(guard.then_some(world));
        }
        if *moments != self.settings.moments {
            volume = volume.with_moments(moments, world, light);
        }
        Some(volume)
    }

    /// The same volume without the light that comes straight from some surfaces and lamps (Greger 1996,
    /// §5.4), from what its rays met: nothing is traced. `None` in a volume that came from a file.
    pub fn ignoring(&self, world: &World, light: &impl SurfaceLight, ignored: Ignored) -> Option<Self> {
        let transport = self.transport.as_ref()?;
        let seen = transport.met.seen(world, light.radiosity(), &ignored);
        let tables = transport.tables(&seen, &self.arrivals, &self.fills, None);
        let settings = VolumeSettings { ignored, ..self.settings.clone() };
        Some(Self { settings, tables, ..self.clone() }.with_moments(&self.settings.moments, world, light))
    }
}
