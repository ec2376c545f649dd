//! Light that leaves a surface of any material: paths that scatter from diffuse parts and specular lobes.
//!
//! At every vertex the emitters are sampled, and a direction is drawn from the material's own
//! distribution; the two are weighted by the balance heuristic (Veach and Guibas 1995). What an ideal
//! mirror sends into its one direction no emitter sample can find, and counts whole. Light of the
//! first vertex is kept apart by the part that reflected it, as the layers of the picture are.
//!
//! Limit: a point or directional lamp has no surface that a mirror's ray could hit. What mirrors throw of
//! it (caustics), and its image in them, is missing here as everywhere in the program.

use super::{
    lights::{LightSample, Selection},
    path::{MAX_BOUNCES, PathTracer, SURE_BOUNCES, receiver_of},
};
use crate::{
    math::random::Rng,
    scene::{accel::Ray, brdf::Brdf, geometry::Surface},
};
use glam::{Vec2, Vec3};

/// One sample of the radiance reflected by a surface, by term, cd/m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflected {
    /// By the Lambertian part, light straight from the emitters.
    pub direct: Vec3,
    /// By the Lambertian part, light that had bounced before.
    pub indirect: Vec3,
    /// By the specular lobe, all light.
    pub specular: Vec3,
    /// Surface points at which light was gathered.
    pub vertices: u32,
}

impl Reflected {
    /// The sum of the terms.
    pub fn total(&self) -> Vec3 {
        self.direct + self.indirect + self.specular
    }
}

impl PathTracer<'_> {
    /// One sample of the radiance that a surface reflects along `wo`, which points away from it.
    pub fn reflected(&self, start: &Surface, wo: Vec3, selection: Selection, rng: &mut Rng) -> Reflected {
        let geometry = &self.world().geometry;
        let (mut surface, mut wo, mut selection) = (*start, wo, selection);
        let mut out = Reflected::default();
        // Of the first vertex's Lambertian part and of its lobe.
        let mut throughput = [Vec3::ONE; 2];
        for bounce in 0..MAX_BOUNCES {
            let brdf = geometry.brdf(&surface);
            if brdf.is_black() {
                break;
            }
            out.vertices += 1;
            let pick = rng.next_f32();
            let mut lights = Rng::new(u64::from(rng.next_u32()), u64::from(rng.next_u32()));
            let vertex = receiver_of(&surface);
            let arrive = |sample: &LightSample| self.arriving(&surface, &brdf, wo, sample);
            let [diffuse, lobe] =
                self.lights().sum(self.world(), &vertex, selection, pick, |_| lights.next_vec2(), arrive);
            if bounce == 0 {
                out.direct += diffuse;
                out.specular += lobe;
            } else {
                out.indirect += throughput[0] * (diffuse + lobe);
                out.specular += throughput[1] * (diffuse + lobe);
            }
            let (part, u) = (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
            let Some(drawn) = brdf.sample(surface.normal, wo, part, u) else { break };
            if surface.geometric_normal.dot(drawn.wi) <= 0.0 {
                break;
            }
            if bounce == 0 {
                throughput = [drawn.diffuse, drawn.specular];
            } else {
                throughput = throughput.map(|t| t * (drawn.diffuse + drawn.specular));
            }
            let left = throughput[0].max(throughput[1]).max_element();
            if bounce >= SURE_BOUNCES {
                let survival = left.min(1.0);
                if rng.next_f32() >= survival {
                    break;
                }
                throughput = throughput.map(|t| t / survival);
            }
            if left == 0.0 {
                break;
            }
            let Some(hit) = self.world().accel.trace(&Ray::new(vertex.origin(), drawn.wi)) else { break };
            let next = geometry.surface(hit.triangle, hit.barycentric, drawn.wi);
            let emission = geometry.emission(&next);
            if emission != Vec3::ZERO {
                let weight = if drawn.density.is_infinite() {
                    1.0
                } else {
                    let light = self.lights().density(self.world(), &next, drawn.wi, hit.t, selection);
                    drawn.density / (drawn.density + light)
                };
                let arriving = emission * weight;
                *(if bounce == 0 { &mut out.direct } else { &mut out.indirect }) += throughput[0] * arriving;
                out.specular += throughput[1] * arriving;
            }
            (surface, wo, selection) = (next, -drawn.wi, Selection::One);
        }
        out
    }

    /// What a sample of an emitter sends along `wo` by the Lambertian part and by the lobe.
    fn arriving(&self, surface: &Surface, brdf: &Brdf, wo: Vec3, sample: &LightSample) -> [Vec3; 2] {
        let cosine = surface.normal.dot(sample.wi);
        if cosine <= 0.0 || surface.geometric_normal.dot(sample.wi) <= 0.0 {
            return [Vec3::ZERO; 2];
        }
        let weight = match sample.density {
            Some(light) => light / (light + brdf.density(surface.normal, sample.wi, wo)),
            None => 1.0,
        };
        let values = brdf.value(surface.normal, sample.wi, wo);
        let light = sample.radiance_over_density * (cosine * weight);
        if values == [Vec3::ZERO; 2] || self.world().accel.occluded(&sample.ray) {
            return [Vec3::ZERO; 2];
        }
        values.map(|f| f * light)
    }
}
