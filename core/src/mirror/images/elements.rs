//! How a reflector is cut into elements, and where pictures of each are taken from (Bastos 1999, §6.6.1).

use super::{
    sample::{ImageWithDepth, Surroundings},
    visible::LEAF,
};
use crate::{
    mirror::{reflectors::Reflector, views::above},
    scene::geometry::Geometry,
};
use glam::{Vec2, Vec3};
use std::{f32::consts::TAU, sync::Arc};

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

impl SampleSettings {
    /// Settings for a reflector of an extent: elements of 1.5 m or some more, as fine on each.
    pub(super) fn for_extent(extent: Vec2) -> Self {
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

/// The elements of one side of a reflector.
pub(super) struct Elements {
    /// Corner and edges of each, m.
    windows: Vec<[Vec3; 3]>,
    across: Vec3,
    up: Vec3,
    /// Unit normal of the side.
    normal: Vec3,
}

/// Directions along a reflector's side, and its box along them.
pub(super) fn extent(geometry: &Geometry, reflector: &Reflector, normal: Vec3) -> ([Vec3; 2], [Vec2; 2]) {
    let (across, up) = axes(normal);
    let corners = reflector.triangles.iter().flat_map(|&t| geometry.positions[t as usize]);
    let places = corners.map(|p| Vec2::new(p.dot(across), p.dot(up)));
    let empty = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    let (low, high) = places.fold(empty, |(low, high), p| (low.min(p), high.max(p)));
    ([across, up], [low, high])
}

impl Elements {
    /// Cuts a side into elements of at most `element_m`; those that hold nothing of it are left out.
    pub(super) fn new(geometry: &Geometry, reflector: &Reflector, normal: Vec3, element_m: f32) -> Self {
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

    pub(super) fn sample(
        &self,
        around: &Surroundings,
        settings: &SampleSettings,
    ) -> Vec<Vec<Arc<ImageWithDepth>>> {
        let pictures = |window: &[Vec3; 3]| {
            let middle = window[0] + 0.5 * (window[1] + window[2]);
            let poses = (0..settings.poses).map(|pose| {
                let out = pose_direction(pose, settings.poses);
                let away = self.across * out.x + self.up * out.y - self.normal * out.z;
                let eye = middle + settings.radius_m * away;
                Arc::new(ImageWithDepth::new(around, eye, *window, settings.resolution))
            });
            poses.collect()
        };
        self.windows.iter().map(pictures).collect()
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
        let bench = SampleSettings::for_extent(Vec2::new(0.38, 0.3));
        assert_eq!((bench.poses, bench.resolution), (24, 32));
        let square = SampleSettings::for_extent(Vec2::splat(3000.0));
        assert!(square.element_m > 800.0 && square.poses == 12);
    }
}
