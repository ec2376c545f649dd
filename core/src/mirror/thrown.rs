//! Emitters seen by dull surfaces in a flat mirror, L S D: what a mirror throws of a lamp.
//!
//! The irradiance is that of the emitter's image, seen through the mirror as through a window and dimmed by
//! its reflectance, E = ∫ F(θₘ) L cos θ dω. The receiver is mirrored here and not the emitter, so that the
//! closed forms of [`crate::scene::direct`] serve as they are. Rays that chance upon an emitter in a mirror
//! would find the same, but a lamp is small: of 256 rays few meet one.
//!
//! Limit: one flat mirror. Longer ways, and those by a curved one, to a luminous surface are found by chance, to a
//! lamp without a surface not.

use super::reflectors::{NO_REFLECTOR, Reflector, Reflectors};
use crate::scene::{
    accel::Ray,
    direct::{self, Receiver},
    emitters::Emitter,
    geometry::{Geometry, offset_origin},
    lamp::{Lamp, LampKind},
    world::World,
};
use glam::Vec3;

/// The flat ideal mirrors of a scene.
#[derive(Clone, Debug, Default)]
pub struct Images {
    reflectors: Reflectors,
    mirrors: Vec<Mirror>,
}

#[derive(Clone, Debug)]
struct Mirror {
    number: u32,
    /// Middle and radius of a sphere around it, m.
    bounds: (Vec3, f32),
}

/// The end of a way through a mirror.
#[derive(Clone, Copy)]
enum Target {
    Point(Vec3),
    Direction(Vec3),
}

impl Target {
    fn of(lamp: &Lamp) -> Self {
        match lamp.kind {
            LampKind::Directional { .. } => Self::Direction(-lamp.axis()),
            _ => Self::Point(lamp.position()),
        }
    }
}

impl Images {
    /// Finds the mirrors; costs nothing where no material is polished.
    pub fn new(geometry: &Geometry) -> Self {
        let reflectors = Reflectors::new(geometry);
        let ideal = |r: &Reflector| geometry.material_of(r.triangles[0]).alpha() == Some(0.0);
        let mirrors = (0u32..)
            .zip(&reflectors.list)
            .filter(|(_, r)| ideal(r))
            .map(|(number, r)| Mirror { number, bounds: geometry.sphere_around(&r.triangles) })
            .collect();
        Self { reflectors, mirrors }
    }

    /// Whether what a triangle reflects of an emitter, straight to a dull surface, is found here.
    pub fn covers(&self, triangle: u32) -> bool {
        let number = self.reflectors.of(triangle);
        number != NO_REFLECTOR && self.mirrors.iter().any(|m| m.number == number)
    }

    /// Mean irradiance of receivers from one emitter by way of the mirrors, lx per channel; `samples` rays a
    /// mirror and receiver, each receiver with a scramble of its own.
    pub fn mean_irradiance(
        &self,
        world: &World,
        emitter: &Emitter,
        receivers: &[(&Receiver, u32)],
        samples: u32,
    ) -> Vec3 {
        let sum: Vec3 =
            self.mirrors.iter().map(|m| self.by_way_of(m, world, emitter, receivers, samples)).sum();
        sum / receivers.len().max(1) as f32
    }

    /// Light of a lamp without a surface at a receiver by way of each mirror: the direction that it comes from, and
    /// its illuminance across that, lx per channel.
    pub fn of_lamp<'a>(
        &'a self,
        world: &'a World,
        lamp: &'a Lamp,
        receiver: &'a Receiver,
    ) -> impl Iterator<Item = (Vec3, Vec3)> + 'a {
        self.mirrors.iter().filter_map(move |mirror| {
            let reflector = &self.reflectors.list[mirror.number as usize];
            reflector.facing(receiver.position)?;
            if !lamp_in_sight(mirror, reflector, receiver.position, lamp) {
                return None;
            }
            let target = Target::of(lamp);
            let wi = match target {
                Target::Point(point) => reflector.mirror_point(point) - receiver.position,
                Target::Direction(wi) => reflector.mirror_direction(wi),
            };
            let wi = wi.normalize_or_zero();
            let across =
                Receiver::new(reflector.mirror_point(receiver.position), reflector.mirror_direction(wi));
            let light = direct::unshadowed_lamp(lamp, &across);
            if light == Vec3::ZERO || receiver.geometric_normal.dot(wi) <= 0.0 {
                return None;
            }
            Some((wi, light * self.passed(mirror, world, receiver, target)))
        })
    }

    fn by_way_of(
        &self,
        mirror: &Mirror,
        world: &World,
        emitter: &Emitter,
        receivers: &[(&Receiver, u32)],
        samples: u32,
    ) -> Vec3 {
        let reflector = &self.reflectors.list[mirror.number as usize];
        let seen_from = receivers.iter().filter_map(|&(receiver, scramble)| {
            reflector.facing(receiver.position)?;
            let turned = |v: Vec3| reflector.mirror_direction(v);
            let image = Receiver {
                position: reflector.mirror_point(receiver.position),
                normal: turned(receiver.normal),
                geometric_normal: turned(receiver.geometric_normal),
            };
            in_sight(mirror, reflector, receiver.position, emitter).then_some((receiver, image, scramble))
        });
        let passed = |receiver: &Receiver, target: Target| self.passed(mirror, world, receiver, target);
        match emitter {
            Emitter::Lamp { lamp, .. } => seen_from.fold(Vec3::ZERO, |sum, (receiver, image, _)| {
                let e = direct::unshadowed_lamp(lamp, &image);
                if e == Vec3::ZERO { sum } else { sum + e * passed(receiver, Target::of(lamp)) }
            }),
            Emitter::Area(area) => {
                let seen_from = seen_from.map(|(receiver, image, scramble)| ((receiver, image), scramble));
                let arrives = |r: &(&Receiver, Receiver), target| passed(r.0, Target::Point(target));
                direct::of_area(world, area, seen_from, samples, |r| &r.1, arrives)
            }
        }
    }

    /// Share of the light from a target that arrives by way of a mirror, per channel: its reflectance, or nothing.
    fn passed(&self, mirror: &Mirror, world: &World, receiver: &Receiver, target: Target) -> Vec3 {
        let reflector = &self.reflectors.list[mirror.number as usize];
        let origin = receiver.origin();
        let ray = match target {
            Target::Point(point) => {
                Ray { t_max: 1.0, ..Ray::new(origin, reflector.mirror_point(point) - origin) }
            }
            Target::Direction(wi) => Ray::new(origin, reflector.mirror_direction(wi)),
        };
        let Some(hit) = world.accel.trace(&ray) else { return Vec3::ZERO };
        if self.reflectors.of(hit.triangle) != mirror.number {
            return Vec3::ZERO;
        }
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, ray.direction);
        let Some(specular) = world.geometry.brdf(&surface).specular else { return Vec3::ZERO };
        let from = offset_origin(surface.position, surface.geometric_normal);
        let on = match target {
            Target::Point(point) => Ray::between(from, point),
            Target::Direction(wi) => Ray::new(from, wi),
        };
        world.transmittance(&on) * specular.reflectance(-ray.direction.normalize().dot(surface.normal))
    }
}

/// Whether an emitter's image may be seen through a mirror: whether the cones around both overlap.
fn in_sight(mirror: &Mirror, reflector: &Reflector, from: Vec3, emitter: &Emitter) -> bool {
    match emitter {
        Emitter::Area(area) => overlap(mirror, from, (reflector.mirror_point(area.bounds.0), area.bounds.1)),
        Emitter::Lamp { lamp, .. } => lamp_in_sight(mirror, reflector, from, lamp),
    }
}

/// [`in_sight`] of a lamp without a surface.
fn lamp_in_sight(mirror: &Mirror, reflector: &Reflector, from: Vec3, lamp: &Lamp) -> bool {
    match Target::of(lamp) {
        Target::Point(point) => overlap(mirror, from, (reflector.mirror_point(point), 0.0)),
        // As far away as matters.
        Target::Direction(wi) => {
            let far = 1e3 * (1.0 + mirror.bounds.1 + from.distance(mirror.bounds.0));
            overlap(mirror, from, (from + far * reflector.mirror_direction(wi), 0.0))
        }
    }
}

/// Whether the cones around a mirror and around another sphere overlap, seen from a point.
fn overlap(mirror: &Mirror, from: Vec3, sphere: (Vec3, f32)) -> bool {
    let cone = |(middle, radius): (Vec3, f32)| {
        let to = middle - from;
        let distance = to.length();
        let angle = if distance > radius { (radius / distance).asin() } else { std::f32::consts::PI };
        (to.normalize_or_zero(), angle)
    };
    let [(to_mirror, mirror_angle), (to_sphere, angle)] = [cone(mirror.bounds), cone(sphere)];
    // A hair more: the sines of small angles are rounded.
    to_mirror.dot(to_sphere).clamp(-1.0, 1.0).acos() <= mirror_angle + angle + 1e-3
}
