//! The sphere unfolded: each hemisphere as the (u, v) square its bins are a grid on.

use super::{
    number,
    sphere_image::{ImageSlot, SphereValues, draw_square, key},
};
use egui::{Rect, Sense, pos2, vec2};
use glam::Vec3;
use lumenscope_core::math::colour::luminance;

/// Shows the upper and the lower hemisphere side by side, `size` points each; hovering reads a bin.
pub fn show(
    ui: &mut egui::Ui,
    slots: &mut [ImageSlot; 2],
    size: f32,
    sphere: &SphereValues<'_>,
    picture_key: u64,
    colour: &dyn Fn(Vec3) -> [u8; 3],
    unit: &str,
) {
    ui.horizontal(|ui| {
        for (slot, (lower, name)) in slots.iter_mut().zip([(false, "upper, y ≥ 0"), (true, "lower, y < 0")])
        {
            ui.vertical(|ui| {
                ui.set_width(size);
                ui.label(egui::RichText::new(name).small());
                let (rect, response) = ui.allocate_exact_size(vec2(size, size), Sense::hover());
                let pixels = (size * ui.pixels_per_point()).clamp(32.0, 512.0) as usize;
                let texture = slot.texture(ui.ctx(), "unfolded", key((picture_key, lower, pixels)), || {
                    draw_square(sphere, lower, pixels, colour)
                });
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(texture, rect, whole, egui::Color32::WHITE);
                if let Some(at) = response.hover_pos() {
                    let bin = bin_at(sphere, (at - rect.min) / size, lower);
                    let value = sphere.values.get(bin).copied().unwrap_or(Vec3::ZERO);
                    response.on_hover_text_at_pointer(format!(
                        "bin {bin}, direction ({})\n{}\nred, green, blue: {} {unit}",
                        number::point(sphere.bins.centre(bin)),
                        number::with_unit(luminance(value), unit),
                        number::triple(value),
                    ));
                }
            });
        }
    });
}

fn bin_at(sphere: &SphereValues<'_>, at: egui::Vec2, lower: bool) -> usize {
    let n = sphere.bins.n();
    let cell = |v: f32| ((v.clamp(0.0, 1.0) * n as f32) as u32).min(n - 1);
    (cell(at.y) * n + cell(at.x) + if lower { n * n } else { 0 }) as usize
}
