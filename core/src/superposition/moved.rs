//! Light on objects that were moved since the transport was solved: from the irradiance volume, at the
//! nodes of their triangles, interpolated between them.
//!
//! A table of nodes and not a query a pixel: the GPU interpolates in it and needs no volume, and both
//! renderers show the same. The nodes and levels of detail are
//! [`dynamic_object`](crate::irradiance_volume::dynamic_object)'s.

use crate::{
    irradiance_volume::{
        IrradianceVolume,
        dynamic_object::{Detail, DynamicObject, lattice_blend, lattice_len},
    },
    math::part::Part,
    transport::LightTransportSolution,
};
use glam::{Vec2, Vec3};
use std::collections::{BTreeSet, HashMap};

/// Irradiance on the moved objects' triangles, lx per channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovedLight {
    /// Record of each moved object's first triangle in `lattices`.
    pub first: HashMap<u32, u32>,
    /// For each triangle: the first entry of its lattice, and its steps an edge.
    pub lattices: Vec<(u32, u32)>,
    /// For each entry of a lattice: the front, then the back; of each direct, then indirect light.
    pub entries: Vec<[[Vec3; 2]; 2]>,
    /// Objects whose direct light is always that of the entries, never evaluated at a pixel.
    pub stored_direct: BTreeSet<u32>,
    /// Queries made, all sides; one finds both parts of the light.
    pub queries: usize,
}

impl MovedLight {
    /// Queries the volume as finely as the solution says; `direct` says whether the direct part is wanted
    /// too. Without a volume all is black. Where movable objects shine, all of them are here, moved or not, and
    /// their direct light too is the volume's.
    pub fn new(solution: &LightTransportSolution, direct: bool) -> Self {
        let mut light = Self::default();
        let volume = solution.volume.as_deref();
        let movable = &solution.world.geometry.movable;
        let guest = |object| solution.guests.iter().any(|g| g.object == object);
        let shining = (0..movable.len() as u32).filter(|&o| movable[o as usize] && !guest(o)).collect();
        let objects: Vec<u32> =
            if solution.gloss.is_some() { shining } else { solution.moved_objects.clone() };
        let direct = direct || solution.gloss.is_some();
        for object in objects {
            if solution.gloss.is_some() {
                light.stored_direct.insert(object);
            }
            light.first.insert(object, light.lattices.len() as u32);
            match solution.dynamic_objects.get(&object) {
                Some(known) => light.add(solution, object as usize, known, volume, [direct, true]),
                None => {
                    let (scene, geometry) = (&solution.scene, &solution.world.geometry);
                    let plain = DynamicObject::new(scene, geometry, object as usize, None);
                    light.add(solution, object as usize, &plain, volume, [direct, true]);
                }
            }
        }
        for guest in solution.guests.iter() {
            light.first.insert(guest.object, light.lattices.len() as u32);
            light.stored_direct.insert(guest.object);
            let parts = [guest.part != Part::Indirect, guest.part != Part::Direct];
            light.add(solution, guest.object as usize, &guest.known, Some(&guest.volume), parts);
        }
        light
    }

    fn add(
        &mut self,
        solution: &LightTransportSolution,
        object: usize,
        known: &DynamicObject,
        volume: Option<&IrradianceVolume>,
        [direct, indirect]: [bool; 2],
    ) {
        let geometry = &solution.world.geometry;
        let triangles = geometry.object_triangles[object].clone();
        let two_sided = triangles.clone().any(|t| geometry.material_of(t).double_sided);
        let sides = [(1.0, true), (-1.0, two_sided)].map(|(side, lit)| {
            let wanted = [lit && direct, lit && indirect];
            let Some(volume) = volume.filter(|_| wanted != [false; 2]) else {
                return vec![[Vec3::ZERO; 2]; known.places.len()];
            };
            let detail = solution.detail;
            self.queries += known.queries(detail);
            // A volume of its own that a guest is lit by may hold other orders: it is matt then.
            match solution.gloss.as_ref().filter(|g| volume.orders().contains(&g.order)) {
                Some(gloss) => known.moments(volume, geometry, object, wanted, side, detail, gloss),
                None => known.irradiance(volume, geometry, object, wanted, side, detail),
            }
        });
        for (triangle, &(first, steps)) in triangles.zip(&known.lattices) {
            let back_lit = geometry.material_of(triangle).double_sided;
            self.lattices.push((self.entries.len() as u32, steps));
            let nodes = &known.nodes[first as usize..][..lattice_len(steps) as usize];
            self.entries.extend(nodes.iter().map(|&node| {
                let of = |side: usize| sides[side][node as usize];
                [of(0), if back_lit { of(1) } else { [Vec3::ZERO; 2] }]
            }));
        }
    }

    /// Irradiance on a moved object's triangle, lx per channel; `None` where the object did not move.
    pub fn irradiance(
        &self,
        solution: &LightTransportSolution,
        triangle: u32,
        barycentric: Vec2,
        back: bool,
        part: Part,
    ) -> Option<Vec3> {
        if self.first.is_empty() {
            return None;
        }
        let geometry = &solution.world.geometry;
        let object = geometry.object[triangle as usize];
        if solution.detail == Detail::Pixels && self.first.contains_key(&object) {
            return Some(at_pixel(solution, triangle, barycentric, back, part));
        }
        let record = *self.first.get(&object)? + triangle - geometry.object_triangles[object as usize].start;
        let (first, steps) = self.lattices[record as usize];
        let (entries, weights) = lattice_blend(steps, barycentric);
        let of = |part: usize| {
            (0..3).fold(Vec3::ZERO, |sum, i| {
                sum + self.entries[(first + entries[i]) as usize][usize::from(back)][part] * weights[i]
            })
        };
        Some(match part {
            Part::Direct => of(0),
            Part::Indirect => of(1),
            Part::All => of(0) + of(1),
        })
    }
}

/// Irradiance on a moved object from the volume at the very point, lx per channel; the indirect part is
/// weakened by what the object hides from itself.
fn at_pixel(
    solution: &LightTransportSolution,
    triangle: u32,
    barycentric: Vec2,
    back: bool,
    part: Part,
) -> Vec3 {
    let geometry = &solution.world.geometry;
    let object = geometry.object[triangle as usize];
    let guest = solution.guests.iter().find(|g| g.object == object);
    let Some(volume) = guest.map_or(solution.volume.as_deref(), |g| Some(&*g.volume)) else {
        return Vec3::ZERO;
    };
    let mix = |[a, b, c]: [Vec3; 3]| {
        a * (1.0 - barycentric.x - barycentric.y) + b * barycentric.x + c * barycentric.y
    };
    let position = mix(geometry.positions[triangle as usize]);
    let normal =
        mix(geometry.normals[triangle as usize]).normalize_or(Vec3::Y) * if back { -1.0 } else { 1.0 };
    let known = guest.map_or(solution.dynamic_objects.get(&object), |g| Some(&*g.known));
    let local = triangle - geometry.object_triangles[object as usize].start;
    let gloss = solution.gloss.as_ref().filter(|g| volume.orders().contains(&g.order));
    let of = |one: Part| {
        if part.holds(one) && guest.is_none_or(|g| g.part.holds(one)) {
            match gloss {
                Some(g) => {
                    volume.moment(position, g.towards(position, normal), g.order, one).unwrap_or_default()
                }
                None if one == Part::Direct => volume.irradiance(position, normal, one),
                None => {
                    let open = known.map_or(1.0, |k| k.open_at(local, barycentric, back));
                    volume.irradiance(position, normal, one) * open
                }
            }
        } else {
            Vec3::ZERO
        }
    };
    of(Part::Direct) + of(Part::Indirect)
}
