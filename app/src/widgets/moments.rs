//! Moments of the light at a point: a sphere an order, and the lobe each order weighs radiance with.

use super::{
    Probe,
    sphere_image::{ImageSlot, SphereValues, draw, key},
};
use egui::{Color32, Rect, RichText, Sense, pos2, vec2};
use egui_plot::{Legend, Line, Plot, PlotPoints};
use glam::{Mat3, Vec3};
use lumenscope_core::{irradiance_volume::moments::Order, math::part::Part};
use std::sync::Arc;

/// Angles a curve is drawn through, from −90° to 90°.
const STEPS: i32 = 180;

/// What is kept between frames.
#[derive(Clone, Default)]
pub struct State {
    slots: Vec<ImageSlot>,
    /// Values of every order, for the probe with this key.
    values: Option<(u64, Arc<Vec<Vec<Vec3>>>)>,
}

/// How the spheres are drawn.
pub struct Look<'a> {
    /// Right, up and towards the viewer, in world space.
    pub world_from_view: Mat3,
    /// Part of the light.
    pub part: Part,
    /// Interpolate between bins.
    pub smooth: bool,
    /// Changes when the probe does.
    pub light_key: u64,
    /// Changes when the colours do.
    pub picture_key: u64,
    /// From a moment to display colour, sRGB.
    pub colour: &'a dyn Fn(Vec3) -> [u8; 3],
}

/// Shows a sphere for each order of the thesis, above the weights.
pub fn show(ui: &mut egui::Ui, state: &mut State, probe: &Probe, look: &Look<'_>) {
    let values = match &state.values {
        Some((of, values)) if *of == look.light_key => Arc::clone(values),
        _ => {
            let values: Vec<_> = Order::THESIS.map(|order| probe.moment(order, look.part)).into();
            let values = Arc::new(values);
            state.values = Some((look.light_key, Arc::clone(&values)));
            values
        }
    };
    let count = Order::THESIS.len();
    state.slots.resize_with(count, ImageSlot::default);
    let gap = 6.0;
    let size = ((ui.available_width() - gap * count as f32) / count as f32).clamp(40.0, 130.0);
    ui.spacing_mut().item_spacing.x = gap;
    ui.horizontal_top(|ui| {
        for ((order, values), slot) in Order::THESIS.into_iter().zip(values.iter()).zip(&mut state.slots) {
            ui.vertical(|ui| {
                ui.set_width(size);
                ui.label(RichText::new(format!("n = {order}")).small().strong())
                    .on_hover_text(meaning(order));
                let sphere = SphereValues { bins: probe.bins, values };
                let (rect, response) = ui.allocate_exact_size(vec2(size, size), Sense::hover());
                response.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Image, true, format!("moment of order {order}"))
                });
                let pixels = (size * ui.pixels_per_point()).clamp(32.0, 400.0) as usize;
                let seen = look.world_from_view.to_cols_array().map(f32::to_bits);
                let slot_key = key((look.light_key, look.picture_key, seen, pixels, look.smooth, look.part));
                let texture = slot.texture(ui.ctx(), "moment", slot_key, || {
                    draw(&sphere, look.world_from_view, pixels, look.smooth, look.colour)
                });
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(texture, rect, whole, Color32::WHITE);
            });
        }
    });
    weights(ui);
    ui.label(
        RichText::new("H(ω) = (n + 1)/2 ∫ L(ω') max(0, ω·ω')^n dω', lx: n = 1 is irradiance, ∞ is πL.")
            .small()
            .weak(),
    );
}

fn meaning(order: Order) -> &'static str {
    match order {
        Order::IRRADIANCE => "Irradiance: what a matt surface facing ω receives, lx",
        Order::Finite(_) => "What a glossy surface that reflects towards ω as cos^n sees, lx",
        Order::Infinite => "What a mirror that reflects towards ω shows, times π",
    }
}

/// The weight of radiance by its angle from ω, each curve scaled to 1 in its middle.
fn weights(ui: &mut egui::Ui) {
    let height = (0.45 * ui.available_width()).clamp(90.0, 170.0);
    Plot::new("weights of moments")
        .height(height)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .x_axis_label("angle from ω, degrees")
        .y_axis_label("weight / largest")
        .legend(Legend::default())
        .show(ui, |plot| {
            for order in Order::THESIS {
                plot.line(Line::new(format!("n = {order}"), PlotPoints::from(curve(order))).width(1.6));
            }
        });
}

/// Angle in degrees, and the weight there over that in the middle.
pub fn curve(order: Order) -> Vec<[f64; 2]> {
    if order == Order::Infinite {
        return vec![[0.0, 0.0], [0.0, 1.0]];
    }
    let most = order.weight(1.0);
    (0..=STEPS)
        .map(|i| {
            let degrees = f64::from(i) * 180.0 / f64::from(STEPS) - 90.0;
            [degrees, f64::from(order.weight(degrees.to_radians().cos() as f32) / most)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_peak_in_the_middle_and_narrow_with_the_order() {
        let half_width = |order| {
            let curve = curve(order);
            assert!((curve[curve.len() / 2][1] - 1.0).abs() < 1e-6);
            curve.iter().filter(|p| p[1] > 0.5).count()
        };
        let widths: Vec<usize> = Order::THESIS[..5].iter().map(|o| half_width(*o)).collect();
        // cos⁻¹ of ½ is 60°, of ½^(1/100) 6.7°: a point a degree.
        assert_eq!((widths[0], widths[4]), (119, 13));
        assert!(widths.windows(2).all(|w| w[0] > w[1]), "{widths:?}");
    }
}
