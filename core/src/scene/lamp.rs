//! Lamps without a surface, as KHR_lights_punctual defines them.

use super::accel::Ray;
use glam::{Affine3A, Vec3};

/// A lamp; its own frame has its position at the origin and shines along −z.
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    /// Name from the file.
    pub name: String,
    /// How it emits.
    pub kind: LampKind,
    /// Placement; scale is ignored.
    pub world_from_lamp: Affine3A,
    /// Factor on its emission: 1 as the file says, 0 switched off.
    pub dimmer: f32,
}

/// How a lamp emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampKind {
    /// The same intensity in every direction.
    Point {
        /// Luminous intensity, cd per channel.
        intensity: Vec3,
    },
    /// A cone, full inside `inner_angle`, zero outside `outer_angle`, both from the axis, rad.
    Spot {
        /// Luminous intensity on the axis, cd per channel.
        intensity: Vec3,
        /// Half angle of the full cone, rad.
        inner_angle: f32,
        /// Half angle of the dark, rad.
        outer_angle: f32,
    },
    /// Parallel light from infinitely far.
    Directional {
        /// Illuminance on a plane facing it, lx per channel.
        illuminance: Vec3,
    },
}

impl Lamp {
    /// Position, m.
    pub fn position(&self) -> Vec3 {
        self.world_from_lamp.translation.into()
    }

    /// Unit axis it shines along.
    pub fn axis(&self) -> Vec3 {
        self.world_from_lamp.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Y)
    }

    /// Intensity towards the unit direction `from_lamp`, cd per channel; zero for a directional lamp.
    ///
    /// A spot falls off as glTF says: t², t = (cos θ − cos outer) / (cos inner − cos outer) clamped.
    pub fn intensity_towards(&self, from_lamp: Vec3) -> Vec3 {
        match self.kind {
            LampKind::Point { intensity } => intensity * self.dimmer,
            LampKind::Spot { intensity, inner_angle, outer_angle } => {
                let (inner, outer) = (inner_angle.cos(), outer_angle.cos());
                let t = ((self.axis().dot(from_lamp) - outer) / (inner - outer).max(1e-3)).clamp(0.0, 1.0);
                intensity * (self.dimmer * t * t)
            }
            LampKind::Directional { .. } => Vec3::ZERO,
        }
    }

    /// Light at a position if nothing is between: the unit direction it comes from, and the illuminance across it,
    /// lx per channel: I / d², or what parallel light has everywhere. None where it has no direction.
    pub fn arriving(&self, position: Vec3) -> (Vec3, Vec3) {
        if let LampKind::Directional { illuminance } = self.kind {
            return (-self.axis(), illuminance * self.dimmer);
        }
        let to_lamp = self.position() - position;
        let d2 = to_lamp.length_squared();
        let wi = to_lamp / d2.sqrt();
        if d2 == 0.0 || !wi.is_finite() {
            (Vec3::ZERO, Vec3::ZERO)
        } else {
            (wi, self.intensity_towards(-wi) / d2)
        }
    }

    /// Ray that is free if the lamp is seen.
    pub fn ray_from(&self, origin: Vec3) -> Ray {
        match self.kind {
            LampKind::Directional { .. } => Ray::new(origin, -self.axis()),
            _ => Ray::between(origin, self.position()),
        }
    }
}
