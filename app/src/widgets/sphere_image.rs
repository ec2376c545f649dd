//! A sphere of values by direction, drawn from outside: the colour at a point of the ball is the
//! value in the direction that points from its middle to there.

use egui::{Color32, ColorImage, TextureHandle, TextureOptions};
use glam::{Mat3, Vec2, Vec3};
use lumenscope_core::math::sphere_map::DirectionBins;

/// Values by direction.
#[derive(Clone, Copy)]
pub struct SphereValues<'a> {
    /// Layout of the bins.
    pub bins: DirectionBins,
    /// One value a bin.
    pub values: &'a [Vec3],
}

impl SphereValues<'_> {
    /// Value of the bin that holds a direction.
    pub fn nearest(&self, direction: Vec3) -> Vec3 {
        self.values.get(self.bins.bin(direction)).copied().unwrap_or(Vec3::ZERO)
    }

    /// Bilinear value over a hemisphere's square; across the equator lies the same cell of the other.
    pub fn smooth(&self, direction: Vec3) -> Vec3 {
        let n = self.bins.n() as i32;
        let (square, lower) = self.bins.square(direction);
        let p = square * n as f32 - Vec2::splat(0.5);
        let base = p.floor();
        let f = p - base;
        let value = |x: i32, y: i32| {
            let outside = (x < 0 || x >= n) != (y < 0 || y >= n);
            let cell = y.clamp(0, n - 1) * n + x.clamp(0, n - 1);
            let bin = cell + if lower != outside { n * n } else { 0 };
            self.values.get(bin as usize).copied().unwrap_or(Vec3::ZERO)
        };
        let (x, y) = (base.x as i32, base.y as i32);
        let top = value(x, y).lerp(value(x + 1, y), f.x);
        let bottom = value(x, y + 1).lerp(value(x + 1, y + 1), f.x);
        top.lerp(bottom, f.y)
    }

    /// Value by bin or smooth.
    pub fn value(&self, direction: Vec3, smooth: bool) -> Vec3 {
        if smooth { self.smooth(direction) } else { self.nearest(direction) }
    }
}

/// Direction from the middle of the ball to where `at` in [−1, 1]² (y up) is seen on it.
///
/// Columns of `world_from_view`: right, up and towards the viewer.
pub fn direction_at(at: Vec2, world_from_view: Mat3) -> Option<Vec3> {
    let rest = 1.0 - at.length_squared();
    (rest >= 0.0).then(|| (world_from_view * at.extend(rest.sqrt())).normalize_or(Vec3::Y))
}

/// Draws the ball, orthographic, edges softened; `colour` brings a value to the display.
pub fn draw(
    sphere: &SphereValues<'_>,
    world_from_view: Mat3,
    size: usize,
    smooth: bool,
    colour: impl Fn(Vec3) -> [u8; 3],
) -> ColorImage {
    let radius = 0.5 * size as f32 - 1.0;
    let centre = 0.5 * size as f32;
    let mut pixels = Vec::with_capacity(size * size);
    for row in 0..size {
        for column in 0..size {
            let offset = Vec2::new(column as f32 + 0.5 - centre, centre - row as f32 - 0.5);
            let coverage = (radius + 0.5 - offset.length()).clamp(0.0, 1.0);
            if coverage == 0.0 {
                pixels.push(Color32::TRANSPARENT);
                continue;
            }
            let at = (offset / radius).clamp_length_max(0.9999);
            let direction = direction_at(at, world_from_view).unwrap_or(Vec3::Y);
            let [r, g, b] = colour(sphere.value(direction, smooth));
            pixels.push(Color32::from_rgb(r, g, b).gamma_multiply(coverage));
        }
    }
    ColorImage::new([size, size], pixels)
}

/// Draws one hemisphere's square, `size` pixels wide, u to the right and v down.
pub fn draw_square(
    sphere: &SphereValues<'_>,
    lower: bool,
    size: usize,
    colour: impl Fn(Vec3) -> [u8; 3],
) -> ColorImage {
    let n = sphere.bins.n() as usize;
    let mut pixels = Vec::with_capacity(size * size);
    for row in 0..size {
        for column in 0..size {
            let cell = (row * n / size) * n + column * n / size;
            let bin = cell + if lower { n * n } else { 0 };
            let [r, g, b] = colour(sphere.values.get(bin).copied().unwrap_or(Vec3::ZERO));
            pixels.push(Color32::from_rgb(r, g, b));
        }
    }
    ColorImage::new([size, size], pixels)
}

/// Images kept as textures between frames, redrawn when their key changes.
#[derive(Clone, Default)]
pub struct ImageSlot {
    key: u64,
    texture: Option<TextureHandle>,
}

impl ImageSlot {
    /// The texture of an image, drawn anew only if `key` differs from the last.
    pub fn texture(
        &mut self,
        ctx: &egui::Context,
        name: &str,
        key: u64,
        draw: impl FnOnce() -> ColorImage,
    ) -> egui::TextureId {
        match &mut self.texture {
            Some(texture) if self.key == key => texture.id(),
            Some(texture) => {
                self.key = key;
                texture.set(draw(), TextureOptions::LINEAR);
                texture.id()
            }
            None => {
                let texture = ctx.load_texture(name, draw(), TextureOptions::LINEAR);
                self.key = key;
                let id = texture.id();
                self.texture = Some(texture);
                id
            }
        }
    }
}

/// Key of anything that hashes, for [`ImageSlot`].
pub fn key(of: impl std::hash::Hash) -> u64 {
    use std::hash::{DefaultHasher, Hasher};
    let mut hasher = DefaultHasher::new();
    of.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_values_meet_across_the_equator_and_hit_bin_centres() {
        let bins = DirectionBins::new(9);
        let values: Vec<Vec3> = (0..bins.len()).map(|b| bins.centre(b) * 0.5 + Vec3::splat(0.5)).collect();
        let sphere = SphereValues { bins, values: &values };
        for (bin, value) in values.iter().enumerate() {
            assert!((sphere.smooth(bins.centre(bin)) - *value).length() < 1e-4);
        }
        for i in 0..360 {
            let (sin, cos) = (i as f32).to_radians().sin_cos();
            let above = sphere.smooth(Vec3::new(cos, 1e-4, sin).normalize());
            let below = sphere.smooth(Vec3::new(cos, -1e-4, sin).normalize());
            // Two sides of one line, 2e-4 apart, values that change by at most ~1 a radian.
            assert!((above - below).length() < 0.02, "at {i}: {above} {below}");
        }
    }

    #[test]
    fn the_ball_shows_the_side_that_faces_the_viewer() {
        let towards_viewer = direction_at(Vec2::ZERO, Mat3::IDENTITY).unwrap();
        assert_eq!(towards_viewer, Vec3::Z);
        assert!(direction_at(Vec2::new(0.8, 0.8), Mat3::IDENTITY).is_none());
    }
}
