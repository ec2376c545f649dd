//! How the values of a view become colours: palette, range and scale, chosen or found in the values.

use super::InspectionScene;
use crate::math::{
    colour::luminance,
    false_colour::{FalseColour, Palette},
};
use serde::{Deserialize, Serialize};

/// How values become colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ColourSettings {
    /// Palette; signed quantities and kinds have their own.
    pub palette: Palette,
    /// Range of the colours.
    pub range: ColourRange,
    /// Steps along it.
    pub scale: ColourScale,
}

/// Range of the colours; beyond it the first and the last go on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum ColourRange {
    /// The view's own.
    #[default]
    Automatic,
    /// Between two percentiles of the values shown, from 0 to 100.
    Percentiles([f32; 2]),
    /// From here to there, in the legend's unit.
    Given([f32; 2]),
}

/// Steps along the palette.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ColourScale {
    /// Equal ratios where the values spread over more than a decade around their median, else equal steps.
    #[default]
    Automatic,
    /// Equal steps.
    Linear,
    /// Equal ratios; for signed quantities equal steps all the same.
    Logarithmic,
}

impl ColourSettings {
    /// Whether a range could be drawn with: finite and not upside down.
    pub fn is_usable(&self) -> bool {
        match self.range {
            ColourRange::Automatic => true,
            ColourRange::Percentiles([low, high]) => 0.0 <= low && low < high && high <= 100.0,
            ColourRange::Given([low, high]) => low.is_finite() && high.is_finite() && low < high,
        }
    }
}

/// Values that percentiles and medians are taken of, at most.
const LOOKED_AT: usize = 1 << 16;

impl InspectionScene {
    /// Palette and range of its values, in its legend's unit.
    ///
    /// Signed quantities diverge from zero. By themselves, values above ten times their median are shown by their
    /// logarithm, from a tenth of the median on.
    pub fn colours(&self, settings: &ColourSettings) -> FalseColour {
        let Some(legend) = &self.legend else { return FalseColour::over([0.0, 1.0], settings.palette) };
        if !legend.names.is_empty() {
            return FalseColour::of_kinds();
        }
        let [low, high] = match settings.range {
            ColourRange::Automatic => legend.range,
            ColourRange::Given(range) => range,
            ColourRange::Percentiles([low, high]) if legend.range[0] < 0.0 => {
                let sizes = self.sorted_values(f32::abs);
                let most = percentile(&sizes, high.max(100.0 - low));
                [-most, most]
            }
            ColourRange::Percentiles(range) => {
                let values = self.sorted_values(|v| v);
                range.map(|p| percentile(&values, p))
            }
        };
        let high = if high > low { high } else { low + 1.0 };
        if low < 0.0 {
            return FalseColour::over([low, high], settings.palette);
        }
        let found = settings.range == ColourRange::Automatic;
        let linear = match settings.palette {
            // Black is black: the low end of what there is would be lost in it.
            Palette::Natural if found => FalseColour::over([0.0, high], Palette::Natural),
            palette => FalseColour::over([low, high], palette),
        };
        match settings.scale {
            ColourScale::Linear => linear,
            ColourScale::Automatic if !found || settings.palette == Palette::Natural => linear,
            ColourScale::Automatic | ColourScale::Logarithmic => {
                let values = self.sorted_values(|v| if v > 0.0 { v } else { f32::NAN });
                let median = percentile(&values, 50.0);
                let asked = settings.scale == ColourScale::Logarithmic;
                if median > 0.0 && (asked || high > 10.0 * median) {
                    let bottom = if found { (0.1 * median).max(low) } else { low };
                    let low = bottom.max(1e-4 * high);
                    FalseColour { low, high, logarithmic: true, ..linear }
                } else {
                    linear
                }
            }
        }
    }

    /// Luminances of the values shown, at most some ten thousand of them, passed through `map` and in order;
    /// without what is not a number.
    fn sorted_values(&self, map: impl Fn(f32) -> f32) -> Vec<f32> {
        let vertices = self.meshes.iter().flat_map(|m| m.triangles.iter().map(|t| &m.values[t[0] as usize]));
        let lines = self.value_lines.iter().map(|l| l.value);
        let all =
            || self.sphere_bins.iter().chain(vertices.clone()).map(|v| luminance(*v)).chain(lines.clone());
        let stride = all().count().div_ceil(LOOKED_AT).max(1);
        let mut values: Vec<f32> = all().step_by(stride).map(map).filter(|v| v.is_finite()).collect();
        values.sort_by(f32::total_cmp);
        values
    }
}

/// The value below which `percent` of sorted values lie; 0 of none.
fn percentile(sorted: &[f32], percent: f32) -> f32 {
    let last = sorted.len().saturating_sub(1);
    let place = (last as f32 * percent / 100.0).round() as usize;
    sorted.get(place.min(last)).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspection::{Legend, ValueLine};
    use glam::Vec3;

    fn of_values(values: impl Iterator<Item = f32>, range: [f32; 2]) -> InspectionScene {
        InspectionScene {
            value_lines: values
                .map(|value| ValueLine { ends: [Vec3::ZERO; 2], value, transparency: 0.0 })
                .collect(),
            legend: Some(Legend { quantity: "irradiance".into(), unit: "lx".into(), range, names: &[] }),
            ..InspectionScene::default()
        }
    }

    #[test]
    fn a_range_is_found_given_or_taken_from_percentiles() {
        let scene = of_values((0..=100).map(|i| i as f32), [0.0, 100.0]);
        let range = |range| {
            let colours = scene.colours(&ColourSettings { range, ..ColourSettings::default() });
            [colours.low, colours.high]
        };
        assert_eq!(range(ColourRange::Automatic), [0.0, 100.0]);
        assert_eq!(range(ColourRange::Given([5.0, 7.0])), [5.0, 7.0]);
        assert_eq!(range(ColourRange::Percentiles([2.0, 98.0])), [2.0, 98.0]);
    }

    #[test]
    fn signed_quantities_diverge_about_zero() {
        let scene = of_values((-10..=50).map(|i| i as f32), [-50.0, 50.0]);
        let settings =
            ColourSettings { range: ColourRange::Percentiles([0.0, 100.0]), ..ColourSettings::default() };
        let colours = scene.colours(&settings);
        assert_eq!((colours.palette, colours.low, colours.high), (Palette::Diverging, -50.0, 50.0));
    }

    #[test]
    fn a_few_bright_values_are_shown_by_their_logarithm_unless_otherwise_asked() {
        let scene = of_values((0..1000).map(|i| if i < 990 { 1.0 } else { 500.0 }), [0.0, 500.0]);
        let scale = |scale| scene.colours(&ColourSettings { scale, ..ColourSettings::default() }).logarithmic;
        assert!(scale(ColourScale::Automatic) && scale(ColourScale::Logarithmic));
        assert!(!scale(ColourScale::Linear));
    }

    #[test]
    fn true_colour_keeps_hue_and_kinds_keep_theirs() {
        let scene = of_values((0..=10).map(|i| i as f32), [1.0, 10.0]);
        let colours =
            scene.colours(&ColourSettings { palette: Palette::Natural, ..ColourSettings::default() });
        // Single precision.
        let off = colours.colour_of(Vec3::new(5.0, 10.0, 20.0)) - Vec3::new(0.5, 1.0, 1.0);
        assert!(off.abs().max_element() < 1e-6, "{off}");
        let mut kinds = scene;
        if let Some(legend) = &mut kinds.legend {
            legend.names = &["valid", "masked"];
        }
        let colours = kinds.colours(&ColourSettings::default());
        for kind in 0..8 {
            let table = Palette::Kinds.table();
            assert_eq!(colours.colour(kind as f32), table[(kind * 255 + 3) / 7], "kind {kind}");
        }
    }
}
