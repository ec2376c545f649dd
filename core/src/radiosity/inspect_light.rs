//! Views of what a solution makes of its elements: radiosity, gradient, and jumps between charts.

use super::{
    RadiositySolution,
    inspect::{LIFT_SPACINGS, coloured},
    lookup::SideMap,
    shared_edges::shared_edges,
    surface_map::{BURIED, Element},
};
use crate::{
    inspection::{InspectionScene, Legend, ValueLine, robust_range},
    math::{colour::luminance, part::Part, relative::floor_of},
    scene::world::World,
};
use glam::Vec3;

/// Radiosity B = ρ E of every element, what it emits not counted, lx.
pub fn radiosity(solution: &RadiositySolution, world: &World) -> InspectionScene {
    coloured(solution, world, solution.radiosity(), "radiosity", "lx")
}

/// Size of the gradient of irradiance along the surface, lx/m: on grids by central differences between nodes, at
/// corners of triangles the mean over those around, by area.
pub fn gradient(solution: &RadiositySolution, world: &World) -> InspectionScene {
    let (elements, map) = (solution.elements(), &solution.transport().map);
    let light = |i: usize| luminance(solution.direct[i] + solution.indirect[i]);
    let mut slopes = vec![Vec3::ZERO; elements.len()];
    for chart in &map.charts {
        let (nx, ny, first) = (chart.nx as usize, chart.ny as usize, chart.first_element as usize);
        let lengths = [chart.step_u.length(), chart.step_v.length()];
        for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))) {
            let i = first + y * nx + x;
            if !elements[i].is_shown() {
                continue;
            }
            // From the neighbour before to the one after, or from the node itself where there is none.
            let slope = |at: usize, count: usize, stride: usize, length: f32| {
                let before = (at > 0 && elements[i - stride].is_shown()).then(|| i - stride);
                let after = (at + 1 < count && elements[i + stride].is_shown()).then(|| i + stride);
                let steps = usize::from(before.is_some()) + usize::from(after.is_some());
                let rise = light(after.unwrap_or(i)) - light(before.unwrap_or(i));
                if steps == 0 || length == 0.0 { 0.0 } else { rise / (steps as f32 * length) }
            };
            slopes[i] = Vec3::splat(slope(x, nx, 1, lengths[0]).hypot(slope(y, ny, nx, lengths[1])));
        }
    }
    let mut areas = vec![0.0f32; elements.len()];
    let mut sums = areas.clone();
    for (number, side) in map.sides.iter().enumerate() {
        if side.size != 0 || *side == SideMap::NONE {
            continue;
        }
        let [a, b, c] = world.geometry.positions[number / 2];
        let corners = [side.corners[0], side.corners[1], side.corners[2]].map(|e| e as usize);
        let values = corners.map(light);
        let normal = (b - a).cross(c - a);
        let double_area = normal.length();
        if double_area == 0.0 {
            continue;
        }
        // ∇E = n × Σ Eᵢ eᵢ / 2A with eᵢ the edge opposite to corner i, in their turn.
        let along = (c - b) * values[0] + (a - c) * values[1] + (b - a) * values[2];
        let size = normal.cross(along).length() / (double_area * double_area);
        for corner in corners {
            sums[corner] += double_area * size;
            areas[corner] += double_area;
        }
    }
    for (slope, (sum, area)) in slopes.iter_mut().zip(sums.iter().zip(&areas)).filter(|(_, (_, a))| **a > 0.0)
    {
        *slope = Vec3::splat(sum / area);
    }
    coloured(solution, world, &slopes, "gradient of irradiance", "lx/m")
}

/// Edges across which the surface of an object goes on from one chart to another, coloured by how far the light jumps
/// there: |E_a − E_b| / max(E_a, E_b, 5 % of the mean), %, the most at three points of the edge. Points where either
/// side has no light of its own, as under what stands there, are left out.
pub fn seams(solution: &RadiositySolution, world: &World) -> InspectionScene {
    const POINTS: [f32; 3] = [0.25, 0.5, 0.75];
    const NOTED: f32 = 10.0;
    let (elements, map) = (solution.elements(), &solution.transport().map);
    let object = |t: u32| world.geometry.object[t as usize];
    let side = |t: u32| &map.sides[2 * t as usize];
    let lit = |t: u32| *side(t) != SideMap::NONE;
    // Vertex elements are shared by triangles: no chart ends between them.
    let chart = |t: u32| if side(t).size == 0 { 0 } else { side(t).first + 1 };
    let mean = solution.direct.iter().zip(&solution.indirect).map(|(d, i)| f64::from(luminance(*d + *i)));
    let floor = floor_of(mean.sum::<f64>() / solution.direct.len().max(1) as f64) as f32;
    let lift = 2.0 * LIFT_SPACINGS * map.spacing_m;
    let mut view = InspectionScene::default();
    for edge in shared_edges(&world.geometry) {
        let [s, t] = edge.triangles;
        if !lit(s) || !lit(t) || chart(s) == chart(t) || object(s) != object(t) {
            continue;
        }
        let light = |i: usize, share: f32| {
            let (triangle, at) = (edge.triangles[i], edge.barycentric(i, share));
            let blend = map.blend(triangle, at, false);
            let mut around = blend.elements.iter().zip(blend.weights).filter(|(_, weight)| *weight > 0.0);
            let open = |e: &Element| e.is_shown() && e.flags & BURIED == 0;
            around
                .all(|(e, _)| open(&elements[*e as usize]))
                .then(|| luminance(solution.irradiance(triangle, at, false, Part::All)))
        };
        let jump = |share: f32| {
            let (a, b) = (light(0, share)?, light(1, share)?);
            Some(100.0 * (a - b).abs() / a.max(b).max(floor))
        };
        let Some(value) = POINTS.into_iter().filter_map(jump).reduce(f32::max) else { continue };
        let off = world.geometry.area_normal(s).normalize_or_zero() * lift;
        view.value_lines.push(ValueLine { ends: edge.ends.map(|p| p + off), value, transparency: 0.0 });
    }
    let [_, most] = robust_range(view.value_lines.iter().map(|l| l.value));
    let jumps = view.value_lines.iter().filter(|l| l.value > NOTED).count();
    view.notes.push(format!(
        "{} smooth edges between charts; across {jumps} of them the light jumps by more than {NOTED:.0} %",
        view.value_lines.len()
    ));
    view.legend = Some(Legend {
        quantity: "jump of the light".into(),
        unit: "%".into(),
        range: [0.0, most],
        names: &[],
    });
    view
}
