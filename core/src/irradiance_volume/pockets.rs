//! Pockets: eighths of cells for which the cell's corners do not speak.
//!
//! In a shelf, or an inch under the edge of a desk, a place sees something else than every sample around it,
//! also than those that see it. What is interpolated there is off by a multiple, and more samples everywhere
//! move such places but do not end them. So the eighths of the cells that hold geometry are asked for the error of a
//! query of indirect light at their middle, and the worst get a sample of their own: a third level, in places. It
//! answers alone in its eighth, wherever it sees the point and three quarters of what that sees; the guard
//! ([`visibility`](super::visibility)) asks, so volumes without a guard have none. They are chosen in two rounds, few
//! rays everywhere and more where that was worst.
//!
//! The error is the mean over directions of |ln (E + e) / (E_exact + e)|, e being 5 % of the mean: by ratios, since
//! what is found of dark places may exceed them by any multiple, but no bright one is missed by more than all of
//! it, and those would be passed over.
//!
//! Not the corners by how much of what they see is seen from the point, too: that leaves shelves as they are, where no
//! corner agrees. Not by direct light: near lamps that changes within an eighth, too, and is asked of the lamps
//! by default. Limits: light steps at the faces of a pocket; what is smaller than one, as the gap between two books,
//! is missed; an eighth whose middle lies in a solid gets none; and they are chosen under the light that the
//! volume is built in.

use super::{
    IrradianceVolume, Sample, SurfaceLight, Tables, VolumeError, VolumeSettings,
    cache::{Met, SeenLight},
    codec::{Texel, decode_rgb},
    direct::Arrivals,
    grid::Cell,
    quadrature::irradiance_by_definition,
    rays::{PointHits, Targets, trace_point},
    trust::SampleState,
};
use crate::{
    math::{
        colour::luminance, part::Part, progress::Progress, relative::floor_of, sphere_map::DirectionBins,
    },
    scene::world::World,
};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Level of a sample in a pocket.
pub const POCKET_LEVEL: u8 = 3;

/// Rows of bins a hemisphere of the two rounds.
const ROUNDS: [u32; 2] = [3, 6];

/// Eighths that come to the second round for each that can be chosen.
const KEPT: usize = 3;

/// Error of a query, as the logarithm of a ratio, up to which an eighth is left to the corners.
const BEARABLE: f32 = 0.5;

/// Ratio of the brightest to the darkest corner up to which a cell is taken to be even.
const EVEN: f32 = 1.5;

/// Light at the middle of an eighth: what a query answers, and what a sample there would hold, by luminance, lx.
struct Compared {
    eighth: u32,
    found: Vec<f32>,
    exact: Vec<f32>,
}

/// Bytes that comparing the eighths of so many cells takes, about, `most` of them to be chosen.
pub(super) fn bytes(cells: u64, most: u64) -> u64 {
    let compared =
        |n: u32| (size_of::<Compared>() + 2 * DirectionBins::new(n).len() * size_of::<f32>()) as u64;
    cells
        .saturating_mul(8 * compared(ROUNDS[0]))
        .max((KEPT as u64 * most).saturating_mul(compared(ROUNDS[1])))
}

/// Of those compared the worst, `most` at most and none that is bearable; in order.
fn worst(compared: &[Compared], most: usize) -> Vec<u32> {
    let values = || compared.iter().flat_map(|c| &c.exact);
    let mean = values().map(|e| f64::from(*e)).sum::<f64>() / values().count().max(1) as f64;
    let floor = floor_of(mean) as f32;
    if floor <= 0.0 {
        // In the dark there is nothing to err from.
        return Vec::new();
    }
    let ratio = |(found, exact): (&f32, &f32)| ((found + floor) / (exact + floor)).ln().abs();
    let error = |c: &Compared| c.found.iter().zip(&c.exact).map(ratio).sum::<f32>() / c.exact.len() as f32;
    let errors = compared.iter().map(|c| (error(c), c.eighth));
    let mut errors: Vec<(f32, u32)> = errors.filter(|e| e.0 > BEARABLE).collect();
    errors.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut eighths: Vec<u32> = errors.into_iter().take(most).map(|e| e.1).collect();
    eighths.sort_unstable();
    eighths
}

impl IrradianceVolume {
    /// Gives samples of their own to the eighths where queries err most, at most as many as the settings say.
    pub(super) fn add_pockets(
        &mut self,
        world: &World,
        light: &impl SurfaceLight,
        targets: &Targets,
        progress: &Progress,
    ) -> Result<(), VolumeError> {
        // Only the guard asks them.
        if self.settings.pocket_samples == 0 || !self.settings.guard {
            return Ok(());
        }
        let eighths = self.with_guard(Some(world)).misled(world, light, progress)?;
        let Some(transport) = self.transport.as_mut().map(Arc::make_mut) else { return Ok(()) };
        let (settings, bins) = (&self.settings, self.directions.bins());
        let first = self.samples.len();
        let grid = Arc::make_mut(&mut self.grid);
        grid.add_pockets(&eighths);
        let positions: Vec<Vec3> = grid.places()[first..].iter().map(|p| p.position).collect();
        let traced = positions.par_iter().enumerate().map(|(i, &p)| {
            progress.report(0.95)?;
            Ok(trace_point(world, light, bins, settings, targets, p, (first + i) as u32))
        });
        let hits: Vec<PointHits> = traced.collect::<Result<_, VolumeError>>()?;
        let samples = Arc::make_mut(&mut self.samples);
        for (&position, hit) in positions.iter().zip(&hits) {
            let back_face_fraction = hit.back_face_fraction;
            let valid = back_face_fraction <= settings.back_face_limit;
            let state = if valid { SampleState::Free } else { SampleState::Masked };
            samples.push(Sample { position, level: POCKET_LEVEL, back_face_fraction, valid, state });
        }
        let new: Vec<Arrivals> =
            world.emitters.list.iter().map(|e| Arrivals::gather(world, e, &positions, settings)).collect();
        let met = Met::new(bins, settings, hits);
        let seen = met.seen(world, light.radiosity(), &settings.ignored);
        let new: Vec<Arc<Arrivals>> = new.into_iter().map(Arc::new).collect();
        let heard = seen.heard(&new);
        let mut tables = [&self.tables.direct, &self.tables.indirect].map(|t| t.to_vec());
        tables[0].extend(transport.solver.direct(met.points(), &heard, |_| None));
        tables[1].extend(transport.solver.indirect(met.points(), |s, out| met.reflected_of(s, &seen, out)));
        let [direct, indirect] = tables.map(Arc::new);
        self.tables = Tables::new(bins, direct, indirect);
        for (all, new) in self.arrivals.iter_mut().zip(&new) {
            Arc::make_mut(all).append(new);
        }
        transport.met.append(met);
        self.ages = Arc::new(vec![0; self.samples.len()]);
        Ok(())
    }

    /// The eighths where a guarded query errs most and not bearably, in order: 8 × cell + corner.
    fn misled(
        &self,
        world: &World,
        light: &impl SurfaceLight,
        progress: &Progress,
    ) -> Result<Vec<u32>, VolumeError> {
        let (Some(guard), Some(transport)) = (&self.guard, &self.transport) else { return Ok(Vec::new()) };
        let seen = transport.met.seen(world, light.radiosity(), &self.settings.ignored);
        let most = self.settings.pocket_samples as usize;
        let uneven = self.uneven();
        let held = self.grid.ends().filter(|&cell| !guard.is_open(cell) && uneven(cell));
        let mut eighths: Vec<u32> = held.flat_map(|cell| 8 * cell..8 * cell + 8).collect();
        for (bins_n, most) in ROUNDS.into_iter().zip([KEPT * most, most]) {
            let compared = eighths.par_iter().map(|&eighth| {
                progress.report(0.9)?;
                Ok(self.compare(world, light, &seen, eighth, bins_n))
            });
            let compared: Vec<Option<Compared>> = compared.collect::<Result<_, VolumeError>>()?;
            eighths = worst(&compared.into_iter().flatten().collect::<Vec<_>>(), most);
        }
        Ok(eighths)
    }

    /// Tells of a cell whether indirect light may bend in it: where its corners differ, or one is in a solid.
    fn uneven(&self) -> impl Fn(u32) -> bool + '_ {
        let bins = self.directions.bins().len();
        let mean =
            |sample: &[Texel]| sample.iter().map(|t| luminance(decode_rgb(*t))).sum::<f32>() / bins as f32;
        let means: Vec<f32> = self.tables.indirect.par_chunks(bins).map(mean).collect();
        move |cell| {
            let Cell { samples, valid } = self.grid.cells()[cell as usize];
            let of = samples.map(|s| means[s as usize]);
            let (least, most) = of.iter().fold((f32::INFINITY, 0.0f32), |(a, b), m| (a.min(*m), b.max(*m)));
            valid != u8::MAX || most > EVEN * least
        }
    }

    /// `None` where the middle of the eighth lies in a solid.
    fn compare(
        &self,
        world: &World,
        light: &impl SurfaceLight,
        seen: &SeenLight,
        eighth: u32,
        bins_n: u32,
    ) -> Option<Compared> {
        let settings = VolumeSettings {
            bins_n,
            supersample: 1,
            informed_rays: 0,
            ignored: self.settings.ignored.clone(),
            moments: Vec::new(),
            ..self.settings
        };
        let (bins, position) = (DirectionBins::new(bins_n), self.grid.middle_of_eighth(eighth));
        let hits = trace_point(world, light, bins, &settings, &Targets::default(), position, eighth);
        if hits.back_face_fraction > settings.back_face_limit {
            return None;
        }
        let mut radiance = vec![Vec3::ZERO; bins.len()];
        seen.reflected(&hits.elements, &hits.extras, &mut radiance);
        let exact = irradiance_by_definition(bins, &radiance).into_iter().map(luminance).collect();
        let (corners, tables) = (self.corners_by_rays(position), self.tables_of(Part::Indirect));
        let found = (0..bins.len()).map(|b| {
            let between = self.directions.interpolated(bins.centre(b));
            luminance(self.between_bins(tables, &corners, &between))
        });
        Some(Compared { eighth, found: found.collect(), exact })
    }
}
