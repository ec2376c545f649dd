//! Commands: the only way a panel or the viewport changes anything.

use crate::session::{Document, View};
use glam::Affine3A;
use lumenscope_core::scene::Target;
use std::path::PathBuf;

/// One thing the user asked for.
#[derive(Clone, Debug)]
pub enum Command {
    /// Put a target somewhere; while `dragging`, successive ones merge into one undo step.
    Place { target: Target, placement: Affine3A, dragging: bool },
    /// Dim a target; while `dragging`, successive ones merge into one undo step.
    Dim { target: Target, dimmer: f32, dragging: bool },
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
    /// Open the example that is built in.
    OpenExample,
    /// Save the session.
    SaveSession(PathBuf),
    /// Replace the whole document.
    Replace(Box<Document>),
    /// Export the picture as PNG.
    ExportPicture(PathBuf),
    /// Export the layers as multi-layer EXR.
    ExportLayers(PathBuf),
    /// Start or restart the reference picture.
    StartReference,
    /// Stop the work in progress.
    Cancel,
}
