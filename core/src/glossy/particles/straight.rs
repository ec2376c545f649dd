//! Straight light in a lobe, evaluated at the point: the "optimised rendering" of Bastos 1999, §7.3.2.1.
//!
//! L = ∫ f Lₑ V cos θ dω over the emitters. Lamps without a surface are sums. For area emitters places on them and
//! directions of the lobe are both drawn, as many of each, and weighted by the balance heuristic (Veach 1997,
//! Eq. 9.2): narrow lobes find a large lamp by their own directions, wide ones a small lamp by its area. Unbiased.
//!
//! The same points for the same scramble, on both processors: twin of `straight_light` in
//! `shaders/glossy/particles.wgsl`.

use crate::{
    math::random::{hash, r2_point},
    scene::{
        accel::Ray, direct::Receiver, emitters::Emitter, geometry::Surface, light_sample::LightSample,
        world::World,
    },
};
use glam::Vec3;

/// Makes the scramble of the lobe's directions another one than that of the places on lamps.
const LOBE_SCRAMBLE: u32 = 0x51ED_270B;

/// Radiance that the lobe of a glossy surface sends along `wo` of the light that comes straight from the emitters,
/// cd/m²; by so many samples of each emitter and as many of the lobe.
pub fn straight_light(world: &World, surface: &Surface, wo: Vec3, samples: u32, scramble: u32) -> Vec3 {
    let brdf = world.geometry.brdf(surface);
    let Some(specular) = brdf.specular.filter(|s| !s.is_mirror()) else { return Vec3::ZERO };
    let lobe = specular.lobe();
    let (receiver, normal) = (Receiver::of(surface), surface.normal);
    let rises = |wi: Vec3| surface.geometric_normal.dot(wi) > 0.0;
    let value = |wi: Vec3| brdf.value(normal, wi, wo)[1] * normal.dot(wi);
    let samples = samples.max(1);
    let mut sum = Vec3::ZERO;
    for emitter in &world.emitters.list {
        let count = if matches!(emitter, Emitter::Area(_)) { samples } else { 1 };
        for j in 0..count {
            let drawn = LightSample::new(world, emitter, &receiver, 1.0, r2_point(j, scramble));
            let Some(light) = drawn.filter(|light| rises(light.wi)) else { continue };
            let share = light.density.map_or(1.0, |p| p / (p + lobe.density(normal, light.wi, wo)));
            let arriving = value(light.wi) * light.radiance_over_density * (share / count as f32);
            if arriving != Vec3::ZERO && !world.accel.occluded(&light.ray) {
                sum += arriving;
            }
        }
    }
    for j in 0..samples {
        let drawn = lobe.sample(normal, wo, r2_point(j, hash(scramble ^ LOBE_SCRAMBLE)));
        let Some(wi) = drawn.filter(|wi| rises(*wi)) else { continue };
        let Some(hit) = world.accel.trace(&Ray::new(receiver.origin(), wi)) else { continue };
        let met = world.geometry.surface(hit.triangle, hit.barycentric, wi);
        let radiance = world.geometry.emission(&met);
        if radiance != Vec3::ZERO {
            let density = lobe.density(normal, wi, wo) + density_of_places(world, &met, wi, hit.t);
            sum += value(wi) * radiance / (density * samples as f32);
        }
    }
    sum
}

/// Density per solid angle with which places on an emitter propose the direction that meets it at a distance, m.
fn density_of_places(world: &World, met: &Surface, wi: Vec3, distance: f32) -> f32 {
    let geometry = &world.geometry;
    let emitter = geometry.emitter_of(met.triangle);
    let mut areas = world.emitters.list.iter().filter_map(|emitter| match emitter {
        Emitter::Area(area) => Some(area),
        Emitter::Lamp { .. } => None,
    });
    let cosine = met.geometric_normal.dot(wi).abs();
    let own = areas.find(|area| area.triangles.first().is_some_and(|&t| geometry.emitter_of(t) == emitter));
    own.filter(|_| cosine > 0.0).map_or(0.0, |area| distance * distance / (area.area() * cosine))
}
