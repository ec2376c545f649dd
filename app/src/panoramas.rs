//! Lists of panoramas that a volume is made of.

use anyhow::{Context as _, Result};
use glam::Vec3;
use lumenscope_core::{io::panorama as files, irradiance_volume::panorama::PanoramaNode};
use std::path::{Path, PathBuf};

/// One line of the list of nodes.
#[derive(serde::Deserialize)]
struct NodeLine {
    position: Vec3,
    file: PathBuf,
}

/// Reads a list of nodes and the panoramas that it names, which lie beside it.
///
/// # Errors
/// One line naming the file and the cause.
pub fn read(list: &Path) -> Result<Vec<PanoramaNode>> {
    let text = std::fs::read_to_string(list).with_context(|| format!("cannot read {}", list.display()))?;
    let lines: Vec<NodeLine> =
        ron::from_str(&text).with_context(|| format!("{}: not a list of nodes", list.display()))?;
    let folder = list.parent().unwrap_or(Path::new(""));
    lines
        .into_iter()
        .map(|l| Ok(PanoramaNode { position: l.position, image: files::read(&folder.join(l.file))? }))
        .collect()
}
