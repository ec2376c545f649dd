//! What picture is wanted: what it depends on, told apart by what a change costs.

use crate::session::Compare;
use lumenscope_core::{
    inspection::InspectionScene,
    math::{
        colour::luminance,
        false_colour::{FalseColour, Palette},
        image::LinearImage,
    },
    scene::camera::Camera,
    superposition::{
        composite::{DirectQuality, Display},
        layers::Weights,
    },
    transport::LightTransportSolution,
};
use std::sync::Arc;

/// Frames in the running mean of a picture at rest.
pub const FRAMES_AT_REST: u32 = 64;

/// A picture that is wanted.
#[derive(Clone)]
pub struct Request {
    /// The light.
    pub solution: Arc<LightTransportSolution>,
    /// Where from.
    pub camera: Camera,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Direct light at rest.
    pub direct: DirectQuality,
    /// Weight of each layer.
    pub weights: Weights,
    /// From radiance to display, exposure settled.
    pub display: Display,
    /// What is drawn over it.
    pub inspection: Option<Arc<InspectionScene>>,
    /// Picture, reference or difference.
    pub compare: Compare,
    /// The reference, for the difference.
    pub reference: Option<Arc<LinearImage>>,
    /// Object to outline.
    pub highlighted: Option<u32>,
}

/// Something shared, equal only to itself; holding it keeps its address from being used again.
#[derive(Clone)]
pub struct Same<T>(pub Option<Arc<T>>);

impl<T> PartialEq for Same<T> {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        }
    }
}

/// What a new frame depends on.
#[derive(Clone, PartialEq)]
pub struct RenderKey {
    solution: Same<LightTransportSolution>,
    camera: Camera,
    size: [u32; 2],
    direct: DirectQuality,
}

/// What bringing a frame to the display depends on.
#[derive(Clone, PartialEq)]
pub struct DisplayKey {
    weights: Weights,
    display: Display,
    inspection: Same<InspectionScene>,
    difference: bool,
    reference: Same<LinearImage>,
    highlighted: Option<u32>,
}

impl Request {
    /// What a new frame depends on.
    pub fn render_key(&self) -> RenderKey {
        RenderKey {
            solution: Same(Some(self.solution.clone())),
            camera: self.camera,
            size: self.size,
            direct: self.direct,
        }
    }

    /// What bringing it to the display depends on.
    pub fn display_key(&self) -> DisplayKey {
        DisplayKey {
            weights: self.weights,
            display: self.display,
            inspection: Same(self.inspection.clone()),
            difference: self.compare == Compare::Difference,
            reference: Same(self.reference.clone()),
            highlighted: self.highlighted,
        }
    }

    /// Palette and range of the inspection views, in their legend's unit.
    pub fn inspection_colours(&self) -> FalseColour {
        let palette = self.display.false_colour.map_or(Palette::default(), |f| f.palette);
        inspection_colours(self.inspection.as_deref(), palette)
    }

    /// Frames that are worth taking at rest.
    pub fn frames_wanted(&self) -> u32 {
        FRAMES_AT_REST
    }
}

/// Palette and range of inspection views, in their legend's unit.
///
/// Values that spread over more than a decade around their median, as those beside a lamp do, are
/// shown by their logarithm, two decades down from the largest.
pub fn inspection_colours(inspection: Option<&InspectionScene>, palette: Palette) -> FalseColour {
    let [low, high] = inspection.and_then(|i| i.legend.as_ref()).map_or([0.0, 1.0], |l| l.range);
    let high = if high > low { high } else { low + 1.0 };
    let median = inspection.and_then(median);
    match median {
        Some(median) if low >= 0.0 && median > 0.0 && high > 20.0 * median => {
            let bottom = (0.05 * median).max(low).max(1e-4 * high);
            FalseColour { palette, low: bottom, high, logarithmic: true }
        }
        _ => FalseColour::over([low, high], palette),
    }
}

/// Median luminance over at most a few thousand of the values shown.
fn median(inspection: &InspectionScene) -> Option<f32> {
    let bins = &inspection.sphere_bins;
    let vertices = inspection.meshes.iter().flat_map(|m| &m.values);
    let stride = (bins.len() / 2048).max(1);
    let mut values: Vec<f32> =
        bins.iter().step_by(stride).chain(vertices.take(2048)).map(|v| luminance(*v)).collect();
    values.retain(|v| v.is_finite() && *v > 0.0);
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}
