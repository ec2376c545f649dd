//! Two volumes compared: what one has more than the other, in numbers, at samples and on a plane.
//!
//! Volumes are compared by what they answer, not by what they store, so grids, bins and where the light
//! comes from may all differ. The difference of a volume and the same one ignoring a surface is the light
//! from that surface (Greger 1996, §5.4); that of a volume and one from the reference is its error.

use super::IrradianceVolume;
use crate::math::{colour::luminance, part::Part, relative::floor_of};
use glam::Vec3;
use rayon::prelude::*;

/// Two volumes and the part of the light that is compared: A − B.
#[derive(Clone, Copy, Debug)]
pub struct Difference<'a> {
    /// What is subtracted from.
    pub a: &'a IrradianceVolume,
    /// What is subtracted.
    pub b: &'a IrradianceVolume,
    /// Part of the light.
    pub part: Part,
}

/// A − B over the valid samples of A and all its bins, by luminance.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct DifferenceStatistics {
    /// Mean of A, lx.
    pub mean_a_lx: f32,
    /// Mean of B, lx.
    pub mean_b_lx: f32,
    /// Mean of A − B, lx.
    pub mean_lx: f32,
    /// Mean of |A − B|, lx.
    pub mean_absolute_lx: f32,
    /// Root of the mean of (A − B)², lx.
    pub rms_lx: f32,
    /// A − B where it is largest in size, lx.
    pub largest_lx: f32,
    /// Where that is, m.
    pub largest_at_m: Vec3,
    /// The direction a surface there faces.
    pub largest_towards: Vec3,
    /// Median of |A − B| over the larger of B and 5 % of its mean.
    pub median_relative: f32,
    /// 95th percentile of the same.
    pub percentile_95_relative: f32,
}

/// A difference in numbers, with how often each size of it occurs.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The numbers.
    pub statistics: DifferenceStatistics,
    /// 5 % of B's mean over the valid samples of A, lx: what errors are relative to at least.
    pub floor_lx: f32,
    /// Values of |A − B| / max(B, 5 % of its mean) in each step.
    pub counts: Vec<u32>,
}

impl<'a> Difference<'a> {
    /// A − B.
    pub fn new(a: &'a IrradianceVolume, b: &'a IrradianceVolume, part: Part) -> Self {
        Self { a, b, part }
    }

    /// A − B for a surface at a point that faces the unit vector `normal`, lx per channel.
    pub fn at(&self, position: Vec3, normal: Vec3) -> Vec3 {
        self.a.irradiance(position, normal, self.part) - self.b.irradiance(position, normal, self.part)
    }

    /// A − B at one of A's samples, lx per channel, one value a bin of A: from the tables where B has the
    /// same samples and bins, else from a query to B.
    ///
    /// # Panics
    /// If A has no such sample.
    pub fn at_sample(&self, sample: usize) -> Vec<Vec3> {
        let a = self.a.sample_irradiance(sample, self.part);
        let b = self.b_at_sample(sample);
        a.iter().zip(b).map(|(a, b)| *a - b).collect()
    }

    fn b_at_sample(&self, sample: usize) -> Vec<Vec3> {
        let position = self.a.samples()[sample].position;
        let bins = self.a.bins();
        if self.same_samples() {
            return self.b.sample_irradiance(sample, self.part);
        }
        (0..bins.len()).map(|bin| self.b.irradiance(position, bins.centre(bin), self.part)).collect()
    }

    /// |A − B| / max(B, `floor`) at one of A's samples by luminance, one value a bin of A; `floor` in lx is
    /// [`Comparison::floor_lx`].
    ///
    /// # Panics
    /// If A has no such sample.
    pub fn relative_at_sample(&self, sample: usize, floor: f32) -> impl Iterator<Item = f32> + use<> {
        let a = self.a.sample_irradiance(sample, self.part);
        a.into_iter()
            .zip(self.b_at_sample(sample))
            .map(move |(a, b)| relative(luminance(a), luminance(b), floor))
    }

    /// Whether both have the same samples and bins.
    pub fn same_samples(&self) -> bool {
        self.a.bins() == self.b.bins()
            && self.a.samples().len() == self.b.samples().len()
            && self.a.grid().bounds() == self.b.grid().bounds()
            && self.a.grid().second() == self.b.grid().second()
            && self.a.grid().size() == self.b.grid().size()
    }

    /// The difference in numbers; zeros where A has no valid sample.
    pub fn statistics(&self) -> DifferenceStatistics {
        self.compare(1, 1.0).statistics
    }

    /// The difference in numbers, and how many values of |A − B| / max(B, 5 % of its mean) lie in each of
    /// `steps` steps of `width`, the last one and everything beyond: the histogram of an error.
    pub fn compare(&self, steps: usize, width: f32) -> Comparison {
        let bins = self.a.bins();
        // Sample, bin, A and B by luminance, in the order of samples and bins.
        let rows: Vec<(u32, u32, f32, f32)> = (0..self.a.samples().len())
            .into_par_iter()
            .filter(|&s| self.a.samples()[s].valid)
            .flat_map_iter(|s| {
                let a = self.a.sample_irradiance(s, self.part);
                let b = self.b_at_sample(s);
                a.into_iter()
                    .zip(b)
                    .enumerate()
                    .map(move |(bin, (a, b))| (s as u32, bin as u32, luminance(a), luminance(b)))
            })
            .collect();
        let count = rows.len().max(1) as f64;
        let mean = |of: &dyn Fn(f64, f64) -> f64| {
            rows.iter().map(|r| of(f64::from(r.2), f64::from(r.3))).sum::<f64>() / count
        };
        let mean_b = mean(&|_, b| b);
        let floor_lx = floor_of(mean_b) as f32;
        let mut errors: Vec<f32> = rows.iter().map(|r| relative(r.2, r.3, floor_lx)).collect();
        let mut counts = vec![0; steps.max(1)];
        for error in &errors {
            counts[((error / width) as usize).min(steps.max(1) - 1)] += 1;
        }
        errors.sort_unstable_by(f32::total_cmp);
        let quantile =
            |share: f64| errors.get((errors.len() as f64 * share) as usize).copied().unwrap_or_default();
        let worst = rows.iter().fold(None, |worst: Option<&(u32, u32, f32, f32)>, r| match worst {
            Some(w) if (w.2 - w.3).abs() >= (r.2 - r.3).abs() => Some(w),
            _ => Some(r),
        });
        let (at, towards, largest) = worst.map_or((Vec3::ZERO, Vec3::Y, 0.0), |r| {
            (self.a.samples()[r.0 as usize].position, bins.centre(r.1 as usize), r.2 - r.3)
        });
        let statistics = DifferenceStatistics {
            mean_a_lx: mean(&|a, _| a) as f32,
            mean_b_lx: mean_b as f32,
            mean_lx: mean(&|a, b| a - b) as f32,
            mean_absolute_lx: mean(&|a, b| (a - b).abs()) as f32,
            rms_lx: mean(&|a, b| (a - b).powi(2)).sqrt() as f32,
            largest_lx: largest,
            largest_at_m: at,
            largest_towards: towards,
            median_relative: quantile(0.5),
            percentile_95_relative: quantile(0.95),
        };
        Comparison { statistics, floor_lx, counts }
    }
}

fn relative(a: f32, b: f32, floor: f32) -> f32 {
    (a - b).abs() / b.max(floor)
}
