//! The command line as tests call it.

use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Path of a scene that the program ships.
pub fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name).display().to_string()
}

/// Runs a command; its error in one string.
pub fn run(arguments: &[&str]) -> Result<(), String> {
    let arguments = std::iter::once("lumenscope").chain(arguments.iter().copied());
    lumenscope::cli::run(arguments.map(Into::into)).map_err(|error| format!("{error:#}"))
}

/// An empty folder that lasts as long as what is returned with its path.
///
/// # Panics
/// If there can be none.
pub fn folder() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().to_path_buf();
    (folder, path)
}

/// A path as an argument.
///
/// # Panics
/// If it is not UTF-8.
pub fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}
