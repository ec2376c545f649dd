//! Layers: the terms of the picture, how they are weighted, and how the sum is brought to the display.

use super::{edit_view, named, section};
use crate::{
    command::Command,
    light_paths::LightPaths,
    session::{Session, View},
};
use egui::{Checkbox, ComboBox, DragValue, Grid, Slider, TextEdit, Ui};
use lumenscope_core::{
    irradiance_volume::{dynamic_object::Detail, moments::Order},
    math::false_colour::{FalseColour, Palette},
    superposition::{
        composite::{DirectQuality, ToneCurve},
        layers::{COUNT, Layer},
    },
};

/// Shows the layers and the display.
pub fn show(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    edit_view(&session.document.view, out, |view| {
        layers(ui, view);
        section(ui, "Light paths", |ui| paths(ui, &session.light_paths, view));
        section(ui, "Display", |ui| display(ui, view));
        section(ui, "Movable objects", |ui| {
            gloss(ui, session, view);
            detail(ui, view);
        });
    });
}

/// Name on screen, and the layer's equation.
fn explain(layer: Layer) -> (&'static str, &'static str) {
    match layer {
        Layer::Emitted => {
            ("Emitted", "Light that emitters send straight to the eye.\n\nL = L_e(x, ω), cd/m²")
        }
        Layer::Direct => (
            "Direct",
            "Light that reached the surface straight from the emitters.\n\n\
             L = ρ/π · E_d,  E_d = ∫ L_e(y) cos θ cos θ' V / r² dA, cd/m²",
        ),
        Layer::Indirect => (
            "Indirect",
            "Light that reached the surface after at least one bounce.\n\n\
             L = ρ/π · E_i,  E_i from radiosity, or for moving objects from the irradiance volume, cd/m²",
        ),
        Layer::Mirror => (
            "Mirror",
            "Light of any kind that planar mirrors show, by the Fresnel equation.\n\n\
             L = F(θ) L_i(x, mirrored ω), cd/m²",
        ),
        Layer::Glossy => (
            "Glossy",
            "Light of any kind that polished surfaces scatter about the mirrored direction.\n\n\
             L = ∫ f(ω, ω') L_i(ω') cos θ' dω', cd/m²",
        ),
    }
}

fn layers(ui: &mut Ui, view: &mut View) {
    ui.spacing_mut().slider_width = 74.0;
    Grid::new("layers").num_columns(3).spacing([6.0, 4.0]).show(ui, |ui| {
        for layer in Layer::ALL {
            let index = layer as usize;
            let (name, equation) = explain(layer);
            let mut on = view.weights[index] != 0.0;
            if ui.add(Checkbox::new(&mut on, name)).on_hover_text(equation).changed() {
                view.weights[index] = f32::from(on);
            }
            let solo = is_solo(view, layer);
            let hint = format!("Show this layer alone, again for all ({})", index + 1);
            let button = ui.selectable_label(solo, "solo").on_hover_text(hint);
            let button = named(button, &format!("Solo {name}"));
            if button.clicked() {
                toggle_solo(view, layer);
            }
            let slider = Slider::new(&mut view.weights[index], 0.0..=4.0).max_decimals(2);
            let slider = ui.add(slider).on_hover_text("Weight of the layer in the sum: 1 is the truth");
            named(slider, &format!("Weight of {name}"));
            ui.end_row();
        }
    });
}

/// Expressions to pick, and what they mean.
const PATHS: [(&str, &str); 8] = [
    ("", "all"),
    ("LE", "emitted"),
    ("LDE", "direct"),
    ("L(D|S)+DE", "indirect"),
    ("L(D|S)*SE", "specular"),
    ("LD{2}E", "2 bounces"),
    ("LD{3}E", "3 bounces"),
    ("LS+DE", "caustics"),
];

fn paths(ui: &mut Ui, shown: &LightPaths, view: &mut View) {
    ui.horizontal(|ui| {
        let edit = TextEdit::singleline(&mut view.paths).hint_text("L(D|S)*E").desired_width(120.0);
        let edit = ui.add(edit).on_hover_text(
            "Which light is shown, as a regular expression over its path: L the light, D a diffuse and S a specular \
             reflection, E the eye; | * + ? {n} and ( ) as usual.\n\nLDE, L(D|S)*SE, LE|LD{2}E",
        );
        named(edit, "Expression of light paths");
        let picked = PATHS.iter().find(|p| p.0 == view.paths).map_or("typed", |p| p.1);
        ComboBox::from_id_salt("paths").width(90.0).selected_text(picked).show_ui(ui, |ui| {
            for (text, meaning) in PATHS {
                ui.selectable_value(&mut view.paths, text.to_owned(), meaning).on_hover_text(text);
            }
        });
    });
    match shown {
        LightPaths::All | LightPaths::Some { weights: Some(_), .. } => {}
        LightPaths::Some { weights: None, .. } => {
            ui.weak("No sum of the layers is this light: the reference shows it (R).");
        }
        LightPaths::Unreadable(error) => {
            ui.colored_label(ui.visuals().warn_fg_color, error.to_string());
        }
    }
}

/// Whether one layer is shown alone.
pub fn is_solo(view: &View, layer: Layer) -> bool {
    Layer::ALL.iter().all(|&l| (view.weights[l as usize] != 0.0) == (l == layer))
}

/// Shows one layer alone, or all when it already is.
pub fn toggle_solo(view: &mut View, layer: Layer) {
    view.weights = if is_solo(view, layer) {
        [1.0; COUNT]
    } else {
        std::array::from_fn(|i| f32::from(i == layer as usize))
    };
}

fn display(ui: &mut Ui, view: &mut View) {
    Grid::new("display").num_columns(2).spacing([10.0, 4.0]).show(ui, |ui| {
        let label = ui
            .label("Exposure")
            .on_hover_text("Exposure value at ISO 100: a luminance of 1.2 · 2^EV cd/m² becomes white");
        ui.horizontal(|ui| {
            let drag = DragValue::new(&mut view.display.ev100).speed(0.05).max_decimals(2).prefix("EV ");
            if ui.add(drag.range(-20.0..=30.0)).labelled_by(label.id).changed() {
                view.auto_exposure = false;
            }
            ui.checkbox(&mut view.auto_exposure, "auto").on_hover_text("Follow the mean luminance of the view");
        });
        ui.end_row();

        ui.label("Tone").on_hover_text("From exposed radiance to the display");
        ComboBox::from_id_salt("tone").selected_text(tone_name(view.display.tone)).show_ui(ui, |ui| {
            for tone in [ToneCurve::Filmic, ToneCurve::Linear] {
                ui.selectable_value(&mut view.display.tone, tone, tone_name(tone));
            }
        });
        ui.end_row();

        ui.label("Direct light").on_hover_text(
            "Shadow rays at every pixel and area emitter, or the radiosity elements' own: soft, and as fine as they are",
        );
        let mut rays = match view.direct {
            DirectQuality::Elements => 0,
            DirectQuality::PerPixel(rays) => rays,
        };
        ComboBox::from_id_salt("direct").selected_text(direct_name(rays)).show_ui(ui, |ui| {
            for choice in [0, 1, 4, 16] {
                ui.selectable_value(&mut rays, choice, direct_name(choice));
            }
        });
        view.direct = if rays == 0 { DirectQuality::Elements } else { DirectQuality::PerPixel(rays) };
        ui.end_row();
    });
    false_colour(ui, view);
}

fn gloss(ui: &mut Ui, session: &Session, view: &mut View) {
    let name = |gloss: Option<Order>| match gloss {
        None => "diffuse".to_owned(),
        Some(order) => format!("glossy, order {order}"),
    };
    ComboBox::from_id_salt("gloss")
        .selected_text(name(view.gloss))
        .show_ui(ui, |ui| {
            ui.selectable_value(&mut view.gloss, None, name(None));
            for order in Order::THESIS.into_iter().filter(|o| *o != Order::IRRADIANCE) {
                ui.selectable_value(&mut view.gloss, Some(order), name(Some(order)));
            }
        })
        .response
        .on_hover_text(
            "Diffuse, or lit by the volume's moment of order n towards the mirrored view vector:\n\n\
             H(x, ω) = (n + 1)/2 ∫ L(x, ω') max(0, ω·ω')^n dω', lx",
        );
    let volume = session.solution.as_ref().and_then(|s| s.volume.as_deref());
    if let (Some(order), Some(volume)) = (view.gloss, volume)
        && !volume.orders().contains(&order)
    {
        ui.weak(format!("The volume holds no moment of order {order}: add it under Plan."));
    }
}

fn detail(ui: &mut Ui, view: &mut View) {
    let name = |detail: Option<Detail>| detail.map_or("automatic", Detail::name);
    let list = ComboBox::from_id_salt("detail").selected_text(name(view.detail)).show_ui(ui, |ui| {
        for choice in std::iter::once(None).chain(Detail::ALL.map(Some)) {
            ui.selectable_value(&mut view.detail, choice, name(choice));
        }
    });
    named(list.response, "Level of detail").on_hover_text(
        "Where objects that have moved ask the irradiance volume. Coarse: at a few vertices. Vertices: at each. \
         Fine: inside large triangles too. Pixels: at each pixel of the picture, which the processor then makes. \
         Automatic: coarser while something moves",
    );
}

fn false_colour(ui: &mut Ui, view: &mut View) {
    let mut on = view.display.false_colour.is_some();
    if ui.checkbox(&mut on, "False colour").on_hover_text("Luminance as colour, in cd/m²").changed() {
        let white = 1.2 * view.display.ev100.exp2();
        let (low, high) = (white * 1e-3, white);
        view.display.false_colour =
            on.then_some(FalseColour { palette: Palette::Viridis, low, high, logarithmic: true });
    }
    let Some(colours) = &mut view.display.false_colour else { return };
    ui.horizontal(|ui| {
        ComboBox::from_id_salt("palette").selected_text(format!("{:?}", colours.palette)).show_ui(ui, |ui| {
            for palette in [Palette::Viridis, Palette::Inferno, Palette::Turbo] {
                ui.selectable_value(&mut colours.palette, palette, format!("{palette:?}"));
            }
        });
        ui.checkbox(&mut colours.logarithmic, "logarithmic")
            .on_hover_text("Equal steps along the palette are equal ratios");
    });
    ui.horizontal(|ui| {
        ui.label("From");
        let speed = f64::from(colours.high) * 0.005;
        let low = ui.add(DragValue::new(&mut colours.low).range(0.0..=1e9).speed(speed).max_decimals(3));
        named(low, "Low end of the false colour");
        ui.label("to");
        let high = ui.add(DragValue::new(&mut colours.high).range(1e-6..=1e9).speed(speed).suffix(" cd/m²"));
        named(high, "High end of the false colour");
        colours.high = colours.high.max(colours.low * 1.001 + 1e-6);
    });
}

fn tone_name(tone: ToneCurve) -> &'static str {
    match tone {
        ToneCurve::Linear => "linear, clipped",
        ToneCurve::Filmic => "filmic",
    }
}

fn direct_name(rays: u32) -> String {
    match rays {
        0 => "from elements".into(),
        1 => "1 ray a pixel".into(),
        n => format!("{n} rays a pixel"),
    }
}
