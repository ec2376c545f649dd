//! The sphere inspector: the radiance and irradiance spheres at one point, turned, plotted, unfolded, in numbers.

use super::{
    Probe, legend,
    radial_plot::{self, Curves, Plane},
    sphere_image::{ImageSlot, SphereValues, key},
    sphere_numbers::SphereNumbers,
    sphere_pair::{self, Ball, Turn},
    unfolded, value_table,
};
use crate::{command::Command, session::View};
use egui::Ui;
use glam::Vec3;
use lumenscope_core::{
    inspection::Legend,
    irradiance_volume::probe::Quantity,
    math::{
        colour::luminance, colour::srgb8, false_colour::FalseColour, part::Part, sphere_map::DirectionBins,
    },
    superposition::composite::{Display, ToneCurve},
};
use std::f32::consts::FRAC_1_PI;

/// Rows of bins a hemisphere that the thesis uses.
const ROWS: [u32; 5] = [9, 17, 29, 41, 49];

const RADIANCE: &str =
    "Radiance that arrives at the point from each direction, L(ω), cd/m² (lm per m² and sr)";
const IRRADIANCE: &str =
    "Irradiance of a small plane facing each direction n: E(n) = ∫ L(ω) max(0, n·ω) dω, lx";

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tab {
    #[default]
    Plots,
    Unfolded,
    Numbers,
}

/// What the inspector remembers between frames; nothing a session would save.
#[derive(Clone, Default)]
struct Memory {
    turn: Turn,
    tab: Tab,
    curves: Curves,
    irradiance: bool,
    smooth: bool,
    false_colour: bool,
    balls: [ImageSlot; 2],
    squares: [ImageSlot; 2],
}

/// Shows the open spheres; `None` invites to click a point.
pub fn show(ui: &mut Ui, probe: Option<&Probe>, view: &View) -> Vec<Command> {
    let Some(probe) = probe else {
        empty(ui);
        return Vec::new();
    };
    let id = egui::Id::unique("sphere inspector");
    let mut memory: Memory = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let mut wanted = view.clone();
    controls(ui, &mut memory, &mut wanted);
    let Some(light) = Light::new(probe, view.probe_part) else {
        ui.label("Waiting for the spheres of this point.");
        return commands(view, wanted);
    };
    let shades = Shades::new(&light, memory.false_colour);
    ui.separator();
    let room = ui.available_width();
    if room > 620.0 {
        ui.horizontal_top(|ui| {
            balls(ui, &mut memory, &light, &shades, view, 168.0);
            ui.separator();
            ui.vertical(|ui| tabs(ui, &mut memory, &light, &shades));
        });
    } else {
        let size = (0.5 * (room - 12.0)).clamp(90.0, 190.0);
        balls(ui, &mut memory, &light, &shades, view, size);
        ui.separator();
        tabs(ui, &mut memory, &light, &shades);
    }
    ui.data_mut(|d| d.insert_temp(id, memory));
    commands(view, wanted)
}

fn commands(view: &View, wanted: View) -> Vec<Command> {
    if *view == wanted { Vec::new() } else { vec![Command::View(Box::new(wanted))] }
}

fn empty(ui: &mut Ui) {
    ui.vertical_centered(|ui| {
        ui.add_space((0.35 * ui.available_height()).clamp(8.0, 120.0));
        ui.label(egui::RichText::new("Click a point in the scene.").size(15.0));
        ui.label(
            egui::RichText::new(
                "Its radiance and irradiance spheres open here: the light that reaches it, by direction.",
            )
            .weak(),
        );
    });
}

fn controls(ui: &mut Ui, memory: &mut Memory, view: &mut View) {
    ui.horizontal_wrapped(|ui| {
        if let Some((p, _)) = view.probe {
            ui.label(egui::RichText::new(format!("({}) m", super::number::point(p))).monospace())
                .on_hover_text("Where the spheres are");
        }
        for (part, name, meaning) in [
            (Part::All, "All", "Direct and indirect light"),
            (Part::Direct, "Direct", "Straight from the emitters"),
            (Part::Indirect, "Indirect", "After at least one bounce"),
        ] {
            ui.selectable_value(&mut view.probe_part, part, name).on_hover_text(meaning);
        }
        ui.separator();
        ui.horizontal(|ui| bins(ui, &mut view.probe_bins_n));
        ui.separator();
        ui.checkbox(&mut memory.smooth, "Smooth")
            .on_hover_text("Interpolate between bins instead of showing each");
        ui.checkbox(&mut memory.false_colour, "False colour")
            .on_hover_text("Luminance by palette, with a legend");
        if memory.turn != Turn::default()
            && ui.button("Align").on_hover_text("See the spheres from the viewport's side again").clicked()
        {
            memory.turn = Turn::default();
        }
    });
}

fn bins(ui: &mut Ui, n: &mut u32) {
    let mut index = ROWS.iter().position(|r| *r >= *n).unwrap_or(ROWS.len() - 1);
    let before = index;
    ui.spacing_mut().slider_width = 70.0;
    let slider = egui::Slider::new(&mut index, 0..=ROWS.len() - 1).show_value(false);
    ui.add(slider).on_hover_text("Bins a sphere: 2n², all of one solid angle");
    if index != before {
        *n = ROWS[index];
    }
    ui.label(format!("n = {n}, {} bins", 2 * *n * *n));
}

fn balls(ui: &mut Ui, memory: &mut Memory, light: &Light, shades: &Shades, view: &View, size: f32) {
    ui.vertical(|ui| {
        sphere_pair::show(
            ui,
            &mut memory.balls,
            &mut memory.turn,
            sphere_pair::Look {
                camera: &view.camera,
                normal: view.probe.map(|p| p.1),
                size,
                smooth: memory.smooth,
                picture_key: light.key ^ key(memory.false_colour),
            },
            [
                Ball {
                    title: "Radiance L",
                    meaning: RADIANCE,
                    values: light.radiance(),
                    unit: "cd/m²",
                    colour: &|v| shades.radiance(v),
                },
                Ball {
                    title: "Irradiance E",
                    meaning: IRRADIANCE,
                    values: light.irradiance(),
                    unit: "lx",
                    colour: &|v| shades.irradiance(v),
                },
            ],
        );
        if let Some([radiance, irradiance]) = &shades.palettes {
            ui.horizontal(|ui| {
                for (colours, quantity, unit) in [(radiance, "L", "cd/m²"), (irradiance, "E", "lx")] {
                    ui.allocate_ui(egui::vec2(size, 48.0), |ui| {
                        let range = [colours.low, colours.high];
                        let legend = Legend { quantity: quantity.into(), unit: unit.into(), range };
                        legend::show_flat(ui, &legend, colours);
                    });
                }
            });
        } else {
            ui.label(
                egui::RichText::new("Both exposed alike; E as a white surface would show it (E/π).")
                    .small()
                    .weak(),
            );
        }
    });
}

fn tabs(ui: &mut Ui, memory: &mut Memory, light: &Light, shades: &Shades) {
    ui.horizontal_wrapped(|ui| {
        for (tab, name) in
            [(Tab::Plots, "Radial plots"), (Tab::Unfolded, "Unfolded"), (Tab::Numbers, "Numbers")]
        {
            ui.selectable_value(&mut memory.tab, tab, name);
        }
        if memory.tab != Tab::Numbers {
            ui.separator();
            ui.selectable_value(&mut memory.irradiance, false, "L").on_hover_text(RADIANCE);
            ui.selectable_value(&mut memory.irradiance, true, "E").on_hover_text(IRRADIANCE);
        }
        if memory.tab == Tab::Plots {
            ui.separator();
            ui.selectable_value(&mut memory.curves, Curves::Luminous, "Luminous");
            ui.selectable_value(&mut memory.curves, Curves::Channels, "R G B");
        }
    });
    let (values, unit) =
        if memory.irradiance { (light.irradiance(), "lx") } else { (light.radiance(), "cd/m²") };
    match memory.tab {
        Tab::Plots => {
            let gap = ui.spacing().item_spacing.x;
            let size = ((ui.available_width() - 2.0 * gap) / 3.0).clamp(120.0, 240.0);
            ui.horizontal_wrapped(|ui| {
                for plane in Plane::ALL {
                    let id = format!("radial {plane:?}");
                    let look = radial_plot::Look { size, curves: memory.curves, smooth: memory.smooth, unit };
                    radial_plot::show(ui, &id, &values, plane, look);
                }
            });
        }
        Tab::Unfolded => {
            let size = (0.5 * (ui.available_width() - 12.0)).clamp(80.0, 240.0);
            let picture_key = light.key ^ key((memory.irradiance, memory.false_colour, "square"));
            let colour: &dyn Fn(Vec3) -> [u8; 3] =
                if memory.irradiance { &|v| shades.irradiance(v) } else { &|v| shades.radiance(v) };
            unfolded::show(ui, &mut memory.squares, size, &values, picture_key, colour, unit);
        }
        Tab::Numbers => {
            value_table::show(ui, "sphere numbers", &SphereNumbers::new(&light.irradiance()).rows());
        }
    }
}

/// One part of a probe's light.
struct Light {
    bins: DirectionBins,
    radiance: Vec<Vec3>,
    irradiance: Vec<Vec3>,
    key: u64,
}

impl Light {
    fn new(probe: &Probe, part: Part) -> Option<Self> {
        let bins = probe.bins;
        let radiance = probe.values(Quantity::Radiance, part);
        let irradiance = probe.values(Quantity::Irradiance, part);
        if radiance.len() != bins.len() || irradiance.len() != bins.len() {
            return None;
        }
        let bits: Vec<[u32; 3]> =
            radiance.iter().chain(&irradiance).map(|v| v.to_array().map(f32::to_bits)).collect();
        Some(Self { bins, radiance, irradiance, key: key((bins.n(), bits)) })
    }

    fn radiance(&self) -> SphereValues<'_> {
        SphereValues { bins: self.bins, values: &self.radiance }
    }

    fn irradiance(&self) -> SphereValues<'_> {
        SphereValues { bins: self.bins, values: &self.irradiance }
    }
}

/// How values become colours.
struct Shades {
    display: Display,
    palettes: Option<[FalseColour; 2]>,
}

impl Shades {
    fn new(light: &Light, false_colour: bool) -> Self {
        let largest = |values: &[Vec3]| values.iter().map(|v| luminance(*v)).fold(0.0f32, f32::max).max(1e-6);
        let white = largest(&light.irradiance) * FRAC_1_PI * 1.6;
        let display = Display { ev100: (white / 1.2).log2(), tone: ToneCurve::Filmic, false_colour: None };
        let palette = |high: f32| FalseColour {
            palette: Default::default(),
            low: 0.0,
            high: if high > 0.0 { high } else { 1.0 },
            logarithmic: false,
        };
        let mut sorted: Vec<f32> = light.radiance.iter().map(|v| luminance(*v)).collect();
        sorted.sort_by(f32::total_cmp);
        // The lamps' own radiance is far above everything else: let them run off the end.
        let most = sorted.get(sorted.len() * 97 / 100).copied().unwrap_or(0.0) * 1.25;
        let high = if most > 0.0 { most } else { largest(&light.radiance) };
        let palettes = false_colour.then(|| [palette(high), palette(largest(&light.irradiance))]);
        Self { display, palettes }
    }

    fn radiance(&self, value: Vec3) -> [u8; 3] {
        match &self.palettes {
            Some([palette, _]) => srgb8(palette.colour(luminance(value))),
            None => self.exposed(value),
        }
    }

    fn irradiance(&self, value: Vec3) -> [u8; 3] {
        match &self.palettes {
            Some([_, palette]) => srgb8(palette.colour(luminance(value))),
            None => self.exposed(value * FRAC_1_PI),
        }
    }

    fn exposed(&self, radiance: Vec3) -> [u8; 3] {
        let [r, g, b, _] = self.display.pixel(radiance);
        [r, g, b]
    }
}
