//! Views of how radiosity is laid out and exchanged: texel density, Mach bands, links between elements.

use super::{
    RadiositySolution,
    inspect::{LIFT_SPACINGS, coloured},
};
use crate::{
    inspection::{InspectionScene, Label, Legend, Line, ValueLine, bulk_range},
    math::colour::luminance,
    scene::world::World,
};
use glam::Vec3;
use std::collections::BTreeMap;

/// Colour of the element that was picked.
const PICKED: Vec3 = Vec3::new(1.0, 0.2, 0.9);

/// Links drawn from an element.
const MOST_LINKS: usize = 64;

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
    let mut view = coloured(solution, world, &densities, "texels a metre", "1/m");
    // A lamp's few fine texels would leave one colour for all the others.
    if let Some(legend) = &mut view.legend {
        legend.range = bulk_range(densities.iter().map(|d| d.x).filter(|d| *d > 0.0));
    }
    view
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
    let [_, largest] = bulk_range(bends.iter().map(|b| b.x.abs()).filter(|b| *b > 0.0));
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
        let to = elements[*element as usize].position;
        view.value_lines.push(ValueLine { ends: [from, to], value: *light, transparency: 0.0 });
    }
    // The element itself, and the normal that its rays leave about.
    let up = elements[nearest].geometric_normal;
    let (u, v) = up.any_orthonormal_pair();
    let half = 0.5 * elements[nearest].area.sqrt();
    let corners = [u + v, v - u, -u - v, u - v].map(|c| from + up * (LIFT_SPACINGS * half) + c * half);
    let outline = (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]);
    let ends = outline.chain([[from, from + up * (2.0 * half)]]);
    view.lines.extend(ends.map(|ends| Line { ends, colour: PICKED }));
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
