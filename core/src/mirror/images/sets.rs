//! The images of reflectors, and how much memory they may take.

use super::{
    elements::{Elements, LEAST_RESOLUTION, SampleSettings, extent},
    sample::{ImageWithDepth, Radiance, Surroundings},
};
use crate::{
    math::progress::{Cancelled, Progress},
    mirror::reflectors::{Reflector, Reflectors},
    scene::{geometry::Geometry, world::World},
};
use glam::{Affine3A, Vec2, Vec3};
use std::sync::Arc;

/// Points that images chosen by themselves have together, at most: 96 MB of them.
const MOST_POINTS: u64 = 12_000_000;

/// Bytes that images asked for by hand may take.
const MOST_BYTES: f64 = 8e9;

/// Bytes of a point with its colour and its share of the boxes.
const BYTES_A_POINT: f64 = 21.0;

/// Why there are no images.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImagesError {
    /// They would take too much memory.
    #[error(
        "{images} images-with-depth of {resolution}×{resolution} pixels take about {gigabytes:.1} GB; at most \
         {most_gigabytes:.1} GB are taken: choose larger elements, fewer images or less resolution"
    )]
    TooLarge {
        /// Images.
        images: u64,
        /// Their width, pixels.
        resolution: u32,
        /// What they take, GB.
        gigabytes: f64,
        /// What they may take, GB.
        most_gigabytes: f64,
    },
    /// Their width is of no use.
    #[error("a resolution of {0} pixels is not a power of two from {LEAST_RESOLUTION} to 1024")]
    Resolution(u32),
    /// The work was cancelled.
    #[error("{0}")]
    Cancelled(#[from] Cancelled),
}

/// The pictures of one side of a reflector, element after element.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflectorImages {
    /// First triangle of the reflector, which stays where others become dull or polished.
    pub triangle: u32,
    /// Whether they show what its back mirrors.
    pub back: bool,
    /// How it was sampled.
    pub settings: SampleSettings,
    /// Pictures of each element: the one that looks straight first. Those that a move leaves as they are stay shared.
    pub elements: Vec<Vec<Arc<ImageWithDepth>>>,
}

impl ReflectorImages {
    /// Samples one side of a reflector.
    pub(super) fn new(around: &Surroundings, Side { reflector, back, settings }: &Side) -> Self {
        let geometry = &around.world.geometry;
        let elements = Elements::new(geometry, reflector, side(reflector, *back), settings.element_m);
        let elements = elements.sample(around, settings);
        Self { triangle: reflector.triangles[0], back: *back, settings: *settings, elements }
    }

    /// Whether they show a side, sampled so.
    pub(super) fn are_of(&self, side: &Side) -> bool {
        (self.triangle, self.back, self.settings) == (side.reflector.triangles[0], side.back, side.settings)
    }

    /// Its pictures.
    pub fn images(&self) -> impl Iterator<Item = &ImageWithDepth> {
        self.elements.iter().flatten().map(|image| &**image)
    }

    /// A picture by its number, counted over all elements.
    pub fn image(&self, number: usize) -> &ImageWithDepth {
        let poses = self.settings.poses as usize;
        &self.elements[number / poses][number % poses]
    }

    /// Reads all colours from a solution of the same geometry.
    pub fn recolour(&mut self, world: &World, radiance: &Radiance) {
        let images = self.elements.iter_mut().flatten();
        images.for_each(|image| Arc::make_mut(image).recolour(world, radiance));
    }

    /// Points of its pictures.
    pub fn points(&self) -> u64 {
        self.images().map(|image| image.triangle.len() as u64).sum()
    }

    /// Bytes of its pictures.
    pub fn bytes(&self) -> usize {
        self.images().map(ImageWithDepth::bytes).sum()
    }
}

fn side(reflector: &Reflector, back: bool) -> Vec3 {
    if back { -reflector.normal } else { reflector.normal }
}

/// The images of a scene's flat reflectors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MirrorImages {
    /// Those of one side of a reflector each, the largest first.
    pub sets: Vec<ReflectorImages>,
    /// Rays that were traced to make them of what there was before: of nothing, one a point.
    pub rays: u64,
    /// How every reflector was to be sampled; `None` for each as its size asks.
    pub(super) asked: Option<SampleSettings>,
    /// Where the objects stood.
    pub(super) placed: Vec<Affine3A>,
    /// Distance of points that are nothing, m.
    pub(super) far_m: f32,
}

impl MirrorImages {
    /// Samples every reflector as its size asks, more coarsely where that were too many points.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn automatic(world: &World, progress: &Progress) -> Result<Self, Cancelled> {
        Self::sample(world, None, progress)
    }

    /// Points of [`Self::automatic`], about: a ray each.
    pub fn automatic_points(geometry: &Geometry) -> u64 {
        sides(geometry, None).iter().map(|side| side.points(geometry)).sum()
    }

    /// Samples every reflector with the same settings.
    ///
    /// # Errors
    /// [`ImagesError`].
    pub fn new(world: &World, settings: &SampleSettings, progress: &Progress) -> Result<Self, ImagesError> {
        let resolution = settings.resolution;
        if !resolution.is_power_of_two() || !(LEAST_RESOLUTION..=1024).contains(&resolution) {
            return Err(ImagesError::Resolution(resolution));
        }
        let sides = sides(&world.geometry, Some(settings));
        // By their boxes first: so many elements could not even be listed.
        let images: u64 =
            sides.iter().map(|s| s.most_elements(&world.geometry) * u64::from(settings.poses)).sum();
        let gigabytes = 1e-9 * BYTES_A_POINT * images as f64 * f64::from(resolution).powi(2);
        let most_gigabytes = 1e-9 * MOST_BYTES;
        if gigabytes > most_gigabytes {
            return Err(ImagesError::TooLarge { images, resolution, gigabytes, most_gigabytes });
        }
        Ok(Self::sample(world, Some(settings), progress)?)
    }

    fn sample(
        world: &World,
        settings: Option<&SampleSettings>,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let nothing = Self { asked: settings.copied(), ..Self::default() };
        Ok(nothing.followed(world, u64::MAX, progress)?.unwrap_or_default())
    }

    /// Whether everything stands where it stood when they were taken.
    pub fn hold(&self, geometry: &Geometry) -> bool {
        self.placed == geometry.world_from_object
    }

    /// The set that shows what a reflector mirrors to an eye behind it, which is the mirrored one.
    pub fn of(&self, reflector: &Reflector, mirrored_eye: Vec3) -> Option<&ReflectorImages> {
        let back = reflector.normal.dot(mirrored_eye) > reflector.offset;
        self.sets.iter().find(|s| s.triangle == reflector.triangles[0] && s.back == back)
    }

    /// Reads all colours from a solution of the same geometry.
    pub fn recolour(&mut self, world: &World, radiance: &Radiance) {
        self.sets.iter_mut().for_each(|set| set.recolour(world, radiance));
    }

    /// Their points.
    pub fn points(&self) -> u64 {
        self.sets.iter().map(ReflectorImages::points).sum()
    }

    /// Bytes of all pictures.
    pub fn bytes(&self) -> usize {
        self.sets.iter().map(ReflectorImages::bytes).sum()
    }
}

/// A side of a reflector that reflects, and how it is sampled.
pub(super) struct Side {
    pub reflector: Reflector,
    pub back: bool,
    pub settings: SampleSettings,
}

/// All sides, sampled as said or as their sizes ask.
pub(super) fn sides(geometry: &Geometry, asked: Option<&SampleSettings>) -> Vec<Side> {
    asked.map_or_else(|| sides_as_asked(geometry), |&settings| sides_with(geometry, |_, _| settings))
}

fn sides_with(geometry: &Geometry, settings: impl Fn(&Reflector, Vec3) -> SampleSettings) -> Vec<Side> {
    let mut sides = Vec::new();
    for reflector in Reflectors::new(geometry).list {
        for back in [false, true].into_iter().take(1 + usize::from(reflector.double_sided)) {
            let settings = settings(&reflector, side(&reflector, back));
            sides.push(Side { reflector: reflector.clone(), back, settings });
        }
    }
    sides
}

/// All sides with settings for their sizes, coarser where the points would be too many.
fn sides_as_asked(geometry: &Geometry) -> Vec<Side> {
    let mut sides = sides_with(geometry, |reflector, normal| {
        let (_, [low, high]) = extent(geometry, reflector, normal);
        SampleSettings::for_extent(high - low)
    });
    while sides.iter().map(|s| s.points(geometry)).sum::<u64>() > MOST_POINTS {
        let finer = |s: &&mut Side| s.settings.resolution > LEAST_RESOLUTION;
        if sides.iter_mut().filter(finer).map(|s| s.settings.resolution /= 2).count() == 0 {
            sides.pop();
        }
    }
    sides
}

impl Side {
    /// Elements of the box around it.
    fn most_elements(&self, geometry: &Geometry) -> u64 {
        let (_, [low, high]) = extent(geometry, &self.reflector, side(&self.reflector, self.back));
        let count = ((high - low) / self.settings.element_m).ceil().max(Vec2::ONE);
        count.x as u64 * count.y as u64
    }

    /// Points of its images, at most.
    pub(super) fn points(&self, geometry: &Geometry) -> u64 {
        let SampleSettings { poses, resolution, .. } = self.settings;
        self.most_elements(geometry) * u64::from(poses) * u64::from(resolution).pow(2)
    }
}
