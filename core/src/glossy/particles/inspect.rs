//! Where particles fall: how many a square metre (Bastos 1999, Fig. 7.3).

use super::{
    splat::{SplatMap, SplatSettings},
    trace::Particles,
};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Legend},
    math::{colour::luminance, frame::frame_from_normal, progress::Progress},
    scene::world::World,
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Particles that are sent for the view.
const SENT: u32 = 20_000;

/// C of Eq. 7.6: some fifty particles are counted for each.
const SCALE: f32 = 4.0;

/// Hits that are drawn, at most.
const DRAWN: usize = 16_000;

/// Share of the room that a hit has for itself which its square fills, by edge.
const FILLED: f32 = 0.6;

/// Particles of a fresh tracing as squares on what they meet, coloured by how many there are a square metre; `None`
/// where nothing shines or nothing reflects.
pub fn density(world: &World, seed: u64) -> Option<InspectionScene> {
    let mut particles = Particles::new(world, seed);
    particles.trace(world, SENT, &Progress::silent()).ok()?;
    let settings = SplatSettings { scale: SCALE, ..SplatSettings::default() };
    let map = SplatMap::of(world, &particles, &settings, |_| true);
    let hits: Vec<_> = particles.hits().map(|(hit, _)| *hit).collect();
    if hits.is_empty() {
        return None;
    }
    let geometry = &world.geometry;
    let (low, high) = geometry.bounds();
    let lift = 5e-4 * (high - low).length();
    let squares: Vec<([Vec3; 4], f32)> = hits
        .par_iter()
        .step_by(hits.len().div_ceil(DRAWN))
        .map(|hit| {
            let surface = geometry.surface(hit.triangle, hit.barycentric, -hit.wi);
            let density = map.density(world, &surface);
            let half = (0.5 * FILLED / density.max(1e-6).sqrt()).min(10.0 * lift);
            let frame = frame_from_normal(surface.geometric_normal);
            let middle = surface.position + lift * surface.geometric_normal;
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            (corners.map(|c| middle + frame * (half * Vec2::from(c)).extend(0.0)), density)
        })
        .collect();
    let mut mesh = ColouredMesh::default();
    for (corners, density) in &squares {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.values.extend([Vec3::splat(*density); 4]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let mut densities: Vec<f32> = squares.iter().map(|s| s.1).collect();
    densities.sort_by(f32::total_cmp);
    // Beside a lamp there are many times as many as anywhere else.
    let range = [0.0, 2.0 * densities[densities.len() / 2]];
    let sent: Vec3 = particles.sent.iter().map(|s| s.flux).sum();
    let most = hits.iter().map(|hit| hit.bounces).max().unwrap_or(0);
    let note = format!(
        "{} particles sent, {} hits on what reflects, up to {most} bounces; of {:.0} lm sent {:.0} lm arrive straight \
         and {:.0} lm after one bounce",
        particles.count(),
        hits.len(),
        luminance(sent),
        luminance(particles.arriving(0).as_vec3()),
        luminance(particles.arriving(1).as_vec3()),
    );
    Some(InspectionScene {
        legend: Some(Legend { quantity: "particles".into(), unit: "1/m²".into(), range, names: &[] }),
        meshes: vec![mesh],
        notes: vec![note],
        ..InspectionScene::default()
    })
}
