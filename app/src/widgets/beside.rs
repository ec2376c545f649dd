//! What a view shows beside the scene: small images and curves.

use egui::{Color32, Mesh, RichText, Sense, Shape, Ui, Vec2, pos2};
use egui_plot::{Line, Plot, PlotPoints};
use lumenscope_core::{
    inspection::{Curve, InspectionScene, NamedImage},
    math::colour::srgb8,
};

/// Edge of an image on screen, points.
const EDGE: f32 = 132.0;

/// Shows the images, then the curves; those with samples on their axis are shown with the volumes.
pub fn show(ui: &mut Ui, inspection: &InspectionScene) {
    ui.horizontal_wrapped(|ui| inspection.images.iter().for_each(|image| picture(ui, image)));
    for (number, curve) in inspection.curves.iter().enumerate().filter(|(_, c)| !is_histogram(c)) {
        line(ui, number, curve);
    }
}

/// Whether a curve counts samples.
pub fn is_histogram(curve: &Curve) -> bool {
    curve.axes[1].contains("samples")
}

/// An image of values from 0 to 1, every pixel a square.
fn picture(ui: &mut Ui, image: &NamedImage) {
    ui.vertical(|ui| {
        ui.label(RichText::new(&image.name).small());
        let (response, painter) = ui.allocate_painter(Vec2::splat(EDGE), Sense::hover());
        let (low, size) = (response.rect.min, EDGE / image.image.width.max(image.image.height) as f32);
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

fn line(ui: &mut Ui, number: usize, curve: &Curve) {
    let [x, y] = &curve.axes;
    let points: PlotPoints<'_> =
        curve.points.iter().map(|p| [f64::from(p.x), f64::from(p.y)]).collect::<Vec<_>>().into();
    ui.label(RichText::new(&curve.name).small());
    let colour = crate::theme::accent(ui.visuals());
    let mut plot = Plot::new(("beside", number))
        .height(110.0)
        .x_axis_label(x.as_str())
        .y_axis_label(y.as_str())
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false);
    if curve.radial {
        plot = plot.data_aspect(1.0);
    }
    plot.show(ui, |plot| plot.line(Line::new(&curve.name, points).color(colour)));
}
