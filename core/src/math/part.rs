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
