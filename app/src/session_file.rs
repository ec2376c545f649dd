//! Session files and the list of files opened lately.
//!
//! A session file is the [`Document`] in RON. Paths in it are relative to the file where the scene
//! lies beside or below it, so that a folder can be moved as a whole.

use crate::document::Document;
use anyhow::{Context as _, Result};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Extension of session files.
pub const EXTENSION: &str = "lumenscope";

/// Whether a path names a session file.
pub fn is_session(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION))
}

/// Writes a session; the old file stays whole if that fails.
///
/// # Errors
/// With the file's name, if it cannot be written.
pub fn write(path: &Path, document: &Document) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut stored = document.clone();
    stored.scene = stored.scene.map(|scene| relative_to(folder, &scene));
    stored.edits.added = stored.edits.added.iter().map(|model| relative_to(folder, model)).collect();
    let text = ron::ser::to_string_pretty(&stored, ron::ser::PrettyConfig::default())
        .with_context(|| format!("{}: the session cannot be written as RON", path.display()))?;
    let partial = path.with_extension("lumenscope-part");
    fs::write(&partial, text)
        .and_then(|()| fs::rename(&partial, path))
        .with_context(|| format!("{}: the session cannot be saved", path.display()))
}

/// Reads a session.
///
/// # Errors
/// With the file's name, if it cannot be read or is no session.
pub fn read(path: &Path) -> Result<Document> {
    let text = fs::read_to_string(path)
        .with_context(|| format!("{}: the session cannot be read", path.display()))?;
    let mut document: Document =
        ron::from_str(&text).with_context(|| format!("{}: this is not a session", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let absolute = |p: PathBuf| if is_portable(&p) { p } else { folder.join(p) };
    document.scene = document.scene.map(absolute);
    document.edits.added = std::mem::take(&mut document.edits.added).into_iter().map(absolute).collect();
    Ok(document)
}

fn relative_to(folder: &Path, path: &Path) -> PathBuf {
    if is_portable(path) {
        return path.to_path_buf();
    }
    let whole = |p: &Path| fs::canonicalize(p).unwrap_or_else(|_| p.to_path_buf());
    let folder = whole(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    let path = whole(path);
    path.strip_prefix(&folder).map(Path::to_path_buf).unwrap_or(path)
}

fn is_portable(path: &Path) -> bool {
    path.to_str().is_some_and(|p| p.starts_with("example:"))
}

/// Files opened lately, newest first.
#[derive(Debug, Default)]
pub struct RecentFiles {
    list: Option<PathBuf>,
    files: Vec<PathBuf>,
}

impl RecentFiles {
    /// Most files kept.
    pub const MOST: usize = 10;

    /// Reads the list kept in a folder; a missing or broken one counts as empty.
    pub fn load(folder: Option<&Path>) -> Self {
        let list = folder.map(|f| f.join("recent.ron"));
        let text = list.as_ref().and_then(|l| fs::read_to_string(l).ok());
        let files = text.and_then(|t| ron::from_str(&t).ok()).unwrap_or_default();
        Self { list, files }
    }

    /// The files, newest first.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Puts a file first and writes the list.
    ///
    /// # Errors
    /// If the list cannot be written; it is kept in memory all the same.
    pub fn add(&mut self, file: &Path) -> Result<()> {
        let file = if is_portable(file) { file.to_path_buf() } else { std::path::absolute(file)? };
        self.files.retain(|f| *f != file);
        self.files.insert(0, file);
        self.files.truncate(Self::MOST);
        let Some(list) = &self.list else { return Ok(()) };
        if let Some(folder) = list.parent() {
            fs::create_dir_all(folder).with_context(|| format!("{}", folder.display()))?;
        }
        fs::write(list, ron::to_string(&self.files)?).with_context(|| format!("{}", list.display()))
    }
}

/// The folder for settings of this user, where there is one.
pub fn config_folder() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "lumenscope").map(|d| d.config_dir().to_path_buf())
}
