//! What each pixel sees, found by casting rays through the pixels.
//!
//! The back of a single-sided surface is passed by, so that one can look into a closed room from
//! outside. It is passed by for the eye alone: it still blocks light.

use crate::scene::{
    accel::{Hit, Ray},
    camera::Camera,
    geometry::Surface,
    world::World,
};
use glam::{UVec2, Vec2, Vec3};

/// Triangle number of a pixel that sees nothing.
pub const NO_TRIANGLE: u32 = u32::MAX;

/// At most this many backs are passed by along one ray of the eye.
const MAX_PASSED_BACKS: u32 = 64;

/// What each pixel sees; row-major from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GBuffer {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Triangle numbers, [`NO_TRIANGLE`] where there is nothing.
    pub triangle: Vec<u32>,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec<Vec2>,
    /// Positions, m.
    pub position: Vec<Vec3>,
    /// Unit shading normals on the side seen.
    pub normal: Vec<Vec3>,
    /// Distances from the eye along the pixels' rays, m; infinite where there is nothing.
    pub depth: Vec<f32>,
    /// Whether the back is seen, of a double-sided surface.
    pub back: Vec<bool>,
}

impl GBuffer {
    /// Casts one ray a pixel, through `subpixel` in [0, 1)² of each; (½, ½) is the centre.
    pub fn new(world: &World, camera: &Camera, size: UVec2, subpixel: Vec2) -> Self {
        use rayon::prelude::*;
        let count = (size.x * size.y) as usize;
        let seen: Vec<Option<(Surface, f32)>> = (0..count as u32)
            .into_par_iter()
            .map(|i| {
                let pixel = UVec2::new(i % size.x, i / size.x);
                let direction = pixel_direction(camera, size, pixel, subpixel);
                let hit = first_visible(world, camera.eye, direction)?;
                Some((world.geometry.surface(hit.triangle, hit.barycentric, direction), hit.t))
            })
            .collect();
        let mut buffer = Self { width: size.x, height: size.y, ..Self::default() };
        for pixel in seen {
            let (triangle, barycentric, position, normal, depth, back) = match pixel {
                Some((s, t)) => (s.triangle, s.barycentric, s.position, s.normal, t, s.back),
                None => (NO_TRIANGLE, Vec2::ZERO, Vec3::ZERO, Vec3::ZERO, f32::INFINITY, false),
            };
            buffer.triangle.push(triangle);
            buffer.barycentric.push(barycentric);
            buffer.position.push(position);
            buffer.normal.push(normal);
            buffer.depth.push(depth);
            buffer.back.push(back);
        }
        buffer
    }

    /// The surface a pixel sees, by its index in the buffers.
    pub fn surface(&self, world: &World, camera: &Camera, pixel: usize) -> Option<Surface> {
        let triangle = self.triangle[pixel];
        (triangle != NO_TRIANGLE).then(|| {
            let direction = self.position[pixel] - camera.eye;
            let mut surface = world.geometry.surface(triangle, self.barycentric[pixel], direction);
            if surface.back != self.back[pixel] {
                // At grazing incidence rounding may turn the plane over; the ray cast decided.
                surface.back = self.back[pixel];
                surface.normal = -surface.normal;
                surface.geometric_normal = -surface.geometric_normal;
            }
            surface
        })
    }
}

/// Unit direction of the ray through `subpixel` of a pixel.
pub fn pixel_direction(camera: &Camera, size: UVec2, pixel: UVec2, subpixel: Vec2) -> Vec3 {
    let uv = (pixel.as_vec2() + subpixel) / size.as_vec2();
    camera.ray_direction(uv, size.x as f32 / size.y as f32)
}

/// First surface along a ray whose visible side is shown: the backs of single-sided surfaces are passed by.
pub fn first_visible(world: &World, origin: Vec3, direction: Vec3) -> Option<Hit> {
    let mut ray = Ray::new(origin, direction);
    for _ in 0..MAX_PASSED_BACKS {
        let hit = world.accel.trace(&ray)?;
        let back = world.geometry.area_normal(hit.triangle).dot(direction) > 0.0;
        if !back || world.geometry.material_of(hit.triangle).double_sided {
            return Some(hit);
        }
        ray.t_min = hit.t.next_up() + 1e-6 * hit.t;
    }
    None
}
