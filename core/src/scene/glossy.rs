//! How glossy reflections are made: settings that scene files name. The room `glossy` does it.

use serde::{Deserialize, Serialize};

/// How the layer `glossy` is made of the mirror image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GlossyMethod {
    /// A kernel of its own for every pixel (Bastos 1999, §7.4.2.2).
    #[default]
    Variant,
    /// One kernel for each reflector (§7.4.2.1).
    Invariant,
    /// No convolution: the mirror image.
    Sharp,
}

impl GlossyMethod {
    /// Every method.
    pub const ALL: [Self; 3] = [Self::Variant, Self::Invariant, Self::Sharp];

    /// Name on the command line and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Variant => "variant",
            Self::Invariant => "invariant",
            Self::Sharp => "sharp",
        }
    }
}
