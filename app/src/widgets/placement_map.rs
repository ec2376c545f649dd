//! A measurement seen from above: false colour, lines of equal illuminance, numbers on a grid.

use super::{legend, number};
use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};
use lumenscope_core::{
    inspection::Legend,
    irradiance_volume::placement::{
        Measurement,
        inspect::{Field, levels},
        requirement::Requirement,
    },
    math::{colour::srgb8, false_colour::FalseColour},
};

/// Tallest map, points.
const TALLEST: f32 = 190.0;
/// Width that a number takes, points.
const NUMBER_WIDTH: f32 = 30.0;

/// Palette from the smallest to the largest value measured.
pub fn colours(measured: &Measurement) -> FalseColour {
    let [low, high] = measured.statistics().map_or([0.0, 1.0], |s| [s.min_lx, s.max_lx]);
    FalseColour { palette: Default::default(), low, high: high.max(low * 1.001 + 1e-6), logarithmic: false }
}

/// Shows the map with its legend; the first edge runs to the right, the second up.
pub fn show(ui: &mut Ui, measured: &Measurement, wanted: &Requirement) {
    let grid = &measured.grid;
    let aspect = (grid.edge_v.length() / grid.edge_u.length()).clamp(0.05, 20.0);
    let width = ui.available_width().min(TALLEST / aspect).max(40.0);
    let (rect, response) = ui.allocate_exact_size(vec2(width, width * aspect), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "illuminance map"));
    let field = Field::new(measured);
    let colours = colours(measured);
    let place = |[x, y]: [f32; 2]| -> Pos2 {
        let share = |x: f32, n: u32| ((x - 0.5) / n as f32).clamp(0.0, 1.0);
        pos2(
            rect.left() + share(x, grid.nx) * rect.width(),
            rect.bottom() - share(y, grid.ny) * rect.height(),
        )
    };
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    painter.add(surface(&field, &colours, place));
    for level in levels(measured, wanted) {
        let red = wanted.mean_lx == Some(level);
        let stroke = if red {
            Stroke::new(2.0, Color32::from_rgb(225, 50, 40))
        } else {
            Stroke::new(1.0, Color32::from_black_alpha(200))
        };
        for contour in field.contours(level) {
            let mut points: Vec<Pos2> = contour.points.iter().map(|p| place(*p)).collect();
            if contour.closed {
                points.extend(points.first().copied());
            }
            painter.add(Shape::line(points, stroke));
        }
    }
    numbers(&painter, rect, measured, &colours);
    if let Some(at) = response.hover_pos() {
        let share = (at - rect.min) / rect.size();
        let (i, j) = ((share.x * grid.nx as f32) as u32, ((1.0 - share.y) * grid.ny as f32) as u32);
        let cell = (j.min(grid.ny - 1) * grid.nx + i.min(grid.nx - 1)) as usize;
        if let (Some(value), Some(p)) = (measured.values[cell], grid.points[cell]) {
            response.on_hover_text(format!("{} at {} m", number::with_unit(value, "lx"), number::point(p)));
        }
    }
    let shown = Legend {
        quantity: "illuminance".into(),
        unit: "lx".into(),
        range: [colours.low, colours.high],
        names: &[],
    };
    legend::show_flat(ui, &shown, &colours);
}

fn surface(field: &Field, colours: &FalseColour, place: impl Fn([f32; 2]) -> Pos2) -> Shape {
    let mut mesh = egui::Mesh::default();
    for row in 0..field.height {
        for column in 0..field.width {
            let value = field.values[row * field.width + column].unwrap_or(0.0);
            let [r, g, b] = srgb8(colours.colour(value));
            mesh.colored_vertex(place([column as f32, row as f32]), Color32::from_rgb(r, g, b));
        }
    }
    field.triangles().for_each(|[a, b, c]| mesh.add_triangle(a, b, c));
    Shape::mesh(mesh)
}

fn numbers(painter: &egui::Painter, rect: Rect, measured: &Measurement, colours: &FalseColour) {
    let grid = &measured.grid;
    let most = [rect.width() / NUMBER_WIDTH, rect.height() / 16.0].map(|n| (n as u32).max(1));
    let [every_u, every_v] = [grid.nx.div_ceil(most[0]), grid.ny.div_ceil(most[1])];
    for j in (every_v / 2..grid.ny).step_by(every_v as usize) {
        for i in (every_u / 2..grid.nx).step_by(every_u as usize) {
            let Some(value) = measured.values[(j * grid.nx + i) as usize] else { continue };
            let at = pos2(
                rect.left() + (i as f32 + 0.5) / grid.nx as f32 * rect.width(),
                rect.bottom() - (j as f32 + 0.5) / grid.ny as f32 * rect.height(),
            );
            let dark = colours.position(value) > 0.6;
            let ink = if dark { Color32::from_gray(10) } else { Color32::from_gray(240) };
            painter.text(at, Align2::CENTER_CENTER, format!("{value:.0}"), FontId::proportional(10.0), ink);
        }
    }
}
