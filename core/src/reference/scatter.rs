//! Light that leaves a surface of any material: paths that scatter from diffuse parts and specular lobes.
//!
//! At every vertex the emitters are sampled, and a direction is drawn from the material's own
//! distribution; the two are weighted by the balance heuristic (Veach and Guibas 1995). What an ideal
//! mirror sends into its one direction no emitter sample can find, and counts whole. A path carries one
//! throughput a state of an [`Automaton`], so that both parts of a surface go on along one direction and
//! are still told apart.
//!
//! Limit: a point or directional lamp has no surface that a ray could hit. What one flat mirror throws of it is
//! added at each vertex ([`crate::mirror::thrown`]); by way of two, or of a curved one, it is missing here as
//! everywhere in the program, and so is its image.

use super::{
    expression::{Automaton, Expression, MOST_STATES},
    lights::Selection,
    path::{MAX_BOUNCES, PathTracer, SURE_BOUNCES, receiver_of},
};
use crate::{
    math::random::Rng,
    scene::{accel::Ray, brdf::Brdf, geometry::Surface, light_sample::LightSample},
};
use glam::{Vec2, Vec3};

/// Outputs that light may count to, see [`Automaton`].
const OUTPUTS: usize = 4;

/// One sample of the radiance that a surface reflects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflected {
    /// By output of the automaton, cd/m²: for [`Automaton::terms`] emitted (nothing), direct, indirect, specular.
    pub radiance: [Vec3; OUTPUTS],
    /// Surface points at which light was gathered.
    pub vertices: u32,
}

impl Reflected {
    /// The sum of the outputs.
    pub fn total(&self) -> Vec3 {
        self.radiance.iter().sum()
    }
}

/// What paths carry in each state of an automaton.
struct Carried<'a> {
    automaton: &'a Automaton,
    throughput: [Vec3; MOST_STATES],
}

impl Carried<'_> {
    /// Adds light that was met after the path as it is.
    fn add(&self, light: Vec3, out: &mut Reflected) {
        for (output, throughput) in self.automaton.counts_as.iter().zip(&self.throughput) {
            if let Some(output) = output {
                out.radiance[*output as usize] += *throughput * light;
            }
        }
    }

    /// One more surface, with what its Lambertian part and its lobe pass on.
    fn after(&self, parts: [Vec3; 2]) -> Self {
        let mut throughput = [Vec3::ZERO; MOST_STATES];
        for (next, carried) in self.automaton.next.iter().zip(&self.throughput) {
            for (next, part) in next.iter().zip(parts) {
                if let Some(next) = next {
                    throughput[*next as usize] += *carried * part;
                }
            }
        }
        Self { throughput, ..*self }
    }

    fn largest(&self) -> f32 {
        self.throughput.iter().fold(0.0, |largest, t| largest.max(t.max_element()))
    }
}

impl PathTracer<'_> {
    /// One sample of the radiance that a surface reflects along `wo`, which points away from it, told apart
    /// by an automaton that stands at the eye.
    pub fn reflected(
        &self,
        start: &Surface,
        wo: Vec3,
        selection: Selection,
        automaton: &Automaton,
        rng: &mut Rng,
    ) -> Reflected {
        let geometry = &self.world().geometry;
        let (mut surface, mut wo, mut selection) = (*start, wo, selection);
        let mut out = Reflected::default();
        let mut carried = Carried { automaton, throughput: [Vec3::ZERO; MOST_STATES] };
        carried.throughput[0] = Vec3::ONE;
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
            let sampled =
                self.lights().sum(self.world(), &vertex, selection, pick, |_| lights.next_vec2(), arrive);
            carried.after(sampled).add(Vec3::ONE, &mut out);
            for (wi, light) in self.lamps_in_mirrors(&vertex) {
                let cosine = surface.normal.dot(wi).max(0.0);
                let here = carried.after(brdf.value(surface.normal, wi, wo).map(|f| f * cosine));
                here.after([Vec3::ZERO, Vec3::ONE]).add(light, &mut out);
            }
            let (part, u) = (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
            let Some(drawn) = brdf.sample(surface.normal, wo, part, u) else { break };
            if surface.geometric_normal.dot(drawn.wi) <= 0.0 {
                break;
            }
            carried = carried.after([drawn.diffuse, drawn.specular]);
            let left = carried.largest();
            if bounce >= SURE_BOUNCES {
                let survival = left.min(1.0);
                if rng.next_f32() >= survival {
                    break;
                }
                carried.throughput.iter_mut().for_each(|t| *t /= survival);
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
                carried.add(emission * weight, &mut out);
            }
            (surface, wo, selection) = (next, -drawn.wi, Selection::One);
        }
        out
    }

    /// One sample of the radiance that arrives along a ray by the paths of an expression, cd/m².
    pub fn radiance_by(&self, ray: &Ray, expression: &Expression, rng: &mut Rng) -> Vec3 {
        let Some(surface) = self.surface(ray) else { return Vec3::ZERO };
        let automaton = expression.automaton();
        let found = self.reflected(&surface, -ray.direction, self.first_selection(), automaton, rng);
        let seen = automaton.counts_as[0].map_or(Vec3::ZERO, |_| self.world().geometry.emission(&surface));
        seen + found.total()
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
