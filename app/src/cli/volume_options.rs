//! How the irradiance volume is built and asked: options that several subcommands share.

use clap::{Args, ValueEnum};
use lumenscope_core::irradiance_volume::{Basis, VolumeSettings, moments::Order, trust::Repair};

/// Options of the irradiance volume.
#[derive(Args, Clone)]
pub struct VolumeOptions {
    /// What queries of the irradiance volume read.
    #[arg(long, value_enum)]
    basis: Option<BasisName>,
    /// Rows and columns of direction bins a hemisphere.
    #[arg(long)]
    bins_n: Option<u32>,
    /// First-level samples an axis, such as 8,5,8; chosen from the scene if not given.
    #[arg(long, value_parser = parse_samples)]
    samples: Option<[u32; 3]>,
    /// Second-level samples an axis in a divided cell, 2 to 9.
    #[arg(long)]
    second_level: Option<u32>,
    /// Samples over both levels that the grid stays within.
    #[arg(long)]
    target_samples: Option<u32>,
    /// Samples beside those for places that the samples of their cell stand for badly; they need the guard.
    #[arg(long)]
    pocket_samples: Option<u32>,
    /// Radiance rays a bin.
    #[arg(long)]
    supersample: Option<u32>,
    /// Extra rays a sample, aimed at bright surfaces.
    #[arg(long)]
    informed_rays: Option<u32>,
    /// Divide the cells in which interpolation errs by more than this share, instead of those with geometry.
    #[arg(long)]
    refine_tolerance: Option<f32>,
    /// With a refine tolerance, divide the cells with geometry too.
    #[arg(long, num_args = 0..=1, default_missing_value = "true")]
    refine_geometry: Option<bool>,
    /// Share of a ray's light left after mirrors below which it is given up.
    #[arg(long)]
    specular_cutoff: Option<f32>,
    /// Share of a sample's rays that may meet backs before it counts as inside a solid.
    #[arg(long)]
    back_face_limit: Option<f32>,
    /// Orders of moments kept beside the irradiance, such as 2,4,10,100,inf.
    #[arg(long, value_delimiter = ',')]
    moments: Vec<Order>,
    /// What is done with volume samples inside solids.
    #[arg(long, value_enum)]
    repair: Option<RepairName>,
    /// Whether volume queries use only samples that see the point: no light through thin walls.
    #[arg(long, num_args = 0..=1, default_missing_value = "true")]
    guard: Option<bool>,
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

/// [`Repair`] by its name on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum RepairName {
    /// Left out; their neighbours share their weight.
    Mask,
    /// Filled with the light of the valid samples beside them.
    Dilate,
    /// Moved to the nearest free point within half a cell.
    Relocate,
}

impl VolumeOptions {
    /// Takes over the options that were given; the others stay as planned.
    pub fn apply(&self, settings: &mut VolumeSettings) {
        let take = |into: &mut u32, from: Option<u32>| *into = from.unwrap_or(*into);
        take(&mut settings.bins_n, self.bins_n);
        take(&mut settings.target_samples, self.target_samples);
        take(&mut settings.pocket_samples, self.pocket_samples);
        take(&mut settings.supersample, self.supersample);
        take(&mut settings.informed_rays, self.informed_rays);
        take(&mut settings.second_level, self.second_level);
        settings.samples = self.samples.or(settings.samples);
        settings.refine_geometry = self.refine_geometry.unwrap_or(settings.refine_geometry);
        settings.specular_cutoff = self.specular_cutoff.unwrap_or(settings.specular_cutoff);
        settings.back_face_limit = self.back_face_limit.unwrap_or(settings.back_face_limit);
        settings.refine_tolerance = self.refine_tolerance.or(settings.refine_tolerance);
        if let Some(basis) = self.basis {
            settings.basis = match basis {
                BasisName::Bins => Basis::Bins,
                BasisName::NearestBin => Basis::NearestBin,
                BasisName::Harmonics => Basis::Harmonics,
            };
        }
        if let Some(repair) = self.repair {
            settings.repair = match repair {
                RepairName::Mask => Repair::Mask,
                RepairName::Dilate => Repair::Dilate,
                RepairName::Relocate => Repair::Relocate,
            };
        }
        if !self.moments.is_empty() {
            settings.moments.clone_from(&self.moments);
        }
        settings.guard = self.guard.unwrap_or(settings.guard);
    }
}

/// `X,Y,Z`.
fn parse_samples(text: &str) -> Result<[u32; 3], String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let three = numbers.ok().and_then(|n| <[u32; 3]>::try_from(n).ok());
    three.ok_or_else(|| format!("`{text}` is not X,Y,Z: samples along each axis"))
}
