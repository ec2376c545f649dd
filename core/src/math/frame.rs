//! Orthonormal frames around a direction, and cosine-weighted directions in them.

use glam::{Mat3, Vec2, Vec3};

/// Frame whose z axis is the unit vector `normal`: columns (tangent, bitangent, normal).
///
/// Branchless construction of Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 2017.
pub fn frame_from_normal(normal: Vec3) -> Mat3 {
    let sign = 1.0_f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    Mat3::from_cols(
        Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
        Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
        normal,
    )
}

/// The unit view vector (from the surface to the eye) mirrored at a unit normal: where an ideal mirror
/// shows the eye the light from, 2 (n·v) n − v.
pub fn mirrored(view: Vec3, normal: Vec3) -> Vec3 {
    2.0 * normal.dot(view) * normal - view
}

/// Direction on the +z hemisphere with density cos θ / π per solid angle, from `u` in [0, 1)².
///
/// The concentric map of the square onto the disc, lifted to the hemisphere (Malley).
pub fn cosine_direction(u: Vec2) -> Vec3 {
    let disc = super::sphere_map::disc_from_square(u);
    let z = (1.0 - disc.length_squared()).max(0.0).sqrt();
    disc.extend(z)
}

/// Direction uniform over the whole sphere, density 1/4π, from `u` in [0, 1)².
pub fn uniform_direction(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (std::f32::consts::TAU * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, z)
}
