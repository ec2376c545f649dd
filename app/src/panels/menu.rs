//! The menu bar.

use super::edit_view;
use crate::{
    command::{Command, Dialog, Window},
    examples::Example,
    export::Export,
    session::{Compare, Session},
};
use egui::{Button, MenuBar, Ui};
use std::path::PathBuf;

/// Shows the menus.
pub fn show(ui: &mut Ui, session: &Session, recent: &[PathBuf], out: &mut Vec<Command>) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(ui, session, recent, out));
        ui.menu_button("Edit", |ui| edit(ui, session, out));
        ui.menu_button("View", |ui| view(ui, session, out));
        ui.menu_button("Help", |ui| {
            item(ui, "Keys, mouse and colours", "F1", true, Command::Window(Window::Help), out);
        });
    });
}

fn file(ui: &mut Ui, session: &Session, recent: &[PathBuf], out: &mut Vec<Command>) {
    let open = session.scene.is_some();
    item(ui, "Open…", "Ctrl+O", true, Command::Dialog(Dialog::Open), out);
    ui.menu_button("Open example", |ui| {
        for example in Example::ALL {
            if ui.button(example.title()).on_hover_text(example.hint()).clicked() {
                out.push(Command::OpenExample(example));
            }
        }
        ui.menu_button("With known answers", |ui| {
            for example in Example::ANALYTIC {
                if ui.button(example.title()).on_hover_text(example.hint()).clicked() {
                    out.push(Command::OpenExample(example));
                }
            }
        });
    });
    ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for file in recent {
                let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
                if ui.button(name).on_hover_text(file.display().to_string()).clicked() {
                    out.push(Command::Open(file.clone()));
                }
            }
        });
    });
    item(ui, "Add a model to the scene…", "", open, Command::Dialog(Dialog::AddModel), out);
    item(ui, "Compare with a lightmap…", "", open, Command::Dialog(Dialog::Lightmap), out);
    ui.separator();
    let save = match &session.file {
        Some(path) => Command::SaveSession(path.clone()),
        None => Command::Dialog(Dialog::SaveSession),
    };
    item(ui, "Save session", "Ctrl+S", open, save, out);
    item(ui, "Save session as…", "Ctrl+Shift+S", open, Command::Dialog(Dialog::SaveSession), out);
    ui.separator();
    for (label, what) in [
        ("Export picture (PNG)…", Export::Picture),
        ("Export picture with a streamed wall (PNG)…", Export::Wall),
        ("Export layers (EXR)…", Export::Layers),
        ("Bake a lightmap (EXR)…", Export::Lightmap),
    ] {
        item(ui, label, "", open, Command::Dialog(Dialog::Export(what)), out);
    }
    ui.separator();
    item(ui, "Quit", "", true, Command::Window(Window::Quit), out);
}

fn edit(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    item(ui, "Undo", "Ctrl+Z", session.history.can_undo(), Command::Undo, out);
    item(ui, "Redo", "Ctrl+Y", session.history.can_redo(), Command::Redo, out);
    ui.separator();
    item(ui, "Solve the light again", "", session.scene.is_some(), Command::Solve, out);
    let selected = session.document.view.selected.is_some();
    ui.add_enabled_ui(selected, |ui| {
        if ui.add(Button::new("Deselect").shortcut_text("Esc")).clicked() {
            edit_view(&session.document.view, out, |v| v.selected = None);
        }
    });
}

fn view(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    let shown = &session.document.view;
    for (compare, label) in [
        (Compare::Picture, "Picture"),
        (Compare::Reference, "Reference (path tracer)"),
        (Compare::Difference, "Difference"),
        (Compare::Flip, "Noticeable difference (FLIP)"),
    ] {
        let enabled = !compare.is_comparison() || session.light_paths.is_comparable();
        ui.add_enabled_ui(enabled, |ui| {
            if ui.radio(shown.compare == compare, label).clicked() {
                edit_view(shown, out, |v| v.compare = compare);
            }
        });
    }
    ui.separator();
    let mut volume = shown.volume.shown;
    if ui.checkbox(&mut volume, "Volume spheres").clicked() {
        edit_view(shown, out, |v| v.volume.shown = volume);
    }
    if ui.button("Camera of the scene").clicked()
        && let Some(scene) = &session.base
    {
        edit_view(shown, out, |v| v.camera = scene.camera);
    }
    ui.separator();
    item(ui, "Hide or show panels", "Tab", true, Command::Window(Window::Panels), out);
    item(ui, "Panels as at first", "", true, Command::Window(Window::ResetPanels), out);
    item(ui, "Dark or light", "", true, Command::Window(Window::Theme), out);
}

fn item(ui: &mut Ui, label: &str, keys: &str, enabled: bool, command: Command, out: &mut Vec<Command>) {
    if ui.add_enabled(enabled, Button::new(label).shortcut_text(keys)).clicked() {
        out.push(command);
    }
}
