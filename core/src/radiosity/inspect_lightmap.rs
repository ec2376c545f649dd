//! A lightmap on the surfaces it was baked for.

use super::{
    faults::{Fault, KINDS},
    inspect::LIFT_SPACINGS,
    lightmap::{JudgedTexel, LightmapReport, Seam},
    texels::dilate,
};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Legend, Line, ValueLine, robust_range},
    math::colour::luminance,
    scene::world::World,
};
use glam::{Vec2, Vec3};

/// Vertices that all triangles together are cut into, about, where there are not more triangles.
const MOST_VERTICES: f32 = 3e5;
/// Pieces along an edge of one triangle.
const MOST_PIECES: f32 = 128.0;

/// Colour of an edge that is a seam.
const SEAM_INK: Vec3 = Vec3::new(0.05, 0.7, 0.1);

/// What is shown of the texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The lightmap's irradiance.
    Light,
    /// The lightmap less our light, by luminance.
    Difference,
    /// The lightmap less what the path tracer finds, by luminance; black where it was not asked.
    Error,
}

/// The lightmap of a report on the scene, in lx: triangles cut about as finely as the texels lie, bilinear
/// between covered texels; the edges that are seams as lines. For reports on the geometry's own coordinates.
pub fn on_surfaces(report: &LightmapReport, world: &World, spacing_m: f32, shown: Shown) -> InspectionScene {
    let value = |i: usize, t: &JudgedTexel| match shown {
        Shown::Light => t.found,
        Shown::Difference => Vec3::splat(luminance(t.found - t.ours)),
        Shown::Error => Vec3::splat(report.traced.get(i).map_or(0.0, |e| luminance(t.found - *e))),
    };
    let [width, height] = report.size;
    let mut texels = vec![None; (width * height) as usize];
    for (i, t) in report.texels.iter().enumerate() {
        texels[(t.at[1] * width + t.at[0]) as usize] = Some(value(i, t));
    }
    dilate(&mut texels, report.size, 1);
    let lift = LIFT_SPACINGS * spacing_m;
    // Pieces a texel along an edge: triangles are cut into n² pieces, however long and thin they are.
    let edge_of = |[a, b, c]: [Vec2; 3]| a.distance(b).max(b.distance(c)).max(c.distance(a));
    let on_map =
        |uvs: &[Vec2; 3]| uvs.map(|uv| uv * Vec2::new(width as f32, height as f32) - Vec2::splat(0.5));
    let mapped = |t: &u32| report.unmapped.binary_search(t).is_err();
    let all = (0..).zip(&world.geometry.lightmap_uvs).filter(|(t, _)| mapped(t));
    let pieces: f32 = all.clone().map(|(_, uvs)| 0.5 * edge_of(on_map(uvs)).min(MOST_PIECES).powi(2)).sum();
    let fineness = (MOST_VERTICES / pieces.max(1.0)).sqrt().min(1.0);
    let mut mesh = ColouredMesh::default();
    for (triangle, uvs) in all {
        let corners = on_map(uvs);
        let [a, b, c] = corners;
        let n = (fineness * edge_of(corners).min(MOST_PIECES)).ceil().max(1.0) as u32;
        let off = world.geometry.area_normal(triangle).normalize_or_zero() * lift;
        let places = world.geometry.positions[triangle as usize].map(|p| p + off);
        let first = mesh.positions.len() as u32;
        let mut known_here = Vec::new();
        for (i, j) in (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))) {
            let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
            let value = known(&texels, report.size, a + (b - a) * u + (c - a) * v);
            known_here.push(value.is_some());
            mesh.positions.push(places[0] + (places[1] - places[0]) * u + (places[2] - places[0]) * v);
            mesh.values.push(value.unwrap_or_default());
        }
        // Row i begins after the n + 1, n, … vertices of the rows before it.
        let at = |i: u32, j: u32| first + i * (n + 1) - i * i.saturating_sub(1) / 2 + j;
        let is_known = |piece: &[u32; 3]| piece.iter().all(|v| known_here[(v - first) as usize]);
        for (i, j) in (0..n).flat_map(|i| (0..n - i).map(move |j| (i, j))) {
            let lower = [at(i, j), at(i + 1, j), at(i, j + 1)];
            let upper = (i + j + 1 < n).then(|| [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            mesh.triangles.extend(std::iter::once(lower).chain(upper).filter(is_known));
        }
    }
    let (quantity, range) = match shown {
        Shown::Light => {
            let [_, high] = robust_range(mesh.values.iter().map(|v| luminance(*v)));
            ("lightmap", [0.0, high])
        }
        Shown::Difference => ("lightmap − ours", report.difference_range()),
        Shown::Error => ("lightmap − path tracer", report.difference_range()),
    };
    InspectionScene {
        meshes: vec![mesh],
        lines: report.seams.iter().map(|s| Line { ends: s.ends, colour: SEAM_INK }).collect(),
        legend: Some(Legend { quantity: quantity.into(), unit: "lx".into(), range, names: &[] }),
        notes: vec![format!("{} texels, {} seams", report.texels.len(), report.seams.len())],
        ..InspectionScene::default()
    }
}

/// The texels that something is wrong with as squares on their surfaces, coloured by fault, and the edges that are
/// seams.
pub fn faults(report: &LightmapReport, world: &World) -> InspectionScene {
    let sizes = report.texel_sizes(&world.geometry);
    let found = report.faults(&world.geometry);
    let mut mesh = ColouredMesh { transparency: 0.15, ..ColouredMesh::default() };
    for texel in &report.texels {
        let Some(fault) = found[(texel.at[1] * report.size[0] + texel.at[0]) as usize] else { continue };
        let normal = world.geometry.area_normal(texel.triangle).normalize_or(Vec3::Y);
        let (u, v) = normal.any_orthonormal_pair();
        let half = 0.5 * sizes.get(&texel.triangle).copied().unwrap_or(0.0);
        let middle = texel.position + normal * (2.0 * LIFT_SPACINGS * half);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([u + v, v - u, -u - v, u - v].map(|c| middle + c * half));
        mesh.values.extend([Vec3::splat(fault.kind() as f32); 4]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let seam = Fault::Seam.kind() as f32;
    let line = |s: &Seam| ValueLine { ends: s.ends, value: seam, transparency: 0.0 };
    InspectionScene {
        meshes: vec![mesh],
        value_lines: report.seams.iter().map(line).collect(),
        legend: Some(Legend {
            quantity: "faults of the lightmap".into(),
            unit: String::new(),
            range: [0.0, (KINDS.len() - 1) as f32],
            names: &KINDS,
        }),
        notes: Fault::ALL
            .into_iter()
            .map(|f| (f, report.count(f)))
            .filter(|(_, (count, _))| *count > 0)
            .map(|(f, (count, of))| format!("{}: {count} {of}", f.name()))
            .collect(),
        ..InspectionScene::default()
    }
}

/// Bilinear between the texels that are known; `None` where none of the four is.
fn known(texels: &[Option<Vec3>], [width, height]: [u32; 2], at: Vec2) -> Option<Vec3> {
    let base = at.floor();
    let f = at - base;
    let mut sum = Vec3::ZERO;
    let mut weights = 0.0;
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let [x, y] = [base.x as i64 + dx, base.y as i64 + dy];
        if x < 0 || y < 0 || x >= i64::from(width) || y >= i64::from(height) {
            continue;
        }
        let Some(value) = texels[(y * i64::from(width) + x) as usize] else { continue };
        let weight = (if dx == 1 { f.x } else { 1.0 - f.x }) * (if dy == 1 { f.y } else { 1.0 - f.y });
        sum += value * weight;
        weights += weight;
    }
    (weights > 0.0).then(|| sum / weights)
}
