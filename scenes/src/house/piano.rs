//! The grand piano, its bench and its music.

use super::palette::Palette;
use crate::glb::{Model, Parts};
use crate::shapes::{
    Shape,
    boxes::{bevelled, block, plain, quad},
    round::{cylinder, lathe, rod, rounded, superellipsoid},
    v,
};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Width of the keyboard's side, m.
const WIDTH: f64 = 1.50;
/// Length, m.
const LENGTH: f64 = 1.85;
/// Where the tail begins to be round, m from the keyboard's front.
const TAIL: f64 = 1.50;
/// Height of the lid's top, m.
const TOP: f64 = 1.0;

/// Adds the piano with its keyboard's front edge in the middle of `front`, the player at +z, and the bench.
pub fn add(model: &mut Model, palette: &Palette, front: DVec3) {
    let corner = front - DVec3::X * 0.5 * WIDTH;
    let mut body = Parts::default();
    body.add(palette.ebony, prism(&outline(0.27, 0.0), 0.63, TOP - 0.032));
    case(&mut body, palette);
    for (_, material, shape) in keys(palette) {
        body.add(material, shape);
    }
    legs(&mut body, palette);
    for shape in body.0.values_mut() {
        *shape = shape.clone().moved(corner);
    }
    model.stand("Grand piano", body);
    let rows = outline(0.25, 0.014);
    let mut lid = Parts::default();
    let (low, high) = (TOP - 0.028, TOP);
    lid.add(palette.ebony, sides(&rows, low, high).moved(corner));
    lid.add(palette.ebony, cap(&rows, low).inverted().moved(corner));
    lid.add(palette.lid, cap(&rows, high).moved(corner));
    model.stand("Piano lid", lid);
    desk(model, palette, corner);
    bench(model, palette, front + v(0.0, 0.0, 0.42));
}

/// The outline as rows across: distance from the keyboard's front, left and right edge, m. The bass side
/// is straight; the treble side curves in (a smooth step) and the tail is half an ellipse, so that the
/// curve has no kink. Grown by `over` on all sides.
fn outline(from: f64, over: f64) -> Vec<[f64; 3]> {
    let tail = 0.60;
    let right = |w: f64| {
        let t = ((w - 0.30) / (TAIL - 0.30)).clamp(0.0, 1.0);
        tail + (WIDTH - tail) * (1.0 - t * t * (3.0 - 2.0 * t))
    };
    let straight = 26u32;
    let mut rows: Vec<[f64; 3]> = (0..=straight)
        .map(|i| {
            let w = from + (TAIL - from) * f64::from(i) / f64::from(straight);
            [w, -over, right(w) + over]
        })
        .collect();
    let round = 14u32;
    for i in 1..=round {
        let (sin, cos) = (FRAC_PI_2 * f64::from(i) / f64::from(round)).sin_cos();
        let half = if i == round { 0.0 } else { (0.5 * tail + over) * cos };
        rows.push([TAIL + (LENGTH - TAIL + over) * sin, 0.5 * tail - half, 0.5 * tail + half]);
    }
    rows
}

/// The top of an outline at a height, facing up; z runs against the rows.
fn cap(rows: &[[f64; 3]], y: f64) -> Shape {
    let mut shape = Shape::default();
    let ids: Vec<[u32; 2]> = rows
        .iter()
        .map(|&[w, left, right]| [left, right].map(|x| shape.vertex(v(x, y, -w), DVec3::Y)))
        .collect();
    for k in 0..rows.len() - 1 {
        let ([a, b], [d, c]) = (ids[k], ids[k + 1]);
        shape.triangles.push([a, b, c]);
        if rows[k + 1][1] < rows[k + 1][2] {
            shape.triangles.push([a, c, d]);
        }
    }
    shape
}

/// The walls of an outline, smooth round the curves, with a flat front.
fn sides(rows: &[[f64; 3]], low: f64, high: f64) -> Shape {
    let at = |k: usize, side: usize| DVec2::new(rows[k][1 + side], -rows[k][0]);
    let last = rows.len() - 1;
    let mut shape = Shape::default();
    // Along the left side to the tail's tip and back along the right one.
    let path: Vec<DVec2> = (0..=last).map(|k| at(k, 0)).chain((0..last).rev().map(|k| at(k, 1))).collect();
    let ids: Vec<[u32; 2]> = (0..path.len())
        .map(|i| {
            let along = path[(i + 1).min(path.len() - 1)] - path[i.saturating_sub(1)];
            let normal = v(along.y, 0.0, -along.x).normalize();
            [low, high].map(|y| shape.vertex(v(path[i].x, y, path[i].y), normal))
        })
        .collect();
    for i in 0..path.len() - 1 {
        let ([a, d], [b, c]) = (ids[i], ids[i + 1]);
        shape.triangles.extend([[a, c, b], [a, d, c]]);
    }
    let (l, r) = (at(0, 0), at(0, 1));
    shape.add(&plain([v(l.x, low, l.y), v(r.x, low, r.y), v(r.x, high, r.y), v(l.x, high, l.y)]));
    shape
}

fn prism(rows: &[[f64; 3]], low: f64, high: f64) -> Shape {
    Shape::join([sides(rows, low, high), cap(rows, low).inverted(), cap(rows, high)])
}

/// Arms, key bed, fallboard and strips beside the keys.
fn case(parts: &mut Parts, palette: &Palette) {
    let mut add = |low: DVec3, high: DVec3, bevel: f64| parts.add(palette.ebony, bevelled(low, high, bevel));
    for x in [0.0, WIDTH - 0.09] {
        add(v(x, 0.63, -0.268), v(x + 0.09, 0.90, 0.0), 0.02);
    }
    add(v(0.092, 0.62, -0.268), v(WIDTH - 0.092, 0.685, -0.001), 0.004);
    add(v(0.092, 0.686, -0.022), v(WIDTH - 0.092, 0.712, -0.002), 0.004);
    for x in [0.092, WIDTH - 0.135] {
        add(v(x, 0.686, -0.20), v(x + 0.043, 0.745, -0.024), 0.004);
    }
    let fall = bevelled(v(0.094, 0.0, -0.012), v(WIDTH - 0.094, 0.20, 0.012), 0.004);
    let lean = DMat3::from_rotation_x(-8f64.to_radians());
    parts.add(palette.ebony, fall.placed(lean, v(0.0, 0.733, -0.205)));
}

/// 52 white keys and 36 black ones.
fn keys(palette: &Palette) -> Vec<(u32, usize, Shape)> {
    let (first, last) = (0.137, WIDTH - 0.137);
    let pitch = (last - first) / 52.0;
    let mut keys = Vec::new();
    for i in 0..52u32 {
        let x = first + f64::from(i) * pitch;
        let white = bevelled(v(x + 0.0004, 0.690, -0.19), v(x + pitch - 0.0004, 0.722, -0.026), 0.0016);
        keys.push((i, palette.ivory, white));
        // From A: no black key after B and E.
        let black = ![1, 4].contains(&(i % 7)) && i < 51;
        if black {
            let x = x + pitch;
            let key = bevelled(v(x - 0.0055, 0.7225, -0.189), v(x + 0.0055, 0.734, -0.085), 0.0022);
            keys.push((i, palette.ebony, key));
        }
    }
    keys
}

/// A turned leg on a brass castor, `height` m high.
pub fn turned_leg(height: f64, radius: f64) -> Shape {
    let profile = [
        [0.0, 0.0],
        [0.45, 0.0],
        [0.55, 0.03],
        [0.62, 0.10],
        [0.42, 0.13],
        [0.60, 0.16],
        [0.42, 0.19],
        [0.50, 0.24],
        [0.78, 0.55],
        [0.92, 0.66],
        [0.96, 0.72],
        [0.80, 0.77],
        [0.58, 0.79],
        [0.86, 0.81],
        [0.86, 0.83],
        [0.66, 0.85],
        [1.0, 0.88],
        [1.0, 1.0],
        [0.0, 1.0],
    ];
    let profile = profile.map(|[r, t]| [r * radius, t * height]);
    lathe(&rounded(&profile, 0.12 * radius, 1, false), 14, false)
}

fn legs(parts: &mut Parts, palette: &Palette) {
    for (x, w) in [(0.14, 0.20), (WIDTH - 0.14, 0.20), (0.32, 1.52)] {
        parts.add(palette.ebony, turned_leg(0.55, 0.062).moved(v(x, 0.068, -w)));
        parts.add(palette.brass, cylinder(v(x, 0.042, -w), 0.030, 0.025, 18));
        let wheel = superellipsoid(v(0.02, 0.02, 0.012), DVec2::ONE, 14, 8);
        parts.add(palette.brass, wheel.moved(v(x, 0.0225, -w)));
    }
    // The lyre with its pedals.
    for x in [-0.09, 0.09] {
        let (low, high) = (v(0.5 * WIDTH + 0.8 * x, 0.14, -0.30), v(0.5 * WIDTH + x, 0.615, -0.26));
        parts.add(palette.ebony, rod(low, high, 0.014, 14));
    }
    parts.add(palette.ebony, block(v(0.5 * WIDTH, 0.085, -0.29), v(0.26, 0.05, 0.10), 0.012));
    for k in [-1.0, 0.0, 1.0] {
        let pedal = superellipsoid(v(0.017, 0.006, 0.075), DVec2::new(0.7, 0.6), 16, 8);
        parts.add(palette.brass, pedal.moved(v(0.5 * WIDTH + 0.075 * k, 0.078, -0.19)));
    }
}

/// The desk on the lid, with two pages and a volume of music lying beside.
fn desk(model: &mut Model, palette: &Palette, corner: DVec3) {
    let lean = DMat3::from_rotation_x(-18f64.to_radians());
    let foot = corner + v(0.5 * WIDTH, TOP + 0.006, -0.47);
    let mut parts = Parts::default();
    let board = bevelled(v(-0.36, 0.0, -0.010), v(0.36, 0.27, 0.0), 0.004);
    parts.add(palette.ebony, board.placed(lean, foot));
    let ledge = bevelled(v(-0.36, 0.0, 0.0015), v(0.36, 0.012, 0.03), 0.004);
    parts.add(palette.ebony, ledge.placed(lean, foot));
    let prop = rod(v(0.0, 0.005, -0.10), v(0.0, 0.16, -0.015), 0.006, 10);
    parts.add(palette.brass, prop.placed(DMat3::IDENTITY, foot + v(0.0, 0.0, -0.055)));
    for x in [-0.212, 0.003] {
        let page = quad(
            [v(x, 0.014, 0.003), v(x + 0.21, 0.014, 0.003), v(x + 0.21, 0.30, 0.003), v(x, 0.30, 0.003)],
            DVec2::ONE,
        );
        parts.add(palette.music, page.placed(lean, foot));
    }
    model.stand("Music desk", parts);
    let mut volumes = Parts::default();
    let mut y = TOP + 0.0015;
    for (k, cover) in [0usize, 4, 2].into_iter().enumerate() {
        let thick = 0.012 + 0.004 * k as f64;
        let book = block(DVec3::ZERO, v(0.23, thick, 0.31), 0.003).turned_y(12.0 - 17.0 * k as f64);
        volumes.add(palette.covers[cover], book.moved(corner + v(0.22, y, -1.0)));
        y += thick + 0.001;
    }
    model.stand("Volumes of music", volumes);
}

/// A bench whose top is polished, its middle at `at`.
fn bench(model: &mut Model, palette: &Palette, at: DVec3) {
    let (w, d, high, low) = (0.40, 0.18, 0.50, 0.465);
    let mut parts = Parts::default();
    let corners = |y: f64| [v(-w, y, d), v(w, y, d), v(w, y, -d), v(-w, y, -d)];
    let [a, b] = [corners(low), corners(high)];
    for i in 0..4 {
        let j = (i + 1) % 4;
        parts.add(palette.walnut, plain([a[i], a[j], b[j], b[i]]));
    }
    parts.add(palette.walnut, plain([a[3], a[2], a[1], a[0]]));
    parts.add(palette.bench, plain(b));
    for x in [-0.34, 0.34] {
        for z in [-0.13, 0.13] {
            parts.add(palette.walnut, turned_leg(0.388, 0.030).moved(v(x, 0.002, z)));
            parts.add(palette.walnut, block(v(x, 0.391, z), v(0.06, 0.072, 0.06), 0.004));
        }
        parts.add(palette.walnut, bevelled(v(x - 0.012, 0.40, -0.098), v(x + 0.012, 0.462, 0.098), 0.003));
    }
    for z in [-0.13, 0.13] {
        parts.add(palette.walnut, bevelled(v(-0.308, 0.40, z - 0.012), v(0.308, 0.462, z + 0.012), 0.003));
    }
    for shape in parts.0.values_mut() {
        *shape = shape.clone().moved(at);
    }
    model.stand("Piano bench", parts);
}
