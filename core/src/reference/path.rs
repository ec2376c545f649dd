//! One path: a sample of the irradiance at a receiver, direct and indirect apart.
//!
//! With Lambertian surfaces the light transport equation closes over irradiance,
//! E(x) = E_direct(x) + ∫ ρ(y)/π E(y) cos θ dω, and a cosine-distributed direction turns the
//! integral into E_indirect(x) ≈ ρ(y) E(y): the throughput of a path is the product of the
//! reflectances it meets. Cosines refer to the shading normal; directions below the geometric
//! horizon carry nothing, as in [`crate::scene::direct`]. Where a scene has specular lobes, what the
//! second vertex reflects is a sample of [`super::scatter`] instead.

use super::{
    expression::Automaton,
    lights::{LightSampler, Selection},
};
use crate::{
    math::{
        frame::{cosine_direction, frame_from_normal},
        part::Part,
        random::Rng,
    },
    mirror::thrown::Images,
    scene::{accel::Ray, direct::Receiver, emitters::Emitter, geometry::Surface, world::World},
};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// Paths end here at the latest; at reflectance 0.999 what is cut off is 4.5e-5 of the light.
pub const MAX_BOUNCES: u32 = 10_000;

/// Bounces before Russian roulette begins.
pub(super) const SURE_BOUNCES: u32 = 3;

/// Irradiance of one path, lx.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Incident {
    /// Straight from the emitters.
    pub direct: Vec3,
    /// After at least one bounce.
    pub indirect: Vec3,
    /// Surface points at which light was gathered, the receiver included.
    pub vertices: u32,
}

/// Random numbers of a path's first vertex; the later ones come from a stream.
#[derive(Clone, Copy, Debug)]
pub struct FirstVertex<F> {
    /// Position on the square that the cosine-distributed direction comes from.
    pub direction: Vec2,
    /// Position on the n-th emitter.
    pub light: F,
}

/// A world with what paths through it need.
#[derive(Clone, Debug)]
pub struct PathTracer<'a> {
    world: WorldRef<'a>,
    lights: LightSampler,
    /// Whether anything in it has a specular lobe.
    specular: bool,
    /// Its flat ideal mirrors: a lamp without a surface is found in them by no ray.
    images: Images,
    terms: Automaton,
}

#[derive(Clone, Copy)]
struct WorldRef<'a>(&'a World);

impl std::fmt::Debug for WorldRef<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "World of {} triangles", self.0.geometry.len())
    }
}

/// Radiance of one camera path by term, cd/m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// Emitted by the surface seen, panes of glass before it or not.
    pub emitted: Vec3,
    /// Reflected after one bounce.
    pub direct: Vec3,
    /// Reflected after more.
    pub indirect: Vec3,
    /// Reflected by an ideal mirror or bent by glass.
    pub mirror: Vec3,
    /// Reflected by a wider specular lobe.
    pub glossy: Vec3,
    /// Surface points at which light was gathered.
    pub vertices: u32,
}

impl Terms {
    /// Every term in the order of the picture's layers.
    pub fn all(&self) -> [Vec3; 5] {
        [self.emitted, self.direct, self.indirect, self.mirror, self.glossy]
    }

    /// Everything but what the surface emits.
    pub fn reflected(&self) -> Vec3 {
        self.direct + self.indirect + self.mirror + self.glossy
    }
}

impl<'a> PathTracer<'a> {
    /// Prepares a world for paths.
    pub fn new(world: &'a World) -> Self {
        Self {
            world: WorldRef(world),
            lights: LightSampler::new(world),
            specular: world.geometry.is_specular(),
            images: Images::new(&world.geometry),
            terms: Automaton::terms(),
        }
    }

    /// The world.
    pub fn world(&self) -> &'a World {
        self.world.0
    }

    /// Its emitters.
    pub(super) fn lights(&self) -> &LightSampler {
        &self.lights
    }

    /// How the first vertex of a path selects among the emitters.
    pub fn first_selection(&self) -> Selection {
        self.lights.first_selection()
    }

    /// What tells the terms of the picture apart.
    pub(super) fn terms(&self) -> &Automaton {
        &self.terms
    }

    /// Whether anything in the world has a specular lobe.
    pub fn is_specular(&self) -> bool {
        self.specular
    }

    /// The surface a ray meets.
    pub fn surface(&self, ray: &Ray) -> Option<Surface> {
        let hit = self.world().accel.trace(ray)?;
        Some(self.world().geometry.surface(hit.triangle, hit.barycentric, ray.direction))
    }

    /// What lamps without a surface send to a receiver by way of one mirror: direction, and illuminance across it.
    pub(super) fn lamps_in_mirrors<'b>(
        &'b self,
        receiver: &'b Receiver,
    ) -> impl Iterator<Item = (Vec3, Vec3)> + 'b {
        let lamps = self.world().emitters.list.iter().filter_map(|emitter| match emitter {
            Emitter::Lamp { lamp, .. } => Some(lamp),
            Emitter::Area(_) => None,
        });
        lamps.flat_map(|lamp| self.images.of_lamp(self.world(), lamp, receiver))
    }

    /// One sample of the radiance that arrives along a ray, all random numbers from `rng`.
    pub fn radiance(&self, ray: &Ray, rng: &mut Rng) -> Terms {
        let Some(surface) = self.surface(ray) else { return Terms::default() };
        let geometry = &self.world().geometry;
        let emitted = geometry.emission(&surface);
        if self.specular {
            let selection = self.lights.first_selection();
            let found = self.reflected(&surface, -ray.direction, selection, &self.terms, rng);
            let [through_panes, direct, indirect, specular] = found.radiance;
            let emitted = emitted + through_panes;
            let is_mirror = geometry.brdf(&surface).specular.is_some_and(|s| s.is_mirror());
            let (mirror, glossy) = if is_mirror { (specular, Vec3::ZERO) } else { (Vec3::ZERO, specular) };
            return Terms { emitted, direct, indirect, mirror, glossy, vertices: found.vertices };
        }
        let reflectance = geometry.reflectance(&surface).min(Vec3::ONE);
        if reflectance == Vec3::ZERO {
            return Terms { emitted, ..Terms::default() };
        }
        let incident = self.incident_random(&Receiver::of(&surface), Part::All, rng);
        Terms {
            emitted,
            direct: reflectance * FRAC_1_PI * incident.direct,
            indirect: reflectance * FRAC_1_PI * incident.indirect,
            vertices: incident.vertices,
            ..Terms::default()
        }
    }

    /// One sample of the irradiance at a receiver, all random numbers from `rng`.
    pub fn incident_random(&self, receiver: &Receiver, part: Part, rng: &mut Rng) -> Incident {
        let direction = rng.next_vec2();
        let mut lights = Rng::new(u64::from(rng.next_u32()), u64::from(rng.next_u32()));
        self.incident(receiver, part, FirstVertex { direction, light: |_| lights.next_vec2() }, rng)
    }

    /// One sample of the irradiance at a receiver; the part not asked for is left zero.
    pub fn incident<F: FnMut(usize) -> Vec2>(
        &self,
        receiver: &Receiver,
        part: Part,
        mut first: FirstVertex<F>,
        rng: &mut Rng,
    ) -> Incident {
        let world = self.world();
        let mut out = Incident { vertices: 1, ..Incident::default() };
        let selection = self.lights.first_selection();
        if part != Part::Indirect {
            let pick = rng.next_f32();
            out.direct = self.lights.sample(world, receiver, selection, pick, &mut first.light);
        }
        if part != Part::Direct {
            let e = |(wi, light): (Vec3, Vec3)| light * receiver.normal.dot(wi).max(0.0);
            out.indirect = self.lamps_in_mirrors(receiver).map(e).sum();
        }
        let Some((emission, wi, mut next)) = self.follow(receiver, first.direction, selection) else {
            return out;
        };
        if part != Part::Indirect {
            out.direct += emission;
        }
        if part == Part::Direct {
            return out;
        }
        if self.specular {
            let found = self.leaving((&next, -wi), true, Selection::One, &self.terms, rng);
            out.indirect += found.total() * PI;
            out.vertices += found.vertices;
            return out;
        }
        let mut throughput = Vec3::ONE;
        for bounce in 0..MAX_BOUNCES {
            throughput *= world.geometry.reflectance(&next).min(Vec3::ONE);
            if bounce >= SURE_BOUNCES {
                let survival = throughput.max_element().min(1.0);
                if rng.next_f32() >= survival {
                    break;
                }
                throughput /= survival;
            }
            if throughput == Vec3::ZERO {
                break;
            }
            let vertex = Receiver::of(&next);
            out.vertices += 1;
            let (pick, point) = (rng.next_f32(), rng.next_vec2());
            let sampled = self.lights.sample(world, &vertex, Selection::One, pick, |_| point);
            out.indirect += throughput * sampled;
            let Some((emission, _, surface)) = self.follow(&vertex, rng.next_vec2(), Selection::One) else {
                break;
            };
            out.indirect += throughput * emission;
            next = surface;
        }
        out
    }

    /// Follows a cosine-distributed direction: the emission found, as weighted irradiance π Lₑ w with
    /// the balance heuristic against light sampling, the direction, and the surface.
    fn follow(&self, receiver: &Receiver, u: Vec2, selection: Selection) -> Option<(Vec3, Vec3, Surface)> {
        let world = self.world();
        let local = cosine_direction(u);
        let wi = frame_from_normal(receiver.normal) * local;
        if receiver.geometric_normal.dot(wi) <= 0.0 {
            return None;
        }
        let hit = world.accel.trace(&Ray::new(receiver.origin(), wi))?;
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, wi);
        let radiance = world.geometry.emission(&surface);
        if radiance == Vec3::ZERO {
            return Some((Vec3::ZERO, wi, surface));
        }
        let cosine_density = local.z * FRAC_1_PI;
        let light_density = self.lights.density(world, &surface, wi, hit.t, selection);
        let total = cosine_density + light_density;
        let weight = if total > 0.0 { cosine_density / total } else { 0.0 };
        Some((radiance * (PI * weight), wi, surface))
    }
}
