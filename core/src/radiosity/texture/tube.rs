//! A patch with parameters u and v that closes on itself: the side of a cylinder, u around and v along it
//! (Bastos §5.5.4).
//!
//! One quadtree over the unit square, whose edges u = 0 and u = 1 are the same line: where its leaves differ in
//! depth there, both take the values of the finer. The texture has a column a step around, none twice;
//! [`Border::Tube`] goes round, and beyond the ends the outermost rows stand again.

use super::{
    Border, Quadtree, RadiosityTexture, Shape,
    convert::{Gaps, fill_first_order, fill_zero_order, zero_order},
    hermite::HermiteSurface,
};
use crate::math::image::LinearImage;
use glam::{Vec2, Vec3};

/// A smooth function around a cylinder.
#[derive(Clone, Debug)]
pub struct TubeSurface {
    cells: u32,
    /// Over the lattice and one vertex more on each side.
    surface: HermiteSurface,
}

impl TubeSurface {
    /// The function through the samples at the corners of a tree's leaves.
    ///
    /// # Panics
    /// If the tree is not of quadrilaterals or the samples not its own.
    pub fn new(tree: &Quadtree, samples: &Gaps) -> Self {
        let smooth = HermiteSurface::new(Shape::Quadrilateral, samples).resampled(samples.side);
        let joined = join(tree, smooth.image);
        let (cells, side) = (samples.side - 1, samples.side as usize + 2);
        let (n, last) = (i64::from(cells), i64::from(cells));
        let at = |i: i64, j: i64| joined.at(i.rem_euclid(n) as u32, j as u32);
        let value = |i: i64, j: i64| match j {
            // As the ends go on.
            -1 => (2.0 * at(i, 0) - at(i, 1)).max(Vec3::ZERO),
            j if j > last => (2.0 * at(i, last) - at(i, last - 1)).max(Vec3::ZERO),
            j => at(i, j),
        };
        let values: Vec<Vec3> =
            (0..(side * side) as i64).map(|i| value(i % side as i64 - 1, i / side as i64 - 1)).collect();
        Self { cells, surface: HermiteSurface::through(&values, side) }
    }

    /// Value at a point: u around, from 0 to 1, and v along.
    pub fn at(&self, uv: Vec2) -> Vec3 {
        let cells = self.cells as f32;
        let around = Vec2::new(uv.x.rem_euclid(1.0), uv.y.clamp(0.0, 1.0));
        self.surface.at((around * cells + Vec2::ONE) / (cells + 2.0))
    }

    /// The texture with `cells` columns around and as many rows, and one, along.
    pub fn sampled(&self, cells: u32) -> RadiosityTexture {
        around(LinearImage::from_fn(cells, cells + 1, |x, y| {
            self.at(Vec2::new(x as f32, y as f32) / cells as f32)
        }))
    }
}

/// The texture of samples at the corners of a tree's leaves by the conversion of first order.
///
/// # Panics
/// If a corner of a leaf is open.
pub fn first_order_texture(tree: &Quadtree, samples: &Gaps) -> RadiosityTexture {
    let joined = join(tree, fill_first_order(tree, samples).image);
    around(LinearImage::from_fn(joined.width - 1, joined.height, |x, y| joined.at(x, y)))
}

/// The texture of one value a leaf by the conversion of zero order.
///
/// # Panics
/// If there is not one value a leaf.
pub fn zero_order_texture(tree: &Quadtree, values: &[Vec3]) -> RadiosityTexture {
    fill_zero_order(tree, values, &zero_order(tree, values))
}

/// A texture whose columns go round and whose outermost rows lie on the ends.
fn around(image: LinearImage) -> RadiosityTexture {
    let step = Vec2::new(1.0 / image.width as f32, 1.0 / (image.height - 1) as f32);
    RadiosityTexture { image, first: Vec2::ZERO, step, border: Border::Tube }
}

/// A lattice whose first and last column are one: the finer leaf's values, or the mean of both.
fn join(tree: &Quadtree, mut lattice: LinearImage) -> LinearImage {
    let (side, cells) = (lattice.width, lattice.width - 1);
    let mut levels = vec![[0, 0]; side as usize];
    for leaf in tree.leaves() {
        let span = leaf.span(tree.height());
        let at_ends = [leaf.u == 0, (leaf.u + 1) * span == cells];
        for row in leaf.v * span..=(leaf.v + 1) * span {
            for end in (0..2).filter(|&end| at_ends[end]) {
                let level = &mut levels[row as usize][end];
                *level = leaf.level.max(*level);
            }
        }
    }
    for (row, [left, right]) in (0..side).zip(levels) {
        let ends = [row * side, row * side + cells].map(|i| i as usize);
        let [a, b] = ends.map(|i| lattice.pixels[i]);
        let joined = if left > right {
            a
        } else if right > left {
            b
        } else {
            0.5 * (a + b)
        };
        ends.into_iter().for_each(|i| lattice.pixels[i] = joined);
    }
    lattice
}
