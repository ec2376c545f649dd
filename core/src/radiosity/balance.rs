//! Where the light of a solution goes: what arrives on surfaces and what they absorb.
//!
//! Summed over points spread on every triangle, where light can reach them: what stands on a floor or hangs on a
//! wall covers a part of it, seldom along the lines of a grid, and light that is looked up there arrives
//! nowhere. The solver itself gathers and so never multiplies by an area.

use super::{RadiositySolution, footprint::points_of, lookup::SideMap, solve::weighted_sum};
use crate::{
    math::{
        colour::luminance,
        frame::{cosine_direction, frame_from_normal},
        part::Part,
        random::r2_point,
    },
    scene::{
        accel::{Hit, Ray},
        direct::Receiver,
        geometry::Surface,
        world::World,
    },
};
use glam::{DVec3, Vec3};

/// Height in spacings below which what is over a point lies upon it: a narrower gap is dark but for its edge.
const UPON_SPACINGS: f32 = 1.0 / 128.0;

/// Light on the surfaces of a scene, in luminance-weighted lumen.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct EnergyBalance {
    /// Flux that arrives straight from the emitters, lm.
    pub direct_flux: f64,
    /// Flux that arrives after bounces, lm.
    pub indirect_flux: f64,
    /// Flux absorbed by the surfaces, lm; in a closed scene equal to `direct_flux` up to sampling noise and what is
    /// lost where the light of elements is looked up. What a specular lobe passes on counts as absorbed by it and
    /// again where it arrives.
    pub absorbed_flux: f64,
}

impl RadiositySolution {
    /// Where the light goes, with things standing as they do in `world`.
    pub fn energy(&self, world: &World) -> EnergyBalance {
        let (sides, geometry) = (self.sides(), &world.geometry);
        let of_side = |number: usize| {
            let (side, t) = (&sides[number], number as u32 / 2);
            if *side == SideMap::NONE || t as usize >= geometry.len() {
                return DVec3::ZERO;
            }
            let points = points_of(side, 1.0);
            let share = f64::from(0.5 * geometry.area_normal(t).length()) / points.len() as f64;
            let towards = geometry.area_normal(t) * if number % 2 == 1 { 1.0 } else { -1.0 };
            let light = points.into_iter().map(|barycentric| {
                let surface = geometry.surface(t, barycentric, towards);
                if is_covered(world, &surface, self.transport().map.spacing_m) {
                    return DVec3::ZERO;
                }
                let [direct, indirect] = [Part::Direct, Part::Indirect]
                    .map(|part| self.irradiance(t, barycentric, surface.back, part));
                let absorbed = (Vec3::ONE - geometry.reflectance(&surface)) * (direct + indirect);
                DVec3::from([direct, indirect, absorbed].map(|light| f64::from(luminance(light))))
            });
            light.sum::<DVec3>() * share
        };
        let [direct_flux, indirect_flux, absorbed_flux] =
            weighted_sum(&vec![1.0; sides.len()], of_side).to_array();
        EnergyBalance { direct_flux, indirect_flux, absorbed_flux }
    }
}

/// Whether something dull lies upon a surface, or it lies inside a solid.
fn is_covered(world: &World, surface: &Surface, spacing_m: f32) -> bool {
    let ray = Ray::new(Receiver::of(surface).origin(), surface.geometric_normal);
    let Some(hit) = world.accel.trace(&ray) else { return false };
    if world.geometry.material_of(hit.triangle).is_glass() {
        return false;
    }
    hit.t < UPON_SPACINGS * spacing_m || (is_black(world, &hit, &ray) && is_inside(world, &ray))
}

fn is_black(world: &World, hit: &Hit, ray: &Ray) -> bool {
    let single = !world.geometry.material_of(hit.triangle).double_sided;
    single && world.geometry.area_normal(hit.triangle).dot(ray.direction) > 0.0
}

/// Whether nearly all that the start of a ray along the normal sees are black backs: beneath the top of a desk that is
/// a single sheet it sees the room beside them.
fn is_inside(world: &World, normal: &Ray) -> bool {
    const RAYS: u32 = 32;
    let frame = frame_from_normal(normal.direction);
    let meets_black = |j: &u32| {
        let ray = Ray::new(normal.origin, frame * cosine_direction(r2_point(*j, 0)));
        world.accel.trace(&ray).is_some_and(|hit| is_black(world, &hit, &ray))
    };
    100 * (0..RAYS).filter(meets_black).count() > 85 * RAYS as usize
}
