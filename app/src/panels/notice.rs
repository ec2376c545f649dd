//! Notices: what could not be done, said where it cannot be missed, in the way of nothing.

use crate::session::Session;
use egui::{Align2, Context, Frame, RichText, Window};

/// Something to be said.
#[derive(Clone, Debug)]
pub struct Notice {
    /// What was attempted.
    pub title: String,
    /// Why it did not work.
    pub text: String,
}

/// Shows the notice until it is dismissed.
pub fn show(ctx: &Context, notice: &mut Option<Notice>) {
    let Some(shown) = notice else { return };
    let mut dismissed = false;
    Window::new("Notice")
        .title_bar(false)
        .resizable(false)
        .anchor(Align2::RIGHT_BOTTOM, [-16.0, -40.0])
        .frame(Frame::window(&ctx.global_style()))
        .show(ctx, |ui| {
            ui.set_max_width(380.0);
            ui.label(RichText::new(&shown.title).strong().color(ui.visuals().error_fg_color));
            ui.add(egui::Label::new(&shown.text).wrap());
            dismissed = ui.button("Dismiss").clicked();
        });
    if dismissed {
        *notice = None;
    }
}

/// Asks what to do with a model dropped onto an open scene; `None` until answered.
pub fn ask_drop(ctx: &Context, file: &std::path::Path) -> Option<DropAnswer> {
    ask(
        ctx,
        "dropped",
        &file.file_name().unwrap_or_default().to_string_lossy(),
        "Open this model as a scene of its own, or add it to the open scene as movable objects?",
        [("Add to scene", DropAnswer::Add), ("Open", DropAnswer::Open), ("Cancel", DropAnswer::Nothing)],
    )
}

/// Asks what to do with unsaved edits that would be lost; `None` until answered.
pub fn ask_unsaved(ctx: &Context, session: &Session) -> Option<UnsavedAnswer> {
    let name = match (&session.file, &session.scene) {
        (Some(file), _) => file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        (None, Some(scene)) => scene.name.clone(),
        (None, None) => "This session".into(),
    };
    ask(
        ctx,
        "unsaved",
        &format!("{name} has changes that are not saved"),
        "Placements, dimmers, added models and overrides of the plan are lost unless the session is saved.",
        [
            ("Save", UnsavedAnswer::Save),
            ("Discard", UnsavedAnswer::Discard),
            ("Cancel", UnsavedAnswer::Cancel),
        ],
    )
}

/// A question in the middle of the window; closing it gives the last answer.
fn ask<A: Copy, const N: usize>(
    ctx: &Context,
    id: &str,
    title: &str,
    question: &str,
    answers: [(&str, A); N],
) -> Option<A> {
    let mut given = None;
    let modal = egui::Modal::new(egui::Id::unique(id)).show(ctx, |ui| {
        ui.set_max_width(420.0);
        ui.heading(title);
        ui.label(question);
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            for (label, answer) in answers {
                if ui.button(label).clicked() {
                    given = Some(answer);
                }
            }
        });
    });
    let last = answers.last().map(|(_, answer)| *answer);
    given.or(if modal.should_close() { last } else { None })
}

/// What to do with unsaved edits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnsavedAnswer {
    /// Save them, then go on.
    Save,
    /// Lose them and go on.
    Discard,
    /// Stay.
    Cancel,
}

/// What to do with a dropped model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DropAnswer {
    /// Open it as a scene.
    Open,
    /// Add it to the open scene.
    Add,
    /// Leave everything as it is.
    Nothing,
}
