//! Polished things: a teapot over a glossy table before a checkered wall, and a pyramid of copper.

use crate::glb::{Material, Model, Parts};
use crate::pictures;
use crate::shapes::{
    Shape,
    boxes::{plain, quad},
    round::{bent, lathe, rounded, tube},
    v,
};
use glam::DVec2;
use std::path::PathBuf;

/// Files in `glossy/` and `mirror/`.
pub fn files() -> Vec<(PathBuf, Vec<u8>)> {
    vec![
        ("glossy/teapot.glb".into(), teapot_table(glaze()).bytes()),
        ("glossy/teapot.ron".into(), TEAPOT.as_bytes().to_vec()),
        ("glossy/phong.ron".into(), PHONG.as_bytes().to_vec()),
        ("glossy/chrome.glb".into(), teapot_table(chrome()).bytes()),
        ("glossy/chrome.ron".into(), CHROME.as_bytes().to_vec()),
        ("mirror/pyramid.glb".into(), pyramid().bytes()),
        ("mirror/pyramid.ron".into(), PYRAMID.as_bytes().to_vec()),
    ]
}

const TEAPOT: &str = "\
// A teapot on a lacquered table of roughness 0.2 before a checkered wall. What touches the table is mirrored
// sharply, what is farther away is blurred.
(
    models: [(file: \"teapot.glb\")],
    movable: [\"Teapot\"],
    area_lamps: [
        (name: \"Lamp\", corner: (-0.5, 1.5, 0.1), edge_u: (1.0, 0.0, 0.0), edge_v: (0.0, 0.0, 0.6),
         radiance: (900.0, 850.0, 760.0)),
    ],
    camera: Some((
        eye: (0.35, 0.46, 1.25),
        target: (0.02, 0.08, -0.1),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 0.62,
    )),
    plan: (volume: Some(false)),
)
";

const PHONG: &str = "\
// The same table with Phong's lobe, as wide as that of GGX: what it mirrors is blurred alike in every direction,
// where microfacets seen aslant draw it out towards the eye.
(
    models: [(file: \"teapot.glb\")],
    phong: [\"Lacquer\"],
    movable: [\"Teapot\"],
    area_lamps: [
        (name: \"Lamp\", corner: (-0.5, 1.5, 0.1), edge_u: (1.0, 0.0, 0.0), edge_v: (0.0, 0.0, 0.6),
         radiance: (900.0, 850.0, 760.0)),
    ],
    camera: Some((
        eye: (0.35, 0.46, 1.25),
        target: (0.02, 0.08, -0.1),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 0.62,
    )),
    plan: (volume: Some(false)),
)
";

const CHROME: &str = "\
// The same teapot in chrome: what is curved shows a map of the light around it, and the table blurs what it
// mirrors of both.
(
    models: [(file: \"chrome.glb\")],
    area_lamps: [
        (name: \"Lamp\", corner: (-0.5, 1.5, 0.1), edge_u: (1.0, 0.0, 0.0), edge_v: (0.0, 0.0, 0.6),
         radiance: (900.0, 850.0, 760.0)),
    ],
    camera: Some((
        eye: (0.3, 0.34, 0.75),
        target: (0.0, 0.1, -0.02),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 0.5,
    )),
    plan: (volume: Some(false)),
)
";

const PYRAMID: &str = "\
// A pyramid of polished copper on the tiled floor of a room with one blue wall: its faces mirror less the
// more they face the eye, and redder.
(
    models: [(file: \"pyramid.glb\")],
    area_lamps: [
        (name: \"Lamp\", corner: (-0.6, 2.4, -0.6), edge_u: (1.2, 0.0, 0.0), edge_v: (0.0, 0.0, 1.2),
         radiance: (700.0, 680.0, 640.0)),
    ],
    camera: Some((
        eye: (1.1, 0.95, 1.9),
        target: (0.0, 0.3, 0.0),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 0.7,
    )),
    plan: (volume: Some(false)),
)
";

fn glaze() -> Material {
    Material::new("Glaze", [0.55, 0.62, 0.40])
}

fn chrome() -> Material {
    Material::new("Chrome", [0.66, 0.67, 0.68]).polished(1.0, 0.0)
}

/// A teapot of some material on a lacquered table before a checkered wall.
fn teapot_table(of: Material) -> Model {
    let mut model = Model::default();
    let checks = model.picture(pictures::checks());
    let table = model.material(Material::new("Lacquer", [0.10, 0.03, 0.02]).polished(0.0, 0.2));
    let wall = model.material(Material { picture: Some(checks), ..Material::new("Checks", [0.9; 3]) });
    let of = model.material(of);
    let top = [v(-0.9, 0.0, 0.7), v(0.9, 0.0, 0.7), v(0.9, 0.0, -0.5), v(-0.9, 0.0, -0.5)];
    model.stand("Table", Parts::of(table, plain(top)));
    let back = [v(-0.9, 0.0, -0.5), v(0.9, 0.0, -0.5), v(0.9, 0.9, -0.5), v(-0.9, 0.9, -0.5)];
    model.stand("Wall", Parts::of(wall, quad(back, DVec2::ONE)));
    let pot = model.mesh(Parts::of(of, teapot()));
    // 0.2 mm above the table.
    model.place("Teapot", pot, [0.0, 0.0002, 0.0], 25.0);
    model
}

/// A teapot 21 cm high, its origin in the middle of its foot.
fn teapot() -> Shape {
    let body = [
        [0.0, 0.0],
        [0.070, 0.0],
        [0.075, 0.012],
        [0.105, 0.050],
        [0.115, 0.090],
        [0.098, 0.135],
        [0.062, 0.160],
        [0.055, 0.168],
        [0.030, 0.180],
        [0.012, 0.184],
        [0.010, 0.192],
        [0.018, 0.204],
        [0.0, 0.212],
    ];
    let spout =
        bent(&[v(0.09, 0.06, 0.0), v(0.15, 0.08, 0.0), v(0.16, 0.13, 0.0), v(0.20, 0.155, 0.0)], 0.03, 4);
    let last = spout.len() as f64 - 1.0;
    let radii: Vec<f64> = (0..spout.len()).map(|i| 0.026 - 0.014 * i as f64 / last).collect();
    let handle =
        bent(&[v(-0.09, 0.14, 0.0), v(-0.16, 0.15, 0.0), v(-0.18, 0.08, 0.0), v(-0.10, 0.05, 0.0)], 0.03, 4);
    let thin = vec![0.010; handle.len()];
    Shape::join([
        lathe(&rounded(&body, 0.02, 3, false), 40, false),
        tube(&spout, &radii, 14),
        tube(&handle, &thin, 10),
    ])
}

fn pyramid() -> Model {
    let mut model = Model::default();
    let checks = model.picture(pictures::checks());
    let copper = model.material(Material::new("Copper", [0.89, 0.59, 0.50]).polished(1.0, 0.0));
    let floor = model.material(Material { picture: Some(checks), ..Material::new("Tiles", [0.8; 3]) });
    let blue = model.material(Material::new("Blue", [0.20, 0.30, 0.55]));
    let light = model.material(Material::new("Light", [0.75, 0.74, 0.70]));
    let ground = [v(-2.0, 0.0, 2.5), v(2.0, 0.0, 2.5), v(2.0, 0.0, -2.0), v(-2.0, 0.0, -2.0)];
    model.stand("Floor", Parts::of(floor, quad(ground, v(3.0, 3.0, 0.0).truncate())));
    let back = [v(-2.0, 0.0, -2.0), v(2.0, 0.0, -2.0), v(2.0, 2.5, -2.0), v(-2.0, 2.5, -2.0)];
    model.stand("Back wall", Parts::of(blue, plain(back)));
    let left = [v(-2.0, 0.0, 2.5), v(-2.0, 0.0, -2.0), v(-2.0, 2.5, -2.0), v(-2.0, 2.5, 2.5)];
    model.stand("Left wall", Parts::of(light, plain(left)));
    let right = [v(2.0, 0.0, -2.0), v(2.0, 0.0, 2.5), v(2.0, 2.5, 2.5), v(2.0, 2.5, -2.0)];
    model.stand("Right wall", Parts::of(light, plain(right)));
    let front = [v(2.0, 0.0, 2.5), v(-2.0, 0.0, 2.5), v(-2.0, 2.5, 2.5), v(2.0, 2.5, 2.5)];
    model.stand("Front wall", Parts::of(light, plain(front)));
    let above = [v(-2.0, 2.5, -2.0), v(2.0, 2.5, -2.0), v(2.0, 2.5, 2.5), v(-2.0, 2.5, 2.5)];
    model.stand("Ceiling", Parts::of(light, plain(above)));
    let (half, top) = (0.5, v(0.0, 0.75, 0.0));
    let foot = [v(-half, 0.001, half), v(half, 0.001, half), v(half, 0.001, -half), v(-half, 0.001, -half)];
    let mut faces = Shape::default();
    for i in 0..4 {
        let (a, b) = (foot[i], foot[(i + 1) % 4]);
        let normal = (b - a).cross(top - a).normalize();
        let corners = [a, b, top].map(|p| faces.vertex(p, normal));
        faces.triangles.push(corners);
    }
    model.stand("Pyramid", Parts::of(copper, faces.turned_y(20.0)));
    model
}
