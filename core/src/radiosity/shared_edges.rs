//! Edges that two triangles share and across which the surface, and so its light, goes on smoothly.

use crate::scene::geometry::Geometry;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// Cosine of the angle below which two normals are one: 2.6°.
const ALIKE: f32 = 0.999;

/// An edge between two triangles that lie in a plane, or whose corners have the same normals there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedEdge {
    /// Its ends, m.
    pub ends: [Vec3; 2],
    /// The triangles.
    pub triangles: [u32; 2],
    /// Which corners of each the ends are.
    pub corners: [[usize; 2]; 2],
}

impl SharedEdge {
    /// Barycentric weights of corners 1 and 2 of one of the triangles at a share of the way between the ends.
    pub fn barycentric(&self, triangle: usize, share: f32) -> Vec2 {
        let [from, to] = self.corners[triangle];
        let weight = |corner: usize| {
            (if corner == from { 1.0 - share } else { 0.0 }) + (if corner == to { share } else { 0.0 })
        };
        Vec2::new(weight(1), weight(2))
    }
}

/// Every edge of exactly two triangles across which the surface is smooth, by place.
pub fn shared_edges(geometry: &Geometry) -> Vec<SharedEdge> {
    type Key = [[i64; 3]; 2];
    let (low, high) = geometry.bounds();
    let weld = (high - low).length().max(f32::MIN_POSITIVE) * 1e-6;
    let key = |p: Vec3| (p / weld).round().to_array().map(|x| x as i64);
    let mut edges: BTreeMap<Key, Vec<(u32, [usize; 2])>> = BTreeMap::new();
    for (t, positions) in geometry.positions.iter().enumerate() {
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (key(positions[i]), key(positions[j]));
            let (k, corners) = if a < b { ([a, b], [i, j]) } else { ([b, a], [j, i]) };
            if a != b {
                edges.entry(k).or_default().push((t as u32, corners));
            }
        }
    }
    let smooth = |edge: &SharedEdge| {
        let [m, n] = edge.triangles.map(|t| geometry.area_normal(t).normalize_or_zero());
        let normal = |side: usize, end: usize| {
            geometry.normals[edge.triangles[side] as usize][edge.corners[side][end]]
        };
        m.dot(n) >= ALIKE || (m.dot(n) > 0.0 && (0..2).all(|end| normal(0, end).dot(normal(1, end)) >= ALIKE))
    };
    let shared = edges.into_values().filter_map(|sides| {
        let [(s, one), (t, other)] = sides[..] else { return None };
        let ends = one.map(|corner| geometry.positions[s as usize][corner]);
        Some(SharedEdge { ends, triangles: [s, t], corners: [one, other] })
    });
    shared.filter(smooth).collect()
}
