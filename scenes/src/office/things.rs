//! Things on desks and floor: monitor, keyboard, mouse, mug, papers, plant, basket, cabinet, clock.

use super::palette::Palette;
use crate::glb::Parts;
use crate::random::Random;
use crate::shapes::{
    Shape,
    boxes::{bevelled, block, cuboid, quad},
    round::{bent, cylinder, fan, lathe, rod, rounded, superellipsoid, tube},
    v,
};
use glam::{DMat3, DVec2};
use std::f64::consts::TAU;

/// A monitor that faces +z; origin at its foot.
pub fn monitor(palette: &Palette) -> Parts {
    let mut parts = Parts::default();
    let (w, low, high, z) = (0.285, 0.12, 0.455, 0.02);
    parts.add(palette.plastic, bevelled(v(-w, low, z - 0.03), v(w, high, z), 0.006));
    let (sw, edge, front) = (w - 0.012, 0.012, z + 0.002);
    let face = [
        v(-sw, low + 0.02, front),
        v(sw, low + 0.02, front),
        v(sw, high - edge, front),
        v(-sw, high - edge, front),
    ];
    parts.add(palette.screen, quad(face, DVec2::ONE));
    parts.add(palette.steel, bevelled(v(-0.03, 0.014, z - 0.055), v(0.03, 0.30, z - 0.032), 0.006));
    let foot = [[0.0, 0.001], [0.12, 0.001], [0.12, 0.009], [0.0, 0.0125]];
    let foot = lathe(&rounded(&foot, 0.004, 1, false), 28, false);
    parts.add(palette.steel, foot);
    parts
}

/// A keyboard whose user sits at +z.
pub fn keyboard(palette: &Palette) -> Parts {
    let mut parts = Parts::default();
    parts.add(palette.plastic, bevelled(v(-0.215, 0.001, -0.07), v(0.215, 0.014, 0.07), 0.004));
    let pitch = 0.0275;
    let mut key = |column: f64, row: i32, width: f64| {
        let (x, z) = (-0.206 + column * pitch, -0.058 + f64::from(row) * 0.0245);
        let high = v(x + width * pitch - 0.004, 0.020, z + 0.0205);
        parts.add(palette.keys, cuboid(v(x, 0.0145, z), high));
    };
    for row in 0..4 {
        for column in 0..10 {
            key(1.5 * f64::from(column), row, 1.5);
        }
    }
    for (column, width) in
        [(0.0, 1.5), (1.5, 1.5), (3.0, 1.0), (4.0, 6.0), (10.0, 1.0), (11.0, 2.0), (13.0, 2.0)]
    {
        key(column, 4, width);
    }
    parts
}

/// A mouse.
pub fn mouse(palette: &Palette) -> Parts {
    let body = superellipsoid(v(0.031, 0.017, 0.055), DVec2::new(0.8, 0.8), 14, 7);
    Parts::of(palette.plastic, body.moved(v(0.0, 0.018, 0.0)))
}

/// A mug with a handle and coffee.
pub fn mug(palette: &Palette, glaze: usize) -> Parts {
    let mut parts = Parts::default();
    let body = [
        [0.0, 0.001],
        [0.034, 0.001],
        [0.041, 0.012],
        [0.041, 0.095],
        [0.037, 0.095],
        [0.037, 0.014],
        [0.030, 0.006],
        [0.0, 0.006],
    ];
    parts.add(glaze, lathe(&rounded(&body, 0.004, 1, false), 24, false));
    parts.add(palette.earth, fan(v(0.0, 0.078, 0.0), glam::DVec3::Y, 0.0365, 16));
    let handle = bent(
        &[v(0.042, 0.078, 0.0), v(0.075, 0.078, 0.0), v(0.072, 0.026, 0.0), v(0.042, 0.024, 0.0)],
        0.022,
        3,
    );
    parts.add(glaze, tube(&handle, &vec![0.0058; handle.len()], 7));
    parts
}

/// A pile of papers, each a little turned, with a pencil on top.
pub fn papers(palette: &Palette) -> Parts {
    let mut parts = Parts::default();
    for (i, turn) in [4.0, -3.0, 9.0].into_iter().enumerate() {
        let y = 0.001 + 0.004 * i as f64;
        let sheet = bevelled(v(-0.105, 0.0, -0.148), v(0.105, 0.003, 0.148), 0.0005);
        parts.add(palette.paper, sheet.turned_y(turn).moved(v(0.0, y, 0.0)));
    }
    parts.add(palette.dividers[1], rod(v(-0.06, 0.017, 0.03), v(0.07, 0.017, -0.05), 0.0037, 6));
    parts
}

/// A cup of pencils.
pub fn pencils(palette: &Palette) -> Parts {
    let mut parts = Parts::default();
    let cup = [[0.0, 0.001], [0.036, 0.001], [0.036, 0.10], [0.033, 0.10], [0.033, 0.005], [0.0, 0.005]];
    parts.add(palette.steel, lathe(&rounded(&cup, 0.003, 1, false), 20, false));
    for (i, colour) in [0usize, 2, 1, 3].into_iter().enumerate() {
        let (sin, cos) = (TAU * (i as f64 + 0.3) / 4.0).sin_cos();
        let foot = v(0.013 * cos, 0.007, 0.013 * sin);
        let tip = v(0.024 * cos, 0.155 + 0.008 * i as f64, 0.024 * sin);
        parts.add(palette.dividers[colour], rod(foot, tip, 0.0036, 6));
    }
    parts
}

/// A potted plant with arching leaves; `scale` 1 is 0.9 m high.
pub fn plant([clay, soil, foliage]: [usize; 3], leaves: u32, scale: f64, seed: u64) -> Parts {
    let mut parts = Parts::default();
    let pot = [
        [0.0, 0.002],
        [0.12, 0.002],
        [0.165, 0.29],
        [0.175, 0.30],
        [0.175, 0.325],
        [0.15, 0.325],
        [0.148, 0.28],
        [0.0, 0.28],
    ];
    let profile: Vec<_> = rounded(&pot, 0.012, 2, false).into_iter().map(|p| p * scale).collect();
    parts.add(clay, lathe(&profile, 30, false));
    let earth = [[0.0, 0.282], [0.144, 0.282], [0.10, 0.30], [0.0, 0.305]];
    let profile: Vec<_> = rounded(&earth, 0.01, 1, false).into_iter().map(|p| p * scale).collect();
    parts.add(soil, lathe(&profile, 24, false));
    let mut random = Random::new(seed);
    for i in 0..leaves {
        // Golden-angle spread; the outer leaves arch further.
        let turn = DMat3::from_rotation_y(2.399_963 * f64::from(i));
        let t = f64::from(i) / f64::from(leaves);
        let (rise, reach) =
            (0.62 - 0.30 * t + random.between(-0.04, 0.04), 0.08 + 0.36 * t + random.between(-0.03, 0.03));
        let width = random.between(0.032, 0.05);
        let foot = 0.02 + 0.08 * t;
        parts.add(foliage, leaf(scale, foot, rise, reach, width).placed(turn, v(0.0, 0.308 * scale, 0.0)));
    }
    parts
}

/// A strip along a parabola in the xy-plane, folded a little along its middle.
fn leaf(scale: f64, foot: f64, rise: f64, reach: f64, width: f64) -> Shape {
    let mut shape = Shape::default();
    let steps = 6u32;
    for i in 0..=steps {
        let t = f64::from(i) / f64::from(steps);
        let middle = v(foot + reach * t * t.sqrt(), rise * (1.75 * t - 0.85 * t * t), 0.0);
        let half = width * (0.12 + 0.88 * (std::f64::consts::PI * (0.10 + 0.90 * t)).sin());
        for side in [-1.0, 0.0, 1.0f64] {
            let fold = if side == 0.0 { 0.0 } else { 0.35 * half };
            shape.vertex((middle + v(0.0, fold, side * half)) * scale, glam::DVec3::Y);
        }
    }
    for i in 0..steps {
        for k in 0..2 {
            let a = 3 * i + k;
            shape.triangles.extend([[a, a + 1, a + 4], [a, a + 4, a + 3]]);
        }
    }
    shape.smooth()
}

/// A waste-paper basket.
pub fn basket(palette: &Palette) -> Parts {
    let profile = [
        [0.0, 0.002],
        [0.105, 0.002],
        [0.14, 0.30],
        [0.143, 0.31],
        [0.138, 0.31],
        [0.134, 0.30],
        [0.10, 0.008],
        [0.0, 0.008],
    ];
    let mut parts = Parts::of(palette.steel, lathe(&rounded(&profile, 0.004, 1, false), 30, false));
    let mut random = Random::new(3);
    for i in 0..3 {
        let crumple = superellipsoid(v(0.042, 0.038, 0.04), DVec2::ONE, 12, 7)
            .warped(|p| p * random.clone().between(0.95, 1.05))
            .turned_y(random.between(0.0, 360.0));
        let (sin, cos) = (TAU * f64::from(i) / 3.0).sin_cos();
        parts.add(palette.paper, crumple.moved(v(0.05 * cos, 0.05, 0.05 * sin)));
    }
    parts
}

/// A low cabinet of two doors, 1.0 × 0.72 × 0.45 m, its back at −z.
pub fn cabinet(palette: &Palette) -> Parts {
    let mut parts = Parts::default();
    parts.add(palette.trim, block(v(0.0, 0.06, -0.012), v(1.0, 0.66, 0.42), 0.006));
    parts.add(palette.plastic, block(v(0.0, 0.002, -0.02), v(0.94, 0.056, 0.36), 0.004));
    for side in [-1.0, 1.0] {
        let door = bevelled(v(-0.246, 0.075, 0.2), v(0.246, 0.71, 0.218), 0.004);
        parts.add(palette.shelf, door.moved(v(side * 0.249, 0.0, 0.0)));
        let x = side * 0.04;
        parts.add(palette.steel, rod(v(x, 0.45, 0.229), v(x, 0.60, 0.229), 0.006, 8));
    }
    parts
}

/// A wall clock that faces +z, its back at z = 0.
pub fn clock(palette: &Palette) -> Parts {
    let mut parts = Parts::default();
    let upright = DMat3::from_rotation_x(90f64.to_radians());
    let rim = [[0.135, 0.003], [0.155, 0.003], [0.155, 0.04], [0.135, 0.04]];
    let place = |shape: Shape| shape.placed(upright, v(0.0, 0.0, 0.0));
    parts.add(palette.plastic, place(lathe(&rounded(&rim, 0.008, 1, true), 32, true)));
    parts.add(palette.paper, place(cylinder(v(0.0, 0.004, 0.0), 0.133, 0.018, 32)));
    for (angle, length, width) in [(-60.0f64, 0.07, 0.006), (50.0, 0.105, 0.004)] {
        let hand = bevelled(v(-width, -0.015, 0.0), v(width, length, 0.002), 0.0008);
        let z = if length > 0.1 { 0.028 } else { 0.025 };
        parts.add(palette.plastic, hand.placed(DMat3::from_rotation_z(angle.to_radians()), v(0.0, 0.0, z)));
    }
    for hour in 0..12 {
        let mark = cuboid(v(-0.003, 0.105, 0.0225), v(0.003, 0.122, 0.0235));
        let turn = DMat3::from_rotation_z(TAU * f64::from(hour) / 12.0);
        parts.add(palette.plastic, mark.placed(turn, v(0.0, 0.0, 0.0)));
    }
    parts
}
