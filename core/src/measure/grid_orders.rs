//! One grid's light by the thesis's conversions of a quadtree's leaves to texels: of zero order, one texel a leaf with
//! the gaps filled (Bastos 1999, Programs 5.7, 5.12 and 5.14), and of first order, the mean of the leaves at each
//! vertex (5.10, 5.11). What they cost against the stages that keep the nodes is the point of showing them.
//!
//! The solver's samples are nodes and not leaves, so a leaf's radiosity is the mean of its corners. The tree is the
//! solver's own where it has one: a cell is a leaf unless a node that was solved lies between its corners. Beyond
//! the grid the nodes of its border stand again. Triangles and curved surfaces have trees of their own; a ball's six
//! are looked up by a latitude–longitude texture.

use super::grid_texture::{GridTexture, Smooth, Stage};
use crate::radiosity::texture::{
    Cell, Quadtree, RadiosityTexture, Shape,
    convert::{Gaps, fill_first_order, fill_zero_order, first_order, zero_order},
    display::Filter,
    sphere_orders::{FirstOrder, zero_order_texture},
    tube,
};
use glam::{UVec2, Vec3};

/// Levels of a tree, at most: what [`Quadtree`] allows.
const MOST_LEVELS: u32 = 10;

/// Names of the orders.
pub const ORDERS: [&str; 2] = ["zero order", "first order"];

impl GridTexture {
    /// The textures of zero and first order, looked up nearest and bilinearly; `None` where the grid has more than
    /// 1,024 cells along an edge.
    pub fn orders(&self) -> Option<[Stage; 2]> {
        let window = match &self.smooth {
            Smooth::Grid(_, window) => *window,
            Smooth::Ball(ball) => return Some(of_ball(&ball.patches)),
            Smooth::Triangle(patch) => {
                let (zero, first) = of_tree(&patch.tree, &patch.samples);
                let [zero, first] = [
                    fill_zero_order(&patch.tree, &zero, &zero_order(&patch.tree, &zero)),
                    fill_first_order(&patch.tree, &first),
                ];
                return Some([
                    Stage { texture: zero, filter: Filter::NearestInTriangle },
                    Stage { texture: first, filter: Filter::Bilinear },
                ]);
            }
            Smooth::Tube(tube) => {
                let (zero, first) = of_tree(&tube.tree, &tube.samples);
                return Some([
                    Stage { texture: tube::zero_order_texture(&tube.tree, &zero), filter: Filter::Nearest },
                    Stage {
                        texture: tube::first_order_texture(&tube.tree, &first),
                        filter: Filter::Bilinear,
                    },
                ]);
            }
        };
        let [nx, ny] = self.nodes;
        let height = (nx.max(ny) - 1).next_power_of_two().ilog2();
        if height > MOST_LEVELS {
            return None;
        }
        let solved = |x: u32, y: u32| x < nx && y < ny && !self.open[(y * nx + x) as usize];
        let mut tree = Quadtree::new(Shape::Quadrilateral);
        tree.refine(height, |cell| {
            let span = cell.span(height);
            let between = |a: u32, b: u32| !(a.is_multiple_of(span) && b.is_multiple_of(span));
            let mut inside = (0..=span).flat_map(|b| (0..=span).map(move |a| (a, b)));
            inside.any(|(a, b)| between(a, b) && solved(cell.u * span + a, cell.v * span + b))
        });
        let radiosity = of_leaves(&tree, height, |c| self.stored.image.at(c.x.min(nx - 1), c.y.min(ny - 1)));
        let zero = fill_zero_order(&tree, &radiosity, &zero_order(&tree, &radiosity));
        let first = fill_first_order(&tree, &first_order(&tree, &radiosity).average());
        // The grid takes a share of the tree's square.
        let over_grid = |texture: RadiosityTexture| {
            let (first, step) = (texture.first / window, texture.step / window);
            RadiosityTexture { first, step, ..texture }
        };
        Some([
            Stage { texture: over_grid(zero), filter: Filter::Nearest },
            Stage { texture: over_grid(first), filter: Filter::Bilinear },
        ])
    }
}

/// The mean of the corners of each leaf, on the lattice of a level.
fn of_leaves(tree: &Quadtree, height: u32, node: impl Fn(UVec2) -> Vec3) -> Vec<Vec3> {
    let mean = |corners: Vec<Vec3>| corners.iter().sum::<Vec3>() / corners.len() as f32;
    let corners = |leaf: &Cell| leaf.corners(tree.shape(), height).map(&node).collect();
    tree.leaves().iter().map(|leaf| mean(corners(leaf))).collect()
}

/// The mean of the corners of each leaf, and of the leaves at each corner.
fn of_tree(tree: &Quadtree, samples: &Gaps) -> (Vec<Vec3>, Gaps) {
    let node = |c: UVec2| samples.texels[(c.y * samples.side + c.x) as usize].unwrap_or_default();
    let leaves = of_leaves(tree, tree.height(), node);
    let means = first_order(tree, &leaves).average();
    (leaves, means)
}

fn of_ball(patches: &[(Quadtree, Gaps); 6]) -> [Stage; 2] {
    let both = patches.each_ref().map(|(tree, samples)| (tree, of_tree(tree, samples)));
    let leaves = both.each_ref().map(|(tree, (zero, _))| ((*tree).clone(), zero.clone()));
    let means = both.map(|(tree, (_, first))| (tree.clone(), first));
    [
        Stage { texture: zero_order_texture(&leaves), filter: Filter::Nearest },
        Stage { texture: FirstOrder::new(&means).texture(), filter: Filter::Bilinear },
    ]
}
