//! The sphere inspector: the radiance and irradiance spheres at one point, turned, plotted, unfolded, in numbers.

use super::Probe;
use crate::{command::Command, session::View};

/// Shows the open spheres; `None` invites to click a point.
pub fn show(ui: &mut egui::Ui, probe: Option<&Probe>, _view: &View) -> Vec<Command> {
    if probe.is_none() {
        ui.label("Click a point in the scene.");
    }
    Vec::new()
}
