//! How the irradiance volume is built and asked: options that several subcommands share.

use clap::{Args, ValueEnum};
use lumenscope_core::irradiance_volume::{Basis, VolumeSettings};

/// Options of the irradiance volume.
#[derive(Args, Clone)]
pub struct VolumeOptions {
    /// What queries of the irradiance volume read.
    #[arg(long, value_enum, default_value_t = BasisName::Bins)]
    basis: BasisName,
    /// Rows and columns of direction bins a hemisphere.
    #[arg(long)]
    bins_n: Option<u32>,
    /// Samples over both levels that the grid stays within.
    #[arg(long)]
    target_samples: Option<u32>,
    /// Radiance rays a bin.
    #[arg(long)]
    supersample: Option<u32>,
    /// Extra rays a sample, aimed at bright surfaces.
    #[arg(long)]
    informed_rays: Option<u32>,
    /// Divide the cells in which interpolation errs by more than this share, instead of those with geometry.
    #[arg(long)]
    refine_tolerance: Option<f32>,
}

/// [`Basis`] by its name on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BasisName {
    /// 2n² bins, bilinear between the four around a normal.
    Bins,
    /// The bin that holds the normal.
    NearestBin,
    /// Nine spherical-harmonic coefficients.
    Harmonics,
}

impl VolumeOptions {
    /// Settings with these options taken over.
    pub fn apply(&self, settings: &mut VolumeSettings) {
        settings.basis = match self.basis {
            BasisName::Bins => Basis::Bins,
            BasisName::NearestBin => Basis::NearestBin,
            BasisName::Harmonics => Basis::Harmonics,
        };
        let take = |into: &mut u32, from: Option<u32>| *into = from.unwrap_or(*into);
        take(&mut settings.bins_n, self.bins_n);
        take(&mut settings.target_samples, self.target_samples);
        take(&mut settings.supersample, self.supersample);
        take(&mut settings.informed_rays, self.informed_rays);
        settings.refine_tolerance = self.refine_tolerance.or(settings.refine_tolerance);
    }
}
