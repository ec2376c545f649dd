//! The uplighter and the desk lamp, each one mesh so that it is dragged as one; origins at the foot.

use super::palette::Palette;
use crate::glb::{Material, Model, Parts};
use crate::shapes::{
    boxes::block,
    round::{bent, cylinder, fan, fan_area, lathe, rod, rounded, tube},
    v,
};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// Luminous flux of the uplighter, lm.
const UPLIGHTER_FLUX: f64 = 10_000.0;
/// Luminous flux of the desk lamp, lm.
const DESK_LAMP_FLUX: f64 = 600.0;
/// Triangles of an emissive disc.
pub const SIDES: u32 = 12;

/// Radiance of a disc that sends out `flux` lumens of a tint whose luminance is 1: L = Φ / (π A).
pub fn radiance(flux: f64, radius: f64, tint: [f64; 3]) -> [f64; 3] {
    let luminance = 0.2126 * tint[0] + 0.7152 * tint[1] + 0.0722 * tint[2];
    tint.map(|t| t / luminance * flux / (PI * fan_area(radius, SIDES)))
}

/// Floor lamp with a bowl that hides the lamp and lights the ceiling.
pub fn uplighter(model: &mut Model, palette: &Palette) -> usize {
    let radius = 0.172;
    let glow = model.material(Material::new("Halogen", [0.0; 3]).emitting(radiance(
        UPLIGHTER_FLUX,
        radius,
        [1.0, 0.86, 0.66],
    )));
    let mut parts = Parts::default();
    let foot = [[0.0, 0.002], [0.15, 0.002], [0.15, 0.018], [0.03, 0.03], [0.02, 0.05], [0.0, 0.05]];
    parts.add(palette.lacquer, lathe(&rounded(&foot, 0.008, 2, false), 28, false));
    parts.add(palette.lacquer, rod(v(0.0, 0.051, 0.0), v(0.0, 1.52, 0.0), 0.014, 14));
    // The bowl: outside up, over the rim, inside down to the axis.
    let bowl = [
        [0.0, 1.522],
        [0.05, 1.526],
        [0.11, 1.556],
        [0.165, 1.61],
        [0.205, 1.71],
        [0.198, 1.71],
        [0.157, 1.616],
        [0.105, 1.570],
        [0.05, 1.546],
        [0.0, 1.542],
    ];
    parts.add(palette.lacquer, lathe(&rounded(&bowl, 0.004, 2, false), 36, false));
    parts.add(glow, fan(v(0.0, 1.685, 0.0), DVec3::Y, radius, SIDES));
    // The diffuser stands high in the bowl: a bright inside would be a small, strong secondary source,
    // which a path tracer finds by chance alone.
    parts.add(palette.lacquer, cylinder(v(0.0, 1.672, 0.0), 0.173, 0.011, 28));
    model.mesh(parts)
}

/// Desk lamp with a jointed arm; the shade hangs 0.25 m before the foot along +x.
pub fn desk_lamp(model: &mut Model, palette: &Palette) -> usize {
    let radius = 0.060;
    let glow = model.material(Material::new("Bulb", [0.0; 3]).emitting(radiance(
        DESK_LAMP_FLUX,
        radius,
        [1.0, 0.80, 0.55],
    )));
    let cream = palette.lacquer;
    let mut parts = Parts::default();
    let foot = [[0.0, 0.001], [0.085, 0.001], [0.085, 0.014], [0.03, 0.024], [0.0, 0.024]];
    parts.add(cream, lathe(&rounded(&foot, 0.006, 2, false), 28, false));
    let arm = bent(
        &[
            v(0.0, 0.025, 0.0),
            v(0.0, 0.06, 0.0),
            v(-0.10, 0.27, 0.0),
            v(0.11, 0.46, 0.0),
            v(0.198, 0.402, 0.0),
        ],
        0.035,
        3,
    );
    parts.add(palette.steel, tube(&arm, &vec![0.0065; arm.len()], 8));
    parts.add(
        palette.steel,
        block(v(-0.083, 0.255, 0.0), v(0.012, 0.012, 0.03), 0.002).moved(v(0.0, -0.06, 0.024)),
    );
    // The shade, modelled about its axis with the mouth at height 0, then tilted and hung up.
    let shade = [
        [0.0, 0.105],
        [0.022, 0.105],
        [0.03, 0.075],
        [0.078, 0.0],
        [0.081, 0.0],
        [0.034, 0.080],
        [0.026, 0.111],
        [0.0, 0.111],
    ];
    let profile: Vec<_> = rounded(&shade, 0.008, 2, false);
    let tilt = DMat3::from_rotation_z(25f64.to_radians());
    let hang = v(0.25, 0.29, 0.0);
    parts.add(cream, lathe(&profile, 32, false).placed(tilt, hang));
    parts.add(glow, fan(v(0.0, 0.010, 0.0), DVec3::NEG_Y, radius, SIDES).placed(tilt, hang));
    parts.add(palette.stoneware, cylinder(v(0.0, 0.012, 0.0), 0.061, 0.005, 28).placed(tilt, hang));
    model.mesh(parts)
}
