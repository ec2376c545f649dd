//! Two volumes compared: surfaces that one leaves out, and volumes kept to come back to.

use super::{edit_view, named, section};
use crate::{
    command::{Command, Dialog},
    copies::CopyVolume,
    document::exists,
    pipeline::{DIFFERENCES, VolumeSource},
    session::{Against, Session, View, VolumeView},
};
use egui::{Button, ComboBox, Ui};
use egui_plot::{Bar, BarChart, Plot};
use lumenscope_core::{
    inspection::Curve,
    scene::{Scene, Target},
};

/// Shows what the volume is compared with.
pub fn show(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    let Some(scene) = session.scene.as_deref() else { return };
    section(ui, "Compare volumes", |ui| {
        let view = &session.document.view;
        edit_view(view, out, |view| {
            ui.horizontal(|ui| {
                ui.label("A").on_hover_text("The volume that the views show, and that B is taken from");
                let name = |of: CopyVolume| match of {
                    CopyVolume::Kept(n) => session.kept.get(n).map_or("present volume", |k| k.name.as_str()),
                    CopyVolume::Present => "present volume",
                };
                let of = &mut view.volume.of;
                let list = ComboBox::from_id_salt("volume A").selected_text(name(*of)).show_ui(ui, |ui| {
                    let kept = (0..session.kept.len()).map(CopyVolume::Kept);
                    for choice in std::iter::once(CopyVolume::Present).chain(kept) {
                        ui.selectable_value(of, choice, name(choice));
                    }
                });
                named(list.response, "Volume that is shown");
            });
            let against = &mut view.volume.against;
            ui.radio_value(against, Against::Ignoring, "B: present without the light of").on_hover_text(
                "The same volume, but rays that meet these surfaces bring nothing; from what the rays met, so \
                 nothing is traced again. Click something in the scene and press I to add it or take it away, Shift+I all of \
                 the material that was clicked.\n\n\
                 E_A − E_B = what comes straight from them, lx",
            );
            ui.indent("ignored", |ui| ignored(ui, scene, view));
            let against = &mut view.volume.against;
            ui.radio_value(against, Against::Present, "B: present volume");
            for (number, kept) in session.kept.iter().enumerate() {
                let text = format!("B: {}", kept.name);
                ui.radio_value(against, Against::Kept(number), text)
                    .on_hover_text("A volume that was kept: samples × bins");
            }
            let mut on = view.views.iter().any(|v| v == DIFFERENCES[0]);
            if ui.checkbox(&mut on, "Show the difference").on_hover_text("A − B at the samples, lx").changed()
            {
                view.views.retain(|v| v != DIFFERENCES[0]);
                if on {
                    view.views.push(DIFFERENCES[0].to_owned());
                }
            }
        });
        ui.horizontal_wrapped(|ui| {
            if ui
                .button("Keep this volume")
                .on_hover_text("Keep it as it is, to compare later ones with")
                .clicked()
            {
                out.push(Command::KeepVolume);
            }
            let trace = ui.button("Path-trace a volume").on_hover_text(
            "The same samples and bins, lit by the path tracer: what the volume should be. It takes minutes; \
             Esc or the cross beside its progress stops it.",
        );
            if trace.clicked() {
                out.push(Command::CompareWith(VolumeSource::Reference));
            }
            let left_out = view.volume.left_out();
            let without = ui.add_enabled(!left_out.is_empty(), Button::new("Keep without them")).on_hover_text(
                "Keep the present volume without the light of what is listed above: to be shown, compared, and to \
                 light copies",
            );
            if without.clicked() {
                let names = names_of(scene, &view.volume);
                out.push(Command::CompareWith(VolumeSource::Ignoring(left_out, names)));
            }
            let file = ui.button("Open a volume…").on_hover_text("A volume saved by `lumenscope volume`, to keep it");
            if file.clicked() {
                out.push(Command::Dialog(Dialog::Volume));
            }
            let panoramas = ui.button("From panoramas…").on_hover_text(
                "A volume from pictures of everything around some points: a RON list of nodes, \
                 [(position: (x, y, z), file: \"p.exr\"), …], with latitude–longitude pictures beside it, \
                 in EXR or HDR. The spheres' panel exports them.",
            );
            if panoramas.clicked() {
                out.push(Command::Dialog(Dialog::Panoramas));
            }
            if let Against::Kept(number) = view.volume.against
                && session.kept.get(number).is_some()
                && ui.button("Forget").on_hover_text("Forget the volume that is compared with").clicked()
            {
                out.push(Command::ForgetVolume(number));
            }
        });
        let curves = session.inspection.iter().flat_map(|i| &i.curves);
        curves.filter(|c| crate::widgets::beside::is_histogram(c)).for_each(|curve| histogram(ui, curve));
    });
}

/// What is left out, and what could be.
fn ignored(ui: &mut Ui, scene: &Scene, view: &mut View) {
    let targets: Vec<Target> = view.volume.ignored.iter().copied().filter(|&t| exists(scene, t)).collect();
    for target in &targets {
        let name = scene.target_name(*target);
        ui.horizontal(|ui| {
            let close = ui.small_button("×").on_hover_text("Count its light again");
            if named(close, &format!("Count {name}")).clicked() {
                view.volume.ignored.remove(target);
            }
            ui.label(name);
        });
    }
    let chosen = view.volume.ignored_materials.len();
    let text = match chosen {
        0 => "no material".to_owned(),
        1 => "one material".to_owned(),
        n => format!("{n} materials"),
    };
    let list = ComboBox::from_id_salt("ignored materials").selected_text(text).show_ui(ui, |ui| {
        for (i, material) in scene.materials.iter().enumerate() {
            let mut on = view.volume.ignored_materials.contains(&(i as u32));
            if ui.toggle_value(&mut on, &material.name).changed() {
                toggle_material(&mut view.volume, i as u32);
            }
        }
    });
    named(list.response, "Materials left out")
        .on_hover_text("Everything of these materials, wherever it is used");
    match view.selected.filter(|t| exists(scene, *t) && !targets.contains(t)) {
        Some(target) => {
            let text = format!("Ignore {}", scene.target_name(target));
            if ui.button(text).on_hover_text("Leave its light out (I)").clicked() {
                toggle_ignored(&mut view.volume, target);
            }
        }
        None if targets.is_empty() && chosen == 0 => {
            ui.weak("Click something in the scene, then press I.");
        }
        None => {}
    }
}

/// Names of what is left out, in one line.
fn names_of(scene: &Scene, view: &VolumeView) -> String {
    let targets = view.ignored.iter().filter(|t| exists(scene, **t)).map(|t| scene.target_name(*t));
    let materials = view.ignored_materials.iter().filter_map(|&m| scene.materials.get(m as usize));
    targets.chain(materials.map(|m| m.name.as_str())).collect::<Vec<_>>().join(", ")
}

/// A curve of equal steps as bars.
fn histogram(ui: &mut Ui, curve: &Curve) {
    let [x, y] = &curve.axes;
    let width = curve.points.windows(2).next().map_or(1.0, |p| f64::from(p[1].x - p[0].x));
    let bars =
        curve.points.iter().map(|p| Bar::new(f64::from(p.x), f64::from(p.y)).width(0.9 * width)).collect();
    ui.label(egui::RichText::new(&curve.name).small()).on_hover_text(
        "Share of all samples and directions by the size of |A − B| / max(B, 5 % of its mean); the last bar \
         holds everything beyond.",
    );
    let colour = crate::theme::accent(ui.visuals());
    Plot::new(&curve.name)
        .height(110.0)
        .x_axis_label(x.as_str())
        .y_axis_label(y.as_str())
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .show(ui, |plot| {
            plot.bar_chart(BarChart::new(&curve.name, bars).color(colour));
        });
}

/// Leaves a target's light out, or counts it again.
pub fn toggle_ignored(view: &mut VolumeView, target: Target) {
    if !view.ignored.remove(&target) {
        view.ignored.insert(target);
    }
    view.against = Against::Ignoring;
}

/// Leaves a material's light out, or counts it again.
pub fn toggle_material(view: &mut VolumeView, material: u32) {
    if !view.ignored_materials.remove(&material) {
        view.ignored_materials.insert(material);
    }
    view.against = Against::Ignoring;
}
