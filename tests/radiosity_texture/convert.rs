//! Conversion of trees to textures against what the programs are to compute, exactly.

use crate::{SHAPES, points, random_tree, sampled};
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::radiosity::texture::{
    Cell, Quadtree, Shape,
    convert::{fill_first_order, fill_zero_order, first_order, zero_order},
    display::Filter,
    triangle::zero_order_texel,
};

/// Small whole numbers, so that sums are exact.
fn radiosities(tree: &Quadtree) -> Vec<Vec3> {
    (0..tree.leaves().len()).map(|i| Vec3::new(i as f32, (i * i % 97) as f32, 1.0)).collect()
}

/// Whether a leaf covers a point of the shape that is on no edge.
fn covers(leaf: &Cell, p: Vec2) -> bool {
    let within = p * (1u32 << leaf.level) as f32 - UVec2::new(leaf.u, leaf.v).as_vec2();
    within.min_element() > 0.0 && within.max_element() < 1.0 && (within.element_sum() > 1.0) == leaf.inverted
}

#[test]
fn a_full_tree_is_its_texture() {
    // Programs 5.7 and 5.12 on Fig. 5.6's grid of 4 × 4: leaf k of the traversal lies at the place whose
    // binary digits spell its path.
    let tree = Quadtree::full(Shape::Quadrilateral, 2);
    let values = radiosities(&tree);
    let texture = zero_order(&tree, &values);
    assert_eq!(texture.side, 4);
    let wanted = [[0, 1, 4, 5], [3, 2, 7, 6], [12, 13, 8, 9], [15, 14, 11, 10]];
    for (v, row) in wanted.iter().enumerate() {
        for (u, leaf) in row.iter().enumerate() {
            assert_eq!(texture.texels[4 * v + u], Some(values[*leaf]), "texel ({u}, {v})");
        }
    }
}

#[test]
fn leaves_above_the_deepest_level_touch_one_texel_and_then_fill_theirs() {
    for shape in SHAPES {
        for seed in 0..10 {
            let tree = random_tree(shape, 4, seed);
            let (leaves, height) = (tree.leaves(), tree.height());
            let values = radiosities(&tree);
            let gaps = zero_order(&tree, &values);
            assert_eq!(gaps.texels.iter().flatten().count(), leaves.len(), "one texel a leaf");
            let filled = fill_zero_order(&tree, &values, &gaps);
            assert_eq!(filled.image.width, 1 << height);
            for (leaf, value) in leaves.iter().zip(&values) {
                let count = filled.image.pixels.iter().filter(|p| **p == *value).count();
                let same = values.iter().zip(&leaves).filter(|(v, _)| **v == *value);
                let texels: usize = same.map(|(_, l)| 4usize.pow(height - l.level)).sum();
                assert_eq!(count, texels, "{leaf:?}");
            }
            for p in points(shape, 200) {
                let Some(i) = leaves.iter().position(|leaf| covers(leaf, p)) else { continue };
                let texel = match shape {
                    Shape::Quadrilateral => (p * filled.image.width as f32).as_uvec2(),
                    Shape::Triangle => zero_order_texel(filled.image.width, p),
                };
                assert_eq!(filled.image.at(texel.x, texel.y), values[i], "{p}");
            }
        }
    }
}

#[test]
fn first_order_textures_are_vertex_averages_exactly() {
    for shape in SHAPES {
        for tree in (0..10).map(|s| random_tree(shape, 4, s)).chain([Quadtree::full(shape, 3)]) {
            let (leaves, values) = (tree.leaves(), radiosities(&tree));
            let sums = first_order(&tree, &values);
            let average = sums.average();
            let cells = 1u32 << tree.height();
            assert_eq!(sums.side, cells + 1);
            for v in 0..=cells {
                for u in 0..=cells {
                    // By geometry instead of by traversal: leaves with a corner at this point.
                    let p = Vec2::new(u as f32, v as f32) / cells as f32;
                    let meeting: Vec<Vec3> = leaves
                        .iter()
                        .zip(&values)
                        .filter(|(leaf, _)| {
                            let scale = (1u32 << leaf.level) as f32;
                            leaf.corners(shape, leaf.level).any(|c| c.as_vec2() / scale == p)
                        })
                        .map(|(_, value)| *value)
                        .collect();
                    let wanted =
                        (!meeting.is_empty()).then(|| meeting.iter().sum::<Vec3>() / meeting.len() as f32);
                    let i = (v * sums.side + u) as usize;
                    assert_eq!(average.texels[i], wanted, "vertex ({u}, {v})");
                    assert_eq!(sums.counter[i] as usize, meeting.len());
                }
            }
        }
    }
    // Fig. 5.9: one element at a corner, two on an edge, four inside; six triangles inside.
    let counts = first_order(&Quadtree::full(Shape::Quadrilateral, 2), &[Vec3::ONE; 16]).counter;
    assert_eq!(counts, [1, 2, 2, 2, 1, 2, 4, 4, 4, 2, 2, 4, 4, 4, 2, 2, 4, 4, 4, 2, 1, 2, 2, 2, 1]);
    let counts = first_order(&Quadtree::full(Shape::Triangle, 2), &[Vec3::ONE; 16]).counter;
    assert_eq!(counts, [1, 3, 3, 3, 1, 3, 6, 6, 3, 0, 3, 6, 3, 0, 0, 3, 3, 0, 0, 0, 1, 0, 0, 0, 0]);
}

#[test]
fn gaps_of_first_order_textures_are_bilinear_between_their_corners() {
    // A bilinear function stays itself on any tree of quadrilaterals, a linear one of triangles. Rounding of
    // values up to 9: 1e-5.
    let functions: [fn(Vec2) -> Vec3; 2] =
        [|p| Vec3::splat(1.0 + 2.0 * p.x + p.y + 5.0 * p.x * p.y), |p| Vec3::splat(1.0 + 2.0 * p.x + p.y)];
    for (shape, function) in SHAPES.into_iter().zip(functions) {
        for seed in 0..10 {
            let tree = random_tree(shape, 5, seed);
            let texture = fill_first_order(&tree, &sampled(&tree, function));
            for p in points(shape, 200) {
                let found = texture.sample(p, Filter::Bilinear);
                assert!((found - function(p)).abs().max_element() < 1e-5, "{p}: {found}");
            }
        }
    }
}

#[test]
fn an_edge_with_t_vertices_follows_its_finer_side() {
    // A coarse quarter beside finer ones: the T-vertex on its edge keeps its own value.
    let mut tree = Quadtree::full(Shape::Quadrilateral, 1);
    tree.refine(3, |cell| {
        cell.level == 0 || (cell.level == 1 && cell.u == 0) || (cell.level, cell.u, cell.v) == (2, 0, 0)
    });
    let mut samples = sampled(&tree, |_| Vec3::ZERO);
    let side = samples.side;
    let t_vertices = tree.t_vertices();
    assert!(!t_vertices.is_empty());
    for t in &t_vertices {
        samples.texels[(t.y * side + t.x) as usize] = Some(Vec3::ONE);
    }
    let texture = fill_first_order(&tree, &samples);
    for t in &t_vertices {
        assert_eq!(texture.image.at(t.x, t.y), Vec3::ONE);
    }
    // On the coarse edge x = 4 of 8 between the T-vertex at y = 2 and the corner at y = 4.
    assert!(t_vertices.contains(&UVec2::new(4, 2)));
    assert_eq!(texture.image.at(4, 3), Vec3::splat(0.5));
}
