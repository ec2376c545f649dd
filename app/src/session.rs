//! The session: the open scene, what the user changed in it, and how it is looked at.

use glam::{Affine3A, Vec3};
use lumenscope_core::{
    math::part::Part,
    scene::{Target, camera::Camera},
    superposition::composite::{DirectQuality, Display},
};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::PathBuf};

/// Everything a session file holds. Edits are undone and redone; the view is not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// Scene file; `None` for the example built in.
    pub scene: Option<PathBuf>,
    /// What the user changed in the scene.
    pub edits: Edits,
    /// How it is looked at.
    pub view: View,
}

/// What the user changed in the scene; whatever is not listed is as the file says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Edits {
    /// New placements.
    pub placements: BTreeMap<Target, Affine3A>,
    /// New dimmers.
    pub dimmers: BTreeMap<Target, f32>,
}

/// How the scene is looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Camera of the viewport.
    pub camera: Camera,
    /// Exposure, tone, false colour.
    pub display: Display,
    /// Whether exposure follows the picture.
    pub auto_exposure: bool,
    /// Weight of each layer, in the order of `Layer::ALL`.
    pub weights: [f32; 3],
    /// Direct light a pixel, when at rest.
    pub direct: DirectQuality,
    /// Picture, reference or difference.
    pub compare: Compare,
    /// The volume shown as spheres.
    pub volume: VolumeView,
    /// What is selected.
    pub selected: Option<Target>,
    /// The point whose spheres are open: position and normal.
    pub probe: Option<(Vec3, Vec3)>,
    /// Rows of bins a hemisphere in the sphere inspector.
    pub probe_bins_n: u32,
    /// Part of the light in the sphere inspector.
    pub probe_part: Part,
    /// Ids of the inspection views switched on (see `registry`).
    pub views: Vec<String>,
}

/// What fills the viewport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Compare {
    /// The superposition renderer's picture.
    #[default]
    Picture,
    /// The path tracer's.
    Reference,
    /// Luminance difference, false colour.
    Difference,
}

/// The volume shown as spheres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VolumeView {
    /// Whether it is shown.
    pub shown: bool,
    /// Radius of a sphere as a share of its cell.
    pub size: f32,
    /// Show first-level samples.
    pub first_level: bool,
    /// Show second-level samples.
    pub second_level: bool,
    /// Part of the light shown.
    pub part: Part,
    /// Radiance instead of irradiance.
    pub radiance: bool,
    /// Only the samples of one slice: axis 0, 1, 2 and height in [0, 1].
    pub slice: Option<(u8, f32)>,
}

impl Default for VolumeView {
    fn default() -> Self {
        Self {
            shown: false,
            size: 0.25,
            first_level: true,
            second_level: true,
            part: Part::All,
            radiance: false,
            slice: None,
        }
    }
}

impl Default for View {
    fn default() -> Self {
        Self {
            camera: Camera::default(),
            display: Display::default(),
            auto_exposure: true,
            weights: [1.0; 3],
            direct: DirectQuality::PerPixel(4),
            compare: Compare::Picture,
            volume: VolumeView::default(),
            selected: None,
            probe: None,
            probe_bins_n: 17,
            probe_part: Part::All,
            views: Vec::new(),
        }
    }
}
