//! The picture held against the reference: its colours, and its error in numbers beside it.

use super::{luminance_legend, screen::Screen};
use crate::{session::Compare, widgets::number};
use egui::{Color32, CornerRadius, Frame, Grid, Margin, Painter, RichText, Stroke, Ui, UiBuilder, vec2};
use lumenscope_core::{
    inspection::Legend,
    math::{
        colour::{luminance, srgb8},
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    measure::{MeasureError, picture::PictureError},
    superposition::composite::{self, DifferenceDisplay, Display},
};

/// A comparison that is shown.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Palette and range: cd/m² of the difference, or FLIP.
    pub colours: FalseColour,
    /// The error in every measure, or why there is none.
    pub error: Result<PictureError, MeasureError>,
    compare: Compare,
    size: [u32; 2],
}

impl Compared {
    /// Compares two pictures of one size, as a display shows them; with the pixels that show how far they are apart.
    pub fn new(
        picture: &LinearImage,
        reference: &LinearImage,
        display: &Display,
        compare: Compare,
    ) -> (Vec<[u8; 4]>, Self) {
        let seen = Display { false_colour: None, ..*display };
        let judged = PictureError::new(picture, reference, |image| composite::display(image, &seen));
        let (colours, bytes) = match (&judged, compare) {
            (Ok((_, flip)), Compare::Flip) => {
                let colours = FalseColour::over([0.0, 1.0], Palette::Inferno);
                let shown = |v: &f32| {
                    let [r, g, b] = srgb8(colours.colour(*v));
                    [r, g, b, 255]
                };
                (colours, flip.map.iter().map(shown).collect())
            }
            _ => {
                let colours = difference_colours(picture, reference);
                (colours, composite::difference(picture, reference, &DifferenceDisplay::Absolute(colours)))
            }
        };
        let size = [picture.width, picture.height];
        (bytes, Self { colours, error: judged.map(|(error, _)| error), compare, size })
    }

    /// What the colours mean.
    pub fn legend(&self) -> Legend {
        let range = [self.colours.low, self.colours.high];
        match (self.compare, &self.error) {
            (Compare::Flip, Ok(_)) => {
                Legend { quantity: "FLIP".into(), unit: String::new(), range, names: &[] }
            }
            _ => luminance_legend("luminance difference", range),
        }
    }

    /// Shows the numbers over the picture, to be copied, and rings the worst pixel.
    pub(super) fn show(&self, ui: &mut Ui, painter: &Painter, screen: &Screen) {
        let corner = screen.rect.min + vec2(14.0, 36.0);
        let place = egui::Rect::from_min_size(corner, vec2(230.0, 220.0)).intersect(screen.rect);
        let mut over = ui.new_child(UiBuilder::new().max_rect(place));
        let plate = Frame::new()
            .fill(Color32::from_black_alpha(185))
            .corner_radius(CornerRadius::same(5))
            .inner_margin(Margin::symmetric(8, 6));
        plate.show(&mut over, |ui| match &self.error {
            Ok(error) => {
                ui.visuals_mut().override_text_color = Some(Color32::from_gray(235));
                numbers(ui, error);
                self.ring(painter, screen, error);
            }
            Err(why) => {
                ui.colored_label(Color32::from_rgb(255, 150, 120), why.to_string());
            }
        });
    }

    fn ring(&self, painter: &Painter, screen: &Screen, error: &PictureError) {
        let [width, height] = self.size.map(|n| n.max(1) as f32);
        let scale = screen.rect.height() / height;
        let shown = egui::Rect::from_center_size(screen.rect.center(), vec2(width * scale, height * scale));
        let at = shown.min + vec2(error.worst.x as f32 + 0.5, error.worst.y as f32 + 0.5) * scale;
        painter.circle_stroke(at, 9.0, Stroke::new(3.0, Color32::from_black_alpha(160)));
        painter.circle_stroke(at, 9.0, Stroke::new(1.5, Color32::from_rgb(90, 220, 255)));
    }
}

fn numbers(ui: &mut Ui, error: &PictureError) {
    Grid::new("picture error").num_columns(3).spacing([10.0, 1.0]).show(ui, |ui| {
        for (name, value, unit, meaning) in error.rows() {
            ui.label(RichText::new(name).small()).on_hover_text(meaning);
            ui.label(RichText::new(number::short(value as f32)).small().monospace());
            ui.label(RichText::new(unit).small());
            ui.end_row();
        }
    });
    ui.horizontal(|ui| {
        let place = format!("at column {}, row {}", error.worst.x, error.worst.y);
        ui.label(RichText::new(place).small()).on_hover_text("The ring marks it; rows count from the top");
        let copy = ui.small_button("Copy").on_hover_text("Copy these numbers as text, tab-separated");
        if crate::panels::named(copy, "Copy the picture's error").clicked() {
            ui.ctx().copy_text(error.text());
        }
    });
}

/// Palette whose bright end is the 98th percentile of the difference, rounded up to 1, 2 or 5.
fn difference_colours(a: &LinearImage, b: &LinearImage) -> FalseColour {
    let mut differences: Vec<f32> = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .step_by((a.pixels.len() / 4096).max(1))
        .map(|(a, b)| (luminance(*a) - luminance(*b)).abs())
        .filter(|d| d.is_finite())
        .collect();
    differences.sort_by(f32::total_cmp);
    let high = differences.get(differences.len() * 98 / 100).copied().unwrap_or(1.0).max(1e-3);
    let magnitude = 10f32.powf(high.log10().floor());
    let round = [1.0, 2.0, 5.0].map(|m| m * magnitude).into_iter().find(|v| *v >= high);
    FalseColour {
        palette: Palette::Inferno,
        low: 0.0,
        high: round.unwrap_or(10.0 * magnitude),
        logarithmic: false,
    }
}
