//! What is drawn over the picture: lamps, the open point, the axes, the state, the read-out.

use super::{pick::Glance, screen::Screen};
use crate::widgets::number;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, pos2, vec2};
use glam::{Affine3A, Vec3};
use lumenscope_core::{
    inspection::Label,
    irradiance_volume::dynamic_object::Detail,
    scene::{
        Scene, Target,
        lamp::{Lamp, LampKind},
        world::World,
    },
    superposition::gbuffer::first_visible,
    transport::{LightTransportSolution, solution::State},
};

/// Distance from a lamp's glyph that still hits it, points.
pub const GLYPH_RADIUS: f32 = 11.0;

const AXES: [(Vec3, &str, Color32); 3] = [
    (Vec3::X, "x", Color32::from_rgb(232, 84, 88)),
    (Vec3::Y, "y", Color32::from_rgb(118, 190, 76)),
    (Vec3::Z, "z", Color32::from_rgb(76, 142, 240)),
];
const SELECTED: Color32 = Color32::from_rgb(255, 176, 46);

/// Lamp whose glyph is under the cursor, the nearest to the eye first.
pub fn lamp_at(screen: &Screen, scene: &Scene, at: Pos2) -> Option<usize> {
    scene
        .lamps
        .iter()
        .enumerate()
        .filter_map(|(i, lamp)| Some((i, screen.project(lamp.position())?)))
        .filter(|(_, (place, _))| place.distance(at) <= GLYPH_RADIUS)
        .min_by(|a, b| a.1.1.total_cmp(&b.1.1))
        .map(|(i, _)| i)
}

/// Draws the lamps' glyphs; the hovered one with its name.
pub fn lamps(
    painter: &Painter,
    screen: &Screen,
    scene: &Scene,
    selected: Option<Target>,
    hovered: Option<usize>,
) {
    for (i, lamp) in scene.lamps.iter().enumerate() {
        let Some((at, _)) = screen.project(lamp.position()) else { continue };
        if !screen.rect.contains(at) {
            continue;
        }
        let is_selected = selected == Some(Target::Lamp(i));
        let colour = if is_selected {
            SELECTED
        } else if lamp.dimmer > 0.0 {
            Color32::from_rgb(255, 236, 170)
        } else {
            Color32::from_gray(150)
        };
        glyph(painter, screen, at, lamp, colour, is_selected || hovered == Some(i));
        if hovered == Some(i) {
            tag(painter, at + vec2(14.0, 0.0), Align2::LEFT_CENTER, &lamp_text(lamp));
        }
    }
}

fn glyph(painter: &Painter, screen: &Screen, at: Pos2, lamp: &Lamp, colour: Color32, strong: bool) {
    let dark = Stroke::new(3.0, Color32::from_black_alpha(150));
    let line = Stroke::new(1.6, colour);
    let radius = if strong { 6.0 } else { 4.5 };
    painter.circle(at, radius + 1.2, Color32::from_black_alpha(110), Stroke::NONE);
    match lamp.kind {
        LampKind::Point { .. } => {
            for i in 0..8 {
                let (sin, cos) = (std::f32::consts::TAU * i as f32 / 8.0).sin_cos();
                let out = vec2(cos, sin);
                for stroke in [dark, line] {
                    painter.line_segment([at + out * (radius + 2.5), at + out * (radius + 5.0)], stroke);
                }
            }
        }
        LampKind::Spot { .. } | LampKind::Directional { .. } => {
            if let Some([from, to]) = screen.segment(lamp.position(), lamp.position() + lamp.axis() * 0.3) {
                let along = (to - from).normalized() * 20.0;
                for stroke in [dark, line] {
                    painter.arrow(from, along, stroke);
                }
            }
        }
    }
    painter.circle(at, radius, colour.gamma_multiply(0.85), Stroke::new(1.0, Color32::from_black_alpha(200)));
}

fn lamp_text(lamp: &Lamp) -> String {
    use lumenscope_core::math::colour::luminance;
    let value = match lamp.kind {
        LampKind::Point { intensity } | LampKind::Spot { intensity, .. } => {
            number::with_unit(luminance(intensity) * lamp.dimmer, "cd")
        }
        LampKind::Directional { illuminance } => {
            number::with_unit(luminance(illuminance) * lamp.dimmer, "lx")
        }
    };
    format!("{} · {value}", lamp.name)
}

/// Marks the open point and its normal.
pub fn probe(painter: &Painter, screen: &Screen, (position, normal): (Vec3, Vec3)) {
    let Some((at, depth)) = screen.project(position) else { return };
    if !screen.rect.contains(at) {
        return;
    }
    let length = 26.0 / screen.points_per_metre(depth);
    if let Some([from, to]) = screen.segment(position, position + normal * length) {
        painter.line_segment([from, to], Stroke::new(3.5, Color32::from_black_alpha(140)));
        painter.line_segment([from, to], Stroke::new(1.6, Color32::WHITE));
    }
    painter.circle(at, 4.0, SELECTED, Stroke::new(1.5, Color32::from_black_alpha(200)));
}

/// Draws a box around a target, placed where the user has put it.
pub fn outline(painter: &Painter, screen: &Screen, placement: Affine3A, low: Vec3, high: Vec3, moving: bool) {
    let corner = |i: usize| {
        let pick = |bit: usize, a: f32, b: f32| if i >> bit & 1 == 0 { a } else { b };
        placement.transform_point3(Vec3::new(
            pick(0, low.x, high.x),
            pick(1, low.y, high.y),
            pick(2, low.z, high.z),
        ))
    };
    let colour = SELECTED.gamma_multiply(if moving { 1.0 } else { 0.65 });
    for i in 0..8 {
        for bit in 0..3 {
            let k = i | 1 << bit;
            if k != i
                && let Some(ends) = screen.segment(corner(i), corner(k))
            {
                painter.line_segment(ends, Stroke::new(1.2, colour));
            }
        }
    }
}

/// Draws the axes in a corner; answers with the side to look from if one's end was clicked.
pub fn triad(ui: &egui::Ui, painter: &Painter, screen: &Screen, clicked: Option<Pos2>) -> Option<Vec3> {
    let centre = pos2(screen.rect.min.x + 40.0, screen.rect.max.y - 40.0);
    let view = screen.camera.view_from_world();
    let mut ends: Vec<(Vec3, Vec3, Option<&str>, Color32)> = AXES
        .iter()
        .flat_map(|&(axis, name, colour)| {
            let seen = view.transform_vector3(axis);
            [(seen, axis, Some(name), colour), (-seen, -axis, None, colour)]
        })
        .collect();
    ends.sort_by(|a, b| a.0.z.total_cmp(&b.0.z));
    let pointer = ui.input(|i| i.pointer.hover_pos());
    if pointer.is_some_and(|p| p.distance(centre) < 34.0) {
        painter.circle_filled(centre, 34.0, Color32::from_black_alpha(60));
    }
    let mut side = None;
    for (seen, axis, name, colour) in ends {
        let at = centre + vec2(seen.x, -seen.y) * 25.0;
        let fade = 0.45 + 0.55 * (0.5 + 0.5 * seen.z);
        match name {
            Some(name) => {
                painter.line_segment([centre, at], Stroke::new(2.0, colour.gamma_multiply(fade)));
                painter.circle_filled(at, 7.0, colour.gamma_multiply(fade));
                painter.text(at, Align2::CENTER_CENTER, name, FontId::proportional(11.0), Color32::BLACK);
            }
            None => {
                painter.circle(
                    at,
                    4.5,
                    Color32::from_black_alpha(90),
                    Stroke::new(1.2, colour.gamma_multiply(fade)),
                );
            }
        }
        if clicked.is_some_and(|p| p.distance(at) < 8.0) {
            side = Some(axis);
        }
    }
    side
}

/// Where the axes are drawn, so that a press there turns nothing.
pub fn over_triad(screen: &Screen, at: Pos2) -> bool {
    at.distance(pos2(screen.rect.min.x + 40.0, screen.rect.max.y - 40.0)) < 34.0
}

/// What is said about the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// Frames in the running mean, and how many it will take.
    pub frames: (u32, u32),
    /// Seconds the last frame took.
    pub seconds: f64,
    /// What draws: an adapter's name, or the processor.
    pub backend: String,
    /// What fills the viewport, if not the picture.
    pub compare: Option<&'static str>,
    /// Whether the picture is drawn with fewer pixels than there are.
    pub coarse: bool,
}

/// Draws the state of the light and of the picture.
pub fn status(
    painter: &Painter,
    screen: &Screen,
    status: &Status,
    solution: Option<&LightTransportSolution>,
) {
    let (dot, word) = match solution.map(|s| s.provenance.state) {
        None => (Color32::from_gray(150), "no light yet"),
        Some(State::Stale) => (Color32::from_rgb(232, 84, 88), "light stale"),
        Some(State::Refining) => (SELECTED, "light refining"),
        Some(State::Settled) if status.frames.0 < status.frames.1 => (SELECTED, "light settled"),
        Some(State::Settled) => (Color32::from_rgb(118, 190, 76), "settled"),
    };
    let mut text = String::from(word);
    if let Some(compare) = status.compare {
        text = format!("{compare} · {text}");
    }
    match status.frames {
        (_, 0) => {}
        _ if status.coarse => text += " · picture coarse",
        (0, _) => text += " · picture refining",
        (done, all) if done < all => text += &format!(" · picture {done} of {all} frames"),
        (done, _) => text += &format!(" · {done} frames"),
    }
    if let Some(solution) = solution.filter(|s| !s.moved_objects.is_empty()) {
        text += match solution.detail {
            Detail::Coarse => " · moved: lit coarsely",
            Detail::Vertices => " · moved: lit at vertices",
            Detail::Fine => " · moved: lit finely",
            Detail::Pixels => " · moved: lit at pixels",
        };
    }
    if status.seconds > 0.0 {
        text += &format!(" · {} ms a frame", number::short((status.seconds * 1e3) as f32));
    }
    if !status.backend.is_empty() {
        text += &format!(" · {}", status.backend);
    }
    let at = screen.rect.min + vec2(24.0, 18.0);
    let rect = tag(painter, at, Align2::LEFT_CENTER, &text);
    painter.circle_filled(pos2(rect.min.x - 7.0, rect.center().y), 4.0, dot);
}

/// Draws the words of a view that nothing stands in front of, the strong ones on plates.
pub fn labels(painter: &Painter, screen: &Screen, world: &World, labels: &[Label]) {
    let mut taken: Vec<Rect> = Vec::new();
    // Strong words first: where two would overlap, the later one is left out.
    let (strong, plain): (Vec<&Label>, Vec<&Label>) = labels.iter().partition(|l| l.strong);
    for label in strong.into_iter().chain(plain) {
        let Some((at, _)) = screen.project(label.position) else { continue };
        let eye = screen.camera.eye;
        // Words stand off what they are written on by less than this share of their distance.
        let hidden = first_visible(world, eye, label.position - eye).is_some_and(|hit| hit.t < 0.995);
        if hidden || !screen.rect.contains(at) {
            continue;
        }
        let ink = Color32::from_gray(240);
        let galley = painter.layout_no_wrap(label.text.clone(), FontId::proportional(11.0), ink);
        let rect = Align2::CENTER_CENTER.anchor_size(at, galley.size());
        if taken.iter().any(|t| t.intersects(rect.expand(1.0))) {
            continue;
        }
        taken.push(rect);
        if label.strong {
            painter.rect_filled(rect.expand2(vec2(4.0, 1.0)), 3.0, Color32::from_black_alpha(170));
        } else {
            let shadow = painter.layout_no_wrap(
                label.text.clone(),
                FontId::proportional(11.0),
                Color32::from_black_alpha(200),
            );
            painter.galley(rect.min + vec2(1.0, 1.0), shadow, Color32::BLACK);
        }
        painter.galley(rect.min, galley, Color32::WHITE);
    }
}

/// Draws what the cursor is on.
pub fn read_out(painter: &Painter, screen: &Screen, solution: &LightTransportSolution, glance: &Glance) {
    let geometry = &solution.world.geometry;
    let triangle = glance.surface.triangle;
    let object = geometry.object[triangle as usize] as usize;
    let name = solution.scene.objects.get(object).map_or("", |o| o.name.as_str());
    let text = format!(
        "{} · {} · {} at {} m",
        number::with_unit(glance.luminance, "cd/m²"),
        number::with_unit(glance.illuminance, "lx"),
        if name.is_empty() { geometry.material_of(triangle).name.as_str() } else { name },
        number::short(glance.distance),
    );
    let at = pos2(screen.rect.center().x, screen.rect.max.y - 16.0);
    tag(painter, at, Align2::CENTER_CENTER, &text);
}

/// Text on a dark plate, legible over any picture in either theme.
pub fn tag(painter: &Painter, at: Pos2, anchor: Align2, text: &str) -> Rect {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), Color32::from_gray(235));
    let rect = anchor.anchor_size(at, galley.size());
    painter.rect_filled(rect.expand2(vec2(6.0, 3.0)), 4.0, Color32::from_black_alpha(150));
    painter.galley(rect.min, galley, Color32::WHITE);
    rect
}
