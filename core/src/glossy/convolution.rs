//! One kernel over a masked picture at its own resolution: directly, or by Fourier transforms where that is cheaper.
//!
//! out(p) = Σ k(q − p) m(q) L(q) / Σ k(q − p) m(q), m the mask of the reflector: image and mask are convolved alike
//! and divided, so that constant light stays constant up to the edge. That is feed-backward: the kernel is the lobe of
//! the pixel that gathers. The thesis's Program 7.12 feeds forward, k(p − q), by the lobe of what is spread
//! ([`Convention`]); one kernel for all is then turned by half, which shows where it is lopsided. Transformed are two planes of complex numbers,
//! red and green, blue and mask: the kernel is real, so what is in the real and in the imaginary part stays apart
//! (Bastos 1999, §2.4: a product of spectra instead of a sum over neighbours).
//!
//! [`super::invariant`] sums over coarser texels instead, which is cheaper than either and blurs a little more; this
//! is what it is held to.

use super::invariant::Kernel;
use crate::math::fourier::transform;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rustfft::num_complex::Complex;

/// How a sum over neighbours is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Neighbour by neighbour: (2r + 1)² a pixel.
    Direct,
    /// By the product of spectra: log N a pixel, whatever the radius.
    Fourier,
}

/// Which of two pixels the kernel is centred on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// The one that is shown: it gathers what lies within its lobe, k(q − p). What the kernels here mean.
    Backward,
    /// The one that is mirrored: it spreads over those around it, k(p − q) (Bastos 1999, Program 7.12).
    Forward,
}

impl Convention {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Backward, Self::Forward];
}

/// Nanoseconds of the direct sum, a pixel and a neighbour, and of the other a pixel, transform and factor of two: two
/// threads, as `lumenscope glossy --kernels` measures them.
const DIRECT_NANOSECONDS: [f64; 2] = [15.0, 0.48];
const FOURIER_NANOSECONDS: f64 = 0.75;

impl Way {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Direct, Self::Fourier];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Fourier => "Fourier",
        }
    }

    /// Expected milliseconds for a picture and a radius in pixels.
    pub fn milliseconds(self, size: [u32; 2], radius: u32) -> f64 {
        let pixels = |[w, h]: [u32; 2]| f64::from(w) * f64::from(h);
        1e-6 * match self {
            Self::Direct => {
                let [pixel, neighbour] = DIRECT_NANOSECONDS;
                pixels(size) * (pixel + neighbour * f64::from(2 * radius + 1).powi(2))
            }
            Self::Fourier => {
                let padded = pixels(padded(size, radius));
                // Two planes there and back, and the kernel.
                FOURIER_NANOSECONDS * padded * padded.log2() * 5.0
            }
        }
    }

    /// The one that is expected to take less time. By measured constants, not by the clock: the same picture on
    /// every run.
    pub fn cheaper(size: [u32; 2], radius: u32) -> Self {
        if Self::Direct.milliseconds(size, radius) <= Self::Fourier.milliseconds(size, radius) {
            Self::Direct
        } else {
            Self::Fourier
        }
    }
}

/// A picture with a mask, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Masked {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Radiance, cd/m² per channel.
    pub radiance: Vec<Vec3>,
    /// Weight of each pixel: 1 where it belongs to the reflector, 0 elsewhere.
    pub mask: Vec<f32>,
}

impl Masked {
    /// Convolves with the kernel of a level; black where no neighbour counts.
    pub fn convolved(&self, kernel: &Kernel, convention: Convention, way: Way) -> Vec<Vec3> {
        let turned = (convention == Convention::Forward)
            .then(|| Kernel { weights: kernel.weights.iter().rev().copied().collect(), ..kernel.clone() });
        let kernel = turned.as_ref().unwrap_or(kernel);
        match way {
            Way::Direct => self.directly(kernel),
            Way::Fourier => self.by_fourier(kernel),
        }
    }

    fn directly(&self, kernel: &Kernel) -> Vec<Vec3> {
        let ([width, height], r) = (self.size.map(|n| n as i32), kernel.radius as i32);
        let edge = 2 * r + 1;
        let at = |p: usize| {
            let (x, y) = (p as i32 % width, p as i32 / width);
            let (from, to) = ((x - r).max(0), (x + r).min(width - 1));
            let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
            for v in (y - r).max(0)..=(y + r).min(height - 1) {
                let first = ((v - y + r) * edge + from - x + r) as usize;
                let q = (v * width + from) as usize;
                let row = self.radiance[q..].iter().zip(&self.mask[q..]).zip(&kernel.weights[first..]);
                for ((radiance, mask), weight) in row.take((to - from + 1) as usize) {
                    let weight = weight * mask;
                    sum += *radiance * weight;
                    weights += weight;
                }
            }
            if weights > 0.0 { sum / weights } else { Vec3::ZERO }
        };
        (0..self.radiance.len()).into_par_iter().map(at).collect()
    }

    fn by_fourier(&self, kernel: &Kernel) -> Vec<Vec3> {
        let [width, height] = self.size.map(|n| n as usize);
        let [across, down] = padded(self.size, kernel.radius).map(|n| n as usize);
        let plane = |value: &dyn Fn(usize) -> Complex<f64>| {
            let mut plane = vec![Complex::default(); across * down];
            for y in 0..height {
                for x in 0..width {
                    plane[y * across + x] = value(y * width + x);
                }
            }
            transform(&mut plane, across, down, true);
            plane
        };
        let masked = |p: usize| (self.radiance[p] * self.mask[p]).as_dvec3();
        let mut planes = [
            plane(&|p| Complex::new(masked(p).x, masked(p).y)),
            plane(&|p| Complex::new(masked(p).z, f64::from(self.mask[p]))),
        ];
        // The kernel around the corner, divided by its sum, which keeps the rounding of all alike.
        let r = kernel.radius as usize;
        let total: f64 = kernel.weights.iter().map(|w| f64::from(*w)).sum();
        let mut spectrum = vec![Complex::default(); across * down];
        for (i, weight) in kernel.weights.iter().enumerate() {
            let (x, y) = (i % (2 * r + 1), i / (2 * r + 1));
            let place = ((y + down - r) % down) * across + (x + across - r) % across;
            spectrum[place] = Complex::new(f64::from(*weight) / total, 0.0);
        }
        transform(&mut spectrum, across, down, true);
        for plane in &mut planes {
            // Conjugate: neighbours at +d have the weight of +d, which is correlation.
            plane.par_iter_mut().zip(&spectrum).for_each(|(value, k)| *value *= k.conj());
            transform(plane, across, down, false);
        }
        let [first, second] = &planes;
        let at = |p: usize| {
            let place = (p / width) * across + p % width;
            let (a, b) = (first[place], second[place]);
            // Less than rounding leaves of a mask of ones is no neighbour at all.
            if b.im > 1e-9 {
                (DVec3::new(a.re, a.im, b.re) / b.im).max(DVec3::ZERO).as_vec3()
            } else {
                Vec3::ZERO
            }
        };
        (0..self.radiance.len()).into_par_iter().map(at).collect()
    }
}

/// Size of the transforms: room for the kernel beyond the edges, products of 2, 3 and 5.
fn padded(size: [u32; 2], radius: u32) -> [u32; 2] {
    size.map(|n| {
        let smooth = |mut m: u32| {
            for p in [2, 3, 5] {
                while m.is_multiple_of(p) {
                    m /= p;
                }
            }
            m == 1
        };
        (n + radius..).find(|m| smooth(*m)).unwrap_or(n + radius)
    })
}
