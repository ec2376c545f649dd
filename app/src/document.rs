//! The document: the open scene, what the user changed in it, and how it is looked at.

use crate::{
    copies::{Copies, CopyVolume},
    grid_view::SurfacePoint,
    placement::Placement,
};
use glam::{Affine3A, Vec3};
use lumenscope_core::{
    inspection::colours::ColourSettings,
    irradiance_volume::{
        dynamic_object::{Detail, Gloss},
        ignored::Ignored,
        inspect::ColourBy,
        moments::Order,
    },
    math::part::Part,
    measure::grid_texture::StageSettings,
    scene::{Scene, Target, camera::Camera, file::PlanOverrides},
    superposition::{
        composite::{DirectQuality, Display},
        layers::{COUNT, Weights},
    },
};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};

/// Everything a session file holds. Edits are undone and redone; the view is not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// Scene file, or `example:NAME` (see [`crate::examples`]); `None` before one is open.
    pub scene: Option<PathBuf>,
    /// What the user changed in the scene.
    pub edits: Edits,
    /// How it is looked at.
    pub view: View,
}

/// What the user changed in the scene; whatever is not listed is as the file says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Edits {
    /// Model files added as movable objects, in the order they were added.
    #[serde(default)]
    pub added: Vec<PathBuf>,
    /// Overrides of the rendering plan, instead of those of the scene file.
    #[serde(default)]
    pub plan: Option<PlanOverrides>,
    /// New placements.
    pub placements: BTreeMap<Target, Affine3A>,
    /// New dimmers.
    pub dimmers: BTreeMap<Target, f32>,
    /// Where illuminance is measured, and what is asked of it.
    #[serde(default)]
    pub placement: Placement,
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
    #[serde(deserialize_with = "weights")]
    pub weights: Weights,
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
    /// Whether the point is shown at every resolution of the thesis.
    #[serde(default)]
    pub probe_resolutions: bool,
    /// Whether the moments there are shown.
    #[serde(default)]
    pub probe_moments: bool,
    /// An order shown beside those of the thesis.
    #[serde(default)]
    pub probe_order: Option<Order>,
    /// Ids of the inspection views switched on (see `registry`).
    pub views: Vec<String>,
    /// How the values they show become colours.
    #[serde(default)]
    pub colours: ColourSettings,
    /// Two copies of something, lit by two volumes.
    #[serde(default)]
    pub copies: Option<Copies>,
    /// Order of the volume's moment by which movable objects shine; `None` where they are diffuse.
    #[serde(default)]
    pub gloss: Option<Order>,
    /// How finely moved objects ask the volume; chosen by what time there is where `None`.
    #[serde(default)]
    pub detail: Option<Detail>,
    /// The point that was clicked last.
    #[serde(default)]
    pub surface: Option<SurfacePoint>,
    /// How the stages of its texture are made.
    #[serde(default)]
    pub stages: StageSettings,
    /// Whether they are held against the path tracer.
    #[serde(default)]
    pub traced_texture: bool,
    /// Light-path expression that says what is shown; all paths where it is empty.
    #[serde(default)]
    pub paths: String,
}

impl VolumeView {
    /// What the volume that is compared with leaves out.
    pub fn left_out(&self) -> Ignored {
        Ignored { materials: self.ignored_materials.clone(), ..Ignored::of(self.ignored.iter().copied()) }
    }
}

impl View {
    /// Whether an inspection view is switched on.
    pub fn shows(&self, id: &str) -> bool {
        self.views.iter().any(|v| v == id)
    }

    /// Switches an inspection view on or off.
    pub fn show(&mut self, id: &str, on: bool) {
        self.views.retain(|v| v != id);
        if on {
            self.views.push(id.to_owned());
        }
    }

    /// The moments that are shown of the open spheres: an order beside those of the thesis, and the part.
    pub fn moments(&self) -> Option<(Option<Order>, Part)> {
        self.probe_moments.then_some((self.probe_order, self.probe_part))
    }

    /// How movable objects shine, seen from the camera.
    pub fn gloss(&self) -> Option<Gloss> {
        Some(Gloss { order: self.gloss?, eye: self.camera.eye })
    }
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
    /// What an observer notices who flips between the two (FLIP), false colour.
    Flip,
}

impl Compare {
    /// Whether the picture is held against the reference, pixel by pixel.
    pub fn is_comparison(self) -> bool {
        matches!(self, Self::Difference | Self::Flip)
    }
}

/// What the volume is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Against {
    /// The present one without the light of some surfaces and lamps.
    #[default]
    Ignoring,
    /// The present one as it is.
    Present,
    /// A volume that was kept, by its number.
    Kept(usize),
}

/// The volume shown as spheres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
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
    /// Surfaces and lamps whose light the volume it is compared with leaves out.
    #[serde(default)]
    pub ignored: BTreeSet<Target>,
    /// Materials whose light it leaves out too, by their indices.
    #[serde(default)]
    pub ignored_materials: BTreeSet<u32>,
    /// The volume that is shown and compared.
    #[serde(default)]
    pub of: CopyVolume,
    /// What it is compared with.
    #[serde(default)]
    pub against: Against,
    /// What the spheres are coloured by.
    pub colour_by: ColourBy,
    /// Order of the moment that is shown, where the volume holds it.
    pub moment: Order,
}

impl Default for VolumeView {
    fn default() -> Self {
        Self {
            shown: false,
            size: 0.16,
            first_level: true,
            second_level: true,
            part: Part::All,
            radiance: false,
            slice: None,
            ignored: BTreeSet::new(),
            ignored_materials: BTreeSet::new(),
            of: CopyVolume::Present,
            against: Against::Ignoring,
            colour_by: ColourBy::Light,
            moment: Order::IRRADIANCE,
        }
    }
}

impl Default for View {
    fn default() -> Self {
        Self {
            camera: Camera::default(),
            display: Display::default(),
            auto_exposure: true,
            weights: [1.0; COUNT],
            direct: DirectQuality::PerPixel(4),
            compare: Compare::Picture,
            volume: VolumeView::default(),
            selected: None,
            probe: None,
            probe_bins_n: 17,
            probe_part: Part::All,
            probe_resolutions: false,
            probe_moments: false,
            probe_order: None,
            views: Vec::new(),
            colours: ColourSettings::default(),
            copies: None,
            gloss: None,
            detail: None,
            surface: None,
            stages: StageSettings::default(),
            traced_texture: false,
            paths: String::new(),
        }
    }
}

impl Edits {
    /// The scene with these edits made, the added models in it already; edits of targets it does not
    /// have are passed over.
    pub fn applied(&self, base: &Scene) -> Scene {
        let mut scene = base.clone();
        if let Some(plan) = &self.plan {
            scene.plan = plan.clone();
        }
        for (&target, &placement) in &self.placements {
            if is_movable(&scene, target) {
                scene.place(target, placement);
            }
        }
        for (&target, &dimmer) in &self.dimmers {
            match target {
                Target::Object(i) if i < scene.objects.len() => scene.objects[i].dimmer = dimmer,
                Target::Lamp(i) if i < scene.lamps.len() => scene.lamps[i].dimmer = dimmer,
                _ => {}
            }
        }
        scene
    }

    /// Drops whatever a scene cannot follow; returns one line for each.
    pub fn retain_valid(&mut self, scene: &Scene) -> Vec<String> {
        let mut dropped = Vec::new();
        if let Some((name, value)) = self.plan.as_ref().and_then(PlanOverrides::problem) {
            dropped.push(format!("overrides of the plan left out: {name} is {value}"));
            self.plan = None;
        }
        self.placements.retain(|&target, placement| {
            let problem = place_problem(scene, target, placement);
            dropped.extend(problem.iter().map(|p| format!("placement of {target:?} left out: {p}")));
            problem.is_none()
        });
        self.dimmers.retain(|&target, dimmer| {
            let problem = dim_problem(scene, target, *dimmer);
            dropped.extend(problem.iter().map(|p| format!("dimmer of {target:?} left out: {p}")));
            problem.is_none()
        });
        if let Some(problem) = self.placement.problem(scene) {
            dropped.push(format!("where illuminance is measured was left out: {problem}"));
            self.placement = Placement::default();
        }
        dropped
    }
}

impl View {
    /// Whether every number in it can be drawn with.
    pub fn is_finite(&self) -> bool {
        let c = &self.camera;
        let false_colour = self
            .display
            .false_colour
            .is_none_or(|f| f.low.is_finite() && f.high.is_finite() && f.high > f.low);
        let probe = self.probe.is_none_or(|(p, n)| p.is_finite() && n.is_finite() && n != Vec3::ZERO);
        c.eye.is_finite()
            && c.target.is_finite()
            && c.eye != c.target
            && c.up.is_finite()
            && c.vertical_fov.is_finite()
            && (0.01..3.1).contains(&c.vertical_fov)
            && self.display.ev100.is_finite()
            && self.weights.iter().all(|w| w.is_finite())
            && self.volume.size.is_finite()
            && (1..=64).contains(&self.probe_bins_n)
            && false_colour
            && probe
            && self.colours.is_usable()
            && self.copies.is_none_or(|c| c.is_finite())
    }
}

/// Whether a target exists in a scene.
pub fn exists(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Object(i) => i < scene.objects.len(),
        Target::Lamp(i) => i < scene.lamps.len(),
    }
}

/// Whether a target exists and may be dragged; every lamp without a surface may.
pub fn is_movable(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Object(i) => scene.objects.get(i).is_some_and(|o| o.movable),
        Target::Lamp(i) => i < scene.lamps.len(),
    }
}

/// Why a placement cannot be taken, if it cannot.
pub fn place_problem(scene: &Scene, target: Target, placement: &Affine3A) -> Option<&'static str> {
    /// Farther than this from the origin, single-precision positions are coarser than a centimetre.
    const FARTHEST_M: f32 = 1e5;
    if !exists(scene, target) {
        return Some("the scene has no such object or lamp");
    }
    if !is_movable(scene, target) {
        return Some("it is fixed; list it under `movable` in the scene file to drag it");
    }
    if !placement.is_finite() {
        return Some("the placement is not a finite number");
    }
    if placement.translation.length() > FARTHEST_M {
        return Some("it lies farther than 100 km from the origin");
    }
    let determinant = placement.matrix3.determinant();
    (!(1e-12..1e12).contains(&determinant.abs())).then_some("the placement flattens it")
}

/// Why a dimmer cannot be taken, if it cannot.
pub fn dim_problem(scene: &Scene, target: Target, dimmer: f32) -> Option<&'static str> {
    if !exists(scene, target) {
        return Some("the scene has no such object or lamp");
    }
    if !scene.emits(target) {
        return Some("it emits no light");
    }
    (!(0.0..=MOST_DIMMER).contains(&dimmer)).then_some("a dimmer lies between 0 and 10")
}

/// Most a lamp can be raised over what the file says.
pub const MOST_DIMMER: f32 = 10.0;

/// Weights of layers; those that an older session does not name are 1.
fn weights<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Weights, D::Error> {
    struct Visitor;
    impl<'de> serde::de::Visitor<'de> for Visitor {
        type Value = Weights;
        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            write!(f, "at most {COUNT} numbers")
        }
        fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut values: A) -> Result<Weights, A::Error> {
            let mut weights = [1.0; COUNT];
            for weight in &mut weights {
                match values.next_element()? {
                    Some(value) => *weight = value,
                    None => break,
                }
            }
            Ok(weights)
        }
    }
    deserializer.deserialize_tuple(COUNT, Visitor)
}
