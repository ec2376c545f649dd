//! Everything around a point as one latitude–longitude picture, as
//! [`irradiance_volume::panorama`](crate::irradiance_volume::panorama) reads it.

use crate::{
    irradiance_volume::panorama::render,
    math::{
        image::LinearImage,
        part::Part,
        progress::{Cancelled, Progress},
        random::hash,
    },
    scene::accel::Ray,
    transport::LightTransportSolution,
};
use glam::Vec3;
use std::{
    f32::consts::FRAC_1_PI,
    sync::atomic::{AtomicU32, Ordering},
};

/// Shadow rays an area emitter and ray.
const SHADOW_RAYS: u32 = 16;

/// Radiance that arrives at a point, cd/m²: `height` pixels high and twice as wide, `rays`² rays a pixel.
///
/// # Errors
/// [`Cancelled`].
pub fn panorama(
    solution: &LightTransportSolution,
    at: Vec3,
    height: u32,
    rays: u32,
    progress: &Progress,
) -> Result<LinearImage, Cancelled> {
    progress.begin("panorama");
    let all = 2.0 * (height * rays).pow(2) as f32;
    let done = AtomicU32::new(0);
    let image = render(height, rays, |direction| {
        // What is left after a stop is thrown away.
        let before = done.fetch_add(1, Ordering::Relaxed);
        if before.is_multiple_of(1024) {
            let _ = progress.report(before as f32 / all);
        }
        if progress.is_cancelled() { Vec3::ZERO } else { radiance(solution, at, direction) }
    });
    progress.report(1.0)?;
    Ok(image)
}

/// Radiance that arrives at a point along a direction, as a picture's pixels have it, cd/m².
fn radiance(solution: &LightTransportSolution, at: Vec3, direction: Vec3) -> Vec3 {
    let world = &solution.world;
    let Some(hit) = world.accel.trace(&Ray::new(at, direction)) else { return Vec3::ZERO };
    let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
    let scramble = hash(direction.x.to_bits() ^ hash(direction.y.to_bits()));
    let e = solution.radiosity.irradiance_exact_direct(world, &surface, Part::All, SHADOW_RAYS, scramble);
    world.geometry.emission(&surface) + world.geometry.reflectance(&surface) * e * FRAC_1_PI
}
