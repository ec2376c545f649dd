//! Radiosity as textures: a quadtree of radiosity turned into an image that a polygon wears.
//!
//! Bastos (1999, §5.5) separates light from geometry: instead of a mesh of small polygons, each surface keeps
//! its few polygons and gets one texture. Here are the steps, each by itself:
//!
//! 1. a [`Quadtree`] over the unit square or a triangle, with one radiosity a leaf or one a vertex;
//! 2. [`convert`]: leaves to texels, one texel a leaf (zero-order) or one a vertex (first-order), gaps filled;
//! 3. [`hermite`]: resampling that keeps every sample and has no crease, T-vertices or not (stage 1);
//! 4. [`prefilter`]: a Gaussian that takes the creases that bilinear display would show (stage 2);
//! 5. [`display`]: bilinear or bicubic lookup (stage 3).
//!
//! [`adapt`] grows a tree where what is sampled asks for it, over any surface with parameters u and v;
//! [`sphere`] puts the six patches of a sphere into one latitude–longitude texture, [`sphere_orders`] does so by the
//! rules of [`convert`]; [`tube`] closes one patch around a cylinder.
//!
//! The quantity is irradiance or radiosity in lx, per channel; nothing here depends on which.
//!
//! Limits: a texture is as fine everywhere as the tree is at its finest, and light that jumps inside a texel
//! is blurred over it.

pub mod adapt;
pub mod convert;
pub mod display;
pub mod hermite;
pub mod prefilter;
mod quadtree;
pub mod sphere;
pub mod sphere_orders;
pub mod triangle;
pub mod tube;

pub use quadtree::{Cell, Quadtree, Shape};

use crate::math::image::LinearImage;
use glam::{Vec2, Vec3};

/// A texture and where its texels lie on the unit square.
#[derive(Clone, Debug, PartialEq)]
pub struct RadiosityTexture {
    /// Texel (i, j) is column i, row j; lx.
    pub image: LinearImage,
    /// Coordinates of the first texel.
    pub first: Vec2,
    /// From a texel to the next along u and along v.
    pub step: Vec2,
    /// What lies beyond the outermost texels.
    pub border: Border,
}

/// What lies beyond the outermost texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// The outermost texels, again and again.
    #[default]
    Clamp,
    /// A sphere: u goes round, and over the first and the last row, the poles, v comes back half way round.
    Sphere,
    /// The side of a cylinder: u goes round, and beyond the ends the outermost rows stand again.
    Tube,
}

impl RadiosityTexture {
    /// A square texture whose outermost texels lie on the border of the unit square: one texel a vertex.
    ///
    /// # Panics
    /// If the image is not square or has fewer than 2 × 2 texels.
    pub fn at_vertices(image: LinearImage) -> Self {
        assert!(image.width == image.height && image.width > 1, "{} x {}", image.width, image.height);
        let step = Vec2::splat(1.0 / (image.width - 1) as f32);
        Self { image, first: Vec2::ZERO, step, border: Border::Clamp }
    }

    /// A square texture whose texels are the middles of equal cells of the unit square: one texel an element.
    ///
    /// # Panics
    /// If the image is not square or is empty.
    pub fn at_centres(image: LinearImage) -> Self {
        assert!(image.width == image.height && image.width > 0, "{} x {}", image.width, image.height);
        let step = Vec2::splat(1.0 / image.width as f32);
        Self { image, first: 0.5 * step, step, border: Border::Clamp }
    }

    /// Texel (i, j), also beyond the border.
    pub fn texel(&self, i: i64, j: i64) -> Vec3 {
        let (w, h) = (i64::from(self.image.width), i64::from(self.image.height));
        let (i, j) = match self.border {
            Border::Clamp => (i.clamp(0, w - 1), j.clamp(0, h - 1)),
            Border::Tube => (i.rem_euclid(w), j.clamp(0, h - 1)),
            Border::Sphere => {
                let over = j < 0 || j >= h;
                let j = if j < 0 { -j } else { j };
                let j = if j >= h { 2 * (h - 1) - j } else { j };
                ((i + if over { w / 2 } else { 0 }).rem_euclid(w), j.clamp(0, h - 1))
            }
        };
        self.image.pixels[(j * w + i) as usize]
    }
}
