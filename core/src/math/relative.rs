//! What errors are relative to: the value itself, but no less than a share of the mean, so that the error of a
//! dark place does not count for more than anyone sees of it.

/// Share of the mean below which a value no longer sets the scale of its error.
pub const FLOOR_SHARE: f64 = 0.05;

/// The least that errors are relative to where values have a mean, in their unit: 5 % of it, and more than 0.
pub fn floor_of(mean: f64) -> f64 {
    (FLOOR_SHARE * mean).max(f64::from(f32::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::floor_of;

    #[test]
    fn the_floor_is_a_share_of_the_mean_and_never_nothing() {
        // 5 % of 40 is 2, to the rounding of one product.
        assert!((floor_of(40.0) - 2.0).abs() < 1e-15);
        // In single precision too, where 0 / 0 would be no number.
        assert!(floor_of(0.0) as f32 > 0.0);
    }
}
