//! Nodes without light of their own, and the neighbours that lend them theirs.
//!
//! Such are nodes outside their region, nodes between corners of quadtrees, and buried nodes at the rim of what
//! stands on a surface. Light is looked up at them as anywhere, so they are filled; a ray that meets them counts
//! for whom they take it from.

use super::{
    specular::Seen,
    subdivide::Between,
    surface_map::{BURIED, Chart, SurfaceMap, UNSOLVED},
};
use crate::math::random::{hash2, unit_f32};
use rayon::prelude::*;

/// An element without light of its own and the elements it takes it from.
#[derive(Clone, Debug)]
pub(super) struct Fill {
    pub element: u32,
    pub sources: Vec<u32>,
    /// Weights of the sources, which sum to 1.
    pub weights: Vec<f32>,
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
pub(super) fn fills(map: &SurfaceMap, between: Vec<Between>) -> Vec<Fill> {
    let mut lit: Vec<bool> = map.elements.iter().map(|e| e.flags & UNSOLVED == 0).collect();
    let mut fills: Vec<Fill> = Vec::new();
    for Between { element, corners, weights } in between {
        lit[element as usize] = true;
        fills.push(Fill { element, sources: corners, weights });
    }
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
                let sources: Vec<u32> =
                    neighbours(chart, i, [1; 2]).filter(|&n| known[n - first]).map(|n| n as u32).collect();
                let found = !sources.is_empty();
                if found {
                    layer.push(i);
                    let weights = vec![1.0 / sources.len() as f32; sources.len()];
                    fills.push(Fill { element: (first + i) as u32, sources, weights });
                }
                !found
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
    fills: &[Fill],
) {
    if fills.is_empty() {
        return;
    }
    let mut fill_of = vec![u32::MAX; map.elements.len() + 1];
    for (number, fill) in fills.iter().enumerate() {
        fill_of[fill.element as usize] = number as u32;
    }
    for fill in fills.iter().rev() {
        let area = std::mem::take(&mut map.elements[fill.element as usize].area);
        for (source, weight) in fill.sources.iter().zip(&fill.weights) {
            map.elements[*source as usize].area += area * weight;
        }
    }
    let lend = |hit: &mut u32, place: u32| {
        let mut step = 0;
        while let Some(fill) = fills.get(fill_of[*hit as usize] as usize) {
            let mut xi = unit_f32(hash2(place, step));
            let mut drawn = fill.sources[0];
            for (source, weight) in fill.sources.iter().zip(&fill.weights) {
                drawn = *source;
                if xi < *weight {
                    break;
                }
                xi -= weight;
            }
            *hit = drawn;
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
