//! How glossy reflections are made: settings that scene files name. The room `glossy` does it.

use serde::{Deserialize, Serialize};

/// How the layer `glossy` is made: of the mirror image, or of particles of light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GlossyMethod {
    /// A kernel of its own for every pixel (Bastos 1999, §7.4.2.2).
    #[default]
    Variant,
    /// The same at every second pixel of every second row, and between them; in full where the kernel is small.
    VariantHalf,
    /// One kernel for each reflector (§7.4.2.1).
    Invariant,
    /// No convolution: the mirror image.
    Sharp,
    /// In object space: particles of light on glossy surfaces, flat or curved, straight light apart (§7.3).
    Particles,
}

impl GlossyMethod {
    /// Every method.
    pub const ALL: [Self; 5] =
        [Self::Variant, Self::VariantHalf, Self::Invariant, Self::Sharp, Self::Particles];

    /// Those that make it of the mirror image.
    pub const OF_IMAGE: [Self; 4] = [Self::Variant, Self::VariantHalf, Self::Invariant, Self::Sharp];

    /// What it does, for the plan.
    pub fn words(self) -> &'static str {
        match self {
            Self::Variant => "a kernel of its own for every pixel",
            Self::VariantHalf => "a kernel of its own for every second pixel of every second row",
            Self::Invariant => "one kernel a reflector",
            Self::Sharp => "no convolution",
            Self::Particles => "particles of light in object space, straight light at every pixel",
        }
    }

    /// Name on the command line and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Variant => "variant",
            Self::VariantHalf => "variant_half",
            Self::Invariant => "invariant",
            Self::Sharp => "sharp",
            Self::Particles => "particles",
        }
    }
}
