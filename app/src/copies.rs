//! Two copies of one thing, side by side, lit by two volumes at once.

use crate::session::Kept;
use anyhow::{Context as _, Result};
use glam::{Affine3A, Vec3};
use lumenscope_core::{
    irradiance_volume::{IrradianceVolume, dynamic_object::DynamicObject},
    math::part::Part,
    scene::{Scene, geometry::Geometry},
    transport::{LightTransportSolution, guests::Visitor},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// One of the volumes at hand: what lights a copy, or is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum CopyVolume {
    /// The one of the scene's light as it is.
    #[default]
    Present,
    /// One that was kept, by its number; the present one where it was forgotten.
    Kept(usize),
}

/// What lights one copy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CopyLight {
    /// The volume.
    pub volume: CopyVolume,
    /// The part of its light.
    pub part: Part,
}

/// Two copies of an object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Copies {
    /// The object, by its index.
    pub object: usize,
    /// The place midway between the copies, m.
    pub at: Vec3,
    /// Distance between their middles, m, along x.
    pub apart_m: f32,
    /// What lights the left and the right one.
    pub lights: [CopyLight; 2],
}

/// Two copies with the volumes that light them.
#[derive(Clone)]
pub struct CopiesRequest {
    /// The copies.
    pub copies: Copies,
    /// Volumes of the two; `None` is the present one.
    pub volumes: [Option<Arc<IrradianceVolume>>; 2],
}

impl Copies {
    /// Of an object, over the middle of the scene, the left one in all light, the right one in indirect.
    pub fn of(scene: &Scene, object: usize) -> Self {
        let geometry = Geometry::new(scene);
        let (low, high) = geometry.bounds();
        let (a, b) = object_bounds(&geometry, object);
        Self {
            object,
            at: 0.5 * (low + high),
            apart_m: 1.4 * (b - a).max_element().max(1e-3),
            lights: [CopyLight::default(), CopyLight { part: Part::Indirect, ..CopyLight::default() }],
        }
    }

    /// Whether they can be shown in a scene.
    pub fn fits(&self, scene: &Scene) -> bool {
        self.object < scene.objects.len() && self.is_finite()
    }

    /// Whether every number in them can be drawn with.
    pub fn is_finite(&self) -> bool {
        self.at.is_finite() && self.at.abs().max_element() < 1e5 && (0.0..1e4).contains(&self.apart_m)
    }

    /// With the volumes they name.
    pub fn request(&self, kept: &[Kept]) -> CopiesRequest {
        let volume = |light: CopyLight| match light.volume {
            CopyVolume::Present => None,
            CopyVolume::Kept(number) => kept.get(number).map(|k| k.volume.clone()),
        };
        CopiesRequest { copies: *self, volumes: self.lights.map(volume) }
    }
}

impl CopiesRequest {
    /// A solution with the copies in it; `known` are the nodes of those of the same object before.
    ///
    /// # Errors
    /// Where there is no volume yet, or no such object.
    pub fn dress(
        &self,
        bare: &LightTransportSolution,
        known: Option<&Arc<DynamicObject>>,
    ) -> Result<LightTransportSolution> {
        let scene = &bare.scene;
        let object = scene.objects.get(self.copies.object).context("the copied object is gone")?;
        let present = bare.volume.as_ref().context("there is no volume to light the copies")?;
        let (low, high) = object_bounds(&bare.world.geometry, self.copies.object);
        let parts: Vec<_> = object
            .parts
            .iter()
            .map(|p| (scene.meshes[p.mesh].clone(), scene.materials[p.material].clone()))
            .collect();
        let mut visitors = Vec::new();
        for (i, side) in [-0.5f32, 0.5].into_iter().enumerate() {
            let middle = self.copies.at + Vec3::X * (side * self.copies.apart_m);
            visitors.push(Visitor {
                parts: parts.clone(),
                world_from_object: Affine3A::from_translation(middle - 0.5 * (low + high))
                    * object.world_from_object,
                volume: self.volumes[i].as_ref().unwrap_or(present).clone(),
                part: self.copies.lights[i].part,
                known: known.cloned(),
            });
        }
        Ok(bare.with_guests(&visitors))
    }
}

fn object_bounds(geometry: &Geometry, object: usize) -> (Vec3, Vec3) {
    let range = geometry.object_triangles.get(object).cloned().unwrap_or_default();
    let corners = geometry.positions[range.start as usize..range.end as usize].iter().flatten();
    let found = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    if found.0.is_finite() { found } else { (Vec3::ZERO, Vec3::ZERO) }
}
