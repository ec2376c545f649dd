//! The Cornell box, with the dimensions published at <https://www.graphics.cornell.edu/online/box/data.html>.
//!
//! The published box is turned by half a turn about the vertical so that it is right-handed and the
//! camera looks along −z; its slightly skew measured floor is a rectangle here. The blocks stand 1 mm
//! above the floor and may be dragged. Its texture coordinates are a lightmap's: every face has a place of its own.

use crate::glb::{Material, Model, Parts};
use crate::shapes::{
    Shape,
    boxes::{hexahedron, lay_out, plain},
    round::lathe,
    v,
};
use glam::{DVec2, DVec3};
use std::{f64::consts::PI, path::PathBuf};

const WIDTH: f64 = 0.5528;
const HEIGHT: f64 = 0.5488;
const DEPTH: f64 = 0.5592;
/// Radiance of the lamp, cd/m², in the published warm ratio 17 : 12 : 4.
const LAMP_RADIANCE: [f64; 3] = [17_000.0, 12_000.0, 4_000.0];

/// A published point, in millimetres, in our frame.
fn published(x: f64, y: f64, z: f64) -> DVec3 {
    v(0.5 * WIDTH - x * 1e-3, y * 1e-3, -z * 1e-3)
}

/// `cornell/cornell.glb`, `cornell/cornell.ron`; with quadtrees `cornell/quadtrees.ron`, with a ball `cornell/ball.ron`,
/// with a column and a sail `cornell/patches.ron`.
pub fn files() -> Vec<(PathBuf, Vec<u8>)> {
    vec![
        ("cornell/cornell.glb".into(), model().bytes()),
        ("cornell/cornell.ron".into(), scene(RON)),
        ("cornell/quadtrees.ron".into(), scene(QUADTREES)),
        ("cornell/ball.glb".into(), ball().bytes()),
        ("cornell/ball.ron".into(), BALL.as_bytes().to_vec()),
        ("cornell/patches.glb".into(), patches().bytes()),
        ("cornell/patches.ron".into(), PATCHES.as_bytes().to_vec()),
    ]
}

/// What a scene file begins with, and what it has beside the box.
type Words = [&'static str; 2];

fn scene([about, own]: Words) -> Vec<u8> {
    format!("{about}(\n{BOX}{own})\n").into_bytes()
}

const BOX: &str = "    models: [(file: \"cornell.glb\")],
    movable: [\"Short block\", \"Tall block\"],
    camera: Some((
        eye: (0.0, 0.273, 0.8),
        target: (0.0, 0.273, 0.0),
        up: (0.0, 1.0, 0.0),
        // 2 atan(0.0125 / 0.035): the published lens and film.
        vertical_fov: 0.6861,
    )),
";

const RON: Words = [
    "\
// The Cornell box, in metres, from its published dimensions; the lamp is an emissive rectangle.
// Both blocks may be dragged.
",
    "    planes: [(
        name: \"Floor\",
        corner: (-0.2764, 0.0, 0.0),
        edge_u: (0.5528, 0.0, 0.0),
        edge_v: (0.0, 0.0, -0.5592),
    )],
",
];

const QUADTREES: Words = [
    "\
// The Cornell box with radiosity on quadtrees: cells of 8 cm, split up to three times where light bends.
",
    "    plan: (
        element_spacing_m: 0.08,
        element_levels: 3,
        element_tolerance: 0.05,
        element_restricted: true,
    ),
",
];

const BALL: &str = "\
// The Cornell box with a ball on the short block: its light is one texture by longitude and latitude.
(
    models: [(file: \"cornell.glb\"), (file: \"ball.glb\")],
    camera: Some((
        eye: (0.0, 0.273, 0.8),
        target: (0.0, 0.273, 0.0),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 0.6861,
    )),
    plan: (element_spacing_m: 0.02),
)
";

const PATCHES: &str = "\
// The Cornell box with a column on the short block and a sail beside the tall one: the column's side is one texture
// that goes round, the sail's is a triangle.
(
    models: [(file: \"cornell.glb\"), (file: \"patches.glb\")],
    camera: Some((
        eye: (0.0, 0.273, 0.8),
        target: (0.0, 0.273, 0.0),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 0.6861,
    )),
    plan: (element_spacing_m: 0.02),
)
";

/// A dull column, 1 mm above the short block, and a sail on the floor.
fn patches() -> Model {
    const RADIUS: f64 = 0.05;
    const ROWS: u32 = 9;
    let mut model = Model::default();
    let white = model.material(Material::new("White", [0.73, 0.73, 0.73]));
    let cloth = Material { double_sided: true, ..Material::new("Cloth", [0.6, 0.6, 0.6]) };
    let cloth = model.material(cloth);
    let side = (0..=ROWS).map(|i| DVec2::new(RADIUS, 0.02 * f64::from(i)));
    let top = DVec2::new(0.0, 0.02 * f64::from(ROWS));
    let profile: Vec<DVec2> = side.chain([top]).collect();
    let mesh = model.mesh(Parts::of(white, lathe(&profile, 48, false).welded()));
    model.place("Column", mesh, [0.09, 0.167, -0.169], 0.0);
    let corners = [v(-0.24, 0.001, -0.06), v(-0.06, 0.001, -0.1), v(-0.2, 0.2, -0.12)];
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    let mut sail = Shape::default();
    sail.triangles = vec![corners.map(|corner| sail.vertex(corner, normal))];
    model.stand("Sail", Parts::of(cloth, sail));
    model
}

/// A dull ball, 1 mm above the short block.
fn ball() -> Model {
    const RADIUS: f64 = 0.08;
    let mut model = Model::default();
    let white = model.material(Material::new("White", [0.73, 0.73, 0.73]));
    let arc = |i: u32| f64::from(i) / 24.0 * PI;
    let profile: Vec<DVec2> =
        (0..=24).map(|i| DVec2::new(RADIUS * arc(i).sin(), -RADIUS * arc(i).cos())).collect();
    let mesh = model.mesh(Parts::of(white, lathe(&profile, 48, false).welded()));
    model.place("Ball", mesh, [0.09, 0.167 + RADIUS, -0.169], 0.0);
    model
}

fn model() -> Model {
    let mut model = Model::default();
    let white = model.material(Material::new("White", [0.73, 0.73, 0.73]));
    let red = model.material(Material::new("Red", [0.63, 0.06, 0.05]));
    let green = model.material(Material::new("Green", [0.14, 0.45, 0.09]));
    let lamp = model.material(Material::new("Lamp", [0.0; 3]).emitting(LAMP_RADIANCE));
    let (x, y, z) = (0.5 * WIDTH, HEIGHT, -DEPTH);
    let corner =
        |sx: f64, top: bool, back: bool| v(sx * x, if top { y } else { 0.0 }, if back { z } else { 0.0 });
    let wall = |c: [(f64, bool, bool); 4]| plain(c.map(|(s, t, b)| corner(s, t, b)));
    let (l, r) = (-1.0, 1.0);
    let mut floor = wall([(l, false, false), (r, false, false), (r, false, true), (l, false, true)]);
    let mut ceiling = wall([(l, true, true), (r, true, true), (r, true, false), (l, true, false)]);
    let mut back = wall([(l, false, true), (r, false, true), (r, true, true), (l, true, true)]);
    let mut left = wall([(l, false, false), (l, false, true), (l, true, true), (l, true, false)]);
    let mut right = wall([(r, false, true), (r, false, false), (r, true, false), (r, true, true)]);
    // 1 mm below the ceiling.
    let lamp_y = HEIGHT * 1e3 - 1.0;
    let corners = [(343.0, 332.0), (213.0, 332.0), (213.0, 227.0), (343.0, 227.0)];
    let mut panel = plain(corners.map(|(x, z)| published(x, lamp_y, z)));
    let short = [(130.0, 65.0), (82.0, 225.0), (240.0, 272.0), (290.0, 114.0)];
    let tall = [(423.0, 247.0), (265.0, 296.0), (314.0, 456.0), (472.0, 406.0)];
    let ((mut short, short_at), (mut tall, tall_at)) = (block(short, 165.0), block(tall, 330.0));
    let all = [&mut floor, &mut ceiling, &mut back, &mut left, &mut right, &mut tall, &mut short, &mut panel];
    lay_out(&mut { all }, 1.8, 0.02);
    model.stand("Floor", Parts::of(white, floor));
    model.stand("Ceiling", Parts::of(white, ceiling));
    model.stand("Back wall", Parts::of(white, back));
    model.stand("Left wall", Parts::of(red, left));
    model.stand("Right wall", Parts::of(green, right));
    model.stand("Lamp", Parts::of(lamp, panel));
    for (name, shape, at) in [("Short block", short, short_at), ("Tall block", tall, tall_at)] {
        let mesh = model.mesh(Parts::of(white, shape));
        model.place(name, mesh, [at.x, 0.001, at.z], 0.0);
    }
    model
}

/// A block from the published corners of its top about the middle of its foot, and where that is.
fn block(top: [(f64, f64); 4], height: f64) -> (Shape, DVec3) {
    let middle = top.iter().map(|&(x, z)| published(x, 0.0, z)).sum::<DVec3>() / 4.0;
    let foot = top.map(|(x, z)| published(x, 0.0, z) - middle);
    let lift = v(0.0, height * 1e-3, 0.0);
    let mut corners = [DVec3::ZERO; 8];
    for i in 0..4 {
        corners[i] = foot[i];
        corners[i + 4] = foot[i] + lift;
    }
    let turn = |s: &Shape| {
        let volume: f64 = s
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| s.positions[i as usize]);
                a.dot(b.cross(c))
            })
            .sum();
        volume < 0.0
    };
    let shape = hexahedron(corners);
    (if turn(&shape) { shape.inverted() } else { shape }, middle)
}
