//! Inspection views: what can be shown inside the scene, and the volume as spheres.

use super::{colours, copies, edit_view, named, section, volumes};
use crate::{
    command::Command,
    pipeline::SPHERES,
    session::{Session, VolumeView},
    widgets::beside,
};
use egui::{ComboBox, Grid, RichText, Slider, Ui};
use lumenscope_core::{
    inspection::InspectionScene,
    irradiance_volume::{inspect::ColourBy, moments::Order},
    math::part::Part,
    registry::{VIEWS, ViewRow},
};
use std::sync::Arc;

/// Shows the views with their settings and their legend.
pub fn show(
    ui: &mut Ui,
    session: &Session,
    inspection: Option<&Arc<InspectionScene>>,
    out: &mut Vec<Command>,
) {
    edit_view(&session.document.view, out, |view| {
        section(ui, "Irradiance volume", |ui| {
            ui.checkbox(&mut view.volume.shown, "Spheres").on_hover_text(
            "The volume's samples as spheres (V). The colour of a sphere in direction n is the irradiance \
             of a surface there that faces n.\n\nE(x, n) = ∫ L(x, ω) max(0, n·ω) dω, lx",
        );
            ui.add_enabled_ui(view.volume.shown, |ui| volume(ui, &mut view.volume));
        });
    });
    volumes::show(ui, session, out);
    copies::show(ui, session, out);
    section(ui, "Inside the light", |ui| {
        edit_view(&session.document.view, out, |view| {
            for rows in VIEWS.chunk_by(|a, b| room(a) == room(b)) {
                ui.label(RichText::new(room(&rows[0])).small().weak());
                for row in rows.iter().filter(|r| r.id != SPHERES) {
                    let mut on = view.shows(row.id);
                    if ui.checkbox(&mut on, row.title).on_hover_text(row.tooltip).changed() {
                        view.show(row.id, on);
                    }
                }
            }
        });
        edit_view(&session.document.view, out, |view| {
            section(ui, "Colours of the views", |ui| {
                colours::edit(ui, &mut view.colours, inspection.map(Arc::as_ref));
            });
        });
        let Some(inspection) = inspection else { return };
        for note in &inspection.notes {
            ui.add(egui::Label::new(RichText::new(note).weak().small()).wrap());
        }
        beside::show(ui, inspection);
    });
}

/// What the views of a room are about.
fn room(row: &ViewRow) -> &'static str {
    match row.id.split('.').next() {
        _ if row.id.starts_with("radiosity.lightmap") => "A lightmap",
        Some("irradiance_volume") => "In the air",
        Some("mirror") => "Mirrors",
        Some("glossy") => "Glossy surfaces",
        _ => "On surfaces",
    }
}

fn volume(ui: &mut Ui, v: &mut VolumeView) {
    Grid::new("volume").num_columns(2).spacing([10.0, 4.0]).show(ui, |ui| {
        let label = ui.label("Size").on_hover_text("Radius of a sphere as a share of its cell");
        ui.add(Slider::new(&mut v.size, 0.05..=0.5).max_decimals(2)).labelled_by(label.id);
        ui.end_row();
        ui.label("Levels")
            .on_hover_text("The coarse grid, and the finer ones inside its cells near surfaces");
        ui.horizontal(|ui| {
            ui.checkbox(&mut v.first_level, "first");
            ui.checkbox(&mut v.second_level, "second");
        });
        ui.end_row();
        ui.label("Light").on_hover_text("Straight from emitters, after at least one bounce, or both");
        ui.horizontal(|ui| {
            for (part, name) in [(Part::All, "all"), (Part::Direct, "direct"), (Part::Indirect, "indirect")] {
                ui.selectable_value(&mut v.part, part, name);
            }
        });
        ui.end_row();
        ui.label("Quantity")
            .on_hover_text("E(x, n) in lx on the sphere's side n, or L(x, ω) in cd/m² from ω");
        ui.horizontal(|ui| {
            ui.selectable_value(&mut v.radiance, false, "irradiance");
            ui.selectable_value(&mut v.radiance, true, "radiance");
        });
        ui.end_row();
        ui.label("Moment").on_hover_text(
            "Order n of H(x, ω) = (n + 1)/2 ∫ L(x, ω') max(0, ω·ω')^n dω', lx; 1 is irradiance. The volume holds \
             others where the plan's line of the irradiance volume says so",
        );
        ui.horizontal(|ui| {
            for order in Order::THESIS {
                ui.selectable_value(&mut v.moment, order, order.to_string());
            }
        });
        ui.end_row();
        ui.label("Colour by").on_hover_text(
            "Light: as it is, in each direction. Luminance: mean illuminance, lx. Validity: whether a sample lies \
             in free air or was repaired. Age: changes of its light since its rays. Distance: to the nearest \
             surface, m. Error: how far it is from the volume chosen under Compare volumes, %",
        );
        ComboBox::from_id_salt("colour by").selected_text(v.colour_by.name()).show_ui(ui, |ui| {
            for choice in ColourBy::ALL {
                ui.selectable_value(&mut v.colour_by, choice, choice.name());
            }
        });
        ui.end_row();
        ui.label("Slice").on_hover_text("Only the samples at one height along an axis");
        slice(ui, &mut v.slice);
        ui.end_row();
    });
}

fn slice(ui: &mut Ui, slice: &mut Option<(u8, f32)>) {
    let name = |axis: Option<u8>| match axis {
        None => "whole",
        Some(0) => "x",
        Some(1) => "y",
        Some(_) => "z",
    };
    ui.horizontal(|ui| {
        let mut axis = slice.map(|s| s.0);
        ComboBox::from_id_salt("slice").width(54.0).selected_text(name(axis)).show_ui(ui, |ui| {
            for choice in [None, Some(0), Some(1), Some(2)] {
                ui.selectable_value(&mut axis, choice, name(choice));
            }
        });
        let mut height = slice.map_or(0.5, |s| s.1);
        if axis.is_some() {
            ui.spacing_mut().slider_width = 70.0;
            let slider = ui.add(Slider::new(&mut height, 0.0..=1.0).max_decimals(2));
            named(slider, "Height of the slice");
        }
        *slice = axis.map(|a| (a, height));
    });
}
