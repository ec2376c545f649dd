//! Views of how radiosity is laid out: quadtrees and T-vertices, texel density, Mach bands, exchange of light.

use super::{
    RadiositySolution,
    inspect::{LIFT_SPACINGS, coloured, statistics},
    subdivide::ChartTree,
    surface_map::Chart,
};
use crate::{
    inspection::{InspectionScene, Label, Legend, Line, robust_range},
    math::{colour::luminance, false_colour::Palette},
    scene::world::World,
};
use glam::Vec3;
use std::collections::BTreeMap;

/// Half the size of a T-vertex's cross, in its leaf's steps.
const CROSS_STEPS: f32 = 0.3;

/// Links drawn from an element.
const MOST_LINKS: usize = 64;

/// Outlines of the leaves, from dark for roots to bright for the finest, and red crosses at T-vertices; `None`
/// without quadtrees.
pub fn quadtrees(solution: &RadiositySolution) -> Option<InspectionScene> {
    let (elements, map) = (solution.elements(), &solution.transport().map);
    let deepest = map.trees.iter().flatten().flat_map(|t| &t.leaves).map(|l| l.level).max()?;
    let lift = LIFT_SPACINGS * map.spacing_m;
    let mut view = InspectionScene::default();
    let (mut leaves, mut t_vertices) = (vec![0usize; usize::from(deepest) + 1], 0);
    for (tree, chart) in map.trees.iter().zip(&map.charts) {
        let Some(tree) = tree else { continue };
        let node = |n: u32| &elements[(chart.first_element + n) as usize];
        let place = |n: u32| node(n).position + node(n).normal * lift;
        for leaf in &tree.leaves {
            let corners = tree.corners(leaf);
            if corners.iter().any(|&c| !node(c).is_shown()) {
                continue;
            }
            leaves[usize::from(leaf.level)] += 1;
            let colour =
                Palette::Viridis.colour(0.2 + 0.8 * f32::from(leaf.level) / f32::from(deepest.max(1)));
            for i in 0..4 {
                view.lines.push(Line { ends: [place(corners[i]), place(corners[(i + 1) % 4])], colour });
            }
        }
        for n in t_vertices_of(tree) {
            if node(n).is_shown() {
                t_vertices += 1;
                cross(&mut view, place(n), chart);
            }
        }
    }
    let of = |(level, count): (usize, &usize)| format!("{count} leaves at level {level}");
    view.notes = leaves.iter().enumerate().map(of).collect();
    view.notes.push(format!("{t_vertices} T-vertices"));
    view.notes.extend(statistics(solution));
    Some(view)
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

/// Texels a metre: one over the root of the area of a grid's cell or of a vertex element.
pub fn texel_density(solution: &RadiositySolution, world: &World) -> InspectionScene {
    let charts = &solution.transport().map.charts;
    let densities = solution.elements().iter().map(|e| {
        let area = match charts.get(e.chart as usize) {
            Some(chart) if chart.nx > 1 && chart.ny > 1 => chart.step_u.length() * chart.step_v.length(),
            _ => e.area,
        };
        Vec3::splat(if area > 0.0 { area.sqrt().recip() } else { 0.0 })
    });
    let densities: Vec<Vec3> = densities.collect();
    coloured(solution, world, &densities, "texels a metre", "1/m")
}

/// Second difference of irradiance between the nodes of grids: bright and dark bands that the eye sees where
/// bilinear lookup creases.
pub fn second_difference(solution: &RadiositySolution, world: &World) -> InspectionScene {
    let elements = solution.elements();
    let light = |i: usize| luminance(solution.direct[i] + solution.indirect[i]);
    let mut bends = vec![Vec3::ZERO; elements.len()];
    for chart in &solution.transport().map.charts {
        let (nx, first) = (chart.nx as usize, chart.first_element as usize);
        for y in 1..(chart.ny as usize).saturating_sub(1) {
            for x in 1..nx.saturating_sub(1) {
                let i = first + y * nx + x;
                let around = [i - 1, i + 1, i - nx, i + nx];
                if around.iter().chain([&i]).all(|&k| elements[k].is_shown()) {
                    let sum: f32 = around.iter().map(|&k| light(k)).sum();
                    bends[i] = Vec3::splat(sum - 4.0 * light(i));
                }
            }
        }
    }
    let mut view = coloured(solution, world, &bends, "second difference of irradiance", "lx");
    let [_, largest] = robust_range(bends.iter().map(|b| b.x.abs()));
    if let Some(legend) = &mut view.legend {
        legend.range = [-largest, largest];
    }
    view
}

/// Lines from an element to the elements it takes most light from, each as bright as its share of
/// E = Σ B/N over the rays that met it; the notes name the largest shares. An element without rays of its own
/// gives way to the nearest one that faces the same way; `None` where there is none.
pub fn links(solution: &RadiositySolution, element: u32) -> Option<InspectionScene> {
    let (elements, transport) = (solution.elements(), solution.transport());
    let picked = elements.get(element as usize)?;
    let meets = |i: usize| transport.row(i as u32).iter().any(|&h| (h as usize) < elements.len());
    let alike = |i: &usize| elements[*i].geometric_normal.dot(picked.geometric_normal) > 0.5;
    let distance = |i: usize| elements[i].position.distance_squared(picked.position);
    let nearest = if meets(element as usize) {
        element as usize
    } else {
        let others = (0..elements.len()).filter(alike).filter(|&i| meets(i));
        others.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?
    };
    let mut given: BTreeMap<u32, f32> = BTreeMap::new();
    for &hit in transport.row(nearest as u32) {
        if let Some(radiosity) = solution.radiosity().get(hit as usize) {
            *given.entry(hit).or_default() +=
                luminance(*radiosity) / transport.row(nearest as u32).len() as f32;
        }
    }
    let sum: f32 = given.values().sum();
    let mut largest: Vec<(u32, f32)> = given.into_iter().collect();
    largest.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    largest.truncate(MOST_LINKS);
    let most = largest.first().map_or(0.0, |l| l.1);
    let from = elements[nearest].position;
    let mut view = InspectionScene {
        legend: Some(Legend {
            quantity: "irradiance from an element".into(),
            unit: "lx".into(),
            range: [0.0, most],
            names: &[],
        }),
        ..InspectionScene::default()
    };
    for (element, light) in &largest {
        let share = if most > 0.0 { light / most } else { 0.0 };
        let to = elements[*element as usize].position;
        view.lines.push(Line { ends: [from, to], colour: Palette::Viridis.colour(share) });
    }
    let name = format!("{sum:.0} lx from others");
    view.labels.push(Label { position: from, text: name, strong: true });
    let shown: f32 = largest.iter().map(|l| l.1).sum();
    view.notes.push(format!(
        "element {nearest}: {sum:.2} lx from other elements, {:.0} % of it from the {} drawn",
        100.0 * shown / sum.max(f32::MIN_POSITIVE),
        largest.len()
    ));
    view.notes.extend(
        largest.iter().take(5).map(|(e, light)| {
            format!("{light:.2} lx from element {e} at {}", elements[*e as usize].position)
        }),
    );
    Some(view)
}
