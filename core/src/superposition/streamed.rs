//! Geometry put in after the solve and lit from the volume as it streams by (Greger 1996, §5.2).
//!
//! Triangles come in strips; each is lit at its vertices, drawn into the picture and forgotten, so that a
//! model far larger than memory can be shown in a room solved without it. Direct light may be evaluated
//! at each pixel once all has been drawn: one receiver a pixel is kept, not one a triangle.
//!
//! Limits, the thesis's: what is put in so casts no shadow, on the room or on itself, and sends no light.

use super::{
    gbuffer::GBuffer,
    layers::{Layer, Layers},
};
use crate::{
    irradiance_volume::IrradianceVolume,
    math::{
        part::Part,
        progress::{Cancelled, Progress},
        random::hash2,
    },
    scene::{
        accel::{Ray, barycentric},
        camera::Camera,
        direct::{Receiver, total_irradiance},
        world::World,
    },
};
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::{
    f32::consts::FRAC_1_PI,
    time::{Duration, Instant},
};

/// Nothing nearer to the eye is drawn, m.
const NEAR: f32 = 1e-3;

/// A strip of triangles.
#[derive(Clone, Copy, Debug)]
pub struct Strip<'a> {
    /// Positions, m.
    pub positions: &'a [Vec3],
    /// Unit normals.
    pub normals: &'a [Vec3],
    /// Triangles, counter-clockwise from the front.
    pub triangles: &'a [[u32; 3]],
}

/// What a pixel shows of the streamed geometry.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    position: Vec3,
    normal: Vec3,
    direct: Vec3,
    indirect: Vec3,
}

/// What streaming took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StreamCounts {
    /// Triangles that came by.
    pub polygons: usize,
    /// Vertices lit: queries of the volume a part.
    pub vertices: usize,
    /// Most bytes held at once of what came by: a strip, its queries and its light.
    pub held_bytes: usize,
    /// Time spent asking the volume.
    pub shading: Duration,
    /// Time spent drawing.
    pub drawing: Duration,
}

/// A picture that strips are drawn over.
pub struct StreamedPicture<'a> {
    camera: Camera,
    size: UVec2,
    volume: &'a IrradianceVolume,
    reflectance: Vec3,
    depth: Vec<f32>,
    seen: Vec<Option<Seen>>,
    counts: StreamCounts,
}

impl<'a> StreamedPicture<'a> {
    /// Over what a G-buffer shows, lit from a volume, with one reflectance.
    pub fn new(buffer: &GBuffer, camera: &Camera, volume: &'a IrradianceVolume, reflectance: Vec3) -> Self {
        Self {
            camera: *camera,
            size: UVec2::new(buffer.width, buffer.height),
            volume,
            reflectance,
            depth: buffer.depth.clone(),
            seen: vec![None; buffer.depth.len()],
            counts: StreamCounts::default(),
        }
    }

    /// Lights a strip at its vertices and draws it; nothing of it is kept but the pixels it shows in.
    ///
    /// # Panics
    /// If positions and normals differ in number, or a triangle names a vertex that is not there.
    pub fn draw(&mut self, strip: &Strip) {
        assert_eq!(strip.positions.len(), strip.normals.len(), "one normal a position");
        let start = Instant::now();
        let queries: Vec<(Vec3, Vec3)> =
            strip.positions.iter().copied().zip(strip.normals.iter().copied()).collect();
        let mut light = [Part::Direct, Part::Indirect].map(|_| vec![Vec3::ZERO; queries.len()]);
        for (part, out) in [Part::Direct, Part::Indirect].into_iter().zip(&mut light) {
            self.volume.irradiance_many(&queries, part, out);
        }
        self.counts.shading += start.elapsed();
        self.counts.polygons += strip.triangles.len();
        self.counts.vertices += strip.positions.len();
        let held = size_of_val(strip.positions) + size_of_val(strip.normals) + size_of_val(strip.triangles);
        let asked = size_of_val(&queries[..]) + light.iter().map(|l| size_of_val(&l[..])).sum::<usize>();
        self.counts.held_bytes = self.counts.held_bytes.max(held + asked);
        let start = Instant::now();
        for triangle in strip.triangles {
            self.triangle(strip, &light, triangle.map(|i| i as usize));
        }
        self.counts.drawing += start.elapsed();
    }

    fn triangle(&mut self, strip: &Strip, [direct, indirect]: &[Vec<Vec3>; 2], ids: [usize; 3]) {
        let corners = ids.map(|i| strip.positions[i]);
        let front = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        if front.dot(corners[0] - self.camera.eye) >= 0.0 {
            return;
        }
        let view = self.camera.view_from_world();
        let seen = corners.map(|c| view.transform_point3(c));
        if seen.iter().any(|s| s.z > -NEAR) {
            return;
        }
        let size = self.size.as_vec2();
        let focal = 0.5 * size.y / (0.5 * self.camera.vertical_fov).tan();
        let pixel = seen.map(|s| 0.5 * size + Vec2::new(s.x, -s.y) * (focal / -s.z));
        let low = (pixel[0].min(pixel[1]).min(pixel[2]) - 0.5).ceil().clamp(Vec2::ZERO, size).as_uvec2();
        let high = (pixel[0].max(pixel[1]).max(pixel[2]) + 0.5).floor().clamp(Vec2::ZERO, size).as_uvec2();
        for y in low.y..high.y {
            for x in low.x..high.x {
                let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let side = |a: Vec2, b: Vec2| (b - a).perp_dot(at - a);
                let around = [0, 1, 2].map(|i| side(pixel[i], pixel[(i + 1) % 3]));
                // Pixels' y runs down, so fronts turn the other way; both are taken, backs are gone.
                if !(around.iter().all(|s| *s <= 0.0) || around.iter().all(|s| *s >= 0.0)) {
                    continue;
                }
                let direction = self.camera.ray_direction(at / size, size.x / size.y);
                let ray = Ray::new(self.camera.eye, direction);
                let t = front.dot(corners[0] - ray.origin) / front.dot(direction);
                let index = (y * self.size.x + x) as usize;
                if !(t > NEAR && t < self.depth[index]) {
                    continue;
                }
                let weights = barycentric(&ray, corners);
                let mix = |v: &[Vec3]| {
                    v[ids[0]] * (1.0 - weights.x - weights.y) + v[ids[1]] * weights.x + v[ids[2]] * weights.y
                };
                self.depth[index] = t;
                self.seen[index] = Some(Seen {
                    position: ray.origin + direction * t,
                    normal: mix(strip.normals).normalize_or(front.normalize_or(Vec3::Y)),
                    direct: mix(direct),
                    indirect: mix(indirect),
                });
            }
        }
    }

    /// What came by so far.
    pub fn counts(&self) -> StreamCounts {
        self.counts
    }

    /// Pixels in which the streamed geometry shows.
    pub fn pixels(&self) -> usize {
        self.seen.iter().flatten().count()
    }

    /// Puts the streamed geometry into the layers of a picture in cd/m², L = ρ E / π. Direct light by
    /// `shadow_rays` rays an area emitter at each pixel, or, with 0, as the volume has it.
    ///
    /// # Errors
    /// [`Cancelled`]; the layers are as they were.
    ///
    /// # Panics
    /// If the layers have another size.
    pub fn composite(
        &self,
        layers: &mut Layers,
        world: &World,
        shadow_rays: u32,
        progress: &Progress,
    ) -> Result<(), Cancelled> {
        assert_eq!(layers.images[0].pixels.len(), self.seen.len(), "the layers have another size");
        let direct_of = |(i, seen): (usize, &Option<Seen>)| -> Result<Vec3, Cancelled> {
            if progress.is_cancelled() {
                return Err(Cancelled);
            }
            let Some(seen) = seen else { return Ok(Vec3::ZERO) };
            Ok(match shadow_rays {
                0 => seen.direct,
                n => {
                    let receiver = Receiver::new(seen.position, seen.normal);
                    total_irradiance(world, &receiver, n, hash2(i as u32, n))
                }
            })
        };
        let direct: Vec<Vec3> =
            self.seen.par_iter().enumerate().map(direct_of).collect::<Result<_, Cancelled>>()?;
        let shown = self.seen.iter().zip(direct).enumerate();
        for (i, (seen, direct)) in shown.filter_map(|(i, (s, d))| Some((i, (s.as_ref()?, d)))) {
            layers.images.iter_mut().for_each(|image| image.pixels[i] = Vec3::ZERO);
            let share = self.reflectance * FRAC_1_PI;
            layers.images[Layer::Direct as usize].pixels[i] = share * direct;
            layers.images[Layer::Indirect as usize].pixels[i] = share * seen.indirect;
        }
        Ok(())
    }
}
