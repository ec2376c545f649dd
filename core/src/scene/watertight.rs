//! A ray against a triangle without gaps: a ray that crosses an edge hits one of its two triangles.
//!
//! Woop, Benthin and Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013. The triangle is
//! translated to the ray's origin and sheared so that the ray runs along +z; what is left is the sign
//! of three 2D cross products, and both triangles of an edge compute the same product for it. obvhs's
//! own test is Möller and Trumbore's with a sign-bit mask that rejects −0, so rays along the diagonal
//! of an axis-aligned wall pass through it.

use glam::{Mat3A, Vec3, Vec3A};
use obvhs::{ray::Ray, triangle::Triangle};

/// What a ray's test against any triangle needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shear {
    /// To the frame in which the ray starts at the origin and runs along +z with t = z.
    ray_from_world: Mat3A,
    origin: Vec3A,
}

impl Shear {
    /// Prepares a ray with a finite direction that is not zero.
    pub(super) fn new(origin: Vec3, direction: Vec3) -> Self {
        let z = direction.abs().max_position();
        let inverse = 1.0 / direction[z];
        // The order of x and y is kept when z is negative: both windings are accepted.
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let mut columns = [Vec3A::ZERO; 3];
        columns[x] = Vec3A::X;
        columns[y] = Vec3A::Y;
        columns[z] = Vec3A::new(-direction[x] * inverse, -direction[y] * inverse, inverse);
        let [x, y, z] = columns;
        Self { ray_from_world: Mat3A::from_cols(x, y, z), origin: origin.into() }
    }

    /// Parameter t of the hit in [t_min, t_max]; infinite for a miss.
    #[inline(always)]
    pub(super) fn intersect(&self, triangle: &Triangle, t_min: f32, t_max: f32) -> f32 {
        let [a, b, c] =
            [triangle.v0, triangle.v1, triangle.v2].map(|v| self.ray_from_world * (v - self.origin));
        let ((ax, ay), (bx, by), (cx, cy)) = ((a.x, a.y), (b.x, b.y), (c.x, c.y));
        let mut u = cx * by - cy * bx;
        let mut v = ax * cy - ay * cx;
        let mut w = bx * ay - by * ax;
        if u == 0.0 || v == 0.0 || w == 0.0 {
            // Products of f32 are exact in f64, so the sign is.
            let cross = |px: f32, qy: f32, py: f32, qx: f32| {
                (f64::from(px) * f64::from(qy) - f64::from(py) * f64::from(qx)) as f32
            };
            u = cross(cx, by, cy, bx);
            v = cross(ax, cy, ay, cx);
            w = cross(bx, ay, by, ax);
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return f32::INFINITY;
        }
        let t = (u * a.z + v * b.z + w * c.z) / (u + v + w);
        // NaN, from a triangle seen edge-on, fails the comparison.
        if t >= t_min && t <= t_max { t } else { f32::INFINITY }
    }
}

/// The ray as obvhs's slab test needs it: reciprocals of any direction, zero included, that are finite.
///
/// `obvhs::ray::Ray::new` replaces every component below 1.2e-7 by that number, which is wrong for
/// directions that are short as a whole, such as the difference of two near points.
pub(super) fn slab_ray(origin: Vec3, direction: Vec3, t_min: f32, t_max: f32) -> Ray {
    const LARGEST: f32 = 1e30;
    let reciprocal = |d: f32| if d.abs() * LARGEST < 1.0 { LARGEST.copysign(d) } else { 1.0 / d };
    Ray {
        origin: origin.into(),
        direction: direction.into(),
        inv_direction: direction.map(reciprocal).into(),
        tmin: t_min,
        tmax: t_max,
    }
}
