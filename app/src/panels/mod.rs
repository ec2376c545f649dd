//! Panels: each shows what it is given and returns commands. [`dock`] lays them out.

pub mod colours;
pub mod copies;
pub mod dock;
pub mod empty;
pub mod help;
pub mod kernel;
pub mod layers;
pub mod lightmap;
pub mod log;
pub mod menu;
pub mod notice;
pub mod placement;
pub mod plan;
mod plan_fields;
pub mod readout;
pub mod scene;
pub mod status;
pub mod texture;
pub mod views;
pub mod volumes;

use crate::{command::Command, session::View};
use egui::{Response, RichText, Ui, UiBuilder};
use glam::Vec3;
use lumenscope_core::math::colour::luminance;

/// Edits a copy of the view; if that changed it, says so.
fn edit_view(view: &View, out: &mut Vec<Command>, edit: impl FnOnce(&mut View)) {
    let mut changed = view.clone();
    edit(&mut changed);
    if changed != *view {
        out.push(Command::View(Box::new(changed)));
    }
}

/// A heading inside a panel and what stands under it, whose widgets keep their ids whatever the sections
/// before it show: a click is not lost when they grow between press and release.
fn section(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    ui.add_space(6.0);
    ui.label(RichText::new(title).strong());
    let id = ui.scope_id().with(title);
    ui.scope_builder(UiBuilder::new().scope_id(id), contents);
}

/// Gives a widget the name by which screen readers, and tests, know it.
pub fn named(response: Response, name: &str) -> Response {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
    response
}

/// A number with about three significant digits.
pub fn number(value: f32) -> String {
    let size = value.abs();
    match size {
        _ if !value.is_finite() => "not finite".into(),
        _ if size == 0.0 => "0".into(),
        _ if !(1e-3..1e6).contains(&size) => format!("{value:.2e}"),
        _ if size >= 100.0 => format!("{value:.0}"),
        _ if size >= 10.0 => format!("{value:.1}"),
        _ if size >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

/// A row of a read-out: a photometric quantity as luminance-weighted value, and its channels.
fn quantity(ui: &mut Ui, name: &str, value: Vec3, unit: &str, tooltip: &str) {
    ui.label(name).on_hover_text(tooltip);
    let channels = format!("{}  {}  {}", number(value.x), number(value.y), number(value.z));
    ui.label(RichText::new(format!("{} {unit}", number(luminance(value)))).strong())
        .on_hover_text(format!("{tooltip}\n\nR  G  B: {channels} {unit}"));
    ui.label(RichText::new(channels).small().weak());
    ui.end_row();
}
