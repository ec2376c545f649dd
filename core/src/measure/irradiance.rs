//! How far irradiances at a list of points are from their reference.

use super::{MeasureError, check_values};
use crate::math::{colour::luminance, relative::floor_of};
use glam::Vec3;

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
