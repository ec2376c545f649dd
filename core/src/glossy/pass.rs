//! The layer `glossy` of one frame: the specification of [`super::gpu`].

use super::{
    GlossyMethod,
    invariant::{Kernel, MEASURED, Measure, convolve},
    kernel::{GlossyPoint, Lens},
    lobes::LobeTable,
    pyramid::Pyramid,
    variant::gather,
};
use crate::{
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
use std::collections::{BTreeMap, BTreeSet};

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
        let pyramid = self.pyramid();
        let seen: BTreeSet<u32> = self.image.reflector.iter().copied().collect();
        let mut convolved: BTreeMap<u32, (Kernel, Vec<Vec3>)> = BTreeMap::new();
        for reflector in seen.into_iter().filter(|r| *r != NO_REFLECTOR) {
            if let Some(kernel) = self.kernel_of(reflector, pyramid.levels.len()) {
                let texels = convolve(&pyramid, reflector, &kernel);
                convolved.insert(reflector, (kernel, texels));
            }
        }
        (0..self.image.radiance.len())
            .into_par_iter()
            .map(|pixel| {
                let (reflector, own) = (self.image.reflector[pixel], self.image.radiance[pixel]);
                match convolved.get(&reflector) {
                    Some((kernel, texels)) => {
                        kernel.at_pixel(&pyramid, texels, reflector, self.pixel_at(pixel), own)
                    }
                    None => own,
                }
            })
            .collect()
    }

    /// The one kernel of a reflector: that of the mean of its points that are seen.
    fn kernel_of(&self, reflector: u32, levels: usize) -> Option<Kernel> {
        let mut measure = Measure::default();
        let mut lobe = None;
        for y in (0..self.buffer.height).step_by(MEASURED as usize) {
            for x in (0..self.buffer.width).step_by(MEASURED as usize) {
                let pixel = (y * self.buffer.width + x) as usize;
                if self.image.reflector[pixel] == reflector {
                    let (point, table) = self.point(pixel)?;
                    measure.add(point.from_eye, self.image.distance[pixel]);
                    lobe = Some((point.normal, table));
                }
            }
        }
        let (normal, table) = lobe?;
        let (point, nearness) = measure.mean(normal, table.alpha)?;
        let support = table.at(point.cos_theta()).support;
        Some(Kernel::new(&self.lens, &point, nearness, support, levels))
    }

    /// Place of a pixel's ray in the picture, in pixels.
    pub fn place(&self, pixel: usize) -> Vec2 {
        let [x, y] = self.pixel_at(pixel);
        Vec2::new(x as f32, y as f32) + self.lens.subpixel
    }
}
