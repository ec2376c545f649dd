//! Picking: what lies under the cursor, in numbers.

use crate::grid_view::SurfacePoint;
use glam::{Vec2, Vec3};
use lumenscope_core::{
    inspection::InspectionScene,
    irradiance_volume::lighting::Lighting,
    math::{colour::luminance, part::Part},
    scene::{
        Target,
        accel::Ray,
        direct::{Receiver, total_irradiance},
        geometry::Surface,
        world::World,
    },
    superposition::{gbuffer::first_visible, overlay::ray_sphere},
    transport::LightTransportSolution,
};
use std::f32::consts::FRAC_1_PI;

/// Shadow rays an emitter of a pick's read-out.
const PICK_SAMPLES: u32 = 256;

/// How far off a surface its spheres are opened, m.
pub const PROBE_OFFSET: f32 = 0.02;

/// Everything known about the point under a click.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    /// Position, m.
    pub position: Vec3,
    /// Interpolated normal on the side seen.
    pub normal: Vec3,
    /// Triangle number in the scene's geometry.
    pub triangle: u32,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec2,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Whether the back is seen.
    pub back: bool,
    /// The object.
    pub target: Target,
    /// Whether the object may be dragged.
    pub movable: bool,
    /// Name of the object.
    pub object: String,
    /// Name of the material.
    pub material: String,
    /// Reflectance of the side seen, per channel.
    pub reflectance: Vec3,
    /// Radiance towards the eye by layer (emitted, direct, indirect), cd/m² per channel.
    pub radiance: [Vec3; 3],
    /// Direct irradiance, lx per channel.
    pub irradiance_direct: Vec3,
    /// Indirect irradiance, lx per channel.
    pub irradiance_indirect: Vec3,
    /// Luminance towards the eye, all layers with weight 1, cd/m².
    pub luminance: f32,
    /// The samples of the volume that would light an object standing here; `None` without a volume.
    pub lighting: Option<Lighting>,
}

/// What a glance at the point under the cursor says, cheap enough for every frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glance {
    /// The surface.
    pub surface: Surface,
    /// Distance from the eye, m.
    pub distance: f32,
    /// Luminance towards the eye, cd/m².
    pub luminance: f32,
    /// Illuminance, lx.
    pub illuminance: f32,
}

impl Pick {
    /// Reads everything at a surface point.
    pub fn at(solution: &LightTransportSolution, surface: &Surface) -> Self {
        let geometry = &solution.world.geometry;
        let object = geometry.object[surface.triangle as usize] as usize;
        let receiver = Receiver {
            position: surface.position,
            normal: surface.normal,
            geometric_normal: surface.geometric_normal,
        };
        let lit = geometry.is_lit(surface);
        let direct = if lit {
            total_irradiance(&solution.world, &receiver, PICK_SAMPLES, surface.triangle)
        } else {
            Vec3::ZERO
        };
        let indirect = if lit { stored(solution, surface, Part::Indirect) } else { Vec3::ZERO };
        let reflectance = geometry.reflectance(surface);
        let brdf = reflectance * FRAC_1_PI;
        let radiance = [geometry.emission(surface), brdf * direct, brdf * indirect];
        Self {
            position: surface.position,
            normal: surface.normal,
            triangle: surface.triangle,
            barycentric: surface.barycentric,
            uv: surface.uv,
            back: surface.back,
            target: Target::Object(object),
            movable: geometry.movable[object],
            object: solution.scene.objects.get(object).map(|o| o.name.clone()).unwrap_or_default(),
            material: geometry.material_of(surface.triangle).name.clone(),
            reflectance,
            radiance,
            irradiance_direct: direct,
            irradiance_indirect: indirect,
            luminance: luminance(radiance.iter().sum()),
            lighting: solution
                .volume
                .as_ref()
                .map(|v| v.lighting(surface.position, surface.normal, Part::All)),
        }
    }

    /// The same point of the same scene in another light; `None` if the scene is another.
    pub fn again(
        &self,
        before: Option<&LightTransportSolution>,
        solution: &LightTransportSolution,
    ) -> Option<Self> {
        let geometry = &solution.world.geometry;
        let same = before
            .is_some_and(|b| b.scene.name == solution.scene.name && b.world.geometry.len() == geometry.len());
        if !same || self.triangle as usize >= geometry.len() {
            return None;
        }
        let into_surface = geometry.area_normal(self.triangle) * if self.back { 1.0 } else { -1.0 };
        let surface = geometry.surface(self.triangle, self.barycentric, into_surface);
        Some(Self::at(solution, &surface))
    }

    /// Radiance towards the eye, all layers with weight 1, cd/m² per channel.
    pub fn total_radiance(&self) -> Vec3 {
        self.radiance.iter().sum()
    }

    /// Where the spheres of this point are opened, and its normal.
    pub fn probe(&self) -> (Vec3, Vec3) {
        (self.position + self.normal * PROBE_OFFSET, self.normal)
    }

    /// Where that is on its triangle.
    pub fn surface(&self) -> SurfacePoint {
        SurfacePoint { triangle: self.triangle, barycentric: self.barycentric, back: self.back }
    }
}

impl Glance {
    /// Looks along a ray; direct light comes from the stored elements.
    pub fn along(solution: &LightTransportSolution, ray: &Ray) -> Option<Self> {
        let (surface, distance) = first_surface(&solution.world, ray)?;
        let geometry = &solution.world.geometry;
        let irradiance =
            if geometry.is_lit(&surface) { stored(solution, &surface, Part::All) } else { Vec3::ZERO };
        let radiance = geometry.emission(&surface) + geometry.reflectance(&surface) * irradiance * FRAC_1_PI;
        Some(Self { surface, distance, luminance: luminance(radiance), illuminance: luminance(irradiance) })
    }
}

/// First surface along a ray that the picture shows, and its distance in lengths of the ray's direction.
pub fn first_surface(world: &World, ray: &Ray) -> Option<(Surface, f32)> {
    let hit = first_visible(world, ray.origin, ray.direction)?;
    Some((world.geometry.surface(hit.triangle, hit.barycentric, ray.direction), hit.t))
}

/// Nearest sphere of an inspection scene along a ray of unit direction: its index and distance, m.
pub fn first_sphere(inspection: &InspectionScene, ray: &Ray) -> Option<(usize, f32)> {
    inspection
        .spheres
        .iter()
        .enumerate()
        .filter_map(|(i, s)| Some((i, ray_sphere(ray.origin, ray.direction, s.centre, s.radius)?)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Irradiance as the picture has it: from the radiosity elements, or the volume on a moved object.
fn stored(solution: &LightTransportSolution, surface: &Surface, part: Part) -> Vec3 {
    let object = solution.world.geometry.object[surface.triangle as usize];
    let guest = solution.guests.iter().find(|g| g.object == object);
    if guest.is_some() || solution.moved_objects.contains(&object) {
        let Some(volume) = guest.map(|g| &g.volume).or(solution.volume.as_ref()) else { return Vec3::ZERO };
        let first = solution.world.geometry.object_triangles[object as usize].start;
        let known = guest.map(|g| &*g.known).or(solution.dynamic_objects.get(&object));
        let open = known
            .map_or(1.0, |known| known.open_at(surface.triangle - first, surface.barycentric, surface.back));
        let shown = |p| part != p && !matches!(guest, Some(g) if g.part == p);
        let of = |part| volume.irradiance(surface.position, surface.normal, part);
        let direct = if shown(Part::Indirect) { of(Part::Direct) } else { Vec3::ZERO };
        let indirect = if shown(Part::Direct) { of(Part::Indirect) * open } else { Vec3::ZERO };
        return direct + indirect;
    }
    let Surface { triangle, barycentric, back, .. } = *surface;
    solution.radiosity.shown(triangle, barycentric, back, part, solution.lookup())
}
