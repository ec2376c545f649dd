//! Which cells of the first level are divided, by how wrong interpolation would be in them.
//!
//! Greger (1996, §6.1.1) leaves open which metric should compare two spheres of irradiance. Here it is the
//! error that a query would make: at a point inside a cell, the mean over the bins of
//! |E − E_exact| / max(E_exact, 5 % of the mean over the volume), where E is interpolated from the cell's
//! corners and E_exact is what a sample there would hold, both by luminance, direct light included. It is
//! the quantity that this program reports everywhere as the error of irradiance, averaged over directions;
//! the maximum over bins would be set by the darkest side of a sphere, where the error is of least account.
//!
//! A cell is asked at its centre and at the centres of its six faces, which neighbours share, and counts
//! with the largest answer; points inside solids are passed over. Still two levels: what is divided carries
//! one second-level grid. Spheres for this have at most 9 × 9 bins a hemisphere: cells are told apart by
//! errors of many per cent.

use super::{
    SurfaceLight, VolumeError, VolumeSettings,
    grid::{BilevelGrid, NONE, trilinear},
    probe::Probe,
    rays::Targets,
};
use crate::{
    math::{colour::luminance, part::Part, progress::Progress, relative::floor_of},
    scene::world::World,
};
use glam::UVec3;
use rayon::prelude::*;

/// Most rows of bins a hemisphere that cells are compared with.
const MOST_BINS_N: u32 = 9;

/// Mean over bins of |E − E_exact| / max(E_exact, floor): how far one sphere of irradiance is from another,
/// by luminance in lx.
///
/// # Panics
/// If they differ in length or are empty.
pub fn sphere_distance(found: &[f32], exact: &[f32], floor: f32) -> f32 {
    assert!(found.len() == exact.len() && !exact.is_empty(), "one value a bin");
    let floor = floor.max(f32::MIN_POSITIVE);
    found.iter().zip(exact).map(|(e, t)| (e - t).abs() / t.max(floor)).sum::<f32>() / exact.len() as f32
}

/// Error of interpolation in each first-level cell of a grid, x fastest: see the module's text.
///
/// # Errors
/// [`VolumeError::Cancelled`].
pub fn cell_errors(
    world: &World,
    light: &impl SurfaceLight,
    settings: &VolumeSettings,
    grid: &BilevelGrid,
    progress: &Progress,
) -> Result<Vec<f32>, VolumeError> {
    let settings = VolumeSettings {
        bins_n: settings.bins_n.min(MOST_BINS_N),
        supersample: 1,
        direct_samples: settings.direct_samples.min(4),
        ..settings.clone()
    };
    let targets = if settings.informed_rays > 0 { Targets::new(light) } else { Targets::default() };
    let (low, _) = grid.bounds();
    let (size, cell) = (grid.size(), grid.cell_size());
    // On a lattice of half cells, corners are even in every coordinate, centres odd in all three and
    // centres of faces in two.
    let half = 2 * size + UVec3::ONE;
    let index = |at: UVec3| ((at.z * half.y + at.y) * half.x + at.x) as usize;
    let at = |i: u32| UVec3::new(i % half.x, i / half.x % half.y, i / (half.x * half.y));
    let spheres: Vec<Option<Vec<f32>>> = (0..half.element_product())
        .into_par_iter()
        .map(|i| {
            let place = at(i);
            let odd = (place % 2).element_sum();
            if odd == 1 {
                return Ok(None);
            }
            progress.report(0.2 * i as f32 / half.element_product() as f32)?;
            let position = low + 0.5 * place.as_vec3() * cell;
            let probe = Probe::with(world, light, position, &settings, &targets, i);
            let open = probe.back_face_fraction <= settings.back_face_limit;
            Ok(open.then(|| probe.irradiance(Part::All).into_iter().map(luminance).collect()))
        })
        .collect::<Result<_, VolumeError>>()?;
    let (sum, count) = spheres
        .iter()
        .flatten()
        .flatten()
        .fold((0.0f64, 0u64), |(sum, count), e| (sum + f64::from(*e), count + 1));
    let floor = floor_of(sum / count.max(1) as f64) as f32;
    let error = |c: u32| {
        let origin = 2 * UVec3::new(c % size.x, c / size.x % size.y, c / (size.x * size.y));
        let corner = |i: usize| {
            let i = i as u32;
            spheres[index(origin + 2 * UVec3::new(i & 1, i >> 1 & 1, i >> 2))].as_ref()
        };
        let mut worst = 0.0f32;
        for inner in [[1, 1, 1], [0, 1, 1], [2, 1, 1], [1, 0, 1], [1, 2, 1], [1, 1, 0], [1, 1, 2]] {
            let inner = UVec3::from(inner);
            let Some(exact) = &spheres[index(origin + inner)] else { continue };
            let weights = trilinear(0.5 * inner.as_vec3());
            let mut found = vec![0.0; exact.len()];
            let mut kept = 0.0;
            for (i, weight) in weights.into_iter().enumerate() {
                let Some(sphere) = corner(i).filter(|_| weight > 0.0) else { continue };
                kept += weight;
                found.iter_mut().zip(sphere).for_each(|(f, e)| *f += e * weight);
            }
            if kept > 0.0 {
                found.iter_mut().for_each(|f| *f /= kept);
            }
            worst = worst.max(sphere_distance(&found, exact, floor));
        }
        worst
    };
    Ok((0..size.element_product()).into_par_iter().map(error).collect())
}

/// The grid whose cells over a tolerance are divided, worst first, as long as it stays within
/// `target_samples`; and with `refine_geometry` those with geometry before them.
///
/// # Errors
/// [`VolumeError`] for settings out of range, bounds that are not finite, and cancellation.
pub fn grid(
    world: &World,
    light: &impl SurfaceLight,
    settings: &VolumeSettings,
    tolerance: f32,
    progress: &Progress,
) -> Result<BilevelGrid, VolumeError> {
    let by_geometry = if settings.refine_geometry {
        let target_samples = (settings.target_samples / 2).max(8);
        VolumeSettings { target_samples, ..settings.clone() }.grid(world)?
    } else {
        settings.grid(world)?
    };
    let errors = cell_errors(world, light, settings, &by_geometry, progress)?;
    let held: Vec<bool> =
        by_geometry.second().iter().map(|s| settings.refine_geometry && *s != NONE).collect();
    let mut order: Vec<usize> = (0..errors.len()).filter(|&c| errors[c] > tolerance && !held[c]).collect();
    order.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]).then(a.cmp(&b)));
    let (low, high) = by_geometry.bounds();
    let make = |count: usize| {
        let mut flags = held.clone();
        order[..count].iter().for_each(|&c| flags[c] = true);
        BilevelGrid::new(low, high, by_geometry.size() + UVec3::ONE, settings.second_level, &flags)
    };
    let most = settings.target_samples as usize;
    let (mut fits, mut fails) = (0, order.len() + 1);
    let mut best = make(0);
    while fails - fits > 1 {
        let middle = (fits + fails) / 2;
        let grid = make(middle);
        if grid.places().len() <= most { (fits, best) = (middle, grid) } else { fails = middle }
    }
    Ok(best)
}
