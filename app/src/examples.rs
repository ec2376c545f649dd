//! The examples that come with the program.

use std::path::{Path, PathBuf};

/// An example scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Example {
    /// A furnished office, lit mostly by an uplighter: the scene shown at first.
    Office,
    /// The Cornell box.
    Cornell,
}

impl Example {
    /// Every example, in the order they are offered.
    pub const ALL: [Self; 2] = [Self::Office, Self::Cornell];

    /// Title on buttons.
    pub fn title(self) -> &'static str {
        match self {
            Self::Office => "Office",
            Self::Cornell => "Cornell box",
        }
    }

    /// What it is good for.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Office => "A furnished room lit by an uplighter: most of its light is indirect.",
            Self::Cornell => "Two blocks between a red and a green wall: colour bleeding at its plainest.",
        }
    }

    /// Name in a session file: `example:NAME`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Office => "example:office",
            Self::Cornell => "example:cornell",
        }
    }

    fn file(self) -> &'static str {
        match self {
            Self::Office => "office/office.ron",
            Self::Cornell => "cornell/cornell.ron",
        }
    }
}

/// The file to read for a document's scene: an example's file for `example:NAME`, else the path itself.
pub fn resolve(scene: &Path) -> PathBuf {
    match Example::ALL.into_iter().find(|e| Path::new(e.key()) == scene) {
        Some(example) => Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(example.file()),
        None => scene.to_path_buf(),
    }
}
