//! The examples that come with the program.

use anyhow::{Context as _, Result};
use std::path::{Path, PathBuf};

/// An example scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Example {
    /// A furnished office, lit mostly by an uplighter: the scene shown at first.
    Office,
    /// The Cornell box.
    Cornell,
    /// A teapot on a glossy table.
    Teapot,
    /// A pyramid of copper on a mirror.
    Pyramid,
    /// A house with a music room: five mirrors.
    House,
}

impl Example {
    /// Every example, in the order they are offered.
    pub const ALL: [Self; 5] = [Self::Office, Self::Cornell, Self::Teapot, Self::Pyramid, Self::House];

    /// Title on buttons.
    pub fn title(self) -> &'static str {
        match self {
            Self::Office => "Office",
            Self::Cornell => "Cornell box",
            Self::Teapot => "Teapot on a glossy table",
            Self::Pyramid => "Copper pyramid",
            Self::House => "House with a music room",
        }
    }

    /// What it is good for.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Office => "A furnished room lit by an uplighter: most of its light is indirect.",
            Self::Cornell => "Two blocks between a red and a green wall: colour bleeding at its plainest.",
            Self::Teapot => {
                "A glossy table between a teapot and a chequered wall: reflections blur with distance."
            }
            Self::Pyramid => {
                "Flat mirrors of copper: reflectance that grows and pales towards grazing angles."
            }
            Self::House => {
                "A grand piano among five flat mirrors and 180,000 triangles: mirrored views and what they cost."
            }
        }
    }

    /// Name in a session file: `example:NAME`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Office => "example:office",
            Self::Cornell => "example:cornell",
            Self::Teapot => "example:teapot",
            Self::Pyramid => "example:pyramid",
            Self::House => "example:house",
        }
    }

    /// Its files: name, and contents built into the program.
    fn files(self) -> Vec<(&'static str, &'static [u8])> {
        match self {
            Self::Office => vec![
                ("office.ron", include_bytes!("../../scenes/office/office.ron")),
                ("office.glb", include_bytes!("../../scenes/office/office.glb")),
            ],
            Self::Cornell => vec![
                ("cornell.ron", include_bytes!("../../scenes/cornell/cornell.ron")),
                ("cornell.glb", include_bytes!("../../scenes/cornell/cornell.glb")),
            ],
            Self::Teapot => vec![
                ("teapot.ron", include_bytes!("../../scenes/glossy/teapot.ron")),
                ("teapot.glb", include_bytes!("../../scenes/glossy/teapot.glb")),
            ],
            Self::Pyramid => vec![
                ("pyramid.ron", include_bytes!("../../scenes/mirror/pyramid.ron")),
                ("pyramid.glb", include_bytes!("../../scenes/mirror/pyramid.glb")),
            ],
            Self::House => vec![
                ("house.ron", include_bytes!("../../scenes/house/house.ron")),
                ("music_room.glb", include_bytes!("../../scenes/house/music_room.glb")),
                ("living_room.glb", include_bytes!("../../scenes/house/living_room.glb")),
            ],
        }
    }

    fn folder(self) -> &'static str {
        match self {
            Self::Office => "office",
            Self::Cornell => "cornell",
            Self::Teapot => "glossy",
            Self::Pyramid => "mirror",
            Self::House => "house",
        }
    }

    /// Its scene file: in the source tree where there is one, else unpacked into the user's cache.
    ///
    /// # Errors
    /// With the file's name, if it cannot be unpacked.
    pub fn path(self) -> Result<PathBuf> {
        let files = self.files();
        let scene = files[0].0;
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(self.folder()).join(scene);
        if source.exists() {
            return Ok(source);
        }
        let cache = directories::ProjectDirs::from("", "", "lumenscope")
            .map_or_else(|| std::env::temp_dir().join("lumenscope"), |d| d.cache_dir().to_path_buf());
        let folder = cache.join(concat!("examples-", env!("CARGO_PKG_VERSION"))).join(self.folder());
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("{}: the example cannot be unpacked", folder.display()))?;
        for (name, bytes) in files {
            lumenscope_core::io::write_file(&folder.join(name), bytes)?;
        }
        Ok(folder.join(scene))
    }
}

/// The scene shown where none is asked for.
///
/// # Errors
/// With the file's name, if it cannot be unpacked.
pub fn office() -> Result<PathBuf> {
    Example::Office.path()
}

/// The Cornell box's scene file.
///
/// # Errors
/// With the file's name, if it cannot be unpacked.
pub fn cornell() -> Result<PathBuf> {
    Example::Cornell.path()
}

/// The file to read for a document's scene: an example's file for `example:NAME`, else the path itself.
///
/// # Errors
/// With the file's name, if an example cannot be unpacked.
pub fn resolve(scene: &Path) -> Result<PathBuf> {
    match Example::ALL.into_iter().find(|e| Path::new(e.key()) == scene) {
        Some(example) => example.path(),
        None => Ok(scene.to_path_buf()),
    }
}
