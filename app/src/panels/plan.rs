//! The plan: what this scene needs, why, and what it cost; each line can be decided by hand.

use super::plan_fields::fields;
use crate::{command::Command, session::Session};
use egui::{Align, Button, Grid, Layout, Popup, PopupCloseBehavior, RichText, Ui};
use lumenscope_core::{
    scene::file::PlanOverrides,
    superposition::plan::{Component, ExpectedError, PlanLine},
};

/// What the panel remembers between frames.
#[derive(Debug, Default)]
pub struct State {
    /// Overrides being written, and the component they are for.
    draft: Option<(Component, PlanOverrides)>,
}

/// Shows the plan, and what the light on screen took.
pub fn show(ui: &mut Ui, state: &mut State, session: &Session, out: &mut Vec<Command>) {
    let (Some(plan), Some(scene)) = (&session.plan, &session.scene) else {
        ui.weak("The plan appears when a scene has been read: what it needs, and why.");
        return;
    };
    for line in &plan.lines {
        Row { line, session, over: &scene.plan }.show(ui, state, out);
    }
}

/// A line of the plan, and the overrides in force.
struct Row<'a> {
    line: &'a PlanLine,
    session: &'a Session,
    over: &'a PlanOverrides,
}

impl Row<'_> {
    fn show(&self, ui: &mut Ui, state: &mut State, out: &mut Vec<Command>) {
        let (line, session) = (self.line, self.session);
        let text = |s: String| if line.used { RichText::new(s) } else { RichText::new(s).weak() };
        ui.horizontal(|ui| {
            ui.label(text(line.component.name().into()).strong()).on_hover_text(
                match (line.used, line.overridden) {
                    (false, true) => "Not computed: switched off by hand",
                    (false, false) => "Not computed: this scene does not need it",
                    (true, true) => "Computed, with settings fixed by hand or by the scene file",
                    (true, false) => "Computed, with settings chosen from the scene",
                },
            );
            if line.component != Component::Emitted {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    self.decide(ui, state, out);
                });
            }
        });
        ui.horizontal(|ui| {
            let error = match line.expected_error {
                _ if !line.used => "not computed".into(),
                ExpectedError::Exact => "exact".into(),
                ExpectedError::Median(share) => format!("error {:.1} %", share * 100.0),
                ExpectedError::Unknown => "error unknown".into(),
            };
            ui.label(text(error).small())
                .on_hover_text(format!("Expected relative error of this part.\n{}", line.error_basis));
            ui.label(text(seconds(session, line)).small())
                .on_hover_text("Seconds it took; in brackets, what was expected before it ran");
        });
        let parts: Vec<&str> =
            [line.settings.as_str(), line.reason.as_str()].into_iter().filter(|p| !p.is_empty()).collect();
        ui.add(egui::Label::new(RichText::new(parts.join("; ")).small().weak()).wrap());
        ui.add_space(5.0);
    }

    /// Whether a line is automatic or fixed, and the window in which that is changed.
    fn decide(&self, ui: &mut Ui, state: &mut State, out: &mut Vec<Command>) {
        let Self { line, session, over } = *self;
        let component = line.component;
        let word = if line.overridden { "fixed" } else { "automatic" };
        let button = ui.add(Button::new(RichText::new(word).small()).selected(line.overridden));
        button.widget_info(|| {
            let label = format!("{}: {word}", component.name());
            egui::WidgetInfo::labeled(egui::Role::Button, true, label)
        });
        let button =
            button.on_hover_text("Click to fix settings of this line, or to let the scene decide again");
        let popup = Popup::menu(&button).close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
            ui.set_min_width(270.0);
            ui.strong(format!("Plan of {}", component.name()));
            let draft = match &mut state.draft {
                Some((of, draft)) if *of == component => draft,
                other => &mut other.insert((component, over.clone())).1,
            };
            Grid::new("override")
                .num_columns(3)
                .spacing([10.0, 4.0])
                .show(ui, |ui| fields(ui, component, draft, session));
            ui.horizontal(|ui| {
                let apply = ui.add_enabled(draft != over, Button::new("Apply"));
                if apply.on_hover_text("Solve again what these settings change; one step to undo").clicked() {
                    out.push(Command::Plan(draft.clone()));
                    ui.close();
                }
                let back = ui.add_enabled(line.overridden, Button::new("Back to automatic"));
                if back.on_hover_text("Let the scene decide every setting of this line").clicked() {
                    out.push(Command::Plan(component.freed(over)));
                    ui.close();
                }
            });
        });
        let open_here = popup.is_some();
        if !open_here && state.draft.as_ref().is_some_and(|(of, _)| *of == component) {
            state.draft = None;
        }
    }
}

fn seconds(session: &Session, line: &PlanLine) -> String {
    let stages = session.solution.as_ref().map(|s| s.provenance.stage_seconds.as_slice()).unwrap_or_default();
    match stages.iter().find(|(name, _)| *name == line.component.name()) {
        Some((_, seconds)) => format!("{seconds:.2} s"),
        None if line.expected_seconds > 0.0 => format!("({:.1} s)", line.expected_seconds),
        None => String::new(),
    }
}
