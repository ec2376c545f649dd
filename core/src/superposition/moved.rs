//! Light on objects that were moved since the transport was solved: from the irradiance volume, at
//! each corner, interpolated over the triangles.
//!
//! As in Greger et al., *The Irradiance Volume*, 1998: a query a vertex, not a query a pixel, so that
//! the GPU interpolates and needs no volume. Its limit: a large triangle shows no detail inside.

use crate::{math::part::Part, transport::LightTransportSolution};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Irradiance at the corners of the moved objects' triangles, lx per channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovedLight {
    /// First entry of each moved object in `corners`, by object: entry of its first triangle.
    pub first: HashMap<u32, u32>,
    /// For each triangle: direct, then indirect light; of each the front, then the back side.
    pub corners: Vec<[[[Vec3; 3]; 2]; 2]>,
}

impl MovedLight {
    /// Queries the volume; `direct` says whether the direct part is wanted too. Without a volume all is black.
    pub fn new(solution: &LightTransportSolution, direct: bool) -> Self {
        use rayon::prelude::*;
        let geometry = &solution.world.geometry;
        let mut light = Self::default();
        for &object in &solution.moved_objects {
            light.first.insert(object, light.corners.len() as u32);
            let range = geometry.object_triangles[object as usize].clone();
            light.corners.par_extend(range.into_par_iter().map(|t| {
                let sides = |part: Part| {
                    let lit = |side: f32| -> [Vec3; 3] {
                        std::array::from_fn(|i| {
                            let position = geometry.positions[t as usize][i];
                            let normal = geometry.normals[t as usize][i] * side;
                            solution
                                .volume
                                .as_ref()
                                .map_or(Vec3::ZERO, |v| v.irradiance(position, normal, part))
                        })
                    };
                    [lit(1.0), if geometry.material_of(t).double_sided { lit(-1.0) } else { [Vec3::ZERO; 3] }]
                };
                [if direct { sides(Part::Direct) } else { [[Vec3::ZERO; 3]; 2] }, sides(Part::Indirect)]
            }));
        }
        light
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
        let first = *self.first.get(&object)?;
        let entry = first + triangle - geometry.object_triangles[object as usize].start;
        let of = |part: usize| {
            let [a, b, c] = self.corners[entry as usize][part][usize::from(back)];
            a * (1.0 - barycentric.x - barycentric.y) + b * barycentric.x + c * barycentric.y
        };
        Some(match part {
            Part::Direct => of(0),
            Part::Indirect => of(1),
            Part::All => of(0) + of(1),
        })
    }
}
