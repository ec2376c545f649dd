//! Pictures from reconstructed textures: every grid of elements resampled by the smooth function through its nodes
//! (stage 1) and, where asked for, low-passed (stage 2), so that even bilinear lookup shows hardly a crease.
//!
//! What comes out is to be shown, not lit again: its transport is empty. Vertex elements stay as they are. Not in
//! the shading kernel: nodes move only when the light does, pixels at every frame.
//!
//! Limits: nodes double along each axis, so memory grows fourfold; beside a step the smooth function overshoots
//! upwards (`texture::hermite`), so shadows that elements resolve badly get a bright rim instead of a blur.

use super::{
    RadiositySolution,
    gather::Transport,
    lookup::SideMap,
    surface_map::{BURIED, Chart, Element, INTERPOLATED, OUTSIDE, SurfaceMap, UNSOLVED},
    texture::{Border, RadiosityTexture, Shape, convert::Gaps, hermite::HermiteSurface, prefilter::adaptive},
};
use crate::{math::image::LinearImage, scene::lookup::Reconstruction};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Nodes of the finer grid to one of the coarser, along each axis.
pub const FACTOR: u32 = 2;

/// How far the prefilter may move a texel, as a share of it.
pub const TOLERANCE: f32 = 0.02;

/// Nodes of a grid along an edge above which it stays as it is: the smooth function is a square of that edge.
const MOST_NODES: u32 = 2048;

impl RadiositySolution {
    /// The solution as pictures show it after a reconstruction; itself where there is none.
    pub fn reconstructed(self: &Arc<Self>, reconstruction: Reconstruction) -> Arc<Self> {
        if reconstruction == Reconstruction::Stored {
            return self.clone();
        }
        let map = &self.transport.map;
        let mut finer = SurfaceMap { spacing_m: map.spacing_m, ..SurfaceMap::default() };
        let resampled: Vec<Resampled> =
            (0..map.charts.len()).into_par_iter().map(|i| Resampled::new(self, i, reconstruction)).collect();
        let (mut direct, mut indirect) = (Vec::new(), Vec::new());
        for one in resampled {
            finer.charts.push(Chart { first_element: finer.elements.len() as u32, ..one.chart });
            finer.trees.push(None);
            finer.elements.extend(one.elements);
            direct.extend(one.direct);
            indirect.extend(one.indirect);
        }
        // Vertex elements follow the grids, as they did.
        let old_grids: u32 = map.charts.iter().map(|c| c.nx * c.ny).sum();
        let shift = finer.elements.len() as u32;
        let vertices = old_grids as usize..self.elements().len();
        finer.elements.extend(&self.elements()[vertices.clone()]);
        direct.extend(&self.direct[vertices.clone()]);
        indirect.extend(&self.indirect[vertices]);
        let grid = |first: u32| map.charts.binary_search_by_key(&first, |c| c.first_element).ok();
        finer.sides = map
            .sides
            .par_iter()
            .map(|side| match (*side == SideMap::NONE, side.size) {
                (true, _) => *side,
                (false, 0) => {
                    let [a, b, c, ..] = side.corners;
                    SideMap::vertices([a, b, c].map(|e| e - old_grids + shift))
                }
                _ => {
                    let Some(number) = grid(side.first) else { return SideMap::NONE };
                    let (old, new) = (&map.charts[number], &finer.charts[number]);
                    let scale = Vec2::new(ratio(old.nx, new.nx), ratio(old.ny, new.ny));
                    let c = side.corners.map(f32::from_bits);
                    let corners = [0, 2, 4].map(|i| Vec2::new(c[i], c[i + 1]) * scale);
                    SideMap::grid(new.first_element, new.nx, new.ny, corners)
                }
            })
            .collect();
        finer.levels = vec![0; finer.elements.len()];
        let transport = Arc::new(Transport::to_be_shown(finer));
        Arc::new(Self { direct, indirect, transport, settings: self.settings, ..Self::default() })
    }
}

/// Steps of a finer grid to one of a coarser.
fn ratio(nodes: u32, finer: u32) -> f32 {
    if nodes > 1 { (finer - 1) as f32 / (nodes - 1) as f32 } else { 1.0 }
}

/// One grid with its light on finer nodes.
struct Resampled {
    chart: Chart,
    elements: Vec<Element>,
    direct: Vec<Vec3>,
    indirect: Vec<Vec3>,
}

impl Resampled {
    fn new(solution: &RadiositySolution, number: usize, reconstruction: Reconstruction) -> Self {
        let map = &solution.transport.map;
        let chart = &map.charts[number];
        let first = chart.first_element as usize;
        let own = first..first + (chart.nx * chart.ny) as usize;
        let old = &solution.elements()[own.clone()];
        let (nodes, most) = ([chart.nx, chart.ny], chart.nx.max(chart.ny));
        if chart.nx < 2 || chart.ny < 2 || most > MOST_NODES {
            return Self {
                chart: *chart,
                elements: old.to_vec(),
                direct: solution.direct[own.clone()].to_vec(),
                indirect: solution.indirect[own].to_vec(),
            };
        }
        let root = map.trees.get(number).and_then(Option::as_ref).map_or([1, 1], |t| t.root);
        let open = |x: u32, y: u32| {
            old[(y * chart.nx + x) as usize].flags & INTERPOLATED != 0
                && !(x.is_multiple_of(root[0]) && y.is_multiple_of(root[1]))
        };
        let finer = nodes.map(|n| (n - 1) * FACTOR + 1);
        let light = |values: &[Vec3]| {
            let value = |x: u32, y: u32| values[first + (y * chart.nx + x) as usize];
            let (surface, window) = smooth(nodes, &open, &value);
            let texture = resampled(&surface, window, finer);
            let texture = match reconstruction {
                Reconstruction::Filtered => adaptive(&texture, TOLERANCE),
                Reconstruction::Stored | Reconstruction::Hermite => texture,
            };
            texture.image.pixels
        };
        let step = 1.0 / FACTOR as f32;
        let element = |i: u32| {
            let (x, y) = (i % finer[0], i / finer[0]);
            let near = |v: u32| [v / FACTOR, v.div_ceil(FACTOR)];
            let around = near(y).map(|y| near(x).map(|x| &old[(y * chart.nx + x) as usize]));
            let all = |flag: u32| around.iter().flatten().all(|e| e.flags & flag != 0);
            let place = chart.origin + (chart.step_u * x as f32 + chart.step_v * y as f32) * step;
            // What only some of the nodes around are does not hold between them.
            let flags = [UNSOLVED, OUTSIDE, BURIED].into_iter().filter(|f| all(*f)).sum::<u32>();
            let of = around[0][0];
            Element { position: place, flags, area: of.area * step * step, ..*of }
        };
        Self {
            chart: Chart {
                step_u: chart.step_u * step,
                nx: finer[0],
                step_v: chart.step_v * step,
                ny: finer[1],
                ..*chart
            },
            elements: (0..finer[0] * finer[1]).map(element).collect(),
            direct: light(&solution.direct),
            indirect: light(&solution.indirect),
        }
    }
}

/// The smooth function through the nodes of a grid, over the least square of a tree's level that holds them, and
/// the share of it that they take. Nodes that are `open` take the value of the level above. Beyond the grid the
/// nodes are turned over its border, so that slopes there are the grid's own.
pub fn smooth(
    [nx, ny]: [u32; 2],
    open: &impl Fn(u32, u32) -> bool,
    light: &impl Fn(u32, u32) -> Vec3,
) -> (HermiteSurface, Vec2) {
    let cells = (nx.max(ny) - 1).next_power_of_two();
    let side = cells + 1;
    // Where a node beyond the border is turned over to: the border, and what lies as far inside.
    let turned = |i: u32, n: u32| if i < n { (i, i) } else { (n - 1, (2 * (n - 1)).saturating_sub(i)) };
    let texels = (0..side * side).map(|i| {
        let (x, y) = (i % side, i / side);
        let ((bx, ix), (by, iy)) = (turned(x, nx), turned(y, ny));
        if (x, y) == (ix, iy) {
            return (!open(x, y)).then(|| light(x, y));
        }
        Some((2.0 * light(bx, by) - light(ix, iy)).max(Vec3::ZERO))
    });
    let samples = Gaps { side, texels: texels.collect() };
    let window = Vec2::new((nx - 1) as f32, (ny - 1) as f32) / cells as f32;
    (HermiteSurface::new(Shape::Quadrilateral, &samples), window)
}

/// A smooth function over a share of the unit square as a texture whose outermost texels lie on its border.
pub fn resampled(surface: &HermiteSurface, window: Vec2, [w, h]: [u32; 2]) -> RadiosityTexture {
    let last = Vec2::new((w - 1) as f32, (h - 1) as f32);
    lattice(LinearImage::from_fn(w, h, |x, y| surface.at(Vec2::new(x as f32, y as f32) / last * window)))
}

/// A texture whose outermost texels lie on the border, as wide as it is high or not.
pub fn lattice(image: LinearImage) -> RadiosityTexture {
    let step = Vec2::new((image.width - 1) as f32, (image.height - 1) as f32).recip();
    RadiosityTexture { image, first: Vec2::ZERO, step, border: Border::Clamp }
}
