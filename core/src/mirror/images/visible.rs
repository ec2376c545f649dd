//! Which points of a sample a mirrored view may show, and how many of them it needs: a quadtree over the sample's
//! pixels (Bastos 1999, §6.6.4).
//!
//! A node is left out where the box around its points lies outside the view's portal, and so are all its points. Where
//! points are smaller than the picture's pixels, of every 4ⁿ one is drawn, as large as all of them: minification by
//! skipping (Program 6.16), here for each node by itself. The thesis divides nodes until their depths are alike, since
//! one size stands for all points of a node; here every point has its own, and a node's box bounds them.
//!
//! Pixels are numbered in Z-order, so that a node's points follow one another, and every fourth or sixteenth of them
//! are a coarser image of the same node.

use super::sample::{ImageWithDepth, Point};
use crate::mirror::{culling::Portal, views::Eye};
use glam::{UVec2, Vec2, Vec3};

/// Points of a leaf, 8 × 8, and of a [`Run`].
pub const LEAF: u32 = 64;

/// The boxes of a sample's points: those of the whole, of its quarters, and so on down to its leaves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quadtree {
    nodes: Vec<Node>,
}

/// Points of a square of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    /// Box around them with their sides, m.
    low: Vec3,
    high: Vec3,
    /// Largest [`ImageWithDepth::scale`].
    scale: f32,
}

impl Node {
    fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            scale: self.scale.max(other.scale),
        }
    }
}

/// Points of an image that are drawn: one in 4^`level` from `first` on, [`LEAF`] of them, or all where the image has
/// fewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// First pixel, in Z-order.
    pub first: u32,
    /// How often squares of four were made one.
    pub level: u32,
}

impl Run {
    /// Its points.
    pub fn points(self, image: &ImageWithDepth) -> impl Iterator<Item = Point> + '_ {
        let count = LEAF.min(image.triangle.len() as u32);
        let widen = (1u32 << self.level) as f32;
        (0..count).map(move |i| {
            let point = image.point(self.first + (i << (2 * self.level)));
            Point { sides: point.sides.map(|side| side * widen), ..point }
        })
    }
}

/// Nodes above a level of the tree.
fn before(level: u32) -> usize {
    ((1usize << (2 * level)) - 1) / 3
}

impl Quadtree {
    /// The boxes of an image's points.
    pub(super) fn new(image: &ImageWithDepth) -> Self {
        let leaf = |points: u32| {
            let nodes = (0..LEAF.min(image.triangle.len() as u32)).map(|i| {
                let pixel = points * LEAF + i;
                let Point { position, sides, .. } = image.point(pixel);
                let half = 0.5 * (sides[0].abs() + sides[1].abs());
                Node { low: position - half, high: position + half, scale: image.scale[pixel as usize] }
            });
            nodes.reduce(Node::with)
        };
        let leaves = (image.triangle.len() as u32 / LEAF).max(1);
        let mut levels: Vec<Vec<Node>> = vec![(0..leaves).filter_map(leaf).collect()];
        while let Some(finer) = levels.last().filter(|l| l.len() > 1) {
            levels.push(
                finer.chunks(4).map(|four| four.iter().skip(1).fold(four[0], |a, &b| a.with(b))).collect(),
            );
        }
        Self { nodes: levels.into_iter().rev().flatten().collect() }
    }

    /// Bytes of the boxes.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }
}

/// A mirrored view, for which points are chosen.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'a> {
    /// Its eye.
    pub eye: &'a Eye,
    /// What bounds it.
    pub portal: &'a Portal,
    /// Size of the picture, pixels.
    pub size: UVec2,
}

impl Sight<'_> {
    /// The runs of an image's points that may show; none that may is left out.
    pub fn runs(&self, image: &ImageWithDepth) -> Vec<Run> {
        let mut runs = Vec::new();
        self.visit(image, 0, 0, &mut runs);
        runs
    }

    fn visit(&self, image: &ImageWithDepth, level: u32, number: u32, runs: &mut Vec<Run>) {
        let node = &image.tree.nodes[before(level) + number as usize];
        if !self.portal.touches(node.low, node.high) {
            return;
        }
        let points = image.triangle.len() as u32 >> (2 * level);
        // As often as leaves one run.
        let most = (points / LEAF).max(1).ilog2() / 2;
        if most == 0 || self.skips(image, node) >= most {
            runs.push(Run { first: number * points, level: most });
            return;
        }
        for quarter in 0..4 {
            self.visit(image, level + 1, 4 * number + quarter, runs);
        }
    }

    /// How often squares of four points can be made one without becoming larger than a pixel, anywhere in a node.
    fn skips(&self, image: &ImageWithDepth, node: &Node) -> u32 {
        let forward = self.eye.forward;
        let nearest = Vec3::select(forward.cmpge(Vec3::ZERO), node.low, node.high);
        let z = forward.dot(nearest - self.eye.position);
        let side = image.edge_u.length().max(image.edge_v.length()) * node.scale / image.resolution as f32;
        let pixels_a_metre: Vec2 = 0.5 * self.size.as_vec2() / (self.eye.half_size * z);
        let widest = side * pixels_a_metre.max_element();
        if z > 0.0 && widest > 0.0 && widest < 1.0 { (1.0 / widest).log2() as u32 } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_of_three_levels_has_twenty_one_nodes() {
        assert_eq!([0, 1, 2, 3].map(before), [0, 1, 5, 21]);
    }
}
