//! Notices: what could not be done, said where it cannot be missed, in the way of nothing.

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
    let mut answer = None;
    let modal = egui::Modal::new(egui::Id::unique("dropped")).show(ctx, |ui| {
        ui.set_max_width(420.0);
        ui.heading(file.file_name().unwrap_or_default().to_string_lossy());
        ui.label("Open this model as a scene of its own, or add it to the open scene as movable objects?");
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            for (label, value) in [
                ("Add to scene", DropAnswer::Add),
                ("Open", DropAnswer::Open),
                ("Cancel", DropAnswer::Nothing),
            ] {
                if ui.button(label).clicked() {
                    answer = Some(value);
                }
            }
        });
    });
    answer.or(modal.should_close().then_some(DropAnswer::Nothing))
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
