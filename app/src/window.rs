//! The window: eframe with wgpu.

use crate::{LumenscopeApp, examples::Example, session::Document};
use anyhow::{Result, anyhow};
use lumenscope_core::gpu;
use std::{path::PathBuf, sync::Arc};

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
        wgpu_options: egui_wgpu::WgpuConfiguration {
            wgpu_setup: egui_wgpu::WgpuSetup::CreateNew(device_setup()),
            ..egui_wgpu::WgpuConfiguration::default()
        },
        ..eframe::NativeOptions::default()
    };
    let create: eframe::AppCreator<'_> = Box::new(|cc| Ok(Box::new(LumenscopeApp::new(cc, document)?)));
    eframe::run_native("lumenscope", options, create)
        .map_err(|error| anyhow!("the window did not open: {error}"))
}

/// A device that the renderer can work on where the adapter offers one, else what the window needs: the
/// picture is then drawn on the processor.
fn device_setup() -> egui_wgpu::WgpuSetupCreateNew {
    let setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    let plain = Arc::clone(&setup.device_descriptor);
    egui_wgpu::WgpuSetupCreateNew {
        device_descriptor: Arc::new(move |adapter| match gpu::device::required_limits(adapter) {
            Ok(required_limits) => wgpu::DeviceDescriptor {
                label: Some("lumenscope"),
                required_features: gpu::device::required_features(),
                required_limits: wgpu::Limits {
                    max_texture_dimension_2d: adapter.limits().max_texture_dimension_2d.min(16384),
                    ..required_limits
                },
                ..wgpu::DeviceDescriptor::default()
            },
            Err(_) => plain(adapter),
        }),
        ..setup
    }
}
