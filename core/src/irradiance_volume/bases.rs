//! How far each basis is from the irradiance it stands for.
//!
//! At a sample nothing is interpolated in space, so what a basis loses there is its own: the irradiance of
//! a normal that no bin is centred on is summed from the sample's radiance bins and from what arrives
//! from each emitter (Eq. 4.3 for that one normal), and compared with what the basis gives.

use super::{
    Basis, IrradianceVolume, SurfaceLight,
    inspect::{VolumeView, spheres},
    slice::bulk,
};
use crate::{
    inspection::{InspectionScene, Legend},
    math::{
        colour::luminance, frame::uniform_direction, part::Part, random::Rng, relative::floor_of,
        sphere_map::DirectionBins,
    },
    scene::world::World,
};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Rows of bins a hemisphere at which a sphere shows the error of a basis: off the centres of the bins.
const SHOWN_N: u32 = 7;

/// Samples and normals a sample by which the bases are compared in words.
const COMPARED: (usize, u64) = (400, 40);

/// Error of one basis, by luminance: |E − E_exact| over the larger of E_exact and 5 % of its mean.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct BasisError {
    /// Which.
    pub basis: Basis,
    /// Median relative error.
    pub median: f32,
    /// 95th percentile.
    pub percentile_95: f32,
    /// Largest.
    pub worst: f32,
    /// Mean of the signed error.
    pub mean_signed: f32,
    /// Bytes of one part of the light in this basis.
    pub bytes: usize,
    /// Mean of the exact irradiance, lx.
    pub mean_lx: f32,
}

impl std::fmt::Display for BasisError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [median, high, worst, signed] =
            [self.median, self.percentile_95, self.worst, self.mean_signed].map(|e| 100.0 * e);
        let (name, megabytes) = (self.basis.name(), self.bytes as f64 * 1e-6);
        write!(f, "{name}: median {median:.2} %, 95th {high:.2} %, ")?;
        write!(f, "worst {worst:.1} %, signed {signed:+.2} %, {megabytes:.2} MB a part")
    }
}

impl IrradianceVolume {
    /// Compares every basis with the exact sum at up to `samples` samples and `directions` random normals
    /// each. Empty where the volume comes from a file, which does not keep radiance.
    pub fn compare_bases(
        &self,
        world: &World,
        light: &impl SurfaceLight,
        part: Part,
        samples: usize,
        directions: u64,
    ) -> Vec<BasisError> {
        let Some(transport) = &self.transport else { return Vec::new() };
        let step = self.samples.len().div_ceil(samples.max(1)).max(1);
        let bins = self.bins();
        let seen = transport.met.seen(world, light.radiosity(), &self.settings.ignored);
        let centres: Vec<Vec3> = (0..bins.len()).map(|b| bins.centre(b)).collect();
        // Exact luminance, then that of each basis.
        let rows: Vec<[f32; 4]> = (0..self.samples.len())
            .into_par_iter()
            .step_by(step)
            .filter(|&s| self.samples[s].valid)
            .flat_map_iter(|s| {
                let mut radiance = vec![Vec3::ZERO; bins.len()];
                transport.met.reflected(s, &seen, &mut radiance);
                let centres = &centres;
                (0..directions).map(move |i| {
                    let normal = uniform_direction(Rng::new(s as u64, i).next_vec2());
                    let exact = luminance(self.exact_at(s, normal, centres, &radiance, part));
                    let of = |basis| luminance(self.at_sample(s as u32, normal, part, basis));
                    let [a, b, c] = Basis::ALL.map(of);
                    [exact, a, b, c]
                })
            })
            .collect();
        let mean = rows.iter().map(|r| f64::from(r[0])).sum::<f64>() / rows.len().max(1) as f64;
        let floor = floor_of(mean) as f32;
        let error = |basis: Basis, column: usize| {
            let mut errors: Vec<f32> = rows.iter().map(|r| (r[column] - r[0]) / r[0].max(floor)).collect();
            let signed = errors.iter().map(|e| f64::from(*e)).sum::<f64>() / errors.len().max(1) as f64;
            errors.iter_mut().for_each(|e| *e = e.abs());
            errors.sort_by(f32::total_cmp);
            let at = |share: f32| {
                errors.get(((errors.len() as f32 * share) as usize).min(errors.len().max(1) - 1)).copied()
            };
            BasisError {
                basis,
                median: at(0.5).unwrap_or(0.0),
                percentile_95: at(0.95).unwrap_or(0.0),
                worst: at(1.0).unwrap_or(0.0),
                mean_signed: signed as f32,
                mean_lx: mean as f32,
                bytes: match basis {
                    Basis::Harmonics => size_of_val(self.tables.harmonics().of(part)),
                    _ => self.table_bytes(),
                },
            }
        };
        Basis::ALL.into_iter().enumerate().map(|(i, basis)| error(basis, i + 1)).collect()
    }

    /// Spheres coloured by how far the volume's own basis is from the exact sum, %, and the error of every
    /// basis in words. `None` where the volume comes from a file, which does not keep radiance.
    pub fn basis_scene(
        &self,
        world: &World,
        light: &impl SurfaceLight,
        view: &VolumeView,
    ) -> Option<InspectionScene> {
        let transport = self.transport.as_ref()?;
        let compared = self.compare_bases(world, light, view.part, COMPARED.0, COMPARED.1);
        let shown = DirectionBins::new(SHOWN_N);
        let bins = self.bins();
        let seen = transport.met.seen(world, light.radiosity(), &self.settings.ignored);
        let centres: Vec<Vec3> = (0..bins.len()).map(|b| bins.centre(b)).collect();
        let basis = self.settings.basis;
        let floor = floor_of(f64::from(compared.first()?.mean_lx)) as f32;
        let mut scene = spheres(self, view, |s| {
            let mut radiance = vec![Vec3::ZERO; bins.len()];
            transport.met.reflected(s, &seen, &mut radiance);
            let error = |bin: usize| {
                let normal = shown.centre(bin);
                let exact = luminance(self.exact_at(s, normal, &centres, &radiance, view.part));
                let found = luminance(self.at_sample(s as u32, normal, view.part, basis));
                Vec3::splat(100.0 * (found - exact).abs() / exact.max(floor))
            };
            (0..shown.len()).map(error).collect()
        });
        scene.bins = Some(shown);
        scene.legend = Some(Legend {
            quantity: format!("error of {}", basis.name()),
            unit: "%".into(),
            range: [0.0, bulk(&scene.sphere_bins)],
            names: &[],
        });
        scene.notes = compared.iter().map(BasisError::to_string).collect();
        Some(scene)
    }

    /// Eq. 4.3 for one normal, its weights summing to π, and every emitter by itself; lx.
    fn exact_at(&self, sample: usize, normal: Vec3, centres: &[Vec3], radiance: &[Vec3], part: Part) -> Vec3 {
        let mut sum = DVec3::ZERO;
        if part != Part::Direct {
            let mut cosines = 0.0;
            for (centre, radiance) in centres.iter().zip(radiance) {
                let cosine = f64::from(normal.dot(*centre).max(0.0));
                cosines += cosine;
                sum += radiance.as_dvec3() * cosine;
            }
            sum *= std::f64::consts::PI / cosines;
        }
        if part != Part::Indirect {
            for arrival in self.arrivals.iter().flat_map(|a| a.of(sample)) {
                sum +=
                    arrival.normal_irradiance.as_dvec3() * f64::from(arrival.direction.dot(normal).max(0.0));
            }
        }
        sum.as_vec3()
    }
}
