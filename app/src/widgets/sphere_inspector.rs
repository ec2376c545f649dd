//! The sphere inspector: the radiance and irradiance spheres at one point, turned, plotted, unfolded, in numbers.

use super::{
    Probe, legend, moments,
    radial_plot::{self, Plane},
    resolutions,
    shades::{Light, Shades},
    sphere_image::{self, ImageSlot, SphereValues, key},
    sphere_numbers::SphereNumbers,
    sphere_pair::{self, Ball, Turn},
    unfolded, value_table, volume_pair,
};
use crate::{
    command::{Command, Dialog},
    export::Export,
    session::{NamedVolume, View},
};
use egui::Ui;
use glam::Vec3;
use lumenscope_core::{
    inspection::Legend,
    irradiance_volume::{lobe, moments::Order},
    math::{colour::Channel, part::Part},
};

/// Most rows of bins a hemisphere: those of the thesis's finest spheres.
const MOST_ROWS: u32 = 49;

const RADIANCE: &str =
    "Radiance that arrives at the point from each direction, L(ω), cd/m² (lm per m² and sr)";
const IRRADIANCE: &str =
    "Irradiance of a small plane facing each direction n: E(n) = ∫ L(ω) max(0, n·ω) dω, lx";

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tab {
    #[default]
    Plots,
    Lobe,
    Unfolded,
    Resolutions,
    Moments,
    Volumes,
    Numbers,
}

/// What the inspector remembers between frames; nothing a session would save.
#[derive(Clone, Default)]
struct Memory {
    turn: Turn,
    tab: Tab,
    channel: Channel,
    irradiance: bool,
    smooth: bool,
    false_colour: bool,
    balls: [ImageSlot; 2],
    squares: [ImageSlot; 2],
    lobe: ImageSlot,
    resolutions: Vec<ImageSlot>,
    moments: Vec<ImageSlot>,
    volumes: volume_pair::Memory,
}

/// Shows the open spheres; `None` invites to click a point.
pub fn show(
    ui: &mut Ui,
    probe: Option<&Probe>,
    resolutions: &[Probe],
    moments: Option<&moments::Spheres>,
    volumes: Option<[NamedVolume<'_>; 2]>,
    view: &View,
) -> Vec<Command> {
    let Some(probe) = probe else {
        empty(ui);
        return Vec::new();
    };
    let id = egui::Id::unique("sphere inspector");
    let mut memory: Memory = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let mut wanted = view.clone();
    let mut out = controls(ui, &mut memory, &mut wanted);
    let Some(light) = Light::new(probe, view.probe_part) else {
        ui.label("Waiting for the spheres of this point.");
        out.extend(commands(view, wanted));
        return out;
    };
    let shades = Shades::new(&light, memory.false_colour, memory.channel);
    let shown = Opened { probe, light: &light, shades: &shades, view, resolutions, moments, volumes };
    ui.separator();
    let room = ui.available_width();
    if room > 620.0 {
        ui.horizontal_top(|ui| {
            balls(ui, &mut memory, &shown, 168.0);
            ui.separator();
            ui.vertical(|ui| tabs(ui, &mut memory, &shown, &mut wanted.probe_order));
        });
    } else {
        // A tall tab leaves less for the balls above it.
        let largest = if matches!(memory.tab, Tab::Lobe | Tab::Resolutions | Tab::Moments | Tab::Volumes) {
            96.0
        } else {
            190.0
        };
        let size = (0.5 * (room - 12.0)).clamp(90.0, largest);
        balls(ui, &mut memory, &shown, size);
        ui.separator();
        tabs(ui, &mut memory, &shown, &mut wanted.probe_order);
    }
    wanted.probe_resolutions = memory.tab == Tab::Resolutions;
    wanted.probe_moments = memory.tab == Tab::Moments;
    ui.data_mut(|d| d.insert_temp(id, memory));
    out.extend(commands(view, wanted));
    out
}

/// What is open, and how it is coloured.
struct Opened<'a> {
    probe: &'a Probe,
    light: &'a Light,
    shades: &'a Shades,
    view: &'a View,
    resolutions: &'a [Probe],
    moments: Option<&'a moments::Spheres>,
    volumes: Option<[NamedVolume<'a>; 2]>,
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

fn controls(ui: &mut Ui, memory: &mut Memory, view: &mut View) -> Vec<Command> {
    let mut out = Vec::new();
    ui.horizontal_wrapped(|ui| {
        if let Some((p, _)) = view.probe {
            ui.label(egui::RichText::new(format!("{} m", super::number::point(p))).monospace().small())
                .on_hover_text("Where the spheres are");
        }
        for (part, name, meaning) in [
            (Part::All, "All", "Direct and indirect light"),
            (Part::Direct, "Direct", "Straight from the emitters"),
            (Part::Indirect, "Indirect", "After at least one bounce"),
        ] {
            ui.selectable_value(&mut view.probe_part, part, name).on_hover_text(meaning);
        }
    });
    ui.horizontal(|ui| bins(ui, &mut view.probe_bins_n));
    ui.horizontal_wrapped(|ui| {
        channels(ui, &mut memory.channel);
        ui.checkbox(&mut memory.smooth, "Smooth")
            .on_hover_text("Interpolate between bins instead of showing each");
        ui.checkbox(&mut memory.false_colour, "False colour")
            .on_hover_text("Values by palette, with a legend");
        let export = ui.button("EXR…").on_hover_text(
            "Export radiance and irradiance, all, direct and indirect, and the moments that are open, as OpenEXR: \
             an environment map that any viewer shows, and every bin",
        );
        if export.clicked() {
            out.push(Command::Dialog(Dialog::Export(Export::Spheres)));
        }
        let panorama = ui.button("Panorama…").on_hover_text(
            "Writes all that arrives here as a latitude–longitude EXR, cd/m²: what a volume from panoramas is made \
             of",
        );
        if panorama.clicked() {
            out.push(Command::Dialog(Dialog::Export(Export::Panorama)));
        }
        if memory.turn != Turn::default()
            && ui.button("Align").on_hover_text("See the spheres from the viewport's side again").clicked()
        {
            memory.turn = Turn::default();
        }
    });
    out
}

fn bins(ui: &mut Ui, n: &mut u32) {
    let spacing = ui.spacing_mut();
    (spacing.slider_width, spacing.item_spacing.x, spacing.button_padding.x) = (62.0, 4.0, 4.0);
    let label = ui.label("n");
    let slider = egui::Slider::new(n, 1..=MOST_ROWS.max(*n)).update_while_editing(false);
    ui.add(slider)
        .labelled_by(label.id)
        .on_hover_text("Rows and columns of bins a hemisphere: 2n² bins, all of one solid angle, 2π/n² sr");
    for rows in resolutions::ROWS {
        ui.selectable_value(n, rows, (2 * rows * rows).to_string())
            .on_hover_text(format!("n = {rows}: {} bins", 2 * rows * rows));
    }
    if !resolutions::ROWS.contains(n) {
        ui.weak(format!("{} bins", 2 * *n * *n));
    }
}

fn channels(ui: &mut Ui, channel: &mut Channel) {
    let title = |c: Channel| match c {
        Channel::Rgb => "RGB",
        Channel::Luminance => "luminous",
        Channel::Red => "red",
        Channel::Green => "green",
        Channel::Blue => "blue",
    };
    egui::ComboBox::from_id_salt("channel").width(84.0).selected_text(title(*channel)).show_ui(ui, |ui| {
        for one in Channel::ALL {
            ui.selectable_value(channel, one, title(one));
        }
    });
}

fn balls(ui: &mut Ui, memory: &mut Memory, shown: &Opened<'_>, size: f32) {
    let Opened { light, shades, view, .. } = *shown;
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
                picture_key: light.key ^ key((memory.false_colour, memory.channel)),
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
                        let legend =
                            Legend { quantity: quantity.into(), unit: unit.into(), range, names: &[] };
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

fn tabs(ui: &mut Ui, memory: &mut Memory, shown: &Opened<'_>, order: &mut Option<Order>) {
    ui.horizontal_wrapped(|ui| {
        for (tab, name, meaning) in [
            (
                Tab::Plots,
                "Radial plots",
                "The value in each direction of a plane as the distance from the middle",
            ),
            (Tab::Lobe, "3-D lobe", "The radial plot of every direction at once"),
            (Tab::Unfolded, "Unfolded", "Each hemisphere as the square its bins are a grid on"),
            (Tab::Resolutions, "Resolutions", "The same point at every resolution of the thesis"),
            (Tab::Moments, "Moments", "What glossier and glossier surfaces would see: orders 1 to ∞"),
            (Tab::Volumes, "Volumes", "The two volumes that are compared, side by side"),
            (Tab::Numbers, "Numbers", "Illuminance from six sides, cylindrical, scalar, vector"),
        ] {
            ui.selectable_value(&mut memory.tab, tab, name).on_hover_text(meaning);
        }
        if !matches!(memory.tab, Tab::Numbers | Tab::Resolutions | Tab::Moments | Tab::Volumes) {
            ui.separator();
            ui.selectable_value(&mut memory.irradiance, false, "L").on_hover_text(RADIANCE);
            ui.selectable_value(&mut memory.irradiance, true, "E").on_hover_text(IRRADIANCE);
        }
    });
    let Opened { probe, light, shades, view, resolutions: probes, moments: spheres, volumes } = *shown;
    let (values, unit) =
        if memory.irradiance { (light.irradiance(), "lx") } else { (light.radiance(), "cd/m²") };
    let colour = |v: Vec3| if memory.irradiance { shades.irradiance(v) } else { shades.radiance(v) };
    let picture_key = light.key ^ key((memory.irradiance, memory.false_colour, memory.channel));
    match memory.tab {
        Tab::Plots => {
            let gap = ui.spacing().item_spacing.x;
            let size = ((ui.available_width() - 2.0 * gap) / 3.0).clamp(80.0, 240.0);
            ui.horizontal_wrapped(|ui| {
                for plane in Plane::ALL {
                    let id = format!("radial {plane:?}");
                    let look =
                        radial_plot::Look { size, channel: memory.channel, smooth: memory.smooth, unit };
                    radial_plot::show(ui, &id, &values, plane, look);
                }
            });
        }
        Tab::Lobe => {
            let view_from = memory.turn.world_from_view(&view.camera);
            let (channel, smooth) = (memory.channel, memory.smooth);
            let look = LobeLook { values, channel, smooth, unit, picture_key };
            lobe_tab(ui, &mut memory.lobe, &mut memory.turn, view_from, look, &colour);
        }
        Tab::Unfolded => {
            let size = (0.5 * (ui.available_width() - 12.0)).clamp(80.0, 240.0);
            unfolded::show(ui, &mut memory.squares, size, &values, picture_key, &colour, unit);
        }
        Tab::Resolutions => {
            let look = resolutions::Look {
                world_from_view: memory.turn.world_from_view(&view.camera),
                part: view.probe_part,
                smooth: memory.smooth,
                picture_key: key((memory.false_colour, memory.channel)) ^ light.key,
                colours: [&|v| shades.radiance(v), &|v| shades.irradiance(v)],
            };
            resolutions::show(ui, &mut memory.resolutions, probes, &look);
        }
        Tab::Moments => {
            let look = moments::Look {
                world_from_view: memory.turn.world_from_view(&view.camera),
                part: view.probe_part,
                smooth: memory.smooth,
                light_key: light.key,
                picture_key: key((memory.false_colour, memory.channel)),
                colour: &|v| shades.irradiance(v),
            };
            moments::show(ui, &mut memory.moments, probe.bins, spheres, order, &look);
        }
        Tab::Volumes => match volumes {
            None => {
                ui.weak("Keep a volume, or open one, under Views, Compare volumes: it is B.");
            }
            Some(pair) => {
                let asked = volume_pair::Asked {
                    position: probe.position,
                    part: view.probe_part,
                    light_key: light.key,
                    traced: light.irradiance(),
                    look: sphere_pair::Look {
                        camera: &view.camera,
                        normal: view.probe.map(|p| p.1),
                        size: (0.5 * (ui.available_width() - 12.0)).clamp(80.0, 190.0),
                        smooth: memory.smooth,
                        picture_key: key((memory.false_colour, memory.channel)),
                    },
                    colour: &|v| shades.irradiance(v),
                };
                volume_pair::show(ui, &mut memory.volumes, &mut memory.turn, pair, &asked);
            }
        },
        Tab::Numbers => {
            value_table::show(ui, "sphere numbers", &SphereNumbers::new(&light.irradiance()).rows());
        }
    }
}

struct LobeLook<'a> {
    values: SphereValues<'a>,
    channel: Channel,
    smooth: bool,
    unit: &'a str,
    picture_key: u64,
}

fn lobe_tab(
    ui: &mut Ui,
    slot: &mut ImageSlot,
    turn: &mut Turn,
    world_from_view: glam::Mat3,
    look: LobeLook<'_>,
    colour: &dyn Fn(Vec3) -> [u8; 3],
) {
    let LobeLook { values, channel, smooth, unit, picture_key } = look;
    let size = ui.available_width().clamp(120.0, 180.0);
    let (rect, response) = ui.allocate_exact_size(egui::vec2(size, size), egui::Sense::click_and_drag());
    let response = response.on_hover_and_drag_cursor(egui::CursorIcon::Grab);
    turn.drag(&response, size);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "3-D radial plot"));
    let reach = values.values.iter().map(|v| channel.measure(*v)).fold(0.0f32, f32::max);
    let pixels = (size * ui.pixels_per_point()).clamp(64.0, 640.0) as usize;
    let seen = world_from_view.to_cols_array().map(f32::to_bits);
    let texture = slot.texture(ui.ctx(), "lobe", key((picture_key, seen, pixels, smooth)), || {
        let mesh = lobe::lobe(&values, smooth, |v| channel.measure(v));
        sphere_image::image(pixels, lobe::picture(&mesh, world_from_view, pixels, reach, colour))
    });
    let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    ui.painter().image(texture, rect, whole, egui::Color32::WHITE);
    ui.label(
        egui::RichText::new(format!(
            "Reaches {}; axes x red, y green, z blue. Drag to turn.",
            super::number::with_unit(reach, unit)
        ))
        .small()
        .weak(),
    );
}
