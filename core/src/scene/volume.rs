//! Choices about the irradiance volume that a scene file or the user may fix.

/// What a query reads: bins or spherical harmonics. Both are kept, so changing it costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// Bilinear between the four bins around the normal.
    #[default]
    Bins,
    /// The one bin that holds the normal, as the thesis has it.
    NearestBin,
    /// Nine spherical-harmonic coefficients.
    Harmonics,
}

impl Basis {
    /// Every basis.
    pub const ALL: [Self; 3] = [Self::Bins, Self::NearestBin, Self::Harmonics];

    /// Name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bins => "bins, interpolated",
            Self::NearestBin => "nearest bin",
            Self::Harmonics => "nine harmonics",
        }
    }
}

/// What is done with samples inside solids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Repair {
    /// Left out: their neighbours share their weight.
    Mask,
    /// Filled with the light of the valid samples beside them.
    Dilate,
    /// Moved to the nearest free point within half a cell; masked where there is none.
    #[default]
    Relocate,
}

impl Repair {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::Mask, Self::Dilate, Self::Relocate];

    /// Name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mask => "mask",
            Self::Dilate => "dilate",
            Self::Relocate => "relocate",
        }
    }
}
