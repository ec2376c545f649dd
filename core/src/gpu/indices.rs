//! Corners shared between triangles for rasterising.
//!
//! The vertex that is first in a triangle says which triangle it is, so it is the triangle's own; the other
//! two may be any corner at the same place. A mesh has about as many triangles as first corners are needed
//! then, and a vertex is projected once instead of three times. Corners keep their numbers, three a triangle,
//! so shaders and tables do not know of it.

use crate::scene::geometry::Geometry;
use std::collections::HashMap;

/// Three corners a triangle, its own first, wound as the triangle is.
///
/// Corners are shared inside an object and bit for bit alone: what moves an object moves them alike.
pub(super) fn shared_corners(geometry: &Geometry) -> Vec<u32> {
    let mut indices = Vec::with_capacity(3 * geometry.len());
    for triangles in &geometry.object_triangles {
        let mut owner: HashMap<[u32; 3], u32> = HashMap::new();
        let key = |t: u32, k: u32| {
            geometry.positions[t as usize][k as usize].to_array().map(|x| (x + 0.0).to_bits())
        };
        let first: Vec<u32> = triangles
            .clone()
            .map(|t| {
                // A corner that no triangle has as its own yet, if there is one.
                let k = (0..3).find(|&k| !owner.contains_key(&key(t, k))).unwrap_or(0);
                owner.entry(key(t, k)).or_insert(3 * t + k);
                k
            })
            .collect();
        for (t, k) in triangles.clone().zip(first) {
            indices.push(3 * t + k);
            for k in [(k + 1) % 3, (k + 2) % 3] {
                indices.push(*owner.entry(key(t, k)).or_insert(3 * t + k));
            }
        }
    }
    indices
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Object, Part, Scene, material::Material, mesh::Mesh};
    use glam::{Affine3A, Vec2, Vec3};
    use std::sync::Arc;

    #[test]
    fn triangles_stay_where_they_are_and_lead_with_a_corner_of_their_own() {
        // A strip of a wavy sheet.
        let positions: Vec<Vec3> =
            (0..40).map(|i| Vec3::new((i / 2) as f32, (i % 2) as f32, (i % 5) as f32)).collect();
        let triangles = (0..38u32).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i, i + 2, i + 1] });
        let mut scene = Scene::default();
        scene.meshes.push(Arc::new(Mesh {
            normals: vec![Vec3::Z; 40],
            uvs: vec![Vec2::ZERO; 40],
            lightmap_uvs: Vec::new(),
            positions,
            triangles: triangles.collect(),
        }));
        scene.materials.push(Material::default());
        scene.objects.push(Object {
            name: "strip".into(),
            parts: vec![Part { mesh: 0, material: 0 }],
            world_from_object: Affine3A::IDENTITY,
            movable: false,
            dimmer: 1.0,
        });
        let geometry = Geometry::new(&scene);
        let indices = shared_corners(&geometry);
        let at = |i: u32| geometry.positions[i as usize / 3][i as usize % 3];
        let mut led = std::collections::HashSet::new();
        for (t, three) in indices.chunks_exact(3).enumerate() {
            assert_eq!(three[0] / 3, t as u32);
            assert!(led.insert(three[0]));
            let k = three[0] as usize % 3;
            let own = geometry.positions[t];
            assert_eq!([0, 1, 2].map(|i| at(three[i])), [0, 1, 2].map(|i| own[(k + i) % 3]));
        }
        let distinct: std::collections::HashSet<u32> = indices.iter().copied().collect();
        assert!(distinct.len() < 50, "{} corners for 38 triangles", distinct.len());
    }
}
