//! Sweeps: from direct light and cached transport to all the light.
//!
//! The unknown is the indirect irradiance x of every element, the fixed point of
//! `x = S + T ρ (D + x)` with T the cached transport, ρ the reflectances, D the direct irradiance and S what
//! arrives from emitters by way of specular lobes alone
//! (the dissertation's Eq. 5.2 times π, gathered). Plain (Jacobi) sweeps gain only a factor ρ each:
//! at ρ = 0.999 that is thousands. Each sweep therefore feeds Anderson's mixing (Walker and Ni 2011):
//! the next x is the combination of the last sweeps with the smallest residual, per channel, which on
//! this linear problem is GMRES and contains as its simplest case the scale factor that balances
//! emitted against absorbed energy. A furnace converges in three sweeps at any reflectance. Not
//! Gauss–Seidel: its order cannot be run in parallel and stay the same at any thread count.
//!
//! Converged means that the *error* is below tolerance, not the last change: the mean residual
//! divided by 1 − ‖Tρ‖∞, the bound of the geometric series that is still to come.

use super::gather::Transport;
use crate::math::progress::{Cancelled, Progress};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Sweeps kept for mixing.
const DEPTH: usize = 4;
/// Elements summed in one go; fixed, so that sums do not depend on the thread count.
const CHUNK: usize = 4096;

/// How a solve went.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Convergence {
    /// Sweeps done.
    pub sweeps: u32,
    /// Mean change of the last sweep, relative to the mean irradiance.
    pub residual: f32,
    /// Bound of the mean error, relative to the mean irradiance.
    pub error_bound: f32,
    /// Whether the bound is below tolerance; never with a NaN in the solution.
    pub converged: bool,
}

/// What arrives from emitters at each element without a diffuse bounce, lx per channel.
#[derive(Clone, Copy)]
pub(super) struct Light<'a> {
    /// Straight.
    pub direct: &'a [Vec3],
    /// By way of specular lobes.
    pub passed_on: &'a [Vec3],
}

/// Indirect irradiance from direct, starting at `start`; see the module's text.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn indirect(
    transport: &Transport,
    Light { direct, passed_on }: Light,
    start: &[Vec3],
    tolerance: f32,
    max_sweeps: u32,
    progress: &Progress,
) -> Result<(Vec<Vec3>, Convergence), Cancelled> {
    let elements = &transport.map.elements;
    let weights: Vec<f32> = elements.iter().map(|e| e.area).collect();
    let amplification = (Vec3::ONE / (Vec3::ONE - transport.norm.min(Vec3::splat(0.9999)))).as_dvec3();
    let mut x = start.to_vec();
    let mut mixing = Mixing::default();
    let mut convergence = Convergence::default();
    let mut first_error = None;
    loop {
        let radiosity: Vec<Vec3> = elements
            .par_iter()
            .zip(direct.par_iter().zip(&x))
            .map(|(e, (d, x))| e.reflectance * (*d + *x))
            .collect();
        let mut g = transport.gather(&radiosity);
        g.par_iter_mut().zip(passed_on).for_each(|(g, p)| *g += *p);
        let f: Vec<Vec3> = g.par_iter().zip(&x).map(|(g, x)| *g - *x).collect();
        convergence.sweeps += 1;
        let mean = weighted_sum(&weights, |i| direct[i].as_dvec3() + g[i].as_dvec3().abs());
        let change = weighted_sum(&weights, |i| f[i].as_dvec3().abs());
        let scale = mean.max_element();
        // Where there is no light there is nothing to converge; NaN fails every comparison.
        let relative = |v: DVec3| if scale > 0.0 { v.max_element() / scale } else { v.max_element() };
        convergence.residual = relative(change) as f32;
        convergence.error_bound = relative(change * amplification) as f32;
        let finite = mean.is_finite() && change.is_finite();
        convergence.converged = finite && convergence.error_bound <= tolerance;
        let first = *first_error.get_or_insert(convergence.error_bound.max(tolerance));
        let done = (first / convergence.error_bound.max(f32::MIN_POSITIVE)).ln() / (first / tolerance).ln();
        progress.report(done.max(0.0))?;
        if convergence.converged || !finite || convergence.sweeps >= max_sweeps {
            return Ok((g, convergence));
        }
        x = mixing.next(&weights, f, g);
    }
}

/// The last sweeps, as differences.
#[derive(Default)]
struct Mixing {
    last: Option<(Vec<Vec3>, Vec<Vec3>)>,
    residual_steps: Vec<Vec<Vec3>>,
    value_steps: Vec<Vec<Vec3>>,
}

impl Mixing {
    /// The next unknown from residual `f` and value `g` of the last sweep.
    fn next(&mut self, weights: &[f32], f: Vec<Vec3>, g: Vec<Vec3>) -> Vec<Vec3> {
        if let Some((f_last, g_last)) = &self.last {
            if self.residual_steps.len() == DEPTH {
                self.residual_steps.remove(0);
                self.value_steps.remove(0);
            }
            self.residual_steps.push(f.iter().zip(f_last).map(|(a, b)| *a - *b).collect());
            self.value_steps.push(g.iter().zip(g_last).map(|(a, b)| *a - *b).collect());
        }
        let n = self.residual_steps.len();
        let mut matrix = [[DVec3::ZERO; DEPTH]; DEPTH];
        let mut right = [DVec3::ZERO; DEPTH];
        for i in 0..n {
            let a = &self.residual_steps[i];
            for (j, b) in self.residual_steps.iter().enumerate().take(i + 1) {
                matrix[i][j] = weighted_sum(weights, |k| a[k].as_dvec3() * b[k].as_dvec3());
                matrix[j][i] = matrix[i][j];
            }
            right[i] = weighted_sum(weights, |k| a[k].as_dvec3() * f[k].as_dvec3());
        }
        let channels =
            [0, 1, 2].map(|c| least_squares(n, |i, j| matrix[i][j][c], |i| right[i][c]).map(|v| v as f32));
        let gamma: [Vec3; DEPTH] =
            std::array::from_fn(|i| Vec3::new(channels[0][i], channels[1][i], channels[2][i]));
        let next = (0..g.len())
            .into_par_iter()
            .with_min_len(1024)
            .map(|k| {
                let mixed = (0..n).fold(g[k], |sum, i| sum - gamma[i] * self.value_steps[i][k]);
                mixed.max(Vec3::ZERO)
            })
            .collect();
        self.last = Some((f, g));
        next
    }
}

/// Solves a small symmetric system, lightly regularised; zeros where it is singular.
fn least_squares(
    n: usize,
    matrix: impl Fn(usize, usize) -> f64,
    right: impl Fn(usize) -> f64,
) -> [f64; DEPTH] {
    let mut lower = [[0.0f64; DEPTH]; DEPTH];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let value = matrix(i, j) - sum;
            if i == j {
                let pivot = value + 1e-12 * matrix(i, i);
                if pivot.is_nan() || pivot <= 0.0 {
                    return [0.0; DEPTH];
                }
                lower[i][i] = pivot.sqrt();
            } else {
                lower[i][j] = value / lower[j][j];
            }
        }
    }
    let mut y = [0.0; DEPTH];
    for i in 0..n {
        let sum: f64 = (0..i).map(|k| lower[i][k] * y[k]).sum();
        y[i] = (right(i) - sum) / lower[i][i];
    }
    let mut x = [0.0; DEPTH];
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| lower[k][i] * x[k]).sum();
        x[i] = (y[i] - sum) / lower[i][i];
    }
    if x.iter().all(|v| v.is_finite()) { x } else { [0.0; DEPTH] }
}

/// Σ w v in a fixed order, in parallel.
pub(super) fn weighted_sum(weights: &[f32], value: impl Fn(usize) -> DVec3 + Sync) -> DVec3 {
    let parts: Vec<DVec3> = (0..weights.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(weights.len());
            range.fold(DVec3::ZERO, |sum, i| sum + value(i) * f64::from(weights[i]))
        })
        .collect();
    parts.into_iter().fold(DVec3::ZERO, |sum, part| sum + part)
}
