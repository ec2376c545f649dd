//! What a flat glossy surface reflects, ray by ray: the integral that the convolutions stand for, under the same
//! light.
//!
//! L = ∫ f(ωᵢ, ωₒ) Lᵢ(ωᵢ) cos θᵢ dωᵢ, each ray drawn from the lobe and what it meets shaded as the mirror image
//! shades it. So the difference to a convolution is that of convolving, not of the light; and each ray says
//! whether the mirror image shows what it met, which is the visibility assumption of Bastos 1999, §7.4.1, measured.
//!
//! A reference, not a method: it takes as many rays as a path tracer, and only spares it the bounces.

use crate::{
    glossy::pass::GlossyFrame,
    math::random::{Rng, hash2},
    mirror::{
        MirrorSettings,
        reflectors::{BLURRED_ALPHA, NO_REFLECTOR},
    },
    reference::stream_seed,
    scene::{
        accel::Ray,
        brdf::Specular,
        camera::Camera,
        geometry::{Surface, offset_origin},
    },
    superposition::pass::{PassSettings, Shading},
};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Relative difference of distances up to which a pixel of the mirror image shows the point that a ray met.
const SAME_DISTANCE: f32 = 0.02;

/// One pixel's lobe by rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LobePixel {
    /// Radiance reflected towards the eye, cd/m².
    pub radiance: Vec3,
    /// Variance of that mean over the rays, (cd/m²)².
    pub variance: Vec3,
    /// Share of the lobe's weight whose rays met what the mirror image does not show.
    pub hidden: f32,
}

/// The lobe of every pixel by so many rays each, at least two; `None` where no flat glossy reflector is seen.
///
/// The same arguments give the same bytes at any thread count.
pub fn lobes_by_rays(
    frame: &GlossyFrame,
    shading: &Shading,
    camera: &Camera,
    settings: &PassSettings,
    rays: u32,
) -> Vec<Option<LobePixel>> {
    (0..frame.image.reflector.len())
        .into_par_iter()
        .map(|pixel| {
            frame.point(pixel)?;
            let surface = frame.buffer.surface(frame.world, camera, pixel)?;
            let specular = frame.world.geometry.brdf(&surface).specular?;
            Some(by_rays(frame, shading, &surface, &specular, settings, (pixel as u32, rays.max(2))))
        })
        .collect()
}

fn by_rays(
    frame: &GlossyFrame,
    shading: &Shading,
    surface: &Surface,
    specular: &Specular,
    settings: &PassSettings,
    (pixel, rays): (u32, u32),
) -> LobePixel {
    let item = u64::from(settings.scramble(pixel));
    let mut rng = Rng::new(stream_seed(settings.seed, item), item);
    let normal = surface.geometric_normal;
    let wo = (frame.lens.eye.position - surface.position).normalize_or(normal);
    let lobe = specular.lobe();
    let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
    let (mut hidden, mut all) = (0.0f64, 0.0f64);
    for ray in 0..rays {
        let Some(wi) = lobe.sample(normal, wo, rng.next_vec2()) else { continue };
        let share = lobe.value(normal, wi, wo) * normal.dot(wi) / lobe.density(normal, wi, wo);
        if !share.is_finite() {
            continue;
        }
        let scramble = hash2(settings.scramble(pixel), ray);
        let (arriving, met) = arriving(frame, shading, surface, wi, scramble);
        let fresnel = specular.reflectance(wo.dot((wi + wo).normalize_or(normal)));
        let value = (fresnel * share * arriving).as_dvec3();
        sum += value;
        squares += value * value;
        all += f64::from(share);
        let reflector = frame.image.reflector[pixel as usize];
        if met.is_none_or(|p| !is_shown(frame, reflector, p)) {
            hidden += f64::from(share);
        }
    }
    let n = f64::from(rays);
    let mean = sum / n;
    let spread = ((squares / n - mean * mean) / (n - 1.0)).max(DVec3::ZERO);
    LobePixel {
        radiance: mean.as_vec3(),
        variance: spread.as_vec3(),
        hidden: if all > 0.0 { (hidden / all) as f32 } else { 0.0 },
    }
}

/// Radiance that arrives at a surface from a direction, by way of sharp flat mirrors as deep as the mirror image
/// goes, and the first point met.
fn arriving(
    frame: &GlossyFrame,
    shading: &Shading,
    from: &Surface,
    mut direction: Vec3,
    scramble: u32,
) -> (Vec3, Option<Vec3>) {
    let geometry = &frame.world.geometry;
    let depth = MirrorSettings::of(&shading.solution.scene.plan).depth;
    let mut origin = offset_origin(from.position, from.geometric_normal);
    let (mut radiance, mut throughput, mut met) = (Vec3::ZERO, Vec3::ONE, None);
    for bounce in 1..=depth.max(1) {
        let Some(hit) = frame.world.accel.trace(&Ray::new(origin, direction)) else { break };
        let surface = geometry.surface(hit.triangle, hit.barycentric, direction);
        met = met.or(Some(surface.position));
        let seen = shading.terms(&surface, hash2(scramble, bounce), -direction);
        let mirror = geometry.brdf(&surface).specular.filter(|s| {
            bounce < depth
                && s.alpha < BLURRED_ALPHA
                && frame.reflectors.of(surface.triangle) != NO_REFLECTOR
                && geometry.is_lit(&surface)
        });
        let Some(mirror) = mirror else {
            radiance += throughput * (seen.all_but_wide() + seen.wide);
            break;
        };
        radiance += throughput * seen.all_but_wide();
        throughput *= mirror.reflectance(-direction.dot(surface.geometric_normal));
        origin = offset_origin(surface.position, surface.geometric_normal);
        direction -= 2.0 * surface.geometric_normal.dot(direction) * surface.geometric_normal;
    }
    (radiance, met)
}

/// Whether the mirror image of a reflector shows a point, at the pixel where it would or at one beside it.
fn is_shown(frame: &GlossyFrame, reflector: u32, point: Vec3) -> bool {
    let image = frame.image;
    let from_eye = frame.reflectors.list[reflector as usize].mirror_point(point) - frame.lens.eye.position;
    if from_eye.dot(frame.lens.eye.forward) <= 0.0 {
        return false;
    }
    let at = (frame.lens.place(from_eye) - frame.lens.subpixel + 0.5).floor().as_ivec2();
    let distance = from_eye.length();
    let shows = |x: i32, y: i32| {
        if x < 0 || y < 0 || x >= image.width as i32 || y >= image.height as i32 {
            return false;
        }
        let i = y as usize * image.width as usize + x as usize;
        let seen = frame.buffer.depth[i] + image.distance[i];
        image.reflector[i] == reflector && (seen - distance).abs() < SAME_DISTANCE * distance
    };
    (-1..=1).any(|dy| (-1..=1).any(|dx| shows(at.x + dx, at.y + dy)))
}
