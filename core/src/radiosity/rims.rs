//! Nodes without light of their own, and the neighbours that lend them theirs.
//!
//! Such are nodes outside their region, nodes between corners of quadtrees, and buried nodes at the rim of what
//! stands on a surface. Light is looked up at them as anywhere, so they are filled; a ray that meets them counts
//! for whom they take it from.

use super::{
    specular::Seen,
    surface_map::{BURIED, Chart, SurfaceMap, UNSOLVED},
};
use crate::math::random::{hash2, unit_f32};
use rayon::prelude::*;

/// Elements without light of their own and those they take it from.
#[derive(Clone, Debug, Default)]
pub(super) struct Fills {
    /// The element, and the end of its stretch of `sources`.
    ends: Vec<(u32, usize)>,
    /// Sources and their weights, which sum to 1 for each element.
    sources: Vec<(u32, f32)>,
}

impl Fills {
    /// Adds an element after those that it may take light from.
    pub fn push(&mut self, element: u32, sources: impl IntoIterator<Item = (u32, f32)>) {
        self.sources.extend(sources);
        self.ends.push((element, self.sources.len()));
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// An element and its sources.
    pub fn get(&self, i: usize) -> Option<(u32, &[(u32, f32)])> {
        let (element, end) = *self.ends.get(i)?;
        let start = if i == 0 { 0 } else { self.ends[i - 1].1 };
        Some((element, &self.sources[start..end]))
    }

    /// Elements and their sources, in order.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (u32, &[(u32, f32)])> {
        (0..self.len()).filter_map(|i| self.get(i))
    }

    /// Which of them each of `count` elements is; `u32::MAX` for none.
    pub fn numbers(&self, count: usize) -> Vec<u32> {
        let mut numbers = vec![u32::MAX; count];
        for (number, (element, _)) in self.ends.iter().enumerate() {
            numbers[*element as usize] = number as u32;
        }
        numbers
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.ends[..]) + size_of_val(&self.sources[..])
    }
}

/// Marks buried nodes beside open ones as unsolved, so that the light around an object that stands
/// on a surface does not fade towards it. Buried nodes further in keep their own darkness and are marked so.
pub(super) fn mark_rims(map: &mut SurfaceMap, buried: &[bool]) {
    for (number, chart) in map.charts.iter().enumerate() {
        let open = |map: &SurfaceMap, i: usize| map.elements[i].flags & UNSOLVED == 0 && !buried[i];
        let rim: Vec<usize> = (0..(chart.nx * chart.ny) as usize)
            .filter(|&i| buried[chart.first_element as usize + i])
            .filter(|&i| {
                let stride = map.stride(number, chart.first_element as usize + i);
                neighbours(chart, i, stride).any(|n| open(map, n))
            })
            .collect();
        for i in rim {
            map.elements[chart.first_element as usize + i].flags |= UNSOLVED;
        }
    }
    for (element, _) in map.elements.iter_mut().zip(buried).filter(|(e, b)| **b && e.flags & UNSOLVED == 0) {
        element.flags |= BURIED;
    }
}

/// The up to eight neighbours of a chart's node at a stride, as element numbers.
fn neighbours(chart: &Chart, node: usize, stride: [usize; 2]) -> impl Iterator<Item = usize> {
    let (nx, ny, first) = (i64::from(chart.nx), i64::from(chart.ny), chart.first_element as usize);
    let (x, y) = (node as i64 % nx, node as i64 / nx);
    let [u, v] = stride.map(|stride| stride as i64);
    (-1..=1)
        .flat_map(move |dy| (-1..=1).map(move |dx| (x + dx * u, y + dy * v)))
        .filter(move |&(i, j)| i >= 0 && j >= 0 && i < nx && j < ny && (i, j) != (x, y))
        .map(move |(i, j)| first + (j * nx + i) as usize)
}

/// Where unsolved nodes take their light from: between corners of leaves from those, then layer by layer
/// outwards from what has light. Buried nodes keep their darkness; on quadtrees, whose nodes lie apart, they lend
/// none: on grids the darkness reaches the rim, as what stands there covers a part of the rim's cells.
pub(super) fn fills(map: &SurfaceMap, between: Fills) -> Fills {
    let mut lit: Vec<bool> = map.elements.iter().map(|e| e.flags & UNSOLVED == 0).collect();
    let mut fills = between;
    fills.iter().for_each(|(element, _)| lit[element as usize] = true);
    for (number, chart) in map.charts.iter().enumerate() {
        let first = chart.first_element as usize;
        let count = (chart.nx * chart.ny) as usize;
        let buried = |i: usize| map.elements[first + i].flags & BURIED != 0;
        let is_tree = map.trees.get(number).is_some_and(Option::is_some);
        let mut known: Vec<bool> = (0..count).map(|i| lit[first + i] && !(is_tree && buried(i))).collect();
        let mut open: Vec<usize> = (0..count).filter(|&i| !known[i] && !buried(i)).collect();
        loop {
            let mut layer = Vec::new();
            open.retain(|&i| {
                let sources = || neighbours(chart, i, [1; 2]).filter(|&n| known[n - first]);
                let found = sources().count();
                if found > 0 {
                    layer.push(i);
                    fills.push((first + i) as u32, sources().map(|n| (n as u32, 1.0 / found as f32)));
                }
                found == 0
            });
            // All are filled, or what is left lies among buried nodes alone.
            if layer.is_empty() {
                break;
            }
            for i in layer {
                known[i] = true;
            }
        }
    }
    fills
}

/// Hits on unsolved elements go to a solved one that lends it light, drawn with its weight; areas are
/// divided by the weights.
pub(super) fn redirect(
    map: &mut SurfaceMap,
    hits: &mut [u32],
    seen: &mut [Option<Box<Seen>>],
    fills: &Fills,
) {
    if fills.len() == 0 {
        return;
    }
    let number_of = fills.numbers(map.elements.len() + 1);
    for (element, sources) in fills.iter().rev() {
        let area = std::mem::take(&mut map.elements[element as usize].area);
        for (source, weight) in sources {
            map.elements[*source as usize].area += area * weight;
        }
    }
    let lend = |hit: &mut u32, place: u32| {
        let mut step = 0;
        while let Some((_, sources)) = fills.get(number_of[*hit as usize] as usize) {
            let mut xi = unit_f32(hash2(place, step));
            for (source, weight) in sources {
                *hit = *source;
                if xi < *weight {
                    break;
                }
                xi -= weight;
            }
            step += 1;
        }
    };
    hits.par_iter_mut().enumerate().with_min_len(4096).for_each(|(place, hit)| lend(hit, place as u32));
    seen.par_iter_mut().enumerate().for_each(|(element, seen)| {
        for (i, (hit, _)) in seen.iter_mut().flat_map(|s| &mut s.elements).enumerate() {
            lend(hit, hash2(element as u32, i as u32));
        }
    });
}
