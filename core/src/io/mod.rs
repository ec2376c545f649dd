//! Files written and read besides scenes: layers as EXR, pictures as PNG.

pub mod exr;
pub mod panorama;
pub mod png;
pub mod probe;

use std::path::{Path, PathBuf};

/// What goes wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IoError {
    /// It cannot be written.
    #[error("cannot write {}: {cause}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why not.
        cause: String,
    },
    /// It cannot be read.
    #[error("cannot read {}: {cause}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why not.
        cause: String,
    },
}

impl IoError {
    fn write(path: &Path, cause: impl ToString) -> Self {
        Self::Write { path: path.into(), cause: one_line(&cause.to_string()) }
    }

    fn read(path: &Path, cause: impl ToString) -> Self {
        Self::Read { path: path.into(), cause: one_line(&cause.to_string()) }
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Writes a whole file beside its place and moves it there, so that a failure leaves the old one.
///
/// # Errors
/// [`IoError::Write`] naming the file and the cause.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    let mut name = path.file_name().ok_or_else(|| IoError::write(path, "not a file name"))?.to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path)).map_err(|cause| {
        // What is left of the attempt is of no use; that it may not exist is no second error.
        let _ = std::fs::remove_file(&part);
        IoError::write(path, cause)
    })
}
