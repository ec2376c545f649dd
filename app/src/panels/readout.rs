//! The read-out: the point picked, in numbers, with the volume samples that light it.

use super::{number, quantity};
use crate::viewport::Pick;
use egui::{Grid, RichText, Ui};
use lumenscope_core::irradiance_volume::visibility::PointState;
use std::fmt::Write as _;

/// Shows the numbers at the point picked last.
pub fn show(ui: &mut Ui, pick: Option<&Pick>) {
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
    if pick.volume_samples.is_empty() {
        return;
    }
    ui.separator();
    ui.label("Lit by volume samples").on_hover_text(
        "The samples of the irradiance volume around this point and their trilinear weights: what would light \
         an object standing here",
    );
    let notice = match pick.volume_state {
        PointState::Inside => None,
        PointState::Outside(metres) => {
            Some(format!("{metres:.2} m outside the volume: the nearest samples answer"))
        }
        PointState::Borrowed => {
            Some("no sample around sees this point: the nearest that does answers".into())
        }
        PointState::Unseen => Some("no sample sees this point: the volume leaves it dark".into()),
    };
    if let Some(notice) = notice {
        ui.colored_label(ui.visuals().warn_fg_color, notice);
    }
    Grid::new("samples").num_columns(4).spacing([12.0, 1.0]).striped(true).show(ui, |ui| {
        for sample in &pick.volume_samples {
            let text = |s: String| {
                let text = RichText::new(s).monospace();
                if sample.weight > 0.0 { text } else { text.weak().strikethrough() }
            };
            ui.label(text(format!("#{}", sample.id)));
            ui.label(text(format!("{:5.1} %", sample.weight * 100.0)));
            let p = sample.position;
            ui.label(text(format!("{:.2} {:.2} {:.2} m", p.x, p.y, p.z)));
            ui.label(if sample.seen { sample.state.name() } else { "hidden" }).on_hover_text(
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
    for sample in &pick.volume_samples {
        let _ = writeln!(
            text,
            "volume sample {}\t{}\tm\t{}\t{}",
            sample.id,
            row(sample.position),
            number(sample.weight),
            if sample.seen { sample.state.name() } else { "hidden" }
        );
    }
    text
}
