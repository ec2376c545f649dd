//! The plan: what this scene needs, and why.

use crate::session::Session;
use egui::{Grid, RichText, Ui};

/// Shows what the light on screen was made with.
pub fn show(ui: &mut Ui, session: &Session) {
    let Some(solution) = &session.solution else {
        ui.weak("The plan appears when a scene has been solved.");
        return;
    };
    let provenance = &solution.provenance;
    Grid::new("plan").num_columns(2).spacing([16.0, 3.0]).show(ui, |ui| {
        for (stage, seconds) in &provenance.stage_seconds {
            ui.label(stage);
            ui.label(format!("{seconds:.2} s"));
            ui.end_row();
        }
        ui.label("Seed").on_hover_text("Every random number comes from this seed and the item it is for.");
        ui.label(RichText::new(provenance.seed.to_string()).monospace());
        ui.end_row();
    });
}
