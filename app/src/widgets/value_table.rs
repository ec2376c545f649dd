//! A table of named numbers with their units, which can be copied into a spreadsheet.

use super::number;

/// One line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What it is.
    pub name: &'static str,
    /// Its values: one for a luminous quantity, three for a vector.
    pub values: Vec<f32>,
    /// Their unit.
    pub unit: &'static str,
    /// What it means, with its equation.
    pub meaning: &'static str,
}

impl Row {
    /// A row of one number.
    pub fn one(name: &'static str, value: f32, unit: &'static str, meaning: &'static str) -> Self {
        Self { name, values: vec![value], unit, meaning }
    }
}

/// Tab-separated lines: name, values, unit.
pub fn text(rows: &[Row]) -> String {
    let mut text = String::new();
    for row in rows {
        let values: Vec<String> = row.values.iter().map(f32::to_string).collect();
        text += &format!("{}\t{}\t{}\n", row.name, values.join("\t"), row.unit);
    }
    text
}

/// Shows the rows and a button that copies them.
pub fn show(ui: &mut egui::Ui, id: &str, rows: &[Row]) {
    egui::Grid::new(id).num_columns(3).striped(true).spacing([12.0, 3.0]).show(ui, |ui| {
        for row in rows {
            ui.label(row.name).on_hover_text(row.meaning);
            let values: Vec<String> = row.values.iter().map(|v| number::short(*v)).collect();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let value = egui::RichText::new(values.join("  ")).monospace();
                ui.add(egui::Label::new(value).selectable(true));
            });
            ui.label(egui::RichText::new(row.unit).weak());
            ui.end_row();
        }
    });
    if ui.button("Copy numbers").on_hover_text("Copies the table, tab-separated").clicked() {
        ui.ctx().copy_text(text(rows));
    }
}
