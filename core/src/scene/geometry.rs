//! The scene flattened to world-space triangles, numbered once and for all.

use super::{
    Scene,
    accel::Ray,
    brdf::Brdf,
    material::{Material, Texture},
    mesh::Mesh,
};
use glam::{Affine3A, Vec2, Vec3};
use std::{ops::Range, sync::Arc};

/// World-space triangles of every object, in object order: a triangle's number is its name everywhere.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Corner positions, m.
    pub positions: Vec<[Vec3; 3]>,
    /// Corner shading normals.
    pub normals: Vec<[Vec3; 3]>,
    /// Corner texture coordinates.
    pub uvs: Vec<[Vec2; 3]>,
    /// Corners on a lightmap: the second set of texture coordinates, or the first where there is no second.
    pub lightmap_uvs: Vec<[Vec2; 3]>,
    /// Material of each triangle.
    pub material: Vec<u32>,
    /// Object of each triangle.
    pub object: Vec<u32>,
    /// Triangles of each object.
    pub object_triangles: Vec<Range<u32>>,
    /// Which objects may move.
    pub movable: Vec<bool>,
    /// Placement of each object when flattened.
    pub world_from_object: Vec<Affine3A>,
    /// Emission factor of each object.
    pub dimmer: Vec<f32>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Vec<Arc<Texture>>,
}

/// A point on a surface, seen from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Position, m.
    pub position: Vec3,
    /// Geometric normal, on the side seen.
    pub geometric_normal: Vec3,
    /// Interpolated normal, on the side seen.
    pub normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec2,
    /// Triangle.
    pub triangle: u32,
    /// Whether the back is seen.
    pub back: bool,
}

impl Surface {
    /// The ray by which an ideal mirror here passes on one along `direction`, d − 2 (d·n) n: about the shading
    /// normal, or about the plane's where that would go through it.
    pub fn mirrored(&self, direction: Vec3) -> Ray {
        let about = |n: Vec3| direction - 2.0 * direction.dot(n) * n;
        let shaded = about(self.normal);
        let above = shaded.dot(self.geometric_normal) > 0.0;
        let along = if above { shaded } else { about(self.geometric_normal) };
        Ray::new(offset_origin(self.position, self.geometric_normal), along)
    }
}

impl Geometry {
    /// Middle and radius of a sphere around some triangles, m: about the middle of their box.
    pub fn sphere_around(&self, triangles: &[u32]) -> (Vec3, f32) {
        let corners = || triangles.iter().flat_map(|&t| self.positions[t as usize]);
        let (low, high) =
            corners().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
        let middle = 0.5 * (low + high);
        (middle, corners().map(|p| p.distance(middle)).fold(0.0, f32::max))
    }

    /// Flattens a scene.
    pub fn new(scene: &Scene) -> Self {
        let mut geometry =
            Self { materials: scene.materials.clone(), textures: scene.textures.clone(), ..Self::default() };
        for (index, object) in scene.objects.iter().enumerate() {
            let first = geometry.positions.len() as u32;
            for part in &object.parts {
                let placed = (index as u32, object.world_from_object);
                geometry.add_part(&scene.meshes[part.mesh], part.material as u32, placed);
            }
            geometry.object_triangles.push(first..geometry.positions.len() as u32);
            geometry.movable.push(object.movable);
            geometry.dimmer.push(object.dimmer);
            geometry.world_from_object.push(object.world_from_object);
        }
        geometry
    }

    /// Puts an object that may not be moved behind all others; returns its number.
    pub fn add_object(&mut self, parts: &[(Arc<Mesh>, Material)], world_from_object: Affine3A) -> usize {
        let object = self.object_triangles.len();
        let first = self.positions.len() as u32;
        for (mesh, material) in parts {
            self.materials.push(material.clone());
            self.add_part(mesh, self.materials.len() as u32 - 1, (object as u32, world_from_object));
        }
        self.object_triangles.push(first..self.positions.len() as u32);
        self.movable.push(false);
        self.dimmer.push(1.0);
        self.world_from_object.push(world_from_object);
        object
    }

    fn add_part(&mut self, mesh: &Mesh, material: u32, (object, world_from_object): (u32, Affine3A)) {
        for t in &mesh.triangles {
            let corner = t.map(|i| i as usize);
            self.uvs.push(corner.map(|i| mesh.uvs[i]));
            self.lightmap_uvs.push(corner.map(|i| *mesh.lightmap_uvs.get(i).unwrap_or(&mesh.uvs[i])));
            self.material.push(material);
            self.object.push(object);
            self.positions.push(corner.map(|i| world_from_object.transform_point3(mesh.positions[i])));
            self.normals.push(corner.map(|i| world_normal(&world_from_object, mesh.normals[i])));
        }
    }

    /// Puts one object somewhere else; its triangles keep their numbers.
    pub fn place(&mut self, object: usize, world_from_object: Affine3A) {
        let change = world_from_object * self.world_from_object[object].inverse();
        self.world_from_object[object] = world_from_object;
        for t in self.object_triangles[object].clone() {
            let t = t as usize;
            self.positions[t] = self.positions[t].map(|p| change.transform_point3(p));
            self.normals[t] = self.normals[t].map(|n| world_normal(&change, n));
        }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Smallest and largest corner, m; a unit box when there is nothing.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let mut corners = self.positions.iter().flatten();
        match corners.next() {
            None => (Vec3::splat(-0.5), Vec3::splat(0.5)),
            Some(&p) => corners.fold((p, p), |(low, high), &q| (low.min(q), high.max(q))),
        }
    }

    /// Twice the area-weighted front normal of a triangle.
    pub fn area_normal(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.positions[triangle as usize];
        (b - a).cross(c - a)
    }

    /// Material of a triangle.
    pub fn material_of(&self, triangle: u32) -> &Material {
        &self.materials[self.material[triangle as usize] as usize]
    }

    /// Object and material of a triangle: what makes an area emitter.
    pub fn emitter_of(&self, triangle: u32) -> (u32, u32) {
        (self.object[triangle as usize], self.material[triangle as usize])
    }

    /// The surface at barycentric weights of a triangle, as seen by a ray travelling along `direction`.
    pub fn surface(&self, triangle: u32, barycentric: Vec2, direction: Vec3) -> Surface {
        let t = triangle as usize;
        let [a, b, c] = self.positions[t];
        let [na, nb, nc] = self.normals[t];
        let [ta, tb, tc] = self.uvs[t];
        let (u, v) = (barycentric.x, barycentric.y);
        let w = 1.0 - u - v;
        let front = self.area_normal(triangle).normalize_or(Vec3::Y);
        let back = front.dot(direction) > 0.0;
        let side = if back { -1.0 } else { 1.0 };
        let shading = (na * w + nb * u + nc * v).normalize_or(front);
        Surface {
            position: a * w + b * u + c * v,
            geometric_normal: front * side,
            normal: shading * side,
            uv: ta * w + tb * u + tc * v,
            barycentric,
            triangle,
            back,
        }
    }

    /// Whether this side of the surface reflects and emits.
    pub fn is_lit(&self, surface: &Surface) -> bool {
        !surface.back || self.material_of(surface.triangle).double_sided
    }

    /// Diffuse reflectance of the side seen; zero on the back of a single-sided surface.
    pub fn reflectance(&self, surface: &Surface) -> Vec3 {
        if !self.is_lit(surface) {
            return Vec3::ZERO;
        }
        self.material_of(surface.triangle).diffuse_at(surface.uv, &self.textures)
    }

    /// What the side seen does to light; black on the back of a single-sided surface.
    pub fn brdf(&self, surface: &Surface) -> Brdf {
        if !self.is_lit(surface) {
            return Brdf::default();
        }
        let front = self.material_of(surface.triangle).brdf_at(surface.uv, &self.textures);
        if surface.back { front.met_from_inside() } else { front }
    }

    /// Whether light passes through any triangle.
    pub fn has_glass(&self) -> bool {
        self.materials.iter().any(Material::is_glass)
            && self.material.iter().any(|&m| self.materials[m as usize].is_glass())
    }

    /// Whether any triangle has a specular lobe.
    pub fn is_specular(&self) -> bool {
        let mut specular = self.materials.iter().map(Material::is_specular);
        specular.any(|s| s) && self.material.iter().any(|&m| self.materials[m as usize].is_specular())
    }

    /// Radiance emitted from the side seen, cd/m², the object's dimmer applied.
    pub fn emission(&self, surface: &Surface) -> Vec3 {
        let material = self.material_of(surface.triangle);
        if material.emission == Vec3::ZERO || !self.is_lit(surface) {
            return Vec3::ZERO;
        }
        let dimmer = self.dimmer[self.object[surface.triangle as usize] as usize];
        material.emission_at(surface.uv, &self.textures) * dimmer
    }
}

fn world_normal(transform: &Affine3A, normal: Vec3) -> Vec3 {
    let cofactor = transform.matrix3.inverse().transpose();
    (cofactor * normal).normalize_or(Vec3::Y)
}

/// Ray origin moved off a surface along its geometric normal by a few units in the last place, so
/// that a ray leaving it does not hit it again, at any scene scale.
///
/// Wächter and Binder, *A Fast and Robust Method for Avoiding Self-Intersection*, Ray Tracing Gems 2019.
pub fn offset_origin(position: Vec3, normal: Vec3) -> Vec3 {
    const ORIGIN: f32 = 1.0 / 32.0;
    const FLOAT_SCALE: f32 = 1.0 / 65_536.0;
    const INT_SCALE: f32 = 256.0;
    let axis = |p: f32, n: f32| {
        if p.abs() < ORIGIN {
            return p + FLOAT_SCALE * n;
        }
        let step = (INT_SCALE * n) as i32;
        f32::from_bits((p.to_bits() as i32).wrapping_add(if p < 0.0 { -step } else { step }) as u32)
    };
    Vec3::new(axis(position.x, normal.x), axis(position.y, normal.y), axis(position.z, normal.z))
}
