//! A picture's mirrors shown from images-with-depth, and from the geometry to hold them against.

use super::{
    MirrorImages,
    layered::LayeredImage,
    reproject::{Reprojected, Splat, reproject},
    sample::{NOTHING, Point},
    select::Selection,
    visible::Sight,
};
use crate::{
    mirror::{
        MirrorSettings,
        culling::Portal,
        reflectors::{NO_REFLECTOR, Reflectors},
        views::{Eye, MirroredView, mirrored_views},
    },
    scene::{
        accel::{Ray, barycentric},
        camera::Camera,
        geometry::{Geometry, Surface, offset_origin},
        world::World,
    },
    superposition::{gbuffer::GBuffer, pass::Shading},
    transport::LightTransportSolution,
};
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;

/// The images that a solution's mirrors are shown from, and how many an element; `None` where they are shown from
/// the geometry: the plan says so, or something stands elsewhere than when they were taken.
pub fn in_use(solution: &LightTransportSolution) -> Option<(&MirrorImages, usize)> {
    let count = MirrorSettings::of(&solution.scene.plan).images?;
    let images = solution.mirror_images.as_deref().filter(|i| i.hold(&solution.world.geometry))?;
    Some((images, count as usize))
}

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
    /// Pixels that are holes.
    pub fn holes(&self) -> usize {
        self.hole.iter().filter(|h| **h).count()
    }

    /// Their share of the mirrors' pixels.
    pub fn hole_share(&self) -> f64 {
        self.holes() as f64 / self.mirrored.max(1) as f64
    }
}

/// What samples show of a surface: emitted and diffuse radiance, for [`super::sample::Radiance`].
pub fn diffuse<'a>(shading: &'a Shading) -> impl Fn(&Surface, Vec3) -> Vec3 + Sync + 'a {
    move |surface, wo| shading.terms(surface, 0, wo).all_but_wide()
}

/// What points show of one view.
struct Splatted {
    /// The pixels that show it.
    mask: Vec<bool>,
    shown: Reprojected,
    points: usize,
}

/// A picture whose mirrors are shown.
pub struct Frame<'a> {
    /// The scene.
    pub world: &'a World,
    /// Its flat reflectors.
    pub reflectors: &'a Reflectors,
    /// Their views from the camera, of depth 1.
    pub views: Vec<MirroredView>,
    /// View of each pixel, counted from 1; 0 for none.
    pub of_pixels: Vec<u32>,
    /// What the pixels see.
    pub buffer: &'a GBuffer,
    camera: &'a Camera,
}

impl<'a> Frame<'a> {
    /// Finds the mirrors that a picture shows.
    pub fn new(
        world: &'a World,
        reflectors: &'a Reflectors,
        buffer: &'a GBuffer,
        camera: &'a Camera,
    ) -> Self {
        let eye = Eye::new(camera, buffer.width as f32 / buffer.height as f32);
        let views = mirrored_views(&world.geometry, reflectors, eye, 1);
        let view_of = |t: &u32| {
            let reflector = reflectors.of(*t);
            let found = views.iter().position(|v| reflector != NO_REFLECTOR && v.reflector == reflector);
            found.map_or(0, |i| i as u32 + 1)
        };
        let of_pixels = buffer.triangle.iter().map(view_of).collect();
        Self { world, reflectors, views, of_pixels, buffer, camera }
    }

    fn size(&self) -> UVec2 {
        UVec2::new(self.buffer.width, self.buffer.height)
    }

    fn mirrored(&self) -> usize {
        self.of_pixels.iter().filter(|v| **v != 0).count()
    }

    /// Shows the mirrors by points.
    pub fn from_points(&self, points: &impl Points, splat: Splat) -> MirrorPicture {
        self.of_splats(&self.splat(points, splat))
    }

    fn of_splats(&self, views: &[Splatted]) -> MirrorPicture {
        let mut picture = MirrorPicture {
            radiance: vec![Vec3::ZERO; self.of_pixels.len()],
            hole: vec![false; self.of_pixels.len()],
            mirrored: self.mirrored(),
            points: views.iter().map(|view| view.points).sum(),
        };
        for Splatted { mask, shown, .. } in views {
            for i in (0..mask.len()).filter(|&i| mask[i]) {
                picture.radiance[i] = shown.radiance[i];
                picture.hole[i] = shown.is_hole(mask, i);
            }
        }
        picture
    }

    /// Shows the mirrors by the triangles of the nearest points: their light is read where the pixel's ray meets them.
    pub fn from_ids(&self, points: &impl Points, shading: &Shading) -> MirrorPicture {
        let views = self.splat(points, Splat::Box);
        let mut picture = self.of_splats(&views);
        for (view, Splatted { mask, shown, .. }) in self.views.iter().zip(&views) {
            let light = |i: usize| {
                let along = self.reflectors.list[view.reflector as usize].mirror_direction(self.direction(i));
                let surface = surface_by_id(&self.world.geometry, &view.eye, shown.triangle[i], along)?;
                Some(diffuse(shading)(&surface, -along))
            };
            let masked = (0..mask.len()).into_par_iter().filter(|&i| mask[i]);
            let read: Vec<(usize, Vec3)> = masked.map(|i| (i, light(i).unwrap_or_default())).collect();
            read.into_iter().for_each(|(i, radiance)| picture.radiance[i] = radiance);
        }
        picture
    }

    fn splat(&self, points: &impl Points, splat: Splat) -> Vec<Splatted> {
        let margin = Portal::margin(self.size().to_array());
        (1u32..)
            .zip(&self.views)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|(number, view)| {
                let mask: Vec<bool> = self.of_pixels.iter().map(|v| *v == number).collect();
                let sight =
                    Sight { eye: &view.eye, portal: &Portal::of_view(view, margin), size: self.size() };
                let points = points.of(self.reflectors, view, &sight);
                let shown = reproject(&points, &view.eye, (self.size(), Vec2::splat(0.5)), &mask, splat);
                Splatted { mask, shown, points: points.len() }
            })
            .collect()
    }

    fn direction(&self, pixel: usize) -> Vec3 {
        (self.buffer.position[pixel] - self.camera.eye).normalize_or_zero()
    }

    /// The same from the geometry: a ray a pixel, what a mirrored view of depth 1 shows.
    pub fn from_geometry(&self, shading: &Shading) -> MirrorPicture {
        let radiance: Vec<Vec3> = (0..self.of_pixels.len())
            .into_par_iter()
            .map(|pixel| {
                let Some(view) = self.of_pixels[pixel].checked_sub(1) else { return Vec3::ZERO };
                let view = &self.views[view as usize];
                let along =
                    self.reflectors.list[view.reflector as usize].mirror_direction(self.direction(pixel));
                let origin = offset_origin(self.buffer.position[pixel], view.clip_normal);
                let Some(hit) = self.world.accel.trace(&Ray::new(origin, along)) else { return Vec3::ZERO };
                let surface = self.world.geometry.surface(hit.triangle, hit.barycentric, along);
                diffuse(shading)(&surface, -along)
            })
            .collect();
        let (mirrored, hole) = (self.mirrored(), vec![false; radiance.len()]);
        MirrorPicture { hole, mirrored, points: 0, radiance }
    }
}

/// The place on a point's triangle that is met along a direction from the mirrored eye; what passes the triangle by,
/// since the point is wider, counts as meeting its edge. `None` for [`NOTHING`].
pub fn surface_by_id(geometry: &Geometry, eye: &Eye, triangle: u32, along: Vec3) -> Option<Surface> {
    (triangle != NOTHING).then(|| {
        let weights = barycentric(&Ray::new(eye.position, along), geometry.positions[triangle as usize]);
        geometry.surface(triangle, weights, along)
    })
}

/// The points that stand for each reflector's mirrored view.
pub trait Points: Sync {
    /// Those that a view may show.
    fn of(&self, reflectors: &Reflectors, view: &MirroredView, sight: &Sight) -> Vec<Point>;
}

/// The nearest samples of every element.
pub struct Nearest<'a> {
    /// Samples of the reflectors.
    pub images: &'a MirrorImages,
    /// What makes one near.
    pub selection: Selection,
    /// Samples an element.
    pub count: usize,
}

impl Points for Nearest<'_> {
    fn of(&self, reflectors: &Reflectors, view: &MirroredView, sight: &Sight) -> Vec<Point> {
        let reflector = &reflectors.list[view.reflector as usize];
        let eye = view.eye.position;
        let Some(set) = self.images.of(reflector, eye) else { return Vec::new() };
        let chosen = self.selection.nearest(set, eye, self.count);
        let of_image = |number: usize| {
            let image = set.image(number);
            sight.runs(image).into_iter().flat_map(|run| run.points(image)).collect::<Vec<_>>()
        };
        chosen.into_par_iter().flat_map_iter(of_image).collect()
    }
}

/// One layered image an element, for each reflector by its first triangle.
pub struct Layered<'a>(pub &'a [(u32, Vec<LayeredImage>)]);

impl Points for Layered<'_> {
    fn of(&self, reflectors: &Reflectors, view: &MirroredView, _: &Sight) -> Vec<Point> {
        let triangle = reflectors.list[view.reflector as usize].triangles[0];
        let sets = self.0.iter().filter(|(t, _)| *t == triangle);
        sets.flat_map(|(_, images)| images).flat_map(|image| image.points.iter().copied()).collect()
    }
}
