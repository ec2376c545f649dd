//! What specular lobes and glass pass on to dull surfaces: L(D|S)*S D, the ways on which light in a room goes on after
//! it met something polished.
//!
//! A gather ray that meets a lobe goes on by it, a chain of lobes included, until it meets nothing or is given
//! up by roulette. Dull light met there is remembered as an element with a factor a channel, as the volume's
//! rays remember it; a luminous surface met, as a place with a factor. Lobes that are wide or lamps that are
//! small are found the other way round: from the place on the lobe a point of each emitter is asked, and both
//! are weighted by the balance heuristic (Veach and Guibas 1995). Flat ideal mirrors have [`crate::mirror::thrown`]
//! for the light that reaches a dull surface by one of them; lamps straight behind panes of glass are direct light.
//!
//! Limits: a lamp without a surface is missed behind a lobe and a mirror after it. What was traced holds for
//! where the objects stood: of lobes that moved since nothing comes, and of emitters what places on lobes find.

use crate::{
    math::{
        colour::luminance,
        random::{Rng, hash2},
    },
    mirror::thrown::Images,
    scene::{
        accel::{Hit, Ray},
        brdf::Brdf,
        direct::Receiver,
        emitters::Emitter,
        geometry::{Geometry, Surface, offset_origin},
        glass::Side,
        light_sample::LightSample,
        world::World,
    },
};
use glam::{Affine3A, Vec2, Vec3};
use std::{collections::HashMap, f32::consts::PI};

/// Lobes that a ray follows, at most.
const MOST_LOBES: u32 = 32;

/// Share of the light below which a ray goes on by chance, in proportion: what a coat reflects of what falls on it
/// straight. Lamps are small and bright, few rays meet one.
const SURE_SHARE: f32 = 0.04;

/// Share of the light below which a dull element met, or a place on a lobe, is remembered by chance only: there are
/// many of those, and each gives little.
const SURE_TO_REMEMBER: f32 = 0.25;

/// Places on lobes asked for an emitter, about.
pub(super) const PLACES: usize = 1 << 20;

/// The same while something moves.
pub(super) const PLACES_MOVING: usize = 1 << 15;

/// What one element sees by way of lobes.
#[derive(Clone, Debug, Default)]
pub(super) struct Seen {
    /// Elements and what of their radiosity arrives, per ray.
    pub elements: Vec<(u32, Vec3)>,
    emissions: Vec<Emission>,
    places: Vec<Place>,
}

/// A luminous surface met by a lobe's ray.
#[derive(Clone, Copy, Debug)]
struct Emission {
    /// Object of the lobe.
    by: u32,
    triangle: u32,
    uv: Vec2,
    factor: Vec3,
}

/// A place on a lobe.
#[derive(Clone, Copy, Debug)]
struct Place {
    triangle: u32,
    barycentric: Vec2,
    /// Of the ray that met it.
    direction: Vec3,
    factor: Vec3,
}

/// What is needed to follow rays by lobes.
#[derive(Clone, Debug, Default)]
pub(super) struct Lobes {
    images: Images,
    /// Whether anything is specular at all.
    any: bool,
    /// Area of each area emitter by object and material, m².
    areas: HashMap<(u32, u32), f32>,
    /// Where the objects stood.
    placements: Vec<Affine3A>,
}

impl Lobes {
    /// Those of a world.
    pub fn new(world: &World) -> Self {
        let geometry = &world.geometry;
        if !geometry.is_specular() {
            return Self::default();
        }
        let areas = world.emitters.list.iter().filter_map(|emitter| match emitter {
            Emitter::Area(area) => Some((geometry.emitter_of(area.triangles[0]), area.area())),
            Emitter::Lamp { .. } => None,
        });
        let placements = geometry.world_from_object.clone();
        Self { images: Images::new(geometry), any: true, areas: areas.collect(), placements }
    }

    /// Whether anything is specular at all.
    pub fn any(&self) -> bool {
        self.any
    }

    /// Follows a ray that met a surface by its lobe, if it has one. `element` gives the element of a place that a
    /// number in [0, 1) draws, if any.
    pub fn follow(
        &self,
        world: &World,
        (mut hit, mut direction): (Hit, Vec3),
        rng: &mut Rng,
        element: impl Fn(&Hit, Vec3, f32) -> Option<u32>,
        seen: &mut Seen,
    ) {
        let geometry = &world.geometry;
        let mut left = Vec3::ONE;
        // Whether who looks along the ray finds lamps straight on, behind panes too, by himself.
        let mut found = true;
        for bounce in 0..MOST_LOBES {
            let surface = geometry.surface(hit.triangle, hit.barycentric, direction);
            let Some(brdf) = lobe(geometry, &surface) else { return };
            let wo = -direction;
            let reflected = brdf.specular.map_or(Vec3::ZERO, |s| s.reflectance(wo.dot(surface.normal)));
            let glass = brdf.glass.and_then(|g| Some((g.pass(&surface, direction)?, g.side == Side::Pane)));
            let through = glass.map_or(Vec3::ZERO, |(passed, _)| passed.share);
            let expected = left * (reflected + through);
            let survival = (expected.max_element() / SURE_SHARE).min(1.0);
            if rng.next_f32() >= survival {
                return;
            }
            left /= survival;
            let mirror = brdf.specular.is_some_and(|s| s.is_mirror());
            let xi = rng.next_f32();
            let remembered = (expected.max_element() / survival / SURE_TO_REMEMBER).min(1.0);
            if !mirror && xi < remembered {
                let Hit { triangle, barycentric, .. } = hit;
                seen.places.push(Place { triangle, barycentric, direction, factor: left / remembered });
            }
            let chance = through.max_element() / (through + reflected).max_element().max(f32::MIN_POSITIVE);
            let passes = if brdf.glass.is_some() && rng.next_f32() < chance { glass } else { None };
            let (ray, density) = if let Some((passed, pane)) = passes {
                left *= passed.share / chance;
                found &= pane;
                (passed.ray, None)
            } else {
                let Some(drawn) = brdf.sample(surface.normal, wo, 0.0, rng.next_vec2()) else { return };
                if surface.geometric_normal.dot(drawn.wi) <= 0.0 {
                    return;
                }
                left *= drawn.specular / (1.0 - chance);
                found = if mirror { bounce == 0 && self.images.covers(hit.triangle) } else { true };
                let origin = offset_origin(surface.position, surface.geometric_normal);
                (Ray::new(origin, drawn.wi), Some(drawn.density))
            };
            let Some(next) = world.accel.trace(&ray) else { return };
            let met = geometry.surface(next.triangle, next.barycentric, ray.direction);
            if geometry.material_of(next.triangle).emission != Vec3::ZERO && geometry.is_lit(&met) {
                let weight = match density {
                    Some(density) if density.is_finite() => {
                        let cosine = met.geometric_normal.dot(ray.direction).abs();
                        let area =
                            self.areas.get(&geometry.emitter_of(next.triangle)).copied().unwrap_or(0.0);
                        let light = next.t * next.t / (area * cosine);
                        if light.is_finite() { density / (density + light) } else { 1.0 }
                    }
                    _ => f32::from(u8::from(!found)),
                };
                if weight > 0.0 {
                    let (by, factor) = (geometry.object[hit.triangle as usize], left * weight);
                    seen.emissions.push(Emission { by, triangle: next.triangle, uv: met.uv, factor });
                }
            }
            let (xi, remembered) = (rng.next_f32(), (left.max_element() / SURE_TO_REMEMBER).min(1.0));
            let met = if xi < remembered { element(&next, ray.direction, rng.next_f32()) } else { None };
            if let Some(element) = met {
                seen.elements.push((element, left / remembered));
            }
            (hit, direction) = (next, ray.direction);
        }
    }

    /// Whether an object is not where it was when rays were traced.
    fn moved(&self, geometry: &Geometry, object: u32) -> bool {
        self.placements.get(object as usize) != geometry.world_from_object.get(object as usize)
    }

    /// Irradiance of an element from one emitter by way of lobes but for [`Images`], times the number of its rays,
    /// lx per channel; and the sum of the squares of what it is the sum of, in luminance. Every `stride`-th place
    /// is asked, from the `first` on.
    pub fn irradiance(
        &self,
        world: &World,
        emitter: &Emitter,
        seen: &Seen,
        (first, stride): (usize, usize),
        scramble: u32,
    ) -> (Vec3, f32) {
        let geometry = &world.geometry;
        let (mut sum, mut squares, mut moved) = (Vec3::ZERO, 0.0, false);
        let mut add = |light: Vec3| {
            sum += light;
            squares += luminance(light).powi(2);
        };
        if let Emitter::Area(area) = emitter {
            let object = area.object as usize;
            moved = self.moved(geometry, area.object);
            let own = geometry.emitter_of(area.triangles[0]);
            let dimmer = if area.textured { geometry.dimmer[object] } else { 1.0 };
            for emission in &seen.emissions {
                let stands = !moved && !self.moved(geometry, emission.by);
                if stands && geometry.emitter_of(emission.triangle) == own {
                    let material = geometry.material_of(emission.triangle);
                    add(emission.factor
                        * material.emission_at(emission.uv, &geometry.textures)
                        * (dimmer * PI));
                }
            }
        }
        for (i, place) in seen.places.iter().enumerate().skip(first).step_by(stride) {
            if self.moved(geometry, geometry.object[place.triangle as usize]) {
                continue;
            }
            let surface = geometry.surface(place.triangle, place.barycentric, place.direction);
            let Some(brdf) = lobe(geometry, &surface) else { continue };
            let Surface { position, normal, geometric_normal, .. } = surface;
            let receiver = Receiver { position, normal, geometric_normal };
            let mut rng = Rng::new(u64::from(scramble), i as u64);
            let Some(sample) = LightSample::new(world, emitter, &receiver, 1.0, rng.next_vec2()) else {
                continue;
            };
            let (wi, wo) = (sample.wi, -place.direction);
            let [_, value] = brdf.value(normal, wi, wo);
            let light = place.factor * value * sample.radiance_over_density * normal.dot(wi);
            if light == Vec3::ZERO || !light.is_finite() {
                continue;
            }
            let (share, panes) = world.straight(&sample.ray);
            let weight = match sample.density {
                Some(light) if !moved && !panes => light / (light + brdf.density(normal, wi, wo)),
                _ => 1.0,
            };
            if share != Vec3::ZERO {
                add(light * share * (weight * stride as f32 * PI));
            }
        }
        (sum, squares)
    }
}

impl Seen {
    /// Places on lobes.
    pub fn places(&self) -> usize {
        self.places.len()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.elements[..]) + size_of_val(&self.emissions[..]) + size_of_val(&self.places[..])
    }
}

/// What a surface does to light but for its diffuse part.
fn lobe(geometry: &Geometry, surface: &Surface) -> Option<Brdf> {
    let brdf = geometry.brdf(surface);
    brdf.specular?;
    Some(Brdf { diffuse: Vec3::ZERO, ..brdf })
}

/// Place from which every `stride`-th is asked in an element's list: another in each.
pub(super) fn first_of(stride: usize, element: usize, seed: u32) -> usize {
    hash2(element as u32, seed ^ 0x10BE) as usize % stride
}
