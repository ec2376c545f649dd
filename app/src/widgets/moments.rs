//! Moments of the light at a point: a sphere an order, and the lobe each order weighs radiance with.

use super::sphere_image::{ImageSlot, SphereValues, draw, key};
use egui::{Color32, DragValue, Rect, RichText, Sense, pos2, vec2};
use egui_plot::{Legend, Line, Plot, PlotPoints};
use glam::{Mat3, Vec3};
use lumenscope_core::{
    irradiance_volume::moments::Order,
    math::{part::Part, sphere_map::DirectionBins},
};

/// Angles a curve is drawn through, from −90° to 90°.
const STEPS: i32 = 180;

/// Moments at a point, made by the worker.
#[derive(Clone, Debug, PartialEq)]
pub struct Spheres {
    /// Part of the light.
    pub part: Part,
    /// Each order with its moment towards every bin, lx.
    pub of: Vec<(Order, Vec<Vec3>)>,
}

impl Spheres {
    /// Orders that are shown, lowest first: those of the thesis, and one besides.
    pub fn orders(besides: Option<Order>) -> Vec<Order> {
        let mut orders: Vec<Order> = Order::THESIS.into_iter().chain(besides).collect();
        orders.sort_unstable();
        orders.dedup();
        orders
    }
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

/// Shows a sphere for each order beside the lobe that it weighs radiance with.
pub fn show(
    ui: &mut egui::Ui,
    slots: &mut Vec<ImageSlot>,
    bins: DirectionBins,
    spheres: Option<&Spheres>,
    besides: &mut Option<Order>,
    look: &Look<'_>,
) {
    order_besides(ui, besides);
    let Some(spheres) =
        spheres.filter(|s| s.part == look.part && s.of.iter().all(|m| m.1.len() == bins.len()))
    else {
        ui.label("Weighing the radiance of every bin for every order.");
        return;
    };
    let count = spheres.of.len();
    slots.resize_with(count, ImageSlot::default);
    let gap = 6.0;
    let size = ((ui.available_width() - gap * count as f32) / count as f32).clamp(40.0, 130.0);
    ui.spacing_mut().item_spacing.x = gap;
    ui.horizontal_top(|ui| {
        for ((order, values), slot) in spheres.of.iter().zip(slots) {
            let order = *order;
            ui.vertical(|ui| {
                ui.set_width(size);
                ui.label(RichText::new(format!("n = {order}")).small().strong())
                    .on_hover_text(meaning(order));
                let sphere = SphereValues { bins, values };
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
    weights(ui, spheres.of.iter().map(|m| m.0));
    ui.label(
        RichText::new("H(ω) = (n + 1)/2 ∫ L(ω') max(0, ω·ω')^n dω', lx: n = 1 is irradiance, ∞ is πL.")
            .small()
            .weak(),
    );
}

/// An order beside those of the thesis: 1 to 10,000.
fn order_besides(ui: &mut egui::Ui, besides: &mut Option<Order>) {
    ui.horizontal(|ui| {
        let mut on = besides.is_some();
        ui.checkbox(&mut on, "Another order")
            .on_hover_text("A moment of any order beside those of the thesis");
        let mut n = match *besides {
            Some(Order::Finite(n)) => n,
            _ => 30,
        };
        if on {
            let number = ui.add(DragValue::new(&mut n).range(1..=Order::HIGHEST));
            crate::panels::named(number, "Order of the moment");
        }
        *besides = on.then_some(Order::Finite(n));
    });
}

fn meaning(order: Order) -> &'static str {
    match order {
        Order::IRRADIANCE => "Irradiance: what a matt surface facing ω receives, lx",
        Order::Finite(_) => "What a glossy surface that reflects towards ω as cos^n sees, lx",
        Order::Infinite => "What a mirror that reflects towards ω shows, times π",
    }
}

/// The weight of radiance by its angle from ω, each curve scaled to 1 in its middle.
fn weights(ui: &mut egui::Ui, orders: impl Iterator<Item = Order>) {
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
            for order in orders {
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
