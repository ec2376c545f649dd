//! Whether a picture may show something polished that has no mirrored view: bent surfaces, and reflectors beyond the
//! views there may be. Where it does not, and no view is needed, nothing of mirrors is recorded.

use super::{
    culling::Portal,
    reflectors::{NO_REFLECTOR, Reflectors},
    views::MirroredView,
};
use crate::scene::geometry::Geometry;
use glam::Vec3;

/// Triangles of a box, at most.
const MOST: usize = 128;

/// Boxes around polished triangles that are part of no flat reflector, m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bent(Vec<[Vec3; 2]>);

impl Bent {
    /// Those of a scene.
    pub fn new(geometry: &Geometry, reflectors: &Reflectors) -> Self {
        let of_object = |range: &std::ops::Range<u32>| {
            let bent = |t: &u32| geometry.material_of(*t).is_specular() && reflectors.of(*t) == NO_REFLECTOR;
            let triangles: Vec<u32> = range.clone().filter(bent).collect();
            let around = |some: &[u32]| {
                let corners = some.iter().flat_map(|&t| geometry.positions[t as usize]);
                let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
                corners.fold(empty, |[low, high], p| [low.min(p), high.max(p)])
            };
            triangles.chunks(MOST).map(around).collect::<Vec<_>>()
        };
        if !geometry.is_specular() {
            return Self::default();
        }
        Self(geometry.object_triangles.iter().flat_map(of_object).collect())
    }
}

/// Whether a picture may show a polished surface that none of its views stands for; `portal` is the picture's.
pub fn without_view(
    (geometry, reflectors, bent): (&Geometry, &Reflectors, &Bent),
    views: &[MirroredView],
    (eye, portal): (Vec3, &Portal),
) -> bool {
    let has_view = |number: usize| views.iter().any(|v| v.parent == 0 && v.reflector as usize == number);
    let shows = |&t: &u32| !portal.cut(geometry.positions[t as usize].to_vec()).is_empty();
    let is_glass = |material: u32| geometry.materials[material as usize].is_glass();
    bent.0.iter().any(|&[low, high]| portal.touches(low, high))
        || reflectors.list.iter().enumerate().any(|(number, reflector)| {
            // Glass lets light through from behind, too.
            let faces = reflector.facing(eye).is_some() || is_glass(reflector.material);
            faces && !has_view(number) && reflector.triangles.iter().any(shows)
        })
}
