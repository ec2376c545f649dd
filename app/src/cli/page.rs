//! A page of pictures, lines and words that the command line draws.

use egui::{
    Color32, FontDefinitions, FontId,
    epaint::text::{Fonts, TextOptions},
};
use lumenscope_core::io::png::write_png;
use std::path::Path;

/// Colour of words and ticks.
pub const INK: [u8; 3] = [235, 235, 235];

/// Columns that a character takes at scale 1, and the size of its font.
const ADVANCE: usize = 8;
const FONT_SIZE: f32 = 12.0;
/// Rows from the top of a capital to the baseline at scale 1.
const CAPITAL: usize = 9;

/// A picture to draw and write on.
pub struct Page {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row-major sRGB pixels.
    pub pixels: Vec<[u8; 4]>,
    /// The window's own.
    fonts: Fonts,
}

impl Page {
    /// An empty one.
    pub fn new(width: usize, height: usize) -> Self {
        Self::over(width, height, vec![[28, 28, 30, 255]; width * height])
    }

    /// A picture to write on, row-major sRGB pixels.
    pub fn over(width: usize, height: usize, pixels: Vec<[u8; 4]>) -> Self {
        let fonts = Fonts::new(TextOptions::default(), FontDefinitions::default());
        Self { width, height, pixels, fonts }
    }

    /// Writes it as a PNG.
    ///
    /// # Errors
    /// One line naming the file and the cause.
    pub fn write(&self, path: &Path) -> anyhow::Result<()> {
        Ok(write_png(path, self.width as u32, self.height as u32, &self.pixels)?)
    }

    /// Sets a pixel; nothing outside.
    pub fn put(&mut self, x: usize, y: usize, [r, g, b]: [u8; 3]) {
        if x < self.width && y < self.height {
            self.pixels[y * self.width + x] = [r, g, b, 255];
        }
    }

    /// A line two pixels wide.
    pub fn line(&mut self, a: [f32; 2], b: [f32; 2], ink: [u8; 3]) {
        let steps = (b[0] - a[0]).abs().max((b[1] - a[1]).abs()).ceil().max(1.0);
        for i in 0..=steps as usize {
            let t = i as f32 / steps;
            let [x, y] = [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
            self.put(x as usize, y as usize, ink);
            self.put(x as usize + 1, y as usize, ink);
        }
    }

    /// Text in columns of eight pixels times the scale, the upper left corner of its first capital at a pixel.
    pub fn text(&mut self, x: usize, y: usize, scale: usize, text: &str, ink: [u8; 3]) {
        let font = FontId::monospace(FONT_SIZE * scale as f32);
        let galley =
            self.fonts.with_pixels_per_point(1.0).layout_no_wrap(text.to_owned(), font, Color32::WHITE);
        let atlas = self.fonts.texture_atlas().image();
        let mut covers = Vec::new();
        let glyphs = galley.rows.iter().flat_map(|row| &row.glyphs);
        for (i, glyph) in glyphs.enumerate() {
            let (from, to) = (glyph.uv_rect.min.map(usize::from), glyph.uv_rect.max.map(usize::from));
            let left = (x + ADVANCE * scale * i) as f32 + glyph.uv_rect.offset.x;
            let top = (y + CAPITAL * scale) as f32 + glyph.uv_rect.offset.y;
            for row in from[1]..to[1] {
                for column in from[0]..to[0] {
                    let at = [left + (column - from[0]) as f32, top + (row - from[1]) as f32];
                    if at[0] >= 0.0 && at[1] >= 0.0 {
                        let covered = f32::from(atlas[(column, row)].a()) / 255.0;
                        covers.push((at[0] as usize, at[1] as usize, covered));
                    }
                }
            }
        }
        for (x, y, covered) in covers {
            self.blend(x, y, ink, covered);
        }
    }

    /// Mixes a colour into a pixel by a share; nothing outside.
    fn blend(&mut self, x: usize, y: usize, ink: [u8; 3], share: f32) {
        if x < self.width && y < self.height {
            let pixel = &mut self.pixels[y * self.width + x];
            for (value, ink) in pixel.iter_mut().zip(ink) {
                *value = (f32::from(*value) + (f32::from(ink) - f32::from(*value)) * share).round() as u8;
            }
        }
    }

    /// Text on a ground of its own, in the middle of a place.
    pub fn plate(&mut self, x: f32, y: f32, text: &str, ground: [u8; 3]) {
        let (w, h) = (8 * text.chars().count() + 6, 12);
        let (left, top) = ((x as usize).saturating_sub(w / 2), (y as usize).saturating_sub(h / 2));
        for i in 0..w * h {
            self.put(left + i % w, top + i / w, ground);
        }
        self.text(left + 3, top + 2, 1, text, INK);
    }
}
