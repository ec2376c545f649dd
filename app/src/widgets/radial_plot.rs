//! Radial plots: the value in every direction of a plane as the distance from the middle.

use super::{number, sphere_image::SphereValues};
use egui::Color32;
use egui_plot::{Line, Plot, PlotPoint, PlotPoints, Text};
use glam::Vec3;
use lumenscope_core::math::colour::Channel;

/// Directions a curve is drawn through.
const STEPS: usize = 360;

/// A plane through the point, and its axes on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// x to the right, y up: seen from +z.
    Xy,
    /// z to the right, y up: seen from −x.
    Zy,
    /// x to the right, z down: seen from above.
    Xz,
}

impl Plane {
    /// Every plane.
    pub const ALL: [Self; 3] = [Self::Xy, Self::Zy, Self::Xz];

    /// Directions to the right and up on the page.
    pub fn axes(self) -> [Vec3; 2] {
        match self {
            Self::Xy => [Vec3::X, Vec3::Y],
            Self::Zy => [Vec3::Z, Vec3::Y],
            Self::Xz => [Vec3::X, Vec3::NEG_Z],
        }
    }

    /// What the plane is called, and how it lies.
    pub fn title(self) -> &'static str {
        match self {
            Self::Xy => "xy, from the front",
            Self::Zy => "yz, from the left",
            Self::Xz => "zx, from above",
        }
    }

    /// Names of its axes' ends: right, left, up, down on the page.
    pub fn ends(self) -> [&'static str; 4] {
        match self {
            Self::Xy => ["+x", "-x", "+y", "-y"],
            Self::Zy => ["+z", "-z", "+y", "-y"],
            Self::Xz => ["+x", "-x", "-z", "+z"],
        }
    }
}

/// How a plot is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Width, points.
    pub size: f32,
    /// What is drawn: of RGB, the luminous value and each channel.
    pub channel: Channel,
    /// Interpolate between bins.
    pub smooth: bool,
    /// Unit of the values.
    pub unit: &'a str,
}

/// Points of a curve: direction by direction, the value as radius.
pub fn curve(
    sphere: &SphereValues<'_>,
    plane: Plane,
    smooth: bool,
    measure: impl Fn(Vec3) -> f32,
) -> Vec<[f64; 2]> {
    let [right, up] = plane.axes();
    (0..=STEPS)
        .map(|i| {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / STEPS as f32).sin_cos();
            let value = measure(sphere.value(right * cos + up * sin, smooth));
            let value = if value.is_finite() { value } else { 0.0 };
            [f64::from(value * cos), f64::from(value * sin)]
        })
        .collect()
}

/// Shows one plane's plot.
pub fn show(ui: &mut egui::Ui, id: &str, sphere: &SphereValues<'_>, plane: Plane, look: Look<'_>) {
    let Look { size, channel, smooth, unit } = look;
    let mut lines: Vec<(&str, Color32, Vec<[f64; 2]>)> = Vec::new();
    for one in Channel::ALL.into_iter().filter(|&c| c != Channel::Rgb) {
        if channel == Channel::Rgb || channel == one {
            let points = curve(sphere, plane, smooth, |v| one.measure(v));
            lines.push((one.name(), channel_colour(ui.visuals(), one), points));
        }
    }
    let reach = lines.iter().flat_map(|(_, _, l)| l).fold(0.0f64, |m, p| m.max(p[0].hypot(p[1])));
    let (rings, outer) = rings(reach);
    let strong = ui.visuals().text_color();
    let faint = strong.gamma_multiply(0.25);
    ui.vertical(|ui| {
        ui.set_width(size);
        ui.label(egui::RichText::new(plane.title()).small());
        Plot::new(id)
            .width(size)
            .height(size)
            .data_aspect(1.0)
            .show_axes(false)
            .show_grid(false)
            .show_background(false)
            .allow_scroll(false)
            .allow_zoom(false)
            .allow_drag(false)
            .allow_boxed_zoom(false)
            .allow_axis_zoom_drag(false)
            .default_x_bounds(-1.18 * outer, 1.18 * outer)
            .default_y_bounds(-1.18 * outer, 1.18 * outer)
            .show_crosshair(false)
            .reset()
            .label_formatter(|_| None)
            .show(ui, |plot| {
                for ring in &rings {
                    plot.line(Line::new("", circle(*ring)).color(faint).width(1.0).allow_hover(false));
                }
                for end in [[outer, 0.0], [0.0, outer]] {
                    let ends = vec![[-end[0], -end[1]], end];
                    plot.line(Line::new("", ends).color(faint).width(1.0).allow_hover(false));
                }
                for (name, colour, points) in lines {
                    plot.line(Line::new(name, PlotPoints::from(points)).color(colour).width(1.8));
                }
                for (text, x, y) in label_places(plane, outer) {
                    plot.text(Text::new("", PlotPoint::new(x, y), text).color(strong).allow_hover(false));
                }
            });
        if let Some(ring) = rings.last() {
            let text = format!("outer ring {}", number::with_unit(*ring as f32, unit));
            ui.label(egui::RichText::new(text).small().weak());
        }
    });
}

fn channel_colour(visuals: &egui::Visuals, channel: Channel) -> Color32 {
    let own = |index: usize| {
        let mut rgb = [if visuals.dark_mode { 70 } else { 40 }; 3];
        rgb[index] = if visuals.dark_mode { 235 } else { 190 };
        Color32::from_rgb(rgb[0], rgb[1], rgb[2])
    };
    match channel {
        Channel::Rgb | Channel::Luminance => visuals.hyperlink_color,
        Channel::Red => own(0),
        Channel::Green => own(1),
        Channel::Blue => own(2),
    }
}

fn label_places(plane: Plane, outer: f64) -> [(&'static str, f64, f64); 4] {
    let [right, left, up, down] = plane.ends();
    let at = 1.09 * outer;
    [(right, at, 0.0), (left, -at, 0.0), (up, 0.0, at), (down, 0.0, -at)]
}

/// Round radii to compare with, and how far the plot reaches.
pub fn rings(reach: f64) -> (Vec<f64>, f64) {
    if reach.is_nan() || reach <= 0.0 {
        return (vec![1.0], 1.0);
    }
    let magnitude = 10f64.powf(reach.log10().floor());
    let step = [0.2, 0.5, 1.0, 2.0, 5.0]
        .map(|m| m * magnitude)
        .into_iter()
        .find(|s| reach / s <= 4.0)
        .unwrap_or(magnitude);
    let count = (reach / step).ceil().max(1.0) as usize;
    let rings: Vec<f64> = (1..=count).map(|i| i as f64 * step).collect();
    let outer = rings.last().copied().unwrap_or(step);
    (rings, outer)
}

fn circle(radius: f64) -> Vec<[f64; 2]> {
    (0..=72)
        .map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 72.0).sin_cos();
            [radius * cos, radius * sin]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumenscope_core::math::{colour::luminance, sphere_map::DirectionBins};

    #[test]
    fn light_from_plus_x_points_right_in_the_planes_that_hold_x() {
        let bins = DirectionBins::new(17);
        let values: Vec<Vec3> = (0..bins.len()).map(|b| Vec3::splat(bins.centre(b).x.max(0.0))).collect();
        let sphere = SphereValues { bins, values: &values };
        let widest = |plane| {
            curve(&sphere, plane, true, luminance)
                .into_iter()
                .fold([0.0f64; 2], |m, p| if p[0].hypot(p[1]) > m[0].hypot(m[1]) { p } else { m })
        };
        assert!(widest(Plane::Xy)[0] > 0.95 && widest(Plane::Xz)[0] > 0.95);
        assert!(widest(Plane::Zy)[0].hypot(widest(Plane::Zy)[1]) < 0.1);
    }

    #[test]
    fn rings_are_round_and_reach_the_curve() {
        for reach in [0.013, 1.0, 7.3, 980.0, 1234.0] {
            let (rings, outer) = rings(reach);
            assert!(outer >= reach && outer < 2.1 * reach && rings.len() <= 5, "{reach}: {rings:?}");
        }
    }
}
