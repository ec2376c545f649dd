//! Whether two estimates differ by more than chance allows.
//!
//! A z-test per value, with Šidák's correction for their number and Student's t for standard errors
//! that come from few values: what Mitsuba's render tests do, plus the t.

use super::MeasureError;
use crate::reference::Estimate;

/// Outcome of comparing two lists of estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZTest {
    /// Largest |z| over all values and channels.
    pub worst: f64,
    /// Index of the value it belongs to.
    pub worst_index: usize,
    /// Mean of z over all: near 0 ± 1/√count when no factor is lost.
    pub mean: f64,
    /// Root mean square of z: near 1 when the standard errors are honest.
    pub rms: f64,
    /// |z| that chance alone exceeds, anywhere, with the probability asked for.
    pub critical: f64,
}

impl ZTest {
    /// Whether no value differs by more than chance allows.
    pub fn passes(&self) -> bool {
        self.worst <= self.critical
    }
}

/// Compares estimates with estimates: z = (a − b) / √(σₐ² + σᵦ²) per channel.
///
/// Differences within 1e-5 of the larger value are rounding in single precision and count as none.
///
/// # Errors
/// [`MeasureError`] if the lists differ in length, are empty, or hold something not finite.
pub fn z_test(found: &[Estimate], wanted: &[Estimate], false_alarm: f64) -> Result<ZTest, MeasureError> {
    let means = |list: &[Estimate]| list.iter().map(|e| e.mean).collect::<Vec<_>>();
    super::check_values(&means(found), &means(wanted))?;
    let (mut sum, mut squares) = (0.0, 0.0);
    let (mut worst, mut worst_index, mut freedom) = (0.0f64, 0, u32::MAX);
    for (index, (a, b)) in found.iter().zip(wanted).enumerate() {
        for e in [a, b] {
            if e.standard_error.max_element() > 0.0 {
                freedom = freedom.min(e.degrees_of_freedom);
            }
        }
        for c in 0..3 {
            let difference = f64::from(a.mean[c]) - f64::from(b.mean[c]);
            let error = f64::from(a.standard_error[c]).hypot(f64::from(b.standard_error[c]));
            let rounding = 1e-5 * f64::from(a.mean[c].abs().max(b.mean[c].abs()));
            let excess = (difference.abs() - rounding).max(0.0).copysign(difference);
            let z = if excess == 0.0 { 0.0 } else { excess / error };
            sum += z;
            squares += z * z;
            if z.is_nan() || z.abs() > worst {
                (worst, worst_index) = (if z.is_nan() { f64::INFINITY } else { z.abs() }, index);
            }
        }
    }
    let count = 3 * found.len();
    Ok(ZTest {
        worst,
        worst_index,
        mean: sum / count as f64,
        rms: (squares / count as f64).sqrt(),
        critical: critical_value(false_alarm, count, freedom),
    })
}

/// |z| that the largest of `count` independent values exceeds with probability `false_alarm`.
///
/// Each may alarm with 1 − (1 − α)^(1/count) (Šidák 1967). Student's t with `freedom` degrees of
/// freedom is taken from the normal quantile by its Cornish–Fisher series to 1/ν² (Abramowitz and
/// Stegun 26.7.5); `u32::MAX` means a known standard error.
pub fn critical_value(false_alarm: f64, count: usize, freedom: u32) -> f64 {
    let each = -((-false_alarm).ln_1p() / count.max(1) as f64).exp_m1();
    let z = normal_quantile(1.0 - 0.5 * each);
    let v = f64::from(freedom.max(1));
    z + (z.powi(3) + z) / (4.0 * v) + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * v * v)
}

/// Quantile of the standard normal distribution for a probability in (0, 1), to 1.2e-9 relative.
///
/// Acklam's rational approximation.
pub fn normal_quantile(probability: f64) -> f64 {
    const A: [f64; 6] = [
        -39.696_830_286_653_76,
        220.946_098_424_520_5,
        -275.928_510_446_968_7,
        138.357_751_867_269,
        -30.664_798_066_147_16,
        2.506_628_277_459_239,
    ];
    const B: [f64; 6] = [
        -54.476_098_798_224_06,
        161.585_836_858_040_9,
        -155.698_979_859_886_6,
        66.801_311_887_719_72,
        -13.280_681_552_885_72,
        1.0,
    ];
    const C: [f64; 6] = [
        -0.007_784_894_002_430_293,
        -0.322_396_458_041_136_5,
        -2.400_758_277_161_838,
        -2.549_732_539_343_734,
        4.374_664_141_464_968,
        2.938_163_982_698_783,
    ];
    const D: [f64; 5] = [
        0.007_784_695_709_041_462,
        0.322_467_129_070_039_8,
        2.445_134_137_142_996,
        3.754_408_661_907_416,
        1.0,
    ];
    let polynomial = |c: &[f64], x: f64| c.iter().fold(0.0, |sum, c| sum * x + c);
    let tail = |p: f64| {
        let q = (-2.0 * p.ln()).sqrt();
        polynomial(&C, q) / polynomial(&D, q)
    };
    let p = probability;
    if p < 0.024_25 {
        tail(p)
    } else if p > 1.0 - 0.024_25 {
        -tail(1.0 - p)
    } else {
        let q = p - 0.5;
        let r = q * q;
        q * polynomial(&A, r) / polynomial(&B, r)
    }
}
