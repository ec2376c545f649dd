//! Points of samples seen from a mirrored eye, and the picture made of them (Bastos 1999, §6.6.3, 6.6.4).

use super::sample::{NOTHING, Point};
use crate::mirror::views::Eye;
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;

/// How a point covers pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Splat {
    /// The pixel it falls into (Program 6.14).
    Pixel,
    /// All pixels of a rectangle of the point's size; the nearest point wins (Program 6.15).
    #[default]
    Box,
    /// A Gaussian as wide as the point: the weighted mean of all points at the nearest surface, which the
    /// thesis names as the better reconstruction (§6.8).
    Gaussian,
}

impl Splat {
    /// All.
    pub const ALL: [Self; 3] = [Self::Pixel, Self::Box, Self::Gaussian];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pixel => "pixel",
            Self::Box => "box",
            Self::Gaussian => "gaussian",
        }
    }
}

/// Widest splat, pixels to either side of its middle: what is nearer than that is blurred in any case.
const WIDEST: f32 = 24.0;
/// Points within this share of the nearest one's distance belong to the same surface.
const SAME_SURFACE: f32 = 0.02;
/// Pixels beyond a point's own half width that a Gaussian reaches.
const GAUSSIAN_REACH: f32 = 1.0;

/// A mirrored picture made of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Reprojected {
    /// Radiance that arrives, cd/m²; 0 in holes and outside the mask.
    pub radiance: Vec<Vec3>,
    /// Distance along the view's axis of what is shown, m; infinite in holes.
    pub depth: Vec<f32>,
    /// Triangle of the nearest point, or [`NOTHING`]: in holes too.
    pub triangle: Vec<u32>,
    /// Pixels of the mask that no point covers.
    pub holes: usize,
    /// Pixels of the mask.
    pub masked: usize,
}

impl Reprojected {
    /// Whether a pixel of the mask is a hole.
    pub fn is_hole(&self, mask: &[bool], pixel: usize) -> bool {
        mask[pixel] && self.depth[pixel].is_infinite()
    }
}

/// Where a point lies in a picture, in pixels from the top left, with half its width and height and its
/// distance along the axis, m; `None` behind the eye or out of the picture.
///
/// The sizes are Eq. 6.5 to 6.7 at once: the point's sides, projected. The ratio of the distances, of the
/// resolutions and the turn between the two views are in the projection.
pub fn footprint(eye: &Eye, size: UVec2, point: &Point) -> Option<(Vec2, Vec2, f32)> {
    let away = point.position - eye.position;
    let z = away.dot(eye.forward);
    if z <= 1e-4 {
        return None;
    }
    let pixels = 0.5 * size.as_vec2() / (eye.half_size * z);
    let on_lens = |v: Vec3| Vec2::new(v.dot(eye.right), -v.dot(eye.up));
    let middle = 0.5 * size.as_vec2() + on_lens(away) * pixels;
    // A side's change in depth moves its end sideways too.
    let along = |side: Vec3| (on_lens(side) - on_lens(away) * (side.dot(eye.forward) / z)).abs() * pixels;
    let half = (0.5 * (along(point.sides[0]) + along(point.sides[1]))).min(Vec2::splat(WIDEST));
    // A pixel more: pixels may be looked through elsewhere than in their middles.
    let reach = half + 1.0;
    let outside = (middle + reach).cmplt(Vec2::ZERO).any() || (middle - reach).cmpge(size.as_vec2()).any();
    (!outside && middle.is_finite()).then_some((middle, half, z))
}

/// Shows points from a mirrored eye in the pixels of a mask; `size` is the picture's, and `subpixel` the place in
/// the pixels that the eye looks through. Of equally near points the first shows.
///
/// [`Splat::Box`] has a twin in `shaders/mirror/splat.wgsl`.
///
/// # Panics
/// If the mask is not as large as the picture.
pub fn reproject(
    points: &[Point],
    eye: &Eye,
    (size, subpixel): (UVec2, Vec2),
    mask: &[bool],
    splat: Splat,
) -> Reprojected {
    assert_eq!(mask.len(), (size.x * size.y) as usize, "a flag a pixel");
    let mut picture = Reprojected {
        radiance: vec![Vec3::ZERO; mask.len()],
        depth: vec![f32::INFINITY; mask.len()],
        triangle: vec![NOTHING; mask.len()],
        holes: 0,
        masked: mask.iter().filter(|m| **m).count(),
    };
    let placed: Vec<(Vec2, Vec2, f32, &Point)> = points
        .par_iter()
        .filter_map(|p| {
            footprint(eye, size, p).map(|(middle, half, z)| (middle + 0.5 - subpixel, half, z, p))
        })
        .collect();
    for &(middle, half, z, point) in &placed {
        let half = if splat == Splat::Pixel { Vec2::ZERO } else { half };
        covered(middle, half, size, |pixel, _| {
            if mask[pixel] && z < picture.depth[pixel] {
                (picture.depth[pixel], picture.triangle[pixel]) = (z, point.triangle);
                picture.radiance[pixel] = point.colour;
            }
        });
    }
    if splat == Splat::Gaussian {
        let mut sum = vec![(Vec3::ZERO, 0.0f32); mask.len()];
        for &(middle, half, z, point) in &placed {
            let sigma = 0.5 * half.max(Vec2::splat(0.5));
            covered(middle, half + GAUSSIAN_REACH, size, |pixel, off| {
                if z <= picture.depth[pixel] * (1.0 + SAME_SURFACE) && picture.depth[pixel].is_finite() {
                    let weight = (-0.5 * (off / sigma).length_squared()).exp();
                    sum[pixel].0 += point.colour * weight;
                    sum[pixel].1 += weight;
                }
            });
        }
        for (radiance, (total, weight)) in picture.radiance.iter_mut().zip(sum) {
            if weight > 1e-6 {
                *radiance = total / weight;
            }
        }
    }
    picture.holes = (0..mask.len()).filter(|&i| mask[i] && picture.depth[i].is_infinite()).count();
    picture
}

/// Visits the pixels whose middles lie in a rectangle, and the one that holds its middle, with the offset of
/// each from the middle.
fn covered(middle: Vec2, half: Vec2, size: UVec2, mut visit: impl FnMut(usize, Vec2)) {
    let own = middle.floor();
    let low = (middle - half - 0.5).ceil().min(own).max(Vec2::ZERO);
    let high = (middle + half - 0.5).floor().max(own).min(size.as_vec2() - 1.0);
    let (low, high) = (low.as_ivec2(), high.as_ivec2());
    for y in low.y..=high.y {
        for x in low.x..=high.x {
            let off = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - middle;
            visit((y as u32 * size.x + x as u32) as usize, off);
        }
    }
}
