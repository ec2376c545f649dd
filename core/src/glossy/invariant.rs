//! One kernel for each reflector: spatially invariant convolution (Bastos 1999, §7.4.2.1).
//!
//! The kernel is that of the mean point of the reflector that is seen, with everything as far away as what it
//! mirrors on the mean. It is a table of at most fifteen by fifteen weights: small kernels are summed over pixels,
//! larger ones over a level of the [`Pyramid`] on which they are that small, and read between its texels. Mask and
//! image are convolved alike and divided, so that the reflector's edge darkens nothing.
//!
//! Means, not the pixel of median distance: two pixels equally far may be far apart, and which of them is the
//! middle one is then a matter of rounding.
//!
//! Limits: a reflector narrower than the texels of its level is shown as if it were sharp, as is one that no
//! pixel of those that are measured shows; at a reflector's edge there is nothing to read between, so that the
//! picture is shifted there by up to half a texel of its level.

use super::{
    kernel::{GlossyPoint, Lens},
    pyramid::Pyramid,
};
use crate::math::image::LinearImage;
use glam::{Vec2, Vec3};

/// Largest radius of a table of weights, texels.
pub const WIDEST: u32 = 7;

/// Every so many pixels along and across one is measured for the mean point.
pub const MEASURED: u32 = 4;

/// Largest radius of a kernel, as a share of the picture's longer side.
pub const MOST_RADIUS: f32 = 0.5;

/// A kernel over offsets of texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    /// Level of the pyramid.
    pub level: usize,
    /// Offsets go from −radius to radius, texels of that level.
    pub radius: u32,
    /// Weights, row-major; their sum is divided by.
    pub weights: Vec<f32>,
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
    pub fn mean(&self, normal: Vec3, alpha: f32) -> Option<(GlossyPoint, f32)> {
        let count = self.count as f32;
        let from_eye = self.from_eye / count;
        let nearness = (1.0 - self.share / count) / from_eye.length();
        (self.count > 0).then_some((GlossyPoint { from_eye, normal, alpha }, nearness))
    }
}

impl Kernel {
    /// The kernel of a point if everything were at 1/`nearness` along the unfolded rays; `support` is tan β of its
    /// lobe. Has a twin in `shaders/glossy/invariant.wgsl`, as have [`Self::at_texel`] and [`Self::at_pixel`].
    pub fn new(lens: &Lens, point: &GlossyPoint, nearness: f32, support: f32, levels: usize) -> Self {
        Self::for_radius(lens, point, nearness, Self::wanted_radius(lens, point, nearness, support), levels)
    }

    /// The same for a radius in pixels, on the level where its table is small.
    pub fn for_radius(lens: &Lens, point: &GlossyPoint, nearness: f32, wanted: u32, levels: usize) -> Self {
        let fits = |level: &usize| wanted.div_ceil(1 << level) <= WIDEST;
        let level = (0..levels).find(fits).unwrap_or(levels.saturating_sub(1));
        Self::on_level(lens, point, nearness, level, wanted.div_ceil(1 << level).min(WIDEST))
    }

    /// Radius that the kernel of a point has, pixels.
    pub fn wanted_radius(lens: &Lens, point: &GlossyPoint, nearness: f32, support: f32) -> u32 {
        let most = (MOST_RADIUS * lens.size.max_element()).max(1.0);
        point.radius_pixels(nearness, support, lens.pixel_angle()).ceil().clamp(1.0, most) as u32
    }

    /// The same at a level of one's choice, 0 for the picture's pixels, with a radius in its texels.
    pub fn on_level(lens: &Lens, point: &GlossyPoint, nearness: f32, level: usize, radius: u32) -> Self {
        let (edge, scale) = (2 * radius + 1, (1u32 << level) as f32);
        let middle = lens.place(point.from_eye);
        let weights = (0..edge * edge).map(|i| {
            let offset = Vec2::new((i % edge) as f32, (i / edge) as f32) - radius as f32;
            point.weight(lens.direction(middle + offset * scale), nearness, lens.pixel_angle() * scale)
        });
        Self { level, radius, weights: weights.collect() }
    }

    /// Σ k c L / Σ k c over the texels of a reflector around one of its level, c their coverage.
    pub fn at_texel(&self, pyramid: &Pyramid, reflector: u32, [x, y]: [i32; 2]) -> Vec3 {
        let (level, r) = (&pyramid.levels[self.level], self.radius as i32);
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for dy in -r..=r {
            for dx in -r..=r {
                let texel = level.at(x + dx, y + dy);
                if texel.reflector == reflector {
                    let place = (dy + r) * (2 * r + 1) + dx + r;
                    let weight = self.weights[place as usize] * texel.coverage;
                    sum += texel.radiance * weight;
                    weights += weight;
                }
            }
        }
        if weights > 0.0 && weights.is_finite() { sum / weights } else { level.at(x, y).radiance }
    }

    /// What was convolved at the texels around a pixel, between them; `own` where none is of its reflector.
    /// `convolved` knows the texels of the kernel's level.
    pub fn at_pixel(
        &self,
        pyramid: &Pyramid,
        convolved: &[Vec3],
        reflector: u32,
        [x, y]: [i32; 2],
        own: Vec3,
    ) -> Vec3 {
        let level = &pyramid.levels[self.level];
        let at = (Vec2::new(x as f32, y as f32) + 0.5) / (1u32 << self.level) as f32 - 0.5;
        let (low, f) = (at.floor(), at - at.floor());
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (tx, ty) = (low.x as i32 + dx, low.y as i32 + dy);
            if level.at(tx, ty).reflector == reflector {
                let weight =
                    (if dx == 1 { f.x } else { 1.0 - f.x }) * (if dy == 1 { f.y } else { 1.0 - f.y });
                sum += convolved[(ty as u32 * level.width + tx as u32) as usize] * weight;
                weights += weight;
            }
        }
        if weights > 0.0 { sum / weights } else { own }
    }

    /// As an image, brightest 1.
    pub fn image(&self) -> LinearImage {
        let largest = self.weights.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        let edge = 2 * self.radius + 1;
        let pixels = self.weights.iter().map(|w| Vec3::splat(w / largest)).collect();
        LinearImage { width: edge, height: edge, pixels }
    }
}

/// Convolves what a reflector mirrors, at the texels of the kernel's level; black where it is not seen.
pub fn convolve(pyramid: &Pyramid, reflector: u32, kernel: &Kernel) -> Vec<Vec3> {
    use rayon::prelude::*;
    let level = &pyramid.levels[kernel.level];
    (0..level.texels.len())
        .into_par_iter()
        .map(|i| match level.texels[i].reflector == reflector {
            true => {
                let [x, y] = [i as u32 % level.width, i as u32 / level.width].map(|v| v as i32);
                kernel.at_texel(pyramid, reflector, [x, y])
            }
            false => Vec3::ZERO,
        })
        .collect()
}
