//! The texture of the surface that was clicked, at its three stages, beside what the path tracer says.

use super::{edit_view, named, number, section};
use crate::{
    command::Command,
    grid_view::{GridView, Traced},
    session::Session,
    widgets::{
        field::{Field, bulk},
        legend,
    },
};
use egui::{ComboBox, Grid, RichText, Slider, Ui};
use glam::{Vec2, Vec3};
use lumenscope_core::{
    inspection::Legend,
    math::{
        colour::luminance,
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    measure::{
        grid_texture::{Conversion, GridReference, Kind, Prefilter, Stage, StageSettings},
        image::second_difference,
    },
    radiosity::texture::{display::Filter, prefilter::WIDEST},
};
use std::{fmt::Write as _, sync::Arc};

/// Pixels along the longer edge of a stage's picture.
const PIXELS: f32 = 192.0;

/// The names of the stages.
pub const NAMES: [&str; 3] = ["1 stored", "2 Hermite", "3 prefiltered"];

/// What the panel keeps between frames: the images of what it shows.
#[derive(Default)]
pub struct State {
    of: Option<Arc<GridView>>,
    stages: Vec<Field>,
    differences: Vec<Field>,
    bends: Vec<Field>,
    reference: Option<Field>,
    light: Option<FalseColour>,
    difference: Option<FalseColour>,
    bend: Option<FalseColour>,
}

/// Shows the stages, how they are made, and their numbers.
pub fn show(ui: &mut Ui, state: &mut State, session: &Session, out: &mut Vec<Command>) {
    let view = &session.document.view;
    if view.surface.is_none() {
        ui.weak(
            "Click a surface to see the texture of its light: as the solver stores it, as a smooth function \
                 resamples it, and as a prefilter and a lookup show it.",
        );
        return;
    }
    edit_view(view, out, |view| {
        let hint = format!(
            "Irradiance of the surface by the path tracer, at the middles of equal cells: what every stage should be. \
             {} paths a point, in the background.",
            GridReference::PATHS * GridReference::ENOUGH
        );
        ui.checkbox(&mut view.traced_texture, "Compare with the path tracer").on_hover_text(hint);
    });
    let Some(shown) = &session.texture else {
        if session.texture_awaited {
            ui.weak("The texture is being made…");
            return;
        }
        ui.weak("This surface has no texture: it is curved and neither a ball nor the side of a cylinder, or small and lit at its corners, or longer than 2,048 nodes.");
        return;
    };
    if state.of.as_ref().is_none_or(|of| !Arc::ptr_eq(of, shown)) {
        state.draw(shown);
    }
    let grid = &shown.grid;
    ui.add_space(4.0);
    ui.label(RichText::new(format!(
        "{}: {} × {} nodes over {:.2} × {:.2} m",
        match grid.kind() {
            Kind::Grid => format!("Grid {}", grid.chart),
            Kind::Triangle => format!("Triangle of grid {}", grid.chart),
            Kind::Ball => "Ball by longitude and latitude".into(),
            Kind::Tube => "Side of a cylinder by angle and height".into(),
        },
        grid.nodes[0],
        grid.nodes[1],
        grid.size_m.x,
        grid.size_m.y
    )));
    if let Some([taken, full]) = grid.samples() {
        ui.label(RichText::new(format!("{taken} samples of {full}")).small()).on_hover_text(
            "What the quadtrees of this surface took of the light that the solver keeps, finer where it bends, and what \
             full ones would",
        );
    }
    let aspect = grid.size_m.y / grid.size_m.x.max(1e-6);
    let width = ((ui.available_width() - 16.0) / 3.0).clamp(40.0, 240.0);
    let mut pointed = None;
    ui.horizontal_top(|ui| {
        for (i, field) in state.stages.iter_mut().enumerate() {
            pointed = field.show(ui, width, aspect).map(|at| (i, at)).or(pointed);
        }
    });
    bar(ui, "irradiance", state.light);
    numbers(ui, shown);
    if shown.reference.is_some() {
        ui.horizontal_top(|ui| {
            for field in &mut state.differences {
                field.show(ui, width, aspect);
            }
        });
        bar(ui, "difference to the path tracer", state.difference);
    }
    ui.horizontal_top(|ui| {
        for field in &mut state.bends {
            field.show(ui, width, aspect);
        }
    });
    bar(ui, "second difference, Mach bands", state.bend);
    ui.weak(match pointed {
        None => "Point at a stage to read it.".to_owned(),
        Some((stage, [x, y])) => {
            let Stage { texture, filter } = &shown.stages[stage];
            let value = number(luminance(texture.sample(Vec2::new(x, y), *filter)));
            let at = Vec2::new(x, y) * grid.size_m;
            format!(
                "stage {}: {value} lx, {:.2} m from the left, {:.2} m from the top",
                stage + 1,
                at.x,
                at.y
            )
        }
    });
    if ui.button("Copy the stages' numbers").on_hover_text("Copies the table, tab-separated").clicked() {
        ui.ctx().copy_text(text(shown));
    }
    edit_view(view, out, |view| section(ui, "Stages", |ui| settings(ui, &mut view.stages)));
    if let Some(traced) = &shown.reference {
        ui.horizontal_top(|ui| {
            if let Some(field) = &mut state.reference {
                field.show(ui, width, aspect);
            }
            ui.vertical(|ui| {
                ui.label(format!("{} paths a point", traced.paths));
                ui.label(format!("{:.1} % noise", 100.0 * traced.noise)).on_hover_text(
                    "Median standard error of the reference over max(E, 5 % of its mean): errors of the stages \
                     below it cannot be told from noise.",
                );
                ui.label(format!("{} × {} points", grid.points[0], grid.points[1]));
            });
        });
    }
}

fn settings(ui: &mut Ui, settings: &mut StageSettings) {
    let lookup = |ui: &mut Ui, value: &mut Filter, choices: [(Filter, &str); 2]| {
        ui.horizontal(|ui| {
            for (filter, name) in choices {
                ui.selectable_value(value, filter, name);
            }
        });
    };
    Grid::new("stages").num_columns(2).spacing([10.0, 4.0]).show(ui, |ui| {
        ui.label("1 texels").on_hover_text(
            "Nodes: as the solver has them. Zero order: one texel a leaf, the mean of its corners. First order: at each \
             corner the mean of the leaves around it",
        );
        ui.horizontal(|ui| {
            for (conversion, name) in [
                (Conversion::Nodes, "nodes"),
                (Conversion::ZeroOrder, "zero order"),
                (Conversion::FirstOrder, "first order"),
            ] {
                ui.selectable_value(&mut settings.conversion, conversion, name);
            }
        });
        ui.end_row();
        ui.label("1 lookup").on_hover_text("The nodes of the surface's grid as the solver has them, and their lookup");
        lookup(ui, &mut settings.stored, [(Filter::Nearest, "nearest"), (Filter::Bilinear, "bilinear")]);
        ui.end_row();
        ui.label("2 texels").on_hover_text(
            "The C¹ function of bicubic Hermite patches through the nodes, and how many texels of it are taken from \
             each node to the next",
        );
        ui.spacing_mut().slider_width = 74.0;
        named(ui.add(Slider::new(&mut settings.factor, 1..=4).suffix("× texels")), "Texels of stage 2");
        ui.end_row();
        ui.label("3 prefilter").on_hover_text(
            "A Gaussian over the texels, of binomial weights, so that bilinear display shows no creases; adaptive: the \
             widest up to 5 × 5 that moves no texel by more than 2 %",
        );
        let name = |prefilter: Prefilter| match prefilter {
            Prefilter::Adaptive => "adaptive".to_owned(),
            Prefilter::Gaussian(1) => "none".to_owned(),
            Prefilter::Gaussian(width) => format!("Gauss {width} × {width}"),
        };
        let list = ComboBox::from_id_salt("prefilter").selected_text(name(settings.prefilter));
        let list = list.show_ui(ui, |ui| {
            for choice in std::iter::once(Prefilter::Adaptive).chain((1..=WIDEST).map(Prefilter::Gaussian)) {
                ui.selectable_value(&mut settings.prefilter, choice, name(choice));
            }
        });
        named(list.response, "Prefilter");
        ui.end_row();
        ui.label("3 lookup").on_hover_text(
            "Bilinear, as graphics cards have it; or the bicubic filter of Mitchell and Netravali with B = C = 1/3",
        );
        // The lookup of stage 1 has a "bilinear" too.
        ui.push_id("display", |ui| {
            let choices = [(Filter::Bilinear, "bilinear"), (Filter::Mitchell, "Mitchell–Netravali")];
            lookup(ui, &mut settings.shown, choices);
        });
        ui.end_row();
    });
}

impl State {
    fn draw(&mut self, shown: &Arc<GridView>) {
        let grid = &shown.grid;
        let scale = PIXELS / grid.size_m.max_element().max(1e-6);
        let size = [grid.size_m.x, grid.size_m.y].map(|m| ((m * scale) as u32).clamp(2, PIXELS as u32));
        let pictures: Vec<_> = shown.stages.iter().map(|s| s.picture(size)).collect();
        let covered = |k: usize| grid.covers(middle(k, size));
        let of_surface = |p: &LinearImage| -> Vec<Vec3> {
            p.pixels.iter().enumerate().filter(|(k, _)| covered(*k)).map(|(_, pixel)| *pixel).collect()
        };
        let high = bulk(pictures.iter().flat_map(of_surface));
        let light = FalseColour { palette: Palette::Viridis, low: 0.0, high, logarithmic: false };
        self.light = Some(light);
        self.stages =
            pictures.iter().zip(NAMES).map(|(p, name)| Field::new(name, p, &light, covered)).collect();
        let bends: Vec<_> = pictures.iter().map(second_difference).collect();
        let most = bulk(bends.iter().flat_map(of_surface).filter(|p| p.x != 0.0));
        let colours = FalseColour::over([-most, most], Palette::Diverging);
        self.bend = Some(colours);
        let bands = |(i, bend): (usize, &LinearImage)| {
            let value = |k: usize| covered(k).then(|| luminance(bend.pixels[k]));
            Field::signed(format!("stage {}, bands", i + 1), size, &colours, value)
        };
        self.bends = bends.iter().enumerate().map(bands).collect();
        (self.differences, self.reference) = (Vec::new(), None);
        if let Some(traced) = &shown.reference {
            let known = |i: usize| grid.is_judged(i);
            let at_points: Vec<_> = shown.stages.iter().map(|s| grid.at_points(s)).collect();
            let off = |s: usize, i: usize| at_points[s].pixels[i] - traced.image.pixels[i];
            let all = (0..3).flat_map(|s| (0..traced.image.pixels.len()).map(move |i| (s, i)));
            let most = bulk(all.filter(|(_, i)| known(*i)).map(|(s, i)| off(s, i)));
            let colours = FalseColour::over([-most, most], Palette::Diverging);
            self.difference = Some(colours);
            let difference = |s: usize| {
                let value = |i: usize| known(i).then(|| luminance(off(s, i)));
                Field::signed(format!("stage {} − path tracer", s + 1), grid.points, &colours, value)
            };
            self.differences = (0..3).map(difference).collect();
            self.reference = Some(Field::new("path tracer", &traced.image, &light, known));
        }
        self.of = Some(shown.clone());
    }
}

/// Where the middle of a pixel lies on the unit square.
pub fn middle(pixel: usize, [width, height]: [u32; 2]) -> Vec2 {
    let at = Vec2::new((pixel as u32 % width) as f32, (pixel as u32 / width) as f32);
    (at + Vec2::splat(0.5)) / Vec2::new(width as f32, height as f32)
}

fn bar(ui: &mut Ui, quantity: &str, colours: Option<FalseColour>) {
    let Some(colours) = colours else { return };
    let range = [colours.low, colours.high];
    let shown = Legend { quantity: quantity.into(), unit: "lx".into(), range, names: &[] };
    legend::show_flat(ui, &shown, &colours);
}

/// Columns of the numbers, and what they mean.
const COLUMNS: [(&str, &str); 5] = [
    ("texels", "Texels of the texture"),
    ("bytes", "Bytes they take, three channels in single precision"),
    ("relMSE", "Mean of (E − E_ref)² / (E_ref² + ε) over the points judged"),
    ("perceptual", "Difference of lightness, each frequency weighted by the eye's sensitivity to contrast"),
    ("worst, lx", "Largest difference of illuminance, E − E_ref"),
];

fn row(shown: &GridView, stage: usize) -> [String; 5] {
    let error = shown.reference.as_ref().and_then(|r: &Traced| r.errors[stage]);
    let [rel_mse, perceptual, worst] = match error {
        Some(e) => {
            [format!("{:.5}", e.rel_mse), format!("{:.5}", e.perceptual), format!("{:+.1}", e.largest_lx)]
        }
        None => ["–".to_owned(), "–".to_owned(), "–".to_owned()],
    };
    let stage = &shown.stages[stage];
    [stage.texels().to_string(), stage.bytes().to_string(), rel_mse, perceptual, worst]
}

fn numbers(ui: &mut Ui, shown: &GridView) {
    let rows = [0, 1, 2].map(|stage| row(shown, stage));
    Grid::new("stage numbers").num_columns(4).striped(true).spacing([14.0, 2.0]).show(ui, |ui| {
        ui.label("");
        for name in NAMES {
            ui.label(RichText::new(name).small());
        }
        ui.end_row();
        for (i, (name, meaning)) in COLUMNS.into_iter().enumerate() {
            ui.label(RichText::new(name).small()).on_hover_text(meaning);
            for row in &rows {
                ui.label(RichText::new(&row[i]).small().monospace());
            }
            ui.end_row();
        }
    });
}

/// The numbers, tab-separated.
pub fn text(shown: &GridView) -> String {
    let mut text = format!("stage\t{}\n", COLUMNS.map(|c| c.0).join("\t"));
    for (i, name) in NAMES.into_iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name}\t{}", row(shown, i).join("\t"));
    }
    text
}
