//! The plan: what this scene needs, why, and what it cost; each line can be decided by hand.

use crate::{command::Command, session::Session};
use egui::{Align, Button, DragValue, Grid, Layout, Popup, PopupCloseBehavior, RichText, Ui};
use lumenscope_core::{
    glossy::GlossyMethod,
    irradiance_volume::{Basis, VolumeSettings, moments::Order, trust::Repair},
    mirror::{IMAGES, MOST_IMAGES, MirrorMethod, MirrorSettings},
    radiosity::{RadiositySettings, lookup::Lookup, surface_map::ElementLayout},
    scene::file::PlanOverrides,
    superposition::plan::{Component, ExpectedError, PlanLine},
};

/// What the panel remembers between frames.
#[derive(Debug, Default)]
pub struct State {
    /// Overrides being written, and the component they are for.
    draft: Option<(Component, PlanOverrides)>,
}

/// Shows the plan, and what the light on screen took.
pub fn show(ui: &mut Ui, state: &mut State, session: &Session, out: &mut Vec<Command>) {
    let (Some(plan), Some(scene)) = (&session.plan, &session.scene) else {
        ui.weak("The plan appears when a scene has been read: what it needs, and why.");
        return;
    };
    for line in &plan.lines {
        Row { line, session, over: &scene.plan }.show(ui, state, out);
    }
}

/// A line of the plan, and the overrides in force.
struct Row<'a> {
    line: &'a PlanLine,
    session: &'a Session,
    over: &'a PlanOverrides,
}

impl Row<'_> {
    fn show(&self, ui: &mut Ui, state: &mut State, out: &mut Vec<Command>) {
        let (line, session) = (self.line, self.session);
        let text = |s: String| if line.used { RichText::new(s) } else { RichText::new(s).weak() };
        ui.horizontal(|ui| {
            ui.label(text(line.component.name().into()).strong()).on_hover_text(
                match (line.used, line.overridden) {
                    (false, true) => "Not computed: switched off by hand",
                    (false, false) => "Not computed: this scene does not need it",
                    (true, true) => "Computed, with settings fixed by hand or by the scene file",
                    (true, false) => "Computed, with settings chosen from the scene",
                },
            );
            if line.component != Component::Emitted {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    self.decide(ui, state, out);
                });
            }
        });
        ui.horizontal(|ui| {
            let error = match line.expected_error {
                _ if !line.used => "not computed".into(),
                ExpectedError::Exact => "exact".into(),
                ExpectedError::Median(share) => format!("error {:.1} %", share * 100.0),
                ExpectedError::Unknown => "error unknown".into(),
            };
            ui.label(text(error).small())
                .on_hover_text(format!("Expected relative error of this part.\n{}", line.error_basis));
            ui.label(text(seconds(session, line)).small())
                .on_hover_text("Seconds it took; in brackets, what was expected before it ran");
        });
        let parts: Vec<&str> =
            [line.settings.as_str(), line.reason.as_str()].into_iter().filter(|p| !p.is_empty()).collect();
        ui.add(egui::Label::new(RichText::new(parts.join("; ")).small().weak()).wrap());
        ui.add_space(5.0);
    }

    /// Whether a line is automatic or fixed, and the window in which that is changed.
    fn decide(&self, ui: &mut Ui, state: &mut State, out: &mut Vec<Command>) {
        let Self { line, session, over } = *self;
        let component = line.component;
        let word = if line.overridden { "fixed" } else { "automatic" };
        let button = ui.add(Button::new(RichText::new(word).small()).selected(line.overridden));
        button.widget_info(|| {
            let label = format!("{}: {word}", component.name());
            egui::WidgetInfo::labeled(egui::Role::Button, true, label)
        });
        let button =
            button.on_hover_text("Click to fix settings of this line, or to let the scene decide again");
        let popup = Popup::menu(&button).close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
            ui.set_min_width(270.0);
            ui.strong(format!("Plan of {}", component.name()));
            let draft = match &mut state.draft {
                Some((of, draft)) if *of == component => draft,
                other => &mut other.insert((component, over.clone())).1,
            };
            Grid::new("override")
                .num_columns(3)
                .spacing([10.0, 4.0])
                .show(ui, |ui| fields(ui, component, draft, session));
            ui.horizontal(|ui| {
                let apply = ui.add_enabled(draft != over, Button::new("Apply"));
                if apply.on_hover_text("Solve again what these settings change; one step to undo").clicked() {
                    out.push(Command::Plan(draft.clone()));
                    ui.close();
                }
                let back = ui.add_enabled(line.overridden, Button::new("Back to automatic"));
                if back.on_hover_text("Let the scene decide every setting of this line").clicked() {
                    out.push(Command::Plan(component.freed(over)));
                    ui.close();
                }
            });
        });
        let open_here = popup.is_some();
        if !open_here && state.draft.as_ref().is_some_and(|(of, _)| *of == component) {
            state.draft = None;
        }
    }
}

fn fields(ui: &mut Ui, component: Component, over: &mut PlanOverrides, session: &Session) {
    match component {
        Component::Emitted => {}
        Component::Direct => {
            let rays = session.plan.as_ref().map_or(16, |p| p.direct_samples);
            count(
                ui,
                "Shadow rays",
                "An area emitter and pixel of pictures written to files",
                &mut over.direct_samples,
                rays,
                1..=1024,
            );
        }
        Component::Radiosity => {
            let usual = RadiositySettings::default();
            let spacing = || {
                let world = session.solution.as_ref().map(|s| &s.world);
                world.map_or(0.1, |w| ElementLayout::new(&w.geometry, None).spacing_m)
            };
            length(
                ui,
                "Element spacing",
                "Distance between elements on flat surfaces",
                &mut over.element_spacing_m,
                spacing,
            );
            count(
                ui,
                "Gather rays",
                "Cosine-distributed rays of each element",
                &mut over.gather_rays,
                usual.gather_rays,
                1..=16_384,
            );
            count(
                ui,
                "Shadow rays",
                "An area emitter and element, where it is partly hidden",
                &mut over.shadow_rays,
                usual.shadow_rays,
                1..=1024,
            );
            choice(ui, "Lookup", LOOKUP, &mut over.lookup, Lookup::ALL.map(|l| (l, l.name())));
        }
        Component::Mirror => {
            count(
                ui,
                "Depth",
                "Mirrors that light is followed through on its way to the eye; 0 shows none",
                &mut over.mirror_depth,
                MirrorSettings::default().depth,
                0..=16,
            );
            choice(ui, "Mirrors from", MIRRORS, &mut over.mirrors, MirrorMethod::ALL.map(|m| (m, m.name())));
            count(
                ui,
                "Images",
                "Images-with-depth an element that stand for a mirrored view",
                &mut over.mirror_images,
                IMAGES,
                1..=MOST_IMAGES,
            );
        }
        Component::Glossy => {
            choice(ui, "Convolution", GLOSSY, &mut over.glossy, GlossyMethod::ALL.map(|m| (m, m.name())));
        }
        Component::IrradianceVolume => {
            let usual = VolumeSettings::default();
            built(ui, &mut over.volume);
            let grid = session.solution.as_ref().and_then(|s| s.volume.as_ref());
            let samples = || {
                let size = grid.map(|v| v.grid().size().to_array().map(|cells| cells + 1));
                size.unwrap_or([8; 3])
            };
            triple(ui, "First level", "Samples along x, y and z", &mut over.volume_samples, samples);
            count(
                ui,
                "Second level",
                "Samples an axis in a cell near surfaces or lamps",
                &mut over.volume_second_level,
                usual.second_level,
                2..=9,
            );
            count(
                ui,
                "Bins",
                "n rows and columns a hemisphere: 2n² bins a sample",
                &mut over.volume_bins_n,
                usual.bins_n,
                1..=64,
            );
            choice(ui, "Basis", BASIS, &mut over.volume_basis, Basis::ALL.map(|b| (b, b.name())));
            let repairs = Repair::ALL.map(|r| (r, r.name()));
            choice(ui, "Samples in solids", REPAIR, &mut over.volume_repair, repairs);
            choice(ui, "Guard", GUARD, &mut over.volume_guard, [(true, "on"), (false, "off")]);
            moments(ui, &mut over.volume_moments);
        }
    }
}

const LOOKUP: &str = "Between the nodes of a grid, in pictures: bilinear between four, or Mitchell and \
                      Netravali's bicubic over 4 × 4, without creases. Nothing is solved again";
const GLOSSY: &str = "How glossy flat surfaces blur what they mirror: by a kernel of its own for every pixel, by \
                      one a reflector, or not at all. Nothing is solved again";
const MIRRORS: &str = "What flat mirrors show: the geometry seen from the mirrored eye, or images-with-depth taken \
                       beforehand, whose price is that of their pixels whatever the scene";
const BASIS: &str = "What a query reads: 2n² bins, bilinear or the nearest, or nine spherical-harmonic \
                     coefficients E_lm = A_l L_lm. Nothing is traced again";
const REPAIR: &str = "Mask: neighbours share their weight. Dilate: they take their neighbours' light. \
                      Relocate: they move to free air within half a cell";
const GUARD: &str = "Queries use only samples that see the point past what stands still: no light through \
                     thin walls";

/// One of a few named values.
fn choice<T: Copy + PartialEq, const N: usize>(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    value: &mut Option<T>,
    choices: [(T, &'static str); N],
) {
    row_of(
        ui,
        name,
        hint,
        value,
        || choices[0].0,
        |ui, value| {
            let shown = choices.iter().find(|c| c.0 == *value).map_or("", |c| c.1);
            let id = ("plan", name);
            egui::ComboBox::from_id_salt(id).selected_text(shown).show_ui(ui, |ui| {
                for (choice, text) in choices {
                    ui.selectable_value(value, choice, text);
                }
            });
        },
    );
}

/// Orders of moments that the volume holds, of those in the thesis.
fn moments(ui: &mut Ui, held: &mut Option<Vec<Order>>) {
    ui.label("Moments").on_hover_text(
        "Orders kept beside the irradiance, for glossy objects: H = (n + 1)/2 ∫ L max(0, cos)^n dω, lx. Each \
         takes as much memory again",
    );
    ui.label("");
    ui.horizontal(|ui| {
        for order in Order::THESIS.into_iter().filter(|o| *o != Order::IRRADIANCE) {
            let mut on = held.as_ref().is_some_and(|h| h.contains(&order));
            if ui.toggle_value(&mut on, order.to_string()).changed() {
                let mut orders = held.take().unwrap_or_default();
                orders.retain(|o| *o != order);
                if on {
                    orders.push(order);
                }
                orders.sort_unstable();
                *held = (!orders.is_empty()).then_some(orders);
            }
        }
    });
    ui.end_row();
}

/// A row whose value is chosen from the scene until it is fixed.
fn row_of<T: Copy>(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    value: &mut Option<T>,
    usual: impl FnOnce() -> T,
    edit: impl FnOnce(&mut Ui, &mut T),
) {
    ui.label(name).on_hover_text(hint);
    let mut fixed = value.is_some();
    let check = ui.checkbox(&mut fixed, "");
    check
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, fixed, format!("fix {name}")));
    check.on_hover_text("Fix this setting");
    match (fixed, &mut *value) {
        (true, Some(value)) => edit(ui, value),
        (true, None) => *value = Some(usual()),
        (false, _) => {
            *value = None;
            ui.weak("automatic");
        }
    }
    ui.end_row();
}

fn count(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    value: &mut Option<u32>,
    usual: u32,
    range: std::ops::RangeInclusive<u32>,
) {
    let edit = |ui: &mut Ui, value: &mut u32| {
        ui.add(DragValue::new(value).range(range));
    };
    row_of(ui, name, hint, value, || usual, edit);
}

fn length(ui: &mut Ui, name: &str, hint: &str, value: &mut Option<f32>, usual: impl FnOnce() -> f32) {
    row_of(ui, name, hint, value, usual, |ui, value| {
        let speed = f64::from(*value) * 0.01;
        ui.add(DragValue::new(value).range(1e-4..=1e4).speed(speed).max_decimals(4).suffix(" m"));
    });
}

fn triple(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    value: &mut Option<[u32; 3]>,
    usual: impl FnOnce() -> [u32; 3],
) {
    row_of(ui, name, hint, value, usual, |ui, value| {
        ui.horizontal(|ui| {
            for axis in value {
                ui.add(DragValue::new(axis).range(2..=200));
            }
        });
    });
}

fn built(ui: &mut Ui, value: &mut Option<bool>) {
    row_of(
        ui,
        "Built",
        "Whether there is a volume at all",
        value,
        || true,
        |ui, value| {
            ui.selectable_value(value, true, "yes");
            ui.selectable_value(value, false, "no");
        },
    );
}

fn seconds(session: &Session, line: &PlanLine) -> String {
    let stages = session.solution.as_ref().map(|s| s.provenance.stage_seconds.as_slice()).unwrap_or_default();
    match stages.iter().find(|(name, _)| *name == line.component.name()) {
        Some((_, seconds)) => format!("{seconds:.2} s"),
        None if line.expected_seconds > 0.0 => format!("({:.1} s)", line.expected_seconds),
        None => String::new(),
    }
}
