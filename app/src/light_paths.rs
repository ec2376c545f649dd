//! Which light is shown: the view's light-path expression, read once when it changes.
//!
//! The layers show an expression where a sum of them is its light; the path tracer shows every one. So weights
//! follow the expression and never contradict it, and a picture is held against a reference only of the same
//! light.

use lumenscope_core::{
    reference::expression::{Expression, ExpressionError},
    superposition::layers::{COUNT, Weights},
};

/// A light-path expression and what can show it.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LightPaths {
    /// All light: there is no expression.
    #[default]
    All,
    /// The light of an expression.
    Some {
        /// The expression.
        expression: Box<Expression>,
        /// Weights by which the layers show it; `None` where no weights do.
        weights: Option<Weights>,
    },
    /// What was typed is no expression.
    Unreadable(ExpressionError),
}

impl LightPaths {
    /// Reads what was typed; nothing is all light.
    pub fn read(text: &str) -> Self {
        if text.trim().is_empty() {
            return Self::All;
        }
        match text.parse::<Expression>() {
            Ok(expression) => {
                let weights = |[emitted, direct, indirect, specular]: [bool; 4]| {
                    [emitted, direct, indirect, specular, specular].map(|on| f32::from(u8::from(on)))
                };
                let weights = expression.of_terms().map(weights);
                Self::Some { expression: Box::new(expression), weights }
            }
            Err(error) => Self::Unreadable(error),
        }
    }

    /// Weights by which the layers show this light; `None` where no weights do.
    pub fn weights(&self) -> Option<Weights> {
        match self {
            Self::All => Some([1.0; COUNT]),
            Self::Some { weights, .. } => *weights,
            Self::Unreadable(_) => None,
        }
    }

    /// Whether the picture can be held against a reference of the same light. What cannot be read changes
    /// neither of them.
    pub fn is_comparable(&self) -> bool {
        !matches!(self, Self::Some { weights: None, .. })
    }

    /// The paths that a reference counts: all of them without an expression.
    ///
    /// # Errors
    /// Where what was typed is no expression: then there is nothing to trace.
    pub fn traced(&self) -> Result<Option<&Expression>, &ExpressionError> {
        match self {
            Self::All => Ok(None),
            Self::Some { expression, .. } => Ok(Some(expression)),
            Self::Unreadable(error) => Err(error),
        }
    }
}
