//! The shell of the office: walls with a window, skirting, paintings, ceiling panel.

use super::palette::Palette;
use crate::glb::{Material, Model, Parts};
use crate::pictures;
use crate::shapes::{
    Shape,
    boxes::{bevelled, cuboid, plain, quad},
    v,
};
use glam::{DVec2, DVec3};

/// Half the room along x, m.
pub const X: f64 = 4.0;
/// Height of the room, m.
pub const Y: f64 = 2.8;
/// Half the room along z, m.
pub const Z: f64 = 3.0;
/// The window in the wall at −z: x from, x to, y from, y to, and how deep the recess is.
const WINDOW: [f64; 4] = [0.1, 2.9, 0.95, 2.3];
const RECESS: f64 = 0.22;

/// Radiance of the sky behind the window where the picture is white, cd/m².
const SKY: [f64; 3] = [55.0, 62.0, 80.0];
/// Radiance of the ceiling panel, cd/m².
const PANEL: [f64; 3] = [1_310.0, 1_250.0, 1_160.0];

/// Adds the shell and what hangs on it.
pub fn add(model: &mut Model, palette: &Palette) {
    shell(model, palette);
    window(model, palette);
    skirting(model, palette);
    panel(model, palette, v(-0.75, Y, -0.35));
    paintings(model, palette);
}

fn shell(model: &mut Model, palette: &Palette) {
    let floor = [v(-X, 0.0, Z), v(X, 0.0, Z), v(X, 0.0, -Z), v(-X, 0.0, -Z)];
    let ceiling = [v(-X, Y, -Z), v(X, Y, -Z), v(X, Y, Z), v(-X, Y, Z)];
    model.stand("Floor", Parts::of(palette.floor, quad(floor, DVec2::new(X, Z))));
    model.stand("Ceiling", Parts::of(palette.ceiling, plain(ceiling)));
    let left = [v(-X, 0.0, Z), v(-X, 0.0, -Z), v(-X, Y, -Z), v(-X, Y, Z)];
    let right = [v(X, 0.0, -Z), v(X, 0.0, Z), v(X, Y, Z), v(X, Y, -Z)];
    let front = [v(X, 0.0, Z), v(-X, 0.0, Z), v(-X, Y, Z), v(X, Y, Z)];
    model.stand("Left wall", Parts::of(palette.accent, plain(left)));
    model.stand("Right wall", Parts::of(palette.wall, plain(right)));
    model.stand("Front wall", Parts::of(palette.wall, plain(front)));
    // The wall with the window: a grid of three by three without its middle, so that edges meet.
    let (xs, ys) = ([-X, WINDOW[0], WINDOW[1], X], [0.0, WINDOW[2], WINDOW[3], Y]);
    let mut back = Shape::default();
    for i in 0..3 {
        for j in (0..3).filter(|&j| (i, j) != (1, 1)) {
            let (a, b, c, d) = (xs[i], xs[i + 1], ys[j], ys[j + 1]);
            back.add(&plain([v(a, c, -Z), v(b, c, -Z), v(b, d, -Z), v(a, d, -Z)]));
        }
    }
    let [a, b, c, d] = WINDOW;
    let (n, f) = (-Z, -Z - RECESS);
    back.add(&plain([v(a, c, n), v(a, c, f), v(a, d, f), v(a, d, n)]));
    back.add(&plain([v(b, c, f), v(b, c, n), v(b, d, n), v(b, d, f)]));
    back.add(&plain([v(a, c, f), v(a, c, n), v(b, c, n), v(b, c, f)]));
    back.add(&plain([v(a, d, n), v(a, d, f), v(b, d, f), v(b, d, n)]));
    model.stand("Back wall", Parts::of(palette.wall, back));
}

fn window(model: &mut Model, palette: &Palette) {
    let [a, b, c, d] = WINDOW;
    let back = -Z - RECESS;
    let picture = Some(model.picture(pictures::dusk()));
    let sky = model.material(Material {
        radiance: SKY,
        radiance_picture: picture,
        ..Material::new("Evening sky", [0.04, 0.04, 0.05])
    });
    let pane = quad([v(a, c, back), v(b, c, back), v(b, d, back), v(a, d, back)], DVec2::ONE);
    model.stand("Window", Parts::of(sky, pane));
    let mut frame = Parts::default();
    let (z0, z1, gap, bar) = (back + 0.02, back + 0.07, 0.002, 0.05);
    let mut piece = |x0: f64, x1: f64, y0: f64, y1: f64| {
        frame.add(palette.trim, bevelled(v(x0, y0, z0), v(x1, y1, z1), 0.006));
    };
    piece(a + gap, a + bar, c + gap, d - gap);
    piece(b - bar, b - gap, c + gap, d - gap);
    piece(a + bar + gap, b - bar - gap, c + gap, c + bar);
    piece(a + bar + gap, b - bar - gap, d - bar, d - gap);
    for third in 1..3 {
        let x = a + (b - a) * f64::from(third) / 3.0;
        piece(x - 0.02, x + 0.02, c + bar + gap, d - bar - gap);
    }
    let sill = bevelled(v(a - 0.06, c - 0.045, -Z + 0.002), v(b + 0.06, c - 0.01, -Z + 0.10), 0.008);
    frame.add(palette.trim, sill);
    model.stand("Window frame", frame);
}

fn skirting(model: &mut Model, palette: &Palette) {
    let (gap, thick, height) = (0.002, 0.014, 0.09);
    let mut boards = Parts::default();
    let mut board = |low: DVec3, high: DVec3| boards.add(palette.trim, bevelled(low, high, 0.005));
    let inner = gap + thick + 0.002;
    board(v(-X + gap, gap, -Z + gap), v(X - gap, height, -Z + gap + thick));
    board(v(-X + gap, gap, Z - gap - thick), v(X - gap, height, Z - gap));
    board(v(-X + gap, gap, -Z + inner), v(-X + gap + thick, height, Z - inner));
    board(v(X - gap - thick, gap, -Z + inner), v(X - gap, height, Z - inner));
    model.stand("Skirting boards", boards);
}

/// A luminous rectangle of 1.2 × 0.6 m in a frame under the ceiling.
fn panel(model: &mut Model, palette: &Palette, middle: DVec3) {
    let glow = model.material(Material::new("Panel light", [0.0; 3]).emitting(PANEL));
    let (hx, hz, bar, low, high) = (0.6, 0.3, 0.03, Y - 0.035, Y - 0.002);
    let at = |x: f64, y: f64, z: f64| v(middle.x + x, y, middle.z + z);
    let mut parts = Parts::default();
    let (y, x, z) = (Y - 0.02, hx, hz);
    parts.add(glow, plain([at(-x, y, -z), at(x, y, -z), at(x, y, z), at(-x, y, z)]));
    let mut frame = |low: DVec3, high: DVec3| parts.add(palette.trim, bevelled(low, high, 0.004));
    let gap = 0.001;
    frame(at(-hx - bar, low, -hz - bar), at(hx + bar, high, -hz - gap));
    frame(at(-hx - bar, low, hz + gap), at(hx + bar, high, hz + bar));
    frame(at(-hx - bar, low, -hz), at(-hx - gap, high, hz));
    frame(at(hx + gap, low, -hz), at(hx + bar, high, hz));
    model.stand("Ceiling panel", parts);
}

fn paintings(model: &mut Model, palette: &Palette) {
    let [hills, bars, rings] = palette.paintings;
    for (name, material, size, position, turn) in [
        ("Painting of hills", hills, [1.15, 0.86], v(-1.55, 1.72, -Z), 0.0),
        ("Painting of bars", bars, [0.70, 0.70], v(-X, 1.65, 1.95), 90.0),
        ("Painting of rings", rings, [0.60, 0.80], v(X, 1.65, -0.4), -90.0),
    ] {
        let (w, h) = (0.5 * size[0], 0.5 * size[1]);
        let mut parts = Parts::default();
        parts.add(palette.plastic, cuboid(v(-w - 0.012, -h - 0.012, 0.004), v(w + 0.012, h + 0.012, 0.018)));
        let (b, near, far) = (0.028, 0.018 + 0.001, 0.034);
        let mut bar = |low: DVec3, high: DVec3| parts.add(palette.birch, bevelled(low, high, 0.005));
        bar(v(-w - b, h, near), v(w + b, h + b, far));
        bar(v(-w - b, -h - b, near), v(w + b, -h, far));
        bar(v(-w - b, -h + 0.001, near), v(-w, h - 0.001, far));
        bar(v(w, -h + 0.001, near), v(w + b, h - 0.001, far));
        let z = 0.022;
        let corners = [v(-w, -h, z), v(w, -h, z), v(w, h, z), v(-w, h, z)];
        parts.add(material, quad(corners, DVec2::ONE));
        let mesh = model.mesh(parts);
        model.place(name, mesh, position.to_array(), turn);
    }
}
