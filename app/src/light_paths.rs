//! Which light is shown: the view's light-path expression, read once when it changes.
//!
//! The layers show an expression where a sum of them is its light; the path tracer shows every one. So weights
//! follow the expression and never contradict it, and a picture is held against a reference only of the same
//! light.

use lumenscope_core::{
    reference::expression::{Expression, ExpressionError},
    scene::Scene,
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
    /// Reads what was typed; nothing is all light. In a `dull` scene, in which nothing is specular, radiosity tells
    /// every expression's light apart.
    pub fn read(text: &str, dull: bool) -> Self {
        if text.trim().is_empty() {
            return Self::All;
        }
        match text.parse::<Expression>() {
            Ok(expression) => {
                let weights = |[emitted, direct, indirect, specular]: [bool; 4]| {
                    [emitted, direct, indirect, specular, specular].map(|on| f32::from(u8::from(on)))
                };
                let terms = expression.of_terms().or_else(|| dull.then(|| expression.bounces().terms()));
                let weights = terms.map(weights);
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

    /// The expression if it means single bounces that radiosity tells apart.
    pub fn single_bounces(&self) -> Option<&Expression> {
        match self {
            Self::Some { expression, weights: Some(_) } => {
                Some(&**expression).filter(|e| e.of_terms().is_none())
            }
            _ => None,
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

/// Whether nothing in a scene is specular.
pub fn is_dull(scene: &Scene) -> bool {
    !scene.materials.iter().any(|m| m.is_specular())
}
