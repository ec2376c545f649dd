//! Spheres of values as images of the window.

use egui::{Color32, ColorImage, TextureHandle, TextureOptions};
use glam::{Mat3, Vec3};
pub use lumenscope_core::math::sphere_values::{SphereValues, direction_at};

/// Draws the ball, orthographic, edges softened; `colour` brings a value to the display.
pub fn draw(
    sphere: &SphereValues<'_>,
    world_from_view: Mat3,
    size: usize,
    smooth: bool,
    colour: impl Fn(Vec3) -> [u8; 3],
) -> ColorImage {
    image(size, sphere.ball(world_from_view, size, smooth, colour))
}

/// Square premultiplied pixels as an image of the window.
pub fn image(size: usize, pixels: Vec<[u8; 4]>) -> ColorImage {
    let colours = pixels.into_iter().map(|[r, g, b, a]| Color32::from_rgba_premultiplied(r, g, b, a));
    ColorImage::new([size, size], colours.collect())
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
