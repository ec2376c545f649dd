//! How far irradiances at a list of points are from their reference.

use super::{MeasureError, check_values};
use crate::{
    math::{colour::luminance, frame::uniform_direction, random::Rng, relative::floor_of},
    scene::{accel::Ray, geometry::Surface, world::World},
};
use glam::Vec3;
use rayon::prelude::*;

/// Rays tried for each point that is wanted, before a scene counts as having no lit surface.
const MOST_TRIES: usize = 10_000;

/// Points on surfaces that can be seen: where random rays from random points of the scene's box end on a side that
/// light falls on; fewer than `count` where hardly any does.
pub fn points_on_surfaces(world: &World, count: usize, seed: u64) -> Vec<Surface> {
    let (low, high) = world.geometry.bounds();
    (0..count as u64)
        .into_par_iter()
        .filter_map(|i| {
            let mut rng = Rng::new(seed, i);
            (0..MOST_TRIES).find_map(|_| {
                let from = low + (high - low) * Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
                let direction = uniform_direction(rng.next_vec2());
                let hit = world.accel.trace(&Ray::new(from, direction))?;
                let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
                world.geometry.is_lit(&surface).then_some(surface)
            })
        })
        .collect()
}

/// Relative errors over a list of points, as fractions.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ErrorStatistics {
    /// Number of points.
    pub count: usize,
    /// Median of the magnitudes.
    pub median: f64,
    /// 95th percentile of the magnitudes.
    pub percentile_95: f64,
    /// Mean with sign: bias.
    pub mean_signed: f64,
    /// Largest magnitude.
    pub max: f64,
    /// Where it is.
    pub worst_index: usize,
}

/// Relative errors of illuminance, (E − E_ref) / max(E_ref, 5 % of the mean of E_ref), on luminance Y.
///
/// # Errors
/// [`MeasureError`] if the lists differ in length, are empty, or hold something not finite.
pub fn relative_errors(found: &[Vec3], reference: &[Vec3]) -> Result<ErrorStatistics, MeasureError> {
    check_values(found, reference)?;
    let wanted: Vec<f64> = reference.iter().map(|v| f64::from(luminance(*v))).collect();
    let count = wanted.len();
    let floor = floor_of(wanted.iter().sum::<f64>() / count as f64);
    let signed: Vec<f64> =
        found.iter().zip(&wanted).map(|(f, w)| (f64::from(luminance(*f)) - w) / w.max(floor)).collect();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| signed[a].abs().total_cmp(&signed[b].abs()));
    let quantile = |q: f64| {
        let place = q * (count - 1) as f64;
        let at = |i: usize| signed[order[i.min(count - 1)]].abs();
        let below = place.floor() as usize;
        at(below) + (at(below + 1) - at(below)) * place.fract()
    };
    Ok(ErrorStatistics {
        count,
        median: quantile(0.5),
        percentile_95: quantile(0.95),
        mean_signed: signed.iter().sum::<f64>() / count as f64,
        max: quantile(1.0),
        worst_index: order[count - 1],
    })
}
