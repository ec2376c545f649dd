//! Drawing an [`InspectionScene`] over a picture on the CPU: the specification of the GPU's inspection passes.
//!
//! Spheres are met by each pixel's ray, lines and meshes are projected; all are tested against the
//! depth of the picture and of each other. Colours are data: nothing here is shaded.

use super::gbuffer::{GBuffer, pixel_direction};
use crate::{
    inspection::{ColouredMesh, InspectionScene, SphereGlyph},
    math::{colour::srgb8, false_colour::FalseColour, sphere_map::DirectionBins},
    scene::{
        accel::{Ray, barycentric},
        camera::Camera,
    },
};
use glam::{UVec2, Vec2, Vec3};

/// Width of lines, in pixels.
pub const LINE_WIDTH: f32 = 1.5;
/// Lines and meshes are drawn this share of their distance nearer, so that they show on surfaces.
pub const DEPTH_BIAS: f32 = 2e-3;
/// Nothing nearer to the eye than this share of a metre is drawn.
pub const NEAR: f32 = 1e-3;

/// Draws an inspection scene over a display picture, behind what the G-buffer says is nearer.
///
/// # Panics
/// If the picture and the G-buffer differ in size.
pub fn draw(
    picture: &mut [[u8; 4]],
    buffer: &GBuffer,
    camera: &Camera,
    scene: &InspectionScene,
    colour: &FalseColour,
) {
    assert_eq!(picture.len(), buffer.depth.len(), "picture and G-buffer differ in size");
    let size = UVec2::new(buffer.width, buffer.height);
    let mut canvas =
        Canvas { picture, depth: buffer.depth.clone(), projection: Projection::new(camera, size) };
    if let Some(bins) = scene.bins {
        for sphere in &scene.spheres {
            canvas.sphere(sphere, &scene.sphere_bins, bins, colour);
        }
    }
    for mesh in &scene.meshes {
        canvas.mesh(mesh, colour);
    }
    for line in &scene.lines {
        canvas.line(line.ends, line.colour, 1.0);
    }
    for line in &scene.value_lines {
        canvas.line(line.ends, colour.colour(line.value), 1.0 - line.transparency);
    }
}

/// Value of a sphere in a direction; zero where the bins are missing.
pub fn sphere_value(sphere: &SphereGlyph, values: &[Vec3], bins: DirectionBins, direction: Vec3) -> Vec3 {
    values.get(sphere.first_bin as usize + bins.bin(direction)).copied().unwrap_or(Vec3::ZERO)
}

/// Nearest distance at which a ray of unit direction meets a sphere from outside.
pub fn ray_sphere(origin: Vec3, direction: Vec3, centre: Vec3, radius: f32) -> Option<f32> {
    let to_centre = centre - origin;
    let along = to_centre.dot(direction);
    // Distance of the centre from the ray, without the cancellation of |c|² − along².
    let off = to_centre - direction * along;
    let inside = radius * radius - off.length_squared();
    let t = along - inside.max(0.0).sqrt();
    (inside >= 0.0 && t > NEAR).then_some(t)
}

/// Where a point shows in a picture, pixels from the upper left corner; `None` behind the eye, beside the picture or
/// behind what the G-buffer has there. Words stand off what they are written on by less than 1 % of their distance.
pub fn place_of(camera: &Camera, buffer: &GBuffer, position: Vec3) -> Option<Vec2> {
    let projection = Projection::new(camera, UVec2::new(buffer.width, buffer.height));
    let view = projection.view(position);
    let at = (view.z > NEAR).then(|| projection.pixel(view))?;
    let inside = at.cmpge(Vec2::ZERO).all() && at.cmplt(projection.size.as_vec2()).all();
    let pixel = inside.then(|| (at.y as u32 * buffer.width + at.x as u32) as usize)?;
    (position.distance(camera.eye) < 1.01 * buffer.depth[pixel]).then_some(at)
}

/// From world to pixels.
struct Projection {
    camera: Camera,
    size: UVec2,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Pixels to one unit of slope.
    focal: f32,
}

impl Projection {
    fn new(camera: &Camera, size: UVec2) -> Self {
        let view = camera.view_from_world();
        let row = |i: usize| view.row(i).truncate();
        let focal = 0.5 * size.y as f32 / (0.5 * camera.vertical_fov).tan();
        Self { camera: *camera, size, right: row(0), up: row(1), forward: -row(2), focal }
    }

    /// (right, up, forward) coordinates from the eye, m.
    fn view(&self, position: Vec3) -> Vec3 {
        let p = position - self.camera.eye;
        Vec3::new(p.dot(self.right), p.dot(self.up), p.dot(self.forward))
    }

    /// Pixel coordinates of a point in front of the eye.
    fn pixel(&self, view: Vec3) -> Vec2 {
        let slope = Vec2::new(view.x, -view.y) / view.z;
        0.5 * self.size.as_vec2() + slope * self.focal
    }

    /// Pixels whose centres may lie in a rectangle.
    fn pixels(&self, low: Vec2, high: Vec2) -> impl Iterator<Item = (u32, u32)> + use<> {
        let limit = self.size.as_vec2();
        let low = (low - 0.5).floor().clamp(Vec2::ZERO, limit).as_uvec2();
        let high = (high + 0.5).ceil().clamp(Vec2::ZERO, limit).as_uvec2();
        (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| (x, y)))
    }

    fn direction(&self, x: u32, y: u32) -> Vec3 {
        pixel_direction(&self.camera, self.size, UVec2::new(x, y), Vec2::splat(0.5))
    }

    /// Rectangle around the corners of a box given by its low and high view coordinates; the whole
    /// picture where it reaches behind the eye.
    fn rectangle(&self, low: Vec3, high: Vec3) -> (Vec2, Vec2) {
        if low.z <= NEAR {
            return (Vec2::ZERO, self.size.as_vec2());
        }
        let mut bounds = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for i in 0..8 {
            let pick = |bit: u32, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            let corner = Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
            let p = self.pixel(corner);
            bounds = (bounds.0.min(p), bounds.1.max(p));
        }
        bounds
    }
}

struct Canvas<'a> {
    picture: &'a mut [[u8; 4]],
    depth: Vec<f32>,
    projection: Projection,
}

impl Canvas<'_> {
    fn put(&mut self, x: u32, y: u32, distance: f32, colour: Vec3, opacity: f32) {
        let i = (y * self.projection.size.x + x) as usize;
        if distance < self.depth[i] {
            self.depth[i] = distance;
            let over = |new: u8, old: u8| {
                (f32::from(old) + (f32::from(new) - f32::from(old)) * opacity).round() as u8
            };
            let ([r, g, b], old) = (srgb8(colour), self.picture[i]);
            self.picture[i] = [over(r, old[0]), over(g, old[1]), over(b, old[2]), 255];
        }
    }

    fn sphere(&mut self, sphere: &SphereGlyph, values: &[Vec3], bins: DirectionBins, colour: &FalseColour) {
        let centre = self.projection.view(sphere.centre);
        if centre.z < -sphere.radius {
            return;
        }
        let (low, high) = self.projection.rectangle(centre - sphere.radius, centre + sphere.radius);
        let eye = self.projection.camera.eye;
        for (x, y) in self.projection.pixels(low, high) {
            let direction = self.projection.direction(x, y);
            if let Some(t) = ray_sphere(eye, direction, sphere.centre, sphere.radius) {
                let normal = ((eye - sphere.centre) + direction * t) / sphere.radius;
                let value = sphere_value(sphere, values, bins, normal.normalize_or(Vec3::Y));
                self.put(x, y, t, colour.colour_of(value), 1.0);
            }
        }
    }

    fn mesh(&mut self, mesh: &ColouredMesh, colour: &FalseColour) {
        let eye = self.projection.camera.eye;
        for triangle in &mesh.triangles {
            let corners = triangle.map(|i| mesh.positions[i as usize]);
            let values = triangle.map(|i| mesh.values[i as usize]);
            let view = corners.map(|c| self.projection.view(c));
            let [low, high] = [view[0].min(view[1]).min(view[2]), view[0].max(view[1]).max(view[2])];
            if high.z <= NEAR {
                continue;
            }
            let (low, high) = if low.z > NEAR {
                let p = view.map(|v| self.projection.pixel(v));
                (p[0].min(p[1]).min(p[2]), p[0].max(p[1]).max(p[2]))
            } else {
                (Vec2::ZERO, self.projection.size.as_vec2())
            };
            for (x, y) in self.projection.pixels(low, high) {
                let ray = Ray::new(eye, self.projection.direction(x, y));
                if let Some((t, weights)) = meet(&ray, corners) {
                    let value =
                        values[0] + (values[1] - values[0]) * weights.x + (values[2] - values[0]) * weights.y;
                    self.put(x, y, t * (1.0 - DEPTH_BIAS), colour.colour_of(value), 1.0 - mesh.transparency);
                }
            }
        }
    }

    fn line(&mut self, ends: [Vec3; 2], colour: Vec3, opacity: f32) {
        let [mut a, mut b] = ends.map(|e| self.projection.view(e));
        if a.z.max(b.z) <= NEAR {
            return;
        }
        let clip = |inside: Vec3, outside: Vec3| {
            if outside.z >= NEAR {
                outside
            } else {
                inside.lerp(outside, (inside.z - NEAR) / (inside.z - outside.z))
            }
        };
        (a, b) = (clip(b, a), clip(a, b));
        let [pa, pb] = [a, b].map(|v| self.projection.pixel(v));
        let along = pb - pa;
        let length = along.length();
        let tangent = if length > 0.0 { along / length } else { Vec2::X };
        let margin = Vec2::splat(LINE_WIDTH);
        for (x, y) in self.projection.pixels(pa.min(pb) - margin, pa.max(pb) + margin) {
            let offset = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - pa;
            let s = offset.dot(tangent);
            if offset.perp_dot(tangent).abs() > 0.5 * LINE_WIDTH || s < 0.0 || s > length {
                continue;
            }
            let share = if length > 0.0 { s / length } else { 0.0 };
            let z = 1.0 / ((1.0 - share) / a.z + share / b.z);
            let distance = z / self.projection.direction(x, y).dot(self.projection.forward);
            self.put(x, y, distance * (1.0 - DEPTH_BIAS), colour, opacity);
        }
    }
}

/// Where a ray meets a triangle, from either side: its distance and barycentric weights.
fn meet(ray: &Ray, corners: [Vec3; 3]) -> Option<(f32, Vec2)> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let t = normal.dot(a - ray.origin) / normal.dot(ray.direction);
    if !t.is_finite() || t <= NEAR {
        return None;
    }
    // The clamped weights give the point back only where it lies inside.
    let weights = barycentric(ray, corners);
    let nearest = a + (b - a) * weights.x + (c - a) * weights.y;
    let miss = (ray.origin + ray.direction * t).distance_squared(nearest);
    (miss <= 1e-10 * (t * t).max(normal.length())).then_some((t, weights))
}
