//! Smoothing of what the gather rays left rough, where the difference between neighbours is no more
//! than their noise.
//!
//! The rays of an element say how certain its irradiance is: the variance of the mean of the radiosities
//! they met. Neighbouring nodes of a grid are averaged with binomial weights over 5 × 5, each times
//! exp(−(Eᵢ − Eⱼ)² / (2 c² (σᵢ² + σⱼ²))): equal within their noise they count fully, further apart than a
//! few standard errors not at all, so contacts and shadow edges stay. This is the range filter of Tomasi
//! and Manduchi (1998) with a width that is measured, not chosen. In the office it does more than four
//! times the rays. Not more rays where it is rough: the noise falls with their root only.
//!
//! Limits: vertex elements are left as they are, a true difference below the noise is blurred, and the
//! light of two lamps together is the sum of their lights only to within the noise.

use super::{gather::Transport, surface_map::UNSOLVED};
use crate::math::colour::luminance;
use glam::Vec3;
use rayon::prelude::*;

/// Binomial weights at 0, 1 and 2 nodes of distance.
const BINOMIAL: [f32; 3] = [6.0, 4.0, 1.0];

/// Variance of the mean over each element's hits of the luminance of `values`, one value an element, and of what
/// arrives by way of lobes, each way of which is taken to be alone on its ray.
pub fn variances(transport: &Transport, values: &[Vec3]) -> Vec<f32> {
    let padded: Vec<f32> = values.iter().map(|v| luminance(*v)).chain(std::iter::once(0.0)).collect();
    let elements = (0..values.len()).into_par_iter().with_min_len(64);
    elements
        .map(|element| {
            let row = transport.row(element as u32);
            let n = row.len().max(1);
            let mean = row.iter().map(|&hit| padded[hit as usize]).sum::<f32>() / n as f32;
            let squares: f32 = row.iter().map(|&hit| (padded[hit as usize] - mean).powi(2)).sum();
            let seen = transport.seen.get(element).and_then(|s| s.as_deref());
            let by_lobes = seen.into_iter().flat_map(|s| &s.elements);
            let ways = by_lobes.map(|&(hit, share)| (padded[hit as usize] * luminance(share)).powi(2));
            (squares + ways.sum::<f32>()) / (n * n) as f32
        })
        .collect()
}

/// Irradiance with the noise of the gather rays averaged away on grids; see the module's text.
///
/// `irradiance` and `variances` have one entry an element, `width` is c in standard errors. Elements that
/// are not solved neither give nor take.
pub fn smooth(transport: &Transport, irradiance: &[Vec3], variances: &[f32], width: f32) -> Vec<Vec3> {
    let elements = &transport.map.elements;
    let level: Vec<f32> = irradiance.iter().map(|e| luminance(*e)).collect();
    let mut out = irradiance.to_vec();
    out.par_iter_mut().enumerate().with_min_len(256).for_each(|(i, out)| {
        let element = &elements[i];
        let Some(chart) = transport.map.charts.get(element.chart as usize) else { return };
        if element.flags & UNSOLVED != 0 {
            return;
        }
        let (nx, ny) = (chart.nx as usize, chart.ny as usize);
        let local = i - chart.first_element as usize;
        let (x, y) = (local % nx, local / nx);
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        let [du, dv] = transport.map.stride(element.chart as usize, i);
        let around = |at: usize, step: usize, count: usize| {
            (0..5)
                .filter_map(move |k| Some((k, (at + k * step).checked_sub(2 * step).filter(|p| *p < count)?)))
        };
        for (b, v) in around(y, dv, ny) {
            for (a, u) in around(x, du, nx) {
                let j = chart.first_element as usize + v * nx + u;
                if elements[j].flags & UNSOLVED != 0 {
                    continue;
                }
                let difference = level[i] - level[j];
                let noise = 2.0 * width * width * (variances[i] + variances[j]);
                let likeness = if i == j || noise == 0.0 {
                    f32::from(difference == 0.0)
                } else {
                    (-difference * difference / noise).exp()
                };
                let weight = BINOMIAL[a.abs_diff(2)] * BINOMIAL[b.abs_diff(2)] * likeness;
                sum += irradiance[j] * weight;
                total += weight;
            }
        }
        *out = sum / total;
    });
    out
}
