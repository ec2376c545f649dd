//! The viewport: the picture, the camera in it, what is picked and what is dragged.

pub mod pick;

pub use pick::{Pick, PickedSample};

use crate::{command::Command, session::View, widgets::Probe};
use lumenscope_core::{
    inspection::InspectionScene, math::image::LinearImage, scene::Scene, transport::LightTransportSolution,
};
use std::sync::Arc;

/// What the viewport shows.
pub struct ViewportInput<'a> {
    /// The scene with the user's edits; `None` before one is open.
    pub scene: Option<&'a Arc<Scene>>,
    /// Its light, possibly of an earlier edit.
    pub solution: Option<&'a Arc<LightTransportSolution>>,
    /// The reference picture so far, cd/m², seen from the view's camera.
    pub reference: Option<&'a Arc<LinearImage>>,
    /// How it is looked at.
    pub view: &'a View,
    /// The open spheres.
    pub probe: Option<&'a Arc<Probe>>,
    /// What the inspection views put into the scene.
    pub inspection: Option<&'a Arc<InspectionScene>>,
    /// The window's wgpu device; without it the picture is drawn on the CPU.
    pub render_state: Option<&'a egui_wgpu::RenderState>,
}

/// What the user did in the viewport this frame.
#[derive(Debug, Default)]
pub struct ViewportOutput {
    /// Commands for the history.
    pub commands: Vec<Command>,
    /// What was clicked.
    pub pick: Option<Pick>,
    /// Seconds the picture last took.
    pub frame_seconds: f64,
}

/// The viewport's own state: nothing that a session would save.
#[derive(Default)]
pub struct Viewport {}

impl Viewport {
    /// A viewport with nothing in it.
    pub fn new() -> Self {
        Self::default()
    }

    /// Shows the picture and answers to mouse and keys, filling the space that `ui` has.
    pub fn show(&mut self, ui: &mut egui::Ui, _input: &ViewportInput<'_>) -> ViewportOutput {
        ui.allocate_space(ui.available_size());
        ViewportOutput::default()
    }
}
