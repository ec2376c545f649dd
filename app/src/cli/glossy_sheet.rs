//! One picture of `glossy` a roughness: every method beside the reference, and where each is wrong.

use super::{
    glossy_judge::{Area, Judge},
    page::{INK, Page},
    render::auto_display,
};
use lumenscope_core::{
    math::{
        colour::{luminance, srgb8},
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    superposition::composite::{self, Display},
};
use std::path::Path;

const MARGIN: usize = 10;
const HEAD: usize = 34;
const FOOT: usize = 30;
/// Relative error at the end of the palette.
const MOST: f32 = 0.5;

/// Colours of the areas, the later over the earlier.
const AREAS: [(Area, [u8; 3]); 5] = [
    (Area::Far, [52, 66, 92]),
    (Area::Near, [72, 120, 140]),
    (Area::Grazing, [120, 96, 150]),
    (Area::Hidden, [214, 92, 60]),
    (Area::Contact, [240, 205, 90]),
];

/// The sheet so far.
pub struct Sheet {
    title: String,
    display: Display,
    size: [usize; 2],
    columns: Vec<Column>,
}

/// A method: its picture, and under it its error.
struct Column {
    name: String,
    pictures: [Vec<[u8; 3]>; 2],
}

impl Sheet {
    /// A sheet with the reference, and under it where methods may fail.
    pub fn new(judge: &Judge, roughness: f32) -> Self {
        let reference = &judge.by_rays.picture;
        let display = auto_display(reference);
        let areas = (0..reference.pixels.len()).map(|i| {
            let last = AREAS.iter().rev().find(|(area, _)| judge.holds(*area, i));
            last.map_or([18, 18, 20], |(_, ink)| *ink)
        });
        let mut sheet = Self {
            title: format!(
                "Glossy reflection, roughness {roughness}: the layer, and |L - Lref| / (Lref + 0.1 mean)"
            ),
            display,
            size: [reference.width as usize, reference.height as usize],
            columns: Vec::new(),
        };
        let shown = sheet.shown(reference);
        sheet.columns.push(Column { name: "lobe by rays".into(), pictures: [shown, areas.collect()] });
        sheet
    }

    fn shown(&self, picture: &LinearImage) -> Vec<[u8; 3]> {
        composite::display(picture, &self.display).into_iter().map(|[r, g, b, _]| [r, g, b]).collect()
    }

    /// Adds a method: its picture, and under it its error.
    pub fn add(&mut self, name: &str, picture: &LinearImage, judge: &Judge) {
        let reference = &judge.by_rays.picture;
        let steady = 0.1 * luminance(reference.mean());
        let colours = FalseColour::over([0.0, MOST], Palette::Inferno);
        let error = |i: usize| {
            let [found, wanted] = [picture, reference].map(|p| luminance(p.pixels[i]));
            let off = (found - wanted).abs() / (wanted + steady).max(f32::MIN_POSITIVE);
            if judge.holds(Area::All, i) { srgb8(colours.colour(off)) } else { [18, 18, 20] }
        };
        let errors = (0..reference.pixels.len()).map(error).collect();
        self.columns.push(Column { name: name.into(), pictures: [self.shown(picture), errors] });
    }

    /// Draws it.
    ///
    /// # Errors
    /// One line naming the file and the cause.
    pub fn write(&self, path: &Path) -> anyhow::Result<()> {
        let [width, height] = self.size;
        let mut page =
            Page::new((width + MARGIN) * self.columns.len() + MARGIN, HEAD + 2 * (height + MARGIN) + FOOT);
        page.text(MARGIN, 6, 1, &self.title, INK);
        for (i, column) in self.columns.iter().enumerate() {
            let left = MARGIN + i * (width + MARGIN);
            page.text(left, HEAD - 12, 1, &column.name, INK);
            for (row, picture) in column.pictures.iter().enumerate() {
                for (k, ink) in picture.iter().enumerate() {
                    page.put(left + k % width, HEAD + row * (height + MARGIN) + k / width, *ink);
                }
            }
        }
        let foot = HEAD + 2 * (height + MARGIN) + 6;
        let mut left = MARGIN;
        for (area, ink) in AREAS {
            for i in 0..100 {
                page.put(left + i % 10, foot + i / 10, ink);
            }
            page.text(left + 14, foot + 1, 1, area.name(), INK);
            left += 22 + 8 * (area.name().len() + 1);
        }
        let (bar, from) = (180.min(width), 2 * MARGIN + width);
        let colours = FalseColour::over([0.0, 1.0], Palette::Inferno);
        for i in 0..10 * bar {
            page.put(from + i % bar, foot + i / bar, srgb8(colours.colour((i % bar) as f32 / bar as f32)));
        }
        page.text(from + bar + 8, foot + 1, 1, &format!("0 to {MOST}"), INK);
        page.write(path)
    }
}
