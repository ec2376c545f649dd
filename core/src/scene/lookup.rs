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

/// What becomes of the light stored on grids of elements before pictures look it up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reconstruction {
    /// Nothing: the nodes as the solver has them.
    #[default]
    Stored,
    /// The smooth function through them, at twice as many nodes along each axis.
    Hermite,
    /// That, low-passed where no texel moves by more than 2 %.
    Filtered,
}

impl Reconstruction {
    /// Every way.
    pub const ALL: [Self; 3] = [Self::Stored, Self::Hermite, Self::Filtered];

    /// Name on the command line and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stored => "stored",
            Self::Hermite => "hermite",
            Self::Filtered => "filtered",
        }
    }
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
