//! How mirrors are shown: settings that scene files name. The room `mirror` does it.

use serde::{Deserialize, Serialize};

/// Where what flat mirrors show comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MirrorMethod {
    /// From the geometry, seen from the mirrored eye (Bastos 1999, §6.3).
    #[default]
    Geometry,
    /// From images-with-depth taken beforehand (§6.6).
    Images,
}

impl MirrorMethod {
    /// Every method.
    pub const ALL: [Self; 2] = [Self::Geometry, Self::Images];

    /// Name on the command line and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometry => "geometry",
            Self::Images => "images",
        }
    }
}
