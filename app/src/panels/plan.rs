//! The plan: what this scene needs, and why, and what it cost.

use crate::session::Session;
use egui::{Grid, RichText, Ui};
use lumenscope_core::superposition::plan::PlanLine;

/// Shows the plan, and what the light on screen took.
pub fn show(ui: &mut Ui, session: &Session) {
    let Some(plan) = &session.plan else {
        ui.weak("The plan appears when a scene has been read: what it needs, and why.");
        return;
    };
    Grid::new("plan").num_columns(4).spacing([14.0, 3.0]).striped(true).show(ui, |ui| {
        for title in ["Component", "Error", "Time", "Settings and reason"] {
            ui.label(RichText::new(title).small().weak());
        }
        ui.end_row();
        for line in &plan.lines {
            row(ui, line, session);
        }
    });
}

fn row(ui: &mut Ui, line: &PlanLine, session: &Session) {
    let text = |s: String| if line.used { RichText::new(s) } else { RichText::new(s).weak() };
    let mark = if line.overridden { " *" } else { "" };
    ui.label(text(format!("{}{mark}", line.component))).on_hover_text(match (line.used, line.overridden) {
        (false, _) => "Not computed: this scene does not need it",
        (true, true) => "Computed, with settings that the scene file fixes",
        (true, false) => "Computed",
    });
    ui.label(text(line.expected_error.map_or("exact".into(), |e| format!("{:.1} %", e * 100.0))))
        .on_hover_text("Expected median relative error of this part");
    ui.label(text(seconds(session, line)))
        .on_hover_text("Seconds it took; in brackets, what was expected before it ran");
    let parts: Vec<&str> =
        [line.settings.as_str(), line.reason.as_str()].into_iter().filter(|p| !p.is_empty()).collect();
    ui.add(egui::Label::new(text(parts.join("; "))).wrap());
    ui.end_row();
}

fn seconds(session: &Session, line: &PlanLine) -> String {
    let stages = session.solution.as_ref().map(|s| s.provenance.stage_seconds.as_slice()).unwrap_or_default();
    match stages.iter().find(|(name, _)| *name == line.component) {
        Some((_, seconds)) => format!("{seconds:.2} s"),
        None if line.expected_seconds > 0.0 => format!("({:.1} s)", line.expected_seconds),
        None => String::new(),
    }
}
