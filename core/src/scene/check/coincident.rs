//! Faces that lie in one plane and overlap: a ray hits either, and light flickers between them.

use super::Finding;
use crate::scene::{Scene, geometry::Geometry};
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// Pairs of triangles compared at most, so that a scene of any size is checked in seconds.
const MOST_PAIRS: u64 = 20_000_000;

/// Planes closer than this share of the scene's diagonal count as one.
const PLANE_TOLERANCE: f32 = 1e-6;

/// Reports pairs of objects, or parts of one, whose faces coincide.
pub fn check(scene: &Scene, geometry: &Geometry, findings: &mut Vec<Finding>) {
    let (low, high) = geometry.bounds();
    let tolerance = PLANE_TOLERANCE * (high - low).length();
    if tolerance <= 0.0 {
        return;
    }
    let mut planes: BTreeMap<[i64; 4], Vec<u32>> = BTreeMap::new();
    for t in 0..geometry.len() as u32 {
        let Some(normal) = geometry.area_normal(t).try_normalize() else { continue };
        // Opposite faces share a plane: the largest component is made positive.
        let largest = normal.abs().max_position();
        let normal = if normal[largest] < 0.0 { -normal } else { normal };
        let distance = normal.dot(geometry.positions[t as usize][0] - low);
        let cell = |v: f32, size: f32| (v / size).round() as i64;
        // A plane on the border of two cells is entered in both.
        let (near, far) =
            (cell(distance - 0.25 * tolerance, tolerance), cell(distance + 0.25 * tolerance, tolerance));
        let direction = normal.to_array().map(|v| cell(v, 1e-4));
        for offset in near..=far {
            planes.entry([direction[0], direction[1], direction[2], offset]).or_default().push(t);
        }
    }
    let mut overlaps: BTreeMap<(u32, u32), BTreeSet<u32>> = BTreeMap::new();
    let mut budget = MOST_PAIRS;
    for triangles in planes.values().filter(|list| list.len() > 1) {
        for (a, b) in overlapping(geometry, triangles, &mut budget) {
            let objects = (geometry.object[a as usize], geometry.object[b as usize]);
            overlaps
                .entry((objects.0.min(objects.1), objects.0.max(objects.1)))
                .or_default()
                .insert(a.min(b));
        }
    }
    for ((a, b), faces) in overlaps {
        let (name, other) = (&scene.objects[a as usize].name, &scene.objects[b as usize].name);
        let whose = if a == b { "its own".to_string() } else { format!("those of \"{other}\"") };
        let what = format!("{} faces coincide with {whose}", faces.len());
        findings.push(Finding::warning(name, what, "move or delete one of them: a ray hits either"));
    }
}

/// Pairs of triangles of one plane that overlap, found by a sweep along one axis of the plane.
fn overlapping(geometry: &Geometry, triangles: &[u32], budget: &mut u64) -> Vec<(u32, u32)> {
    let normal = geometry.area_normal(triangles[0]);
    let drop = normal.abs().max_position();
    let flat = |p: Vec3| match drop {
        0 => Vec2::new(p.y, p.z),
        1 => Vec2::new(p.z, p.x),
        _ => Vec2::new(p.x, p.y),
    };
    let mut flattened: Vec<(f32, f32, u32, [Vec2; 3])> = triangles
        .iter()
        .map(|&t| {
            let corners = geometry.positions[t as usize].map(flat);
            let x = corners.map(|c| c.x);
            (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]), t, corners)
        })
        .collect();
    flattened.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    let mut pairs = Vec::new();
    for (i, (_, end, a, first)) in flattened.iter().enumerate() {
        for (start, _, b, second) in &flattened[i + 1..] {
            if start >= end || *budget == 0 {
                break;
            }
            *budget -= 1;
            if a != b && overlap(first, second) {
                pairs.push((*a, *b));
            }
        }
    }
    pairs
}

/// Whether two triangles overlap by more than a sliver: no edge of either separates them.
fn overlap(a: &[Vec2; 3], b: &[Vec2; 3]) -> bool {
    let separates = |edge: Vec2| {
        let axis = edge.perp();
        let range = |t: &[Vec2; 3]| {
            let d = t.map(|p| axis.dot(p));
            (d[0].min(d[1]).min(d[2]), d[0].max(d[1]).max(d[2]))
        };
        let ((low_a, high_a), (low_b, high_b)) = (range(a), range(b));
        let sliver = 1e-3 * (high_a - low_a).min(high_b - low_b);
        high_a <= low_b + sliver || high_b <= low_a + sliver
    };
    !(0..3).any(|i| separates(a[(i + 1) % 3] - a[i]) || separates(b[(i + 1) % 3] - b[i]))
}
