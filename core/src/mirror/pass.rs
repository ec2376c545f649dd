//! What the pixels see in flat mirrors: the specification of the mirrored passes in [`super::gpu`].

use super::{
    MirrorSettings,
    culling::Portal,
    images::{
        Reprojected, Selection, Splat,
        pass::{Nearest, Points, in_use, surface_by_id},
        reproject,
        visible::Sight,
    },
    reflectors::{NO_REFLECTOR, Reflector, Reflectors},
    views::{Eye, MirroredView, mirrored_views_of},
};
use crate::{
    math::random::hash2,
    scene::{
        accel::Ray,
        camera::Camera,
        geometry::{Surface, offset_origin},
        world::World,
    },
    superposition::{
        gbuffer::GBuffer,
        pass::{PassSettings, Shading},
    },
    transport::LightTransportSolution,
};
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// What arrives along the mirrored direction at each pixel that shows a flat reflector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MirrorImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Reflector of each pixel, or [`NO_REFLECTOR`].
    pub reflector: Vec<u32>,
    /// Radiance that arrives, cd/m² per channel, before the reflectance; 0 where nothing is seen.
    pub radiance: Vec<Vec3>,
    /// Distance from the reflector to what is seen in it, m; infinite where nothing is.
    pub distance: Vec<f32>,
    /// Mirrored views the frame needed: a raster pass each on the GPU, unless images-with-depth stand for it.
    pub views: usize,
    /// Pixels that show a mirror of which no image-with-depth has seen what is in it; they have no reflector.
    pub holes: usize,
}

/// Follows what every pixel of a G-buffer shows through flat mirrors; `None` where no view is needed.
///
/// Cut off at the reflector, a mirrored view's ray through a pixel is the reflected ray; it is cast from the
/// reflector, where rounding cannot put it on the wrong side. Where the plan has images-with-depth, what a ray meets
/// first is what they have seen.
pub fn mirror_image(
    shading: &Shading,
    reflectors: &Reflectors,
    buffer: &GBuffer,
    camera: &Camera,
    settings: &PassSettings,
) -> Option<MirrorImage> {
    let world = &shading.solution.world;
    let eye = Eye::new(camera, buffer.width as f32 / buffer.height as f32);
    let views = views_of(shading.solution, reflectors, eye);
    if views.is_empty() {
        return None;
    }
    let walk = Walk { shading, reflectors, known: numbered(&views), settings };
    let size = UVec2::new(buffer.width, buffer.height);
    let first: Vec<u32> = (0..buffer.triangle.len())
        .into_par_iter()
        .map(|pixel| {
            let surface = buffer.surface(world, camera, pixel);
            surface.and_then(|s| walk.view(&s, 0)).unwrap_or(0)
        })
        .collect();
    let by_images = in_use(shading.solution).map(|(images, count)| {
        let points = Nearest { images, selection: Selection::Angle, count };
        from_images(&points, reflectors, &views, &first, (size, settings.subpixel()))
    });
    let pixels: Vec<(u32, Vec3, f32)> = (0..buffer.triangle.len())
        .into_par_iter()
        .map(|pixel| {
            let nothing = (NO_REFLECTOR, Vec3::ZERO, f32::INFINITY);
            let Some(surface) = buffer.surface(world, camera, pixel) else { return nothing };
            let Some(number) = first[pixel].checked_sub(1) else { return nothing };
            let view = &views[number as usize];
            let seen = match by_images.as_ref().map(|images| &images[number as usize]) {
                None => First::Traced,
                Some(shown) if shown.depth[pixel].is_infinite() => return nothing,
                Some(shown) => First::Seen(view, shown.triangle[pixel]),
            };
            let direction = (surface.position - camera.eye).normalize_or_zero();
            let (radiance, distance) = walk.follow(surface, direction, (first[pixel], seen), pixel as u32);
            (reflectors.of(surface.triangle), radiance, distance)
        })
        .collect();
    Some(MirrorImage {
        width: buffer.width,
        height: buffer.height,
        reflector: pixels.iter().map(|p| p.0).collect(),
        radiance: pixels.iter().map(|p| p.1).collect(),
        distance: pixels.iter().map(|p| p.2).collect(),
        views: views.len(),
        holes: pixels.iter().zip(&first).filter(|(p, view)| **view != 0 && p.0 == NO_REFLECTOR).count(),
    })
}

/// The mirrored views that a frame of a solution needs: what is glossy has none where particles make it.
pub(super) fn views_of(
    solution: &LightTransportSolution,
    reflectors: &Reflectors,
    eye: Eye,
) -> Vec<MirroredView> {
    let geometry = &solution.world.geometry;
    let by_particles = solution.particle_light().is_some();
    let is_mirror = |r: &Reflector| geometry.materials[r.material as usize].alpha() == Some(0.0);
    let depth = MirrorSettings::of(&solution.scene.plan).depth;
    mirrored_views_of(geometry, reflectors, eye, depth, |r| !by_particles || is_mirror(r))
}

/// What images-with-depth show in each view of depth 1.
fn from_images(
    points: &Nearest,
    reflectors: &Reflectors,
    views: &[MirroredView],
    of_pixels: &[u32],
    (size, subpixel): (UVec2, Vec2),
) -> Vec<Reprojected> {
    let margin = Portal::margin(size.to_array());
    let first: Vec<(u32, &MirroredView)> = (1..).zip(views).take_while(|(_, v)| v.depth == 1).collect();
    let show = |(number, view): (u32, &MirroredView)| {
        let mask: Vec<bool> = of_pixels.iter().map(|v| *v == number).collect();
        let sight = Sight { eye: &view.eye, portal: &Portal::of_view(view, margin), size };
        reproject(&points.of(reflectors, view, &sight), &view.eye, (size, subpixel), &mask, Splat::Box)
    };
    first.into_par_iter().map(show).collect()
}

/// Number of a view, counted from 1, by the view it is seen in and its reflector.
fn numbered(views: &[MirroredView]) -> HashMap<(u32, u32), u32> {
    views.iter().enumerate().map(|(i, v)| ((v.parent, v.reflector), i as u32 + 1)).collect()
}

/// How it is known what a mirrored ray meets first.
#[derive(Clone, Copy)]
enum First<'a> {
    /// By a ray.
    Traced,
    /// By the triangle that an image-with-depth has seen, in this view.
    Seen(&'a MirroredView, u32),
}

struct Walk<'a> {
    shading: &'a Shading<'a>,
    reflectors: &'a Reflectors,
    known: HashMap<(u32, u32), u32>,
    settings: &'a PassSettings,
}

impl Walk<'_> {
    fn world(&self) -> &World {
        &self.shading.solution.world
    }

    /// The view that shows what a surface mirrors, if it is a flat reflector that has one.
    fn view(&self, surface: &Surface, seen_in: u32) -> Option<u32> {
        let reflector = self.reflectors.of(surface.triangle);
        if reflector == NO_REFLECTOR || !self.world().geometry.is_lit(surface) {
            return None;
        }
        self.known.get(&(seen_in, reflector)).copied()
    }

    /// Radiance that arrives at a surface along the mirrored direction, and from how far.
    fn follow(
        &self,
        mut surface: Surface,
        mut direction: Vec3,
        (mut view, first): (u32, First),
        pixel: u32,
    ) -> (Vec3, f32) {
        let geometry = &self.world().geometry;
        let (mut radiance, mut throughput) = (Vec3::ZERO, Vec3::ONE);
        let mut distance = f32::INFINITY;
        for depth in 1.. {
            direction = self.reflectors.list[self.reflectors.of(surface.triangle) as usize]
                .mirror_direction(direction);
            let met = match first {
                First::Seen(seen_in, triangle) if depth == 1 => {
                    surface_by_id(geometry, &seen_in.eye, triangle, direction).map(|met| {
                        let height = seen_in.clip_normal.dot(met.position) - seen_in.clip_offset;
                        let along = seen_in.clip_normal.dot(direction).max(1e-6);
                        (met, (height / along).max(0.0))
                    })
                }
                _ => {
                    let origin = offset_origin(surface.position, surface.geometric_normal);
                    let hit = self.world().accel.trace(&Ray::new(origin, direction));
                    hit.map(|hit| (geometry.surface(hit.triangle, hit.barycentric, direction), hit.t))
                }
            };
            let Some((met, away)) = met else { break };
            if depth == 1 {
                distance = away;
            }
            surface = met;
            let scramble = hash2(self.settings.scramble(pixel), depth);
            let next = self.view(&surface, view);
            let seen = self.shading.terms(&surface, scramble, -direction);
            radiance +=
                throughput * (seen.all_but_wide() + if next.is_none() { seen.wide } else { Vec3::ZERO });
            let Some(next) = next else { break };
            let Some(specular) = geometry.brdf(&surface).specular else { break };
            throughput *= specular.reflectance(-direction.dot(surface.geometric_normal));
            view = next;
        }
        (radiance, distance)
    }
}
