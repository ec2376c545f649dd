//! Commands: the only way a panel or the viewport changes anything.

use crate::{
    examples::Example,
    export::Export,
    lightmaps::LightmapFile,
    pipeline::VolumeSource,
    placement::Placement,
    session::{Document, View},
};
use glam::Affine3A;
use lumenscope_core::scene::{Target, file::PlanOverrides};
use std::path::PathBuf;

/// One thing the user asked for.
#[derive(Clone, Debug)]
pub enum Command {
    /// Put a target somewhere.
    Place {
        /// What is put.
        target: Target,
        /// Where.
        placement: Affine3A,
        /// Whether more of the same is to come: successive ones merge into one undo step.
        dragging: bool,
    },
    /// Dim a target.
    Dim {
        /// What is dimmed.
        target: Target,
        /// Factor on its emission.
        dimmer: f32,
        /// Whether more of the same is to come: successive ones merge into one undo step.
        dragging: bool,
    },
    /// Choose where illuminance is measured, and what is asked of it.
    Measure {
        /// The choice.
        placement: Box<Placement>,
        /// Whether more of the same is to come: successive ones merge into one undo step.
        dragging: bool,
    },
    /// Override the rendering plan; what the overrides leave open is chosen from the scene.
    Plan(PlanOverrides),
    /// A drag ended: the next edit is its own undo step.
    EndDrag,
    /// Change how the scene is looked at.
    View(Box<View>),
    /// Step back.
    Undo,
    /// Step forward.
    Redo,
    /// Open a scene or session file.
    Open(PathBuf),
    /// Open an example.
    OpenExample(Example),
    /// Add a model file to the open scene, as movable objects.
    AddModel(PathBuf),
    /// Save the session.
    SaveSession(PathBuf),
    /// Replace the whole document.
    Replace(Box<Document>),
    /// Write something to a file.
    Export(Export, PathBuf),
    /// Hold a lightmap baked elsewhere against our light.
    Lightmap(LightmapFile),
    /// Start or restart the reference picture.
    StartReference,
    /// Keep the volume as it is now, to compare later ones with.
    KeepVolume,
    /// Forget a volume that was kept, by its number.
    ForgetVolume(usize),
    /// Make a volume from another source, and keep it.
    CompareWith(VolumeSource),
    /// Stop the work in progress.
    Cancel,
    /// Go on with the light where it was stopped.
    Solve,
    /// Ask for a file, then do something with it.
    Dialog(Dialog),
    /// Change the window, not the session.
    Window(Window),
}

impl Command {
    /// Whether it leaves the open document: what is not saved would be lost.
    pub fn leaves(&self) -> bool {
        matches!(self, Self::Open(_) | Self::OpenExample(_) | Self::Replace(_) | Self::Window(Window::Quit))
    }
}

/// What a file is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// A scene or session to open.
    Open,
    /// A model to add.
    AddModel,
    /// Where to save the session.
    SaveSession,
    /// Where to write something.
    Export(Export),
    /// A list of panoramas.
    Panoramas,
    /// A volume that was saved.
    Volume,
    /// A lightmap.
    Lightmap,
}

/// What can be changed about the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// Show or hide the help.
    Help,
    /// Show or hide every panel but the viewport.
    Panels,
    /// Put the panels back where they were at first.
    ResetPanels,
    /// Dark or light.
    Theme,
    /// Close the window.
    Quit,
}
