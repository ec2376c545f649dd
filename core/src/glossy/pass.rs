//! The layer `glossy` of one frame: the specification of [`super::gpu`].

use super::{
    GlossyMethod,
    convolution::{Convention, Masked, Way},
    invariant::{Kernel, MEASURED, Measure, SplitKernel, convolve},
    kernel::{GlossyPoint, Lens},
    lobes::LobeTable,
    pyramid::{Pyramid, level_size},
    variant::{gather, reach},
};
use crate::{
    mirror::{
        pass::MirrorImage,
        reflectors::{NO_REFLECTOR, Reflectors},
        views::Eye,
    },
    scene::{brdf::Lobe, camera::Camera, world::World},
    superposition::{gbuffer::GBuffer, pass::PassSettings},
};
use glam::{UVec2, Vec3, Vec4};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Lobes that are told apart, at most; what has another reflects unblurred.
pub const MOST_LOBES: usize = 16;

/// Lobes of the glossy reflectors, by [`key`].
pub type Lobes = BTreeMap<[u32; 2], LobeTable>;

/// What tells a lobe from others: the bits of its parameters.
pub fn key(lobe: Lobe) -> [u32; 2] {
    lobe.parameters().map(f32::to_bits)
}

/// The lobes of all glossy reflectors; those that are known already are taken over.
pub fn lobes(world: &World, reflectors: &Reflectors, known: &Lobes) -> Lobes {
    let all = reflectors.list.iter().filter_map(|r| world.geometry.materials[r.material as usize].lobe());
    let mut lobes = Lobes::new();
    for lobe in all {
        let key = key(lobe);
        if lobes.len() >= MOST_LOBES && !lobes.contains_key(&key) {
            continue;
        }
        lobes.entry(key).or_insert_with(|| known.get(&key).cloned().unwrap_or_else(|| LobeTable::new(lobe)));
    }
    lobes
}

/// Radius of a kernel in pixels below which it is summed at every pixel, not between nodes: as far as the window of
/// its finest level reaches anyway.
const SMALL_RADIUS: f32 = 4.0;

/// Relative difference of nearness up to which a node shows what a pixel shows.
const ALIKE: f32 = 0.1;

/// Weight of the node before a pixel's place, or of the one after it, along one axis.
fn node_weight(place: usize, after: usize) -> f32 {
    match (place % 2, after) {
        (0, 0) => 1.0,
        (0, _) => 0.0,
        _ => 0.5,
    }
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
        let lobe = self.lobe(reflector)?;
        let normal = self.reflectors.list[reflector as usize].facing(self.lens.eye.position)?;
        let from_eye = self.buffer.position[pixel] - self.lens.eye.position;
        Some((GlossyPoint { from_eye, normal, lobe: lobe.lobe }, lobe))
    }

    /// Radiance that a glossy pixel reflects of the mean that arrives within its lobe: E(θ) F(θ̄) L; black where it is
    /// not glossy.
    pub fn reflected(&self, pixel: usize, arriving: Vec3) -> Vec3 {
        let Some((point, lobe)) = self.point(pixel) else { return Vec3::ZERO };
        let (buffer, geometry) = (self.buffer, &self.world.geometry);
        let surface = geometry.surface(buffer.triangle[pixel], buffer.barycentric[pixel], point.from_eye);
        let specular = geometry.brdf(&surface).specular;
        specular.map_or(Vec3::ZERO, |s| lobe.modulation(&s, point.cos_theta()) * arriving)
    }

    fn pixel_at(&self, pixel: usize) -> [i32; 2] {
        [pixel as i32 % self.buffer.width as i32, pixel as i32 / self.buffer.width as i32]
    }

    /// The mirror image of the glossy reflectors at every resolution.
    pub fn pyramid(&self) -> Pyramid {
        Pyramid::new(self.image, &self.buffer.depth, |reflector| self.lobe(reflector).is_some())
    }

    /// The lobe of a reflector; `None` of a mirror, and of one too many.
    fn lobe(&self, reflector: u32) -> Option<&LobeTable> {
        let material = self.reflectors.list.get(reflector as usize)?.material;
        self.lobes.get(&key(self.world.geometry.materials[material as usize].lobe()?))
    }

    /// Radiance that arrives within the lobe of each pixel, cd/m², before the reflectance; as the mirror image
    /// has it where a pixel is not glossy.
    pub fn scattered(&self, method: GlossyMethod) -> Vec<Vec3> {
        match method {
            GlossyMethod::Sharp | GlossyMethod::Particles => self.image.radiance.clone(),
            GlossyMethod::Variant => {
                let pyramid = self.pyramid();
                self.at_every_pixel(|pixel| self.gathered(&pyramid, pixel))
            }
            GlossyMethod::VariantHalf => {
                let pyramid = self.pyramid();
                let nodes = self.nodes(&pyramid);
                self.at_every_pixel(|pixel| {
                    self.between(&pyramid, &nodes, pixel).or_else(|| self.gathered(&pyramid, pixel))
                })
            }
            GlossyMethod::Invariant => self.invariant(),
        }
    }

    /// What is found at each pixel; what is mirrored where nothing is.
    fn at_every_pixel(&self, found: impl Fn(usize) -> Option<Vec3> + Sync) -> Vec<Vec3> {
        let own = &self.image.radiance;
        (0..own.len()).into_par_iter().map(|pixel| found(pixel).unwrap_or(own[pixel])).collect()
    }

    /// Mean over the lobe of a glossy pixel.
    fn gathered(&self, pyramid: &Pyramid, pixel: usize) -> Option<Vec3> {
        let (point, lobe) = self.point(pixel)?;
        let support = lobe.at(point.cos_theta()).support;
        let reflector = self.image.reflector[pixel];
        Some(gather(pyramid, &self.lens, &point, self.pixel_at(pixel), reflector, support).radiance)
    }

    /// Radius of a glossy pixel's kernel, pixels.
    fn radius(&self, pyramid: &Pyramid, pixel: usize) -> Option<f32> {
        let (point, lobe) = self.point(pixel)?;
        let support = lobe.at(point.cos_theta()).support;
        let reflector = self.image.reflector[pixel];
        Some(reach(pyramid, &self.lens, &point, self.pixel_at(pixel), reflector, support))
    }

    /// Width and height of the grid of nodes: every second pixel of every second row.
    fn node_grid(&self) -> [usize; 2] {
        level_size([self.image.width, self.image.height], 1).map(|n| n as usize)
    }

    /// The means at the nodes, where kernels are not small. Has a twin in `shaders/glossy/half.wgsl`, as has
    /// [`Self::between`].
    fn nodes(&self, pyramid: &Pyramid) -> Vec<Option<Vec3>> {
        let [across, down] = self.node_grid();
        (0..across * down)
            .into_par_iter()
            .map(|node| {
                let pixel = 2 * (node / across) * self.image.width as usize + 2 * (node % across);
                self.radius(pyramid, pixel).filter(|r| *r >= SMALL_RADIUS)?;
                self.gathered(pyramid, pixel)
            })
            .collect()
    }

    /// Between the nodes around a pixel that show what it shows: the same reflector, and in it what is about as far.
    /// `None` where its kernel is small or no node is like it.
    fn between(&self, pyramid: &Pyramid, nodes: &[Option<Vec3>], pixel: usize) -> Option<Vec3> {
        self.radius(pyramid, pixel).filter(|r| *r >= SMALL_RADIUS)?;
        let ([x, y], [across, down]) = (self.pixel_at(pixel).map(|v| v as usize), self.node_grid());
        let own = pyramid.levels[0].texels[pixel];
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let weight = node_weight(x, dx) * node_weight(y, dy);
            let (column, row) = (x / 2 + dx, y / 2 + dy);
            if weight == 0.0 || column >= across || row >= down {
                continue;
            }
            let texel = pyramid.levels[0].at(2 * column as i32, 2 * row as i32);
            let apart = (texel.nearness - own.nearness).abs();
            if texel.reflector == own.reflector
                && apart <= ALIKE * own.nearness.max(texel.nearness)
                && let Some(node) = nodes[row * across + column]
            {
                sum += node * weight;
                weights += weight;
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }

    fn invariant(&self) -> Vec<Vec3> {
        let pyramid = self.pyramid();
        let mut convolved: BTreeMap<u32, (SplitKernel, Vec<Vec4>)> = BTreeMap::new();
        for reflector in self.seen() {
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

    /// Reflectors that are seen.
    fn seen(&self) -> BTreeSet<u32> {
        self.image.reflector.iter().copied().filter(|r| *r != NO_REFLECTOR).collect()
    }

    /// [`GlossyMethod::Invariant`] over the picture's own pixels, as far as the kernels reach, each by the cheaper of
    /// both ways.
    pub fn invariant_in_full(&self) -> Vec<Vec3> {
        let mut out = self.image.radiance.clone();
        for reflector in self.seen() {
            let Some((point, nearness, support)) = self.mean_point(reflector) else { continue };
            let radius = Kernel::wanted_radius(&self.lens, &point, nearness, support);
            let kernel = Kernel::on_level(&self.lens, &point, nearness, 0, radius);
            let is_own = |r: &u32| *r == reflector;
            let masked = Masked {
                size: [self.image.width, self.image.height],
                radiance: self.image.radiance.clone(),
                mask: self.image.reflector.iter().map(|r| f32::from(u8::from(is_own(r)))).collect(),
            };
            let convolved =
                masked.convolved(&kernel, Convention::Backward, Way::cheaper(masked.size, radius));
            let own = self.image.reflector.iter().enumerate().filter(|(_, r)| is_own(r));
            own.for_each(|(pixel, _)| out[pixel] = convolved[pixel]);
        }
        out
    }

    /// The one kernel of a reflector: that of the mean of its points that are seen.
    fn kernel_of(&self, reflector: u32, levels: usize) -> Option<SplitKernel> {
        let (point, nearness, support) = self.mean_point(reflector)?;
        Some(SplitKernel::new(&self.lens, &point, nearness, support, levels))
    }

    /// The mean of the points of a glossy reflector that are seen, the nearness of what it mirrors and tan β of its
    /// lobe.
    pub fn mean_point(&self, reflector: u32) -> Option<(GlossyPoint, f32, f32)> {
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
        let (point, nearness) = measure.mean(normal, table.lobe)?;
        Some((point, nearness, table.at(point.cos_theta()).support))
    }
}
