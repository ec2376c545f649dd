//! Settings of the plan's lines that can be fixed by hand.

use crate::session::Session;
use egui::{DragValue, Ui};
use lumenscope_core::{
    glossy::{
        GlossyMethod,
        environment::{GLOSSY_DEPTH, MOST_GLOSSY_DEPTH},
        particles::light,
    },
    irradiance_volume::{Basis, VolumeSettings, moments::Order, trust::Repair},
    mirror::{IMAGES, MOST_IMAGES, MirrorMethod, MirrorSettings},
    radiosity::{RadiositySettings, lookup::Lookup, subdivide::Subdivision, surface_map::ElementLayout},
    scene::{file::PlanOverrides, lookup::Reconstruction},
    superposition::plan::Component,
};
use std::collections::BTreeSet;

/// The settings of a component that can be fixed, one row each.
pub fn fields(ui: &mut Ui, component: Component, over: &mut PlanOverrides, session: &Session) {
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
            let names = ["none", "1", "2", "3", "4"];
            let levels = [0u8, 1, 2, 3, 4].map(|n| (n, names[usize::from(n)]));
            choice(ui, "Levels", LEVELS, &mut over.element_levels, levels);
            let split = Subdivision::default().tolerance;
            share(ui, "Split above", SPLIT, &mut over.element_tolerance, split, 0.001..=10.0);
            choice(
                ui,
                "Restricted",
                RESTRICTED,
                &mut over.element_restricted,
                [(true, "yes"), (false, "no")],
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
            let ways = Reconstruction::ALL.map(|r| (r, r.name()));
            choice(ui, "Reconstruction", RECONSTRUCTION, &mut over.reconstruction, ways);
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
            count(
                ui,
                "Reflections",
                "Glossy reflections, one seen in the other, in mirrors and on curved things",
                &mut over.glossy_depth,
                GLOSSY_DEPTH,
                1..=MOST_GLOSSY_DEPTH,
            );
            count(
                ui,
                "Particles",
                "Particles of light sent by all emitters, where what is glossy is made of them",
                &mut over.glossy_particles,
                light::PARTICLES,
                1..=light::MOST_PARTICLES,
            );
        }
        Component::IrradianceVolume => volume(ui, over, session),
    }
}

fn volume(ui: &mut Ui, over: &mut PlanOverrides, session: &Session) {
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
        "Samples at most",
        "Over both levels; the first level is chosen to stay within where it is automatic",
        &mut over.volume_target_samples,
        usual.target_samples,
        8..=200_000,
    );
    share(ui, "Divide by error", TOLERANCE, &mut over.volume_refine_tolerance, 0.1, 0.0..=10.0);
    choice(
        ui,
        "Geometry too",
        "Where cells are divided by error: whether those with geometry are divided besides",
        &mut over.volume_refine_geometry,
        [(true, "yes"), (false, "no")],
    );
    count(
        ui,
        "Bins",
        "n rows and columns a hemisphere: 2n² bins a sample",
        &mut over.volume_bins_n,
        usual.bins_n,
        1..=64,
    );
    count(
        ui,
        "Pockets",
        "Samples at most for places in shelves and under desks that the samples around stand for badly; with the guard",
        &mut over.volume_pocket_samples,
        usual.pocket_samples,
        0..=4096,
    );
    count(
        ui,
        "Rays a bin",
        "Radiance rays through random points of each bin; 1 goes through its middle",
        &mut over.volume_supersample,
        usual.supersample,
        1..=256,
    );
    count(
        ui,
        "Aimed rays",
        "Extra rays a sample towards bright surfaces, weighted so that the mean stays as it is",
        &mut over.volume_informed_rays,
        usual.informed_rays,
        0..=4096,
    );
    share(ui, "Mirror cut-off", CUTOFF, &mut over.volume_specular_cutoff, usual.specular_cutoff, 0.0..=1.0);
    share(ui, "Back faces", BACKS, &mut over.volume_back_face_limit, usual.back_face_limit, 0.0..=1.0);
    choice(ui, "Basis", BASIS, &mut over.volume_basis, Basis::ALL.map(|b| (b, b.name())));
    let repairs = Repair::ALL.map(|r| (r, r.name()));
    choice(ui, "Samples in solids", REPAIR, &mut over.volume_repair, repairs);
    choice(ui, "Guard", GUARD, &mut over.volume_guard, [(true, "on"), (false, "off")]);
    ignored(ui, &mut over.volume_ignored, session);
    moments(ui, &mut over.volume_moments);
}

const TOLERANCE: &str = "Divides the cells in which interpolation errs by more than this share, worst first, instead \
                         of those with geometry";
const CUTOFF: &str =
    "Share of a ray's light left after mirrors, in the best channel, below which it is given up";
const BACKS: &str =
    "Share of a sample's rays that may meet backs of surfaces before it counts as inside a solid";

/// Things whose light the volume leaves out, by name.
fn ignored(ui: &mut Ui, names: &mut Option<Vec<String>>, session: &Session) {
    ui.label("Ignored").on_hover_text(
        "Objects, lamps and materials whose light the volume leaves out: rays that meet them bring nothing",
    );
    ui.label("");
    let chosen = names.clone().unwrap_or_default();
    let scene = session.scene.as_deref();
    let all = scene.map(|s| {
        let objects = s.objects.iter().map(|o| o.name.clone());
        let lamps = s.lamps.iter().map(|l| l.name.clone());
        let materials = s.materials.iter().map(|m| m.name.clone());
        objects.chain(lamps).chain(materials).filter(|n| !n.is_empty()).collect::<BTreeSet<_>>()
    });
    let text = if chosen.is_empty() { "nothing".to_owned() } else { chosen.join(", ") };
    let list = egui::ComboBox::from_id_salt("ignored").selected_text(text).show_ui(ui, |ui| {
        for name in all.into_iter().flatten() {
            let mut on = chosen.contains(&name);
            if ui.toggle_value(&mut on, &name).changed() {
                let mut next = chosen.clone();
                next.retain(|n| *n != name);
                if on {
                    next.push(name);
                }
                *names = (!next.is_empty()).then_some(next);
            }
        }
    });
    super::named(list.response, "Ignored by the volume");
    ui.end_row();
}

const RECONSTRUCTION: &str = "What becomes of a grid's nodes before that, in pictures: nothing (stored); the smooth \
    function through them at twice as many along each axis (hermite); or that, low-passed where it moves nothing by \
    more than 2 % (filtered)";
const LEVELS: &str = "Times that a cell of the element spacing may be split where light bends: quadtrees instead of \
                      uniform grids";
const SPLIT: &str = "Deviation from bilinear that is let be on an unsplit cell, relative to the irradiance; four times \
                     as much a level further down";
const RESTRICTED: &str = "Cells that share an edge differ by one level at most";
const LOOKUP: &str = "Between the nodes of a grid, in pictures: bilinear between four, or Mitchell and \
                      Netravali's bicubic over 4 × 4, without creases. Nothing is solved again";
const GLOSSY: &str = "How glossy flat surfaces blur what they mirror: by a kernel of its own for every pixel, by \
                      one a reflector, or not at all; nothing is solved again. Or particles of light, sent once, on \
                      whatever is glossy";
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

/// A share of one.
fn share(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    value: &mut Option<f32>,
    usual: f32,
    range: std::ops::RangeInclusive<f32>,
) {
    let edit = |ui: &mut Ui, value: &mut f32| {
        ui.add(DragValue::new(value).range(range).speed(0.005).max_decimals(4));
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
