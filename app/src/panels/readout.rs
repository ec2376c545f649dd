//! The read-out: the point picked, in numbers, with the volume samples that light it.

use super::{edit_view, number, quantity};
use crate::{command::Command, session::Session, viewport::Pick};
use egui::{Grid, RichText, Ui};
use lumenscope_core::{irradiance_volume::lighting::Lighting, math::colour::luminance};
use std::fmt::Write as _;

/// The view that draws the samples that light the clicked point.
const LIGHTING: &str = "irradiance_volume.lighting";

/// Shows the numbers at the point picked last.
pub fn show(ui: &mut Ui, pick: Option<&Pick>, session: &Session, out: &mut Vec<Command>) {
    let Some(pick) = pick else {
        ui.weak("Click a point in the picture: its position, material and light appear here.");
        return;
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(&pick.object).strong());
        if !pick.material.is_empty() {
            ui.weak(&pick.material);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.small_button("Copy").on_hover_text("Copy these numbers as text").clicked() {
                ui.ctx().copy_text(as_text(pick));
            }
        });
    });
    let (p, n, r) = (pick.position, pick.normal, pick.reflectance);
    Grid::new("place").num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        ui.label("Position");
        ui.label(format!("{:.3}  {:.3}  {:.3} m", p.x, p.y, p.z));
        ui.end_row();
        ui.label("Normal");
        ui.label(format!("{:.2}  {:.2}  {:.2}{}", n.x, n.y, n.z, if pick.back { "  (back)" } else { "" }));
        ui.end_row();
        ui.label("Reflectance").on_hover_text("Diffuse reflectance ρ in red, green and blue");
        ui.label(format!("{:.2}  {:.2}  {:.2}", r.x, r.y, r.z));
        ui.end_row();
    });
    ui.separator();
    Grid::new("light").num_columns(3).spacing([10.0, 2.0]).show(ui, |ui| {
        let total = pick.irradiance_direct + pick.irradiance_indirect;
        let e = "E = ∫ L(x, ω) cos θ dω: light that falls on the surface";
        quantity(ui, "Irradiance", total, "lx", e);
        quantity(ui, "  direct", pick.irradiance_direct, "lx", "The part straight from the emitters");
        quantity(ui, "  indirect", pick.irradiance_indirect, "lx", "The part after at least one bounce");
        let l = "L = L_e + ρ E / π: light that leaves the surface towards the eye";
        quantity(ui, "Radiance", pick.total_radiance(), "cd/m²", l);
    });
    if let Some(lighting) = &pick.lighting {
        ui.separator();
        edit_view(&session.document.view, out, |view| {
            let mut drawn = view.shows(LIGHTING);
            ui.horizontal(|ui| {
                ui.label("Lit by volume samples").on_hover_text(
                    "The samples of the irradiance volume around this point and their shares: what would light an \
                     object standing here",
                );
                if ui.checkbox(&mut drawn, "draw").on_hover_text("Draw them and their cell in the scene").changed() {
                    view.show(LIGHTING, drawn);
                }
            });
        });
        lit_by(ui, lighting);
    }
}

/// The samples that light the point, and the place between them.
fn lit_by(ui: &mut Ui, lighting: &Lighting) {
    ui.label(RichText::new(lighting.place()).small().weak()).on_hover_text(
        "The cell that holds the point, and where in it: 0 at its lower corner, 1 at its upper one",
    );
    if let Some(notice) = lighting.notice() {
        ui.colored_label(ui.visuals().warn_fg_color, notice);
    }
    Grid::new("samples").num_columns(5).spacing([10.0, 1.0]).striped(true).show(ui, |ui| {
        for sample in &lighting.samples {
            let text = |s: String| {
                let text = RichText::new(s).monospace();
                if sample.weight > 0.0 { text } else { text.weak().strikethrough() }
            };
            ui.label(text(format!("#{}", sample.id)));
            ui.label(text(format!("{:5.1} %", sample.weight * 100.0)))
                .on_hover_text(format!("{:.1} % before any was left out", sample.trilinear * 100.0));
            ui.label(text(format!("{} lx", number(luminance(sample.irradiance)))))
                .on_hover_text("Its own irradiance towards the normal");
            let p = sample.position;
            ui.label(text(format!("{:.2} {:.2} {:.2} m", p.x, p.y, p.z)));
            ui.label(sample.word()).on_hover_text(
                "valid: in free air; relocated: moved out of a solid; dilated: inside a solid, filled from its \
                 neighbours; masked: inside a solid, not used; hidden: a wall stands between it and the point",
            );
            ui.end_row();
        }
    });
}

/// The read-out as text, one quantity a line.
pub fn as_text(pick: &Pick) -> String {
    let mut text = String::new();
    let row = |v: glam::Vec3| format!("{} {} {}", v.x, v.y, v.z);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "object\t{}\nmaterial\t{}", pick.object, pick.material);
    let _ = writeln!(text, "position\t{}\tm", row(pick.position));
    let _ = writeln!(text, "normal\t{}", row(pick.normal));
    let _ = writeln!(text, "reflectance\t{}", row(pick.reflectance));
    let _ = writeln!(text, "irradiance direct\t{}\tlx", row(pick.irradiance_direct));
    let _ = writeln!(text, "irradiance indirect\t{}\tlx", row(pick.irradiance_indirect));
    let _ = writeln!(text, "radiance\t{}\tcd/m²", row(pick.total_radiance()));
    if let Some(lighting) = &pick.lighting {
        let _ = writeln!(text, "volume\t{}", lighting.place());
        for sample in &lighting.samples {
            let _ = writeln!(
                text,
                "volume sample {}\t{}\tm\t{}\t{}\tlx\t{}",
                sample.id,
                row(sample.position),
                number(sample.weight),
                row(sample.irradiance),
                sample.word()
            );
        }
    }
    text
}
