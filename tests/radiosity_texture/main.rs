//! Radiosity as textures: trees, their conversion, and what the three stages of reconstruction keep.

mod convert;
mod curved;
mod grid;
mod inspect;
mod lightmap;
mod lookup;
mod quadtree;
mod reconstruct;
mod spot;
mod stages;
mod subdivision;

use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::random::Rng,
    radiosity::texture::{Quadtree, Shape, convert::Gaps},
};

const SHAPES: [Shape; 2] = [Shape::Quadrilateral, Shape::Triangle];

/// An unrestricted tree of up to `height` levels, split at random.
fn random_tree(shape: Shape, height: u32, seed: u64) -> Quadtree {
    let mut tree = Quadtree::new(shape);
    tree.refine(height, |cell| {
        let item = u64::from(cell.level) << 40 | u64::from(cell.u) << 20 | u64::from(cell.v) << 1;
        let share = Rng::new(seed, item | u64::from(cell.inverted)).next_f32();
        cell.level == 0 || share < 0.5
    });
    tree
}

/// A value at every corner of a leaf.
fn sampled(tree: &Quadtree, value: impl Fn(Vec2) -> Vec3) -> Gaps {
    let side = (1u32 << tree.height()) + 1;
    let texels =
        tree.vertices().into_iter().zip(0..).map(|(known, i)| {
            known.then(|| value(UVec2::new(i % side, i / side).as_vec2() / (side - 1) as f32))
        });
    Gaps { side, texels: texels.collect() }
}

/// A point of the shape from one of the unit square.
fn fold(shape: Shape, p: Vec2) -> Vec2 {
    if shape == Shape::Triangle && p.element_sum() > 1.0 { Vec2::ONE - p } else { p }
}

/// Random points of a shape.
fn points(shape: Shape, count: u64) -> impl Iterator<Item = Vec2> {
    (0..count).map(move |i| fold(shape, Rng::new(3, i).next_vec2()))
}
