//! A page of pictures, lines and words that the command line draws.

use font8x8::UnicodeFonts;
use lumenscope_core::io::png::write_png;
use std::path::Path;

/// Colour of words and ticks.
pub const INK: [u8; 3] = [235, 235, 235];

/// A picture to draw and write on.
pub struct Page {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row-major sRGB pixels.
    pub pixels: Vec<[u8; 4]>,
}

impl Page {
    /// An empty one.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![[28, 28, 30, 255]; width * height] }
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

    /// Text with its upper left corner at a pixel; what the font lacks shows as a question mark.
    pub fn text(&mut self, x: usize, y: usize, scale: usize, text: &str, ink: [u8; 3]) {
        for (i, c) in text.chars().enumerate() {
            let plain = match c {
                '₀' => '0',
                '−' | '–' => '-',
                '’' => '\'',
                other => other,
            };
            let glyph = font8x8::BASIC_FONTS
                .get(plain)
                .or_else(|| font8x8::LATIN_FONTS.get(plain))
                .or_else(|| font8x8::GREEK_FONTS.get(plain))
                .or_else(|| font8x8::BASIC_FONTS.get('?'))
                .unwrap_or_default();
            for (row, bits) in glyph.into_iter().enumerate() {
                for column in (0..8).filter(|b| bits >> b & 1 == 1) {
                    for s in 0..scale * scale {
                        let (dx, dy) = (s % scale, s / scale);
                        self.put(x + scale * (8 * i + column) + dx, y + scale * row + dy, ink);
                    }
                }
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
