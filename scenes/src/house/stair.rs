//! The stair along the back wall of the living room, its gallery, and the turned balusters of both.

use super::palette::Palette;
use super::shell::{X, Z};
use crate::glb::{Model, Parts};
use crate::shapes::{
    Shape,
    boxes::{bevelled, block},
    round::{bent, lathe, rounded, superellipsoid, tube},
    v,
};
use glam::{DVec2, DVec3};

/// Steps.
const STEPS: u32 = 15;
/// Height and depth of a step, m.
const RISE: f64 = 0.19;
const RUN: f64 = 0.21;
/// Where the first step begins, m.
const FOOT: f64 = 0.95;
/// The stair's open side, m.
const SIDE: f64 = -2.0;
/// Height of a baluster on a step's front half, m.
const BALUSTER: f64 = 0.84;
/// Edge of the gallery, m.
const EDGE: f64 = FOOT + STEPS as f64 * RUN;
/// Floor of the gallery, m.
const GALLERY: f64 = STEPS as f64 * RISE;

/// Adds stair, gallery, balusters, posts and rails.
pub fn add(model: &mut Model, palette: &Palette) {
    let mut steps = Parts::default();
    for i in 0..STEPS {
        let (x, top) = (FOOT + f64::from(i) * RUN, f64::from(i + 1) * RISE);
        let body = bevelled(v(x, 0.002, -Z + 0.004), v(x + RUN - 0.001, top - 0.032, SIDE - 0.02), 0.002);
        steps.add(palette.trim, body);
        let tread = bevelled(v(x - 0.025, top - 0.031, -Z + 0.003), v(x + RUN - 0.026, top, SIDE), 0.008);
        steps.add(palette.oak, tread);
        let runner =
            block(v(x + 0.5 * RUN - 0.02, top + 0.001, 0.5 * (SIDE - Z)), v(RUN - 0.03, 0.006, 0.6), 0.002);
        steps.add(palette.felt, runner);
    }
    model.stand("Stair", steps);
    let mut gallery = Parts::default();
    gallery.add(
        palette.trim,
        bevelled(v(EDGE, GALLERY - 0.22, -Z + 0.003), v(X - 0.003, GALLERY - 0.03, Z - 0.003), 0.01),
    );
    gallery.add(
        palette.oak,
        bevelled(v(EDGE - 0.02, GALLERY - 0.028, -Z + 0.004), v(X - 0.004, GALLERY, Z - 0.004), 0.006),
    );
    model.stand("Gallery", gallery);
    balusters(model, palette);
    rails(model, palette);
    let column = model.mesh(Parts::of(palette.trim, column(GALLERY - 0.224)));
    for (name, z) in [("Column left", 2.2), ("Column right", -0.9)] {
        model.place(name, column, [EDGE + 0.14, 0.002, z], 0.0);
    }
}

fn balusters(model: &mut Model, palette: &Palette) {
    let short = model.mesh(Parts::of(palette.trim, baluster(BALUSTER)));
    let long = model.mesh(Parts::of(palette.trim, baluster(BALUSTER + 0.5 * RISE)));
    let z = SIDE - 0.06;
    for i in 0..STEPS {
        let (x, top) = (FOOT + f64::from(i) * RUN, f64::from(i + 1) * RISE + 0.001);
        model.place(format!("Baluster {}", 2 * i + 1), short, [x + 0.03, top, z], 0.0);
        model.place(format!("Baluster {}", 2 * i + 2), long, [x + 0.03 + 0.5 * RUN, top, z], 0.0);
    }
    let count = 36;
    for i in 0..count {
        let z = SIDE + 0.22 + f64::from(i) * (Z - SIDE - 0.32) / f64::from(count);
        model.place(format!("Gallery baluster {}", i + 1), short, [EDGE + 0.06, GALLERY + 0.001, z], 0.0);
    }
}

/// A turned baluster between two square blocks, `height` m high.
fn baluster(height: f64) -> Shape {
    let (foot, head) = (0.10, 0.12);
    // Radius, share of the height between the blocks.
    let turned = [
        [0.0, 0.0],
        [0.017, 0.0],
        [0.020, 0.015],
        [0.017, 0.03],
        [0.011, 0.045],
        [0.014, 0.075],
        [0.021, 0.13],
        [0.0225, 0.20],
        [0.020, 0.27],
        [0.014, 0.36],
        [0.0105, 0.44],
        [0.0095, 0.50],
        [0.013, 0.515],
        [0.015, 0.525],
        [0.013, 0.535],
        [0.0095, 0.55],
        [0.011, 0.62],
        [0.0135, 0.72],
        [0.0155, 0.82],
        [0.0145, 0.88],
        [0.0105, 0.92],
        [0.017, 0.94],
        [0.020, 0.96],
        [0.017, 0.985],
        [0.014, 1.0],
        [0.0, 1.0],
    ];
    let (low, span) = (foot + 0.0005, height - foot - head - 0.001);
    let profile: Vec<[f64; 2]> = turned.iter().map(|&[r, t]| [r, low + t * span]).collect();
    Shape::join([
        block(DVec3::ZERO, v(0.04, foot, 0.04), 0.003),
        lathe(&rounded(&profile, 0.004, 2, false), 16, false),
        block(v(0.0, height - head, 0.0), v(0.036, head, 0.036), 0.003),
    ])
}

fn column(height: f64) -> Shape {
    let profile = [
        [0.0, 0.0],
        [0.105, 0.0],
        [0.105, 0.05],
        [0.085, 0.075],
        [0.095, 0.095],
        [0.078, 0.12],
        [0.080, 0.9],
        [0.064, height - 0.16],
        [0.078, height - 0.13],
        [0.066, height - 0.11],
        [0.095, height - 0.05],
        [0.105, height - 0.04],
        [0.105, height],
        [0.0, height],
    ];
    lathe(&rounded(&profile, 0.012, 3, false), 32, false)
}

fn rails(model: &mut Model, palette: &Palette) {
    let mut parts = Parts::default();
    let z = SIDE - 0.06;
    let newel = |height: f64| {
        let ball = superellipsoid(DVec3::splat(0.06), DVec2::ONE, 24, 14);
        let cap = [[0.0, 0.0], [0.066, 0.0], [0.066, 0.02], [0.035, 0.045], [0.030, 0.06], [0.0, 0.062]];
        Shape::join([
            block(DVec3::ZERO, v(0.10, height, 0.10), 0.008),
            lathe(&rounded(&cap, 0.006, 2, false), 24, false).moved(v(0.0, height + 0.001, 0.0)),
            ball.moved(v(0.0, height + 0.12, 0.0)),
        ])
    };
    parts.add(palette.walnut, newel(1.12).moved(v(FOOT - 0.12, 0.002, z)));
    parts.add(palette.walnut, newel(1.06).moved(v(EDGE + 0.06, GALLERY + 0.001, z)));
    parts.add(palette.walnut, newel(1.06).moved(v(EDGE + 0.06, GALLERY + 0.001, Z - 0.09)));
    // The rail runs with the nosings; its lower side meets the balusters' heads.
    let at = |x: f64| BALUSTER + RISE + (x - FOOT - 0.03) * RISE / RUN + 0.030;
    let (from, to) = (FOOT - 0.065, EDGE - 0.03);
    let path = bent(
        &[v(from, at(from), z), v(to - 0.12, at(to - 0.12), z), v(to + 0.035, at(to - 0.12) + 0.03, z)],
        0.1,
        6,
    );
    parts.add(palette.walnut, tube(&path, &vec![0.031; path.len()], 20));
    let y = GALLERY + BALUSTER + 0.032;
    let along = [v(EDGE + 0.06, y, SIDE + 0.0), v(EDGE + 0.06, y, Z - 0.142)];
    parts.add(palette.walnut, tube(&along, &[0.031; 2], 20));
    model.stand("Newels and rails", parts);
}
