//! Quadtrees over the unit square or the triangle (0, 0), (1, 0), (0, 1).
//!
//! A tree is topology only; radiosities are lists beside it, one a leaf in the order of [`Quadtree::leaves`]
//! or one a vertex of the lattice of its finest level. Children of a quadrilateral go round as in Bastos's
//! programs: (2u, 2v), (2u+1, 2v), (2u+1, 2v+1), (2u, 2v+1). A triangle splits at the middles of its edges
//! into three at its corners and one upside down between them; that one's own corners count from
//! (u+1, v+1) backwards.
//!
//! An unrestricted tree may have leaves of any level side by side; a restricted one only leaves at most
//! one level apart ([`Quadtree::restrict`]).

use glam::{UVec2, Vec2};

/// Highest level: 1,024 cells along an edge.
pub const MOST_LEVELS: u32 = 10;

/// What a tree divides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// The unit square.
    Quadrilateral,
    /// The half of it below u + v = 1.
    Triangle,
}

/// A node of a tree by its place: cell (u, v) of the 2^level × 2^level grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Cell {
    /// Depth; the root has 0.
    pub level: u32,
    /// Column.
    pub u: u32,
    /// Row.
    pub v: u32,
    /// Whether it is the half of the cell beyond its diagonal; only in triangles.
    pub inverted: bool,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    cell: Cell,
    /// First of four children, or 0.
    children: u32,
}

/// A quadtree; see the module's text.
#[derive(Clone, Debug)]
pub struct Quadtree {
    shape: Shape,
    nodes: Vec<Node>,
}

impl Cell {
    const ROOT: Self = Self { level: 0, u: 0, v: 0, inverted: false };

    /// The four parts in order.
    pub fn children(&self, shape: Shape) -> [Self; 4] {
        let (level, u, v) = (self.level + 1, 2 * self.u, 2 * self.v);
        let part = |du: u32, dv: u32, inverted| Self { level, u: u + du, v: v + dv, inverted };
        match (shape, self.inverted) {
            (Shape::Quadrilateral, _) => {
                [part(0, 0, false), part(1, 0, false), part(1, 1, false), part(0, 1, false)]
            }
            (Shape::Triangle, false) => {
                [part(0, 0, false), part(1, 0, false), part(0, 1, false), part(0, 0, true)]
            }
            (Shape::Triangle, true) => {
                [part(1, 1, true), part(0, 1, true), part(1, 0, true), part(1, 1, false)]
            }
        }
    }

    /// Its corners, going round, as vertices of the lattice of level `height`: four, or three of a triangle.
    ///
    /// # Panics
    /// If `height` is less than its level.
    pub fn corners(&self, shape: Shape, height: u32) -> impl Iterator<Item = UVec2> + use<> {
        let span = self.span(height);
        let at = move |u: u32, v: u32| UVec2::new(u, v) * span;
        let (u, v) = (self.u, self.v);
        let list = match (shape, self.inverted) {
            (Shape::Quadrilateral, _) => [(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)],
            (Shape::Triangle, false) => [(u, v), (u + 1, v), (u, v + 1), (u, v)],
            (Shape::Triangle, true) => [(u + 1, v + 1), (u, v + 1), (u + 1, v), (u, v)],
        };
        let count = if shape == Shape::Quadrilateral { 4 } else { 3 };
        list.into_iter().take(count).map(move |(u, v)| at(u, v))
    }

    /// Cells of level `height` along its edge.
    ///
    /// # Panics
    /// If `height` is less than its level.
    pub fn span(&self, height: u32) -> u32 {
        assert!(height >= self.level, "a cell of level {} in a lattice of level {height}", self.level);
        1 << (height - self.level)
    }

    /// Its middle in the unit square.
    pub fn centre(&self, shape: Shape) -> Vec2 {
        let (sum, count) =
            self.corners(shape, self.level).fold((Vec2::ZERO, 0.0), |(s, n), c| (s + c.as_vec2(), n + 1.0));
        sum / count / (1u32 << self.level) as f32
    }

    /// Lattice vertices strictly inside its edges, at level `height`.
    fn inside_edges(&self, shape: Shape, height: u32) -> Vec<UVec2> {
        let corners: Vec<UVec2> = self.corners(shape, height).collect();
        let span = self.span(height);
        let edges = corners.iter().zip(corners.iter().cycle().skip(1));
        edges.flat_map(|(a, b)| (1..span).map(move |k| (*a * (span - k) + *b * k) / span)).collect()
    }
}

impl Quadtree {
    /// One leaf.
    pub fn new(shape: Shape) -> Self {
        Self { shape, nodes: vec![Node { cell: Cell::ROOT, children: 0 }] }
    }

    /// A tree all of whose leaves are at level `height`.
    ///
    /// # Panics
    /// If `height` is above 10.
    pub fn full(shape: Shape, height: u32) -> Self {
        assert!(height <= MOST_LEVELS, "height {height}, at most {MOST_LEVELS}");
        let mut tree = Self::new(shape);
        tree.refine(height, |_| true);
        tree
    }

    /// Splits every leaf below level `height` for which `wanted` says so, and its parts in turn; whether
    /// anything was split.
    pub fn refine(&mut self, height: u32, wanted: impl Fn(&Cell) -> bool) -> bool {
        let before = self.nodes.len();
        let mut next = 0;
        while next < self.nodes.len() {
            let Node { cell, children } = self.nodes[next];
            if children == 0 && cell.level < height.min(MOST_LEVELS) && wanted(&cell) {
                self.nodes[next].children = self.nodes.len() as u32;
                let parts = cell.children(self.shape);
                self.nodes.extend(parts.map(|cell| Node { cell, children: 0 }));
            }
            next += 1;
        }
        self.nodes.len() > before
    }

    /// Splits leaves until none has a neighbour across an edge that is more than one level finer.
    pub fn restrict(&mut self) {
        loop {
            let (height, known) = (self.height(), self.vertices());
            let side = (1 << height) + 1;
            let shape = self.shape;
            let too_coarse = |cell: &Cell| {
                let corners: Vec<UVec2> = cell.corners(shape, height).collect();
                let middles: Vec<UVec2> =
                    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| (*a + *b) / 2).collect();
                cell.level + 1 < height
                    && cell
                        .inside_edges(shape, height)
                        .iter()
                        .any(|p| known[(p.y * side + p.x) as usize] && !middles.contains(p))
            };
            if !self.refine(height, too_coarse) {
                return;
            }
        }
    }

    /// What it divides.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Level of the deepest leaf.
    pub fn height(&self) -> u32 {
        self.nodes.iter().map(|n| n.cell.level).max().unwrap_or(0)
    }

    /// The leaves, depth first.
    pub fn leaves(&self) -> Vec<Cell> {
        let mut found = Vec::new();
        let mut open = vec![0];
        while let Some(i) = open.pop() {
            let Node { cell, children } = self.nodes[i as usize];
            if children == 0 {
                found.push(cell);
            } else {
                open.extend((children..children + 4).rev());
            }
        }
        found
    }

    /// Which vertices of the lattice of its finest level are corners of leaves: (2^height + 1)² entries,
    /// row-major.
    pub fn vertices(&self) -> Vec<bool> {
        let height = self.height();
        let side = (1u32 << height) + 1;
        let mut known = vec![false; (side * side) as usize];
        for leaf in self.leaves() {
            for p in leaf.corners(self.shape, height) {
                known[(p.y * side + p.x) as usize] = true;
            }
        }
        known
    }

    /// Corners of leaves that lie inside an edge of another leaf, on the lattice of its finest level.
    pub fn t_vertices(&self) -> Vec<UVec2> {
        let (height, known) = (self.height(), self.vertices());
        let side = (1 << height) + 1;
        let mut found: Vec<UVec2> = self
            .leaves()
            .iter()
            .flat_map(|leaf| leaf.inside_edges(self.shape, height))
            .filter(|p| known[(p.y * side + p.x) as usize])
            .collect();
        found.sort_by_key(|p| [p.y, p.x]);
        found.dedup();
        found
    }
}
