//! Subdivision a posteriori: a tree that is fine where what is sampled bends.
//!
//! A leaf is split when linear interpolation between its corners misses the samples at the middles of its
//! edges or at its own middle by more than a tolerance; those samples are then its children's corners, so none
//! is taken in vain. What is sampled is a function of (u, v): a quadrilateral, a triangle, or any surface with
//! such parameters, whose owner maps them to a position and a normal (Bastos §5.5.4).
//!
//! Limit: what is smaller than a leaf of the first level can lie between all samples and be missed.

use super::{Cell, Quadtree, Shape, convert::Gaps};
use crate::math::colour::luminance;
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// When to split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subdivision {
    /// Level that every leaf has at least.
    pub least_level: u32,
    /// Level that no leaf goes beyond, at most 10.
    pub most_level: u32,
    /// Deviation from linear that is let be, in the unit of the values' luminance.
    pub tolerance: f32,
    /// Whether neighbours may differ by one level only.
    pub restricted: bool,
}

/// Grows a tree over `shape` by sampling `value`; the samples, one at every corner of a leaf.
///
/// # Panics
/// If the least level is above the most, or the most above 10.
pub fn sample_adaptively(
    shape: Shape,
    subdivision: &Subdivision,
    value: impl Fn(Vec2) -> Vec3 + Sync,
) -> (Quadtree, Gaps) {
    let Subdivision { least_level, most_level, .. } = *subdivision;
    assert!(least_level <= most_level, "levels {least_level} to {most_level}");
    let mut tree = Quadtree::full(shape, least_level);
    let mut known: HashMap<UVec2, Vec3> = HashMap::new();
    for level in least_level..most_level {
        let leaves: Vec<Cell> = tree.leaves().into_iter().filter(|l| l.level == level).collect();
        let middles = leaves.iter().flat_map(|leaf| parts_corners(leaf, shape, most_level));
        take(&mut known, middles.collect(), most_level, &value);
        let bent = |cell: &Cell| deviation(cell, shape, most_level, &known) > subdivision.tolerance;
        if !tree.refine(level + 1, |cell| cell.level == level && bent(cell)) {
            break;
        }
    }
    if subdivision.restricted {
        tree.restrict();
    }
    let height = tree.height();
    let corners = tree.leaves().iter().flat_map(|l| l.corners(shape, most_level)).collect();
    take(&mut known, corners, most_level, &value);
    let (side, span) = ((1u32 << height) + 1, 1u32 << (most_level - height));
    let texels = tree
        .vertices()
        .into_iter()
        .zip(0..)
        .map(|(used, i)| used.then(|| known[&(UVec2::new(i % side, i / side) * span)]))
        .collect();
    (tree, Gaps { side, texels })
}

fn parts_corners(leaf: &Cell, shape: Shape, height: u32) -> Vec<UVec2> {
    leaf.children(shape).iter().flat_map(|part| part.corners(shape, height)).collect()
}

/// Samples the lattice points that are not known yet.
fn take(
    known: &mut HashMap<UVec2, Vec3>,
    mut wanted: Vec<UVec2>,
    height: u32,
    value: &(impl Fn(Vec2) -> Vec3 + Sync),
) {
    wanted.sort_by_key(|p| [p.y, p.x]);
    wanted.dedup();
    wanted.retain(|p| !known.contains_key(p));
    let scale = 1.0 / (1u32 << height) as f32;
    let values: Vec<Vec3> = wanted.par_iter().map(|p| value(p.as_vec2() * scale)).collect();
    known.extend(wanted.into_iter().zip(values));
}

/// How far linear interpolation between a leaf's corners is off at the corners of its parts.
fn deviation(leaf: &Cell, shape: Shape, height: u32, known: &HashMap<UVec2, Vec3>) -> f32 {
    let corners: Vec<UVec2> = leaf.corners(shape, height).collect();
    let at = |p: UVec2| luminance(known[&p]);
    let mean = |points: &[UVec2]| points.iter().map(|p| at(*p)).sum::<f32>() / points.len() as f32;
    let next = corners.iter().cycle().skip(1);
    let edges = corners.iter().zip(next).map(|(a, b)| (at((*a + *b) / 2) - mean(&[*a, *b])).abs());
    let middle = if shape == Shape::Quadrilateral {
        (at((corners[0] + corners[2]) / 2) - mean(&corners)).abs()
    } else {
        0.0
    };
    edges.fold(middle, f32::max)
}
