//! What picture is wanted: what it depends on, told apart by what a change costs.

use crate::session::Compare;
use lumenscope_core::{
    inspection::{InspectionScene, colours::ColourSettings},
    math::{false_colour::FalseColour, image::LinearImage},
    scene::camera::Camera,
    superposition::{
        composite::{DirectQuality, Display},
        layers::Weights,
        moved::MovedLight,
    },
    transport::LightTransportSolution,
};
use std::sync::{
    Arc, OnceLock,
    atomic::{AtomicBool, Ordering},
};

/// Frames in the running mean of a picture at rest.
pub const FRAMES_AT_REST: u32 = 64;

/// Light as it is shown, with the light on moved objects, which is made once for every frame of it.
pub struct Lit {
    /// The light, movable objects shining as the view wants them.
    pub solution: Arc<LightTransportSolution>,
    moved: OnceLock<MovedLight>,
    asked: AtomicBool,
}

impl Lit {
    /// Light whose moved objects nobody has looked at yet.
    pub fn new(solution: Arc<LightTransportSolution>) -> Arc<Self> {
        Arc::new(Self { solution, moved: OnceLock::new(), asked: AtomicBool::new(false) })
    }

    /// The light on moved objects; makes it where it is not there yet, so not for the window's own thread.
    pub fn moved(&self) -> &MovedLight {
        self.moved.get_or_init(|| MovedLight::new(&self.solution, true))
    }

    /// The light on moved objects if it is there; else it is made in the background and `ctx` then woken.
    pub fn ready(self: &Arc<Self>, ctx: &egui::Context) -> Option<&MovedLight> {
        let found = self.moved.get();
        if found.is_none() && !self.asked.swap(true, Ordering::Relaxed) {
            let (lit, ctx) = (self.clone(), ctx.clone());
            let spawned = std::thread::Builder::new().name("moved light".into()).spawn(move || {
                lit.moved();
                ctx.request_repaint();
            });
            if spawned.is_err() {
                return Some(self.moved());
            }
        }
        found
    }
}

/// A picture that is wanted.
#[derive(Clone)]
pub struct Request {
    /// The light.
    pub light: Arc<Lit>,
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
    /// How its values become colours.
    pub colours: ColourSettings,
    /// Picture, reference or difference.
    pub compare: Compare,
    /// The reference, for the difference.
    pub reference: Option<Arc<LinearImage>>,
    /// Object to outline.
    pub highlighted: Option<u32>,
}

/// Something shared, equal only to itself; holding it keeps its address from being used again.
pub struct Same<T>(pub Option<Arc<T>>);

impl<T> Clone for Same<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

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
    light: Same<Lit>,
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
    colours: ColourSettings,
    compare: Compare,
    reference: Same<LinearImage>,
    highlighted: Option<u32>,
}

impl Request {
    /// What a new frame depends on.
    pub fn render_key(&self) -> RenderKey {
        RenderKey {
            light: Same(Some(self.light.clone())),
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
            colours: self.colours,
            compare: self.compare,
            reference: Same(self.reference.clone()),
            highlighted: self.highlighted,
        }
    }

    /// Palette and range of the inspection views, in their legend's unit.
    pub fn inspection_colours(&self) -> FalseColour {
        match &self.inspection {
            Some(inspection) => inspection.colours(&self.colours),
            None => InspectionScene::default().colours(&self.colours),
        }
    }

    /// Frames that are worth taking at rest.
    pub fn frames_wanted(&self) -> u32 {
        FRAMES_AT_REST
    }
}
