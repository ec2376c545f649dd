//! A view over the picture, with its words in it and its legend beside it.

use super::page::{INK, Page};
use crate::widgets::number;
use lumenscope_core::{
    inspection::{InspectionScene, Legend},
    math::{colour::srgb8, false_colour::FalseColour},
    scene::camera::Camera,
    superposition::{gbuffer::GBuffer, overlay},
};

/// Width of the strip with the legend, pixels.
const STRIP: usize = 136;
const MARGIN: usize = 10;
/// Width of the bar and height of a line of text, pixels.
const BAR: usize = 16;
const LINE: usize = 14;

/// What views are drawn over.
pub struct Ground<'a> {
    /// The picture as the display shows it.
    pub pixels: Vec<[u8; 4]>,
    /// What each pixel sees.
    pub buffer: GBuffer,
    /// From where.
    pub camera: &'a Camera,
}

impl Ground<'_> {
    /// The picture with a view in it, and beside it the title, the legend and, as far as there is room, the notes.
    pub fn framed(&self, title: &str, scene: &InspectionScene, colours: &FalseColour) -> Page {
        let (width, height) = (self.buffer.width as usize, self.buffer.height as usize);
        let mut pixels = self.pixels.clone();
        overlay::draw(&mut pixels, &self.buffer, self.camera, scene, colours);
        let mut page = Page::new(width + STRIP, height);
        for (y, row) in pixels.chunks_exact(width).enumerate() {
            page.pixels[y * (width + STRIP)..][..width].copy_from_slice(row);
        }
        self.words(&mut page, scene);
        let left = width + MARGIN;
        let mut top = lines(&mut page, left, MARGIN, title, INK);
        if let Some(legend) = &scene.legend {
            top = legend_at(&mut page, left, top + LINE, legend, colours);
        }
        for note in &scene.notes {
            let room = (height.saturating_sub(top + LINE)) / LINE;
            if wrapped(note).len() > room {
                break;
            }
            top = lines(&mut page, left, top + LINE / 2, note, FAINT);
        }
        page
    }

    /// The words that nothing stands in front of, the strong ones on plates; where two meet the first stays.
    fn words(&self, page: &mut Page, scene: &InspectionScene) {
        let mut taken: Vec<[f32; 4]> = Vec::new();
        let (strong, plain): (Vec<_>, Vec<_>) = scene.labels.iter().partition(|l| l.strong);
        for label in strong.into_iter().chain(plain) {
            let Some(at) = overlay::place_of(self.camera, &self.buffer, label.position) else { continue };
            let half = [4.0 * label.text.chars().count() as f32 + 3.0, 6.0];
            let inside = at.x > half[0] && at.x + half[0] < self.buffer.width as f32;
            let apart =
                |t: &[f32; 4]| (t[0] - at.x).abs() > t[2] + half[0] || (t[1] - at.y).abs() > t[3] + half[1];
            if !inside || !taken.iter().all(apart) {
                continue;
            }
            taken.push([at.x, at.y, half[0], half[1]]);
            if label.strong {
                page.plate(at.x, at.y, &label.text, [20, 20, 22]);
            } else {
                let (x, y) = ((at.x - half[0] + 3.0) as usize, (at.y - 4.0).max(0.0) as usize);
                page.text(x + 1, y + 1, 1, &label.text, [0, 0, 0]);
                page.text(x, y, 1, &label.text, INK);
            }
        }
    }
}

/// Colour of what matters less.
const FAINT: [u8; 3] = [165, 165, 165];

/// Quantity, unit, and a bar with its numbers, or a patch for each kind; returns where it ends.
fn legend_at(page: &mut Page, left: usize, top: usize, legend: &Legend, colours: &FalseColour) -> usize {
    let mut top = lines(page, left, top, &legend.quantity, INK);
    if !legend.names.is_empty() {
        for (kind, name) in legend.names.iter().enumerate() {
            let colour = srgb8(colours.colour(kind as f32));
            (0..LINE * LINE).for_each(|i| page.put(left + i % LINE, top + 4 + i / LINE, colour));
            page.text(left + LINE + 6, top + 6, 1, name, INK);
            top += LINE + 6;
        }
        return top;
    }
    if !legend.unit.is_empty() {
        top = lines(page, left, top, &format!("in {}", legend.unit), FAINT);
    }
    top += LINE / 2;
    let height = 170.min(page.height.saturating_sub(top + LINE)).max(2);
    for y in 0..height {
        let colour = srgb8(colours.palette.colour(1.0 - y as f32 / (height - 1) as f32));
        (0..BAR).for_each(|x| page.put(left + x, top + y, colour));
    }
    for value in colours.ticks(6) {
        let y = top + ((1.0 - colours.position(value)) * (height - 1) as f32) as usize;
        (0..4).for_each(|x| page.put(left + BAR + x, y, INK));
        page.text(left + BAR + 8, y.saturating_sub(4), 1, &number::tick(value), INK);
    }
    top + height + 4
}

/// Writes text in as many lines as it needs; returns where it ends.
fn lines(page: &mut Page, left: usize, top: usize, text: &str, ink: [u8; 3]) -> usize {
    let lines = wrapped(text);
    for (i, line) in lines.iter().enumerate() {
        page.text(left, top + LINE * i, 1, line, ink);
    }
    top + LINE * lines.len()
}

/// Text in lines that fit the strip, broken between words; a word too long for one is cut.
fn wrapped(text: &str) -> Vec<String> {
    const COLUMNS: usize = (STRIP - MARGIN) / 8;
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let word: String = word.chars().take(COLUMNS).collect();
        let last = lines.len() - 1;
        let used = lines[last].chars().count();
        if used == 0 {
            lines[last] = word;
        } else if used + 1 + word.chars().count() <= COLUMNS {
            lines[last] += &format!(" {word}");
        } else {
            lines.push(word);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lumenscope_core::inspection::colours::ColourSettings;

    #[test]
    fn a_legend_stands_beside_the_picture_and_its_bar_has_the_palette() {
        let camera = Camera::default();
        let world = lumenscope_core::scene::world::World::new(&Default::default());
        let buffer = GBuffer::new(&world, &camera, glam::UVec2::new(64, 240), glam::Vec2::splat(0.5));
        let ground = Ground { pixels: vec![[7, 7, 7, 255]; 64 * 240], buffer, camera: &camera };
        let legend =
            Legend { quantity: "irradiance".into(), unit: "lx".into(), range: [0.0, 100.0], names: &[] };
        let scene = InspectionScene { legend: Some(legend), ..InspectionScene::default() };
        let colours = scene.colours(&ColourSettings::default());
        let page = ground.framed("Surface irradiance", &scene, &colours);
        assert_eq!((page.width, page.height), (64 + STRIP, 240));
        assert!((0..64).all(|x| page.pixels[100 * page.width + x] == [7, 7, 7, 255]), "the picture itself");
        for end in [0.0, 100.0] {
            let [r, g, b] = srgb8(colours.colour(end));
            assert!(page.pixels.contains(&[r, g, b, 255]), "{end} lx is not on the bar");
        }
        assert!(colours.colour_of(Vec3::ONE).is_finite());
    }

    #[test]
    fn words_are_wrapped_and_none_is_lost() {
        let text = "irradiance, mean over directions of everything";
        let lines = wrapped(text);
        assert!(lines.iter().all(|l| l.chars().count() <= 15), "{lines:?}");
        assert_eq!(lines.join(" "), text);
    }
}
