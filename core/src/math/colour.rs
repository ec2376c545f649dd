//! Linear Rec. 709 photometric RGB: luminance, the sRGB transfer function and the display tone curve.

use glam::Vec3;

/// Luminance weights of linear Rec. 709: Y = 0.2126 R + 0.7152 G + 0.0722 B.
pub const LUMINANCE_WEIGHTS: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Luminous efficacy used by the radiometric display, in lm/W (1 W at 555 nm).
pub const LUMENS_PER_WATT: f32 = 683.0;

/// Luminance Y of a linear RGB value, in the value's own unit.
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(LUMINANCE_WEIGHTS)
}

/// What of an RGB value is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Channel {
    /// All three, as a colour.
    #[default]
    Rgb,
    /// Y = 0.2126 R + 0.7152 G + 0.0722 B.
    Luminance,
    /// Red alone.
    Red,
    /// Green alone.
    Green,
    /// Blue alone.
    Blue,
}

impl Channel {
    /// Every choice.
    pub const ALL: [Self; 5] = [Self::Rgb, Self::Luminance, Self::Red, Self::Green, Self::Blue];

    /// Name on screen and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rgb => "rgb",
            Self::Luminance => "luminance",
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
        }
    }

    /// One number for a value; luminance stands for all three.
    pub fn measure(self, rgb: Vec3) -> f32 {
        match self {
            Self::Rgb | Self::Luminance => luminance(rgb),
            Self::Red => rgb.x,
            Self::Green => rgb.y,
            Self::Blue => rgb.z,
        }
    }

    /// A value with nothing else in it: grey, but for [`Self::Rgb`].
    pub fn of(self, rgb: Vec3) -> Vec3 {
        if self == Self::Rgb { rgb } else { Vec3::splat(self.measure(rgb)) }
    }
}

/// sRGB opto-electronic transfer function of one channel in [0, 1] (IEC 61966-2-1).
pub fn srgb_from_linear(linear: f32) -> f32 {
    let v = linear.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(encoded: f32) -> f32 {
    let v = encoded.clamp(0.0, 1.0);
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Eight-bit sRGB of a linear value in [0, 1]; NaN and negative become 0.
pub fn srgb8(rgb: Vec3) -> [u8; 3] {
    rgb.to_array().map(|v| (srgb_from_linear(if v.is_nan() { 0.0 } else { v }) * 255.0 + 0.5) as u8)
}
