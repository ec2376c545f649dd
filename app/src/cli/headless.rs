//! No subcommand: the window, or, where there is no display, files that show the same.

use crate::examples::{self, Example};

use super::{
    Common,
    render::{self, Backend},
    screenshots, solve,
};
use lumenscope_core::io::png::write_png;
use std::path::{Path, PathBuf};

/// Folder written where there is no display.
const FOLDER: &str = "lumenscope-out";

/// Opens the window; without a display says so and writes picture, layers and views.
///
/// # Errors
/// When neither is possible.
pub fn window_or_files(file: Option<PathBuf>, common: &Common) -> anyhow::Result<()> {
    if has_display() {
        return crate::run_window(file);
    }
    eprintln!("no display: writing the picture, its layers and its views into {FOLDER}/");
    let folder = Path::new(FOLDER);
    solve::output_folder(folder)?;
    let file = file.unwrap_or_else(|| Example::Office.key().into());
    let loaded = solve::load(&examples::resolve(&file)?, common)?;
    let solution = solve::solve(&loaded, true)?;
    let (layers, _) = render::picture(&solution, [1280, 720], 8, Backend::Auto, common.seed)?;
    render::write_layers(&folder.join("layers.exr"), &layers)?;
    screenshots::write_pictures(&solution, &layers, folder, |path, width, height, pixels| {
        Ok(write_png(path, width, height, pixels)?)
    })
}

fn has_display() -> bool {
    !cfg!(target_os = "linux")
        || ["DISPLAY", "WAYLAND_DISPLAY"]
            .iter()
            .any(|name| std::env::var_os(name).is_some_and(|v| !v.is_empty()))
}
