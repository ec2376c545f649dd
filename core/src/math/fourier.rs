//! Fourier transforms of planes of numbers.

use rayon::prelude::*;
use rustfft::{FftPlanner, num_complex::Complex};

/// Two-dimensional transform of a row-major plane in place, rows then columns; forward as it is, the inverse
/// divided by the number of elements.
///
/// Bastos 1999 has 1/N in both of Eq. 2.18 and 2.19; it belongs to one of them.
///
/// # Panics
/// If the plane does not have `width` times `height` elements.
pub fn transform(plane: &mut [Complex<f64>], width: usize, height: usize, forward: bool) {
    assert_eq!(plane.len(), width * height, "elements of a plane");
    if plane.is_empty() {
        return;
    }
    let mut planner = FftPlanner::new();
    let mut plan = |n: usize| if forward { planner.plan_fft_forward(n) } else { planner.plan_fft_inverse(n) };
    let (rows, columns) = (plan(width), plan(height));
    plane.par_chunks_mut(width).for_each(|row| rows.process(row));
    let mut turned = vec![Complex::default(); plane.len()];
    turned.par_chunks_mut(height).enumerate().for_each(|(x, column)| {
        for (y, value) in column.iter_mut().enumerate() {
            *value = plane[y * width + x];
        }
        columns.process(column);
    });
    let scale = if forward { 1.0 } else { 1.0 / (width * height) as f64 };
    plane.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, value) in row.iter_mut().enumerate() {
            *value = turned[x * height + y] * scale;
        }
    });
}
