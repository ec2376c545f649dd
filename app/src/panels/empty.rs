//! The empty state: what a stranger sees first, and what to do next.

use crate::{
    command::{Command, Dialog},
    examples::Example,
};
use egui::{Align, Layout, RichText, Ui, vec2};
use std::path::PathBuf;

/// Invites to open something; `opening` while something is.
pub fn show(ui: &mut Ui, recent: &[PathBuf], opening: bool, out: &mut Vec<Command>) {
    let height = ui.available_height();
    ui.with_layout(Layout::top_down(Align::Center), |ui| {
        ui.add_space((height * 0.2).max(24.0));
        ui.label(RichText::new("lumenscope").size(34.0).strong().color(crate::theme::accent(ui.visuals())));
        ui.label(RichText::new("See where light flows in a scene, and where it came from.").size(15.0));
        ui.add_space(26.0);
        if opening {
            ui.spinner();
            ui.label("Opening…");
            return;
        }
        let open = egui::Button::new(RichText::new("Open a scene…").size(15.0)).min_size(vec2(240.0, 34.0));
        if ui.add(open).on_hover_text("glTF, GLB, OBJ, RON scene or lumenscope session").clicked() {
            out.push(Command::Dialog(Dialog::Open));
        }
        for example in Example::ALL {
            let label = format!("Open example: {}", example.title());
            let button = egui::Button::new(label).min_size(vec2(240.0, 28.0));
            if ui.add(button).on_hover_text(example.hint()).clicked() {
                out.push(Command::OpenExample(example));
            }
        }
        ui.add_space(16.0);
        ui.weak("Drop a .glb, .gltf, .obj or .ron here");
        if !recent.is_empty() {
            ui.add_space(22.0);
            ui.label(RichText::new("Recent").strong());
            for file in recent {
                let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
                if ui.link(name).on_hover_text(file.display().to_string()).clicked() {
                    out.push(Command::Open(file.clone()));
                }
            }
        }
    });
}
