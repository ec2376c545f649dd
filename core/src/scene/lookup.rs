//! How pictures look up what is stored on surfaces: a setting that scene files name. The room `radiosity` does it.

use serde::{Deserialize, Serialize};

/// How a value between the nodes of a grid of elements is made of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lookup {
    /// Bilinear between four nodes: it keeps them, and creases along their lines.
    #[default]
    Bilinear,
    /// Mitchell and Netravali's bicubic (1/3, 1/3) over 4 × 4 nodes: C¹, a little blurred.
    Mitchell,
}

impl Lookup {
    /// Every way.
    pub const ALL: [Self; 2] = [Self::Bilinear, Self::Mitchell];

    /// Name on the command line and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bilinear => "bilinear",
            Self::Mitchell => "mitchell",
        }
    }
}
