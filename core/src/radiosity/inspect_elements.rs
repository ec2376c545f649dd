//! What radiosity is solved on: the areas that elements stand for, and their edges, both by level.
//!
//! A level is how often a side was halved from the usual spacing: that of a leaf of a quadtree, else
//! log₂(spacing / side) of a grid's cell or a triangle, rounded. So lamps' finer grids and small triangles
//! of curved meshes can be told from the rest whether there are quadtrees or not.

use super::{
    RadiositySolution,
    inspect::{LIFT_SPACINGS, statistics},
    lookup::SideMap,
    subdivide::ChartTree,
    surface_map::{Chart, Element},
};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Legend, Line, ValueLine},
    scene::world::World,
};
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;

/// Half the size of a T-vertex's cross, in its leaf's steps.
const CROSS_STEPS: f32 = 0.3;

/// Share of the picture that shows through the one and the other squares of the elements' chequers.
const CHEQUERS: [f32; 2] = [0.35, 0.65];

/// The area that each element of a grid stands for and the triangles of vertex elements, over the lit picture in
/// chequers and coloured by level.
pub fn elements(solution: &RadiositySolution, world: &World) -> InspectionScene {
    let (elements, map) = (solution.elements(), &solution.transport().map);
    let lift = LIFT_SPACINGS * map.spacing_m;
    let mut meshes = CHEQUERS.map(|transparency| ColouredMesh { transparency, ..ColouredMesh::default() });
    let mut add = |chequer: u32, corners: &[Vec3], level: f32| {
        let mesh = &mut meshes[chequer as usize % 2];
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.values.extend(corners.iter().map(|_| Vec3::splat(level)));
        mesh.triangles.extend((2..corners.len() as u32).map(|i| [first, first + i - 1, first + i]));
    };
    for (chart, tree) in map.charts.iter().zip(&map.trees) {
        let normal = elements[chart.first_element as usize].geometric_normal;
        let place = |at: Vec2| chart.origin + chart.step_u * at.x + chart.step_v * at.y + normal * lift;
        let corners = |low: Vec2, high: Vec2| {
            [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)].map(place)
        };
        let shown = |n: u32| elements[(chart.first_element + n) as usize].is_shown();
        if let Some(tree) = tree {
            for leaf in tree.leaves.iter().filter(|l| tree.corners(l).into_iter().all(shown)) {
                let span = tree.span(leaf.level);
                let low = Vec2::new(leaf.at[0] as f32, leaf.at[1] as f32);
                let high = low + Vec2::new(span[0] as f32, span[1] as f32);
                let chequer = leaf.at[0] / span[0] + leaf.at[1] / span[1];
                add(chequer, &corners(low, high), f32::from(leaf.level));
            }
            continue;
        }
        let last = Vec2::new((chart.nx - 1) as f32, (chart.ny - 1) as f32);
        let level = level(map.spacing_m, side(chart));
        for (x, y) in (0..chart.ny).flat_map(|y| (0..chart.nx).map(move |x| (x, y))) {
            let at = Vec2::new(x as f32, y as f32);
            // A single node stands for the whole width, in whose middle it lies.
            let wide = Vec2::new(f32::from(chart.nx == 1), f32::from(chart.ny == 1));
            let (low, high) = ((at - 0.5).max(-0.5 * wide), (at + 0.5).min(last + 0.5 * wide));
            if shown(y * chart.nx + x) {
                add(x + y, &corners(low, high), level);
            }
        }
    }
    for (triangle, back) in vertex_sides(&map.sides) {
        let off =
            world.geometry.area_normal(triangle).normalize_or(Vec3::Y) * if back { -lift } else { lift };
        let corners = world.geometry.positions[triangle as usize].map(|p| p + off);
        add(triangle, &corners, level(map.spacing_m, triangle_side(corners)));
    }
    let deepest = meshes.iter().flat_map(|m| &m.values).map(|v| v.x).fold(1.0, f32::max);
    InspectionScene {
        meshes: meshes.into(),
        legend: Some(legend(deepest)),
        notes: statistics(solution, world),
        ..InspectionScene::default()
    }
}

/// Edges between elements, coloured by level: of the leaves of quadtrees, of the cells of grids without them, of
/// the triangles of vertex elements; and red crosses at T-vertices, corners of leaves inside an edge of another.
pub fn edges(solution: &RadiositySolution, world: &World) -> InspectionScene {
    let (elements, map) = (solution.elements(), &solution.transport().map);
    let lift = LIFT_SPACINGS * map.spacing_m;
    let mut view = InspectionScene::default();
    let (mut leaves, mut t_vertices) = (Vec::new(), 0);
    for (tree, chart) in map.trees.iter().zip(&map.charts) {
        let node = |n: u32| &elements[(chart.first_element + n) as usize];
        let place = |e: &Element| e.position + e.normal * lift;
        let Some(tree) = tree else {
            let level = level(map.spacing_m, side(chart));
            cells(chart, |a, b| {
                if let [true, true] = [a, b].map(|n| node(n).is_shown()) {
                    view.value_lines.push(line([a, b].map(|n| place(node(n))), level));
                }
            });
            continue;
        };
        for leaf in &tree.leaves {
            let corners = tree.corners(leaf);
            if corners.iter().any(|&c| !node(c).is_shown()) {
                continue;
            }
            let level = usize::from(leaf.level);
            leaves.resize(leaves.len().max(level + 1), 0);
            leaves[level] += 1;
            for i in 0..4 {
                let ends = [corners[i], corners[(i + 1) % 4]].map(|n| place(node(n)));
                view.value_lines.push(line(ends, level as f32));
            }
        }
        for n in t_vertices_of(tree).into_iter().filter(|n| node(*n).is_shown()) {
            t_vertices += 1;
            cross(&mut view, place(node(n)), chart);
        }
    }
    let mut known = BTreeSet::new();
    for (triangle, back) in vertex_sides(&map.sides) {
        let off =
            world.geometry.area_normal(triangle).normalize_or(Vec3::Y) * if back { -lift } else { lift };
        let corners = world.geometry.positions[triangle as usize].map(|p| p + off);
        let level = level(map.spacing_m, triangle_side(corners));
        let side = &map.sides[2 * triangle as usize + usize::from(back)];
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (side.corners[i], side.corners[j]);
            if known.insert([a.min(b), a.max(b)]) {
                view.value_lines.push(line([corners[i], corners[j]], level));
            }
        }
    }
    let of = |(level, count): (usize, &usize)| format!("{count} leaves of quadtrees at level {level}");
    view.notes = leaves.iter().enumerate().map(of).collect();
    if !leaves.is_empty() {
        view.notes.push(format!("{t_vertices} T-vertices"));
    }
    view.notes.extend(statistics(solution, world));
    let deepest = view.value_lines.iter().map(|l| l.value).fold(1.0, f32::max);
    view.legend = Some(legend(deepest));
    view
}

fn legend(deepest: f32) -> Legend {
    Legend {
        quantity: "level".into(),
        unit: "halvings of the spacing".into(),
        range: [0.0, deepest],
        names: &[],
    }
}

fn line(ends: [Vec3; 2], value: f32) -> ValueLine {
    ValueLine { ends, value, transparency: 0.0 }
}

/// How often a side was halved from the spacing, 0 for what is as long or longer.
fn level(spacing_m: f32, side_m: f32) -> f32 {
    (spacing_m / side_m.max(f32::MIN_POSITIVE)).log2().round().clamp(0.0, 16.0)
}

/// The longer side of a grid's cell, m.
fn side(chart: &Chart) -> f32 {
    chart.step_u.length().max(chart.step_v.length())
}

/// The side of a square as large as two of a triangle, m.
fn triangle_side([a, b, c]: [Vec3; 3]) -> f32 {
    (b - a).cross(c - a).length().sqrt()
}

/// Triangles, and whether their backs, that are lit by an element a corner.
fn vertex_sides(sides: &[SideMap]) -> impl Iterator<Item = (u32, bool)> + '_ {
    let by_corners = |(_, side): &(usize, &SideMap)| side.size == 0 && **side != SideMap::NONE;
    sides.iter().enumerate().filter(by_corners).map(|(n, _)| ((n / 2) as u32, n % 2 == 1))
}

/// Calls for each pair of nodes that are next to each other on a grid.
fn cells(chart: &Chart, mut edge: impl FnMut(u32, u32)) {
    for y in 0..chart.ny {
        for x in 0..chart.nx {
            let node = y * chart.nx + x;
            if x + 1 < chart.nx {
                edge(node, node + 1);
            }
            if y + 1 < chart.ny {
                edge(node, node + chart.nx);
            }
        }
    }
}

/// Corners of leaves inside an edge of another leaf.
fn t_vertices_of(tree: &ChartTree) -> Vec<u32> {
    let corners = tree.levels();
    let mut found = Vec::new();
    for leaf in &tree.leaves {
        let span = tree.span(leaf.level);
        let node = |x: u32, y: u32| (leaf.at[1] + y) * tree.nodes[0] + leaf.at[0] + x;
        let across = (1..span[0]).flat_map(|x| [node(x, 0), node(x, span[1].min(tree.nodes[1] - 1))]);
        let along = (1..span[1]).flat_map(|y| [node(0, y), node(span[0].min(tree.nodes[0] - 1), y)]);
        found.extend(across.chain(along).filter(|n| corners.get(*n as usize).is_some_and(Option::is_some)));
    }
    found.sort_unstable();
    found.dedup();
    found
}

fn cross(view: &mut InspectionScene, at: Vec3, chart: &Chart) {
    for step in [chart.step_u + chart.step_v, chart.step_u - chart.step_v] {
        let half = step * CROSS_STEPS;
        view.lines.push(Line { ends: [at - half, at + half], colour: Vec3::new(0.9, 0.05, 0.05) });
    }
}
