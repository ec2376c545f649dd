//! The weight that a texel of the mirror image has in a pixel's glossy reflection.

use crate::{mirror::views::Eye, scene::brdf::Lobe};
use glam::{Vec2, Vec3};

/// A point of a flat glossy reflector, as one pixel shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlossyPoint {
    /// The point, from the eye, m.
    pub from_eye: Vec3,
    /// Unit normal of the reflector on the side seen.
    pub normal: Vec3,
    /// Its lobe.
    pub lobe: Lobe,
}

/// What the weights of all points of a picture share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// The eye.
    pub eye: Eye,
    /// Width and height in pixels.
    pub size: Vec2,
    /// Place inside the pixels that rays go through.
    pub subpixel: Vec2,
}

impl Lens {
    /// Unit direction through a place in the picture, in pixels from the top left.
    pub fn direction(&self, at: Vec2) -> Vec3 {
        let uv = at / self.size;
        let eye = &self.eye;
        (eye.forward
            + eye.right * ((2.0 * uv.x - 1.0) * eye.half_size.x)
            + eye.up * ((1.0 - 2.0 * uv.y) * eye.half_size.y))
            .normalize()
    }

    /// Place in the picture, in pixels from the top left, of a point before the eye, given from the eye.
    pub fn place(&self, from_eye: Vec3) -> Vec2 {
        let eye = &self.eye;
        let slope = Vec2::new(from_eye.dot(eye.right), from_eye.dot(eye.up)) / from_eye.dot(eye.forward);
        let uv = slope / eye.half_size;
        0.5 * (1.0 + Vec2::new(uv.x, -uv.y)) * self.size
    }

    /// Angle of one pixel in the middle of the picture, rad.
    pub fn pixel_angle(&self) -> f32 {
        2.0 * self.eye.half_size.y / self.size.y
    }
}

impl GlossyPoint {
    /// Cosine of the angle between view and normal.
    pub fn cos_theta(&self) -> f32 {
        -self.from_eye.dot(self.normal) / self.from_eye.length()
    }

    /// Unnormalised weight of a texel: f(ωᵢ, ωₒ) cos θᵢ times its solid angle from this point over that from
    /// the eye, with ωᵢ the direction to what the texel mirrors.
    ///
    /// Unfolded at the mirror, what a texel shows stands at the distance 1/`nearness` along its pixel's
    /// direction v; seen from a point P of the mirror it lies towards u = v − P·nearness, and is 1/|u| nearer
    /// than from the eye. Its surface is taken to face both alike. `texel_angle` bounds 1/|u| where the
    /// texel is touched by the surface: from inside it no direction is nearer than its edge.
    ///
    /// Has a twin in `shaders/glossy/convolve.wgsl`.
    pub fn weight(&self, direction: Vec3, nearness: f32, texel_angle: f32) -> f32 {
        let u = direction - self.from_eye * nearness;
        let least = 0.5 * texel_angle;
        let squared = u.length_squared();
        // Where both touch, the direction is the mirrored one.
        let towards = if squared > 1e-4 * least * least { u / squared.sqrt() } else { direction };
        let wi = towards - 2.0 * self.normal.dot(towards) * self.normal;
        let cos_i = wi.dot(self.normal);
        if cos_i <= 0.0 {
            return 0.0;
        }
        let wo = -self.from_eye.normalize();
        self.lobe.value(self.normal, wi, wo) * cos_i / squared.max(least * least)
    }

    /// Radius of the kernel in pixels for what lies at 1/`nearness` on the unfolded ray: a lobe of slope tan β
    /// about a ray of length d spans d tan β, seen from |P| + d.
    pub fn radius_pixels(&self, nearness: f32, support: f32, pixel_angle: f32) -> f32 {
        let share = 1.0 - (self.from_eye.length() * nearness).min(1.0);
        share * support / pixel_angle
    }
}
