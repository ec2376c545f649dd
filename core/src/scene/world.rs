//! A scene made ready for rays: its triangles, trees and emitters, kept together and moved together.

use super::{
    Scene, Target, accel::Accel, emitters::Emitters, geometry::Geometry, material::Material, mesh::Mesh,
};
use glam::Affine3A;
use std::sync::Arc;

/// Triangles, trees and emitters of one scene.
#[derive(Clone)]
pub struct World {
    /// World-space triangles.
    pub geometry: Geometry,
    /// Trees over them.
    pub accel: Accel,
    /// Everything that emits.
    pub emitters: Emitters,
    /// Whether light passes through any of it.
    pub glass: bool,
}

impl World {
    /// Prepares a scene.
    pub fn new(scene: &Scene) -> Self {
        let geometry = Geometry::new(scene);
        let accel = Accel::new(&geometry);
        let emitters = Emitters::new(scene, &geometry);
        let glass = geometry.has_glass();
        Self { geometry, accel, emitters, glass }
    }

    /// Puts an object behind all others; returns its number. It has a tree of its own, but is not one of
    /// those that may be moved, and does not emit.
    pub fn add_object(&mut self, parts: &[(Arc<Mesh>, Material)], world_from_object: Affine3A) -> usize {
        let object = self.geometry.add_object(parts, world_from_object);
        self.accel.add_object(&self.geometry, object);
        self.glass = self.geometry.has_glass();
        object
    }

    /// Follows placements and dimmers that changed in `scene`; meshes and materials must not have.
    /// Returns what moved or was dimmed.
    ///
    /// # Panics
    /// If an object moved that is not movable, or the number of objects differs.
    pub fn follow(&mut self, scene: &Scene) -> Vec<Target> {
        assert_eq!(scene.objects.len(), self.geometry.object_triangles.len(), "another scene");
        let mut changed = Vec::new();
        for (index, object) in scene.objects.iter().enumerate() {
            let moved = self.geometry.world_from_object[index] != object.world_from_object;
            if moved {
                self.geometry.place(index, object.world_from_object);
                self.accel.place(index, object.world_from_object);
            }
            if moved || self.geometry.dimmer[index] != object.dimmer {
                self.geometry.dimmer[index] = object.dimmer;
                changed.push(Target::Object(index));
            }
        }
        for emitter in &self.emitters.list {
            if let super::emitters::Emitter::Lamp { index, lamp } = emitter
                && scene.lamps[*index] != *lamp
            {
                changed.push(Target::Lamp(*index));
            }
        }
        self.emitters = Emitters::new(scene, &self.geometry);
        changed
    }
}
