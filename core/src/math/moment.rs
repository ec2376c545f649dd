//! Orders of irradiance moments, and the lobe each weighs radiance with (Greger 1996, Eq. 4.8, Fig. 4.14).

use std::{fmt, str::FromStr};

/// Order of a moment: exponent of the cosine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Order {
    /// cosⁿ, n from 1 to [`Order::HIGHEST`]; 1 is irradiance.
    Finite(u32),
    /// The direction itself: π times radiance.
    Infinite,
}

impl Default for Order {
    fn default() -> Self {
        Self::IRRADIANCE
    }
}

impl Order {
    /// Order 1.
    pub const IRRADIANCE: Self = Self::Finite(1);

    /// Orders of Fig. 4.14 and 4.15.
    pub const THESIS: [Self; 6] = [
        Self::Finite(1),
        Self::Finite(2),
        Self::Finite(4),
        Self::Finite(10),
        Self::Finite(100),
        Self::Infinite,
    ];

    /// Highest finite order: its lobe is a degree wide.
    pub const HIGHEST: u32 = 10_000;

    /// Weight of radiance from an angle with this cosine, (n + 1)/2 max(0, cos)ⁿ; its integral over the
    /// sphere is π. Infinite at the middle of order ∞ and 0 elsewhere.
    pub fn weight(self, cosine: f32) -> f32 {
        match self {
            Self::Finite(n) => 0.5 * (n + 1) as f32 * cosine.max(0.0).powi(n as i32),
            Self::Infinite if cosine >= 1.0 => f32::INFINITY,
            Self::Infinite => 0.0,
        }
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finite(n) => n.fmt(f),
            Self::Infinite => f.write_str("∞"),
        }
    }
}

impl FromStr for Order {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "∞" | "inf" | "infinite" => Ok(Self::Infinite),
            number => match number.parse() {
                Ok(n) if (1..=Self::HIGHEST).contains(&n) => Ok(Self::Finite(n)),
                _ => Err(format!("`{text}` is not a moment's order: 1 to {}, or inf", Self::HIGHEST)),
            },
        }
    }
}

impl TryFrom<String> for Order {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Order> for String {
    fn from(order: Order) -> Self {
        match order {
            Order::Finite(n) => n.to_string(),
            Order::Infinite => "inf".into(),
        }
    }
}
