//! Views of a radiosity solution: its light as colours, its figures as text.

use super::{RadiositySolution, lookup::SideMap, surface_map::UNSOLVED};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Legend, bulk_range, robust_range},
    math::{colour::luminance, part::Part},
    scene::world::World,
};
use glam::Vec3;

/// How far lines and colours stand off the surface, in element spacings.
pub(super) const LIFT_SPACINGS: f32 = 0.02;

/// Irradiance as the elements carry it, lx: grids as quadrilaterals between nodes, vertex elements as triangles.
pub fn irradiance(solution: &RadiositySolution, world: &World, part: Part) -> InspectionScene {
    let values: Vec<Vec3> = match part {
        Part::Direct => solution.direct.clone(),
        Part::Indirect => solution.indirect.clone(),
        Part::All => solution.direct.iter().zip(&solution.indirect).map(|(d, i)| *d + *i).collect(),
    };
    coloured(solution, world, &values, "irradiance", "lx")
}

/// How much one more sweep would change each element's indirect irradiance, lx.
pub fn residual(solution: &RadiositySolution, world: &World) -> InspectionScene {
    let residual = solution.residual();
    let mut view = coloured(solution, world, &residual, "residual irradiance", "lx");
    if let Some(legend) = &mut view.legend {
        legend.range = [0.0, bulk_range(residual.iter().map(|r| luminance(*r)))[1]];
    }
    view
}

/// Figures of a solution, with units.
pub fn statistics(solution: &RadiositySolution, world: &World) -> Vec<String> {
    let (energy, convergence) = (solution.energy(world), solution.convergence());
    let transport = solution.transport();
    let solved = solution.elements().iter().filter(|e| e.flags & UNSOLVED == 0).count();
    vec![
        format!(
            "{} elements, {solved} solved, in {} grids, {:.3} m apart",
            solution.elements().len(),
            transport.map.charts.len(),
            transport.map.spacing_m
        ),
        format!("{} gather rays an element, {:.1} MB", transport.rays, solution.bytes() as f64 / 1e6),
        format!(
            "{} sweeps, residual {:.1e}, error bound {:.1e} of the mean irradiance",
            convergence.sweeps, convergence.residual, convergence.error_bound
        ),
        format!(
            "direct flux {:.1} lm, indirect {:.1} lm, absorbed {:.1} lm",
            energy.direct_flux, energy.indirect_flux, energy.absorbed_flux
        ),
    ]
}

/// Values of the elements as colours of the surfaces.
pub(super) fn coloured(
    solution: &RadiositySolution,
    world: &World,
    values: &[Vec3],
    quantity: &str,
    unit: &str,
) -> InspectionScene {
    let (elements, map) = (solution.elements(), &solution.transport().map);
    let lift = LIFT_SPACINGS * map.spacing_m;
    let mut mesh = ColouredMesh {
        positions: elements.iter().map(|e| e.position + e.geometric_normal * lift).collect(),
        values: values.to_vec(),
        ..ColouredMesh::default()
    };
    for chart in &map.charts {
        for y in 1..chart.ny {
            for x in 1..chart.nx {
                let at = |x: u32, y: u32| chart.first_element + y * chart.nx + x;
                let corners = [at(x - 1, y - 1), at(x, y - 1), at(x, y), at(x - 1, y)];
                if corners.iter().all(|&i| elements[i as usize].is_shown()) {
                    let [a, b, c, d] = corners;
                    mesh.triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    for (number, side) in map.sides.iter().enumerate() {
        if side.size != 0 || *side == SideMap::NONE {
            continue;
        }
        let (triangle, back) = (number / 2, number % 2 == 1);
        let front = world.geometry.area_normal(triangle as u32).normalize_or(Vec3::Y);
        let off = front * if back { -lift } else { lift };
        let first = mesh.positions.len() as u32;
        for (corner, position) in world.geometry.positions[triangle].iter().enumerate() {
            mesh.positions.push(*position + off);
            mesh.values.push(values[side.corners[corner] as usize]);
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    let [_, largest] = robust_range(values.iter().map(|v| luminance(*v)));
    InspectionScene {
        meshes: vec![mesh],
        legend: Some(Legend {
            quantity: quantity.into(),
            unit: unit.into(),
            range: [0.0, largest],
            names: &[],
        }),
        notes: statistics(solution, world),
        ..InspectionScene::default()
    }
}
