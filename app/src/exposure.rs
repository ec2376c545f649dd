//! Exposure that follows the picture.

use glam::Vec2;
use lumenscope_core::{
    math::{colour::luminance, part::Part},
    scene::{accel::Ray, camera::Camera},
    transport::LightTransportSolution,
};
use std::f32::consts::PI;

/// Share of white that the view's mean luminance is brought to: photographic middle grey.
const MIDDLE_GREY: f32 = 0.18;

/// Rays across and down: enough for a mean, few enough for every frame.
const GRID: [u32; 2] = [32, 20];

/// Exposure value at which the geometric mean of reflected luminance in view is middle grey;
/// `None` where nothing lit is in view.
///
/// EV = log₂(Y / (1.2 · 0.18)), Y = exp(mean ln(ρ E / π)), cd/m². Emitters are left out: a lamp in view
/// must not darken the room it lights.
pub fn exposure(solution: &LightTransportSolution, camera: &Camera, aspect: f32) -> Option<f32> {
    let world = &solution.world;
    let (mut sum, mut count) = (0.0f64, 0u32);
    for y in 0..GRID[1] {
        for x in 0..GRID[0] {
            let uv = (Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(GRID[0] as f32, GRID[1] as f32);
            let ray = Ray::new(camera.eye, camera.ray_direction(uv, aspect));
            let Some(hit) = world.accel.trace(&ray) else { continue };
            let surface = world.geometry.surface(hit.triangle, hit.barycentric, ray.direction);
            let irradiance =
                solution.radiosity.irradiance(hit.triangle, hit.barycentric, surface.back, Part::All);
            let y = luminance(world.geometry.reflectance(&surface) * irradiance) / PI;
            if y > 0.0 && y.is_finite() {
                sum += f64::from(y).ln();
                count += 1;
            }
        }
    }
    let mean = (sum / f64::from(count.max(1))).exp() as f32;
    (count > 0).then(|| (mean / (1.2 * MIDDLE_GREY)).log2().clamp(-20.0, 30.0))
}
