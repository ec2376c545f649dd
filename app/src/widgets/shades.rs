//! The light of the open spheres, and how its values become colours.

use super::{
    Probe,
    sphere_image::{SphereValues, key},
};
use glam::Vec3;
use lumenscope_core::{
    irradiance_volume::probe::Quantity,
    math::{
        colour::{Channel, srgb8},
        false_colour::FalseColour,
        part::Part,
        sphere_map::DirectionBins,
    },
    superposition::composite::{Display, ToneCurve},
};
use std::f32::consts::FRAC_1_PI;

/// One part of a probe's light.
pub(super) struct Light {
    bins: DirectionBins,
    radiance: Vec<Vec3>,
    irradiance: Vec<Vec3>,
    /// Changes when the values do.
    pub key: u64,
}

impl Light {
    pub fn new(probe: &Probe, part: Part) -> Option<Self> {
        let bins = probe.bins;
        let radiance = probe.values(Quantity::Radiance, part);
        let irradiance = probe.values(Quantity::Irradiance, part);
        if radiance.len() != bins.len() || irradiance.len() != bins.len() {
            return None;
        }
        let bits: Vec<[u32; 3]> =
            radiance.iter().chain(&irradiance).map(|v| v.to_array().map(f32::to_bits)).collect();
        Some(Self { bins, radiance, irradiance, key: key((bins.n(), bits)) })
    }

    pub fn radiance(&self) -> SphereValues<'_> {
        SphereValues { bins: self.bins, values: &self.radiance }
    }

    pub fn irradiance(&self) -> SphereValues<'_> {
        SphereValues { bins: self.bins, values: &self.irradiance }
    }
}

/// How values become colours.
pub(super) struct Shades {
    display: Display,
    channel: Channel,
    /// Palettes of radiance and irradiance, where false colour is on.
    pub palettes: Option<[FalseColour; 2]>,
}

impl Shades {
    pub fn new(light: &Light, false_colour: bool, channel: Channel) -> Self {
        let measure = |v: &Vec3| channel.measure(*v);
        let largest = |values: &[Vec3]| values.iter().map(measure).fold(0.0f32, f32::max).max(1e-6);
        let white = largest(&light.irradiance) * FRAC_1_PI * 1.6;
        let display = Display { ev100: (white / 1.2).log2(), tone: ToneCurve::Filmic, false_colour: None };
        let palette = |high: f32| FalseColour {
            palette: Default::default(),
            low: 0.0,
            high: if high > 0.0 { high } else { 1.0 },
            logarithmic: false,
        };
        let mut sorted: Vec<f32> = light.radiance.iter().map(measure).collect();
        sorted.sort_by(f32::total_cmp);
        // The lamps' own radiance is far above everything else: let them run off the end.
        let most = sorted.get(sorted.len() * 97 / 100).copied().unwrap_or(0.0) * 1.25;
        let high = if most > 0.0 { most } else { largest(&light.radiance) };
        let palettes = false_colour.then(|| [palette(high), palette(largest(&light.irradiance))]);
        Self { display, channel, palettes }
    }

    pub fn radiance(&self, value: Vec3) -> [u8; 3] {
        match &self.palettes {
            Some([palette, _]) => srgb8(palette.colour(self.channel.measure(value))),
            None => self.exposed(value),
        }
    }

    pub fn irradiance(&self, value: Vec3) -> [u8; 3] {
        match &self.palettes {
            Some([_, palette]) => srgb8(palette.colour(self.channel.measure(value))),
            None => self.exposed(value * FRAC_1_PI),
        }
    }

    fn exposed(&self, radiance: Vec3) -> [u8; 3] {
        let [r, g, b, _] = self.display.pixel(self.channel.of(radiance));
        [r, g, b]
    }
}
