//! How the values that views show become colours: palette, range, scale.

use super::named;
use crate::widgets::number;
use egui::{ComboBox, DragValue, Grid, Ui};
use lumenscope_core::{
    inspection::{
        InspectionScene,
        colours::{ColourRange, ColourScale, ColourSettings},
    },
    math::false_colour::Palette,
};

/// Percentiles that are proposed.
const PERCENTILES: [f32; 2] = [2.0, 98.0];

/// Palettes to choose from, with their names.
const PALETTES: [(Palette, &str); 4] = [
    (Palette::Viridis, "Viridis"),
    (Palette::Inferno, "Inferno"),
    (Palette::Turbo, "Turbo"),
    (Palette::Natural, "true colour"),
];

/// Edits the settings; `shown` is what has the values.
pub fn edit(ui: &mut Ui, settings: &mut ColourSettings, shown: Option<&InspectionScene>) {
    Grid::new("view colours").num_columns(2).spacing([10.0, 4.0]).show(ui, |ui| {
        ui.label("Palette").on_hover_text(
            "Colours of the values, by luminance. True colour shows light as the eye would see it, white at the high \
             end. Signed quantities and kinds have palettes of their own.",
        );
        let name = PALETTES.iter().find(|p| p.0 == settings.palette).map_or("", |p| p.1);
        let list = ComboBox::from_id_salt("view palette").selected_text(name).show_ui(ui, |ui| {
            for (palette, name) in PALETTES {
                ui.selectable_value(&mut settings.palette, palette, name);
            }
        });
        named(list.response, "Palette of views");
        ui.end_row();

        ui.label("Range").on_hover_text("Values beyond it take the end's colour");
        range(ui, settings, shown);
        ui.end_row();

        ui.label("Steps").on_hover_text("Equal steps along the palette are equal differences, or equal ratios");
        ui.horizontal(|ui| {
            for (scale, name) in [
                (ColourScale::Automatic, "auto"),
                (ColourScale::Linear, "linear"),
                (ColourScale::Logarithmic, "log"),
            ] {
                ui.selectable_value(&mut settings.scale, scale, name);
            }
        });
        ui.end_row();
    });
}

fn range(ui: &mut Ui, settings: &mut ColourSettings, shown: Option<&InspectionScene>) {
    let name = match settings.range {
        ColourRange::Automatic => "automatic",
        ColourRange::Percentiles(_) => "percentiles",
        ColourRange::Given(_) => "given",
    };
    ui.vertical(|ui| {
        let list = ComboBox::from_id_salt("view range").selected_text(name).show_ui(ui, |ui| {
            let found = shown.map_or([0.0, 1000.0], |s| {
                let colours = s.colours(&ColourSettings::default());
                [colours.low, colours.high]
            });
            let now = settings.range;
            for (on, range, name) in [
                (now == ColourRange::Automatic, ColourRange::Automatic, "automatic"),
                (
                    matches!(now, ColourRange::Percentiles(_)),
                    ColourRange::Percentiles(PERCENTILES),
                    "percentiles",
                ),
                (matches!(now, ColourRange::Given(_)), ColourRange::Given(found), "given"),
            ] {
                if ui.selectable_label(on, name).clicked() && !on {
                    settings.range = range;
                }
            }
        });
        named(list.response, "Range of views");
        let unit = shown.and_then(|s| s.legend.as_ref()).map_or("", |l| l.unit.as_str());
        match &mut settings.range {
            ColourRange::Automatic => {
                if let Some(legend) = shown.and_then(|s| s.legend.as_ref()).filter(|l| l.names.is_empty()) {
                    let [low, high] = legend.range.map(number::short);
                    ui.weak(format!("{low} to {high} {unit}"));
                }
            }
            ColourRange::Percentiles([low, high]) => ends(ui, [low, high], 0.1, 0.0..=100.0, "%"),
            ColourRange::Given([low, high]) => {
                let speed = f64::from(*high - *low) * 0.005;
                ends(ui, [low, high], speed, -1e9..=1e9, unit);
            }
        }
    });
}

/// The two ends of a range, which never meet.
fn ends(ui: &mut Ui, [low, high]: [&mut f32; 2], speed: f64, all: std::ops::RangeInclusive<f32>, unit: &str) {
    let apart = (1e-3 * (*high - *low)).abs().max(1e-6);
    ui.horizontal(|ui| {
        let to = (*high - apart).max(*all.start());
        let first = DragValue::new(low).range(*all.start()..=to).speed(speed).max_decimals(3);
        named(ui.add(first), "Low end of the views' range");
        ui.label("to");
        let from = (*low + apart).min(*all.end());
        let last = DragValue::new(high).range(from..=*all.end()).speed(speed).max_decimals(3);
        named(ui.add(last.suffix(format!(" {unit}"))), "High end of the views' range");
    });
}
