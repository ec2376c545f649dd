//! Layers: one linear radiance image a term; weighted, they sum to the picture.
//!
//! The terms are those of Bastos 1999, Eq. 4.5, L_D E + L_S E + L(D|S)*D E + L(D|S)*S E, where the subscripts
//! tell lights that shine alike in all directions (D) from others (S). What is seen of a light here is always
//! L_D E, [`Layer::Emitted`]: an emissive surface has one radiance for all directions, and the lamps that have a
//! direction, spots and parallel light, have no surface to be seen. So L_S E is zero, and needs no layer. The third
//! term is split at its first reflection into [`Layer::Direct`] and [`Layer::Indirect`], the fourth by the width of
//! the last lobe into [`Layer::Mirror`] and [`Layer::Glossy`].

use crate::math::image::LinearImage;

/// The terms of the picture, in the order they are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Layer {
    /// Light that emitters send straight to the eye.
    Emitted,
    /// Light that reached the surface straight from the emitters.
    Direct,
    /// Light that reached the surface after at least one bounce.
    Indirect,
    /// Light of whatever kind that the surface reflects as an ideal mirror.
    Mirror,
    /// Light of whatever kind that it reflects into a wider lobe.
    Glossy,
}

/// Number of layers.
pub const COUNT: usize = 5;

/// One factor a layer, in the order of [`Layer::ALL`].
pub type Weights = [f32; COUNT];

impl Layer {
    /// Every layer.
    pub const ALL: [Self; COUNT] = [Self::Emitted, Self::Direct, Self::Indirect, Self::Mirror, Self::Glossy];

    /// Name in files, on the command line and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Emitted => "emitted",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Mirror => "mirror",
            Self::Glossy => "glossy",
        }
    }
}

/// One image a layer, cd/m².
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Images in the order of [`Layer::ALL`].
    pub images: [LinearImage; COUNT],
}

impl Layers {
    /// Black layers.
    pub fn new(width: u32, height: u32) -> Self {
        Self { images: std::array::from_fn(|_| LinearImage::new(width, height)) }
    }

    /// One layer's image.
    pub fn get(&self, layer: Layer) -> &LinearImage {
        &self.images[layer as usize]
    }

    /// The sum: the picture, cd/m².
    pub fn total(&self) -> LinearImage {
        self.sum([1.0; COUNT])
    }

    /// Weighted sum, cd/m².
    pub fn sum(&self, weights: Weights) -> LinearImage {
        let mut picture = LinearImage::new(self.images[0].width, self.images[0].height);
        for (image, weight) in self.images.iter().zip(weights) {
            for (out, pixel) in picture.pixels.iter_mut().zip(&image.pixels) {
                *out += *pixel * weight;
            }
        }
        picture
    }
}
