//! How reflectors are cut into elements and sampled, and how much memory that may take (Bastos 1999, §6.6.1).

use super::{
    sample::{ImageWithDepth, Radiance},
    visible::LEAF,
};
use crate::{
    math::progress::{Cancelled, Progress},
    mirror::{
        reflectors::{Reflector, Reflectors},
        views::above,
    },
    scene::{geometry::Geometry, world::World},
};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::TAU;

/// How a reflector is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleSettings {
    /// Longest side of an element, m.
    pub element_m: f32,
    /// Centres of projection on each hemisphere.
    pub poses: u32,
    /// Radius of the hemispheres, m: about how far from the reflector one stands.
    pub radius_m: f32,
    /// Width and height of a picture, pixels; a power of two, at least [`LEAST_RESOLUTION`].
    pub resolution: u32,
}

impl Default for SampleSettings {
    /// Elements of 1.5 m with twelve pictures of 128 × 128 each.
    fn default() -> Self {
        Self { element_m: 1.5, poses: 12, radius_m: 1.6, resolution: 128 }
    }
}

/// Least width of a picture, pixels: a leaf of its quadtree.
pub const LEAST_RESOLUTION: u32 = LEAF.isqrt();

/// Elements of a reflector, about, at most, and images of all of them together: as in Bastos 1999, Table 6.1, a
/// reflector of few elements has many images each.
const MOST_ELEMENTS: f32 = 12.0;
const IMAGES_A_REFLECTOR: u32 = 144;
const LEAST_POSES: u32 = 12;
const MOST_POSES: u32 = 24;

/// Width of a pixel on the reflector that is asked for, m.
const PITCH_M: f32 = 0.012;

/// Points that images chosen by themselves have together, at most: 96 MB of them.
const MOST_POINTS: u64 = 12_000_000;

/// Bytes that images asked for by hand may take.
const MOST_BYTES: f64 = 8e9;

/// Bytes of a point with its colour and its share of the boxes.
const BYTES_A_POINT: f64 = 21.0;

impl SampleSettings {
    /// Settings for a reflector of an extent: elements of 1.5 m or some more, as fine on each.
    fn for_extent(extent: Vec2) -> Self {
        let usual = Self::default();
        let element_m = (extent.element_product() / MOST_ELEMENTS).sqrt().max(usual.element_m);
        let elements = (extent / element_m).ceil().max(Vec2::ONE);
        let side = (extent / elements).max_element();
        let resolution = ((side / PITCH_M) as u32).clamp(4 * LEAST_RESOLUTION, usual.resolution);
        Self {
            element_m,
            poses: (IMAGES_A_REFLECTOR / elements.element_product() as u32).clamp(LEAST_POSES, MOST_POSES),
            radius_m: usual.radius_m,
            resolution: resolution.next_power_of_two(),
        }
    }
}

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

/// The elements of one side of a reflector.
struct Elements {
    /// Corner and edges of each, m.
    windows: Vec<[Vec3; 3]>,
    across: Vec3,
    up: Vec3,
    /// Unit normal of the side.
    normal: Vec3,
}

/// Directions along a reflector's side, and its box along them.
fn extent(geometry: &Geometry, reflector: &Reflector, normal: Vec3) -> ([Vec3; 2], [Vec2; 2]) {
    let (across, up) = axes(normal);
    let corners = reflector.triangles.iter().flat_map(|&t| geometry.positions[t as usize]);
    let places = corners.map(|p| Vec2::new(p.dot(across), p.dot(up)));
    let empty = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    let (low, high) = places.fold(empty, |(low, high), p| (low.min(p), high.max(p)));
    ([across, up], [low, high])
}

impl Elements {
    /// Cuts a side into elements of at most `element_m`; those that hold nothing of it are left out.
    fn new(geometry: &Geometry, reflector: &Reflector, normal: Vec3, element_m: f32) -> Self {
        let ([across, up], [low, high]) = extent(geometry, reflector, normal);
        let count = ((high - low) / element_m).ceil().max(Vec2::ONE);
        let size = (high - low) / count;
        let base = reflector.normal * reflector.offset;
        let cells =
            (0..count.y as u32).flat_map(|j| (0..count.x as u32).map(move |i| Vec2::new(i as f32, j as f32)));
        let windows = cells.map(|cell| low + size * cell).filter(|&at| {
            reflector.triangles.iter().any(|&t| {
                let mut part = geometry.positions[t as usize].to_vec();
                for (axis, low, high) in [(across, at.x, at.x + size.x), (up, at.y, at.y + size.y)] {
                    part = above(&above(&part, axis, low), -axis, -high);
                }
                part.len() > 2
            })
        });
        let windows =
            windows.map(|at| [base + across * at.x + up * at.y, across * size.x, up * size.y]).collect();
        Self { windows, across, up, normal }
    }

    fn sample(&self, world: &World, settings: &SampleSettings) -> Vec<Vec<ImageWithDepth>> {
        let pictures = |window: &[Vec3; 3]| {
            let middle = window[0] + 0.5 * (window[1] + window[2]);
            let poses = (0..settings.poses).map(|pose| {
                let out = pose_direction(pose, settings.poses);
                let away = self.across * out.x + self.up * out.y - self.normal * out.z;
                ImageWithDepth::new(world, middle + settings.radius_m * away, *window, settings.resolution)
            });
            poses.collect()
        };
        self.windows.iter().map(pictures).collect()
    }
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
        let geometry = &world.geometry;
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
        Self::sample(world, &sides, progress)
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

/// Unit directions along a plane.
fn axes(normal: Vec3) -> (Vec3, Vec3) {
    let along = if normal.y.abs() > 0.9 {
        (Vec3::X - normal * normal.x).normalize()
    } else {
        Vec3::Y.cross(normal).normalize()
    };
    (along, normal.cross(along))
}

/// Directions spread evenly over a hemisphere about +z, the first straight up, none flatter than
/// [`LEAST_COSINE`].
fn pose_direction(i: u32, count: u32) -> Vec3 {
    let z = 1.0 - (1.0 - LEAST_COSINE) * i as f32 / count.max(1) as f32;
    let (sin, cos) = (0.618_034 * TAU * i as f32).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(radius * cos, radius * sin, z)
}

/// Least cosine between a pose and the normal: what is seen at grazing angles has to be seen by a sample too.
const LEAST_COSINE: f32 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{frame::uniform_direction, random::Rng};

    #[test]
    fn the_axes_of_a_plane_are_a_frame_however_it_is_tilted() {
        for i in 0..1000 {
            let normal = uniform_direction(Rng::new(1, i).next_vec2());
            let (along, up) = axes(normal);
            assert!(along.is_normalized() && up.is_normalized(), "{normal}");
            assert!(along.dot(normal).abs() < 1e-5 && (along.cross(up) - normal).length() < 1e-5, "{normal}");
        }
    }

    #[test]
    fn large_reflectors_have_many_elements_and_small_ones_many_images() {
        let floor = SampleSettings::for_extent(Vec2::new(6.0, 4.5));
        assert_eq!((floor.element_m, floor.poses, floor.resolution), (1.5, 12, 128));
        let bench = SampleSettings::for_extent(Vec2::new(0.4, 0.3));
        assert_eq!((bench.poses, bench.resolution), (24, 32));
        let square = SampleSettings::for_extent(Vec2::splat(3000.0));
        assert!(square.element_m > 800.0 && square.poses == 12);
    }
}
