//! Parts of the light: direct, indirect, both.

/// Which part of the light is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Part {
    /// Straight from the emitters.
    Direct,
    /// After at least one bounce.
    Indirect,
    /// Both.
    #[default]
    All,
}

impl Part {
    /// Whether it holds the direct or the indirect part; all holds both.
    pub fn holds(self, one: Self) -> bool {
        self == Self::All || self == one
    }
}
