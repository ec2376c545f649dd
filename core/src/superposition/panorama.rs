//! Everything around a point as one latitude–longitude picture, as
//! [`irradiance_volume::panorama`](crate::irradiance_volume::panorama) reads it.

use super::{
    composite::DirectQuality,
    pass::{PassSettings, Shading},
};
use crate::{
    irradiance_volume::panorama::render,
    math::{
        image::LinearImage,
        progress::{Cancelled, Progress},
        random::hash,
    },
    scene::accel::Ray,
    transport::LightTransportSolution,
};
use glam::Vec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Shadow rays an area emitter and ray.
const SHADOW_RAYS: u32 = 16;

/// Mirrors that a ray is followed through.
const MOST_REFLECTIONS: u32 = 16;

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
    let all = 2.0 * (height as f32 * rays as f32).powi(2);
    let done = AtomicU64::new(0);
    let shading = Shading::new(
        solution,
        &PassSettings { direct: DirectQuality::PerPixel(SHADOW_RAYS), ..PassSettings::default() },
    );
    let image = render(height, rays, |direction| {
        // What is left after a stop is thrown away.
        let before = done.fetch_add(1, Ordering::Relaxed);
        if before.is_multiple_of(1024) {
            let _ = progress.report(before as f32 / all);
        }
        if progress.is_cancelled() { Vec3::ZERO } else { radiance(&shading, at, direction) }
    });
    progress.report(1.0)?;
    Ok(image)
}

/// Radiance that arrives at a point along a direction, cd/m²: what a pixel of a picture has, except that
/// reflections in ideal mirrors are traced and wider lobes stand in as broad as the hemisphere.
fn radiance(shading: &Shading, at: Vec3, direction: Vec3) -> Vec3 {
    let world = &shading.solution.world;
    let scramble = hash(direction.x.to_bits() ^ hash(direction.y.to_bits()));
    let (mut ray, mut sum, mut left) = (Ray::new(at, direction), Vec3::ZERO, Vec3::ONE);
    for _ in 0..MOST_REFLECTIONS {
        let Some(hit) = world.accel.trace(&ray) else { break };
        let wo = -ray.direction;
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, ray.direction);
        let seen = shading.terms(&surface, scramble, wo);
        let mirror = world.geometry.brdf(&surface).specular.filter(|s| s.is_mirror());
        let Some(mirror) = mirror else { return sum + left * (seen.all_but_wide() + seen.wide) };
        sum += left * seen.all_but_wide();
        left *= mirror.reflectance(wo.dot(surface.normal));
        ray = surface.mirrored(ray.direction);
    }
    sum
}
