//! The empty state: what a stranger sees first, and what to do next.

use crate::{
    command::{Command, Dialog},
    examples::Example,
};
use egui::{Align, Color32, Layout, Mesh, RichText, Ui, pos2, vec2};
use std::path::PathBuf;

/// Invites to open something; `opening` while something is.
pub fn show(ui: &mut Ui, recent: &[PathBuf], opening: bool, out: &mut Vec<Command>) {
    let height = ui.available_height();
    glow(ui);
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

/// A lamp's light on a wall behind the title: cos³ of the angle, as a point lamp lights it.
fn glow(ui: &Ui) {
    const STEPS: [usize; 2] = [48, 30];
    let (rect, accent) = (ui.max_rect(), crate::theme::accent(ui.visuals()));
    let strength = if ui.visuals().dark_mode { 0.20 } else { 0.28 };
    let lamp = pos2(rect.center().x, rect.top() + 0.26 * rect.height());
    let distance = 0.32 * rect.height().max(1.0);
    let mut mesh = Mesh::default();
    for y in 0..=STEPS[1] {
        for x in 0..=STEPS[0] {
            let at = pos2(
                rect.left() + rect.width() * x as f32 / STEPS[0] as f32,
                rect.top() + rect.height() * y as f32 / STEPS[1] as f32,
            );
            let cos = distance / at.distance(lamp).hypot(distance);
            let shade = accent.gamma_multiply(strength * cos.powi(3));
            mesh.colored_vertex(at, if shade.a() == 0 { Color32::TRANSPARENT } else { shade });
        }
    }
    let row = STEPS[0] as u32 + 1;
    for y in 0..STEPS[1] as u32 {
        for x in 0..STEPS[0] as u32 {
            let i = y * row + x;
            mesh.add_triangle(i, i + 1, i + row);
            mesh.add_triangle(i + 1, i + row + 1, i + row);
        }
    }
    ui.painter().add(mesh);
}
