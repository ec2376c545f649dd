//! Light that leaves a surface of any material: paths that scatter from diffuse parts and specular lobes, and go on
//! through glass.
//!
//! At every vertex the emitters are sampled, and a direction is drawn from the material's own
//! distribution; the two are weighted by the balance heuristic (Veach and Guibas 1995). What an ideal
//! mirror sends into its one direction no emitter sample can find, and counts whole. A path carries one
//! throughput a state of an [`Automaton`], so that both parts of a surface go on along one direction and
//! are still told apart. A lamp behind panes of glass is found by emitter samples alone; passing a pane is no event.
//!
//! Limit: a point or directional lamp has no surface that a ray could hit. What one flat mirror throws of it is
//! added at each vertex ([`crate::mirror::thrown`]); by way of two, or of a curved one, it is missing here as
//! everywhere in the program, and so are its image and what a solid of glass would throw of it.

use super::{
    expression::{Automaton, Expression, MOST_STATES},
    lights::Selection,
    path::{MAX_BOUNCES, PathTracer, SURE_BOUNCES},
};
use crate::{
    math::random::Rng,
    scene::{
        accel::Ray,
        brdf::Brdf,
        direct::Receiver,
        geometry::Surface,
        glass::{Glass, Passed, Side},
        light_sample::LightSample,
    },
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

    /// The same, a share of it.
    fn times(&self, share: Vec3) -> Self {
        Self { throughput: self.throughput.map(|t| t * share), ..*self }
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
    /// One sample of the radiance that a surface reflects or lets pass along `wo`, which points away from it, told
    /// apart by an automaton that stands at the eye.
    pub fn reflected(
        &self,
        start: &Surface,
        wo: Vec3,
        selection: Selection,
        automaton: &Automaton,
        rng: &mut Rng,
    ) -> Reflected {
        self.leaving((start, wo), false, selection, automaton, rng)
    }

    /// [`Self::reflected`]; `lit` says whether who looks along `wo` has asked the lamps behind panes himself.
    pub(super) fn leaving(
        &self,
        (start, wo): (&Surface, Vec3),
        mut lit: bool,
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
            let vertex = Receiver::of(&surface);
            let arrive = |sample: &LightSample| self.arriving(&surface, &brdf, wo, sample);
            let sampled =
                self.lights().sum(self.world(), &vertex, selection, pick, |_| lights.next_vec2(), arrive);
            carried.after(sampled).add(Vec3::ONE, &mut out);
            for (wi, light) in self.lamps_in_mirrors(&vertex) {
                let cosine = surface.normal.dot(wi).max(0.0);
                let here = carried.after(brdf.value(surface.normal, wi, wo).map(|f| f * cosine));
                here.after([Vec3::ZERO, Vec3::ONE]).add(light, &mut out);
            }
            let glass = brdf.glass.map(|glass| self.through(&glass, &brdf, &surface, wo));
            let chance = glass.as_ref().map_or(0.0, |g| g.1);
            let (ray, density) = match glass {
                Some((Some(passed), chance)) if rng.next_f32() < chance => {
                    let share = passed.share / chance;
                    let pane = brdf.glass.is_some_and(|g| g.side == Side::Pane);
                    carried = if pane { carried.times(share) } else { carried.after([Vec3::ZERO, share]) };
                    lit &= pane;
                    (passed.ray, None)
                }
                _ => {
                    let (part, u) = (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
                    let Some(drawn) = brdf.sample(surface.normal, wo, part, u) else { break };
                    if surface.geometric_normal.dot(drawn.wi) <= 0.0 {
                        break;
                    }
                    let other = 1.0 / (1.0 - chance);
                    carried = carried.after([drawn.diffuse * other, drawn.specular * other]);
                    lit = drawn.density.is_finite();
                    (Ray::new(vertex.origin(), drawn.wi), Some(drawn.density))
                }
            };
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
            let Some(hit) = self.world().accel.trace(&ray) else { break };
            let next = geometry.surface(hit.triangle, hit.barycentric, ray.direction);
            let emission = geometry.emission(&next);
            if emission != Vec3::ZERO {
                let weight = match density {
                    Some(density) if density.is_finite() => {
                        let light =
                            self.lights().density(self.world(), &next, ray.direction, hit.t, selection);
                        density / (density + light)
                    }
                    Some(_) => 1.0,
                    None => f32::from(u8::from(!lit)),
                };
                carried.add(emission * weight, &mut out);
            }
            (surface, wo, selection) = (next, -ray.direction, Selection::One);
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
        let values = brdf.value(surface.normal, sample.wi, wo);
        if values == [Vec3::ZERO; 2] {
            return values;
        }
        let (share, panes) = self.world().straight(&sample.ray);
        let weight = match sample.density {
            Some(light) if !panes => light / (light + brdf.density(surface.normal, sample.wi, wo)),
            _ => 1.0,
        };
        let light = share * sample.radiance_over_density * (cosine * weight);
        values.map(|f| f * light)
    }

    /// What passes a surface of glass, and the chance with which a path follows that and not what is reflected.
    fn through(&self, glass: &Glass, brdf: &Brdf, surface: &Surface, wo: Vec3) -> (Option<Passed>, f32) {
        let passed = glass.pass(surface, -wo);
        let through = passed.map_or(0.0, |p| p.share.max_element());
        let lobe = brdf.specular.map_or(Vec3::ZERO, |s| s.reflectance(surface.normal.dot(wo)));
        let other = lobe.max_element() + brdf.diffuse.max_element();
        (passed, through / (through + other).max(f32::MIN_POSITIVE))
    }
}
