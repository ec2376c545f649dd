//! What is lit: meshes, materials, objects, lamps, camera; and the rays that ask where light goes.
//!
//! [`Scene`] is plain data in metres, y up, right-handed. [`Geometry`](geometry::Geometry) flattens
//! it to world-space triangles, [`Accel`](accel::Accel) answers rays, [`Emitters`](emitters::Emitters)
//! lists everything that emits, and [`direct`] gives the light that comes from them without a bounce.

pub mod accel;
pub mod brdf;
pub mod camera;
pub mod check;
pub mod direct;
pub mod emitters;
pub mod file;
pub mod fresnel;
pub mod geometry;
pub mod glass;
pub mod glossy;
pub mod import;
pub mod lamp;
pub mod light_sample;
pub mod lookup;
pub mod material;
pub mod mesh;
pub mod mirrors;
pub mod volume;
mod watertight;
pub mod world;

use camera::Camera;
use glam::{Affine3A, Vec3};
use lamp::Lamp;
use material::{Material, Texture};
use mesh::Mesh;
use std::sync::Arc;

/// A scene: everything a solver may ask about, in world units of one metre.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Name shown in titles: the file's stem.
    pub name: String,
    /// Meshes, shared between objects.
    pub meshes: Vec<Arc<Mesh>>,
    /// Materials; every [`Part`] names one.
    pub materials: Vec<Material>,
    /// Textures named by materials.
    pub textures: Vec<Arc<Texture>>,
    /// Placed objects.
    pub objects: Vec<Object>,
    /// Lamps without a surface. Emissive surfaces are lamps too: see [`emitters::Emitters`].
    pub lamps: Vec<Lamp>,
    /// First view.
    pub camera: Camera,
    /// Planes on which illuminance is wanted.
    pub planes: Vec<MeasuringPlane>,
    /// What the file leaves out or gets overridden in the rendering plan.
    pub plan: file::PlanOverrides,
    /// What was found odd or unsupported while loading, one line each.
    pub warnings: Vec<String>,
}

/// One thing that can be picked and, if movable, dragged.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name from the file.
    pub name: String,
    /// Meshes with their materials.
    pub parts: Vec<Part>,
    /// Placement.
    pub world_from_object: Affine3A,
    /// Whether the user may drag it.
    pub movable: bool,
    /// Factor on the emission of its parts: 1 as the file says, 0 switched off.
    pub dimmer: f32,
}

/// A mesh of an object and what it is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Index into [`Scene::materials`].
    pub material: usize,
}

/// A rectangle on which illuminance is measured.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MeasuringPlane {
    /// Name shown.
    pub name: String,
    /// Corner, m.
    pub corner: Vec3,
    /// First edge, m.
    pub edge_u: Vec3,
    /// Second edge, m; the measured side is `edge_u × edge_v`.
    pub edge_v: Vec3,
}

/// What a command can act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum Target {
    /// Index into [`Scene::objects`].
    Object(usize),
    /// Index into [`Scene::lamps`].
    Lamp(usize),
}

impl Scene {
    /// Number of triangles over all objects.
    pub fn triangle_count(&self) -> usize {
        self.objects.iter().flat_map(|o| &o.parts).map(|p| self.meshes[p.mesh].triangles.len()).sum()
    }

    /// Whether a target emits light: any lamp, and any object with an emissive part.
    pub fn emits(&self, target: Target) -> bool {
        match target {
            Target::Lamp(_) => true,
            Target::Object(i) => {
                self.objects[i].parts.iter().any(|p| self.materials[p.material].emission != Vec3::ZERO)
            }
        }
    }

    /// Placement of a target.
    pub fn placement(&self, target: Target) -> Affine3A {
        match target {
            Target::Object(i) => self.objects[i].world_from_object,
            Target::Lamp(i) => self.lamps[i].world_from_lamp,
        }
    }

    /// Puts a target somewhere else.
    pub fn place(&mut self, target: Target, placement: Affine3A) {
        match target {
            Target::Object(i) => self.objects[i].world_from_object = placement,
            Target::Lamp(i) => self.lamps[i].world_from_lamp = placement,
        }
    }

    /// Name of a target.
    pub fn target_name(&self, target: Target) -> &str {
        match target {
            Target::Object(i) => &self.objects[i].name,
            Target::Lamp(i) => &self.lamps[i].name,
        }
    }
}
