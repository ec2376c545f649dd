//! Where pictures are taken behind a reflector, and what they hold (Bastos 1999, §6.6.1).

use crate::{
    mirror::reflectors::Reflector,
    scene::{
        accel::Ray,
        geometry::{Surface, offset_origin},
        world::World,
    },
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Radiance that a surface sends towards a direction, cd/m²; it must not depend on the direction.
pub type Radiance<'a> = dyn Fn(&Surface, Vec3) -> Vec3 + Sync + 'a;

/// How a reflector is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleSettings {
    /// Longest side of an element, m.
    pub element_m: f32,
    /// Centres of projection on each hemisphere.
    pub poses: u32,
    /// Radius of the hemispheres, m: about how far from the reflector one stands.
    pub radius_m: f32,
    /// Width and height of a picture, pixels.
    pub resolution: u32,
}

impl Default for SampleSettings {
    /// Elements of 1.5 m with twelve pictures of 128 × 128 each: the sizes of Bastos 1999, Table 6.1.
    fn default() -> Self {
        Self { element_m: 1.5, poses: 12, radius_m: 1.6, resolution: 128 }
    }
}

/// Least cosine between a pose and the normal: below it a picture is all edge.
const LEAST_COSINE: f32 = 0.2;

/// A picture taken through a reflector element from behind it.
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
    /// Width and height, pixels.
    pub resolution: u32,
    /// Distance from the centre of projection to what each pixel sees, m; infinite where there is nothing.
    pub depth: Vec<f32>,
    /// Triangle that each pixel sees.
    pub triangle: Vec<u32>,
    /// Barycentric weights of its corners 1 and 2.
    pub barycentric: Vec<Vec2>,
    /// Radiance, cd/m² per channel: emitted and diffuse.
    pub colour: Vec<Vec3>,
}

/// A pixel of an image-with-depth in the scene: a small parallelogram that faces its sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Its middle, m.
    pub position: Vec3,
    /// Its sides, m.
    pub sides: [Vec3; 2],
    /// Radiance, cd/m².
    pub colour: Vec3,
    /// Triangle it lies on.
    pub triangle: u32,
    /// Barycentric weights there.
    pub barycentric: Vec2,
}

impl ImageWithDepth {
    /// Takes the picture.
    pub fn new(
        (world, radiance): (&World, &Radiance),
        eye: Vec3,
        [corner, edge_u, edge_v]: [Vec3; 3],
        resolution: u32,
    ) -> Self {
        let mut image = Self {
            eye,
            corner,
            edge_u,
            edge_v,
            resolution,
            depth: Vec::new(),
            triangle: Vec::new(),
            barycentric: Vec::new(),
            colour: Vec::new(),
        };
        // Away from the eye, off the reflector itself.
        let mut normal = edge_u.cross(edge_v).normalize_or_zero();
        if normal.dot(corner - eye) < 0.0 {
            normal = -normal;
        }
        let nothing = (f32::INFINITY, u32::MAX, Vec2::ZERO);
        let seen: Vec<(f32, u32, Vec2)> = (0..resolution * resolution)
            .into_par_iter()
            .map(|pixel| {
                let through = image.through(pixel);
                let direction = (through - eye).normalize_or_zero();
                let origin = offset_origin(through, normal);
                world.accel.trace(&Ray::new(origin, direction)).map_or(nothing, |hit| {
                    let at = world.geometry.surface(hit.triangle, hit.barycentric, direction).position;
                    ((at - eye).length(), hit.triangle, hit.barycentric)
                })
            })
            .collect();
        image.depth = seen.iter().map(|s| s.0).collect();
        image.triangle = seen.iter().map(|s| s.1).collect();
        image.barycentric = seen.iter().map(|s| s.2).collect();
        image.recolour(world, radiance);
        image
    }

    /// Where the ray through a pixel crosses the element, m.
    fn through(&self, pixel: u32) -> Vec3 {
        let [x, y] = [pixel % self.resolution, pixel / self.resolution].map(|i| i as f32 + 0.5);
        self.corner + (self.edge_u * x + self.edge_v * y) / self.resolution as f32
    }

    /// Reads every pixel's colour anew where it was seen: by its id, without a ray.
    pub fn recolour(&mut self, world: &World, radiance: &Radiance) {
        let geometry = &world.geometry;
        let pixels = 0..self.triangle.len() as u32;
        self.colour = pixels
            .into_par_iter()
            .map(|pixel| {
                let i = pixel as usize;
                if self.triangle[i] == u32::MAX {
                    return Vec3::ZERO;
                }
                let direction = (self.through(pixel) - self.eye).normalize_or_zero();
                let surface = geometry.surface(self.triangle[i], self.barycentric[i], direction);
                radiance(&surface, -direction)
            })
            .collect();
    }

    /// A pixel as a point in the scene (Program 6.14); `None` where it sees nothing.
    ///
    /// Its sides are those of the pixel on the element, s times as long, s the ratio of the distances from
    /// the centre of projection to the point and to the element.
    pub fn point(&self, pixel: u32) -> Option<Point> {
        let i = pixel as usize;
        if !self.depth[i].is_finite() {
            return None;
        }
        let out = self.through(pixel) - self.eye;
        let scale = self.depth[i] / out.length();
        let side = |edge: Vec3| edge * (scale / self.resolution as f32);
        Some(Point {
            position: self.eye + out * scale,
            sides: [side(self.edge_u), side(self.edge_v)],
            colour: self.colour[i],
            triangle: self.triangle[i],
            barycentric: self.barycentric[i],
        })
    }

    /// All its points.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        (0..self.triangle.len() as u32).filter_map(|pixel| self.point(pixel))
    }

    /// Middle of its element, m.
    pub fn middle(&self) -> Vec3 {
        self.corner + 0.5 * (self.edge_u + self.edge_v)
    }

    /// Bytes of its pixels: depth, id with its place, and colour.
    pub fn bytes(&self) -> usize {
        self.triangle.len() * (4 + 4 + 8 + 12)
    }
}

/// The pictures of one reflector, element after element.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflectorImages {
    /// Number of the reflector.
    pub reflector: u32,
    /// Pictures of each element: the one that looks straight first.
    pub elements: Vec<Vec<ImageWithDepth>>,
}

impl ReflectorImages {
    /// Samples a reflector.
    pub fn new(
        (world, radiance): (&World, &Radiance),
        number: u32,
        reflector: &Reflector,
        settings: &SampleSettings,
    ) -> Self {
        let geometry = &world.geometry;
        let (across, up) = axes(reflector.normal);
        let corners = reflector.triangles.iter().flat_map(|&t| geometry.positions[t as usize]);
        let places = corners.map(|p| Vec2::new(p.dot(across), p.dot(up)));
        let empty = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let (low, high) = places.fold(empty, |(low, high), p| (low.min(p), high.max(p)));
        let count = ((high - low) / settings.element_m.max(1e-3)).ceil().max(Vec2::ONE);
        let size = (high - low) / count;
        let base = reflector.normal * reflector.offset;
        let mut elements = Vec::new();
        for j in 0..count.y as u32 {
            for i in 0..count.x as u32 {
                let at = low + size * Vec2::new(i as f32, j as f32);
                let window = [base + across * at.x + up * at.y, across * size.x, up * size.y];
                let middle = window[0] + 0.5 * (window[1] + window[2]);
                let poses = (0..settings.poses).map(|pose| {
                    let out = pose_direction(pose, settings.poses);
                    let eye =
                        middle + settings.radius_m * (across * out.x + up * out.y - reflector.normal * out.z);
                    ImageWithDepth::new((world, radiance), eye, window, settings.resolution)
                });
                elements.push(poses.collect());
            }
        }
        Self { reflector: number, elements }
    }

    /// Its pictures.
    pub fn images(&self) -> impl Iterator<Item = &ImageWithDepth> {
        self.elements.iter().flatten()
    }

    /// Reads all colours anew from a solution of the same geometry.
    pub fn recolour(&mut self, world: &World, radiance: &Radiance) {
        self.elements.iter_mut().flatten().for_each(|image| image.recolour(world, radiance));
    }

    /// Bytes of its pictures.
    pub fn bytes(&self) -> usize {
        self.images().map(ImageWithDepth::bytes).sum()
    }
}

/// Unit directions along a plane.
fn axes(normal: Vec3) -> (Vec3, Vec3) {
    let along = if normal.y.abs() > 0.9 {
        (Vec3::X - normal * normal.x).normalize()
    } else {
        Vec3::Y.cross(normal).normalize()
    };
    (along, normal.cross(along))
}

/// Directions spread evenly over a hemisphere about +z, the first straight up, none flatter than
/// [`LEAST_COSINE`].
fn pose_direction(i: u32, count: u32) -> Vec3 {
    let z = 1.0 - (1.0 - LEAST_COSINE) * i as f32 / count.max(1) as f32;
    let (sin, cos) = (0.618_034 * TAU * i as f32).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(radius * cos, radius * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{frame::uniform_direction, random::Rng};

    #[test]
    fn the_axes_of_a_plane_are_a_frame_however_it_is_tilted() {
        for i in 0..1000 {
            let normal = uniform_direction(Rng::new(1, i).next_vec2());
            let (along, up) = axes(normal);
            assert!(along.is_normalized() && up.is_normalized(), "{normal}");
            assert!(along.dot(normal).abs() < 1e-5 && (along.cross(up) - normal).length() < 1e-5, "{normal}");
        }
    }
}
