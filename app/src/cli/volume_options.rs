//! How the irradiance volume is built and asked: options that several subcommands share.

use clap::{Args, ValueEnum};
use lumenscope_core::irradiance_volume::{Basis, VolumeSettings};

/// Options of the irradiance volume.
#[derive(Args, Clone)]
pub struct VolumeOptions {
    /// What queries of the irradiance volume read.
    #[arg(long, value_enum, default_value_t = BasisName::Bins)]
    basis: BasisName,
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
    }
}
