//! Legend of a false colour: a bar, round numbers, the quantity and its unit.

use super::number;
use egui::{
    Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, TextStyle, pos2,
    text::{LayoutJob, TextFormat, TextWrapping},
    vec2,
};
use lumenscope_core::{
    inspection::Legend,
    math::{colour::srgb8, false_colour::FalseColour},
};

/// Size of a legend, points.
const SIZE: egui::Vec2 = egui::vec2(118.0, 230.0);
const BAR: f32 = 14.0;

/// Shows a vertical bar with round ticks; a click copies it as text.
pub fn show(ui: &mut egui::Ui, legend: &Legend, colours: &FalseColour) -> egui::Response {
    let height = SIZE.y.min(ui.available_height().max(120.0));
    let (rect, response) = ui.allocate_exact_size(vec2(SIZE.x, height), Sense::click());
    paint(ui.painter(), rect, legend, colours, ui.visuals());
    finish(response, legend, colours)
}

/// Shows a flat bar as wide as there is room, ticks below.
pub fn show_flat(ui: &mut egui::Ui, legend: &Legend, colours: &FalseColour) -> egui::Response {
    let width = ui.available_width().clamp(120.0, 420.0);
    let (rect, response) = ui.allocate_exact_size(vec2(width, 46.0), Sense::click());
    let visuals = ui.visuals();
    let font = TextStyle::Small.resolve(ui.style());
    let bar = Rect::from_min_max(rect.min + vec2(8.0, 15.0), pos2(rect.max.x - 8.0, rect.min.y + 15.0 + BAR));
    let painter = ui.painter();
    let unit = if legend.unit.is_empty() { String::new() } else { format!(" in {}", legend.unit) };
    title(painter, rect.min + vec2(8.0, 0.0), &legend.quantity, &unit, &font, f32::INFINITY, visuals);
    gradient(painter, bar, colours, false);
    painter.rect_stroke(bar, 1.0, outline(visuals), egui::StrokeKind::Outside);
    let mut free = f32::NEG_INFINITY;
    for value in colours.ticks(5) {
        let x = bar.min.x + colours.position(value) * bar.width();
        painter.vline(x, bar.max.y..=bar.max.y + 3.0, outline(visuals));
        let galley = painter.layout_no_wrap(number::tick(value), font.clone(), visuals.text_color());
        let left = (x - 0.5 * galley.size().x).clamp(rect.min.x, rect.max.x - galley.size().x);
        if left > free {
            free = left + galley.size().x + 4.0;
            painter.galley(pos2(left, bar.max.y + 3.0), galley, visuals.text_color());
        }
    }
    finish(response, legend, colours)
}

/// Paints a vertical legend into a rectangle, for use over a picture.
pub fn paint(
    painter: &egui::Painter,
    rect: Rect,
    legend: &Legend,
    colours: &FalseColour,
    visuals: &egui::Visuals,
) {
    let font = FontId::proportional(11.0);
    let text = visuals.text_color();
    painter.rect_filled(rect, 5.0, visuals.panel_fill.gamma_multiply(0.88));
    let unit = if legend.unit.is_empty() { String::new() } else { format!("\nin {}", legend.unit) };
    let top =
        title(painter, rect.min + vec2(8.0, 6.0), &legend.quantity, &unit, &font, SIZE.x - 14.0, visuals);
    if !legend.names.is_empty() {
        return kinds(painter, pos2(rect.min.x + 10.0, top + 6.0), legend, colours, text);
    }
    let bar = Rect::from_min_max(
        pos2(rect.min.x + 10.0, top + 8.0),
        pos2(rect.min.x + 10.0 + BAR, rect.max.y - 12.0),
    );
    gradient(painter, bar, colours, true);
    painter.rect_stroke(bar, 1.0, outline(visuals), egui::StrokeKind::Outside);
    for value in colours.ticks(6) {
        let y = bar.max.y - colours.position(value) * bar.height();
        painter.hline(bar.max.x..=bar.max.x + 4.0, y, outline(visuals));
        painter.text(pos2(bar.max.x + 8.0, y), Align2::LEFT_CENTER, number::tick(value), font.clone(), text);
    }
}

/// A patch of colour and a name for each kind.
fn kinds(painter: &egui::Painter, at: Pos2, legend: &Legend, colours: &FalseColour, ink: Color32) {
    for (i, name) in legend.names.iter().enumerate() {
        let [r, g, b] = srgb8(colours.colour(i as f32));
        let patch = Rect::from_min_size(at + vec2(0.0, 18.0 * i as f32), vec2(BAR, 12.0));
        painter.rect_filled(patch, 2.0, Color32::from_rgb(r, g, b));
        let font = FontId::proportional(11.0);
        painter.text(patch.right_center() + vec2(8.0, 0.0), Align2::LEFT_CENTER, *name, font, ink);
    }
}

/// Size that [`paint`] wants, points.
pub fn size(legend: &Legend) -> egui::Vec2 {
    match legend.names.len() {
        0 => SIZE,
        // Room for two lines of title.
        kinds => vec2(SIZE.x, 46.0 + 18.0 * kinds as f32),
    }
}

/// Quantity and, fainter, its unit, in lines no longer than `width`; where they end.
fn title(
    painter: &egui::Painter,
    at: Pos2,
    quantity: &str,
    unit: &str,
    font: &FontId,
    width: f32,
    visuals: &egui::Visuals,
) -> f32 {
    let ink = visuals.text_color();
    let mut job = LayoutJob { wrap: TextWrapping::wrap_at_width(width), ..LayoutJob::default() };
    job.append(quantity, 0.0, TextFormat::simple(font.clone(), ink));
    job.append(unit, 0.0, TextFormat::simple(font.clone(), ink.gamma_multiply(0.75)));
    let galley = painter.layout_job(job);
    let end = at.y + galley.size().y;
    painter.galley(at, galley, ink);
    end
}

fn outline(visuals: &egui::Visuals) -> Stroke {
    Stroke::new(1.0, visuals.text_color().gamma_multiply(0.6))
}

/// Fills a bar with the palette, low end at the left or at the bottom.
fn gradient(painter: &egui::Painter, bar: Rect, colours: &FalseColour, upright: bool) {
    let mut mesh = egui::Mesh::default();
    const STEPS: u32 = 64;
    for i in 0..=STEPS {
        let t = i as f32 / STEPS as f32;
        let [r, g, b] = srgb8(colours.palette.colour(t));
        let colour = Color32::from_rgb(r, g, b);
        let ends = if upright {
            let y = egui::lerp(bar.max.y..=bar.min.y, t);
            [pos2(bar.min.x, y), pos2(bar.max.x, y)]
        } else {
            let x = egui::lerp(bar.min.x..=bar.max.x, t);
            [pos2(x, bar.min.y), pos2(x, bar.max.y)]
        };
        for end in ends {
            mesh.colored_vertex(end, colour);
        }
        if i > 0 {
            let k = 2 * i;
            mesh.add_triangle(k - 2, k - 1, k);
            mesh.add_triangle(k - 1, k, k + 1);
        }
    }
    painter.add(egui::Shape::mesh(mesh));
}

fn finish(response: egui::Response, legend: &Legend, colours: &FalseColour) -> egui::Response {
    let scale = if colours.logarithmic { "logarithmic" } else { "linear" };
    let names =
        if legend.names.is_empty() { String::new() } else { format!(": {}", legend.names.join(", ")) };
    let line = format!(
        "{}{names} from {} to {} {unit}, {scale} scale; found {} to {} {unit}",
        legend.quantity,
        number::short(colours.low),
        number::short(colours.high),
        number::short(legend.range[0]),
        number::short(legend.range[1]),
        unit = legend.unit,
    );
    if response.clicked() {
        response.ctx.copy_text(line.clone());
    }
    response.on_hover_text(format!("{line}\nClick to copy."))
}
