//! Two copies of the selected thing, lit by two volumes at once.

use super::{edit_view, named, section};
use crate::{
    command::Command,
    copies::{Copies, CopyLight, CopyVolume},
    session::Session,
};
use egui::{ComboBox, DragValue, Grid, Ui};
use lumenscope_core::{irradiance_volume::moments::Order, math::part::Part, scene::Target};

/// Shows what is copied and what lights each copy.
pub fn show(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    let Some(scene) = session.scene.as_deref() else { return };
    section(ui, "Two copies", |ui| {
        edit_view(&session.document.view, out, |view| {
            let selected = match view.selected {
                Some(Target::Object(i)) => Some(i),
                _ => None,
            };
            let mut on = view.copies.is_some();
            let hint = "Two copies of the selected object side by side, each lit from a volume of its own: present or kept, \
                    in a part of its light. They shadow what is under them but send no light back.";
            let name = match view.copies.map(|c| c.object).or(selected) {
                Some(i) => format!("Copies of {}", scene.objects.get(i).map_or("", |o| &o.name)),
                None => "Copies of what is selected".into(),
            };
            ui.add_enabled_ui(on || selected.is_some(), |ui| {
                if ui.checkbox(&mut on, name).on_hover_text(hint).changed() {
                    view.copies = selected.filter(|_| on).map(|object| Copies {
                        at: view.probe.map_or(Copies::of(scene, object).at, |p| p.0),
                        ..Copies::of(scene, object)
                    });
                }
            });
            let gloss = view.gloss;
            let Some(copies) = &mut view.copies else { return };
            Grid::new("copies").num_columns(3).spacing([6.0, 3.0]).show(ui, |ui| {
                for (name, light) in ["Left", "Right"].into_iter().zip(&mut copies.lights) {
                    ui.label(name);
                    lit_by(ui, name, session, light);
                    ui.end_row();
                }
            });
            for (name, light) in ["left", "right"].into_iter().zip(&copies.lights) {
                if let Some(order) = gloss.filter(|order| !holds(session, light.volume, *order)) {
                    ui.weak(format!(
                        "The {name} copy's volume holds no moment of order {order}: it is drawn matt."
                    ));
                }
            }
            ui.horizontal(|ui| {
                ui.label("At").on_hover_text("The place midway between the copies, m");
                for (axis, value) in ["x", "y", "z"].iter().zip(copies.at.as_mut()) {
                    let number = ui.add(DragValue::new(value).speed(0.01).max_decimals(2).suffix(" m"));
                    named(number, &format!("Copies {axis}"));
                }
            });
        });
    });
}

/// Whether a volume holds an order; where there is no volume yet nothing is missed.
fn holds(session: &Session, volume: CopyVolume, order: Order) -> bool {
    let kept = match volume {
        CopyVolume::Kept(n) => session.kept.get(n).map(|k| &*k.volume),
        CopyVolume::Present => None,
    };
    let present = || session.solution.as_ref().and_then(|s| s.volume.as_deref());
    kept.or_else(present).is_none_or(|v| v.orders().contains(&order))
}

fn lit_by(ui: &mut Ui, side: &str, session: &Session, light: &mut CopyLight) {
    let name = |volume: CopyVolume| match volume {
        CopyVolume::Kept(n) => session.kept.get(n).map_or("present volume", |k| k.name.as_str()),
        CopyVolume::Present => "present volume",
    };
    let list = ComboBox::from_id_salt((side, "volume")).width(110.0).selected_text(name(light.volume));
    let list = list.show_ui(ui, |ui| {
        for volume in
            std::iter::once(CopyVolume::Present).chain((0..session.kept.len()).map(CopyVolume::Kept))
        {
            ui.selectable_value(&mut light.volume, volume, name(volume));
        }
    });
    named(list.response, &format!("Volume of the {} copy", side.to_lowercase()));
    let part = |part| match part {
        Part::All => "all",
        Part::Direct => "direct",
        Part::Indirect => "indirect",
    };
    let list = ComboBox::from_id_salt((side, "part")).width(70.0).selected_text(part(light.part));
    let list = list.show_ui(ui, |ui| {
        for choice in [Part::All, Part::Direct, Part::Indirect] {
            ui.selectable_value(&mut light.part, choice, part(choice));
        }
    });
    named(list.response, &format!("Light of the {} copy", side.to_lowercase()));
}
