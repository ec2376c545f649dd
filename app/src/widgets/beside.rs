//! What a view shows beside the scene: small images and curves.

use egui::{Color32, Mesh, RichText, Sense, Shape, Ui, Vec2, pos2};
use egui_plot::{Line, Plot, PlotPoints};
use lumenscope_core::{
    inspection::{Curve, InspectionScene, NamedImage},
    math::colour::srgb8,
};
use std::{fmt::Debug, hash::Hash};

/// Edge of an image on screen, points.
const EDGE: f32 = 132.0;

/// Height of a plot, points.
const HEIGHT: f32 = 110.0;

/// Shows the images, then the curves; those with samples on their axis are shown with the volumes.
pub fn show(ui: &mut Ui, inspection: &InspectionScene) {
    ui.horizontal_wrapped(|ui| inspection.images.iter().for_each(|image| picture(ui, image, EDGE)));
    for (number, curve) in inspection.curves.iter().enumerate().filter(|(_, c)| !is_histogram(c)) {
        ui.label(RichText::new(&curve.name).small());
        plot(ui, number, &[curve], HEIGHT, true);
    }
}

/// Whether a curve counts samples.
pub fn is_histogram(curve: &Curve) -> bool {
    curve.axes[1].contains("samples")
}

/// An image of values from 0 to 1, every pixel a square; its longer edge in points.
pub fn picture(ui: &mut Ui, image: &NamedImage, edge: f32) {
    ui.vertical(|ui| {
        ui.label(RichText::new(&image.name).small());
        let (response, painter) = ui.allocate_painter(Vec2::splat(edge), Sense::hover());
        let (low, size) = (response.rect.min, edge / image.image.width.max(image.image.height) as f32);
        let mut mesh = Mesh::default();
        for y in 0..image.image.height {
            for x in 0..image.image.width {
                let [r, g, b] = srgb8(image.image.at(x, y));
                let at = pos2(low.x + x as f32 * size, low.y + y as f32 * size);
                let square = egui::Rect::from_min_size(at, Vec2::splat(size));
                mesh.add_colored_rect(square, Color32::from_rgb(r, g, b));
            }
        }
        painter.add(Shape::mesh(mesh));
    });
}

/// Curves over the same axes, which are `named` or not; the first in the accent's colour.
pub fn plot(ui: &mut Ui, id: impl Hash + Debug, curves: &[&Curve], height: f32, named: bool) {
    let Some(first) = curves.first() else { return };
    let [x, y] = &first.axes;
    let mut plot =
        Plot::new(("beside", id)).height(height).allow_scroll(false).allow_zoom(false).allow_drag(false);
    if named {
        plot = plot.x_axis_label(x.as_str()).y_axis_label(y.as_str());
    }
    if first.radial {
        plot = plot.data_aspect(1.0);
    }
    let colours = [crate::theme::accent(ui.visuals()), ui.visuals().weak_text_color()];
    plot.show(ui, |plot| {
        for (curve, colour) in curves.iter().zip(colours.into_iter().cycle()) {
            let points: PlotPoints<'_> =
                curve.points.iter().map(|p| [f64::from(p.x), f64::from(p.y)]).collect::<Vec<_>>().into();
            plot.line(Line::new(&curve.name, points).color(colour));
        }
    });
}
