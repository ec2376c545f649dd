//! What a solution says of a point of a surface.

use super::{
    RadiositySolution,
    lookup::{self, Lookup},
};
use crate::{
    math::{part::Part, random::hash2},
    scene::{
        direct::{Receiver, total_irradiance},
        geometry::Surface,
        world::World,
    },
};
use glam::{Vec2, Vec3};

impl RadiositySolution {
    /// Irradiance at barycentric weights of a triangle, on its front or back, lx per channel.
    ///
    /// Zero on the black back of a single-sided surface.
    pub fn irradiance(&self, triangle: u32, barycentric: Vec2, back: bool, part: Part) -> Vec3 {
        let blend = self.transport.map.blend(triangle, barycentric, back);
        match part {
            Part::Direct => blend.sum(&self.direct),
            Part::Indirect => blend.sum(&self.indirect),
            Part::All => blend.sum(&self.direct) + blend.sum(&self.indirect),
        }
    }

    /// [`Self::irradiance`] as a picture looks it up; each part is cut off at zero.
    pub fn shown(&self, triangle: u32, barycentric: Vec2, back: bool, part: Part, lookup: Lookup) -> Vec3 {
        let side = match lookup {
            Lookup::Bilinear => None,
            Lookup::Mitchell => self.sides().get(2 * triangle as usize + usize::from(back)),
        };
        let Some(side) = side else { return self.irradiance(triangle, barycentric, back, part) };
        let of = |values| lookup::mitchell(side, barycentric, self.elements(), values);
        match part {
            Part::Direct => of([&self.direct])[0],
            Part::Indirect => of([&self.indirect])[0],
            Part::All => lookup::mitchell(side, barycentric, self.elements(), [&self.direct, &self.indirect])
                .into_iter()
                .sum(),
        }
    }

    /// Irradiance at a point with the direct light evaluated there by `shadow_rays` rays an
    /// emitter, and only the indirect from elements, lx per channel: what the picture shows.
    pub fn irradiance_exact_direct(
        &self,
        world: &World,
        surface: &Surface,
        part: Part,
        shadow_rays: u32,
        scramble: u32,
    ) -> Vec3 {
        if !world.geometry.is_lit(surface) {
            return Vec3::ZERO;
        }
        let indirect =
            || self.irradiance(surface.triangle, surface.barycentric, surface.back, Part::Indirect);
        let direct = || {
            let receiver = Receiver {
                position: surface.position,
                normal: surface.normal,
                geometric_normal: surface.geometric_normal,
            };
            total_irradiance(world, &receiver, shadow_rays, hash2(scramble, surface.triangle))
        };
        match part {
            Part::Direct => direct(),
            Part::Indirect => indirect(),
            Part::All => direct() + indirect(),
        }
    }

    /// Radiance reflected by a surface towards any direction on its side, ρE/π, cd/m² per channel;
    /// what the surface emits is not in it.
    pub fn radiance(&self, world: &World, surface: &Surface, part: Part) -> Vec3 {
        let e = self.irradiance(surface.triangle, surface.barycentric, surface.back, part);
        world.geometry.reflectance(surface) * e * std::f32::consts::FRAC_1_PI
    }

    /// The element nearest to a point of a triangle's side, or [`lookup::NO_ELEMENTS`].
    pub fn element_at(&self, triangle: u32, barycentric: Vec2, back: bool) -> u32 {
        self.transport.map.blend(triangle, barycentric, back).nearest()
    }
}
