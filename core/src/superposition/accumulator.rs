//! Progressive refinement: the mean of frames that differ in their random numbers.

use super::layers::{COUNT, Layers};
use crate::math::image::LinearImage;
use glam::DVec3;

/// Sum of frames, in `f64` so that the thousandth frame still counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accumulator {
    size: [u32; 2],
    sums: [Vec<DVec3>; COUNT],
    frames: u32,
}

impl Accumulator {
    /// An empty sum.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a frame; one of another size starts over.
    pub fn add(&mut self, layers: &Layers) {
        let size = [layers.images[0].width, layers.images[0].height];
        if self.frames == 0 || self.size != size {
            let pixels = layers.images[0].pixels.len();
            *self = Self { size, sums: std::array::from_fn(|_| vec![DVec3::ZERO; pixels]), frames: 0 };
        }
        for (sum, image) in self.sums.iter_mut().zip(&layers.images) {
            for (sum, pixel) in sum.iter_mut().zip(&image.pixels) {
                *sum += pixel.as_dvec3();
            }
        }
        self.frames += 1;
    }

    /// Number of frames added.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Forgets all frames.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Mean of the frames, cd/m²; empty images when there are none.
    pub fn mean(&self) -> Layers {
        let [width, height] = self.size;
        let scale = 1.0 / f64::from(self.frames.max(1));
        Layers {
            images: std::array::from_fn(|i| LinearImage {
                width,
                height,
                pixels: self.sums[i].iter().map(|s| (*s * scale).as_vec3()).collect(),
            }),
        }
    }
}
