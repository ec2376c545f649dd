//! The images of reflectors, and how much memory they may take.

use super::{
    elements::{Elements, LEAST_RESOLUTION, SampleSettings, extent},
    sample::{ImageWithDepth, Radiance},
};
use crate::{
    math::progress::{Cancelled, Progress},
    mirror::reflectors::{Reflector, Reflectors},
    scene::{geometry::Geometry, world::World},
};
use glam::{Affine3A, Vec2, Vec3};

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
    /// Pictures of each element: the one that looks straight first.
    pub elements: Vec<Vec<ImageWithDepth>>,
}

impl ReflectorImages {
    /// Samples one side of a reflector.
    pub fn new(world: &World, reflector: &Reflector, back: bool, settings: &SampleSettings) -> Self {
        let elements = Elements::new(&world.geometry, reflector, side(reflector, back), settings.element_m);
        let elements = elements.sample(world, settings);
        Self { triangle: reflector.triangles[0], back, settings: *settings, elements }
    }

    /// Its pictures.
    pub fn images(&self) -> impl Iterator<Item = &ImageWithDepth> {
        self.elements.iter().flatten()
    }

    /// A picture by its number, counted over all elements.
    pub fn image(&self, number: usize) -> &ImageWithDepth {
        let poses = self.settings.poses as usize;
        &self.elements[number / poses][number % poses]
    }

    /// Reads all colours from a solution of the same geometry.
    pub fn recolour(&mut self, world: &World, radiance: &Radiance) {
        self.elements.iter_mut().flatten().for_each(|image| image.recolour(world, radiance));
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
    /// Where the objects stood.
    placed: Vec<Affine3A>,
}

impl MirrorImages {
    /// Samples every reflector as its size asks, more coarsely where that were too many points.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn automatic(world: &World, progress: &Progress) -> Result<Self, Cancelled> {
        Self::sample(world, &sides_as_asked(&world.geometry), progress)
    }

    /// Points of [`Self::automatic`], about: a ray each.
    pub fn automatic_points(geometry: &Geometry) -> u64 {
        sides_as_asked(geometry).iter().map(|side| side.points(geometry)).sum()
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
        let sides = sides(&world.geometry, |_, _| *settings);
        // By their boxes first: so many elements could not even be listed.
        let images: u64 =
            sides.iter().map(|s| s.most_elements(&world.geometry) * u64::from(settings.poses)).sum();
        let gigabytes = 1e-9 * BYTES_A_POINT * images as f64 * f64::from(resolution).powi(2);
        let most_gigabytes = 1e-9 * MOST_BYTES;
        if gigabytes > most_gigabytes {
            return Err(ImagesError::TooLarge { images, resolution, gigabytes, most_gigabytes });
        }
        Ok(Self::sample(world, &sides, progress)?)
    }

    fn sample(world: &World, sides: &[Side], progress: &Progress) -> Result<Self, Cancelled> {
        progress.begin("mirror images");
        let mut sets = Vec::new();
        for (i, side) in sides.iter().enumerate() {
            progress.report(i as f32 / sides.len() as f32)?;
            sets.push(ReflectorImages::new(world, &side.reflector, side.back, &side.settings));
        }
        progress.report(1.0)?;
        Ok(Self { sets, placed: world.geometry.world_from_object.clone() })
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

    /// Bytes of all pictures.
    pub fn bytes(&self) -> usize {
        self.sets.iter().map(ReflectorImages::bytes).sum()
    }
}

/// A side of a reflector that reflects, and how it is sampled.
struct Side {
    reflector: Reflector,
    back: bool,
    settings: SampleSettings,
}

fn sides(geometry: &Geometry, settings: impl Fn(&Reflector, Vec3) -> SampleSettings) -> Vec<Side> {
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
    let mut sides = sides(geometry, |reflector, normal| {
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
    fn points(&self, geometry: &Geometry) -> u64 {
        let SampleSettings { poses, resolution, .. } = self.settings;
        self.most_elements(geometry) * u64::from(poses) * u64::from(resolution).pow(2)
    }
}
