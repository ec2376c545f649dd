//! Furniture of both rooms: tables on turned legs, spindle chairs, sofa, curtains, frames, small things.

use super::palette::Palette;
use super::piano::turned_leg;
use crate::glb::Parts;
use crate::shapes::{
    Shape,
    boxes::{bevelled, block, plain, quad},
    round::{lathe, rod, rounded, superellipsoid, tube},
    v,
};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::TAU;

/// A table of a size on four turned legs; its top at `size.y`.
pub fn table(wood: usize, size: DVec3, leg: f64) -> Parts {
    let mut parts = Parts::default();
    let (w, d, top) = (0.5 * size.x, 0.5 * size.z, size.y);
    parts.add(wood, bevelled(v(-w, top - 0.03, -d), v(w, top, d), 0.008));
    let (x, z) = (w - 0.06, d - 0.06);
    for (sx, sz) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        parts.add(wood, turned_leg(top - 0.144, leg).moved(v(sx * x, 0.002, sz * z)));
        parts.add(wood, block(v(sx * x, top - 0.141, sz * z), v(0.065, 0.109, 0.065), 0.004));
    }
    for s in [-1.0, 1.0] {
        let (inner, y) = (0.034, [top - 0.13, top - 0.032]);
        parts.add(
            wood,
            bevelled(v(-x + inner, y[0], s * z - 0.012), v(x - inner, y[1], s * z + 0.012), 0.003),
        );
        parts.add(
            wood,
            bevelled(v(s * x - 0.012, y[0], -z + inner), v(s * x + 0.012, y[1], z - inner), 0.003),
        );
    }
    parts
}

/// A spindle-back chair that faces +z.
pub fn spindle_chair(wood: usize) -> Parts {
    let mut parts = Parts::default();
    let seat = superellipsoid(v(0.22, 0.022, 0.21), DVec2::new(0.5, 0.7), 36, 8);
    parts.add(wood, seat.moved(v(0.0, 0.44, 0.0)));
    let turned = |from: DVec3, to: DVec3, radius: f64| {
        let knots = [0.5, 0.75, 0.55, 1.0, 0.62, 0.95, 1.0, 0.92, 0.6, 0.9, 0.55, 0.8, 0.5];
        let last = knots.len() as f64 - 1.0;
        let path: Vec<DVec3> = (0..knots.len()).map(|i| from.lerp(to, i as f64 / last)).collect();
        tube(&path, &knots.map(|k| k * radius), 10)
    };
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        parts.add(wood, turned(v(0.20 * x, 0.002, 0.19 * z), v(0.145 * x, 0.419, 0.14 * z), 0.022));
    }
    for x in [-0.174, 0.174] {
        parts.add(wood, turned(v(x, 0.20, -0.145), v(x, 0.20, 0.145), 0.014));
    }
    parts.add(wood, turned(v(-0.155, 0.20, 0.0), v(0.155, 0.20, 0.0), 0.014));
    let crest = |x: f64| v(1.12 * x, 0.93 - 0.5 * x * x, -0.245 + 0.7 * x * x);
    let path: Vec<DVec3> = (0..=16).map(|i| crest(-0.20 + 0.025 * f64::from(i))).collect();
    parts.add(wood, tube(&path, &[0.019; 17], 12));
    for i in 0..7 {
        let x = -0.156 + 0.052 * f64::from(i);
        let foot = v(x, 0.464, -0.155 + 0.9 * x * x);
        parts.add(wood, turned(foot, crest(x) - v(0.0, 0.02, 0.0), 0.0105));
    }
    parts
}

/// A sofa or armchair `width` m wide that faces +z.
pub fn sofa(fabric: usize, cushion: usize, wood: usize, width: f64) -> Parts {
    let mut parts = Parts::default();
    let half = 0.5 * width;
    let soft = |half: DVec3| superellipsoid(half, DVec2::new(0.42, 0.36), 24, 9);
    parts.add(fabric, soft(v(half - 0.14, 0.13, 0.40)).moved(v(0.0, 0.225, 0.02)));
    parts.add(fabric, soft(v(half - 0.02, 0.30, 0.12)).moved(v(0.0, 0.56, -0.36)));
    for side in [-1.0, 1.0] {
        parts.add(fabric, soft(v(0.12, 0.27, 0.42)).moved(v(side * (half - 0.12), 0.36, 0.02)));
        for z in [-0.32, 0.36] {
            let foot = [[0.0, 0.0], [0.018, 0.0], [0.030, 0.06], [0.024, 0.088], [0.0, 0.088]];
            let foot = lathe(&rounded(&foot, 0.006, 1, false), 14, false);
            parts.add(wood, foot.moved(v(side * (half - 0.2), 0.002, z)));
        }
    }
    let seats = if width > 1.4 { 2 } else { 1 };
    let each = (width - 0.5) / f64::from(seats);
    for i in 0..seats {
        let x = -half + 0.25 + each * (f64::from(i) + 0.5);
        parts.add(fabric, soft(v(0.5 * each - 0.004, 0.075, 0.33)).moved(v(x, 0.432, 0.09)));
        let lean = DMat3::from_rotation_x(-0.2) * DMat3::from_rotation_z(0.25 - 0.3 * f64::from(i));
        let pillow = superellipsoid(v(0.20, 0.20, 0.06), DVec2::new(0.8, 0.35), 20, 8);
        parts.add(cushion, pillow.placed(lean, v(x + 0.1, 0.70, -0.15)));
    }
    parts
}

/// A curtain gathered to a side: `width` m at the rod, `height` m high, hung with its middle at x = 0.
pub fn curtain(cloth: usize, width: f64, height: f64) -> Parts {
    let mut shape = Shape::default();
    let (columns, rows) = (72u32, 12u32);
    for row in 0..=rows {
        let t = f64::from(row) / f64::from(rows);
        for column in 0..=columns {
            let u = f64::from(column) / f64::from(columns);
            // Folds deepen downwards and do not run quite straight.
            let phase = TAU * (6.0 * u + 0.06 * (5.0 * t + 3.0 * u).sin());
            let depth = 0.022 + 0.016 * t;
            let spread = 1.0 - 0.10 * (1.0 - t) * t;
            shape.vertex(v((u - 0.5) * width * spread, height * (1.0 - t), depth * phase.sin()), DVec3::Z);
        }
    }
    let across = columns + 1;
    for row in 0..rows {
        for column in 0..columns {
            let a = row * across + column;
            shape.triangles.extend([[a, a + across, a + across + 1], [a, a + across + 1, a + 1]]);
        }
    }
    Parts::of(cloth, shape.smooth())
}

/// A rod of `length` m along x with turned ends and rings.
pub fn curtain_rod(metal: usize, length: f64) -> Parts {
    let mut parts = Parts::default();
    let half = 0.5 * length;
    parts.add(metal, rod(v(-half, 0.0, 0.0), v(half, 0.0, 0.0), 0.012, 14));
    for side in [-1.0, 1.0] {
        let finial = superellipsoid(v(0.035, 0.026, 0.026), DVec2::ONE, 20, 10);
        parts.add(metal, finial.moved(v(side * (half + 0.036), 0.0, 0.0)));
        parts.add(
            metal,
            rod(v(side * (half - 0.1), 0.0, -0.098), v(side * (half - 0.1), 0.0, -0.0125), 0.008, 8),
        );
    }
    parts
}

/// A frame of `size` m round its opening with beads, facing +z, its middle at the origin.
pub fn frame(gilt: usize, size: DVec2, beads: bool) -> Parts {
    let mut parts = Parts::default();
    let (w, h) = (0.5 * size.x, 0.5 * size.y);
    let (b, near, far) = (0.055, 0.004, 0.040);
    let mut bar = |low: DVec3, high: DVec3| parts.add(gilt, bevelled(low, high, 0.012));
    bar(v(-w - b, h, near), v(w + b, h + b, far));
    bar(v(-w - b, -h - b, near), v(w + b, -h, far));
    bar(v(-w - b, -h + 0.001, near), v(-w, h - 0.001, far));
    bar(v(w, -h + 0.001, near), v(w + b, h - 0.001, far));
    if beads {
        let bead = superellipsoid(DVec3::splat(0.014), DVec2::ONE, 8, 4);
        let mut row = |from: DVec2, to: DVec2| {
            let count = (from.distance(to) / 0.040).floor();
            for i in 0..count as u32 {
                let at = from.lerp(to, (f64::from(i) + 0.5) / count);
                parts.add(gilt, bead.clone().moved(v(at.x, at.y, far + 0.0145)));
            }
        };
        let (x, y) = (w + 0.5 * b, h + 0.5 * b);
        row(DVec2::new(-x, y), DVec2::new(x, y));
        row(DVec2::new(-x, -y), DVec2::new(x, -y));
        row(DVec2::new(-x, -y + 0.02), DVec2::new(-x, y - 0.02));
        row(DVec2::new(x, -y + 0.02), DVec2::new(x, y - 0.02));
    }
    parts
}

/// What a frame of a size holds, 1.2 cm before the wall; a picture if `textured`.
pub fn framed(size: DVec2, textured: bool) -> Shape {
    let (w, h) = (0.5 * size.x, 0.5 * size.y);
    let corners = [v(-w, -h, 0.012), v(w, -h, 0.012), v(w, h, 0.012), v(-w, h, 0.012)];
    if textured { quad(corners, DVec2::ONE) } else { plain(corners) }
}

/// A vase 0.34 m high.
pub fn vase(glaze: usize) -> Parts {
    let profile = [
        [0.0, 0.001],
        [0.055, 0.001],
        [0.060, 0.02],
        [0.105, 0.13],
        [0.095, 0.20],
        [0.045, 0.27],
        [0.040, 0.30],
        [0.060, 0.335],
        [0.055, 0.336],
        [0.034, 0.30],
        [0.038, 0.27],
        [0.0, 0.20],
    ];
    Parts::of(glaze, lathe(&rounded(&profile, 0.03, 3, false), 40, false))
}

/// A candlestick with its candle.
pub fn candlestick(palette: &Palette) -> Parts {
    let profile = [
        [0.0, 0.001],
        [0.055, 0.001],
        [0.055, 0.010],
        [0.030, 0.022],
        [0.012, 0.035],
        [0.018, 0.055],
        [0.009, 0.075],
        [0.010, 0.15],
        [0.020, 0.170],
        [0.010, 0.185],
        [0.026, 0.20],
        [0.026, 0.205],
        [0.014, 0.207],
        [0.014, 0.225],
        [0.0, 0.225],
    ];
    let mut parts = Parts::of(palette.brass, lathe(&rounded(&profile, 0.005, 2, false), 28, false));
    let candle = [[0.0, 0.2255], [0.010, 0.2255], [0.0095, 0.36], [0.004, 0.368], [0.0, 0.369]];
    parts.add(palette.wax, lathe(&candle.map(DVec2::from), 18, false));
    parts
}

/// A round table on a turned pillar and three feet.
pub fn pillar_table(wood: usize, radius: f64, height: f64) -> Parts {
    let top = [
        [0.0, height - 0.03],
        [radius - 0.02, height - 0.03],
        [radius, height - 0.015],
        [radius, height],
        [0.0, height],
    ];
    let mut parts = Parts::of(wood, lathe(&rounded(&top, 0.01, 2, false), 56, false));
    let leg = turned_leg(height - 0.201, 0.055).moved(v(0.0, 0.17, 0.0));
    parts.add(wood, leg);
    for k in 0..3 {
        let turn = DMat3::from_rotation_y(TAU * (f64::from(k) + 0.2) / 3.0);
        let path = [
            v(0.026, 0.20, 0.0),
            v(0.12, 0.19, 0.0),
            v(0.22, 0.11, 0.0),
            v(0.30, 0.028, 0.0),
            v(0.345, 0.026, 0.0),
        ];
        parts.add(wood, tube(&path, &[0.024, 0.023, 0.020, 0.017, 0.013], 12).placed(turn, DVec3::ZERO));
    }
    parts
}
