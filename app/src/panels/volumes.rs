//! Two volumes compared: surfaces that one leaves out, and volumes kept to come back to.

use super::{edit_view, named, section};
use crate::{
    command::{Command, Dialog},
    document::exists,
    pipeline::{DIFFERENCES, VolumeSource},
    session::{Against, Session, VolumeView},
};
use egui::Ui;
use egui_plot::{Bar, BarChart, Plot};
use lumenscope_core::{inspection::Curve, scene::Target};

/// Shows what the volume is compared with.
pub fn show(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    let Some(scene) = session.scene.as_deref() else { return };
    section(ui, "Compare volumes", |ui| {
        let view = &session.document.view;
        edit_view(view, out, |view| {
            let against = &mut view.volume.against;
            ui.radio_value(against, Against::Ignoring, "Without the light of").on_hover_text(
            "The same volume, but rays that meet these surfaces bring nothing; from what the rays met, so \
             nothing is traced again. Select something in the scene and press I to add it or take it away.\n\n\
             E_A − E_B = what comes straight from them, lx",
        );
            let ignored: Vec<Target> = view.volume.ignored.iter().copied().collect();
            ui.indent("ignored", |ui| {
                for target in ignored.iter().copied().filter(|&t| exists(scene, t)) {
                    let name = scene.target_name(target);
                    ui.horizontal(|ui| {
                        let close = ui.small_button("×").on_hover_text("Count its light again");

                        let close = named(close, &format!("Count {name}"));
                        if close.clicked() {
                            view.volume.ignored.remove(&target);
                        }
                        ui.label(name);
                    });
                }
                match view.selected.filter(|t| exists(scene, *t) && !ignored.contains(t)) {
                    Some(target) => {
                        let text = format!("Ignore {}", scene.target_name(target));
                        if ui.button(text).on_hover_text("Leave its light out (I)").clicked() {
                            toggle_ignored(&mut view.volume, target);
                        }
                    }
                    None if ignored.is_empty() => {
                        ui.weak("Click something in the scene, then press I.");
                    }
                    None => {}
                }
            });
            for (number, kept) in session.kept.iter().enumerate() {
                ui.horizontal(|ui| {
                    ui.radio_value(&mut view.volume.against, Against::Kept(number), &kept.name)
                        .on_hover_text("A volume that was kept: samples × bins");
                });
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
