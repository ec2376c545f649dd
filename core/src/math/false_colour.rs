//! False colour: from a quantity to a perceptually even palette, with round numbers for its legend.

use super::colour::{linear_from_srgb, luminance};
use glam::Vec3;

/// The palettes offered; all but `Turbo` are perceptually even.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Palette {
    /// Dark blue to yellow; the default.
    #[default]
    Viridis,
    /// Black over red to pale yellow.
    Inferno,
    /// Blue over green to red; most hues, for reading values off.
    Turbo,
    /// Blue over white to red: for signed quantities, white at zero.
    Diverging,
    /// The value's own colour, white at the high end: for light as the eye would see it.
    Natural,
    /// [`KINDS`] colours that are told apart, whole numbers from 0 on: for values that are kinds and not amounts.
    Kinds,
}

/// Colours of [`Palette::Kinds`]: grey, then those of Okabe and Ito (2008), told apart by colour-blind eyes too.
pub const KINDS: usize = 8;

const KIND_COLOURS: [[u8; 3]; KINDS] = [
    [150, 150, 150],
    [86, 180, 233],
    [230, 159, 0],
    [213, 40, 60],
    [0, 158, 115],
    [240, 228, 66],
    [204, 121, 167],
    [0, 114, 178],
];

/// A palette stretched over a range, linear or logarithmic.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FalseColour {
    /// Palette in use.
    pub palette: Palette,
    /// Value at the dark end, in the quantity's unit.
    pub low: f32,
    /// Value at the bright end, in the quantity's unit.
    pub high: f32,
    /// Whether equal steps along the palette are equal ratios.
    pub logarithmic: bool,
}

impl FalseColour {
    /// Linear over a range; where the range goes below zero, diverging and as far below as above.
    pub fn over([low, high]: [f32; 2], palette: Palette) -> Self {
        if low < 0.0 {
            let most = high.abs().max(-low);
            return Self { palette: Palette::Diverging, low: -most, high: most, logarithmic: false };
        }
        Self { palette, low, high, logarithmic: false }
    }

    /// Place of `value` along the palette in [0, 1]; NaN gives 0.
    pub fn position(&self, value: f32) -> f32 {
        let t = if self.logarithmic {
            let low = self.low.max(self.high * 1e-6).max(f32::MIN_POSITIVE);
            (value.max(low) / low).ln() / (self.high / low).ln().max(1e-6)
        } else {
            (value - self.low) / (self.high - self.low).max(f32::MIN_POSITIVE)
        };
        if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) }
    }

    /// For kinds, whole numbers from 0 on.
    pub fn of_kinds() -> Self {
        Self { palette: Palette::Kinds, low: 0.0, high: (KINDS - 1) as f32, logarithmic: false }
    }

    /// Linear RGB colour of `value`.
    pub fn colour(&self, value: f32) -> Vec3 {
        self.palette.colour(self.position(value))
    }

    /// Linear RGB colour of a value of three channels: of its luminance, but for [`Palette::Natural`], which
    /// scales every channel by itself.
    pub fn colour_of(&self, value: Vec3) -> Vec3 {
        match self.palette {
            Palette::Natural => Vec3::from(value.to_array().map(|channel| self.position(channel))),
            _ => self.colour(luminance(value)),
        }
    }

    /// At most `count` + 2 round values (1, 2 or 5 times a power of ten) inside the range, for a legend.
    pub fn ticks(&self, count: usize) -> Vec<f32> {
        let (low, high) = (self.low as f64, self.high as f64);
        if high.is_nan() || low.is_nan() || high <= low || count == 0 {
            return vec![self.low];
        }
        if self.logarithmic {
            let low = low.max(high * 1e-6);
            let mut decade = 10f64.powf(low.log10().floor());
            let mut ticks = Vec::new();
            while decade <= high {
                ticks.extend(
                    [1.0, 2.0, 5.0]
                        .map(|m| m * decade)
                        .iter()
                        .filter(|v| (low..=high).contains(v))
                        .map(|v| *v as f32),
                );
                decade *= 10.0;
            }
            let stride = ticks.len().div_ceil(count.max(1)).max(1);
            return ticks.into_iter().step_by(stride).collect();
        }
        let raw = (high - low) / count as f64;
        let magnitude = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * magnitude)
            .into_iter()
            .find(|s| *s >= raw * 0.999)
            .unwrap_or(raw);
        let first = (low / step).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        (first..=last).map(|i| (i as f64 * step) as f32).collect()
    }
}

impl Palette {
    /// Linear RGB at `t` in [0, 1].
    pub fn colour(self, t: f32) -> Vec3 {
        let table = self.table();
        let x = t.clamp(0.0, 1.0) * (table.len() - 1) as f32;
        let i = (x as usize).min(table.len() - 2);
        table[i].lerp(table[i + 1], x - i as f32)
    }

    /// The palette as 256 linear RGB entries: what the GPU twin uploads.
    pub fn table(self) -> &'static [Vec3; 256] {
        use colorgrad::Gradient;
        use std::sync::OnceLock;
        static TABLES: [OnceLock<[Vec3; 256]>; 6] = [const { OnceLock::new() }; 6];
        TABLES[self as usize].get_or_init(|| {
            let encoded = |c: colorgrad::Color| Vec3::new(c.r, c.g, c.b).map(linear_from_srgb);
            let at = |t: f32| match self {
                Self::Viridis => encoded(colorgrad::preset::viridis().at(t)),
                Self::Inferno => encoded(colorgrad::preset::inferno().at(t)),
                Self::Turbo => encoded(colorgrad::preset::turbo().at(t)),
                Self::Diverging => encoded(colorgrad::preset::rd_bu().at(1.0 - t)),
                Self::Natural => Vec3::splat(t),
                Self::Kinds => {
                    let kind = KIND_COLOURS[(t * (KINDS - 1) as f32).round() as usize];
                    Vec3::from(kind.map(|c| linear_from_srgb(f32::from(c) / 255.0)))
                }
            };
            std::array::from_fn(|i| at(i as f32 / 255.0))
        })
    }
}
