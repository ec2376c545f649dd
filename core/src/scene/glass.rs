//! Clear glass: what passes through a surface, by Snell's law and the Fresnel equation (Bastos 1999, §3.5.2).
//!
//! Two kinds, as glTF tells them apart. The boundary of a *solid* bends light: n₁ sin θ₁ = n₂ sin θ₂, with the angles
//! from the normal (Bastos's Eq. 3.1 has cosines); what lies behind it is seen by a specular chain. A *pane* stands
//! for both faces of a thin sheet and lets light straight through; so lamps are seen through panes by shadow rays, and
//! passing one is no event of a light path. Absorption is the base colour, once a surface met.
//!
//! Limits: glass is clear whatever its roughness. Of what one face reflects back into a solid only total reflection is
//! followed in pictures and by the solvers: a plate passes (1 − F)² of the light where all orders together would pass
//! (1 − F) / (1 + F), 0.16 % more of a common glass; the path tracer follows them all. A lamp without a surface casts no
//! light through a solid.

use super::{
    accel::Ray,
    fresnel,
    geometry::{Surface, offset_origin},
    world::World,
};
use glam::Vec3;

/// Surfaces of glass that are looked through one after the other, at most.
pub const MOST_FACES: usize = 16;

/// From where a surface of glass is met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// From the air before it, or before the coat of something dull.
    #[default]
    Outside,
    /// From within the solid.
    Inside,
    /// Both faces of a thin sheet at once.
    Pane,
}

impl Side {
    /// Reflectance at an angle of incidence with this cosine, of a boundary with a normal reflectance.
    ///
    /// From inside that of the same ray from outside, 1 beyond the critical angle; of a pane 2 F / (1 + F), all
    /// orders between its faces. Has a twin in `shaders/shared/reflection.wgsl`.
    pub fn reflectance(self, normal_reflectance: f32, cos_theta: f32) -> f32 {
        match self {
            Self::Outside => fresnel::reflectance(normal_reflectance, cos_theta),
            Self::Inside => {
                let sine_squared = 1.0 - cos_theta.clamp(0.0, 1.0).powi(2);
                let outside = 1.0 - fresnel::effective_index(normal_reflectance).powi(2) * sine_squared;
                if outside <= 0.0 { 1.0 } else { fresnel::reflectance(normal_reflectance, outside.sqrt()) }
            }
            Self::Pane => {
                let once = fresnel::reflectance(normal_reflectance, cos_theta);
                2.0 * once / (1.0 + once)
            }
        }
    }
}

/// What a point of a surface lets pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Share passed of what is not reflected, per channel.
    pub tint: Vec3,
    /// Normal reflectance of a boundary.
    pub dielectric: f32,
    /// From where it is met.
    pub side: Side,
}

/// Light that passes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// The ray behind the surface.
    pub ray: Ray,
    /// Radiance before the surface over that behind it, per channel.
    pub share: Vec3,
}

impl Glass {
    /// What is seen through a surface along a unit `direction` that meets it; `None` beyond the critical angle.
    ///
    /// L = tint (1 − F) (n₁ / n₂)² L′: radiance changes with the square of the index, as its cone narrows.
    pub fn pass(&self, surface: &Surface, direction: Vec3) -> Option<Passed> {
        let about = |normal: Vec3| {
            let cosine = -direction.dot(normal);
            let share = self.tint * (1.0 - self.side.reflectance(self.dielectric, cosine));
            let ratio = match self.side {
                Side::Pane => return Some((direction, share)),
                Side::Outside => fresnel::effective_index(self.dielectric).recip(),
                Side::Inside => fresnel::effective_index(self.dielectric),
            };
            let behind = refracted(direction, normal, ratio)?;
            Some((behind, share * (ratio * ratio)))
        };
        let facing = surface.normal.dot(direction) < 0.0;
        let mut passed = about(if facing { surface.normal } else { surface.geometric_normal })?;
        if passed.0.dot(surface.geometric_normal) >= 0.0 {
            passed = about(surface.geometric_normal)?;
        }
        let (behind, share) = passed;
        let origin = offset_origin(surface.position, -surface.geometric_normal);
        Some(Passed { ray: Ray::new(origin, behind), share })
    }

    /// [`Self::pass`], or total reflection where nothing passes.
    pub fn pass_or_reflect(&self, surface: &Surface, direction: Vec3) -> Passed {
        let reflected = || Passed { ray: surface.mirrored(direction), share: Vec3::ONE };
        self.pass(surface, direction).unwrap_or_else(reflected)
    }
}

/// A unit direction behind a boundary with the ratio n₁ / n₂ of indices; the normal points against it. Snell's law as
/// a vector: d′ = η d + (η c₁ − c₂) n, c₂² = 1 − η² (1 − c₁²); `None` where that is negative.
pub fn refracted(direction: Vec3, normal: Vec3, ratio: f32) -> Option<Vec3> {
    let cosine = -direction.dot(normal);
    let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    (squared > 0.0).then(|| (ratio * direction + (ratio * cosine - squared.sqrt()) * normal).normalize())
}

/// A surface seen through glass.
#[derive(Clone, Copy, Debug)]
pub struct Behind {
    /// The surface.
    pub surface: Surface,
    /// Unit direction along which it is met.
    pub direction: Vec3,
    /// Share of its radiance that is seen, per channel.
    pub share: Vec3,
    /// Whether a solid bent the ray on the way: panes alone leave a path of light what it is.
    pub bent: bool,
}

impl World {
    /// The surfaces seen through one that may be of glass, along a unit direction, one behind the other, the first
    /// that is not glass last.
    pub fn seen_through(&self, surface: Surface, direction: Vec3) -> impl Iterator<Item = Behind> + '_ {
        let start = Behind { surface, direction, share: Vec3::ONE, bent: false };
        std::iter::successors(Some(start), |seen| self.behind(seen)).skip(1).take(MOST_FACES)
    }

    fn behind(&self, seen: &Behind) -> Option<Behind> {
        let Behind { surface, direction, share, bent } = *seen;
        let glass = self.geometry.brdf(&surface).glass?;
        let Passed { ray, share: passed } = glass.pass_or_reflect(&surface, direction);
        let hit = self.accel.trace(&ray)?;
        Some(Behind {
            surface: self.geometry.surface(hit.triangle, hit.barycentric, ray.direction),
            direction: ray.direction,
            share: share * passed,
            bent: bent || glass.side != Side::Pane,
        })
    }

    /// Share of the light along a ray that arrives straight, per channel: none past anything but panes.
    pub fn transmittance(&self, ray: &Ray) -> Vec3 {
        self.straight(ray).0
    }

    /// [`Self::transmittance`], and whether there are panes in the way.
    pub fn straight(&self, ray: &Ray) -> (Vec3, bool) {
        if !self.glass {
            return (if self.accel.occluded(ray) { Vec3::ZERO } else { Vec3::ONE }, false);
        }
        let (mut ray, mut share) = (*ray, Vec3::ONE);
        let along = ray.direction.normalize_or_zero();
        for passed_before in 0..MOST_FACES {
            let Some(hit) = self.accel.trace(&ray) else { return (share, passed_before > 0) };
            let surface = self.geometry.surface(hit.triangle, hit.barycentric, ray.direction);
            let pane = self.geometry.brdf(&surface).glass.filter(|g| g.side == Side::Pane);
            let Some(passed) = pane.and_then(|pane| pane.pass(&surface, along)) else { break };
            share *= passed.share;
            ray.t_min = (hit.t * (1.0 + 1e-5)).next_up();
        }
        (Vec3::ZERO, false)
    }
}
