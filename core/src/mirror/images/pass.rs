//! A picture's mirrors shown from images-with-depth, and from the geometry to hold them against.

use super::{
    reproject::{Splat, reproject},
    sample::{ImageWithDepth, Point, ReflectorImages},
    select::Selection,
};
use crate::{
    mirror::{
        reflectors::{NO_REFLECTOR, Reflectors},
        views::Eye,
    },
    scene::{
        accel::Ray,
        camera::Camera,
        geometry::{Surface, offset_origin},
    },
    superposition::{gbuffer::GBuffer, pass::Shading},
};
use glam::{UVec2, Vec3};
use rayon::prelude::*;

/// What arrives at the mirrors of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct MirrorPicture {
    /// Emitted and diffuse radiance, cd/m²; 0 where no mirror is.
    pub radiance: Vec<Vec3>,
    /// Whether no point covers a pixel that shows a mirror.
    pub hole: Vec<bool>,
    /// Pixels that show a mirror.
    pub mirrored: usize,
    /// Points that were put into the picture.
    pub points: usize,
}

impl MirrorPicture {
    /// Share of the mirrors' pixels that are holes.
    pub fn hole_share(&self) -> f64 {
        self.hole.iter().filter(|h| **h).count() as f64 / self.mirrored.max(1) as f64
    }
}

/// What samples show of a surface: emitted and diffuse radiance, for [`super::sample::Radiance`].
pub fn diffuse<'a>(shading: &'a Shading) -> impl Fn(&Surface, Vec3) -> Vec3 + Sync + 'a {
    move |surface, wo| shading.terms(surface, 0, wo).diffuse()
}

/// Reflector of each pixel that shows the lit side of one, or [`NO_REFLECTOR`].
pub fn reflector_of_pixels(reflectors: &Reflectors, buffer: &GBuffer, eye: Vec3) -> Vec<u32> {
    let seen = buffer.triangle.iter().map(|&t| reflectors.of(t));
    let faces = |r: u32| reflectors.list[r as usize].facing(eye).is_some();
    seen.map(|r| if r != NO_REFLECTOR && faces(r) { r } else { NO_REFLECTOR }).collect()
}

/// The points that stand for each reflector's mirrored view.
pub trait Points: Sync {
    /// Those of a reflector for a mirrored eye.
    fn of(&self, reflector: u32, eye: Vec3) -> Vec<Point>;
}

/// The nearest samples of every element.
pub struct Nearest<'a> {
    /// Samples of the reflectors.
    pub sets: &'a [ReflectorImages],
    /// What makes one near.
    pub selection: Selection,
    /// Samples an element.
    pub count: usize,
}

impl Points for Nearest<'_> {
    fn of(&self, reflector: u32, eye: Vec3) -> Vec<Point> {
        let sets = self.sets.iter().filter(|set| set.reflector == reflector);
        let chosen = sets.flat_map(|set| self.selection.nearest(set, eye, self.count));
        chosen.flat_map(ImageWithDepth::points).collect()
    }
}

/// One layered image an element.
pub struct Layered<'a>(pub &'a [(u32, Vec<super::LayeredImage>)]);

impl Points for Layered<'_> {
    fn of(&self, reflector: u32, _: Vec3) -> Vec<Point> {
        let sets = self.0.iter().filter(|(r, _)| *r == reflector);
        sets.flat_map(|(_, images)| images).flat_map(|image| image.points.iter().copied()).collect()
    }
}

/// Shows the mirrors of a picture by points.
pub fn from_points(
    points: &impl Points,
    reflectors: &Reflectors,
    of_pixels: &[u32],
    (camera, size): (&Camera, UVec2),
    splat: Splat,
) -> MirrorPicture {
    let eye = Eye::new(camera, size.x as f32 / size.y as f32);
    let mut picture = MirrorPicture {
        radiance: vec![Vec3::ZERO; of_pixels.len()],
        hole: vec![false; of_pixels.len()],
        mirrored: of_pixels.iter().filter(|r| **r != NO_REFLECTOR).count(),
        points: 0,
    };
    let shown: Vec<(Vec<bool>, super::Reprojected, usize)> = (0..reflectors.list.len() as u32)
        .into_par_iter()
        .filter_map(|number| {
            let mask: Vec<bool> = of_pixels.iter().map(|r| *r == number).collect();
            if !mask.contains(&true) {
                return None;
            }
            let mirrored = eye.mirrored(&reflectors.list[number as usize]);
            let points = points.of(number, mirrored.position);
            let shown = reproject(&points, &mirrored, size, &mask, splat);
            Some((mask, shown, points.len()))
        })
        .collect();
    for (mask, shown, points) in shown {
        picture.points += points;
        for i in (0..mask.len()).filter(|&i| mask[i]) {
            picture.radiance[i] = shown.radiance[i];
            picture.hole[i] = shown.is_hole(&mask, i);
        }
    }
    picture
}

/// The same from the geometry: a ray a pixel, what a mirrored view of depth 1 shows.
pub fn from_geometry(
    shading: &Shading,
    reflectors: &Reflectors,
    of_pixels: &[u32],
    buffer: &GBuffer,
    camera: &Camera,
) -> MirrorPicture {
    let world = &shading.solution.world;
    let radiance: Vec<Vec3> = (0..of_pixels.len())
        .into_par_iter()
        .map(|pixel| {
            let Some(reflector) = reflectors.list.get(of_pixels[pixel] as usize) else { return Vec3::ZERO };
            let position = buffer.position[pixel];
            let along = reflector.mirror_direction((position - camera.eye).normalize_or_zero());
            let normal = reflector.facing(camera.eye).unwrap_or(reflector.normal);
            let Some(hit) = world.accel.trace(&Ray::new(offset_origin(position, normal), along)) else {
                return Vec3::ZERO;
            };
            let surface = world.geometry.surface(hit.triangle, hit.barycentric, along);
            diffuse(shading)(&surface, -along)
        })
        .collect();
    MirrorPicture {
        hole: vec![false; radiance.len()],
        mirrored: of_pixels.iter().filter(|r| **r != NO_REFLECTOR).count(),
        points: 0,
        radiance,
    }
}
