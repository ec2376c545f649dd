//! Numbers as they are shown: three digits that mean something, and never without a unit.

use glam::Vec3;

/// Three significant digits, thousands apart, powers of ten only where nothing else fits.
pub fn short(value: f32) -> String {
    if !value.is_finite() {
        return "not a number".into();
    }
    let size = value.abs();
    if size == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e7).contains(&size) {
        return format!("{value:.2e}");
    }
    let decimals = (2 - size.log10().floor() as i32).clamp(0, 5) as usize;
    if decimals > 0 {
        return format!("{value:.decimals$}");
    }
    let step = 10f64.powi(size.log10().floor() as i32 - 2);
    let rounded = ((f64::from(value) / step).round() * step) as i64;
    grouped(rounded)
}

/// A value and its unit.
pub fn with_unit(value: f32, unit: &str) -> String {
    format!("{} {unit}", short(value))
}

/// Three numbers of one unit.
pub fn triple(value: Vec3) -> String {
    format!("{}, {}, {}", short(value.x), short(value.y), short(value.z))
}

/// A position or direction, three decimals.
pub fn point(value: Vec3) -> String {
    format!("{:.3}, {:.3}, {:.3}", value.x, value.y, value.z)
}

/// A legend's tick: as short as it can be.
pub fn tick(value: f32) -> String {
    let text = short(value);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

fn grouped(value: i64) -> String {
    let digits = value.unsigned_abs().to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    if value < 0 { format!("-{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_kept() {
        let cases = [
            (0.0, "0"),
            (0.012_34, "0.0123"),
            (1.234, "1.23"),
            (123.4, "123"),
            (4567.0, "4570"),
            (45_678.0, "45\u{a0}700"),
            (-12.0, "-12.0"),
            (1e-5, "1.00e-5"),
            (f32::NAN, "not a number"),
        ];
        for (value, text) in cases {
            assert_eq!(short(value), text);
        }
        assert_eq!(tick(0.5), "0.5");
        assert_eq!(tick(200.0), "200");
    }
}
