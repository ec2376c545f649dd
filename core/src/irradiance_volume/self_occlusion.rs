//! What an object hides from itself, known before it moves (Greger 1996, §5.1.3, §6.1.3).
//!
//! Each node has the share V of its cosine-weighted hemisphere that the object leaves open, and its indirect
//! light is taken as V E_volume. Limits: the hidden part of the hemisphere counts as black, although it sends
//! back some of what falls on it (a lit bowl brightens itself), and as average in what it would have shown.

use super::dynamic_object::{DynamicObject, entry, lattice_blend, lattice_len};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Legend},
    math::{
        frame::{cosine_direction, frame_from_normal},
        random::{fold, hash2, r2_point},
    },
    scene::{
        accel::Ray,
        geometry::{Geometry, offset_origin},
        world::World,
    },
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Rays an object's self-occlusion takes, about, and the bounds of those of one node.
const OCCLUSION_RAYS: usize = 600_000;
const NODE_RAYS: [u32; 2] = [48, 512];
/// Nodes at most that are asked one by one what they hide.
const MOST_OCCLUDED: usize = 12_000;

impl DynamicObject {
    /// Precomputes what the object hides from itself: V = ∫ visible cos θ dω / π at every node, or, in an
    /// object of very many, at those of the coarse level.
    ///
    /// # Panics
    /// If the object is not movable in `world`.
    pub fn occlude(&mut self, world: &World, object: usize, seed: u64) {
        let geometry = &world.geometry;
        let first = geometry.object_triangles[object].start;
        let [least, most] = NODE_RAYS;
        let each = |node: usize, rays: u32| {
            let (triangle, _) = self.places[node];
            let (position, normal) = self.place(geometry, first, node);
            let front = geometry.area_normal(first + triangle).normalize_or(Vec3::Y);
            let scramble = hash2(node as u32, fold(seed));
            let two_sided = geometry.material_of(first + triangle).double_sided;
            [1.0f32, -1.0].map(|side| {
                if side < 0.0 && !two_sided {
                    return 1.0;
                }
                // Nodes lie on edges and corners: a little inwards, off the triangles that meet there, and
                // up by so little more that it stays on this side of all but the narrowest grooves.
                let inward = 1e-3 * (self.middle(geometry, first, triangle) - position);
                let start = position + inward + front * (side * 0.02 * inward.length());
                let origin = offset_origin(start, front * side);
                let frame = frame_from_normal(normal * side);
                let open = (0..rays).filter(|&ray| {
                    let direction = frame * cosine_direction(r2_point(ray, scramble));
                    // Below the plane of its own triangle, a smooth normal sees no object but the surface.
                    direction.dot(front) * side <= 0.0
                        || !world.accel.occluded_by(object as u32, &Ray::new(origin, direction))
                });
                open.count() as f32 / rays as f32
            })
        };
        let rays = |nodes: usize| ((OCCLUSION_RAYS / nodes.max(1)) as u32).clamp(least, most);
        let count = self.places.len();
        if count <= MOST_OCCLUDED {
            self.open = (0..count).into_par_iter().map(|node| each(node, rays(count))).collect();
            return;
        }
        // Too many to ask each: those of the coarse level, blended as their light is.
        let count = self.asked.len();
        let asked: Vec<[f32; 2]> = self.asked.par_iter().map(|&v| each(v as usize, rays(count))).collect();
        let blend = |b: &[(u32, f32); 4]| -> [f32; 2] {
            std::array::from_fn(|side| b.iter().map(|&(entry, w)| asked[entry as usize][side] * w).sum())
        };
        let mut open: Vec<[f32; 2]> = self.blends.iter().map(blend).collect();
        for &(triangle, Vec2 { x: u, y: v }) in &self.places[self.vertices..] {
            let [a, b, c]: [[f32; 2]; 3] = std::array::from_fn(|i| open[self.corner(triangle, i) as usize]);
            open.push(std::array::from_fn(|s| a[s] * (1.0 - u - v) + b[s] * u + c[s] * v));
        }
        self.open = open;
    }

    fn middle(&self, geometry: &Geometry, first: u32, triangle: u32) -> Vec3 {
        let [a, b, c] = geometry.positions[(first + triangle) as usize];
        (a + b + c) / 3.0
    }

    /// Share of the hemisphere over a point of a triangle that the object leaves open.
    pub fn open_at(&self, triangle: u32, barycentric: Vec2, back: bool) -> f32 {
        let (first, steps) = self.lattices[triangle as usize];
        let (entries, weights) = lattice_blend(steps, barycentric);
        let of = |entry: u32| self.open[self.nodes[(first + entry) as usize] as usize][usize::from(back)];
        (0..3).map(|i| of(entries[i]) * weights[i]).sum()
    }

    /// The object where it stands, coloured by how much of the hemisphere over its front is open, %.
    fn open_mesh(&self, geometry: &Geometry, object: usize) -> ColouredMesh {
        let first = geometry.object_triangles[object].start;
        let mut mesh = ColouredMesh::default();
        for &(start, steps) in &self.lattices {
            let base = mesh.positions.len() as u32;
            for &node in &self.nodes[start as usize..][..lattice_len(steps) as usize] {
                mesh.positions.push(self.place(geometry, first, node as usize).0);
                mesh.values.push(Vec3::splat(100.0 * self.open[node as usize][0]));
            }
            for j in 0..steps {
                for i in 0..steps - j {
                    let at = |i, j| base + entry(steps, i, j);
                    mesh.triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                    if i + j + 2 <= steps {
                        mesh.triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                    }
                }
            }
        }
        mesh
    }
}

/// Everything movable, coloured by the share of the hemisphere that it leaves open to itself, %.
pub fn scene(objects: &BTreeMap<u32, DynamicObject>, geometry: &Geometry) -> InspectionScene {
    let meshes: Vec<ColouredMesh> =
        objects.iter().map(|(&object, known)| known.open_mesh(geometry, object as usize)).collect();
    let open = |known: &DynamicObject| {
        known.open.iter().map(|o| f64::from(o[0])).sum::<f64>() / known.open.len().max(1) as f64
    };
    let nodes: usize = objects.values().map(|o| o.places.len()).sum();
    let mean = objects.values().map(open).sum::<f64>() / objects.len().max(1) as f64;
    InspectionScene {
        meshes,
        legend: Some(Legend {
            quantity: "open to the surroundings".into(),
            unit: "%".into(),
            range: [0.0, 100.0],
            names: &[],
        }),
        notes: vec![format!(
            "{} movable objects, {nodes} nodes, {:.1} % open in the mean of objects",
            objects.len(),
            100.0 * mean
        )],
        ..InspectionScene::default()
    }
}
