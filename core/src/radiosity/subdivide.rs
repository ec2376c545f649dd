//! Subdivision a posteriori: quadtrees over the grids of flat regions, split where the light asks for it.
//!
//! A region's grid is laid out as fine as it may become. Its nodes are solved only at corners of leaves of the
//! quadtrees that tile it; what lies between them is interpolated bilinearly, the finest leaves first, so
//! that both sides of an edge with T-vertices agree. The grid is then a texture as [`super::texture`] makes
//! it: lookups, shading and its twin on the GPU do not know of the trees. A region that is no rectangle, a
//! triangle say, leaves the nodes outside it unsolved.
//!
//! After a draft on the roots each leaf, level by level, is judged by what its corners' own gather rays met.
//! Light from a distance d bends over d, so interpolation over a leaf of side s is off by the order of
//! s² |B − E| / d² for each ray that met radiosity B where E arrives; the mean of that over rays and corners,
//! relative to E and times the leaf's share of the area of a root, is held to a tolerance: what an error is
//! worth is the area on which it is seen, and the many small leaves of small things would else take every
//! split. Not second differences of the solution: at a hundred rays they are mostly noise, which would be taken
//! for detail.
//!
//! What is left on coarse leaves is noise more than bent light, so rays go as the root of the area that elements
//! stand for: the many small ones of small things cast few.
//!
//! Limits: edges of indirect shadows from far objects are not foreseen; vertex elements and the bodies of
//! lamps keep their spacing; trees stay as they were when lamps move afterwards.

use super::{
    RadiositySolution,
    gather::Gathering,
    rims::Fills,
    surface_map::{Chart, INTERPOLATED, OUTSIDE, SurfaceMap, UNSOLVED},
};
use crate::math::{colour::luminance, relative::floor_of};
use glam::Vec3;
use rayon::prelude::*;

/// How grids are subdivided.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Subdivision {
    /// Times that a root, a cell of the usual spacing, can be split: 1 to 4.
    pub levels: u8,
    /// Deviation from bilinear that is let be on a root, relative to the irradiance (or 5 % of its mean, if that
    /// is more); four times as much a level further down.
    pub tolerance: f32,
    /// Whether leaves that share an edge may differ by one level at most.
    #[serde(default)]
    pub restricted: bool,
}

impl Default for Subdivision {
    fn default() -> Self {
        Self { levels: 1, tolerance: 0.1, restricted: false }
    }
}

/// Width that a narrow leaf counts with, in spacings: it is seldom looked at, but its ends may be.
const LEAST_WIDTH: f32 = 0.1;

/// Most times that a root can be split.
pub const MOST_LEVELS: u8 = 4;

/// A leaf of a grid's trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// First node along u and v.
    pub at: [u32; 2],
    /// Times it was split from a root.
    pub level: u8,
}

/// The quadtrees over one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ChartTree {
    /// Grid steps of a root along u and v: a power of two.
    pub root: [u32; 2],
    /// Nodes of the grid along u and v.
    pub nodes: [u32; 2],
    /// The leaves.
    pub leaves: Vec<Leaf>,
}

/// Grid steps of a root, and nodes of the finest grid, along an axis with `nodes` of the usual spacing.
pub(super) fn root_and_nodes(nodes: u32, levels: u8) -> (u32, u32) {
    if nodes == 1 { (1, 1) } else { (1 << levels, ((nodes - 1) << levels) + 1) }
}

impl ChartTree {
    /// A grid of roots.
    pub(super) fn new(root: [u32; 2], nodes: [u32; 2]) -> Self {
        let [w, h] = [0, 1].map(|axis| ((nodes[axis] - 1) / root[axis]).max(1));
        let leaf = |i: u32| Leaf { at: [i % w * root[0], i / w * root[1]], level: 0 };
        Self { root, nodes, leaves: (0..w * h).map(leaf).collect() }
    }

    /// Grid steps of a leaf of a level along u and v.
    pub fn span(&self, level: u8) -> [u32; 2] {
        self.root.map(|root| (root >> level).max(1))
    }

    /// Nodes at a leaf's corners, going round; one twice where the grid is a single node wide.
    pub fn corners(&self, leaf: &Leaf) -> [u32; 4] {
        let span = self.span(leaf.level);
        let [low, high] =
            [[0, 0], span].map(|d| [0, 1].map(|axis| (leaf.at[axis] + d[axis]).min(self.nodes[axis] - 1)));
        let node = |x: u32, y: u32| y * self.nodes[0] + x;
        [node(low[0], low[1]), node(high[0], low[1]), node(high[0], high[1]), node(low[0], high[1])]
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.leaves[..])
    }

    /// Splits the leaves that are wanted and can be; whether any was.
    fn split(&mut self, wanted: impl Fn(&Self, &Leaf) -> bool) -> bool {
        let mut leaves = Vec::with_capacity(self.leaves.len());
        for leaf in &self.leaves {
            let (span, part) = (self.span(leaf.level), self.span(leaf.level + 1));
            if span == part || !wanted(self, leaf) {
                leaves.push(*leaf);
                continue;
            }
            for y in (0..span[1]).step_by(part[1] as usize) {
                for x in (0..span[0]).step_by(part[0] as usize) {
                    leaves.push(Leaf { at: [leaf.at[0] + x, leaf.at[1] + y], level: leaf.level + 1 });
                }
            }
        }
        let grown = leaves.len() > self.leaves.len();
        self.leaves = leaves;
        grown
    }

    /// Splits leaves until those that share an edge differ by one level at most.
    fn restrict(&mut self) {
        loop {
            let levels = self.levels_of_cells();
            let [w, h] = self.nodes.map(|n| (n.max(2) - 1) as usize);
            let steep = |tree: &Self, leaf: &Leaf| {
                let ([x, y], [a, b]) =
                    (leaf.at.map(|v| v as usize), tree.span(leaf.level).map(|v| v as usize));
                // Numbers wrap below 0 and fail the test of being inside.
                let beside = (0..a)
                    .flat_map(|i| [(x + i, y.wrapping_sub(1)), (x + i, y + b)])
                    .chain((0..b).flat_map(|j| [(x.wrapping_sub(1), y + j), (x + a, y + j)]));
                let mut inside = beside.filter(|&(x, y)| x < w && y < h);
                inside.any(|(x, y)| levels[y * w + x] > leaf.level + 1)
            };
            if !self.split(steep) {
                return;
            }
        }
    }

    /// Level of the leaf that each cell of the grid lies in, x fastest.
    pub fn levels_of_cells(&self) -> Vec<u8> {
        let [w, h] = self.nodes.map(|n| (n.max(2) - 1) as usize);
        let mut levels = vec![0; w * h];
        for leaf in &self.leaves {
            let ([x, y], [a, b]) = (leaf.at.map(|v| v as usize), self.span(leaf.level).map(|v| v as usize));
            (y..y + b).for_each(|y| levels[y * w + x..][..a].fill(leaf.level));
        }
        levels
    }

    /// Level of the coarsest leaf that each node is a corner of; `None` between corners.
    pub fn levels(&self) -> Vec<Option<u8>> {
        let mut levels: Vec<Option<u8>> = vec![None; (self.nodes[0] * self.nodes[1]) as usize];
        for leaf in &self.leaves {
            for corner in self.corners(leaf) {
                let known = &mut levels[corner as usize];
                *known = Some(known.map_or(leaf.level, |k| k.min(leaf.level)));
            }
        }
        levels
    }
}

/// Luminances that leaves are judged by: direct irradiance and radiosity of every node, solved or between.
pub(super) struct Draft {
    direct: Vec<f32>,
    radiosity: Vec<f32>,
    /// Irradiance below which a deviation is held to it, lx.
    floor: f32,
}

impl Draft {
    /// Those of a solution.
    pub(super) fn new(solution: &RadiositySolution) -> Self {
        let luminances = |values: &[Vec3]| values.iter().map(|v| luminance(*v)).collect();
        let sum = |light: &[Vec3]| -> f32 {
            solution.elements().iter().zip(light).map(|(e, light)| e.area * luminance(*light)).sum()
        };
        let area: f32 = solution.elements().iter().map(|e| e.area).sum();
        let mean = (sum(&solution.direct) + sum(&solution.indirect)) / area.max(f32::MIN_POSITIVE);
        Self {
            direct: luminances(&solution.direct),
            radiosity: luminances(solution.radiosity()),
            floor: floor_of(f64::from(mean)) as f32,
        }
    }

    /// The test of leaves: whether the elements at a leaf's corners and its sides, m, ask for a split.
    pub(super) fn asks(
        &self,
        gathering: &Gathering,
        subdivision: &Subdivision,
    ) -> impl Fn(&[usize], [f32; 2]) -> bool + use<> {
        let judged: Vec<[f32; 2]> = (0..self.direct.len())
            .into_par_iter()
            .with_min_len(64)
            .map(|i| self.judge(gathering, i))
            .collect();
        let (floor, tolerance) = (self.floor, subdivision.tolerance);
        let usual = gathering.map.spacing_m;
        move |corners, [a, b]| {
            let mean = |k: usize| corners.iter().map(|&c| judged[c][k]).sum::<f32>() / corners.len() as f32;
            let off = a.max(b).powi(2) * mean(0);
            off * a.max(b) * a.min(b).max(LEAST_WIDTH * usual)
                > tolerance * mean(1).max(floor) * usual * usual
        }
    }

    /// By how much bilinear interpolation may be off at an element, over its side², and its irradiance: the mean
    /// over its rays of |B − E| / d², lx/m², with distances of the elements met, no less than a quarter of the
    /// spacing; and direct light with the mean over its rays of B, lx.
    fn judge(&self, gathering: &Gathering, element: usize) -> [f32; 2] {
        const NEAREST_SPACINGS: f32 = 0.25;
        let (map, row) = (&gathering.map, gathering.row(element));
        let radiosity = |hit: u32| self.radiosity.get(hit as usize).copied();
        let rays = row.len().max(1) as f32;
        let own = row.iter().filter_map(|&hit| radiosity(hit)).sum::<f32>() / rays;
        let least = (NEAREST_SPACINGS * map.spacing_m).powi(2);
        let sum = row.iter().fold(0.0, |sum, &hit| {
            let Some(other) = radiosity(hit) else { return sum };
            let apart = map.elements[hit as usize].position - map.elements[element].position;
            sum + (other - own).abs() / apart.length_squared().max(least)
        });
        [sum / rays, self.direct[element] + own]
    }
}

impl SurfaceMap {
    /// Area of a finest leaf, m²; `None` without quadtrees.
    pub(super) fn finest_leaf_area(&self) -> Option<f32> {
        let splits = self.trees.iter().flatten().map(|tree| tree.root[0].max(tree.root[1]).ilog2()).max()?;
        Some((self.spacing_m / (1 << splits) as f32).powi(2))
    }

    /// Area that an element stands for among others like it, m²: on a grid all nodes of a level have the same.
    pub(super) fn area_stood_for(&self, element: u32) -> f32 {
        let element = element as usize;
        let chart = self.elements[element].chart;
        let Some(Chart { step_u, step_v, nx, ny, .. }) = self.charts.get(chart as usize) else {
            return self.elements[element].area;
        };
        let cells = [*nx, *ny].map(|n| n.max(2) - 1);
        let area = step_u.length() * step_v.length() * (cells[0] * cells[1]) as f32;
        let (root, span) = match &self.trees[chart as usize] {
            Some(tree) => (tree.root, tree.span(self.levels[element])),
            None => ([1, 1], [1, 1]),
        };
        let roots = (cells[0] / root[0] + 1).min(*nx) * (cells[1] / root[1] + 1).min(*ny);
        area / roots as f32 * (span[0] * span[1]) as f32 / (root[0] * root[1]) as f32
    }

    /// Splits the leaves of a level that `wanted` names by the elements at their corners inside the region and
    /// their sides, m, and with `restricted` what lies beside them too coarse; whether any was.
    pub(super) fn subdivide(
        &mut self,
        level: u8,
        restricted: bool,
        wanted: impl Fn(&[usize], [f32; 2]) -> bool,
    ) -> bool {
        let mut grown = false;
        let (charts, elements) = (&self.charts, &self.elements);
        for (tree, chart) in self.trees.iter_mut().zip(charts) {
            let Some(tree) = tree else { continue };
            let split = tree.split(|tree, leaf| {
                if leaf.level != level {
                    return false;
                }
                let span = tree.span(leaf.level);
                let sides = [chart.step_u.length() * span[0] as f32, chart.step_v.length() * span[1] as f32];
                let corners = tree.corners(leaf).map(|c| (chart.first_element + c) as usize);
                let inside: Vec<usize> =
                    corners.into_iter().filter(|&c| elements[c].flags & OUTSIDE == 0).collect();
                wanted(&inside, sides)
            });
            if split && restricted {
                tree.restrict();
            }
            grown |= split;
        }
        if grown {
            self.mark_nodes();
        }
        grown
    }

    /// Flags the nodes that are to be solved, corners of leaves inside their region, and notes their levels.
    pub(super) fn mark_nodes(&mut self) {
        self.levels = vec![0; self.elements.len()];
        for (tree, chart) in self.trees.iter().zip(&self.charts) {
            let Some(tree) = tree else { continue };
            for (node, level) in tree.levels().into_iter().enumerate() {
                let element = chart.first_element as usize + node;
                self.levels[element] = level.unwrap_or(MOST_LEVELS);
                let flags = &mut self.elements[element].flags;
                *flags &= OUTSIDE;
                *flags |= match level {
                    _ if *flags & OUTSIDE != 0 => UNSOLVED,
                    Some(_) => 0,
                    None => UNSOLVED | INTERPOLATED,
                };
            }
        }
    }

    /// Nodes between corners and the solved corners they take their light from. Nodes with none stay away.
    pub(super) fn between(&self) -> Fills {
        let mut found = Fills::default();
        for (tree, chart) in self.trees.iter().zip(&self.charts) {
            let Some(tree) = tree else { continue };
            let first = chart.first_element;
            let mut taken = vec![false; (tree.nodes[0] * tree.nodes[1]) as usize];
            let mut leaves: Vec<&Leaf> = tree.leaves.iter().collect();
            leaves.sort_by_key(|leaf| std::cmp::Reverse(leaf.level));
            for leaf in leaves {
                let (span, corners) = (tree.span(leaf.level), tree.corners(leaf));
                for b in 0..=span[1].min(tree.nodes[1] - 1) {
                    for a in 0..=span[0].min(tree.nodes[0] - 1) {
                        let node = (leaf.at[1] + b) * tree.nodes[0] + leaf.at[0] + a;
                        let element = first + node;
                        if std::mem::replace(&mut taken[node as usize], true)
                            || self.elements[element as usize].flags & INTERPOLATED == 0
                        {
                            continue;
                        }
                        let (s, t) = (a as f32 / span[0] as f32, b as f32 / span[1] as f32);
                        let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
                        let solved = |(c, w): &(u32, f32)| {
                            *w > 0.0 && self.elements[*c as usize].flags & UNSOLVED == 0
                        };
                        let corners = corners.map(|c| first + c).into_iter().zip(weights).filter(solved);
                        let sum: f32 = corners.clone().map(|(_, weight)| weight).sum();
                        if sum > 0.0 {
                            found.push(element, corners.map(|(c, weight)| (c, weight / sum)));
                        }
                    }
                }
            }
        }
        found
    }
}
