//! A hall of boxes in 452 polygons, as many as the model of the dissertation's Table 5.1 has: for benchmarks, not
//! shipped as a file.

use crate::glb::{Material, Model, Parts};
use crate::random::Random;
use crate::shapes::{
    Shape,
    boxes::{cuboid, plain},
    v,
};

/// Boxes that stand in the hall, five quadrilaterals each: their bottoms are left out.
const BOXES: usize = 89;
const HALL: [f64; 3] = [12.0, 4.0, 9.0];

/// Quadrilaterals: the boxes', six of the hall and a lamp.
pub const POLYGONS: usize = 5 * BOXES + 6 + 1;

/// The model; the same seed places the same boxes.
pub fn grotto(seed: u64) -> Model {
    let [w, h, d] = HALL;
    let mut model = Model::default();
    let wall = model.material(Material::new("Wall", [0.7, 0.68, 0.62]));
    let stones = [[0.6, 0.45, 0.3], [0.4, 0.5, 0.6], [0.55, 0.55, 0.5]];
    let stones = stones.map(|colour| model.material(Material::new("Stone", colour)));
    let light = model.material(Material::new("Lamp", [0.0; 3]).emitting([4000.0; 3]));
    model.stand("Hall", Parts::of(wall, cuboid(v(0.0, 0.0, 0.0), v(w, h, d)).inverted()));
    let y = h - 0.05;
    let corners = [v(5.0, y, 3.5), v(7.0, y, 3.5), v(7.0, y, 5.5), v(5.0, y, 5.5)];
    model.stand("Lamp", Parts::of(light, plain(corners)));
    let mut random = Random::new(seed);
    for i in 0..BOXES {
        // A place of its own for each, so that none stand in one another.
        let (column, row) = (i % 11, i / 11);
        let cell = [(w - 1.0) / 11.0, (d - 1.0) / 9.0];
        let size = [0.25, 0.25].map(|low| random.between(low, 0.7));
        let at = [column, row].map(|n| n as f64);
        let x = 0.5 + (at[0] + 0.5) * cell[0] + random.between(-0.08, 0.08);
        let z = 0.5 + (at[1] + 0.5) * cell[1] + random.between(-0.08, 0.08);
        let [a, b] = size.map(|s| 0.5 * s);
        let height = random.between(0.3, 2.2);
        let stone = open_box(v(x - a, 0.0, z - b), v(x + a, height, z + b));
        model.stand(format!("Box {i}"), Parts::of(stones[random.below(3)], stone));
    }
    model
}

/// A cuboid without its bottom.
fn open_box(low: glam::DVec3, high: glam::DVec3) -> Shape {
    let mut shape = cuboid(low, high);
    let normals = &shape.normals;
    shape.triangles.retain(|t| normals[t[0] as usize].y > -0.5);
    shape
}
