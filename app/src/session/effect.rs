//! What a command asks for that needs a thread, a file or the window.

use super::Document;
use crate::{
    command::{Dialog, Window},
    examples::Example,
    export::Export,
    pipeline::VolumeSource,
};
use std::path::PathBuf;

/// What a command asks for that the session itself cannot do.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Load a scene or session file.
    Load(PathBuf),
    /// Load the scene of a document.
    Replace(Box<Document>),
    /// Load the open scene with one more model in it.
    AddModel(PathBuf),
    /// Load an example.
    LoadExample(Example),
    /// The scene changed: let the light follow. `dragging` while more of the same is to come.
    Follow {
        /// Whether more of the same is to come.
        dragging: bool,
    },
    /// The probe moved: sample it anew.
    Probe,
    /// Make the texture of the surface that was clicked.
    Texture,
    /// Hold the lightmap against our light.
    Lightmap,
    /// Measure where the document says, from now on.
    Measure,
    /// Make what the views show.
    Inspect,
    /// Path-trace the view, from the start if the view or scene changed.
    Reference,
    /// Forget the reference.
    DropReference,
    /// Put the two copies in, or take them away.
    Copies,
    /// Make a volume from another source, to keep it.
    OtherVolume(VolumeSource),
    /// Write the session.
    Save(PathBuf),
    /// Write something to a file.
    Export(Export, PathBuf),
    /// Stop the work in progress.
    Cancel,
    /// Ask for a file.
    Dialog(Dialog),
    /// Change the window.
    Window(Window),
}
