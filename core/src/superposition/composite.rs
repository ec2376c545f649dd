//! From layers to display: weights, exposure, tone curve or false colour.

use crate::math::false_colour::FalseColour;

/// How the picture is brought to the display. Has a twin in `shaders/superposition/composite.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Display {
    /// Exposure value at ISO 100: a luminance of 1.2 · 2^EV cd/m² becomes display 1.
    pub ev100: f32,
    /// Curve from exposed radiance to display.
    pub tone: ToneCurve,
    /// Luminance as false colour instead of the picture; its range is in cd/m².
    pub false_colour: Option<FalseColour>,
}

/// Curve from exposed radiance to display.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ToneCurve {
    /// Clipped at 1.
    Linear,
    /// Narkowicz's fit of the ACES curve, a shoulder that keeps highlights.
    #[default]
    Filmic,
}

impl Default for Display {
    fn default() -> Self {
        Self { ev100: 7.0, tone: ToneCurve::Filmic, false_colour: None }
    }
}

/// How direct light is evaluated for each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum DirectQuality {
    /// Read from the radiosity elements: soft, and as fine as they are.
    Elements,
    /// Shadow rays at every pixel, this many an area emitter.
    PerPixel(u32),
}
