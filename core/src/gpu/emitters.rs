//! The emitters as flat tables: the Rust sides of the structures in `shaders/shared/direct.wgsl`.

use crate::scene::{
    emitters::{Emitter, Emitters},
    lamp::LampKind,
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// `EmitterInfo` of `shaders/shared/direct.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct EmitterInfo {
    /// Intensity (cd), illuminance (lx) or radiance (cd/m²), dimmer applied.
    pub emission: Vec3,
    /// 0 point, 1 spot, 2 directional, 3 area.
    pub kind: u32,
    /// Position of a lamp, m.
    pub position: Vec3,
    /// Cosine of a spot's full cone.
    pub cos_inner: f32,
    /// Axis a lamp shines along.
    pub axis: Vec3,
    /// Cosine of a spot's dark.
    pub cos_outer: f32,
    /// First entry in the emitter triangles.
    pub first: u32,
    /// Entries.
    pub count: u32,
    /// 1 double-sided, 2 textured.
    pub flags: u32,
    /// Area, m².
    pub area: f32,
}

/// `EmitterTriangle` of `shaders/shared/direct.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct EmitterTriangle {
    /// Triangle.
    pub triangle: u32,
    /// Area up to and including it, m².
    pub cumulative_area: f32,
}

/// The emitters and the triangles of the area emitters.
pub fn emitters(emitters: &Emitters) -> (Vec<EmitterInfo>, Vec<EmitterTriangle>) {
    let mut triangles = Vec::new();
    let infos = emitters
        .list
        .iter()
        .map(|emitter| match emitter {
            Emitter::Lamp { lamp, .. } => {
                let info =
                    EmitterInfo { position: lamp.position(), axis: lamp.axis(), ..EmitterInfo::default() };
                match lamp.kind {
                    LampKind::Point { intensity } => {
                        EmitterInfo { emission: intensity * lamp.dimmer, kind: 0, ..info }
                    }
                    LampKind::Spot { intensity, inner_angle, outer_angle } => EmitterInfo {
                        emission: intensity * lamp.dimmer,
                        kind: 1,
                        cos_inner: inner_angle.cos(),
                        cos_outer: outer_angle.cos(),
                        ..info
                    },
                    LampKind::Directional { illuminance } => {
                        EmitterInfo { emission: illuminance * lamp.dimmer, kind: 2, ..info }
                    }
                }
            }
            Emitter::Area(area) => {
                let first = triangles.len() as u32;
                triangles.extend(
                    area.triangles
                        .iter()
                        .zip(&area.cumulative_area)
                        .map(|(&triangle, &cumulative_area)| EmitterTriangle { triangle, cumulative_area }),
                );
                EmitterInfo {
                    emission: area.radiance,
                    kind: 3,
                    first,
                    count: area.triangles.len() as u32,
                    flags: u32::from(area.double_sided) | (u32::from(area.textured) << 1),
                    area: area.area(),
                    ..EmitterInfo::default()
                }
            }
        })
        .collect();
    (infos, triangles)
}
