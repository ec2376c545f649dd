//! What a volume is built with, and what can go wrong.

pub use crate::scene::volume::Basis;

use super::{
    grid::{BilevelGrid, cells_with_geometry},
    ignored::Ignored,
    moments::Order,
    trust::Repair,
};
use crate::{
    math::progress::Cancelled,
    scene::{Scene, emitters::Emitter, lamp::LampKind, world::World},
};
use glam::{UVec3, Vec3};
use std::path::PathBuf;

/// What an irradiance volume is built with.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct VolumeSettings {
    /// First-level samples an axis, at least 2 each; chosen from the scene when `None`.
    pub samples: Option<[u32; 3]>,
    /// Samples over both levels that the automatic choice stays within. Greger's office has 2,287 (§5.1.1);
    /// some more let ours keep its error in the dark corners, see `tests/irradiance_volume/accuracy.rs`.
    pub target_samples: u32,
    /// Samples at most, beside those, for places that the samples of their cell stand for badly, up to 100,000; see
    /// [`super::pockets`]. They need the guard. None by default: light steps at their faces, and each is one more to
    /// relight.
    pub pocket_samples: u32,
    /// Second-level samples an axis in a cell with geometry, 2 to 9; the thesis uses 3.
    pub second_level: u32,
    /// Divides the cells in which interpolation errs by more than this share, worst first and within
    /// `target_samples`, instead of those with geometry; 0 to 10. See [`super::adaptive`].
    pub refine_tolerance: Option<f32>,
    /// Whether cells with geometry are divided too where a tolerance says which; then cells of the first level
    /// are so large that those take half of `target_samples` at most.
    pub refine_geometry: bool,
    /// Rows and columns of direction bins a hemisphere, 1 to 128; 17 gives 578 bins.
    pub bins_n: u32,
    /// Radiance rays a bin, 1 to 256; 1 goes through its centre.
    pub supersample: u32,
    /// Extra radiance rays a sample, aimed at surfaces known to be bright, up to 65,536; see [`super::rays`].
    pub informed_rays: u32,
    /// Share of a ray's light left after mirrors, in the best channel, below which it is given up; 0 to 1.
    pub specular_cutoff: f32,
    /// Shadow rays a luminous surface at least, from each sample.
    pub direct_samples: u32,
    /// Seed of the jitter.
    pub seed: u64,
    /// Share of a sample's rays that may hit back faces before it counts as inside a solid.
    pub back_face_limit: f32,
    /// What queries read.
    pub basis: Basis,
    /// Surfaces and lamps left out as sources of light.
    pub ignored: Ignored,
    /// Orders of moments kept beside the irradiance, which is order 1; at most 8.
    pub moments: Vec<Order>,
    /// What is done with samples inside solids.
    pub repair: Repair,
    /// Whether queries use only samples that see the point; see [`super::visibility`].
    pub guard: bool,
}

impl Default for VolumeSettings {
    fn default() -> Self {
        Self {
            samples: None,
            target_samples: 2_600,
            pocket_samples: 0,
            second_level: 3,
            refine_tolerance: None,
            refine_geometry: false,
            bins_n: 17,
            supersample: 1,
            informed_rays: 256,
            specular_cutoff: 0.02,
            direct_samples: 16,
            seed: 0,
            back_face_limit: 0.25,
            basis: Basis::Bins,
            ignored: Ignored::default(),
            moments: Vec::new(),
            repair: Repair::default(),
            guard: true,
        }
    }
}

/// Why there is no volume.
#[derive(Debug, thiserror::Error)]
pub enum VolumeError {
    /// A setting is out of range.
    #[error("irradiance volume: {name} is {value}, must lie in {range}")]
    Setting {
        /// Which.
        name: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        range: &'static str,
    },
    /// The scene has no extent to put a grid into.
    #[error("irradiance volume: the scene's bounds are not finite or empty: {low} m to {high} m")]
    Bounds {
        /// Smallest corner.
        low: Vec3,
        /// Largest corner.
        high: Vec3,
    },
    /// It would take more memory than [`MOST_BYTES`](super::budget::MOST_BYTES).
    #[error(
        "irradiance volume: {samples} samples or more of {bins} bins and {orders} moments would take {gigabytes:.1} GB, \
         at most 4.3 GB are granted: take fewer samples, bins, moments or rays"
    )]
    TooLarge {
        /// Samples at least.
        samples: u64,
        /// Bins of each.
        bins: u32,
        /// Moments beside the irradiance.
        orders: usize,
        /// Memory, 10⁹ bytes.
        gigabytes: f64,
    },
    /// The user stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A file cannot be read or written.
    #[error("{path}: {cause}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// A file is not a volume.
    #[error("{path}: not a lumenscope irradiance volume: {reason}")]
    Format {
        /// Which.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

/// Luminous triangles, and the positions of lamps as triangles without extent.
fn emitter_triangles(world: &World) -> impl Iterator<Item = [Vec3; 3]> + '_ {
    world.emitters.list.iter().flat_map(|emitter| match emitter {
        Emitter::Lamp { lamp, .. } => match lamp.kind {
            LampKind::Directional { .. } => Vec::new(),
            _ => vec![[lamp.position(); 3]],
        },
        Emitter::Area(area) => area.triangles.iter().map(|&t| world.geometry.positions[t as usize]).collect(),
    })
}

impl VolumeSettings {
    /// The defaults, but for what the overrides of a scene fix. Names that nothing has are passed over.
    pub fn overridden(scene: &Scene, seed: u64) -> Self {
        let (over, usual) = (&scene.plan, Self::default());
        let names = over.volume_ignored.as_deref().unwrap_or_default();
        Self {
            samples: over.volume_samples,
            target_samples: over.volume_target_samples.unwrap_or(usual.target_samples),
            pocket_samples: over.volume_pocket_samples.unwrap_or(usual.pocket_samples),
            second_level: over.volume_second_level.unwrap_or(usual.second_level),
            refine_tolerance: over.volume_refine_tolerance,
            refine_geometry: over.volume_refine_geometry.unwrap_or(usual.refine_geometry),
            bins_n: over.volume_bins_n.unwrap_or(usual.bins_n),
            supersample: over.volume_supersample.unwrap_or(usual.supersample),
            informed_rays: over.volume_informed_rays.unwrap_or(usual.informed_rays),
            specular_cutoff: over.volume_specular_cutoff.unwrap_or(usual.specular_cutoff),
            direct_samples: usual.direct_samples,
            seed,
            back_face_limit: over.volume_back_face_limit.unwrap_or(usual.back_face_limit),
            basis: over.volume_basis.unwrap_or_default(),
            ignored: Ignored::named(scene, names).0,
            moments: over.volume_moments.clone().unwrap_or_default(),
            repair: over.volume_repair.unwrap_or_default(),
            guard: over.volume_guard.unwrap_or(usual.guard),
        }
    }

    /// Checks every range.
    ///
    /// # Errors
    /// [`VolumeError::Setting`] naming the first setting out of range.
    pub fn check(&self) -> Result<(), VolumeError> {
        let within = |name, value: u32, low: u32, high: u32, range| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(VolumeError::Setting { name, value: value.to_string(), range })
            }
        };
        for axis in self.samples.into_iter().flatten() {
            within("samples an axis", axis, 2, 200, "2 to 200")?;
        }
        within("target_samples", self.target_samples, 8, 1_000_000, "8 to 1,000,000")?;
        within("pocket_samples", self.pocket_samples, 0, 100_000, "0 to 100,000")?;
        within("second_level", self.second_level, 2, 9, "2 to 9")?;
        if let Some(tolerance) = self.refine_tolerance
            && !(0.0..=10.0).contains(&tolerance)
        {
            let value = tolerance.to_string();
            return Err(VolumeError::Setting { name: "refine_tolerance", value, range: "0 to 10" });
        }
        within("bins_n", self.bins_n, 1, 128, "1 to 128")?;
        within("supersample", self.supersample, 1, 256, "1 to 256")?;
        within("informed_rays", self.informed_rays, 0, 65_536, "0 to 65,536")?;
        if !(0.0..=1.0).contains(&self.specular_cutoff) {
            let value = self.specular_cutoff.to_string();
            return Err(VolumeError::Setting { name: "specular_cutoff", value, range: "0 to 1" });
        }
        within("direct_samples", self.direct_samples, 1, 1024, "1 to 1024")?;
        if self.moments.len() > 8 {
            let value = self.moments.len().to_string();
            return Err(VolumeError::Setting { name: "number of moments", value, range: "0 to 8" });
        }
        if self.back_face_limit.is_nan() || self.back_face_limit < 0.0 {
            let value = self.back_face_limit.to_string();
            return Err(VolumeError::Setting { name: "back_face_limit", value, range: "0 to 1" });
        }
        self.samples
            .map_or(self.check_samples(8), |samples| self.check_cells(UVec3::from(samples) - UVec3::ONE))
    }

    /// The grid for a scene; cells with geometry, and cells with an emitter or next to one, are refined.
    ///
    /// It spans the bounds less 5 cm, or 2 % of an axis where that is smaller, on each side. Where no
    /// number of samples is given, cells are near cubes, as small as `target_samples` allows but with
    /// at most 16 along the longest axis.
    ///
    /// # Errors
    /// [`VolumeError::Setting`] and [`VolumeError::Bounds`].
    pub fn grid(&self, world: &World) -> Result<BilevelGrid, VolumeError> {
        self.check()?;
        let (low, high) = world.geometry.bounds();
        let extent = high - low;
        if !(low.is_finite() && high.is_finite() && extent.is_finite() && extent.max_element() > 0.0) {
            return Err(VolumeError::Bounds { low, high });
        }
        // A flat scene still needs cells with a volume.
        let thin = Vec3::splat(0.01 * extent.max_element());
        let (low, high) =
            (low - 0.5 * (thin - extent).max(Vec3::ZERO), high + 0.5 * (thin - extent).max(Vec3::ZERO));
        let inset = (0.02 * (high - low)).min(Vec3::splat(0.05));
        let (low, high) = (low + inset, high - inset);
        let make = |samples: UVec3| {
            let size = samples - UVec3::ONE;
            let mut flags = cells_with_geometry(low, high, size, &world.geometry.positions);
            // Near an emitter light changes fastest, and emitters like to sit on walls, outside the grid.
            let skin = 0.01 * (high - low) / size.as_vec3();
            let near: Vec<[Vec3; 3]> =
                emitter_triangles(world).map(|t| t.map(|p| p.clamp(low + skin, high - skin))).collect();
            for (flag, holds) in flags.iter_mut().zip(cells_with_geometry(low, high, size, &near)) {
                *flag |= holds;
            }
            BilevelGrid::new(low, high, samples, self.second_level, &flags)
        };
        if let Some(samples) = self.samples {
            return Ok(make(samples.into()));
        }
        let extent = high - low;
        let cells = |along: u32| {
            let edge = extent.max_element() / along as f32;
            (extent / edge).round().max(Vec3::ONE).as_uvec3() + UVec3::ONE
        };
        let mut best = make(cells(1));
        let (mut fits, mut fails) = (1, 17);
        while fails - fits > 1 {
            let middle = (fits + fails) / 2;
            let samples = cells(middle);
            let first_level = samples.element_product();
            let grid = if first_level > self.target_samples { None } else { Some(make(samples)) };
            match grid.filter(|g| g.places().len() <= self.target_samples as usize) {
                Some(grid) => (fits, best) = (middle, grid),
                None => fails = middle,
            }
        }
        Ok(best)
    }
}
