//! Keys that work wherever the pointer is; those of the viewport alone are its own.

use crate::{
    command::{Command, Dialog, Window},
    panels::layers::toggle_solo,
    session::{Compare, Session},
};
use egui::{Context, Key, KeyboardShortcut, Modifiers};
use lumenscope_core::superposition::layers::Layer;

/// Commands of the keys pressed in this frame.
pub(super) fn commands(ctx: &Context, session: &Session, out: &mut Vec<Command>) {
    let open = session.scene.is_some();
    let with = |modifiers: Modifiers, key| {
        ctx.input_mut(|i| i.consume_shortcut(&KeyboardShortcut::new(modifiers, key)))
    };
    let (command, shifted) = (Modifiers::COMMAND, Modifiers::COMMAND | Modifiers::SHIFT);
    if with(command, Key::O) {
        out.push(Command::Dialog(Dialog::Open));
    }
    if open && with(shifted, Key::S) {
        out.push(Command::Dialog(Dialog::SaveSession));
    }
    if open && with(command, Key::S) {
        out.push(match &session.file {
            Some(path) => Command::SaveSession(path.clone()),
            None => Command::Dialog(Dialog::SaveSession),
        });
    }
    if with(shifted, Key::Z) || with(command, Key::Y) {
        out.push(Command::Redo);
    }
    if with(command, Key::Z) {
        out.push(Command::Undo);
    }
    if with(Modifiers::NONE, Key::F1) {
        out.push(Command::Window(Window::Help));
    }
    if !open || ctx.egui_wants_keyboard_input() {
        return;
    }
    if with(Modifiers::NONE, Key::Tab) {
        out.push(Command::Window(Window::Panels));
    }
    let mut view = session.document.view.clone();
    for (key, layer) in [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5].into_iter().zip(Layer::ALL) {
        if with(Modifiers::NONE, key) {
            toggle_solo(&mut view, layer);
        }
    }
    if with(Modifiers::NONE, Key::R) {
        view.compare = match view.compare {
            Compare::Picture => Compare::Reference,
            Compare::Reference if session.light_paths.is_comparable() => Compare::Difference,
            Compare::Difference => Compare::Flip,
            Compare::Reference | Compare::Flip => Compare::Picture,
        };
    }
    if with(Modifiers::NONE, Key::V) {
        view.volume.shown = !view.volume.shown;
    }
    if with(Modifiers::SHIFT, Key::I)
        && let (Some(solution), Some(clicked)) = (&session.solution, view.surface)
        && let Some(&material) = solution.world.geometry.material.get(clicked.triangle as usize)
    {
        crate::panels::volumes::toggle_material(&mut view.volume, material);
    }
    if with(Modifiers::NONE, Key::I)
        && let Some(target) = view.selected
    {
        crate::panels::volumes::toggle_ignored(&mut view.volume, target);
    }
    // An open menu or popup closes first.
    if !egui::Popup::is_any_open(ctx) && with(Modifiers::NONE, Key::Escape) {
        view.selected = None;
    }
    if view != session.document.view {
        out.push(Command::View(Box::new(view)));
    }
}
