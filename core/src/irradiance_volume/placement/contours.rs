//! Lines of equal value on a lattice: marching squares, joined to polylines.
//!
//! Along an edge the value is linear, so a linear field gives exact lines and any other one is off by the
//! curvature inside one cell. Where a cell's corners alternate, its mean decides which two belong together.

use std::collections::BTreeMap;

/// Values on a lattice, row by row; `None` where there is none: no line runs there.
#[derive(Clone, Copy, Debug)]
pub struct Lattice<'a> {
    /// Nodes along a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The values.
    pub values: &'a [Option<f32>],
}

/// A line of equal value, in lattice coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// The value.
    pub level: f32,
    /// Points [column, row]; the last is followed by the first where it is closed.
    pub points: Vec<[f32; 2]>,
    /// Whether it is a loop.
    pub closed: bool,
}

/// An edge between two nodes: column, row, and whether it runs down rather than along.
type Edge = (usize, usize, bool);

/// All lines of one level, in an order that depends on the values alone.
///
/// # Panics
/// If there are not `width · height` values.
pub fn contours(lattice: &Lattice, level: f32) -> Vec<Contour> {
    assert_eq!(lattice.values.len(), lattice.width * lattice.height, "one value a node");
    let mut links: BTreeMap<Edge, Vec<Edge>> = BTreeMap::new();
    for row in 1..lattice.height {
        for column in 1..lattice.width {
            for (a, b) in crossings(lattice, column - 1, row - 1, level) {
                links.entry(a).or_default().push(b);
                links.entry(b).or_default().push(a);
            }
        }
    }
    let ends: Vec<Edge> = links.iter().filter(|(_, l)| l.len() == 1).map(|(e, _)| *e).collect();
    let all: Vec<Edge> = links.keys().copied().collect();
    let mut lines = Vec::new();
    // Open lines first, from their ends; what is left are loops.
    for start in ends.into_iter().chain(all) {
        let Some(path) = follow(&mut links, start) else { continue };
        let closed = path.len() > 2 && path.first() == path.last();
        let mut points: Vec<[f32; 2]> = path.iter().map(|e| place(lattice, *e, level)).collect();
        if closed {
            points.pop();
        }
        lines.push(Contour { level, points, closed });
    }
    lines
}

/// Walks from an edge until the line ends, using up its links; `None` where there is no link left.
fn follow(links: &mut BTreeMap<Edge, Vec<Edge>>, start: Edge) -> Option<Vec<Edge>> {
    let mut path = vec![start];
    let mut here = start;
    while let Some(next) = links.get_mut(&here).and_then(Vec::pop) {
        if let Some(back) = links.get_mut(&next)
            && let Some(i) = back.iter().position(|e| *e == here)
        {
            back.swap_remove(i);
        }
        path.push(next);
        here = next;
    }
    (path.len() > 1).then_some(path)
}

/// Pairs of edges that a line joins within one cell.
fn crossings(lattice: &Lattice, column: usize, row: usize, level: f32) -> Vec<(Edge, Edge)> {
    let at = |c: usize, r: usize| lattice.values[r * lattice.width + c];
    let corners = [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
    let [Some(a), Some(b), Some(c), Some(d)] = corners else { return Vec::new() };
    let above = [a, b, c, d].map(|v| v >= level);
    // Top, right, bottom, left.
    let edges: [Edge; 4] =
        [(column, row, false), (column + 1, row, true), (column, row + 1, false), (column, row, true)];
    let crossed: Vec<usize> = (0..4).filter(|&i| above[i] != above[(i + 1) % 4]).collect();
    match crossed[..] {
        [i, j] => vec![(edges[i], edges[j])],
        [_, _, _, _] => {
            let middle = 0.25 * (a + b + c + d) >= level;
            // The line goes around the corners that differ from the middle.
            if middle == above[0] {
                vec![(edges[0], edges[1]), (edges[2], edges[3])]
            } else {
                vec![(edges[3], edges[0]), (edges[1], edges[2])]
            }
        }
        _ => Vec::new(),
    }
}

/// Where the level is met on an edge, in lattice coordinates.
fn place(lattice: &Lattice, (column, row, down): Edge, level: f32) -> [f32; 2] {
    let other = if down { (column, row + 1) } else { (column + 1, row) };
    let at = |(c, r): (usize, usize)| lattice.values[r * lattice.width + c].unwrap_or(level);
    let (a, b) = (at((column, row)), at(other));
    let t = if a == b { 0.5 } else { ((level - a) / (b - a)).clamp(0.0, 1.0) };
    let (x, y) = (column as f32, row as f32);
    if down { [x, y + t] } else { [x + t, y] }
}
