//! The layers of one frame on the CPU: the specification of the GPU's shading pass.
//!
//! At each pixel the radiance towards the eye is L = Lₑ + ρ/π · (E_direct + E_indirect) + L_specular:
//! emitted, direct and indirect are the first three layers, and what a specular lobe reflects is one of
//! the other two, from the room [`mirror`](crate::mirror). What is seen through panes of glass stays in its own
//! layers; what a solid of glass bends is specular and goes to the layer `mirror`. Direct light is evaluated at
//! every pixel, for crisp shadows, or read from the radiosity elements while things move; indirect light is always
//! read, bilinearly or as the plan's `lookup` has it.

use super::{
    composite::DirectQuality,
    gbuffer::GBuffer,
    layers::{COUNT, Layer, Layers},
    moved::MovedLight,
};
use crate::{
    glossy::{
        GlossyMethod, particles,
        pass::{GlossyFrame, Lobes, key, lobes},
    },
    math::{
        part::Part,
        random::{fold, hash2, r2_point},
    },
    mirror::{
        pass::mirror_image,
        reflectors::{NO_REFLECTOR, Reflectors},
    },
    scene::{
        camera::Camera,
        direct::{Receiver, total_irradiance},
        geometry::Surface,
        glass::Side,
    },
    transport::LightTransportSolution,
};
use glam::{UVec2, Vec2, Vec3};
use std::{borrow::Cow, f32::consts::FRAC_1_PI};

/// How one frame is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassSettings {
    /// How direct light is evaluated.
    pub direct: DirectQuality,
    /// Number of the frame: frames differ in their shadow rays, and their mean converges.
    pub frame: u32,
    /// Whether frames also differ in the place inside the pixels that they look through.
    pub jitter: bool,
    /// Seed of every random number.
    pub seed: u64,
}

impl Default for PassSettings {
    fn default() -> Self {
        Self { direct: DirectQuality::PerPixel(4), frame: 0, jitter: false, seed: 1 }
    }
}

impl PassSettings {
    /// Place inside every pixel that this frame looks through; the centre without jitter.
    pub fn subpixel(&self) -> Vec2 {
        if self.jitter { r2_point(self.frame, fold(self.seed)) } else { Vec2::splat(0.5) }
    }

    /// Scramble of this frame's shadow rays at a pixel.
    pub fn scramble(&self, pixel: u32) -> u32 {
        hash2(pixel, hash2(self.frame, fold(self.seed)))
    }
}

/// Renders one frame: what each pixel sees, and the layers in cd/m².
///
/// The same arguments give the same bytes at any thread count.
pub fn render(
    solution: &LightTransportSolution,
    camera: &Camera,
    width: u32,
    height: u32,
    settings: &PassSettings,
) -> (GBuffer, Layers) {
    frame(&Shading::new(solution, settings), camera, width, height)
}

/// [`render`], with the light on moved objects made before: it is the same in every frame of a solution.
pub fn render_lit(
    solution: &LightTransportSolution,
    moved: &MovedLight,
    camera: &Camera,
    width: u32,
    height: u32,
    settings: &PassSettings,
) -> (GBuffer, Layers) {
    frame(&Shading::lit(solution, moved, settings), camera, width, height)
}

fn frame(shading: &Shading, camera: &Camera, width: u32, height: u32) -> (GBuffer, Layers) {
    use rayon::prelude::*;
    let (solution, settings) = (shading.solution, &shading.settings);
    let buffer = GBuffer::new(&solution.world, camera, UVec2::new(width, height), settings.subpixel());
    let (mut shaded, bent): (Vec<[Vec3; COUNT]>, Vec<Vec3>) = (0..buffer.triangle.len())
        .into_par_iter()
        .map(|pixel| match buffer.surface(&solution.world, camera, pixel) {
            Some(surface) => {
                let wo = (camera.eye - surface.position).normalize_or(surface.normal);
                let seen = shading.terms(&surface, settings.scramble(pixel as u32), wo);
                let [mirror, glossy] =
                    if seen.is_mirror { [seen.wide, Vec3::ZERO] } else { [Vec3::ZERO, seen.wide] };
                ([seen.emitted, seen.direct, seen.indirect, mirror, glossy], seen.bent)
            }
            None => ([Vec3::ZERO; COUNT], Vec3::ZERO),
        })
        .unzip();
    if shading.specular {
        let reflectors = Reflectors::new(&solution.world.geometry);
        if let Some(image) = mirror_image(shading, &reflectors, &buffer, camera, settings) {
            let lobes = lobes(&solution.world, &reflectors, &Lobes::new());
            let frame =
                GlossyFrame::new(&solution.world, &reflectors, &lobes, &image, &buffer, camera, settings);
            reflect(&frame, shading, camera, &mut shaded);
        }
    }
    if let Some(light) = solution.particle_light() {
        let straight = Some(particles::pass::straight_samples(settings.direct));
        shaded.par_iter_mut().enumerate().for_each(|(pixel, out)| {
            let Some(surface) = buffer.surface(&solution.world, camera, pixel) else { return };
            let (world, scramble) = (&solution.world, settings.scramble(pixel as u32));
            let reflected =
                particles::pass::reflected(world, &light.map, straight, &surface, camera.eye, scramble);
            if let Some(glossy) = reflected {
                out[Layer::Glossy as usize] = glossy;
            }
        });
    }
    for (pixel, bent) in shaded.iter_mut().zip(&bent) {
        pixel[Layer::Mirror as usize] += *bent;
    }
    let mut layers = Layers::new(width, height);
    for (i, image) in layers.images.iter_mut().enumerate() {
        image.pixels = shaded.iter().map(|p| p[i]).collect();
    }
    (buffer, layers)
}

/// Puts what arrives at flat reflectors into their layers: L = F(θ) Lᵢ for a mirror, E(θ) F(θ̄) times the mean
/// over the lobe for a glossy one.
fn reflect(frame: &GlossyFrame, shading: &Shading, camera: &Camera, shaded: &mut [[Vec3; COUNT]]) {
    use rayon::prelude::*;
    let world = &shading.solution.world;
    let method = shading.solution.glossy_of_image();
    let radiance = if frame.lobes.is_empty() { None } else { Some(frame.scattered(method)) };
    let radiance = radiance.as_ref().unwrap_or(&frame.image.radiance);
    let mirrored = |pixel: usize| frame.image.reflector[pixel] != NO_REFLECTOR;
    shaded.par_iter_mut().enumerate().filter(|(pixel, _)| mirrored(*pixel)).for_each(|(pixel, out)| {
        let Some(surface) = frame.buffer.surface(world, camera, pixel) else { return };
        let Some(specular) = world.geometry.brdf(&surface).specular else { return };
        let wo = (camera.eye - surface.position).normalize_or(surface.normal);
        let cos_theta = wo.dot(surface.geometric_normal);
        let (layer, share) = match frame.lobes.get(&key(specular.lobe())) {
            Some(lobe) if method != GlossyMethod::Sharp => {
                (Layer::Glossy, lobe.modulation(&specular, cos_theta))
            }
            _ if specular.is_mirror() => (Layer::Mirror, specular.reflectance(cos_theta)),
            _ => (Layer::Glossy, specular.of_uniform_light(cos_theta)),
        };
        out[layer as usize] = share * radiance[pixel];
    });
}

/// A solution with what shading it needs, for one frame.
pub struct Shading<'a> {
    /// The light.
    pub solution: &'a LightTransportSolution,
    /// Whether anything in it has a specular lobe.
    pub specular: bool,
    moved: Cow<'a, MovedLight>,
    settings: PassSettings,
}

/// Radiance of a surface towards a direction, term by term, cd/m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenTerms {
    /// Emitted.
    pub emitted: Vec3,
    /// Reflected diffusely, straight from the emitters.
    pub direct: Vec3,
    /// Reflected diffusely, after a bounce.
    pub indirect: Vec3,
    /// Reflected by the specular lobe: from the map of what is curved, or as if it were as wide as the hemisphere,
    /// F(θ) E / π. What stands in where nothing finer is known of it.
    pub wide: Vec3,
    /// Whether that lobe is an ideal mirror's.
    pub is_mirror: bool,
    /// Seen through solids of glass, and reflected by a lobe behind any glass.
    pub bent: Vec3,
}

impl SeenTerms {
    /// All but the specular lobe.
    pub fn all_but_wide(&self) -> Vec3 {
        self.emitted + self.direct + self.indirect + self.bent
    }
}

impl<'a> Shading<'a> {
    /// Prepares a solution.
    pub fn new(solution: &'a LightTransportSolution, settings: &PassSettings) -> Self {
        let specular = solution.world.geometry.is_specular();
        let stored_direct = settings.direct == DirectQuality::Elements || specular;
        let moved = Cow::Owned(MovedLight::new(solution, stored_direct));
        Self { solution, specular, moved, settings: *settings }
    }

    /// Prepares a solution whose moved objects' light, both its parts, was made before.
    pub fn lit(solution: &'a LightTransportSolution, moved: &'a MovedLight, settings: &PassSettings) -> Self {
        let specular = solution.world.geometry.is_specular();
        Self { solution, specular, moved: Cow::Borrowed(moved), settings: *settings }
    }

    /// Radiance of a surface towards a unit `wo`, what is seen through it included.
    pub fn terms(&self, surface: &Surface, scramble: u32, wo: Vec3) -> SeenTerms {
        let mut seen = self.own_terms(surface, scramble, wo);
        let world = &self.solution.world;
        if world.glass {
            for (face, behind) in (1..).zip(world.seen_through(*surface, -wo)) {
                let next = self.own_terms(&behind.surface, hash2(scramble, face), -behind.direction);
                seen.bent += behind.share * next.wide;
                if behind.bent {
                    seen.bent += behind.share * next.all_but_wide();
                } else {
                    seen.emitted += behind.share * next.emitted;
                    seen.direct += behind.share * next.direct;
                    seen.indirect += behind.share * next.indirect;
                }
            }
        }
        seen
    }

    /// Of the surface by itself.
    fn own_terms(&self, surface: &Surface, scramble: u32, wo: Vec3) -> SeenTerms {
        let (solution, settings) = (self.solution, &self.settings);
        let geometry = &solution.world.geometry;
        let emitted = geometry.emission(surface);
        let brdf = geometry.brdf(surface);
        if brdf.is_black() {
            return SeenTerms { emitted, ..SeenTerms::default() };
        }
        let stored = |part: Part| {
            self.moved
                .irradiance(solution, surface.triangle, surface.barycentric, surface.back, part)
                .unwrap_or_else(|| {
                    let Surface { triangle, barycentric, back, .. } = *surface;
                    solution.radiosity.shown(triangle, barycentric, back, part, solution.lookup())
                })
        };
        let object = geometry.object[surface.triangle as usize];
        let (wide, is_mirror) = brdf.specular.map_or((Vec3::ZERO, false), |s| {
            if s.side == Side::Inside {
                return (Vec3::ZERO, s.is_mirror());
            }
            if let Some(map) = solution.environments.number(surface.triangle) {
                let map = &solution.environments.list[map as usize];
                return (map.reflected(surface.position, surface.normal, wo, &s), s.is_mirror());
            }
            let all = stored(Part::Direct) + stored(Part::Indirect);
            (s.of_uniform_light(wo.dot(surface.normal)) * FRAC_1_PI * all, s.is_mirror())
        });
        if brdf.diffuse == Vec3::ZERO {
            return SeenTerms { emitted, wide, is_mirror, ..SeenTerms::default() };
        }
        let share = brdf.diffuse * FRAC_1_PI;
        let direct = match settings.direct {
            DirectQuality::Elements => stored(Part::Direct),
            DirectQuality::PerPixel(_) if self.moved.stored_direct.contains(&object) => stored(Part::Direct),
            DirectQuality::PerPixel(samples) => {
                total_irradiance(&solution.world, &Receiver::of(surface), samples, scramble)
            }
        };
        let indirect = share * stored(Part::Indirect);
        SeenTerms { emitted, direct: share * direct, indirect, wide, is_mirror, ..SeenTerms::default() }
    }
}
