//! One point of an emitter as a receiver sees it: what next-event estimation draws.
//!
//! Points are drawn uniformly over an emitter's area.

use super::{
    accel::Ray,
    direct::Receiver,
    emitters::{AreaEmitter, Emitter, Facing},
    world::World,
};
use glam::{Vec2, Vec3};

/// One point of an emitter as seen from a receiver, not yet asked whether anything is between.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Direction towards it.
    pub wi: Vec3,
    /// Its radiance over the density, cd/m² sr; of a lamp, intensity over squared distance and probability, lx.
    pub radiance_over_density: Vec3,
    /// Density per solid angle with which the direction was proposed; `None` for a lamp without a surface.
    pub density: Option<f32>,
    /// Ray that is free if it is seen.
    pub ray: Ray,
}

impl LightSample {
    /// One point of an emitter chosen with `probability`; `None` where it sends nothing to the receiver.
    pub fn new(
        world: &World,
        emitter: &Emitter,
        receiver: &Receiver,
        probability: f32,
        u: Vec2,
    ) -> Option<Self> {
        match emitter {
            Emitter::Area(area) => {
                let seen = AreaPoint::new(world, area, receiver, probability, u)?;
                let radiance_over_density = seen.radiance / seen.density;
                let lit = radiance_over_density != Vec3::ZERO && radiance_over_density.is_finite();
                lit.then_some(Self {
                    wi: seen.wi,
                    radiance_over_density,
                    density: Some(seen.density),
                    ray: seen.ray,
                })
            }
            Emitter::Lamp { lamp, .. } => {
                let (wi, light) = lamp.arriving(receiver.position);
                let light = light / probability;
                (light != Vec3::ZERO && light.is_finite()).then_some(Self {
                    wi,
                    radiance_over_density: light,
                    density: None,
                    ray: lamp.ray_from(receiver.origin()),
                })
            }
        }
    }
}

/// A point of an area emitter that faces a receiver.
pub struct AreaPoint {
    /// Direction towards it.
    pub wi: Vec3,
    /// Its radiance, cd/m².
    pub radiance: Vec3,
    /// Density with which its direction was proposed, per solid angle.
    pub density: f32,
    /// Ray that is free if it is seen.
    pub ray: Ray,
}

impl AreaPoint {
    /// The point for `u` in [0, 1)² of an emitter chosen with `probability`; `None` where it faces away.
    pub fn new(
        world: &World,
        area: &AreaEmitter,
        receiver: &Receiver,
        probability: f32,
        u: Vec2,
    ) -> Option<Self> {
        let point = area.point(&world.geometry, u);
        let Facing { wi, d2, cosine, target } = area.facing(&point, receiver.position)?;
        if receiver.geometric_normal.dot(wi) <= 0.0 {
            return None;
        }
        Some(Self {
            wi,
            radiance: point.radiance,
            density: probability * d2 / (area.area() * cosine),
            ray: Ray::between(receiver.origin(), target),
        })
    }
}
