//! Everything that emits: lamps without a surface, and the emissive surfaces grouped into area emitters.

use super::{
    Scene, Target,
    geometry::{Geometry, offset_origin},
    lamp::{Lamp, LampKind},
};
use crate::math::colour::luminance;
use glam::{Vec2, Vec3};

/// All emitters of a scene, lamps first, then area emitters in object order.
#[derive(Clone, Debug, Default)]
pub struct Emitters {
    /// The emitters.
    pub list: Vec<Emitter>,
}

/// One emitter.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// A lamp without a surface.
    Lamp {
        /// Its index in the scene.
        index: usize,
        /// Its values.
        lamp: Lamp,
    },
    /// The emissive triangles of one material on one object.
    Area(AreaEmitter),
}

/// Emissive triangles of one material on one object.
#[derive(Clone, Debug)]
pub struct AreaEmitter {
    /// Object they belong to.
    pub object: u32,
    /// Triangle numbers in [`Geometry`].
    pub triangles: Vec<u32>,
    /// Area up to and including each triangle, m².
    pub cumulative_area: Vec<f32>,
    /// Centre of a sphere around them, m, and its radius, m.
    pub bounds: (Vec3, f32),
    /// Whether they emit from the back too.
    pub double_sided: bool,
    /// Whether a texture varies the radiance.
    pub textured: bool,
    /// Radiance before any texture, cd/m², dimmer applied.
    pub radiance: Vec3,
}

/// A point on an area emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmitterPoint {
    /// Position, m.
    pub position: Vec3,
    /// Front normal.
    pub normal: Vec3,
    /// Emitted radiance, cd/m².
    pub radiance: Vec3,
    /// Triangle.
    pub triangle: u32,
}

impl Emitters {
    /// Lists the emitters of a scene; switched-off ones are kept, with no light.
    pub fn new(scene: &Scene, geometry: &Geometry) -> Self {
        let mut list: Vec<Emitter> = scene
            .lamps
            .iter()
            .enumerate()
            .map(|(index, lamp)| Emitter::Lamp { index, lamp: lamp.clone() })
            .collect();
        for (object, range) in geometry.object_triangles.iter().enumerate() {
            let mut materials: Vec<u32> = range.clone().map(|t| geometry.material[t as usize]).collect();
            materials.dedup();
            materials.sort_unstable();
            materials.dedup();
            for index in materials {
                let material = &geometry.materials[index as usize];
                if material.emission == Vec3::ZERO {
                    continue;
                }
                let triangles: Vec<u32> = range
                    .clone()
                    .filter(|&t| {
                        geometry.material[t as usize] == index && geometry.area_normal(t).length() > 0.0
                    })
                    .collect();
                let mut total = 0.0f64;
                let cumulative_area = triangles
                    .iter()
                    .map(|&t| {
                        total += 0.5 * f64::from(geometry.area_normal(t).length());
                        total as f32
                    })
                    .collect();
                if triangles.is_empty() {
                    continue;
                }
                let bounds = geometry.sphere_around(&triangles);
                list.push(Emitter::Area(AreaEmitter {
                    object: object as u32,
                    triangles,
                    cumulative_area,
                    bounds,
                    double_sided: material.double_sided,
                    textured: material.emission_texture.is_some(),
                    radiance: material.emission * geometry.dimmer[object],
                }));
            }
        }
        Self { list }
    }

    /// Number of emitters.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether nothing emits.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

impl Emitter {
    /// What the user would drag to move it.
    pub fn target(&self) -> Target {
        match self {
            Self::Lamp { index, .. } => Target::Lamp(*index),
            Self::Area(area) => Target::Object(area.object as usize),
        }
    }

    /// Luminous flux, lm; for a directional lamp its illuminance times 1 m².
    pub fn flux(&self) -> f32 {
        use std::f32::consts::{PI, TAU};
        match self {
            Self::Lamp { lamp, .. } => match lamp.kind {
                LampKind::Point { intensity } => 4.0 * PI * luminance(intensity) * lamp.dimmer,
                LampKind::Spot { intensity, inner_angle, outer_angle } => {
                    // ∫ t² d(cos θ), t rising linearly in cos θ from the outer angle to the inner one.
                    let mean = 1.0 - (2.0 * inner_angle.cos() + outer_angle.cos()) / 3.0;
                    TAU * mean * luminance(intensity) * lamp.dimmer
                }
                LampKind::Directional { illuminance } => luminance(illuminance) * lamp.dimmer,
            },
            Self::Area(area) => {
                PI * luminance(area.radiance) * area.area() * if area.double_sided { 2.0 } else { 1.0 }
            }
        }
    }
}

/// A point of an area emitter as it is seen from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    /// Unit direction towards it.
    pub wi: Vec3,
    /// Squared distance, m².
    pub d2: f32,
    /// Cosine of the angle that its light leaves it at.
    pub cosine: f32,
    /// The point, off the emitter's surface, m.
    pub target: Vec3,
}

impl AreaEmitter {
    /// How one of its points is seen from a place; `None` where it faces away.
    pub fn facing(&self, point: &EmitterPoint, from: Vec3) -> Option<Facing> {
        let to_light = point.position - from;
        let d2 = to_light.length_squared();
        let wi = to_light / d2.sqrt();
        let facing = -point.normal.dot(wi);
        let cosine = if self.double_sided { facing.abs() } else { facing };
        let target = offset_origin(point.position, point.normal * facing.signum());
        (d2 > 0.0 && wi.is_finite() && cosine > 0.0).then_some(Facing { wi, d2, cosine, target })
    }

    /// Total area, m².
    pub fn area(&self) -> f32 {
        self.cumulative_area.last().copied().unwrap_or(0.0)
    }

    /// Point uniform over the area, density 1 / area, from `u` in [0, 1)².
    pub fn point(&self, geometry: &Geometry, u: Vec2) -> EmitterPoint {
        let wanted = u.x * self.area();
        let i = self.cumulative_area.partition_point(|&a| a <= wanted).min(self.triangles.len() - 1);
        let before = if i == 0 { 0.0 } else { self.cumulative_area[i - 1] };
        let x = ((wanted - before) / (self.cumulative_area[i] - before)).clamp(0.0, 1.0);
        let root = x.sqrt();
        let barycentric = Vec2::new(root * (1.0 - u.y), root * u.y);
        let triangle = self.triangles[i];
        let t = triangle as usize;
        let [a, b, c] = geometry.positions[t];
        let weight = 1.0 - barycentric.x - barycentric.y;
        let radiance = if self.textured {
            let [ta, tb, tc] = geometry.uvs[t];
            let uv = ta * weight + tb * barycentric.x + tc * barycentric.y;
            geometry.material_of(triangle).emission_at(uv, &geometry.textures)
                * geometry.dimmer[self.object as usize]
        } else {
            self.radiance
        };
        EmitterPoint {
            position: a * weight + b * barycentric.x + c * barycentric.y,
            normal: geometry.area_normal(triangle).normalize_or(Vec3::Y),
            radiance,
            triangle,
        }
    }
}
