//! What a visual task asks of the light on it, and how a measurement falls short.

use super::Statistics;
use std::fmt;

/// What is asked of the illuminance on a task area; whatever is `None` is not asked for.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Requirement {
    /// The task.
    pub task: String,
    /// Smallest mean illuminance, lx: the maintained illuminance Ēₘ of EN 12464-1.
    pub mean_lx: Option<f32>,
    /// Smallest illuminance anywhere, lx.
    pub min_lx: Option<f32>,
    /// Largest illuminance anywhere, lx.
    pub max_lx: Option<f32>,
    /// Smallest uniformity U₀ = E_min / Ē.
    pub uniformity: Option<f32>,
}

/// A requirement that many spaces share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// The task.
    pub task: &'static str,
    /// Smallest mean illuminance, lx.
    pub mean_lx: Option<f32>,
    /// Largest illuminance, lx.
    pub max_lx: Option<f32>,
    /// Smallest uniformity.
    pub uniformity: Option<f32>,
    /// Where the numbers come from.
    pub source: &'static str,
}

const fn task(task: &'static str, mean_lx: f32, uniformity: f32, source: &'static str) -> Preset {
    Preset { task, mean_lx: Some(mean_lx), max_lx: None, uniformity: Some(uniformity), source }
}

const fn sensitive(task: &'static str, max_lx: f32) -> Preset {
    let source = "CIE 157:2004, light-responsive materials";
    Preset { task, mean_lx: None, max_lx: Some(max_lx), uniformity: None, source }
}

/// Usual tasks. From EN 12464-1:2011, tables 5.1 to 5.36; the numbers of an entry are those of the standard's
/// row that `source` names. National rules and later editions may ask for more: check before you rely on it.
pub const PRESETS: &[Preset] = &[
    task("Corridor", 100.0, 0.4, "EN 12464-1:2011, 5.1.1"),
    task("Stairs", 100.0, 0.4, "EN 12464-1:2011, 5.1.2 (150 lx in the edition of 2002)"),
    task("Canteen, pantry", 200.0, 0.4, "EN 12464-1:2011, 5.2.1"),
    task("Archive", 200.0, 0.4, "EN 12464-1:2011, 5.26.7"),
    task("Filing, copying", 300.0, 0.4, "EN 12464-1:2011, 5.26.1"),
    task("Reception desk", 300.0, 0.6, "EN 12464-1:2011, 5.26.6"),
    task("Classroom", 300.0, 0.6, "EN 12464-1:2011, 5.36.1"),
    task("Writing, reading, screens", 500.0, 0.6, "EN 12464-1:2011, 5.26.2"),
    task("Meeting room", 500.0, 0.6, "EN 12464-1:2011, 5.26.5"),
    task("Technical drawing", 750.0, 0.7, "EN 12464-1:2011, 5.26.3"),
    sensitive("Exhibit: works on paper, textiles", 50.0),
    sensitive("Exhibit: oil paint, wood", 200.0),
];

impl Preset {
    /// As a requirement of one's own.
    pub fn requirement(&self) -> Requirement {
        Requirement {
            task: self.task.into(),
            mean_lx: self.mean_lx,
            min_lx: None,
            max_lx: self.max_lx,
            uniformity: self.uniformity,
        }
    }
}

/// The preset of a task.
pub fn preset(task: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|p| p.task.eq_ignore_ascii_case(task))
}

/// One way in which light is not as it should be.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub enum Shortfall {
    /// The mean is too small.
    Mean {
        /// Mean found, lx.
        found_lx: f32,
        /// Mean asked for, lx.
        wanted_lx: f32,
    },
    /// The darkest point is too dark.
    Dark {
        /// Smallest found, lx.
        found_lx: f32,
        /// Smallest allowed, lx.
        wanted_lx: f32,
    },
    /// The brightest point is too bright.
    Bright {
        /// Largest found, lx.
        found_lx: f32,
        /// Largest allowed, lx.
        wanted_lx: f32,
    },
    /// The light is too uneven.
    Uneven {
        /// U₀ found.
        found: f32,
        /// U₀ asked for.
        wanted: f32,
    },
    /// Nothing could be measured.
    Nothing,
}

impl fmt::Display for Shortfall {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Self::Mean { found_lx, wanted_lx } => {
                write!(f, "too little light: mean {found_lx:.0} lx of {wanted_lx:.0} lx")
            }
            Self::Dark { found_lx, wanted_lx } => {
                write!(f, "too dark in places: down to {found_lx:.0} lx, {wanted_lx:.0} lx at least")
            }
            Self::Bright { found_lx, wanted_lx } => {
                write!(f, "too much light: up to {found_lx:.0} lx, {wanted_lx:.0} lx at most")
            }
            Self::Uneven { found, wanted } => {
                write!(f, "too uneven: U₀ {found:.2}, {wanted:.2} at least")
            }
            Self::Nothing => write!(f, "nothing could be measured: every point is inside something"),
        }
    }
}

impl Requirement {
    /// Whether it asks for nothing.
    pub fn is_empty(&self) -> bool {
        self.mean_lx.is_none() && self.min_lx.is_none() && self.max_lx.is_none() && self.uniformity.is_none()
    }

    /// Whether every number in it can be compared with.
    pub fn is_finite(&self) -> bool {
        let all = [self.mean_lx, self.min_lx, self.max_lx, self.uniformity];
        all.into_iter().flatten().all(|v| v.is_finite() && v >= 0.0)
    }

    /// What a measurement lacks; empty where all is well. A value that is not a number is never well.
    pub fn shortfalls(&self, statistics: Option<&Statistics>) -> Vec<Shortfall> {
        if self.is_empty() {
            return Vec::new();
        }
        let Some(s) = statistics else { return vec![Shortfall::Nothing] };
        let (mean, dark, bright, even) = (s.mean_lx, s.min_lx, s.max_lx, s.uniformity);
        let less = |found: f32, wanted: Option<f32>| wanted.filter(|w| found.is_nan() || found < *w);
        let more = |found: f32, wanted: Option<f32>| wanted.filter(|w| found.is_nan() || found > *w);
        [
            less(mean, self.mean_lx).map(|wanted_lx| Shortfall::Mean { found_lx: mean, wanted_lx }),
            less(dark, self.min_lx).map(|wanted_lx| Shortfall::Dark { found_lx: dark, wanted_lx }),
            more(bright, self.max_lx).map(|wanted_lx| Shortfall::Bright { found_lx: bright, wanted_lx }),
            less(even, self.uniformity).map(|wanted| Shortfall::Uneven { found: even, wanted }),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
