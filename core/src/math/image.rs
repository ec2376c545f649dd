//! Linear floating-point images.

use glam::{Vec2, Vec3};

/// Bilinear value at a place among texels that lie at whole numbers.
pub fn bilinear(place: Vec2, texel: impl Fn(i32, i32) -> Vec3) -> Vec3 {
    let base = place.floor();
    let f = place - base;
    let (x, y) = (base.x as i32, base.y as i32);
    let row = |y: i32| texel(x, y).lerp(texel(x + 1, y), f.x);
    row(y).lerp(row(y + 1), f.y)
}

/// A linear RGB image, row-major from the top left; the unit is the owner's (cd/m², lx, reflectance).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height` pixels.
    pub pixels: Vec<Vec3>,
}

impl LinearImage {
    /// A black image.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![Vec3::ZERO; (width * height) as usize] }
    }

    /// An image from its rows computed in parallel; the result does not depend on the thread count.
    pub fn from_fn(width: u32, height: u32, pixel: impl Fn(u32, u32) -> Vec3 + Sync) -> Self {
        use rayon::prelude::*;
        let mut image = Self::new(width, height);
        image.pixels.par_chunks_mut(width.max(1) as usize).enumerate().for_each(|(y, row)| {
            for (x, out) in row.iter_mut().enumerate() {
                *out = pixel(x as u32, y as u32);
            }
        });
        image
    }

    /// Makes pixels black that are not finite, and cuts negative values off.
    pub fn clear_invalid(&mut self) {
        for pixel in &mut self.pixels {
            *pixel = if pixel.is_finite() { pixel.max(Vec3::ZERO) } else { Vec3::ZERO };
        }
    }

    /// Pixel at column `x`, row `y`.
    ///
    /// # Panics
    /// If the pixel lies outside.
    pub fn at(&self, x: u32, y: u32) -> Vec3 {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) outside {}x{}", self.width, self.height);
        self.pixels[(y * self.width + x) as usize]
    }

    /// Bilinear value at texture coordinates `uv` (v down), repeating outside [0, 1).
    pub fn sample_repeat(&self, uv: Vec2) -> Vec3 {
        let size = Vec2::new(self.width as f32, self.height as f32);
        let p = (uv - uv.floor()) * size - Vec2::splat(0.5);
        let wrap = |v: i32, n: u32| v.rem_euclid(n.max(1) as i32) as u32;
        bilinear(p, |x, y| self.at(wrap(x, self.width), wrap(y, self.height)))
    }

    /// Mean over all pixels, summed in `f64`; zero for an empty image.
    pub fn mean(&self) -> Vec3 {
        let sum = self.pixels.iter().fold(glam::DVec3::ZERO, |s, p| s + p.as_dvec3());
        (sum / (self.pixels.len().max(1) as f64)).as_vec3()
    }
}
