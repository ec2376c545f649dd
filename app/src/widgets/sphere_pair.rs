//! Two balls side by side, the radiance and the irradiance sphere, turned together by dragging.

use super::{
    number,
    sphere_image::{ImageSlot, SphereValues, direction_at, draw, key},
};
use egui::{Align2, Color32, CursorIcon, FontId, Pos2, Rect, Sense, pos2, vec2};
use glam::{Mat3, Quat, Vec2, Vec3};
use lumenscope_core::{math::colour::luminance, scene::camera::Camera};

/// One ball of the pair.
pub struct Ball<'a> {
    /// Its title.
    pub title: &'a str,
    /// What it shows, with its equation.
    pub meaning: &'a str,
    /// Its values.
    pub values: SphereValues<'a>,
    /// Their unit.
    pub unit: &'a str,
    /// From a value to display colour, sRGB.
    pub colour: &'a dyn Fn(Vec3) -> [u8; 3],
}

/// The turn of the balls against the viewport's camera: angles to the right and up, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turn(pub Vec2);

impl Turn {
    /// Follows a drag over something `size` points wide; a double click turns back.
    pub fn drag(&mut self, response: &egui::Response, size: f32) {
        if response.dragged() {
            self.0 += Vec2::new(response.drag_delta().x, response.drag_delta().y) * (2.4 / size);
            self.0.y = self.0.y.clamp(-3.0, 3.0);
        }
        if response.double_clicked() {
            *self = Self::default();
        }
    }

    /// Right, up and towards-the-viewer of the balls, in world space.
    pub fn world_from_view(self, camera: &Camera) -> Mat3 {
        let [right, up, forward] = crate::viewport::navigation::axes(camera);
        let about_up = Quat::from_axis_angle(camera.up.normalize_or(Vec3::Y), -self.0.x);
        let tilted = Quat::from_axis_angle(right, -self.0.y);
        Mat3::from_quat(about_up * tilted) * Mat3::from_cols(right, up, -forward)
    }
}

/// How the balls are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// The viewport's camera, whose side the balls are seen from.
    pub camera: &'a Camera,
    /// Normal to mark.
    pub normal: Option<Vec3>,
    /// Diameter, points.
    pub size: f32,
    /// Interpolate between bins.
    pub smooth: bool,
    /// Changes when the values or their colours do.
    pub picture_key: u64,
}

/// Shows the balls; dragging one turns both.
pub fn show(
    ui: &mut egui::Ui,
    slots: &mut [ImageSlot; 2],
    turn: &mut Turn,
    look: Look<'_>,
    balls: [Ball<'_>; 2],
) {
    let Look { camera, normal, size, smooth, picture_key } = look;
    let world_from_view = turn.world_from_view(camera);
    let view_key = key(world_from_view.to_cols_array().map(f32::to_bits));
    ui.horizontal(|ui| {
        for (i, (slot, ball)) in slots.iter_mut().zip(balls).enumerate() {
            ui.vertical(|ui| {
                ui.set_width(size);
                ui.label(egui::RichText::new(ball.title).strong()).on_hover_text(ball.meaning);
                let (rect, response) = ui.allocate_exact_size(vec2(size, size), Sense::click_and_drag());
                let response = response.on_hover_and_drag_cursor(CursorIcon::Grab);
                turn.drag(&response, size);
                let pixels = (size * ui.pixels_per_point()).clamp(64.0, 400.0) as usize;
                let slot_key = key((picture_key, view_key, pixels, smooth, i));
                let texture = slot.texture(ui.ctx(), "sphere", slot_key, || {
                    draw(&ball.values, world_from_view, pixels, smooth, ball.colour)
                });
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(texture, rect, whole, Color32::WHITE);
                axes(ui, rect, world_from_view, normal);
                let (low, high) = range(&ball.values);
                let text = format!("{} to {} {}", number::short(low), number::short(high), ball.unit);
                ui.label(egui::RichText::new(text).small())
                    .on_hover_text("Smallest and largest value over all directions");
                if let Some(at) = response.hover_pos()
                    && let Some(direction) = direction_at(on_ball(rect, at), world_from_view)
                {
                    let value = ball.values.value(direction, smooth);
                    response.on_hover_text_at_pointer(format!(
                        "{}\nred, green, blue: {} {}\ntowards ({})",
                        number::with_unit(luminance(value), ball.unit),
                        number::triple(value),
                        ball.unit,
                        number::point(direction),
                    ));
                }
            });
        }
    });
}

fn on_ball(rect: Rect, at: Pos2) -> Vec2 {
    let offset = (at - rect.center()) / (0.5 * rect.width());
    Vec2::new(offset.x, -offset.y)
}

fn range(values: &SphereValues<'_>) -> (f32, f32) {
    values
        .values
        .iter()
        .map(|v| luminance(*v))
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Marks where the axes and the surface's normal leave the ball.
fn axes(ui: &egui::Ui, rect: Rect, world_from_view: Mat3, normal: Option<Vec3>) {
    let painter = ui.painter_at(rect);
    let marks = [
        (Vec3::X, "x", Color32::from_rgb(232, 84, 88)),
        (Vec3::Y, "y", Color32::from_rgb(118, 190, 76)),
        (Vec3::Z, "z", Color32::from_rgb(76, 142, 240)),
    ];
    let normal = normal.map(|n| (n, "n", Color32::WHITE));
    for (direction, name, colour) in marks.into_iter().chain(normal) {
        let seen = world_from_view.transpose() * direction;
        if seen.z < 0.0 {
            continue;
        }
        let at = rect.center() + vec2(seen.x, -seen.y) * (0.5 * rect.width() - 4.0);
        painter.circle(at, 3.5, colour, egui::Stroke::new(1.0, Color32::from_black_alpha(180)));
        let inwards = (rect.center() - at).normalized() * if name == "n" { 21.0 } else { 10.0 };
        let out = at + if inwards.length() > 1.0 { inwards } else { vec2(8.0, -8.0) };
        let font = FontId::proportional(11.0);
        painter.text(
            out + vec2(0.8, 0.8),
            Align2::CENTER_CENTER,
            name,
            font.clone(),
            Color32::from_black_alpha(200),
        );
        painter.text(out, Align2::CENTER_CENTER, name, font, Color32::WHITE);
    }
}
