//! Desks, dividers, swivel chairs and bookcases; origins on the floor in the middle of each.

use super::palette::{COVERS, Palette};
use crate::glb::Parts;
use crate::random::Random;
use crate::shapes::{
    Shape,
    boxes::{bevelled, block},
    round::{bent, lathe, rod, rounded, superellipsoid, tube},
    v,
};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::TAU;

/// Height of a desk top, m.
pub const DESK: f64 = 0.75;

/// A desk of 1.6 × 0.8 m with steel legs and a pedestal of three drawers; its user sits at +z.
pub fn desk(palette: &Palette) -> Parts {
    let mut parts = Parts::default();
    parts.add(palette.birch, bevelled(v(-0.8, DESK - 0.03, -0.4), v(0.8, DESK, 0.4), 0.006));
    let under = DESK - 0.032;
    for x in [-0.74, 0.74] {
        for z in [-0.34, 0.34] {
            parts.add(palette.steel, block(v(x, 0.002, z), v(0.05, under - 0.002, 0.05), 0.006));
        }
        parts.add(palette.steel, bevelled(v(x - 0.02, 0.60, -0.313), v(x + 0.02, 0.66, 0.313), 0.004));
    }
    parts.add(palette.shelf, bevelled(v(-0.713, 0.36, -0.345), v(0.713, 0.69, -0.327), 0.003));
    let (x, low) = (0.48, 0.06);
    parts.add(palette.trim, bevelled(v(x - 0.2, low, -0.30), v(x + 0.2, under - 0.06, 0.28), 0.006));
    for drawer in 0..3 {
        let y = low + 0.01 + f64::from(drawer) * 0.193;
        parts.add(palette.shelf, bevelled(v(x - 0.195, y, 0.282), v(x + 0.195, y + 0.185, 0.298), 0.004));
        let handle = v(x, y + 0.145, 0.312);
        parts.add(palette.steel, rod(handle - v(0.06, 0.0, 0.0), handle + v(0.06, 0.0, 0.0), 0.006, 8));
    }
    for dx in [-0.14, 0.14] {
        for z in [-0.22, 0.2] {
            let foot = block(v(x + dx, 0.002, z), v(0.04, low - 0.004, 0.04), 0.0);
            parts.add(palette.plastic, foot);
        }
    }
    parts
}

/// A free-standing felt panel along x on two feet.
pub fn divider(palette: &Palette, felt: usize, width: f64, height: f64) -> Parts {
    let mut parts = Parts::default();
    let half = 0.5 * width;
    parts.add(felt, bevelled(v(-half, 0.052, -0.018), v(half, height, 0.018), 0.010));
    parts.add(palette.steel, bevelled(v(-half, 0.030, -0.015), v(half, 0.050, 0.015), 0.004));
    for x in [-0.42 * width, 0.42 * width] {
        parts.add(palette.steel, block(v(x, 0.002, 0.0), v(0.05, 0.026, 0.17), 0.008));
    }
    parts
}

/// A swivel chair that faces −z.
pub fn chair(palette: &Palette, fabric: usize) -> Parts {
    let mut parts = Parts::default();
    let cushion = [[0.0, 0.435], [0.20, 0.435], [0.235, 0.455], [0.235, 0.49], [0.20, 0.505], [0.0, 0.495]];
    parts.add(fabric, lathe(&rounded(&cushion, 0.03, 2, false), 32, false));
    let pan = [[0.0, 0.415], [0.17, 0.415], [0.19, 0.433], [0.0, 0.433]];
    parts.add(palette.plastic, lathe(&rounded(&pan, 0.006, 1, false), 18, false));
    // The back: a cushion bent round the sitter.
    let bend = |p: DVec3| v(p.x, p.y, p.z - 0.75 * p.x * p.x - 0.25 * (p.y - 0.05).powi(2));
    let back = superellipsoid(v(0.215, 0.20, 0.034), DVec2::new(0.42, 0.42), 24, 10);
    let lean = DMat3::from_rotation_x(8f64.to_radians());
    parts.add(fabric, back.warped(bend).placed(lean, v(0.0, 0.80, 0.255)));
    let bar = bent(&[v(0.0, 0.417, 0.198), v(0.0, 0.417, 0.315), v(0.0, 0.76, 0.322)], 0.07, 4);
    parts.add(palette.steel, tube(&bar, &vec![0.013; bar.len()], 10));
    for side in [-1.0, 1.0] {
        let arm = bent(
            &[v(side * 0.195, 0.419, 0.02), v(side * 0.275, 0.419, 0.02), v(side * 0.285, 0.666, 0.03)],
            0.05,
            2,
        );
        parts.add(palette.steel, tube(&arm, &vec![0.011; arm.len()], 7));
        let pad = superellipsoid(v(0.032, 0.014, 0.125), DVec2::new(0.6, 0.5), 12, 5);
        parts.add(palette.plastic, pad.moved(v(side * 0.285, 0.682, 0.01)));
    }
    let column = [[0.0, 0.13], [0.032, 0.13], [0.032, 0.26], [0.018, 0.265], [0.018, 0.414], [0.0, 0.414]];
    parts.add(palette.steel, lathe(&rounded(&column, 0.004, 1, false), 10, false));
    let hub = [[0.0, 0.075], [0.045, 0.075], [0.045, 0.128], [0.0, 0.128]];
    parts.add(palette.plastic, lathe(&rounded(&hub, 0.006, 1, false), 12, false));
    for star in 0..5 {
        let angle = TAU * (f64::from(star) + 0.25) / 5.0;
        let turn = DMat3::from_rotation_y(angle);
        let path = [v(0.047, 0.105, 0.0), v(0.16, 0.095, 0.0), v(0.27, 0.077, 0.0)];
        parts.add(palette.plastic, tube(&path, &[0.021, 0.017, 0.013], 7).placed(turn, DVec3::ZERO));
        parts.add(palette.plastic, castor().moved(v(0.285, 0.0, 0.0)).placed(turn, DVec3::ZERO));
    }
    parts
}

/// Two small wheels on a fork.
fn castor() -> Shape {
    let wheel = [[0.0, -0.009], [0.026, -0.009], [0.026, 0.009], [0.0, 0.009]];
    let wheel = lathe(&wheel.map(DVec2::from), 9, false);
    let on_side = DMat3::from_rotation_x(90f64.to_radians());
    Shape::join([
        wheel.clone().placed(on_side, v(0.0, 0.0275, 0.014)),
        wheel.placed(on_side, v(0.0, 0.0275, -0.014)),
        rod(v(0.0, 0.0565, 0.0), v(0.0, 0.09, 0.0), 0.008, 6),
    ])
}

/// A bookcase 1.1 m wide and 1.95 m high, its back at −z, with five shelves of books.
pub fn bookcase(shelf: usize, covers: &[usize; COVERS], seed: u64) -> Parts {
    let (w, h, depth, board): (f64, f64, f64, f64) = (0.55, 1.95, 0.30, 0.022);
    let mut parts = Parts::default();
    let (front, back) = (0.5 * depth, -0.5 * depth);
    for side in [-1.0, 1.0] {
        let (a, b) = (side * w, side * (w - board));
        parts.add(shelf, bevelled(v(a.min(b), 0.002, back), v(a.max(b), h, front), 0.003));
    }
    let inner = w - board - 0.001;
    parts.add(shelf, bevelled(v(-inner, 0.06, back + 0.001), v(inner, h - 0.002, back + 0.011), 0.001));
    let mut random = Random::new(seed);
    let rows = 5;
    let pitch = (h - 0.06 - board) / f64::from(rows);
    for row in 0..=rows {
        let y = 0.06 + f64::from(row) * pitch;
        let low = v(-inner, y, back + 0.013);
        parts.add(shelf, bevelled(low, v(inner, y + board, front - 0.004), 0.003));
        if row < rows {
            books(&mut parts, covers, &mut random, inner - 0.006, y + board + 0.001, pitch - board);
        }
    }
    parts
}

/// A row of books from left to right, with gaps, a leaning one and a lying pile now and then.
fn books(parts: &mut Parts, covers: &[usize; COVERS], random: &mut Random, half: f64, y: f64, room: f64) {
    let mut x = -half;
    let back = -0.125;
    let mut colour = random.below(COVERS);
    while x < half - 0.03 {
        // Series: some neighbours share colour and size.
        let series = 1 + random.below(4);
        let (height, depth) = (random.between(0.19, 0.9 * room), random.between(0.15, 0.225));
        let thickness = random.between(0.020, 0.052);
        colour = (colour + 1 + random.below(COVERS - 1)) % COVERS;
        for _ in 0..series {
            let own = thickness * random.between(0.8, 1.2);
            if x + own > half {
                return;
            }
            let height = height * random.between(0.985, 1.0);
            let book = bevelled(v(x, y, back), v(x + own, y + height, back + depth), 0.004);
            parts.add(covers[colour], book);
            x += own + 0.0015;
        }
        match random.below(7) {
            0 if x + 0.14 < half => {
                // One leans on the row: turned about its lower right edge.
                let (height, thickness) = (random.between(0.2, 0.26), 0.024);
                let angle = 13f64.to_radians();
                let foot = x + height * angle.sin() + 0.002;
                let book = bevelled(v(0.0, 0.0, back), v(thickness, height, back + 0.18), 0.004);
                let lean = DMat3::from_rotation_z(angle);
                parts.add(covers[random.below(COVERS)], book.placed(lean, v(foot, y, 0.0)));
                x = foot + thickness + 0.03;
            }
            1 if x + 0.26 < half => {
                let mut top = y;
                for _ in 0..2 + random.below(3) {
                    let thickness = random.between(0.02, 0.04);
                    let length = random.between(0.20, 0.245);
                    let book = bevelled(v(x, top, back), v(x + length, top + thickness, back + 0.17), 0.004);
                    parts.add(covers[random.below(COVERS)], book);
                    top += thickness + 0.001;
                }
                x += 0.25;
            }
            2 => x += random.between(0.03, 0.08),
            _ => {}
        }
    }
}
