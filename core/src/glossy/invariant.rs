//! One kernel for each reflector: spatially invariant convolution (Bastos 1999, §7.4.2.1).
//!
//! The kernel is that of the mean point of the reflector that is seen, with everything as far away as what it
//! mirrors on the mean. Small kernels are summed over pixels. Of larger ones the peak is summed over the finest level
//! of the [`Pyramid`] on which the rest is at most nine texels wide on the next: lobes are peaked, and a tail needs no
//! pixels. Mask and image are convolved alike and divided, so that the reflector's edge darkens nothing.
//!
//! Means, not the pixel of median distance: two pixels equally far may be far apart, and which of them is the
//! middle one is then a matter of rounding.
//!
//! Limits: a reflector narrower than the texels of its level is shown as if it were sharp, as is one that no
//! pixel of those that are measured shows; at a reflector's edge there is nothing to read between, so that the
//! picture is shifted there by up to half a texel of its level; texels are square and as coarse as the length of the
//! footprint allows, so that beyond some 60° it is wider than the lobe, which microfacets make 1 / cos θ times as long as
//! wide: at 75° the step of a light is twice as long as wide instead of four times.

use super::{
    kernel::{GlossyPoint, Lens},
    pyramid::{Level, Pyramid, around},
};
use crate::{math::image::LinearImage, scene::brdf::Lobe};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Largest radius of a table of weights, texels.
pub const WIDEST: u32 = 4;

/// Radius of the table of a peak, texels.
pub const PEAK: u32 = 2;

/// What a coarser level blurs is taken off its weights, to second order: k − σ²/2 ∇²k. A mean over a texel has a
/// variance of 1/12 of its edge squared along an axis, reading between texels ∫ f (1 − f) df = 1/6 on the mean: σ² = 1/4.
/// The rest is read at quarters of its texels only and once more between the peak's, which is 1/4 to 1/3; and weights
/// stay above 0. What that leaves is within the error that a coarse level has anyway.
const SHARPENED: f32 = 0.125;

/// Every so many pixels along and across one is measured for the mean point.
pub const MEASURED: u32 = 4;

/// Largest radius of a kernel, as a share of the picture's longer side.
pub const MOST_RADIUS: f32 = 0.5;

/// Weights over offsets of texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    /// Level of the pyramid.
    pub level: usize,
    /// Offsets go from −radius to radius, texels of that level.
    pub radius: u32,
    /// Weights, row-major.
    pub weights: Vec<f32>,
}

/// The kernel of a reflector on as many texels as it needs.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitKernel {
    /// All of a small kernel, the peak of a larger one.
    pub peak: Kernel,
    /// The rest of a larger one, on the next coarser level.
    pub rest: Option<Kernel>,
}

/// What pixels of one reflector show, summed up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measure {
    /// Pixels.
    pub count: u32,
    /// Σ of their points, from the eye, m.
    pub from_eye: Vec3,
    /// Σ d / (|P| + d): how much of the way from the eye to what is mirrored lies behind the mirror.
    pub share: f32,
}

impl Measure {
    /// Adds the point of a pixel that mirrors what is `distance` away, m.
    pub fn add(&mut self, from_eye: Vec3, distance: f32) {
        self.count += 1;
        self.from_eye += from_eye;
        self.share += if distance.is_finite() { distance / (from_eye.length() + distance) } else { 1.0 };
    }

    /// The mean point, and the nearness of what it mirrors, 1/m; `None` of nothing.
    pub fn mean(&self, normal: Vec3, lobe: Lobe) -> Option<(GlossyPoint, f32)> {
        let count = self.count as f32;
        let from_eye = self.from_eye / count;
        let nearness = (1.0 - self.share / count) / from_eye.length();
        (self.count > 0).then_some((GlossyPoint { from_eye, normal, lobe }, nearness))
    }
}

impl Kernel {
    /// Radius that the kernel of a point has, pixels.
    pub fn wanted_radius(lens: &Lens, point: &GlossyPoint, nearness: f32, support: f32) -> u32 {
        let most = (MOST_RADIUS * lens.size.max_element()).max(1.0);
        point.radius_pixels(nearness, support, lens.pixel_angle()).ceil().clamp(1.0, most) as u32
    }

    /// The kernel of a point at a level of one's choice, 0 for the picture's pixels, with a radius in its texels.
    pub fn on_level(lens: &Lens, point: &GlossyPoint, nearness: f32, level: usize, radius: u32) -> Self {
        Self::of_part(lens, point, nearness, [level, radius as usize], |_| 1.0)
    }

    /// The same times a share by distance in texels, sharpened where it is not summed over pixels.
    fn of_part(
        lens: &Lens,
        point: &GlossyPoint,
        nearness: f32,
        [level, radius]: [usize; 2],
        share: impl Fn(f32) -> f32,
    ) -> Self {
        let (edge, scale) = (2 * radius + 1, (1u32 << level) as f32);
        let middle = lens.place(point.from_eye);
        let at = |x: f32, y: f32| {
            let offset = Vec2::new(x, y) - radius as f32;
            let direction = lens.direction(middle + offset * scale);
            share(offset.length()) * point.weight(direction, nearness, lens.pixel_angle() * scale)
        };
        let weights = (0..edge * edge).map(|i| {
            let (x, y) = ((i % edge) as f32, (i / edge) as f32);
            let own = at(x, y);
            if level == 0 {
                return own;
            }
            let around = at(x + 1.0, y) + at(x - 1.0, y) + at(x, y + 1.0) + at(x, y - 1.0);
            (own - SHARPENED * (around - 4.0 * own)).max(0.0)
        });
        Self { level, radius: radius as u32, weights: weights.collect() }
    }

    /// Σ k c L and, last, Σ k c over the texels of a reflector around one of its level, c their coverage.
    fn sum(&self, pyramid: &Pyramid, reflector: u32, [x, y]: [i32; 2]) -> Vec4 {
        let (level, r) = (&pyramid.levels[self.level], self.radius as i32);
        let mut sum = Vec4::ZERO;
        for dy in -r..=r {
            for dx in -r..=r {
                let texel = level.at(x + dx, y + dy);
                if texel.reflector == reflector {
                    let place = (dy + r) * (2 * r + 1) + dx + r;
                    sum += texel.radiance.extend(1.0) * (self.weights[place as usize] * texel.coverage);
                }
            }
        }
        sum
    }

    /// As an image, brightest 1.
    pub fn image(&self) -> LinearImage {
        let largest = self.weights.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        let edge = 2 * self.radius + 1;
        let pixels = self.weights.iter().map(|w| Vec3::splat(w / largest)).collect();
        LinearImage { width: edge, height: edge, pixels }
    }
}

/// Share of the kernel that its peak takes, by the distance in texels.
fn peak_share(distance: f32) -> f32 {
    (1.0 - (distance / (PEAK + 1) as f32).powi(2)).max(0.0).powi(2)
}

impl SplitKernel {
    /// The kernel of a point if everything were at 1/`nearness` along the unfolded rays; `support` is tan β of its
    /// lobe. Has a twin in `shaders/glossy/invariant.wgsl`, as have its sums and [`Self::at_pixel`].
    pub fn new(lens: &Lens, point: &GlossyPoint, nearness: f32, support: f32, levels: usize) -> Self {
        Self::for_radius(lens, point, nearness, Kernel::wanted_radius(lens, point, nearness, support), levels)
    }

    /// The same for a radius in pixels.
    pub fn for_radius(lens: &Lens, point: &GlossyPoint, nearness: f32, wanted: u32, levels: usize) -> Self {
        let fits = |level: &usize| wanted.div_ceil(1 << level) <= WIDEST;
        let level = (0..levels).find(fits).unwrap_or(levels.saturating_sub(1));
        let radius = wanted.div_ceil(1 << level).min(WIDEST) as usize;
        let part = |level, radius, share: &dyn Fn(f32) -> f32| {
            Kernel::of_part(lens, point, nearness, [level, radius], share)
        };
        let Some(fine) = level.checked_sub(1) else {
            return Self { peak: part(0, radius, &|_| 1.0), rest: None };
        };
        // A texel of the rest has the area of four of the peak.
        let rest = part(level, radius, &|distance| 4.0 * (1.0 - peak_share(2.0 * distance)));
        Self { peak: part(fine, PEAK as usize, &peak_share), rest: Some(rest) }
    }

    /// Σ k c L / Σ k c at a texel of the peak's level; `rest` knows the sums of the rest at the texels of its level.
    fn at_texel(&self, pyramid: &Pyramid, rest: &[Vec4], reflector: u32, [x, y]: [i32; 2]) -> Vec3 {
        let mut sum = self.peak.sum(pyramid, reflector, [x, y]);
        if let Some(kernel) = &self.rest {
            sum += between(&pyramid.levels[kernel.level], rest, reflector, [x, y], 1).unwrap_or(Vec4::ZERO);
        }
        let own = pyramid.levels[self.peak.level].at(x, y).radiance;
        if sum.w > 0.0 && sum.w.is_finite() { sum.truncate() / sum.w } else { own }
    }

    /// What was convolved at the texels around a pixel, between them; `own` where none is of its reflector.
    /// `convolved` knows the texels of the peak's level.
    pub fn at_pixel(
        &self,
        pyramid: &Pyramid,
        convolved: &[Vec4],
        reflector: u32,
        pixel: [i32; 2],
        own: Vec3,
    ) -> Vec3 {
        let level = self.peak.level;
        between(&pyramid.levels[level], convolved, reflector, pixel, level).map_or(own, Vec4::truncate)
    }
}

/// Values of a level between those of its texels that show a reflector, around the middle of one of a level finer by
/// some steps.
fn between(level: &Level, values: &[Vec4], reflector: u32, finer: [i32; 2], steps: usize) -> Option<Vec4> {
    let (mut sum, mut weights) = (Vec4::ZERO, 0.0);
    for ([x, y], weight) in around(finer, steps) {
        if level.at(x, y).reflector == reflector {
            sum += values[(y as u32 * level.width + x as u32) as usize] * weight;
            weights += weight;
        }
    }
    (weights > 0.0).then(|| sum / weights)
}

/// Convolves what a reflector mirrors, at the texels of the peak's level; black where it is not seen.
pub fn convolve(pyramid: &Pyramid, reflector: u32, kernel: &SplitKernel) -> Vec<Vec4> {
    let at_own = |number: usize, found: &(dyn Fn([i32; 2]) -> Vec4 + Sync)| -> Vec<Vec4> {
        let level = &pyramid.levels[number];
        let place = |i: usize| [i as u32 % level.width, i as u32 / level.width].map(|v| v as i32);
        let texels = level.texels.par_iter().enumerate();
        texels.map(|(i, t)| if t.reflector == reflector { found(place(i)) } else { Vec4::ZERO }).collect()
    };
    let rest = kernel
        .rest
        .as_ref()
        .map_or_else(Vec::new, |rest| at_own(rest.level, &|place| rest.sum(pyramid, reflector, place)));
    at_own(kernel.peak.level, &|place| kernel.at_texel(pyramid, &rest, reflector, place).extend(1.0))
}
