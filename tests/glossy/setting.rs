//! Synthetic mirror images: a mirror across the view that shows what a test wants it to.

use glam::{Vec2, Vec3};
use lumenscope_core::{
    glossy::{
        invariant::{SplitKernel, convolve},
        kernel::{GlossyPoint, Lens},
        lobes::LobeTable,
        pyramid::Pyramid,
        variant::gather,
    },
    math::random::hash2,
    mirror::{pass::MirrorImage, reflectors::NO_REFLECTOR, views::Eye},
    scene::{
        brdf::{Lobe, LobeShape},
        camera::Camera,
    },
};

/// Both lobes.
pub const SHAPES: [LobeShape; 2] = [LobeShape::Ggx, LobeShape::Phong];

/// Widths α of roughness 0.05, 0.1, 0.2, 0.4.
pub const ALPHAS: [f32; 4] = [0.0025, 0.01, 0.04, 0.16];

/// Both lobes of each width.
pub fn lobes() -> impl Iterator<Item = Lobe> {
    SHAPES.into_iter().flat_map(|shape| ALPHAS.map(|alpha| Lobe::new(shape, alpha)))
}

/// A mirror across the view at 2 m, tilted by `tilt` about the vertical, that shows something at distances behind it.
pub struct Setting {
    pub size: [u32; 2],
    pub lens: Lens,
    pub normal: Vec3,
    pub image: MirrorImage,
    pub eye_distance: Vec<f32>,
    pub lobe: Lobe,
}

pub fn setting(
    size: [u32; 2],
    fov: f32,
    tilt: f32,
    lobe: Lobe,
    distance: impl Fn([u32; 2]) -> f32,
) -> Setting {
    let camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, vertical_fov: fov };
    let [width, height] = size;
    let extent = Vec2::new(width as f32, height as f32);
    let lens = Lens { eye: Eye::new(&camera, extent.x / extent.y), size: extent, subpixel: Vec2::splat(0.5) };
    let normal = Vec3::new(tilt.sin(), 0.0, tilt.cos());
    let pixels = || (0..width * height).map(|i| [i % width, i / width]);
    let middle = |[x, y]: [u32; 2]| Vec2::new(x as f32, y as f32) + 0.5;
    let eye_distance = pixels().map(|p| -2.0 * normal.z / normal.dot(lens.direction(middle(p)))).collect();
    let image = MirrorImage {
        width,
        height,
        reflector: vec![0; (width * height) as usize],
        radiance: pixels().map(|[x, y]| Vec3::splat((hash2((y * width + x) / 5, 3) & 255) as f32)).collect(),
        distance: pixels().map(distance).collect(),
        views: 1,
        holes: 0,
    };
    Setting { size, lens, normal, image, eye_distance, lobe }
}

impl Setting {
    /// Shows a radiance by pixel.
    pub fn showing(mut self, radiance: impl Fn([u32; 2]) -> f32) -> Self {
        let width = self.size[0];
        for (i, shown) in self.image.radiance.iter_mut().enumerate() {
            *shown = Vec3::splat(radiance([i as u32 % width, i as u32 / width]));
        }
        self
    }

    fn pixel(&self, i: usize) -> [i32; 2] {
        [i as i32 % self.size[0] as i32, i as i32 / self.size[0] as i32]
    }

    /// Number of a pixel.
    pub fn number(&self, [x, y]: [u32; 2]) -> usize {
        (y * self.size[0] + x) as usize
    }

    pub fn pyramid(&self) -> Pyramid {
        Pyramid::new(&self.image, &self.eye_distance, |_| true)
    }

    pub fn point(&self, i: usize) -> GlossyPoint {
        let [x, y] = self.pixel(i);
        let direction = self.lens.direction(Vec2::new(x as f32, y as f32) + 0.5);
        GlossyPoint { from_eye: direction * self.eye_distance[i], normal: self.normal, lobe: self.lobe }
    }

    pub fn variant(&self) -> Vec<Vec3> {
        let pyramid = self.pyramid();
        let table = LobeTable::new(self.lobe);
        (0..self.image.radiance.len())
            .map(|i| {
                if self.image.reflector[i] == NO_REFLECTOR {
                    return Vec3::ZERO;
                }
                let point = self.point(i);
                let support = table.at(point.cos_theta()).support;
                let reflector = self.image.reflector[i];
                gather(&pyramid, &self.lens, &point, self.pixel(i), reflector, support).radiance
            })
            .collect()
    }

    /// The point in the middle, the nearness of what it mirrors and tan β of its lobe.
    pub fn middle(&self) -> (GlossyPoint, f32, f32) {
        let i = self.number([self.size[0] / 2, self.size[1] / 2]);
        let point = self.point(i);
        let nearness = 1.0 / (self.eye_distance[i] + self.image.distance[i]);
        (point, nearness, LobeTable::new(self.lobe).at(point.cos_theta()).support)
    }

    /// One kernel for all pixels of reflector 0.
    pub fn invariant(&self) -> (Vec<Vec3>, SplitKernel) {
        let pyramid = self.pyramid();
        let (point, nearness, support) = self.middle();
        let kernel = SplitKernel::new(&self.lens, &point, nearness, support, pyramid.levels.len());
        let texels = convolve(&pyramid, 0, &kernel);
        let at = |i: usize| kernel.at_pixel(&pyramid, &texels, 0, self.pixel(i), self.image.radiance[i]);
        ((0..self.image.radiance.len()).map(at).collect(), kernel)
    }
}
