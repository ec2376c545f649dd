//! The layer `glossy` of one frame: the specification of [`super::gpu`].

use super::{
    GlossyMethod,
    invariant::{Kernel, convolve},
    kernel::{GlossyPoint, Lens},
    lobes::LobeTable,
    pyramid::Pyramid,
    variant::gather,
};
use crate::{
    math::image::LinearImage,
    mirror::{
        pass::MirrorImage,
        reflectors::{NO_REFLECTOR, Reflectors},
        views::Eye,
    },
    scene::{camera::Camera, world::World},
    superposition::{gbuffer::GBuffer, pass::PassSettings},
};
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Largest radius of an invariant kernel, as a share of the picture's longer side.
const MOST_RADIUS: f32 = 0.5;

/// Widths of lobes that are told apart, at most; what has another reflects unblurred.
pub const MOST_LOBES: usize = 16;

/// Lobes of the glossy reflectors, by the bits of α.
pub type Lobes = BTreeMap<u32, LobeTable>;

/// Tabulates the lobes of all glossy reflectors.
pub fn lobes(world: &World, reflectors: &Reflectors) -> Lobes {
    let alphas = reflectors
        .list
        .iter()
        .filter_map(|r| world.geometry.materials[r.material as usize].alpha().filter(|alpha| *alpha > 0.0));
    let mut lobes = Lobes::new();
    for alpha in alphas {
        if lobes.len() >= MOST_LOBES {
            break;
        }
        lobes.entry(alpha.to_bits()).or_insert_with(|| LobeTable::new(alpha));
    }
    lobes
}

/// What a frame's glossy pixels are made from.
pub struct GlossyFrame<'a> {
    /// The scene.
    pub world: &'a World,
    /// Its flat reflectors.
    pub reflectors: &'a Reflectors,
    /// Lobes of the glossy ones.
    pub lobes: &'a Lobes,
    /// Directions of the pixels.
    pub lens: Lens,
    /// What is mirrored.
    pub image: &'a MirrorImage,
    /// Positions on the reflectors.
    pub buffer: &'a GBuffer,
}

impl<'a> GlossyFrame<'a> {
    /// Prepares a frame.
    pub fn new(
        world: &'a World,
        reflectors: &'a Reflectors,
        lobes: &'a Lobes,
        image: &'a MirrorImage,
        buffer: &'a GBuffer,
        camera: &Camera,
        settings: &PassSettings,
    ) -> Self {
        let size = UVec2::new(buffer.width, buffer.height).as_vec2();
        let eye = Eye::new(camera, size.x / size.y);
        let lens = Lens { eye, size, subpixel: settings.subpixel() };
        Self { world, reflectors, lobes, lens, image, buffer }
    }

    /// The glossy point of a pixel and its lobe; `None` where the pixel shows no glossy reflector.
    pub fn point(&self, pixel: usize) -> Option<(GlossyPoint, &LobeTable)> {
        let reflector = self.image.reflector[pixel];
        if reflector == NO_REFLECTOR {
            return None;
        }
        let reflector = &self.reflectors.list[reflector as usize];
        let alpha = self.world.geometry.materials[reflector.material as usize].alpha()?;
        let lobe = self.lobes.get(&alpha.to_bits())?;
        let normal = reflector.facing(self.lens.eye.position)?;
        let from_eye = self.buffer.position[pixel] - self.lens.eye.position;
        Some((GlossyPoint { from_eye, normal, alpha }, lobe))
    }

    fn pixel_at(&self, pixel: usize) -> [i32; 2] {
        [pixel as i32 % self.buffer.width as i32, pixel as i32 / self.buffer.width as i32]
    }

    /// The mirror image at every resolution.
    pub fn pyramid(&self) -> Pyramid {
        Pyramid::new(self.image, &self.buffer.depth)
    }

    /// Radiance that arrives within the lobe of each pixel, cd/m², before the reflectance; as the mirror image
    /// has it where a pixel is not glossy.
    pub fn scattered(&self, method: GlossyMethod) -> Vec<Vec3> {
        match method {
            GlossyMethod::Sharp => self.image.radiance.clone(),
            GlossyMethod::Variant => {
                let pyramid = self.pyramid();
                (0..self.image.radiance.len())
                    .into_par_iter()
                    .map(|pixel| match self.point(pixel) {
                        Some((point, lobe)) => {
                            let support = lobe.at(point.cos_theta()).support;
                            let reflector = self.image.reflector[pixel];
                            gather(&pyramid, &self.lens, &point, self.pixel_at(pixel), reflector, support)
                                .radiance
                        }
                        None => self.image.radiance[pixel],
                    })
                    .collect()
            }
            GlossyMethod::Invariant => self.invariant(),
        }
    }

    fn invariant(&self) -> Vec<Vec3> {
        let mut out = self.image.radiance.clone();
        let mut pixels: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (pixel, &reflector) in self.image.reflector.iter().enumerate() {
            if reflector != NO_REFLECTOR {
                pixels.entry(reflector).or_default().push(pixel);
            }
        }
        for (reflector, pixels) in pixels {
            let Some(kernel) = self.kernel_of(&pixels) else { continue };
            let mask: Vec<bool> = self.image.reflector.iter().map(|r| *r == reflector).collect();
            let image = LinearImage {
                width: self.image.width,
                height: self.image.height,
                pixels: self.image.radiance.clone(),
            };
            let convolved = convolve(&image, &mask, &kernel);
            for pixel in pixels {
                out[pixel] = convolved.pixels[pixel];
            }
        }
        out
    }

    /// The one kernel of a reflector: that of the pixel that mirrors what is at the median distance.
    fn kernel_of(&self, pixels: &[usize]) -> Option<Kernel> {
        let mut by_distance = pixels.to_vec();
        by_distance
            .sort_by(|a, b| self.image.distance[*a].total_cmp(&self.image.distance[*b]).then(a.cmp(b)));
        let pixel = by_distance[by_distance.len() / 2];
        let (point, lobe) = self.point(pixel)?;
        let nearness = 1.0 / (self.buffer.depth[pixel] + self.image.distance[pixel]);
        let most = (MOST_RADIUS * self.lens.size.max_element()) as u32;
        let support = lobe.at(point.cos_theta()).support;
        Some(Kernel::around(&self.lens, &point, self.pixel_at(pixel), nearness, support, most))
    }

    /// Place of a pixel's ray in the picture, in pixels.
    pub fn place(&self, pixel: usize) -> Vec2 {
        let [x, y] = self.pixel_at(pixel);
        Vec2::new(x as f32, y as f32) + self.lens.subpixel
    }
}
