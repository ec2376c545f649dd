//! A lightmap baked elsewhere: itself, how far it is from our light, and its faults.

use super::{edit_view, section};
use crate::{
    command::{Command, Dialog},
    lightmaps::{JudgedLightmap, LIGHTMAPS, LightmapFile, PATHS},
    session::Session,
    widgets::{
        field::{Field, bulk},
        legend,
    },
};
use egui::{Color32, DragValue, Grid, RichText, Sense, Ui, vec2};
use lumenscope_core::{
    inspection::Legend,
    math::false_colour::{FalseColour, Palette},
    radiosity::faults::Fault,
    transport::solution::State as LightState,
};
use std::{fmt::Write as _, sync::Arc};

/// What the panel keeps between frames: the images of what it shows.
#[derive(Default)]
pub struct State {
    of: Option<Arc<JudgedLightmap>>,
    fields: Vec<Field>,
    colours: Option<FalseColour>,
}

/// Shows the lightmap, its difference to ours and its faults.
pub fn show(ui: &mut Ui, state: &mut State, session: &Session, out: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let hint = "A lightmap over the texture coordinates of the scene: irradiance in lx as .exr or .hdr, or .png. \
                    It can also be dropped onto the window.";
        if ui.button("Open a lightmap…").on_hover_text(hint).clicked() {
            out.push(Command::Dialog(Dialog::Lightmap));
        }
        if let Some(file) = &session.lightmap_file {
            white(ui, file, out);
            let mut traced = file.paths > 0;
            let hint = format!("Irradiance by the path tracer too, {PATHS} paths a texel: how far the lightmap and our light are from the truth");
            if ui.checkbox(&mut traced, "path tracer").on_hover_text(hint).changed() {
                let paths = if traced { PATHS } else { 0 };
                out.push(Command::Lightmap(LightmapFile { paths, ..file.clone() }));
            }
        }
    });
    let Some(file) = &session.lightmap_file else {
        ui.weak("A lightmap baked by another program is held against our light, texel by texel, and its faults are \
                 pointed out.");
        return;
    };
    ui.label(file.path.file_name().unwrap_or(file.path.as_os_str()).to_string_lossy());
    let Some(judged) = &session.lightmap else {
        ui.weak("It is held against our light as soon as that has settled.");
        return;
    };
    if state.of.as_ref().is_none_or(|of| !Arc::ptr_eq(of, judged)) {
        state.draw(judged);
    }
    if session.solution.as_ref().is_some_and(|s| s.provenance.state != LightState::Settled) {
        ui.weak("The light is changing; what is shown here is of the light before.");
    }
    in_scene(ui, session, out);
    let aspect = judged.map.height as f32 / judged.map.width.max(1) as f32;
    let width = ((ui.available_width() - 8.0) / 2.0).clamp(60.0, 300.0);
    for pair in state.fields.chunks_mut(2) {
        ui.horizontal_top(|ui| {
            for field in pair {
                field.show(ui, width, aspect);
            }
        });
    }
    if let Some(colours) = state.colours {
        bar(ui, "irradiance", &colours);
    }
    bar(ui, "lightmap − ours", &judged.difference_colours());
    section(ui, "Faults", |ui| faults(ui, judged));
}

fn in_scene(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    let traced = session.lightmap.as_ref().is_some_and(|l| l.traced.is_some());
    ui.horizontal_wrapped(|ui| {
        ui.label("In the scene")
            .on_hover_text("Shows it on the surfaces it was baked for; green lines are seams");
        edit_view(&session.document.view, out, |view| {
            let names = ["the lightmap", "its difference", "its error", "its faults"];
            for (id, name) in LIGHTMAPS.into_iter().zip(names) {
                if id.ends_with("_error") && !traced {
                    continue;
                }
                let mut on = view.shows(id);
                if ui.checkbox(&mut on, name).changed() {
                    // One covers the other.
                    LIGHTMAPS.into_iter().for_each(|id| view.show(id, false));
                    view.show(id, on);
                }
            }
        });
    });
}

fn white(ui: &mut Ui, file: &LightmapFile, out: &mut Vec<Command>) {
    let mut white = file.white;
    let speed = f64::from(white) * 0.01;
    let number = DragValue::new(&mut white).range(1e-3..=1e6).speed(speed).prefix("white ").suffix(" lx");
    let number = super::named(ui.add(number), "White of the lightmap");
    if number.on_hover_text("Irradiance of white in a .png, or of 1 in the others").changed() {
        out.push(Command::Lightmap(LightmapFile { white, ..file.clone() }));
    }
}

impl State {
    fn draw(&mut self, judged: &Arc<JudgedLightmap>) {
        let (ours, size) = (judged.ours(), [judged.map.width, judged.map.height]);
        let (difference, faults) = (judged.difference(), judged.fault_pixels());
        let covered = |i: usize| difference[i].is_some();
        let lit = (0..ours.pixels.len()).filter(|&i| covered(i));
        let high = bulk(lit.map(|i| ours.pixels[i]));
        let light = FalseColour { palette: Palette::Viridis, low: 0.0, high, logarithmic: false };
        self.fields = vec![
            Field::new("lightmap", &judged.map, &light, |_| true),
            Field::new("our light on it", &ours, &light, covered),
            Field::signed("difference", size, &judged.difference_colours(), |i| difference[i]),
            Field::of_pixels("faults", size, faults.into_iter()),
        ];
        self.colours = Some(light);
        self.of = Some(judged.clone());
    }
}

fn bar(ui: &mut Ui, quantity: &str, colours: &FalseColour) {
    let range = [colours.low, colours.high];
    legend::show_flat(
        ui,
        &Legend { quantity: quantity.into(), unit: "lx".into(), range, names: &[] },
        colours,
    );
}

fn faults(ui: &mut Ui, judged: &JudgedLightmap) {
    Grid::new("faults").num_columns(3).spacing([8.0, 3.0]).show(ui, |ui| {
        for fault in Fault::ALL {
            let (count, of) = judged.report.count(fault);
            let [r, g, b] = fault.colour();
            let (patch, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
            ui.painter().rect_filled(patch, 2.0, Color32::from_rgb(r, g, b));
            ui.label(fault.name()).on_hover_text(fault.meaning());
            ui.label(RichText::new(format!("{count} {of}")).monospace());
            ui.end_row();
        }
    });
    ui.label(format!(
        "{} texels covered, {} triangles off the map; relative to ours: median {:.1} %, 95th percentile {:.1} %",
        judged.report.texels.len(),
        judged.report.unmapped.len(),
        100.0 * judged.errors.median,
        100.0 * judged.errors.percentile_95
    ))
    .on_hover_text("|E − ours| / max(ours, 5 % of its mean) over the texels that a triangle covers");
    if let Some(traced) = &judged.traced {
        let percent = |x: f64| format!("{:.1} %", 100.0 * x);
        ui.label(format!(
            "to the path tracer: the lightmap median {}, 95th percentile {}; our light {} and {}; its own standard \
             error {}",
            percent(traced.of_map.median),
            percent(traced.of_map.percentile_95),
            percent(traced.of_ours.median),
            percent(traced.of_ours.percentile_95),
            percent(traced.noise)
        ));
    }
    if ui.button("Copy the faults").on_hover_text("Copies the numbers, tab-separated").clicked() {
        ui.ctx().copy_text(text(judged));
    }
}

/// The numbers, tab-separated.
pub fn text(judged: &JudgedLightmap) -> String {
    let mut text = String::new();
    for fault in Fault::ALL {
        let (count, of) = judged.report.count(fault);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}\t{count}\t{of}", fault.name());
    }
    let _ = writeln!(text, "median error\t{}\t", judged.errors.median);
    let _ = writeln!(text, "95th percentile of the error\t{}\t", judged.errors.percentile_95);
    if let Some(traced) = &judged.traced {
        for (name, errors) in [("lightmap", traced.of_map), ("ours", traced.of_ours)] {
            let _ = writeln!(text, "median error of {name} to the path tracer\t{}\t", errors.median);
        }
    }
    text
}
