//! One kernel for each reflector: spatially invariant convolution (Bastos 1999, §7.4.2.1).
//!
//! The kernel is that of the reflector's pixel of median distance, with everything as far away as what it
//! mirrors. Small kernels are summed directly, large ones by the Fourier transform; mask and image are
//! convolved alike and divided, so that the reflector's edge darkens nothing.

use super::kernel::{GlossyPoint, Lens};
use crate::math::{fourier::transform, image::LinearImage};
use glam::{DVec3, Vec2, Vec3};
use rustfft::num_complex::Complex;

/// Radius in pixels above which the Fourier transform is cheaper: (2 r + 1)² products a pixel against some
/// 15 log₂ N for two pairs of transforms.
pub const DIRECT_RADIUS: u32 = 7;

/// A kernel over pixel offsets, normalised to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    /// Offsets go from −radius to radius.
    pub radius: u32,
    /// Weights, row-major.
    pub weights: Vec<f32>,
}

impl Kernel {
    /// The kernel around a pixel if everything were at 1/`nearness` along the unfolded rays.
    pub fn around(
        lens: &Lens,
        point: &GlossyPoint,
        pixel: [i32; 2],
        nearness: f32,
        support: f32,
        most: u32,
    ) -> Self {
        let wanted = point.radius_pixels(nearness, support, lens.pixel_angle()).ceil();
        let radius = (wanted.max(1.0) as u32).min(most.max(1));
        let edge = 2 * radius + 1;
        let weights: Vec<f32> = (0..edge * edge)
            .map(|i| {
                let offset = Vec2::new((i % edge) as f32, (i / edge) as f32) - radius as f32;
                let at = Vec2::new(pixel[0] as f32, pixel[1] as f32) + lens.subpixel + offset;
                point.weight(lens.direction(at), nearness, lens.pixel_angle())
            })
            .collect();
        let sum: f64 = weights.iter().map(|w| f64::from(*w)).sum();
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Self { radius, weights: weights.iter().map(|w| (f64::from(*w) * scale) as f32).collect() }
    }

    /// As an image, brightest 1.
    pub fn image(&self) -> LinearImage {
        let largest = self.weights.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        let edge = 2 * self.radius + 1;
        LinearImage {
            width: edge,
            height: edge,
            pixels: self.weights.iter().map(|w| Vec3::splat(w / largest)).collect(),
        }
    }
}

/// Convolves an image under a mask and divides by the convolved mask: Σ k L m / Σ k m, where the mask is set.
pub fn convolve(image: &LinearImage, mask: &[bool], kernel: &Kernel) -> LinearImage {
    if kernel.radius <= DIRECT_RADIUS { direct(image, mask, kernel) } else { by_fourier(image, mask, kernel) }
}

/// [`convolve`] by a sum over the kernel at each pixel.
pub fn direct(image: &LinearImage, mask: &[bool], kernel: &Kernel) -> LinearImage {
    let (width, height, r) = (image.width as i32, image.height as i32, kernel.radius as i32);
    LinearImage::from_fn(image.width, image.height, |x, y| {
        let (x, y) = (x as i32, y as i32);
        if !mask[(y * width + x) as usize] {
            return Vec3::ZERO;
        }
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0f64);
        for dy in -r..=r {
            for dx in -r..=r {
                let (u, v) = (x + dx, y + dy);
                if u < 0 || v < 0 || u >= width || v >= height || !mask[(v * width + u) as usize] {
                    continue;
                }
                let k = f64::from(kernel.weights[((dy + r) * (2 * r + 1) + dx + r) as usize]);
                sum += k * image.pixels[(v * width + u) as usize].as_dvec3();
                weights += k;
            }
        }
        if weights > 0.0 { (sum / weights).as_vec3() } else { image.at(x as u32, y as u32) }
    })
}

/// [`convolve`] by the Fourier transform; padded, so that nothing wraps around.
pub fn by_fourier(image: &LinearImage, mask: &[bool], kernel: &Kernel) -> LinearImage {
    let r = kernel.radius as usize;
    let (w, h) = (image.width as usize, image.height as usize);
    let (width, height) = (smooth(w + r), smooth(h + r));
    let plane = |value: &dyn Fn(usize) -> Complex<f64>| {
        let mut plane = vec![Complex::default(); width * height];
        for y in 0..h {
            for x in 0..w {
                if mask[y * w + x] {
                    plane[y * width + x] = value(y * w + x);
                }
            }
        }
        plane
    };
    // Two real planes in one complex one: a real kernel keeps them apart.
    let channel = |i: usize, c: usize| f64::from(image.pixels[i][c]);
    let mut pairs = [
        plane(&|i| Complex::new(channel(i, 0), channel(i, 1))),
        plane(&|i| Complex::new(channel(i, 2), 1.0)),
    ];
    let mut spectrum = vec![Complex::default(); width * height];
    for (i, weight) in kernel.weights.iter().enumerate() {
        // Mirrored: a gather correlates.
        let (dx, dy) = ((i % (2 * r + 1)) as isize - r as isize, (i / (2 * r + 1)) as isize - r as isize);
        let x = (-dx).rem_euclid(width as isize) as usize;
        let y = (-dy).rem_euclid(height as isize) as usize;
        spectrum[y * width + x] += Complex::new(f64::from(*weight), 0.0);
    }
    transform(&mut spectrum, width, height, true);
    for pair in &mut pairs {
        transform(pair, width, height, true);
        pair.iter_mut().zip(&spectrum).for_each(|(a, k)| *a *= k);
        transform(pair, width, height, false);
    }
    let [red_green, blue_mask] = pairs;
    LinearImage::from_fn(image.width, image.height, |x, y| {
        let i = y as usize * w + x as usize;
        let at = y as usize * width + x as usize;
        if !mask[i] {
            return Vec3::ZERO;
        }
        let (rg, bm) = (red_green[at], blue_mask[at]);
        let found = DVec3::new(rg.re, rg.im, bm.re) / bm.im;
        // Rounding may put a black pixel below zero.
        if bm.im > 1e-9 * (width * height) as f64 {
            found.max(DVec3::ZERO).as_vec3()
        } else {
            image.pixels[i]
        }
    })
}

/// The next number of the form 2ᵃ 3ᵇ 5ᶜ: sizes that transform fast.
fn smooth(n: usize) -> usize {
    (n..)
        .find(|&n| {
            let mut n = n;
            for p in [2, 3, 5] {
                while n % p == 0 {
                    n /= p;
                }
            }
            n == 1
        })
        .unwrap_or(n)
}
