//! Placement: illuminance on a plane or an object's top, held against what a task needs.

use super::{edit_view, named, section};
use crate::{
    command::Command,
    placement::{PLACEMENT, Placement, Site, own_plane},
    session::Session,
    widgets::{
        placement_map,
        value_table::{self, Row},
    },
};
use egui::{Color32, ComboBox, DragValue, Grid, Response, RichText, Ui};
use lumenscope_core::{
    irradiance_volume::placement::{
        Measurement, Statistics,
        requirement::{PRESETS, Requirement},
    },
    scene::{Scene, Target},
};

/// Shows the choice, the verdict, the numbers and the map.
pub fn show(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    let Some(scene) = session.scene.as_deref() else {
        ui.weak("Open a scene to measure the light in it.");
        return;
    };
    let placement = &session.document.edits.placement;
    let mut changed = placement.clone();
    let mut drag = Drag::default();
    site(ui, scene, session, &mut changed, &mut drag);
    if changed.site.is_none() {
        ui.weak(
            "Choose a measuring plane or the top of an object: illuminance on it appears here in lux and \
             follows whatever you drag.",
        );
    } else {
        task(ui, &mut changed, &mut drag);
        let mut shown = session.document.view.shows(PLACEMENT);
        let hint = "False colour and lines of equal illuminance on the plane itself";
        if ui.checkbox(&mut shown, "Show in the picture").on_hover_text(hint).changed() {
            edit_view(&session.document.view, out, |view| view.show(PLACEMENT, shown));
        }
        match session.measurement.as_deref() {
            Some(measured) => result(ui, measured, &changed.requirement),
            None => {
                ui.weak("Measuring…");
            }
        }
    }
    if changed != *placement {
        out.push(Command::Measure { placement: Box::new(changed), dragging: drag.dragging });
    }
    if drag.ended {
        out.push(Command::EndDrag);
    }
}

/// What the numbers that were dragged say of the undo step.
#[derive(Default)]
struct Drag {
    dragging: bool,
    ended: bool,
}

impl Drag {
    fn watch(&mut self, response: &Response) {
        self.dragging |= response.dragged();
        self.ended |= response.drag_stopped();
    }
}

fn site(ui: &mut Ui, scene: &Scene, session: &Session, placement: &mut Placement, drag: &mut Drag) {
    let name = |site: Option<Site>| match site {
        None => "nothing".to_owned(),
        Some(Site::Plane(i)) => scene.planes.get(i).map_or_else(String::new, |p| p.name.clone()),
        Some(Site::Own) => placement.own.name.clone(),
        Some(Site::Top(i)) => format!("Top of {}", scene.objects.get(i).map_or("", |o| &o.name)),
    };
    let mut sites: Vec<Option<Site>> = vec![None];
    sites.extend((0..scene.planes.len()).map(|i| Some(Site::Plane(i))));
    sites.push(Some(Site::Own));
    if let Some(Target::Object(i)) = session.document.view.selected {
        sites.push(Some(Site::Top(i)));
    }
    if !sites.contains(&placement.site) {
        sites.push(placement.site);
    }
    let choices: Vec<(Option<Site>, String)> = sites.into_iter().map(|s| (s, name(s))).collect();
    let shown = name(placement.site);
    ui.horizontal(|ui| {
        ui.label("Measure").on_hover_text(
            "A plane of the scene file, a plane of your own, or the top of the selected object: of its level \
             surfaces that face up, the one of the largest area",
        );
        let list = ComboBox::from_id_salt("site").width(170.0).selected_text(shown);
        let list = list.show_ui(ui, |ui| {
            for (site, name) in &choices {
                ui.selectable_value(&mut placement.site, *site, name);
            }
        });
        named(list.response, "Measured place");
    });
    if placement.site == Some(Site::Own) {
        own(ui, session, placement, drag);
    }
}

fn own(ui: &mut Ui, session: &Session, placement: &mut Placement, drag: &mut Drag) {
    let plane = &mut placement.own;
    let middle = plane.corner + 0.5 * (plane.edge_u + plane.edge_v);
    let (mut at, mut size) = (middle, [plane.edge_u.length(), plane.edge_v.length()]);
    Grid::new("own plane").num_columns(4).spacing([5.0, 3.0]).show(ui, |ui| {
        ui.label("Middle").on_hover_text("World position of the plane's middle, m; y is up");
        for (axis, value) in ["x", "y", "z"].iter().zip(at.as_mut()) {
            let response = ui.add(DragValue::new(value).speed(0.01).max_decimals(2).suffix(" m"));
            drag.watch(&named(response, &format!("Plane {axis}")));
        }
        ui.end_row();
        ui.label("Size").on_hover_text("Along x and along z, m");
        for (name, value) in ["Plane width", "Plane depth"].iter().zip(&mut size) {
            let number = DragValue::new(value).speed(0.01).range(0.05..=200.0).max_decimals(2).suffix(" m");
            drag.watch(&named(ui.add(number), name));
        }
        if let Some((probe, _)) = session.document.view.probe {
            let hint = "Puts the plane's middle where the spheres are open";
            if ui.small_button("To the point").on_hover_text(hint).clicked() {
                at = probe;
            }
        }
        ui.end_row();
    });
    if at != middle || size != [plane.edge_u.length(), plane.edge_v.length()] {
        let mut moved = own_plane(at);
        (moved.edge_u, moved.edge_v) = (glam::Vec3::X * size[0], glam::Vec3::Z * -size[1]);
        moved.corner = at - 0.5 * (moved.edge_u + moved.edge_v);
        *plane = moved;
    }
}

fn task(ui: &mut Ui, placement: &mut Placement, drag: &mut Drag) {
    let wanted = &mut placement.requirement;
    ui.horizontal(|ui| {
        ui.label("Task").on_hover_text("What the light is for. The numbers below can be changed freely.");
        let shown = if wanted.task.is_empty() { "none" } else { &wanted.task };
        let list = ComboBox::from_id_salt("task").width(170.0).selected_text(shown.to_owned());
        let list = list.show_ui(ui, |ui| {
            if ui.selectable_label(wanted.is_empty(), "none").clicked() {
                *wanted = Requirement::default();
            }
            for preset in PRESETS {
                let row = ui.selectable_label(wanted.task == preset.task, preset.task);
                if row.on_hover_text(preset.source).clicked() {
                    *wanted = preset.requirement();
                }
            }
        });
        named(list.response, "Task");
    });
    Grid::new("wanted").num_columns(4).spacing([8.0, 3.0]).show(ui, |ui| {
        let mut row = |ui: &mut Ui, name, value: &mut Option<f32>, start, most, suffix, hint: &str| {
            let mut on = value.is_some();
            if ui.checkbox(&mut on, name).on_hover_text(hint).changed() {
                *value = on.then_some(start);
            }
            if let Some(value) = value {
                let speed = most / 1000.0;
                let number = DragValue::new(value).speed(speed).range(0.0..=most).suffix(suffix);
                drag.watch(&named(ui.add(number.max_decimals(2)), &format!("{name} asked for")));
            } else {
                ui.label("");
            }
        };
        let mean = "Smallest mean illuminance, lx: the maintained illuminance of EN 12464-1";
        row(ui, "Mean", &mut wanted.mean_lx, 500.0, 20_000.0, " lx", mean);
        let even = "Smallest uniformity U₀ = E_min / E_mean";
        row(ui, "U₀", &mut wanted.uniformity, 0.6, 1.0, "", even);
        ui.end_row();
        row(ui, "Least", &mut wanted.min_lx, 100.0, 20_000.0, " lx", "Smallest illuminance anywhere, lx");
        row(ui, "Most", &mut wanted.max_lx, 1000.0, 100_000.0, " lx", "Largest illuminance anywhere, lx");
        ui.end_row();
        ui.label("Kept in use").on_hover_text(
            "Maintenance factor: illuminance kept in use over that of new, clean lamps. Every value is multiplied \
             by it; 0.8 is usual where lamps are cleaned each year",
        );
        let factor = DragValue::new(&mut placement.maintenance_factor).speed(0.005).range(0.01..=1.0);
        drag.watch(&named(ui.add(factor.max_decimals(2)), "Maintenance factor"));
        ui.label("Grid").on_hover_text(
            "Points along each edge, in those that EN 12464-1 asks for: at most 0.2 · 5^(log₁₀ d) metres apart on \
             a field d metres long",
        );
        let finer = DragValue::new(&mut placement.finer).speed(0.05).range(1..=16).prefix("× ");
        drag.watch(&named(ui.add(finer), "Grid finer"));
        ui.end_row();
    });
}

fn result(ui: &mut Ui, measured: &Measurement, wanted: &Requirement) {
    let statistics = measured.statistics();
    verdict(ui, statistics.as_ref(), wanted);
    placement_map::show(ui, measured, wanted);
    let Some(s) = statistics else { return };
    section(ui, &measured.name, |ui| {
        value_table::show(ui, "illuminance", &rows(&s));
        ui.horizontal(|ui| {
            if ui
                .button("Copy grid")
                .on_hover_text("Copies every point as CSV: x, y, z in m, E in lx")
                .clicked()
            {
                ui.ctx().copy_text(crate::placement::csv(measured));
            }
            let how = match measured.gather_rays {
                0 => "indirect light from the volume".to_owned(),
                n => format!("indirect light by {n} rays a point"),
            };
            let left = if measured.inside > 0 {
                format!(", {} inside things", measured.inside)
            } else {
                String::new()
            };
            ui.weak(format!("{} points{left}; {how}", s.points));
        });
    });
}

/// The numbers of a measurement.
pub fn rows(s: &Statistics) -> Vec<Row> {
    vec![
        Row::one("Minimum", s.min_lx, "lx", "Smallest illuminance on the grid"),
        Row::one("Mean", s.mean_lx, "lx", "Arithmetic mean over the grid"),
        Row::one("Maximum", s.max_lx, "lx", "Largest illuminance on the grid"),
        Row::one("Uniformity U₀", s.uniformity, "", "E_min / E_mean"),
        Row::one("Diversity", s.diversity, "", "E_min / E_max"),
    ]
}

fn verdict(ui: &mut Ui, statistics: Option<&Statistics>, wanted: &Requirement) {
    let short = wanted.shortfalls(statistics);
    let plate = |ui: &mut Ui, fill: Color32, text: String| {
        egui::Frame::new().fill(fill).corner_radius(4).inner_margin(egui::Margin::symmetric(8, 4)).show(
            ui,
            |ui| {
                ui.set_min_width(ui.available_width());
                ui.label(RichText::new(text).color(Color32::WHITE).strong());
            },
        );
    };
    for shortfall in &short {
        plate(ui, Color32::from_rgb(170, 44, 40), format!("! {shortfall}"));
    }
    if short.is_empty() && !wanted.is_empty() {
        plate(
            ui,
            Color32::from_rgb(48, 112, 60),
            format!("Enough light for: {}", wanted.task.to_lowercase()),
        );
    }
}
