//! How emitters send particles.

use crate::{
    math::{
        frame::{cosine_direction, frame_from_normal, uniform_direction},
        random::Rng,
    },
    scene::{
        accel::Ray,
        emitters::Emitter,
        geometry::{Geometry, offset_origin},
        lamp::LampKind,
        world::World,
    },
};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// An emitter's way of sending particles, the same for all of them.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Flux Φ per channel, lm, if every particle were as bright as the brightest may be; a particle's attenuation
    /// begins below 1 where it is not.
    pub flux: Vec3,
    /// Middle and radius of a sphere around everything, m.
    bounds: (Vec3, f32),
}

impl Emission {
    /// The flux of an emitter, that of parallel light through a disc as wide as a sphere around everything: its
    /// middle and radius, m.
    pub fn new(bounds: (Vec3, f32), emitter: &Emitter) -> Self {
        let radius = bounds.1;
        let flux = match emitter {
            Emitter::Lamp { lamp, .. } => {
                lamp.dimmer
                    * match lamp.kind {
                        LampKind::Point { intensity } => 2.0 * TAU * intensity,
                        LampKind::Spot { intensity, outer_angle, .. } => {
                            TAU * (1.0 - outer_angle.cos()) * intensity
                        }
                        LampKind::Directional { illuminance } => PI * radius * radius * illuminance,
                    }
            }
            Emitter::Area(area) => {
                let sides = if area.double_sided { 2.0 } else { 1.0 };
                sides * PI * area.area() * area.radiance
            }
        };
        Self { flux, bounds }
    }

    /// Draws a particle: the ray it leaves on, and its attenuation per channel, at most 1.
    pub fn send(&self, geometry: &Geometry, emitter: &Emitter, rng: &mut Rng) -> (Ray, Vec3) {
        let (place, u) = (rng.next_vec2(), rng.next_vec2());
        match emitter {
            Emitter::Lamp { lamp, .. } => match lamp.kind {
                LampKind::Point { .. } => (Ray::new(lamp.position(), uniform_direction(u)), Vec3::ONE),
                LampKind::Spot { intensity, outer_angle, .. } => {
                    let cos = 1.0 - u.x * (1.0 - outer_angle.cos());
                    let sin = (1.0 - cos * cos).max(0.0).sqrt();
                    let around = Vec2::from_angle(TAU * u.y) * sin;
                    let direction = frame_from_normal(lamp.axis()) * around.extend(cos);
                    let attenuation = share(lamp.intensity_towards(direction), intensity * lamp.dimmer);
                    (Ray::new(lamp.position(), direction), attenuation)
                }
                LampKind::Directional { .. } => {
                    let (middle, radius) = self.bounds;
                    let disc = Vec2::from_angle(TAU * place.x) * (radius * place.y.sqrt());
                    let from = middle + frame_from_normal(lamp.axis()) * disc.extend(-radius);
                    (Ray::new(from, lamp.axis()), Vec3::ONE)
                }
            },
            Emitter::Area(area) => {
                let point = area.point(geometry, place);
                let behind = area.double_sided && rng.next_f32() < 0.5;
                let normal = if behind { -point.normal } else { point.normal };
                let direction = frame_from_normal(normal) * cosine_direction(u);
                let ray = Ray::new(offset_origin(point.position, normal), direction);
                (ray, share(point.radiance, area.radiance))
            }
        }
    }
}

/// The sphere around everything in a world that parallel light is sent through: middle and radius, m.
pub fn sphere_around(geometry: &Geometry) -> (Vec3, f32) {
    let (low, high) = geometry.bounds();
    (0.5 * (low + high), 0.5 * (high - low).length())
}

/// Where an emitter stands.
pub fn placement(world: &World, emitter: &Emitter) -> Affine3A {
    match emitter {
        Emitter::Lamp { lamp, .. } => lamp.world_from_lamp,
        Emitter::Area(area) => world.geometry.world_from_object[area.object as usize],
    }
}

/// One over the other by channel, 0 where there is nothing.
fn share(part: Vec3, whole: Vec3) -> Vec3 {
    Vec3::select(whole.cmpgt(Vec3::ZERO), part / whole, Vec3::ZERO)
}
