//! Scenes where an irradiance volume is known to fail: thin walls, tunnels, samples inside solids.

use crate::glb::{Material, Model, Parts};
use crate::shapes::{Shape, boxes::cuboid, v};
use std::path::PathBuf;

/// Their files in `analytic/`.
pub fn files() -> Vec<(PathBuf, Vec<u8>)> {
    let scenes = [
        ("two_rooms", two_rooms(), TWO_ROOMS),
        ("tunnel", tunnel(), TUNNEL),
        ("closed_box", closed_box(), CLOSED_BOX),
    ];
    let mut files = Vec::new();
    for (name, model, text) in scenes {
        files.push((PathBuf::from(format!("analytic/{name}.glb")), model.bytes()));
        files.push((PathBuf::from(format!("analytic/{name}.ron")), text.to_owned().into_bytes()));
    }
    files
}

const TWO_ROOMS: &str = "\
// Two rooms of grey walls, 4 m x 2.5 m x 3 m together, divided by a wall 2 cm thick from x = 0.29 to
// x = 0.31. A lamp hangs in the room on the left; no light reaches the one on the right: E = 0 there.
(
    models: [(file: \"two_rooms.glb\")],
    area_lamps: [
        (name: \"Lamp\", corner: (-1.4, 2.45, -0.3), edge_u: (0.6, 0.0, 0.0), edge_v: (0.0, 0.0, 0.6),
         radiance: (1000.0, 1000.0, 1000.0)),
    ],
    camera: Some((
        eye: (-1.8, 1.6, 1.4),
        target: (0.3, 1.0, 0.0),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 1.1,
    )),
    plan: (volume: Some(true)),
)
";

const TUNNEL: &str = "\
// A tunnel of 12 m x 2 m x 2 m of grey walls, reflectance 0.5, with a lamp at the end x = 0. Light dies off
// along it and is never 0.
(
    models: [(file: \"tunnel.glb\")],
    area_lamps: [
        (name: \"Lamp\", corner: (0.05, 0.75, 0.25), edge_u: (0.0, 0.0, -0.5), edge_v: (0.0, 0.5, 0.0),
         radiance: (5000.0, 5000.0, 5000.0)),
    ],
    camera: Some((
        eye: (11.5, 1.0, 0.0),
        target: (0.0, 1.0, 0.0),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 1.1,
    )),
    plan: (volume: Some(true)),
)
";

const CLOSED_BOX: &str = "\
// A closed box of 1 m with walls 20 cm thick stands in a lit room of 3 m x 2.5 m x 3 m. Inside it is dark:
// E = 0. Its walls hold samples that see nothing but backs.
(
    models: [(file: \"closed_box.glb\")],
    area_lamps: [
        (name: \"Lamp\", corner: (-0.3, 2.45, -0.3), edge_u: (0.6, 0.0, 0.0), edge_v: (0.0, 0.0, 0.6),
         radiance: (1000.0, 1000.0, 1000.0)),
    ],
    camera: Some((
        eye: (-1.3, 1.7, 1.3),
        target: (0.0, 0.6, 0.0),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 1.1,
    )),
    plan: (volume: Some(true)),
)
";

fn grey(model: &mut Model) -> usize {
    model.material(Material::new("Grey", [0.5; 3]))
}

fn room(low: [f64; 3], high: [f64; 3]) -> Shape {
    cuboid(v(low[0], low[1], low[2]), v(high[0], high[1], high[2])).inverted()
}

fn two_rooms() -> Model {
    let mut model = Model::default();
    let material = grey(&mut model);
    model.stand("Lit room", Parts::of(material, room([-2.0, 0.0, -1.5], [0.29, 2.5, 1.5])));
    model.stand("Dark room", Parts::of(material, room([0.31, 0.0, -1.5], [2.0, 2.5, 1.5])));
    model.stand("Chest in the dark", Parts::of(material, cuboid(v(1.2, 0.001, -0.4), v(1.7, 0.5, 0.4))));
    model
}

fn tunnel() -> Model {
    let mut model = Model::default();
    let material = grey(&mut model);
    model.stand("Tunnel", Parts::of(material, room([0.0, 0.0, -1.0], [12.0, 2.0, 1.0])));
    model
}

fn closed_box() -> Model {
    let mut model = Model::default();
    let material = grey(&mut model);
    model.stand("Room", Parts::of(material, room([-1.5, 0.0, -1.5], [1.5, 2.5, 1.5])));
    let outside = cuboid(v(-0.5, 0.01, -0.5), v(0.5, 1.01, 0.5));
    model.stand("Box, outside", Parts::of(material, outside));
    model.stand("Box, inside", Parts::of(material, room([-0.3, 0.21, -0.3], [0.3, 0.81, 0.3])));
    model
}
