//! Guests: things put in after the solve, each lit from a volume of its own choice.
//!
//! Two copies of one thing side by side, lit by two volumes at once, show what a volume's bins, its grid or
//! its part of the light do (Greger 1996, §5.4). A guest's direct light comes from its volume too, so that
//! the whole difference shows. Limits: guests cast direct shadows like anything that has moved, but they
//! reflect nothing, and light on them carries no shadow that is finer than a cell.

use super::LightTransportSolution;
use crate::{
    irradiance_volume::{IrradianceVolume, dynamic_object::DynamicObject},
    math::part::Part,
    scene::{material::Material, mesh::Mesh, world::World},
};
use glam::Affine3A;
use std::sync::Arc;

/// What is put in, and what lights it.
#[derive(Clone, Debug)]
pub struct Visitor {
    /// Its meshes with their materials, shared.
    pub parts: Vec<(Arc<Mesh>, Material)>,
    /// Where it stands.
    pub world_from_object: Affine3A,
    /// The volume that lights it.
    pub volume: Arc<IrradianceVolume>,
    /// The part of the light it is shown in.
    pub part: Part,
    /// Its nodes and self-occlusion, where they are known from an earlier visit; else they are made.
    pub known: Option<Arc<DynamicObject>>,
}

/// A thing put in after the solve.
#[derive(Clone, Debug)]
pub struct Guest {
    /// Its number in the world's geometry, behind the scene's own objects.
    pub object: u32,
    /// Its meshes.
    pub meshes: Vec<Arc<Mesh>>,
    /// Its nodes, and what it hides from itself.
    pub known: Arc<DynamicObject>,
    /// The volume that lights it.
    pub volume: Arc<IrradianceVolume>,
    /// The part of the light it is shown in.
    pub part: Part,
}

impl LightTransportSolution {
    /// The same light with guests in it, instead of any it had.
    ///
    /// # Panics
    /// If the world has objects that the scene has not: guests of an earlier call are not removed from it.
    pub fn with_guests(&self, visitors: &[Visitor]) -> Self {
        assert!(self.guests.is_empty(), "guests are put into a solution that has none");
        let mut world: World = (*self.world).clone();
        let mut guests = Vec::new();
        for visitor in visitors {
            let object = world.add_object(&visitor.parts, visitor.world_from_object);
            let meshes: Vec<Arc<Mesh>> = visitor.parts.iter().map(|p| p.0.clone()).collect();
            let known = visitor.known.clone().unwrap_or_else(|| {
                let grid = visitor.volume.grid();
                let spacing = 0.5 * grid.cell_size().min_element() / grid.inner() as f32;
                let borrowed: Vec<&Mesh> = meshes.iter().map(|m| &**m).collect();
                let mut known = DynamicObject::of_meshes(&borrowed, &world.geometry, object, Some(spacing));
                known.occlude(&world, object, self.provenance.seed);
                Arc::new(known)
            });
            guests.push(Guest {
                object: object as u32,
                meshes,
                known,
                volume: visitor.volume.clone(),
                part: visitor.part,
            });
        }
        let mirror_images = self.mirror_images.as_ref().map(|images| images.moved(&world));
        Self { world: Arc::new(world), guests: Arc::new(guests), mirror_images, ..self.clone() }
    }
}
