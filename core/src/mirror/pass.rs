//! What the pixels see in flat mirrors: the specification of the mirrored passes in [`super::gpu`].

use super::{
    MirrorSettings,
    reflectors::{NO_REFLECTOR, Reflectors},
    views::{Eye, MirroredView, mirrored_views},
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
};
use glam::Vec3;
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
    /// Mirrored views the frame needed: a raster pass each on the GPU.
    pub views: usize,
}

/// Follows what every pixel of a G-buffer shows through flat mirrors; `None` where no view is needed.
///
/// Cut off at the reflector, a mirrored view's ray through a pixel is the reflected ray; it is cast from the
/// reflector, where rounding cannot put it on the wrong side.
pub fn mirror_image(
    shading: &Shading,
    reflectors: &Reflectors,
    buffer: &GBuffer,
    camera: &Camera,
    settings: &PassSettings,
) -> Option<MirrorImage> {
    let world = &shading.solution.world;
    let eye = Eye::new(camera, buffer.width as f32 / buffer.height as f32);
    let depth = MirrorSettings::of(&shading.solution.scene.plan).depth;
    let views = mirrored_views(&world.geometry, reflectors, eye, depth);
    if views.is_empty() {
        return None;
    }
    let walk = Walk { shading, reflectors, known: numbered(&views), settings };
    let pixels: Vec<(u32, Vec3, f32)> = (0..buffer.triangle.len())
        .into_par_iter()
        .map(|pixel| {
            let nothing = (NO_REFLECTOR, Vec3::ZERO, f32::INFINITY);
            let Some(surface) = buffer.surface(world, camera, pixel) else { return nothing };
            let Some(view) = walk.view(&surface, 0) else { return nothing };
            let direction = (surface.position - camera.eye).normalize_or_zero();
            let (radiance, distance) = walk.follow(surface, direction, view, pixel as u32);
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
    })
}

/// Number of a view, counted from 1, by the view it is seen in and its reflector.
fn numbered(views: &[MirroredView]) -> HashMap<(u32, u32), u32> {
    views.iter().enumerate().map(|(i, v)| ((v.parent, v.reflector), i as u32 + 1)).collect()
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
    fn follow(&self, mut surface: Surface, mut direction: Vec3, mut view: u32, pixel: u32) -> (Vec3, f32) {
        let geometry = &self.world().geometry;
        let (mut radiance, mut throughput) = (Vec3::ZERO, Vec3::ONE);
        let mut distance = f32::INFINITY;
        for depth in 1.. {
            direction = self.reflectors.list[self.reflectors.of(surface.triangle) as usize]
                .mirror_direction(direction);
            let origin = offset_origin(surface.position, surface.geometric_normal);
            let Some(hit) = self.world().accel.trace(&Ray::new(origin, direction)) else { break };
            if depth == 1 {
                distance = hit.t;
            }
            surface = geometry.surface(hit.triangle, hit.barycentric, direction);
            let scramble = hash2(self.settings.scramble(pixel), depth);
            let next = self.view(&surface, view);
            let seen = self.shading.terms(&surface, scramble, -direction);
            radiance += throughput * (seen.diffuse() + if next.is_none() { seen.wide } else { Vec3::ZERO });
            let Some(next) = next else { break };
            let Some(specular) = geometry.brdf(&surface).specular else { break };
            throughput *= specular.reflectance(-direction.dot(surface.geometric_normal));
            view = next;
        }
        (radiance, distance)
    }
}
