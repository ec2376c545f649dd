//! Trees: the order of their leaves, what they cover, restriction, T-vertices.

use crate::{SHAPES, random_tree};
use glam::UVec2;
use lumenscope_core::radiosity::texture::{Quadtree, Shape};
use std::collections::HashMap;

#[test]
fn vertices_of_a_full_tree_are_numbered_as_in_figure_5_9() {
    // The figure numbers the vertices of a 4 × 4 mesh as a traversal of the tree meets them; printed with the
    // last row on top, each element's four corners at its place.
    const PRINTED: [[u32; 8]; 8] = [
        [24, 23, 23, 20, 20, 19, 19, 18],
        [22, 21, 21, 16, 16, 15, 15, 17],
        [22, 21, 21, 16, 16, 15, 15, 17],
        [8, 7, 7, 6, 6, 14, 14, 13],
        [8, 7, 7, 6, 6, 14, 14, 13],
        [3, 2, 2, 5, 5, 10, 10, 12],
        [3, 2, 2, 5, 5, 10, 10, 12],
        [0, 1, 1, 4, 4, 9, 9, 11],
    ];
    let tree = Quadtree::full(Shape::Quadrilateral, 2);
    let mut numbers: HashMap<UVec2, u32> = HashMap::new();
    for leaf in tree.leaves() {
        for corner in leaf.corners(Shape::Quadrilateral, 2) {
            let next = numbers.len() as u32;
            numbers.entry(corner).or_insert(next);
        }
    }
    for (row, printed) in PRINTED.iter().rev().enumerate() {
        for (column, wanted) in printed.iter().enumerate() {
            let vertex = UVec2::new(column.div_ceil(2) as u32, row.div_ceil(2) as u32);
            assert_eq!(numbers[&vertex], *wanted, "column {column}, row {row}");
        }
    }
}

#[test]
fn leaves_cover_the_shape_once() {
    for shape in SHAPES {
        for seed in 0..20 {
            let tree = random_tree(shape, 5, seed);
            let area: f64 = tree.leaves().iter().map(|leaf| 0.25f64.powi(leaf.level as i32)).sum();
            assert_eq!(area, 1.0);
            let mut leaves = tree.leaves();
            leaves.sort();
            leaves.dedup();
            assert_eq!(leaves.len(), tree.leaves().len());
        }
        for height in 0..4 {
            let tree = Quadtree::full(shape, height);
            assert!(tree.leaves().iter().all(|leaf| leaf.level == height) && tree.height() == height);
            assert_eq!(tree.leaves().len(), 4usize.pow(height));
            assert!(tree.t_vertices().is_empty());
        }
    }
}

#[test]
fn one_split_quarter_has_the_two_t_vertices_of_figure_5_16() {
    let mut tree = Quadtree::full(Shape::Quadrilateral, 1);
    tree.refine(2, |cell| cell.level == 0 || (cell.u, cell.v) == (0, 0));
    assert_eq!(tree.t_vertices(), [UVec2::new(2, 1), UVec2::new(1, 2)]);
    // The middle of a triangle meets its three neighbours.
    let mut tree = Quadtree::full(Shape::Triangle, 1);
    tree.refine(2, |cell| cell.level == 0 || cell.inverted);
    assert_eq!(tree.t_vertices(), [UVec2::new(1, 1), UVec2::new(2, 1), UVec2::new(1, 2)]);
}

#[test]
fn restricted_trees_have_t_vertices_only_at_the_middles_of_edges() {
    for shape in SHAPES {
        let mut changed = 0;
        for seed in 0..20 {
            let mut tree = random_tree(shape, 6, seed);
            let before = tree.leaves().len();
            tree.restrict();
            changed += usize::from(tree.leaves().len() > before);
            let (height, t_vertices) = (tree.height(), tree.t_vertices());
            let mut middles = Vec::new();
            for leaf in tree.leaves() {
                let corners: Vec<UVec2> = leaf.corners(shape, height).collect();
                let next = corners.iter().cycle().skip(1);
                middles.extend(corners.iter().zip(next).map(|(a, b)| (*a + *b) / 2));
            }
            assert!(t_vertices.iter().all(|t| middles.contains(t)), "seed {seed}");
            let leaves = tree.leaves().len();
            tree.restrict();
            assert_eq!(tree.leaves().len(), leaves, "restricted already");
        }
        assert!(changed > 10, "some trees were unrestricted");
    }
}
