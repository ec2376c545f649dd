//! The scene: objects and lamps, what is selected, where it stands and how bright it is set.

use super::{edit_view, named, number, section};
use crate::{
    command::Command,
    document::{MOST_DIMMER, is_movable},
    session::Session,
};
use egui::{DragValue, Grid, Response, RichText, ScrollArea, Slider, TextEdit, Ui};
use glam::{Affine3A, EulerRot, Quat, Vec3};
use lumenscope_core::scene::{Scene, Target, lamp::LampKind};

/// What the panel remembers.
#[derive(Default)]
pub struct State {
    filter: String,
    scrolled_to: Option<Target>,
}

/// Shows the list and, below it, what is selected.
pub fn show(ui: &mut Ui, state: &mut State, session: &Session, out: &mut Vec<Command>) {
    let Some(scene) = session.scene.as_deref() else {
        ui.weak("Objects and lamps appear here when a scene is open.");
        return;
    };
    let search = TextEdit::singleline(&mut state.filter).hint_text("Search").desired_width(f32::INFINITY);
    named(ui.add(search), "Search").on_hover_text("Show only names that contain this");
    ui.add_space(4.0);
    let height = if session.document.view.selected.is_some() { 120.0 } else { f32::INFINITY };
    ScrollArea::vertical().id_salt("targets").max_height(height).auto_shrink(false).show(ui, |ui| {
        list(ui, state, scene, session, out);
    });
    if let Some(target) = session.document.view.selected {
        ui.separator();
        selected(ui, scene, session, target, out);
    }
}

fn list(ui: &mut Ui, state: &mut State, scene: &Scene, session: &Session, out: &mut Vec<Command>) {
    let lamps = (0..scene.lamps.len()).map(Target::Lamp);
    let objects = (0..scene.objects.len()).map(Target::Object);
    let mut targets: Vec<Target> = lamps.chain(objects).collect();
    targets.sort_by_key(|&t| (!scene.emits(t), !is_movable(scene, t)));
    let filter = state.filter.to_lowercase();
    let view = &session.document.view;
    let follow = view.selected.is_some() && view.selected != state.scrolled_to;
    state.scrolled_to = view.selected;
    for target in targets {
        let name = scene.target_name(target);
        if !name.to_lowercase().contains(&filter) {
            continue;
        }
        let (lamp, movable) = (scene.emits(target), is_movable(scene, target));
        let mark = if lamp { "●" } else { "■" };
        let colour = match (lamp, movable) {
            (true, _) => crate::theme::accent(ui.visuals()),
            (false, true) => ui.visuals().text_color(),
            (false, false) => ui.visuals().weak_text_color().gamma_multiply(0.6),
        };
        let kind = match (lamp, movable) {
            (true, true) => "lamp, can be dragged",
            (true, false) => "lamp, fixed",
            (false, true) => "object, can be dragged",
            (false, false) => "object, fixed",
        };
        let selected = view.selected == Some(target);
        let changed = session.document.edits.placements.contains_key(&target)
            || session.document.edits.dimmers.contains_key(&target);
        let text = format!("{name}{}", if changed { " •" } else { "" });
        let hand = RichText::new(if movable { "↔" } else { "" }).weak();
        let row = ui.selectable_label(selected, (RichText::new(mark).color(colour), text, hand));
        let row = row.on_hover_text(kind);
        if follow && selected {
            row.scroll_to_me(Some(egui::Align::Center));
        }
        if row.clicked() {
            edit_view(view, out, |v| v.selected = (!selected).then_some(target));
        }
    }
}

fn selected(ui: &mut Ui, scene: &Scene, session: &Session, target: Target, out: &mut Vec<Command>) {
    ui.label(RichText::new(scene.target_name(target)).strong());
    if scene.emits(target) {
        dimmer(ui, scene, session, target, out);
    }
    let placement = scene.placement(target);
    let kind = match target {
        Target::Lamp(i) => Some(scene.lamps[i].kind),
        Target::Object(_) => None,
    };
    let has_place = !matches!(kind, Some(LampKind::Directional { .. }));
    let has_turn = !matches!(kind, Some(LampKind::Point { .. }));
    ui.add_enabled_ui(is_movable(scene, target), |ui| {
        transform(ui, placement, [has_place, has_turn], |placement, dragging| {
            out.push(Command::Place { target, placement, dragging });
        })
    })
    .inner
    .then(|| out.push(Command::EndDrag));
    if let Target::Object(i) = target {
        section(ui, "Material", |ui| materials(ui, scene, i));
    }
}

fn dimmer(ui: &mut Ui, scene: &Scene, session: &Session, target: Target, out: &mut Vec<Command>) {
    let (mut value, unit) = match target {
        Target::Object(i) => (scene.objects[i].dimmer, "lm"),
        Target::Lamp(i) => match scene.lamps[i].kind {
            LampKind::Directional { .. } => (scene.lamps[i].dimmer, "lx"),
            _ => (scene.lamps[i].dimmer, "lm"),
        },
    };
    ui.horizontal(|ui| {
        let label =
            ui.label("Dimmer").on_hover_text("Factor on the emission: 1 as the file says, 0 switched off");
        let slider = Slider::new(&mut value, 0.0..=MOST_DIMMER).logarithmic(true).smallest_positive(0.01);
        let response = ui.add(slider.max_decimals(2)).labelled_by(label.id);
        if response.changed() {
            out.push(Command::Dim { target, dimmer: value, dragging: response.dragged() });
        }
        if response.drag_stopped() {
            out.push(Command::EndDrag);
        }
    });
    if let Some(flux) = session.flux(target) {
        let tooltip = "Luminous flux Φ = π ∫ L dA of a surface, ∫ I dω of a point or spot lamp; \
                       for parallel light its illuminance.";
        ui.horizontal(|ui| {
            ui.label("Emits").on_hover_text(tooltip);
            ui.label(RichText::new(format!("{} {unit}", number(flux))).strong()).on_hover_text(tooltip);
        });
    }
}

/// Shows position and turn; true when a drag of a number ended.
fn transform(
    ui: &mut Ui,
    placement: Affine3A,
    [has_place, has_turn]: [bool; 2],
    mut place: impl FnMut(Affine3A, bool),
) -> bool {
    let (scale, rotation, mut position) = placement.to_scale_rotation_translation();
    let (y, x, z) = rotation.to_euler(EulerRot::YXZ);
    // Rounded, so that a turn of nothing does not read −0.0°.
    let mut degrees = Vec3::new(x, y, z).map(|r| (r.to_degrees() * 100.0).round() / 100.0 + 0.0);
    let mut ended = false;
    let mut changed = None;
    let mut watch = |r: Response| {
        if r.changed() {
            changed = Some(r.dragged());
        }
        ended |= r.drag_stopped();
    };
    Grid::new("transform").num_columns(4).spacing([5.0, 3.0]).show(ui, |ui| {
        if has_place {
            ui.label("Position").on_hover_text("World position, m; y is up");
            for (name, value) in ["x", "y", "z"].iter().zip(position.as_mut()) {
                let drag = DragValue::new(value).speed(0.01).max_decimals(3).suffix(" m");
                watch(named(ui.add(drag), &format!("Position {name}")));
            }
            ui.end_row();
        }
        if has_turn {
            ui.label("Turn").on_hover_text("About x, y, z in degrees: first z, then x, then y");
            for (name, value) in ["x", "y", "z"].iter().zip(degrees.as_mut()) {
                let drag = DragValue::new(value).speed(0.5).max_decimals(1).suffix("°");
                watch(named(ui.add(drag), &format!("Turn {name}")));
            }
            ui.end_row();
        }
    });
    if let Some(dragging) = changed {
        let r = degrees.map(f32::to_radians);
        let rotation = Quat::from_euler(EulerRot::YXZ, r.y, r.x, r.z);
        place(Affine3A::from_scale_rotation_translation(scale, rotation, position), dragging);
    }
    ended
}

/// What is said of what glass passes.
const PASSES: &str =
    "Share t that passes of the light that is not reflected, in red, green and blue: L = t (1 − F) L′";

fn materials(ui: &mut Ui, scene: &Scene, object: usize) {
    let mut seen = Vec::new();
    for part in &scene.objects[object].parts {
        if seen.contains(&part.material) {
            continue;
        }
        seen.push(part.material);
        let material = &scene.materials[part.material];
        let r = material.reflectance;
        let sides = if material.double_sided { "both sides" } else { "front only" };
        let textured = if material.reflectance_texture.is_some() { ", textured" } else { "" };
        ui.horizontal_wrapped(|ui| {
            swatch(ui, r);
            ui.label(&material.name);
            let rgb = |v: Vec3| format!("{:.2} {:.2} {:.2}", v.x, v.y, v.z);
            if material.is_glass() {
                let passes = rgb(r * material.passes());
                ui.weak(format!("glass, passes {passes}{textured}, {sides}")).on_hover_text(PASSES);
            } else {
                let reflectance = "Diffuse reflectance ρ in red, green and blue: L = ρ E / π";
                ui.weak(format!("ρ {}{textured}, {sides}", rgb(r))).on_hover_text(reflectance);
            }
        });
        if material.emission != Vec3::ZERO {
            let e = material.emission;
            ui.weak(format!("emits {}  {}  {} cd/m²", number(e.x), number(e.y), number(e.z)));
        }
    }
}

fn swatch(ui: &mut Ui, reflectance: Vec3) {
    let [r, g, b] = lumenscope_core::math::colour::srgb8(reflectance);
    let (rect, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 2.0, egui::Color32::from_rgb(r, g, b));
}
