//! A picture taken from behind a reflector, and the points its pixels are (Bastos 1999, §6.6.1, 6.6.3).

use super::visible::Quadtree;
use crate::scene::{
    accel::{Ray, barycentric},
    geometry::{Surface, offset_origin},
    world::World,
};
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;

/// Radiance that a surface sends towards a direction, cd/m²; it must not depend on the direction.
pub type Radiance<'a> = dyn Fn(&Surface, Vec3) -> Vec3 + Sync + 'a;

/// Triangle of a pixel that sees nothing.
pub const NOTHING: u32 = u32::MAX;

/// Sizes of the scene that a point which is nothing lies away: its direction is what matters.
const FAR: f32 = 1e4;

/// What pictures are taken of.
pub struct Surroundings<'a> {
    /// The scene.
    pub world: &'a World,
    /// Distance of points that are nothing, m.
    pub far_m: f32,
}

impl<'a> Surroundings<'a> {
    /// A scene.
    pub fn new(world: &'a World) -> Self {
        let (low, high) = world.geometry.bounds();
        Self { world, far_m: FAR * (high - low).length() }
    }
}

/// A picture taken through a reflector element from behind it; its pixels are numbered in Z-order.
///
/// The centre of projection and the edges of the element take the place of the thesis's inverse matrix (Class 6.10).
#[derive(Clone, Debug, PartialEq)]
pub struct ImageWithDepth {
    /// Centre of projection, m.
    pub eye: Vec3,
    /// The element's corner, m; its pixels run along the edges.
    pub corner: Vec3,
    /// First edge, m.
    pub edge_u: Vec3,
    /// Second edge, m.
    pub edge_v: Vec3,
    /// Width and height, pixels: a power of two.
    pub resolution: u32,
    /// Distance of what each pixel sees over that of the element along the same ray; where it sees nothing, that of
    /// a point very far away.
    pub scale: Vec<f32>,
    /// Triangle that each pixel sees, or [`NOTHING`].
    pub triangle: Vec<u32>,
    /// Radiance, cd/m² per channel, emitted and diffuse; empty until it is [read](Self::recolour).
    pub colour: Vec<Vec3>,
    /// Boxes of its points.
    pub tree: Quadtree,
}

/// A pixel of an image-with-depth in the scene: a small parallelogram that faces its sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Its middle, m.
    pub position: Vec3,
    /// Its sides, m.
    pub sides: [Vec3; 2],
    /// Radiance, cd/m²; black where the sample has no colours.
    pub colour: Vec3,
    /// Triangle it lies on, or [`NOTHING`].
    pub triangle: u32,
}

impl ImageWithDepth {
    /// Takes the picture, without colours.
    ///
    /// # Panics
    /// If the resolution is not a power of two.
    pub fn new(
        around: &Surroundings,
        eye: Vec3,
        [corner, edge_u, edge_v]: [Vec3; 3],
        resolution: u32,
    ) -> Self {
        assert!(resolution.is_power_of_two(), "{resolution} pixels across are no power of two");
        let mut image = Self {
            eye,
            corner,
            edge_u,
            edge_v,
            resolution,
            scale: Vec::new(),
            triangle: Vec::new(),
            colour: Vec::new(),
            tree: Quadtree::default(),
        };
        let pixels = (0..resolution * resolution).into_par_iter();
        let seen: Vec<(f32, u32)> = pixels.map(|pixel| image.see(around, pixel)).collect();
        image.scale = seen.iter().map(|s| s.0).collect();
        image.triangle = seen.iter().map(|s| s.1).collect();
        image.tree = Quadtree::new(&image);
        image
    }

    /// What a pixel sees: the distance over that of the element, and the triangle.
    pub(super) fn see(&self, around: &Surroundings, pixel: u32) -> (f32, u32) {
        let Surroundings { world, far_m } = around;
        let out = self.out(pixel);
        let length = out.length();
        let direction = out / length;
        // Away from the eye, off the reflector itself.
        let normal = self.edge_u.cross(self.edge_v).normalize_or_zero();
        let away = if normal.dot(self.corner - self.eye) < 0.0 { -normal } else { normal };
        let origin = offset_origin(self.eye + out, away);
        world.accel.trace(&Ray::new(origin, direction)).map_or((far_m / length, NOTHING), |hit| {
            let at = world.geometry.surface(hit.triangle, hit.barycentric, direction).position;
            ((at - self.eye).length() / length, hit.triangle)
        })
    }

    /// Column and row, from the element's corner, at which a place is seen; `None` beside the eye and behind it.
    pub(super) fn seen_at(&self, position: Vec3) -> Option<Vec2> {
        let normal = self.edge_u.cross(self.edge_v);
        let out = position - self.eye;
        let scale = normal.dot(self.corner - self.eye) / normal.dot(out);
        let at = self.eye + out * scale - self.corner;
        let along = |edge: Vec3| at.dot(edge) / edge.length_squared() * self.resolution as f32;
        (scale.is_finite() && scale > 0.0).then(|| Vec2::new(along(self.edge_u), along(self.edge_v)))
    }

    /// From the centre of projection to where the ray through a pixel crosses the element, m.
    pub(super) fn out(&self, pixel: u32) -> Vec3 {
        let at = (place(pixel).as_vec2() + 0.5) / self.resolution as f32;
        self.corner + self.edge_u * at.x + self.edge_v * at.y - self.eye
    }

    /// Reads every pixel's colour anew where it was seen: by its id, without tracing a ray.
    pub fn recolour(&mut self, world: &World, radiance: &Radiance) {
        let geometry = &world.geometry;
        let pixels = 0..self.triangle.len() as u32;
        self.colour = pixels
            .into_par_iter()
            .map(|pixel| {
                let triangle = self.triangle[pixel as usize];
                if triangle == NOTHING {
                    return Vec3::ZERO;
                }
                let direction = self.out(pixel).normalize_or_zero();
                let corners = geometry.positions[triangle as usize];
                let weights = barycentric(&Ray::new(self.eye, direction), corners);
                radiance(&geometry.surface(triangle, weights, direction), -direction)
            })
            .collect();
    }

    /// A pixel as a point in the scene (Program 6.14).
    ///
    /// Its sides are those of the pixel on the element, s times as long, s the ratio of the distances from
    /// the centre of projection to the point and to the element.
    pub fn point(&self, pixel: u32) -> Point {
        let i = pixel as usize;
        let scale = self.scale[i];
        let side = |edge: Vec3| edge * (scale / self.resolution as f32);
        Point {
            position: self.eye + self.out(pixel) * scale,
            sides: [side(self.edge_u), side(self.edge_v)],
            colour: self.colour.get(i).copied().unwrap_or_default(),
            triangle: self.triangle[i],
        }
    }

    /// All its points.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        (0..self.triangle.len() as u32).map(|pixel| self.point(pixel))
    }

    /// Middle of its element, m.
    pub fn middle(&self) -> Vec3 {
        self.corner + 0.5 * (self.edge_u + self.edge_v)
    }

    /// Bytes of its pixels and their boxes.
    pub fn bytes(&self) -> usize {
        self.scale.len() * 4 + self.triangle.len() * 4 + self.colour.len() * 12 + self.tree.bytes()
    }
}

/// Column and row of a pixel by its number in Z-order: even bits and odd ones. Has a twin in
/// `shaders/mirror/splat.wgsl`.
pub fn place(pixel: u32) -> UVec2 {
    let compact = |v: u32| {
        let v = v & 0x5555_5555;
        let v = (v | v >> 1) & 0x3333_3333;
        let v = (v | v >> 2) & 0x0F0F_0F0F;
        let v = (v | v >> 4) & 0x00FF_00FF;
        (v | v >> 8) & 0xFFFF
    };
    UVec2::new(compact(pixel), compact(pixel >> 1))
}
