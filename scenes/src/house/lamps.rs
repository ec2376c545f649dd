//! Lamps of the house, each a disc of twelve triangles of a given flux in a body that hides it.

use super::palette::Palette;
use crate::glb::{Material, Model, Parts};
use crate::office::lamps::{SIDES, radiance};
use crate::shapes::{
    Shape,
    boxes::block,
    round::{bent, cylinder, fan, lathe, rod, rounded, superellipsoid, tube},
    v,
};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Tint of incandescent light, its luminance near 1.
const WARM: [f64; 3] = [1.0, 0.82, 0.58];

/// A lit disc.
fn glow(model: &mut Model, name: &'static str, flux: f64, radius: f64) -> usize {
    model.material(Material::new(name, [0.0; 3]).emitting(radiance(flux, radius, WARM)))
}

/// A bowl of plaster on three chains that lights the ceiling; the top of its rod at the origin.
pub fn pendant(model: &mut Model, palette: &Palette) -> usize {
    let radius = 0.20;
    let glow = glow(model, "Bowl light", 5_200.0, radius);
    let mut parts = Parts::default();
    let drop = 0.62;
    let bowl = [
        [0.0, 0.0],
        [0.012, 0.004],
        [0.02, 0.02],
        [0.09, 0.035],
        [0.17, 0.07],
        [0.225, 0.135],
        [0.235, 0.15],
        [0.226, 0.15],
        [0.215, 0.135],
        [0.165, 0.082],
        [0.09, 0.05],
        [0.0, 0.045],
    ];
    let bowl = lathe(&rounded(&bowl, 0.006, 2, false), 40, false);
    parts.add(palette.porcelain, bowl.moved(v(0.0, -drop - 0.15, 0.0)));
    parts.add(glow, fan(v(0.0, -drop - 0.022, 0.0), DVec3::Y, radius, SIDES));
    parts.add(palette.porcelain, cylinder(v(0.0, -drop - 0.036, 0.0), radius + 0.001, 0.012, 32));
    let rose = [[0.0, -0.04], [0.02, -0.04], [0.03, -0.02], [0.07, -0.012], [0.07, -0.002], [0.0, -0.002]];
    parts.add(palette.brass, lathe(&rounded(&rose, 0.005, 2, false), 24, false));
    for k in 0..3 {
        let (sin, cos) = (TAU * f64::from(k) / 3.0).sin_cos();
        let (low, high) = (v(0.231 * cos, 0.001 - drop, 0.231 * sin), v(0.012 * cos, -0.041, 0.012 * sin));
        parts.add(palette.brass, rod(low, high, 0.0025, 6));
    }
    model.mesh(parts)
}

/// A lamp with a turned foot and a shade open above and below; the disc under the shade's top shines down,
/// the shade is lit by it.
pub fn table_lamp(model: &mut Model, palette: &Palette, name: &'static str, body: usize, flux: f64) -> usize {
    let radius = 0.055;
    let glow = glow(model, name, flux, radius);
    let mut parts = Parts::default();
    let foot = [
        [0.0, 0.001],
        [0.075, 0.001],
        [0.075, 0.012],
        [0.045, 0.025],
        [0.028, 0.05],
        [0.05, 0.08],
        [0.072, 0.14],
        [0.062, 0.21],
        [0.028, 0.26],
        [0.020, 0.28],
        [0.028, 0.29],
        [0.014, 0.30],
        [0.0, 0.302],
    ];
    parts.add(body, lathe(&rounded(&foot, 0.008, 2, false), 32, false));
    parts.add(palette.brass, rod(v(0.0, 0.303, 0.0), v(0.0, 0.482, 0.0), 0.006, 10));
    parts.add(palette.shade, skirt(0.16, 0.10, 0.34, 0.55));
    parts.add(palette.porcelain, cylinder(v(0.0, 0.483, 0.0), radius + 0.001, 0.008, 24));
    parts.add(glow, fan(v(0.0, 0.481, 0.0), DVec3::NEG_Y, radius, SIDES));
    model.mesh(parts)
}

/// The sheet of a shade, pleated.
fn skirt(low_radius: f64, high_radius: f64, low: f64, high: f64) -> Shape {
    let mut shape = Shape::default();
    let around = 72u32;
    for (y, radius) in [(low, low_radius), (high, high_radius)] {
        for s in 0..around {
            let (sin, cos) = (TAU * f64::from(s) / f64::from(around)).sin_cos();
            let r = radius * if s % 2 == 0 { 1.0 } else { 0.975 };
            shape.vertex(v(r * cos, y, r * sin), v(cos, 0.0, sin));
        }
    }
    for s in 0..around {
        let (a, b) = (s, (s + 1) % around);
        shape.triangles.extend([[a, a + around, b + around], [a, b + around, b]]);
    }
    shape.smooth()
}

/// A floor lamp that lights the ceiling.
pub fn torchiere(model: &mut Model, palette: &Palette) -> usize {
    let radius = 0.15;
    let glow = glow(model, "Torchiere light", 6_500.0, radius);
    let mut parts = Parts::default();
    let foot =
        [[0.0, 0.002], [0.16, 0.002], [0.16, 0.02], [0.06, 0.045], [0.03, 0.09], [0.018, 0.12], [0.0, 0.12]];
    parts.add(palette.brass, lathe(&rounded(&foot, 0.01, 3, false), 32, false));
    parts.add(palette.brass, rod(v(0.0, 0.121, 0.0), v(0.0, 1.60, 0.0), 0.013, 16));
    for y in [0.45, 0.85, 1.25] {
        let ring = superellipsoid(v(0.024, 0.016, 0.024), DVec2::ONE, 18, 8);
        parts.add(palette.brass, ring.moved(v(0.0, y, 0.0)));
    }
    let bowl = [
        [0.0, 1.602],
        [0.04, 1.606],
        [0.10, 1.64],
        [0.165, 1.72],
        [0.185, 1.79],
        [0.176, 1.79],
        [0.155, 1.725],
        [0.095, 1.655],
        [0.0, 1.63],
    ];
    parts.add(palette.porcelain, lathe(&rounded(&bowl, 0.006, 2, false), 36, false));
    parts.add(glow, fan(v(0.0, 1.768, 0.0), DVec3::Y, radius, SIDES));
    parts.add(palette.porcelain, cylinder(v(0.0, 1.754, 0.0), radius + 0.001, 0.012, 28));
    model.mesh(parts)
}

/// A small lamp of brass that lights the music.
pub fn piano_lamp(model: &mut Model, palette: &Palette) -> usize {
    let radius = 0.045;
    let glow = glow(model, "Piano lamp light", 420.0, radius);
    let mut parts = Parts::default();
    parts.add(palette.brass, block(v(0.0, 0.001, 0.0), v(0.12, 0.02, 0.12), 0.006));
    let arm = bent(&[v(0.0, 0.022, 0.0), v(0.0, 0.33, 0.0), v(0.0, 0.40, 0.06), v(0.0, 0.38, 0.20)], 0.05, 5);
    parts.add(palette.brass, tube(&arm, &vec![0.007; arm.len()], 12));
    let hood = [[0.0, 0.05], [0.03, 0.046], [0.07, 0.0], [0.074, 0.0], [0.034, 0.052], [0.0, 0.057]];
    let hood = lathe(&rounded(&hood, 0.004, 2, false), 28, false);
    parts.add(palette.brass, hood.moved(v(0.0, 0.312, 0.20)));
    parts.add(palette.porcelain, cylinder(v(0.0, 0.334, 0.20), radius + 0.0005, 0.004, 24));
    parts.add(glow, fan(v(0.0, 0.333, 0.20), DVec3::NEG_Y, radius, SIDES));
    model.mesh(parts)
}
