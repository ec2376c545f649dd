//! The shell of the house: walls with windows and an arch, floors, gallery, doors, trim.

use super::palette::Palette;
use crate::glb::{Material, Model, Parts};
use crate::pictures;
use crate::shapes::{
    Shape,
    boxes::{bevelled, cuboid, plain, quad},
    round::{lathe, rounded},
    v,
};
use glam::{DMat3, DVec2, DVec3};

/// Half the house along x, m; the music room lies at −x.
pub const X: f64 = 5.0;
/// Half the house along z, m.
pub const Z: f64 = 3.0;
/// Height of the music room, m.
pub const LOW: f64 = 2.9;
/// Height of the living room with its gallery, m.
pub const HIGH: f64 = 5.0;
/// Half the thickness of the wall between the rooms, m.
const HALF_WALL: f64 = 0.08;
/// Clearance between things, m.
const GAP: f64 = 0.002;
/// Depth of a window's recess, m.
const RECESS: f64 = 0.2;
/// Radiance of the garden where its picture is white, cd/m².
const GARDEN: [f64; 3] = [640.0, 660.0, 690.0];

/// Adds that of the music room, with the wall between the rooms.
pub fn music_room(model: &mut Model, palette: &Palette) {
    model.stand("Music room floor", Parts::of(palette.parquet, quad(ground(-X, 0.0), DVec2::new(2.5, 3.0))));
    model.stand("Music room ceiling", Parts::of(palette.ceiling, ceiling(-X, -HALF_WALL, LOW)));
    music_walls(model, palette);
    let mut frames = Parts::default();
    let mut panes = Shape::default();
    let back = -Z - RECESS;
    for [a, b, c, d] in WINDOWS {
        panes.add(&quad([v(a, c, back), v(b, c, back), v(b, d, back), v(a, d, back)], DVec2::ONE));
        frames.add(palette.trim, casement(DVec2::new(b - a, d - c)).moved(v(0.5 * (a + b), c, -Z)));
    }
    windows(model, "Windows", panes, frames);
    door(model, palette);
    let mut boards = Parts::default();
    let mut board = |low: DVec3, high: DVec3| boards.add(palette.trim, bevelled(low, high, 0.006));
    for (y0, y1, out) in [(0.003, 0.12, 0.016), (LOW - 0.10, LOW - 0.003, 0.08)] {
        board(v(-X + GAP, y0, -Z + 0.10), v(-X + GAP + out, y1, Z - 0.10));
        board(v(-X + 0.10, y0, Z - GAP - out), v(-HALF_WALL - 0.10, y1, Z - GAP));
        board(v(-X + 0.10, y0, -Z + GAP), v(-HALF_WALL - 0.10, y1, -Z + GAP + out));
    }
    model.stand("Skirting and cornices", boards);
    arch(model, palette);
}

/// Adds that of the living room.
pub fn living_room(model: &mut Model, palette: &Palette) {
    model.stand("Living room floor", Parts::of(palette.planks, quad(ground(0.0, X), DVec2::new(2.5, 3.0))));
    model.stand("Living room ceiling", Parts::of(palette.ceiling, ceiling(HALF_WALL, X, HIGH)));
    living_walls(model, palette);
    let [a, b, c, d] = SIDE_WINDOW;
    let x = X + RECESS;
    let pane = quad([v(x, c, a), v(x, c, b), v(x, d, b), v(x, d, a)], DVec2::new(2.0, 1.0));
    let turned = casement(DVec2::new(b - a, d - c)).turned_y(-90.0);
    let frame = Parts::of(palette.trim, turned.moved(v(X, c, 0.5 * (a + b))));
    windows(model, "Side window", pane, frame);
    let mut boards = Parts::default();
    let mut board =
        |low: DVec3, high: DVec3, bevel: f64| boards.add(palette.trim, bevelled(low, high, bevel));
    board(v(HALF_WALL + 0.10, 0.003, Z - GAP - 0.016), v(X - 0.10, 0.12, Z - GAP), 0.006);
    board(v(X - GAP - 0.016, 0.003, -Z + 0.10), v(X - GAP, 0.12, Z - 0.10), 0.006);
    board(v(HALF_WALL + 0.10, HIGH - 0.13, Z - GAP - 0.1), v(X - 0.12, HIGH - 0.003, Z - GAP), 0.01);
    board(v(HALF_WALL + 0.10, HIGH - 0.13, -Z + GAP), v(X - 0.12, HIGH - 0.003, -Z + GAP + 0.1), 0.01);
    model.stand("Living room skirting and cornices", boards);
}

fn ground(a: f64, b: f64) -> [DVec3; 4] {
    [v(a, 0.0, Z), v(b, 0.0, Z), v(b, 0.0, -Z), v(a, 0.0, -Z)]
}

fn ceiling(a: f64, b: f64, y: f64) -> Shape {
    plain([v(a, y, -Z), v(b, y, -Z), v(b, y, Z), v(a, y, Z)])
}

/// A wall from a lower corner along `along` and up, with rectangular holes (from, to, low, high), m; its
/// front is `along × up`. Behind a hole the reveals reach `depth` back.
fn pierced(corner: DVec3, along: DVec3, size: DVec2, holes: &[[f64; 4]], depth: f64) -> Shape {
    let cuts = |ends: f64, i: usize| {
        let mut at = vec![0.0, ends];
        at.extend(holes.iter().flat_map(|h| [h[i], h[i + 1]]));
        at.sort_by(f64::total_cmp);
        at.dedup();
        at
    };
    let (us, vs) = (cuts(size.x, 0), cuts(size.y, 2));
    let at = |u: f64, w: f64, back: f64| corner + along * u + DVec3::Y * w - along.cross(DVec3::Y) * back;
    let mut wall = Shape::default();
    for u in us.windows(2) {
        for w in vs.windows(2) {
            let open = |h: &[f64; 4]| u[0] >= h[0] && u[1] <= h[1] && w[0] >= h[2] && w[1] <= h[3];
            if !holes.iter().any(open) {
                let corners = [[u[0], w[0]], [u[1], w[0]], [u[1], w[1]], [u[0], w[1]]];
                wall.add(&plain(corners.map(|[u, w]| at(u, w, 0.0))));
            }
        }
    }
    for &[a, b, c, d] in holes.iter().filter(|_| depth > 0.0) {
        // The reveals meet the grid's edges: cut where it is cut.
        for w in vs.windows(2).filter(|w| w[0] >= c && w[1] <= d) {
            wall.add(&plain([at(a, w[0], 0.0), at(a, w[0], depth), at(a, w[1], depth), at(a, w[1], 0.0)]));
            wall.add(&plain([at(b, w[0], depth), at(b, w[0], 0.0), at(b, w[1], 0.0), at(b, w[1], depth)]));
        }
        for u in us.windows(2).filter(|u| u[0] >= a && u[1] <= b) {
            if c > 0.0 {
                wall.add(&plain([
                    at(u[0], c, depth),
                    at(u[0], c, 0.0),
                    at(u[1], c, 0.0),
                    at(u[1], c, depth),
                ]));
            }
            wall.add(&plain([at(u[0], d, 0.0), at(u[0], d, depth), at(u[1], d, depth), at(u[1], d, 0.0)]));
        }
    }
    wall
}

/// Windows of the music room in its back wall: from, to along x, low, high.
const WINDOWS: [[f64; 4]; 2] = [[-4.35, -3.15, 0.35, 2.45], [-2.35, -1.15, 0.35, 2.45]];
/// Window of the living room in its right wall, under the gallery: from, to along z, low, high.
const SIDE_WINDOW: [f64; 4] = [-0.6, 1.8, 0.55, 2.35];
/// The arch between the rooms, along z.
const ARCH: [f64; 4] = [-1.2, 1.2, 0.0, 2.35];

fn music_walls(model: &mut Model, palette: &Palette) {
    let music = X - HALF_WALL;
    let back = pierced(
        v(-X, 0.0, -Z),
        DVec3::X,
        DVec2::new(music, LOW),
        &WINDOWS.map(|[a, b, c, d]| [a + X, b + X, c, d]),
        RECESS,
    );
    model.stand("Music room, back wall", Parts::of(palette.sage, back));
    let left = [v(-X, 0.0, Z), v(-X, 0.0, -Z), v(-X, LOW, -Z), v(-X, LOW, Z)];
    model.stand("Music room, left wall", Parts::of(palette.sage, plain(left)));
    let front = [v(-HALF_WALL, 0.0, Z), v(-X, 0.0, Z), v(-X, LOW, Z), v(-HALF_WALL, LOW, Z)];
    model.stand("Music room, front wall", Parts::of(palette.sage, plain(front)));
    // The wall between, with the arch's reveals; the living room's side has none.
    let [a, b, c, d] = ARCH;
    let towards_music = pierced(
        v(-HALF_WALL, 0.0, -Z),
        DVec3::Z,
        DVec2::new(2.0 * Z, LOW),
        &[[a + Z, b + Z, c, d]],
        2.0 * HALF_WALL,
    );
    model.stand("Wall with the arch", Parts::of(palette.sage, towards_music));
}

fn living_walls(model: &mut Model, palette: &Palette) {
    let [a, b, c, d] = ARCH;
    let towards_living =
        pierced(v(HALF_WALL, 0.0, Z), DVec3::NEG_Z, DVec2::new(2.0 * Z, HIGH), &[[Z - b, Z - a, c, d]], 0.0);
    model.stand("Living room, left wall", Parts::of(palette.cream, towards_living));
    let back = [v(HALF_WALL, 0.0, -Z), v(X, 0.0, -Z), v(X, HIGH, -Z), v(HALF_WALL, HIGH, -Z)];
    model.stand("Living room, back wall", Parts::of(palette.ochre, plain(back)));
    let [a, b, c, d] = SIDE_WINDOW;
    let right = pierced(v(X, 0.0, -Z), DVec3::Z, DVec2::new(2.0 * Z, HIGH), &[[a + Z, b + Z, c, d]], RECESS);
    model.stand("Living room, right wall", Parts::of(palette.cream, right));
    let front = [v(X, 0.0, Z), v(HALF_WALL, 0.0, Z), v(HALF_WALL, HIGH, Z), v(X, HIGH, Z)];
    model.stand("Living room, front wall", Parts::of(palette.cream, plain(front)));
}

fn windows(model: &mut Model, name: &str, panes: Shape, frames: Parts) {
    let picture = Some(model.picture(pictures::garden()));
    let garden = model.material(Material {
        radiance: GARDEN,
        radiance_picture: picture,
        ..Material::new("Garden", [0.04, 0.05, 0.04])
    });
    model.stand(name, Parts::of(garden, panes));
    model.stand(format!("{name}, frames"), frames);
}

/// The frame of a window that stands in a recess behind z = 0, its foot at y = 0, with its sill.
fn casement(size: DVec2) -> Shape {
    let (half, height) = (0.5 * size.x, size.y);
    let (z0, z1, gap, bar) = (-RECESS + 0.02, -RECESS + 0.07, 0.002, 0.05);
    let mut pieces = Vec::new();
    let mut piece = |x0: f64, x1: f64, y0: f64, y1: f64| {
        pieces.push(bevelled(v(x0, y0, z0), v(x1, y1, z1), 0.006));
    };
    piece(-half + gap, -half + bar, gap, height - gap);
    piece(half - bar, half - gap, gap, height - gap);
    piece(-half + bar + gap, half - bar - gap, gap, bar);
    piece(-half + bar + gap, half - bar - gap, height - bar, height - gap);
    piece(-0.018, 0.018, bar + gap, height - bar - gap);
    for k in 1..4 {
        let y = height * f64::from(k) / 4.0;
        for side in [-1.0, 1.0] {
            let (from, to) = (side * 0.020, side * (half - bar - gap));
            piece(from.min(to), from.max(to), y - 0.012, y + 0.012);
        }
    }
    pieces.push(bevelled(v(-half - 0.06, -0.045, 0.002), v(half + 0.06, -0.01, 0.11), 0.008));
    Shape::join(pieces)
}

/// The mirrored door in the wall with the arch, seen from the music room.
fn door(model: &mut Model, palette: &Palette) {
    let (z0, z1, top) = (1.72, 2.56, 2.08);
    let wall = -HALF_WALL;
    let mut parts = Parts::default();
    parts.add(palette.trim, bevelled(v(wall - 0.045, 0.004, z0), v(wall - 0.002, top, z1), 0.004));
    let x = wall - 0.0465;
    let mut rail = |low: DVec3, high: DVec3| parts.add(palette.trim, bevelled(low, high, 0.004));
    let (front, stile) = (x - 0.012, 0.085);
    rail(v(front, 0.004, z0), v(x, top, z0 + stile));
    rail(v(front, 0.004, z1 - stile), v(x, top, z1));
    rail(v(front, 0.004, z0 + stile + 0.001), v(x, 0.20, z1 - stile - 0.001));
    rail(v(front, top - 0.10, z0 + stile + 0.001), v(x, top, z1 - stile - 0.001));
    let knob = [[0.0, 0.0], [0.022, 0.0], [0.022, 0.006], [0.009, 0.012], [0.009, 0.030], [0.024, 0.040]];
    let knob = [&knob[..], &[[0.028, 0.055], [0.020, 0.068], [0.0, 0.071]]].concat();
    let out = DMat3::from_rotation_z(90f64.to_radians());
    let knob =
        lathe(&rounded(&knob, 0.004, 2, false), 24, false).placed(out, v(front - 0.001, 1.02, z0 + 0.043));
    parts.add(palette.brass, knob);
    // The architrave.
    let mut post = |z: [f64; 2], y: [f64; 2]| {
        let (low, high) = (v(wall - 0.075, y[0], z[0]), v(wall - 0.002, y[1], z[1]));
        parts.add(palette.trim, bevelled(low, high, 0.012));
    };
    post([z0 - 0.11, z0 - 0.004], [0.004, top + 0.004]);
    post([z1 + 0.004, z1 + 0.11], [0.004, top + 0.004]);
    post([z0 - 0.14, z1 + 0.14], [top + 0.008, top + 0.13]);
    model.stand("Door", parts);
    let (a, b, c, d) = (z0 + stile + 0.001, z1 - stile - 0.001, 0.201, top - 0.101);
    let x = wall - 0.0475;
    let glass = plain([v(x, c, a), v(x, c, b), v(x, d, b), v(x, d, a)]);
    model.stand("Door mirror", Parts::of(palette.door_glass, glass));
}

/// The casing round the arch, on both sides, and its threshold.
fn arch(model: &mut Model, palette: &Palette) {
    let [a, b, _, d] = ARCH;
    let mut arch = Parts::default();
    for side in [-1.0, 1.0] {
        let (near, far) = (side * (HALF_WALL + 0.002), side * (HALF_WALL + 0.03));
        let (x0, x1) = (near.min(far), near.max(far));
        let mut piece = |z0: f64, z1: f64, y0: f64, y1: f64| {
            arch.add(palette.trim, bevelled(v(x0, y0, z0), v(x1, y1, z1), 0.008));
        };
        piece(a - 0.13, a - 0.01, 0.003, d + 0.01);
        piece(b + 0.01, b + 0.13, 0.003, d + 0.01);
        piece(a - 0.16, b + 0.16, d + 0.012, d + 0.15);
    }
    model.stand("Arch", arch);
    let threshold = cuboid(v(-HALF_WALL, 0.0005, a + 0.002), v(HALF_WALL, 0.006, b - 0.002));
    model.stand("Threshold", Parts::of(palette.walnut, threshold));
}
