//! Things of glass: a ball, a block and a coloured pane in a tiled room.

use crate::glb::{Material, Model, Parts};
use crate::pictures;
use crate::shapes::{
    boxes::{cuboid, plain, quad},
    round::lathe,
    v,
};
use glam::DVec2;
use std::{f64::consts::PI, path::PathBuf};

/// Files in `glass/`.
pub fn files() -> Vec<(PathBuf, Vec<u8>)> {
    vec![("glass/glass.glb".into(), glass().bytes()), ("glass/glass.ron".into(), GLASS.as_bytes().to_vec())]
}

const GLASS: &str = "\
// Glass: a ball and a block bend what is seen through them, a pane colours it; the lamp lights through the pane.
(
    models: [(file: \"glass.glb\")],
    movable: [\"Ball\", \"Pane\"],
    area_lamps: [
        (name: \"Lamp\", corner: (-1.3, 2.0, 0.2), edge_u: (0.8, 0.0, 0.0), edge_v: (0.0, 0.0, 0.8),
         radiance: (1400.0, 1340.0, 1240.0)),
    ],
    camera: Some((
        eye: (0.5, 0.85, 2.3),
        target: (0.05, 0.3, 0.0),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 0.62,
    )),
    plan: (volume: Some(false)),
)
";

/// Radius of the ball, m.
const RADIUS: f64 = 0.28;

fn glass() -> Model {
    let mut model = Model::default();
    let checks = model.picture(pictures::checks());
    let floor = model.material(Material { picture: Some(checks), ..Material::new("Tiles", [0.8; 3]) });
    let light = model.material(Material::new("Light", [0.75, 0.74, 0.70]));
    let red = model.material(Material::new("Red", [0.60, 0.16, 0.12]));
    let clear = model.material(Material::new("Glass", [0.98, 0.99, 0.98]).glass(true));
    let amber = model.material(Material::new("Amber pane", [0.95, 0.66, 0.25]).glass(false));
    let ground = [v(-2.0, 0.0, 2.5), v(2.0, 0.0, 2.5), v(2.0, 0.0, -1.6), v(-2.0, 0.0, -1.6)];
    model.stand("Floor", Parts::of(floor, quad(ground, DVec2::splat(4.0))));
    let back = [v(-2.0, 0.0, -1.6), v(2.0, 0.0, -1.6), v(2.0, 2.2, -1.6), v(-2.0, 2.2, -1.6)];
    model.stand("Back wall", Parts::of(light, plain(back)));
    let left = [v(-2.0, 0.0, 2.5), v(-2.0, 0.0, -1.6), v(-2.0, 2.2, -1.6), v(-2.0, 2.2, 2.5)];
    model.stand("Left wall", Parts::of(red, plain(left)));
    let right = [v(2.0, 0.0, -1.6), v(2.0, 0.0, 2.5), v(2.0, 2.2, 2.5), v(2.0, 2.2, -1.6)];
    model.stand("Right wall", Parts::of(light, plain(right)));
    let front = [v(2.0, 0.0, 2.5), v(-2.0, 0.0, 2.5), v(-2.0, 2.2, 2.5), v(2.0, 2.2, 2.5)];
    model.stand("Front wall", Parts::of(light, plain(front)));
    let above = [v(-2.0, 2.2, -1.6), v(2.0, 2.2, -1.6), v(2.0, 2.2, 2.5), v(-2.0, 2.2, 2.5)];
    model.stand("Ceiling", Parts::of(light, plain(above)));
    let arc = |i: u32| f64::from(i) / 28.0 * PI;
    let profile: Vec<DVec2> =
        (0..=28).map(|i| DVec2::new(RADIUS * arc(i).sin(), -RADIUS * arc(i).cos())).collect();
    let ball = model.mesh(Parts::of(clear, lathe(&profile, 48, false).welded()));
    // 1 mm above the floor, as is the block.
    model.place("Ball", ball, [0.42, RADIUS + 0.001, 0.25], 0.0);
    let block = model.mesh(Parts::of(clear, cuboid(v(-0.14, 0.0, -0.14), v(0.14, 0.62, 0.14))));
    model.place("Block", block, [-0.15, 0.001, 0.0], 30.0);
    let corners = [v(-0.3, 0.0, 0.0), v(0.3, 0.0, 0.0), v(0.3, 0.8, 0.0), v(-0.3, 0.8, 0.0)];
    let pane = model.mesh(Parts::of(amber, plain(corners)));
    model.place("Pane", pane, [-0.75, 0.001, 0.35], 35.0);
    model
}
