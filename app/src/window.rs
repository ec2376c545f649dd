//! The window: eframe with wgpu.

use crate::{LumenscopeApp, examples::Example, session::Document};
use anyhow::{Result, anyhow};
use std::path::PathBuf;

/// Opens the window on a scene or session file; without one on the first example.
///
/// # Errors
/// If there is no display or no graphics adapter, or the system gives no thread.
pub fn run_window(path: Option<PathBuf>) -> Result<()> {
    let scene = path.unwrap_or_else(|| Example::Office.key().into());
    let document = Document { scene: Some(scene), ..Document::default() };
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("lumenscope")
            .with_app_id("lumenscope")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([720.0, 480.0])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        ..eframe::NativeOptions::default()
    };
    let create: eframe::AppCreator<'_> = Box::new(|cc| Ok(Box::new(LumenscopeApp::new(cc, document)?)));
    eframe::run_native("lumenscope", options, create)
        .map_err(|error| anyhow!("the window did not open: {error}"))
}
