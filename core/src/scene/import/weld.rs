//! Vertices of files that have none to share: joined by position, with normals smooth up to a crease.
//!
//! A corner's normal is Σ α n over the triangles around its point that lean from its own by less than the
//! crease, α their angles there (Thürmer and Wüthrich 1998): it does not depend on how a face is cut. Corners
//! with one normal and one texture coordinate are one vertex. Not one normal a point, which would round boxes.

use crate::scene::mesh::Mesh;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Faces that lean from each other by more keep an edge, radians (40°).
const CREASE: f32 = 0.698;

/// Triangles around one point beyond which they stay flat: a fan of so many is no surface to be smoothed.
const MOST_AROUND: usize = 256;

/// A mesh of triangles whose vertices are known by position alone; `uvs` may be empty.
pub fn welded(positions: &[Vec3], uvs: &[Vec2], triangles: &[[u32; 3]]) -> Mesh {
    let place = |i: u32| positions[i as usize];
    // Zero and minus zero are one place.
    let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut points: HashMap<[u32; 3], usize> = HashMap::new();
    let mut around: Vec<Vec<(usize, f32)>> = Vec::new();
    let mut of_corner = Vec::with_capacity(triangles.len());
    let mut normals = Vec::with_capacity(triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        let p = corners.map(place);
        normals.push((p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero());
        of_corner.push([0, 1, 2].map(|k| {
            let point = *points.entry(bits(p[k])).or_insert_with(|| {
                around.push(Vec::new());
                around.len() - 1
            });
            let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            let angle = if a == Vec3::ZERO || b == Vec3::ZERO { 0.0 } else { a.angle_between(b) };
            around[point].push((t, angle));
            point
        }));
    }
    let mut mesh = Mesh::default();
    let mut vertices: HashMap<(usize, [u32; 3], [u32; 2]), u32> = HashMap::new();
    for (t, corners) in triangles.iter().enumerate() {
        let own = normals[t];
        mesh.triangles.push([0, 1, 2].map(|k| {
            let point = of_corner[t][k];
            let alike = |&&(u, _): &&(usize, f32)| own.dot(normals[u]) >= CREASE.cos();
            let smooth = match &around[point] {
                list if list.len() > MOST_AROUND => own,
                list => list.iter().filter(alike).map(|&(u, angle)| normals[u] * angle).sum(),
            };
            let normal = smooth.normalize_or(own);
            let uv = uvs.get(corners[k] as usize).copied().unwrap_or_default();
            let key = (point, normal.to_array().map(f32::to_bits), uv.to_array().map(f32::to_bits));
            *vertices.entry(key).or_insert_with(|| {
                mesh.positions.push(place(corners[k]));
                mesh.normals.push(normal);
                mesh.uvs.push(uv);
                mesh.positions.len() as u32 - 1
            })
        }));
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners and the triangles of two quads that share an edge, folded by an angle; no vertex is shared.
    fn fold(angle: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let (sin, cos) = angle.sin_cos();
        let (a, b) = (Vec3::new(-1.0, 0.0, 0.0), Vec3::new(cos, sin, 0.0));
        let quads = [[a, a + Vec3::Z, Vec3::Z, Vec3::ZERO], [Vec3::ZERO, Vec3::Z, b + Vec3::Z, b]];
        let corners = quads.iter().flat_map(|q| [0, 1, 2, 0, 2, 3].map(|i| q[i])).collect();
        (corners, (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
    }

    #[test]
    fn a_slight_fold_is_smooth_and_shares_its_vertices() {
        let (positions, triangles) = fold(0.4);
        let mesh = welded(&positions, &[], &triangles);
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (6, 4));
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            // On the fold half-way between the two faces, whose normals lean from y by 0 and 0.4.
            let lean = if p.x == 0.0 {
                0.2
            } else if p.x > 0.0 {
                0.4
            } else {
                0.0f32
            };
            let wanted = Vec3::new(-lean.sin(), lean.cos(), 0.0);
            assert!((*n - wanted).length() < 1e-6, "{n} at {p}");
        }
    }

    #[test]
    fn a_sharp_fold_keeps_its_edge() {
        let (positions, triangles) = fold(1.5);
        let mesh = welded(&positions, &[], &triangles);
        assert_eq!(mesh.positions.len(), 8);
        assert!(mesh.normals.iter().all(|n| (n.y - 1.0).abs() < 1e-6 || (n.y - 1.5f32.cos()).abs() < 1e-6));
    }

    #[test]
    fn a_seam_of_texture_splits_a_vertex_and_not_its_normal() {
        let (positions, triangles) = fold(0.4);
        let uvs: Vec<Vec2> = (0..12).map(|i| Vec2::splat(if i < 6 { 0.0 } else { 1.0 })).collect();
        let mesh = welded(&positions, &uvs, &triangles);
        assert_eq!(mesh.positions.len(), 8);
        let on_fold = |i: &usize| mesh.positions[*i].x == 0.0;
        let lean = (0..8).filter(on_fold).map(|i| mesh.normals[i].x);
        assert!(lean.into_iter().all(|x| (x + 0.2f32.sin()).abs() < 1e-6));
    }
}
