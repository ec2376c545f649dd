//! One point at every resolution that the thesis shows, side by side, with what each misses.

use super::{
    Probe, number,
    sphere_image::{ImageSlot, SphereValues, draw, key},
};
use egui::{Color32, Rect, RichText, Sense, pos2, vec2};
use glam::{Mat3, Vec3};
use lumenscope_core::{irradiance_volume::probe::Quantity, math::part::Part};

/// Rows of bins a hemisphere that the thesis shows: 162, 578, 1682, 3362 and 4802 bins.
pub const ROWS: [u32; 5] = [9, 17, 29, 41, 49];

/// How the spheres are drawn.
pub struct Look<'a> {
    /// Right, up and towards the viewer, in world space.
    pub world_from_view: Mat3,
    /// Part of the light.
    pub part: Part,
    /// Interpolate between bins.
    pub smooth: bool,
    /// Changes when the values or their colours do.
    pub picture_key: u64,
    /// From radiance and from irradiance to display colour, sRGB.
    pub colours: [&'a dyn Fn(Vec3) -> [u8; 3]; 2],
}

/// Shows radiance above irradiance, a column a resolution, coarsest first.
pub fn show(ui: &mut egui::Ui, slots: &mut Vec<ImageSlot>, probes: &[Probe], look: &Look<'_>) {
    let Some(finest) = probes.last() else {
        ui.label("Sampling the spheres at every resolution.");
        return;
    };
    slots.resize_with(2 * probes.len(), ImageSlot::default);
    let gap = 6.0;
    let size = ((ui.available_width() - gap * probes.len() as f32) / probes.len() as f32).clamp(44.0, 150.0);
    let best = finest.values(Quantity::Irradiance, look.part);
    let best = SphereValues { bins: finest.bins, values: &best };
    ui.spacing_mut().item_spacing.x = gap;
    ui.horizontal_top(|ui| {
        for (i, probe) in probes.iter().enumerate() {
            ui.vertical(|ui| {
                ui.set_width(size);
                let title = format!("{} bins", probe.bins.len());
                ui.label(RichText::new(title).small().strong()).on_hover_text(format!(
                    "n = {}: 2n² bins of {} sr",
                    probe.bins.n(),
                    number::short(probe.bins.solid_angle())
                ));
                for (k, quantity) in [Quantity::Radiance, Quantity::Irradiance].into_iter().enumerate() {
                    let values = probe.values(quantity, look.part);
                    let sphere = SphereValues { bins: probe.bins, values: &values };
                    ball(ui, &mut slots[2 * i + k], &sphere, size, look, k);
                }
                let values = probe.values(Quantity::Irradiance, look.part);
                let sphere = SphereValues { bins: probe.bins, values: &values };
                let off = 100.0 * sphere.relative_difference(&best);
                let text = if i + 1 == probes.len() { "finest".into() } else { format!("{} %", number::short(off)) };
                ui.label(RichText::new(text).small()).on_hover_text(
                    "Irradiance, interpolated, against the finest sphere:\nroot mean square difference over all \
                     directions, as a share of the mean",
                );
            });
        }
    });
    ui.label(
        RichText::new("Radiance above, irradiance below; what E differs from the finest, root mean square.")
            .small()
            .weak(),
    );
}

fn ball(
    ui: &mut egui::Ui,
    slot: &mut ImageSlot,
    sphere: &SphereValues<'_>,
    size: f32,
    look: &Look<'_>,
    quantity: usize,
) {
    let (rect, _) = ui.allocate_exact_size(vec2(size, size), Sense::hover());
    let pixels = (size * ui.pixels_per_point()).clamp(32.0, 400.0) as usize;
    let seen = look.world_from_view.to_cols_array().map(f32::to_bits);
    let slot_key = key((look.picture_key, seen, pixels, look.smooth, sphere.bins.n(), quantity, look.part));
    let texture = slot.texture(ui.ctx(), "resolution", slot_key, || {
        draw(sphere, look.world_from_view, pixels, look.smooth, look.colours[quantity])
    });
    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture, rect, whole, Color32::WHITE);
}
