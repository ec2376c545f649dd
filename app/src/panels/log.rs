//! The log: what happened, newest last.

use crate::journal::{Journal, Severity};
use egui::{RichText, Ui};

/// What the panel remembers.
#[derive(Default)]
pub struct State {
    shown: usize,
}

/// Shows the lines, and scrolls to a new one.
pub fn show(ui: &mut Ui, state: &mut State, log: &Journal) {
    if log.lines().is_empty() {
        ui.weak("Nothing has happened yet.");
    }
    for line in log.lines() {
        let visuals = ui.visuals();
        let (mark, colour) = match line.severity {
            Severity::Info => ("·", visuals.text_color()),
            Severity::Warning => ("!", visuals.warn_fg_color),
            Severity::Error => ("×", visuals.error_fg_color),
        };
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(format!("{:8.1} s", line.seconds)).monospace().weak());
            ui.label(RichText::new(mark).color(colour));
            let times = if line.times > 1 { format!("  ({} times)", line.times) } else { String::new() };
            ui.add(egui::Label::new(RichText::new(format!("{}{times}", line.text)).color(colour)).wrap());
        });
    }
    if state.shown != log.lines().len() {
        state.shown = log.lines().len();
        ui.scroll_to_cursor(Some(egui::Align::BOTTOM));
    }
}
