//! Seconds and error of one setting of a method, at points of surfaces whose light is known.
//!
//! Seconds are those of the solve, and of asking for the light of a picture's pixels after it: a solution costs
//! once for every view, a path tracer again for each. Direct light evaluated at a point costs every method the
//! same and is left out.

use super::{
    MeasureError,
    irradiance::{ErrorStatistics, relative_errors},
    volume::ReferencePoints,
};
use crate::{
    irradiance_volume::{IrradianceVolume, VolumeError, VolumeSettings},
    math::{
        part::Part,
        progress::{Cancelled, Progress},
    },
    radiosity::{
        RadiosityError, RadiositySettings, RadiositySolution, lookup::Lookup, surface_map::UNSOLVED,
    },
    reference::{irradiance::irradiance_with, path::PathTracer},
    scene::{geometry::Surface, world::World},
};
use glam::Vec3;
use rayon::prelude::*;
use std::time::Instant;

/// A scene with points at which its light is known.
pub struct Sweep<'a> {
    /// The scene.
    pub world: &'a World,
    /// The points.
    pub surfaces: Vec<Surface>,
    /// The light there, one receiver a surface.
    pub truth: ReferencePoints,
    /// Points of a picture that the light is asked for.
    pub pixels: u32,
}

/// One setting, measured.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Row {
    /// Elements that are solved, samples of a volume, or paths a point.
    pub size: usize,
    /// Rays that elements cast; 0 where none do.
    pub rays: usize,
    /// Solving, s.
    pub solve_seconds: f64,
    /// Solving and a picture's worth of questions, s.
    pub seconds: f64,
    /// Indirect light by the method, direct light exact: what pictures show.
    pub picture: ErrorStatistics,
    /// The same looked up by Mitchell's bicubic, where the method has that.
    pub bicubic: Option<ErrorStatistics>,
    /// Both parts by the method.
    pub stored: ErrorStatistics,
}

/// Why there is no row.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The radiosity failed.
    #[error(transparent)]
    Radiosity(#[from] RadiosityError),
    /// The volume failed.
    #[error(transparent)]
    Volume(#[from] VolumeError),
    /// The errors could not be measured.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// The user stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Sweep<'_> {
    /// Solves the radiosity with some settings, and measures it.
    ///
    /// # Errors
    /// [`SweepError`].
    pub fn radiosity(
        &self,
        settings: &RadiositySettings,
        progress: &Progress,
    ) -> Result<(Row, RadiositySolution), SweepError> {
        let start = Instant::now();
        let solution = RadiositySolution::solve(self.world, settings, progress)?;
        let solve_seconds = start.elapsed().as_secs_f64();
        let at =
            |part, lookup| self.ask(|s, _| solution.shown(s.triangle, s.barycentric, s.back, part, lookup));
        let (indirect, seconds) = at(Part::Indirect, Lookup::Bilinear);
        let row = Row {
            size: solution.elements().iter().filter(|e| e.flags & UNSOLVED == 0).count(),
            rays: solution.transport().hits.len(),
            solve_seconds,
            seconds: solve_seconds + seconds,
            picture: self.with_direct(&indirect)?,
            bicubic: Some(self.with_direct(&at(Part::Indirect, Lookup::Mitchell).0)?),
            stored: relative_errors(&at(Part::All, Lookup::Bilinear).0, &self.truth.total())?,
        };
        Ok((row, solution))
    }

    /// Builds a volume lit by a solution that took `light_seconds`, and measures it.
    ///
    /// # Errors
    /// [`SweepError`].
    pub fn volume(
        &self,
        (light, light_seconds): (&RadiositySolution, f64),
        settings: &VolumeSettings,
        progress: &Progress,
    ) -> Result<Row, SweepError> {
        let start = Instant::now();
        let volume = IrradianceVolume::build(self.world, light, settings, progress)?;
        let solve_seconds = light_seconds + start.elapsed().as_secs_f64();
        let at = |part| self.ask(|s, _| volume.irradiance(s.position, s.normal, part));
        let (indirect, seconds) = at(Part::Indirect);
        Ok(Row {
            size: volume.samples().len(),
            rays: 0,
            solve_seconds,
            seconds: solve_seconds + seconds,
            picture: self.with_direct(&indirect)?,
            bicubic: None,
            stored: relative_errors(&at(Part::All).0, &self.truth.total())?,
        })
    }

    /// Traces paths from every point, by other random numbers than those of the truth.
    ///
    /// # Errors
    /// [`SweepError`].
    pub fn paths(&self, paths: u32, seed: u64) -> Result<Row, SweepError> {
        let tracer = PathTracer::new(self.world);
        let seed = seed.wrapping_add(1 << 32);
        let at = |part| {
            self.ask(|_, i| {
                irradiance_with(&tracer, &self.truth.receivers[i], part, paths, seed + i as u64).mean
            })
        };
        let (indirect, seconds) = at(Part::Indirect);
        Ok(Row {
            size: paths as usize,
            rays: 0,
            solve_seconds: 0.0,
            seconds,
            picture: self.with_direct(&indirect)?,
            bicubic: None,
            stored: relative_errors(&at(Part::All).0, &self.truth.total())?,
        })
    }

    /// What a method says at every point, and how long it takes at a picture's pixels, s.
    fn ask(&self, light: impl Fn(&Surface, usize) -> Vec3 + Sync) -> (Vec<Vec3>, f64) {
        let start = Instant::now();
        let found = self.surfaces.par_iter().enumerate().map(|(i, s)| light(s, i)).collect();
        (found, start.elapsed().as_secs_f64() * f64::from(self.pixels) / self.surfaces.len().max(1) as f64)
    }

    fn with_direct(&self, indirect: &[Vec3]) -> Result<ErrorStatistics, MeasureError> {
        let found: Vec<Vec3> = indirect.iter().zip(&self.truth.direct).map(|(i, d)| *i + *d).collect();
        relative_errors(&found, &self.truth.total())
    }
}
