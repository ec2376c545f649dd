//! What one model file holds, before it joins a scene.

use super::super::{
    Object, Part, Scene,
    camera::Camera,
    lamp::Lamp,
    material::{Material, Texture},
    mesh::Mesh,
};
use glam::{Affine3A, Vec2, Vec3};
use std::{ops::Range, sync::Arc};

/// The content of one model file; indices count within it.
#[derive(Default)]
pub struct Model {
    pub meshes: Vec<Arc<Mesh>>,
    pub materials: Vec<Material>,
    pub textures: Vec<Arc<Texture>>,
    pub objects: Vec<Object>,
    pub lamps: Vec<Lamp>,
    pub camera: Option<Camera>,
    pub notes: Notes,
}

/// Warnings gathered by kind, so that each kind gives one line.
#[derive(Default)]
pub struct Notes(Vec<(String, Vec<String>)>);

impl Notes {
    /// Notes that `what` holds for `owner`.
    pub fn add(&mut self, what: &str, owner: &str) {
        match self.0.iter_mut().find(|(known, _)| known == what) {
            Some((_, owners)) => {
                if !owners.iter().any(|o| o == owner) {
                    owners.push(owner.into());
                }
            }
            None => self.0.push((what.into(), vec![owner.into()])),
        }
    }

    /// One line a kind, in the order first noted.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        self.0.iter().map(|(what, owners)| {
            let more =
                if owners.len() > 1 { format!(" and {} more", owners.len() - 1) } else { String::new() };
            if owners[0].is_empty() { what.clone() } else { format!("{what}: {}{more}", owners[0]) }
        })
    }
}

impl Model {
    /// Joins a scene under a transform; returns the indices of the new objects. `prefix` goes before
    /// every warning. A mirroring transform turns the winding of the meshes it mirrors.
    pub fn append_to(
        self,
        scene: &mut Scene,
        world_from_model: Affine3A,
        movable: bool,
        prefix: &str,
    ) -> Range<usize> {
        let first = scene.objects.len();
        let (mesh, material, texture) = (scene.meshes.len(), scene.materials.len(), scene.textures.len());
        scene.warnings.extend(self.notes.lines().map(|line| format!("{prefix}{line}")));
        scene.meshes.extend(self.meshes);
        scene.textures.extend(self.textures);
        scene.materials.extend(self.materials.into_iter().map(|m| Material {
            reflectance_texture: m.reflectance_texture.map(|i| i + texture),
            emission_texture: m.emission_texture.map(|i| i + texture),
            ..m
        }));
        scene.objects.extend(self.objects.into_iter().map(|o| {
            Object {
                world_from_object: world_from_model * o.world_from_object,
                movable: movable || o.movable,
                parts: o
                    .parts
                    .iter()
                    .map(|p| Part { mesh: p.mesh + mesh, material: p.material + material })
                    .collect(),
                ..o
            }
        }));
        scene.lamps.extend(self.lamps.into_iter().map(|l| Lamp {
            world_from_lamp: lamp_placement(
                world_from_model.transform_point3(l.position()),
                world_from_model.transform_vector3(l.axis()),
            ),
            ..l
        }));
        first..scene.objects.len()
    }
}

/// Placement of a lamp at a position that shines along a direction; straight down without one.
pub fn lamp_placement(position: Vec3, direction: Vec3) -> Affine3A {
    let axis = direction.normalize_or(Vec3::NEG_Y);
    Affine3A::from_rotation_translation(glam::Quat::from_rotation_arc(Vec3::NEG_Z, axis), position)
}

/// A mesh from positions and what else the file has: without normals every triangle gets corners of
/// its own and its flat normal, without texture coordinates they are zero.
pub fn mesh(
    positions: Vec<Vec3>,
    normals: Option<Vec<Vec3>>,
    [uvs, lightmap_uvs]: [Option<Vec<Vec2>>; 2],
    triangles: Vec<[u32; 3]>,
) -> Mesh {
    let uvs = uvs.unwrap_or_else(|| vec![Vec2::ZERO; positions.len()]);
    let lightmap_uvs = lightmap_uvs.unwrap_or_default();
    if let Some(normals) = normals {
        let normals = normals.into_iter().map(|n| n.normalize_or_zero()).collect();
        return Mesh { positions, normals, uvs, lightmap_uvs, triangles };
    }
    let mut flat = Mesh::default();
    for t in triangles {
        let first = flat.positions.len() as u32;
        let corners = t.map(|i| positions[i as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        flat.positions.extend(corners);
        flat.normals.extend([normal; 3]);
        flat.uvs.extend(t.map(|i| uvs[i as usize]));
        flat.lightmap_uvs.extend(t.into_iter().filter_map(|i| lightmap_uvs.get(i as usize)));
        flat.triangles.push([first, first + 1, first + 2]);
    }
    flat
}
