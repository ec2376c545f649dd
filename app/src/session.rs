//! The session: a document with the scene it names, the light in it, and the way commands change both.
//!
//! No window, no threads and no files here: [`Session::apply`] changes what can be changed at once and
//! returns [`Effect`]s for the rest, so that a test can throw commands at it. Not a store of callbacks:
//! data goes down to the panels, commands come up.

mod effect;
mod kept;
mod look;

pub use crate::document::{Against, Compare, Document, Edits, View, VolumeView};
pub use effect::Effect;
pub use kept::{Kept, NamedVolume};

use crate::{
    command::Command,
    document::{dim_problem, exists, place_problem},
    grid_view::GridView,
    history::{History, Key},
    journal::Journal,
    light_paths::{LightPaths, is_dull},
    lightmaps::{JudgedLightmap, LightmapFile},
    widgets::{Probe, moments::Spheres},
};
use lumenscope_core::{
    inspection::InspectionScene,
    irradiance_volume::placement::Measurement,
    math::image::LinearImage,
    scene::{Scene, Target},
    superposition::plan::Plan,
    transport::LightTransportSolution,
};
use std::{path::PathBuf, sync::Arc};

/// A document with the scene it names and the light in it.
#[derive(Default)]
pub struct Session {
    /// What a session file would hold.
    pub document: Document,
    /// File it was saved to or opened from.
    pub file: Option<PathBuf>,
    /// Undo and redo of the document's edits.
    pub history: History,
    /// The scene as its files say, with the models added.
    pub base: Option<Arc<Scene>>,
    /// The scene with the edits made.
    pub scene: Option<Arc<Scene>>,
    /// Its light, possibly of an earlier edit.
    pub solution: Option<Arc<LightTransportSolution>>,
    /// Which light the view's expression asks for.
    pub light_paths: LightPaths,
    /// The reference picture so far, cd/m².
    pub reference: Option<Reference>,
    /// The open spheres.
    pub probe: Option<Arc<Probe>>,
    /// The same point at every resolution of the thesis, coarsest first; empty unless asked for.
    pub resolutions: Arc<Vec<Probe>>,
    /// The moments there; `None` unless asked for.
    pub moments: Option<Arc<Spheres>>,
    /// The texture of the surface that was clicked; `None` where that has none.
    pub texture: Option<Arc<GridView>>,
    /// Whether that of a surface clicked since is still to come.
    pub texture_awaited: bool,
    /// The lightmap that is looked at.
    pub lightmap_file: Option<LightmapFile>,
    /// What was found about it in the light as it settled last.
    pub lightmap: Option<Arc<JudgedLightmap>>,
    /// What the scene needs, and why.
    pub plan: Option<Arc<Plan>>,
    /// Illuminance where it is measured.
    pub measurement: Option<Arc<Measurement>>,
    /// Volumes kept to be compared with; they last until another scene is opened.
    pub kept: Vec<Kept>,
    /// How many volumes were ever kept of this scene: no two have the same name.
    kept_so_far: usize,
    /// What the views switched on put into the scene.
    pub inspection: Option<Arc<InspectionScene>>,
    /// What happened.
    pub log: Journal,
    /// The scene for each list of added models that undo and redo can come back to.
    bases: Vec<(Vec<PathBuf>, Arc<Scene>)>,
    /// Moved objects that were said to lie outside the irradiance volume.
    outside: Vec<u32>,
    saved: Edits,
}

/// The reference picture so far.
#[derive(Clone)]
pub struct Reference {
    /// Mean of the samples, cd/m².
    pub image: Arc<LinearImage>,
    /// Samples a pixel.
    pub samples: u32,
}

impl Session {
    /// Whether there is something a save would keep.
    pub fn is_dirty(&self) -> bool {
        self.document.edits != self.saved
    }

    /// Whether the light belongs to the scene with the edits made.
    pub fn is_lit_as_edited(&self) -> bool {
        match (&self.solution, &self.scene) {
            (Some(solution), Some(scene)) => Arc::ptr_eq(&solution.scene, scene),
            _ => false,
        }
    }

    /// Luminous flux of a lamp as it is dimmed now, lm (lx for parallel light).
    pub fn flux(&self, target: Target) -> Option<f32> {
        let (solution, scene) = (self.solution.as_ref()?, self.scene.as_ref()?);
        let dimmer = |scene: &Scene| match target {
            Target::Object(i) => scene.objects.get(i).map(|o| o.dimmer),
            Target::Lamp(i) => scene.lamps.get(i).map(|l| l.dimmer),
        };
        let (was, is) = (dimmer(&solution.scene)?, dimmer(scene)?);
        let list = &solution.world.emitters.list;
        let flux: f32 = list.iter().filter(|e| e.target() == target).map(|e| e.flux()).sum();
        if was == is { Some(flux) } else { (was > 0.0).then(|| flux * is / was) }
    }

    /// Takes better light. An object moved out of the irradiance volume is named once, until it comes back.
    pub fn take_light(&mut self, light: Arc<LightTransportSolution>) {
        let mut outside = Vec::new();
        if let Some(volume) = &light.volume {
            let geometry = &light.world.geometry;
            for &object in &light.moved_objects {
                let range = geometry.object_triangles[object as usize].clone();
                let corners = range.flat_map(|t| geometry.positions[t as usize]);
                let Some(metres) = volume.beyond(corners) else { continue };
                outside.push(object);
                if !self.outside.contains(&object) {
                    let name = light.scene.objects.get(object as usize).map_or("object", |o| o.name.as_str());
                    self.log.warn(format!(
                        "{name} reaches {metres:.2} m outside the irradiance volume: the nearest samples light it there"
                    ));
                }
            }
        }
        self.outside = outside;
        self.solution = Some(light);
    }

    /// Marks the document as written to `file`.
    pub fn set_saved(&mut self, file: PathBuf) {
        self.file = Some(file);
        self.saved = self.document.edits.clone();
    }

    /// Takes a scene that has been loaded for `document`; a document that names no camera of its own
    /// (`fresh`) takes the scene's.
    pub fn open(&mut self, mut document: Document, scene: Arc<Scene>, file: Option<PathBuf>, fresh: bool) {
        for line in document.edits.retain_valid(&scene) {
            self.log.warn(line);
        }
        if fresh {
            document.view = View { camera: scene.camera, ..View::default() };
        }
        if !document.view.is_finite() {
            self.log.warn("the view in the session file was not usable: the scene's own view is shown");
            document.view = View { camera: scene.camera, ..View::default() };
        }
        document.view.copies = document.view.copies.filter(|c| c.fits(&scene));
        document.view.selected = document.view.selected.filter(|&t| exists(&scene, t));
        self.scene = Some(Arc::new(document.edits.applied(&scene)));
        self.bases = vec![(document.edits.added.clone(), Arc::clone(&scene))];
        self.base = Some(scene);
        self.saved = document.edits.clone();
        self.light_paths = LightPaths::read(&document.view.paths, self.base.as_deref().is_some_and(is_dull));
        if !document.view.paths.is_empty() {
            document.view.weights = self.light_paths.weights().unwrap_or(document.view.weights);
        }
        self.document = document;
        self.file = file;
        self.history = History::default();
        self.solution = None;
        self.reference = None;
        self.probe = None;
        self.texture = None;
        self.texture_awaited = false;
        self.lightmap_file = None;
        self.lightmap = None;
        self.plan = None;
        self.measurement = None;
        self.inspection = None;
        self.kept.clear();
        self.kept_so_far = 0;
    }

    /// Takes the open scene with models added, as one step of the history.
    pub fn reopen(&mut self, added: Vec<PathBuf>, scene: Arc<Scene>) -> Vec<Effect> {
        self.bases.retain(|(models, _)| *models != added);
        self.bases.push((added.clone(), scene));
        let before = self.document.edits.clone();
        let after = Edits { added, ..before.clone() };
        self.history.edit(&mut self.document.edits, after, Key::Added, false);
        self.follow_edits(&before, false)
    }

    /// Carries a command out, as far as that needs no thread, no file and no window.
    pub fn apply(&mut self, command: Command) -> Vec<Effect> {
        match command {
            Command::Place { target, placement, dragging } => {
                let problem =
                    self.base.as_deref().map_or(Some(NOTHING_OPEN), |s| place_problem(s, target, &placement));
                let problem = problem.map(|p| format!("{}: {p}", self.name(target)));
                self.edit(Key::Place(target), dragging, problem, |e| {
                    e.placements.insert(target, placement);
                })
            }
            Command::Dim { target, dimmer, dragging } => {
                let problem =
                    self.base.as_deref().map_or(Some(NOTHING_OPEN), |s| dim_problem(s, target, dimmer));
                let problem = problem.map(|p| format!("{}: {p}", self.name(target)));
                self.edit(Key::Dim(target), dragging, problem, |e| {
                    e.dimmers.insert(target, dimmer);
                })
            }
            Command::Measure { placement, dragging } => {
                let problem =
                    self.base.as_deref().map_or(Some(NOTHING_OPEN), |scene| placement.problem(scene));
                let problem = problem.map(|p| format!("the measurement: {p}"));
                self.edit(Key::Placement, dragging, problem, |e| e.placement = *placement)
            }
            Command::Plan(overrides) => {
                let problem = match &self.base {
                    None => Some(NOTHING_OPEN.to_owned()),
                    Some(_) => {
                        overrides.problem().map(|(name, value)| format!("plan: {name} cannot be {value}"))
                    }
                };
                let of_file = self.base.as_ref().is_some_and(|base| base.plan == overrides);
                self.edit(Key::Plan, false, problem, |e| e.plan = (!of_file).then_some(overrides))
            }
            Command::EndDrag => {
                self.history.end_drag();
                if self.scene.is_some() { vec![Effect::Follow { dragging: false }] } else { Vec::new() }
            }
            Command::Undo => {
                let before = self.document.edits.clone();
                self.history.undo(&mut self.document.edits);
                self.follow_edits(&before, false)
            }
            Command::Redo => {
                let before = self.document.edits.clone();
                self.history.redo(&mut self.document.edits);
                self.follow_edits(&before, false)
            }
            Command::View(view) => self.look(*view),
            Command::Replace(document) => vec![Effect::Replace(document)],
            Command::Open(path) => vec![Effect::Load(path)],
            Command::OpenExample(example) => vec![Effect::LoadExample(example)],
            Command::AddModel(path) if self.base.is_some() => vec![Effect::AddModel(path)],
            Command::AddModel(path) => vec![Effect::Load(path)],
            Command::SaveSession(path) => self.if_open(Effect::Save(path)),
            Command::Export(what, path) => self.if_open(Effect::Export(what, path)),
            Command::Lightmap(file) => {
                if self.scene.is_some() {
                    self.lightmap = None;
                    self.lightmap_file = Some(file);
                }
                // What the views show of the one before goes with it.
                [self.if_open(Effect::Inspect), self.if_open(Effect::Lightmap)].concat()
            }
            Command::StartReference => match self.light_paths.traced() {
                Ok(_) => {
                    self.reference = None;
                    self.if_open(Effect::Reference)
                }
                Err(error) => {
                    self.log.warn(format!("no reference: {error}"));
                    Vec::new()
                }
            },
            Command::KeepVolume => {
                let volume = self.solution.as_ref().and_then(|s| s.volume.clone());
                match volume {
                    Some(volume) => self.keep(volume, "radiosity"),
                    None => self.log.warn("there is no volume to keep yet"),
                }
                vec![Effect::Inspect]
            }
            Command::ForgetVolume(number) => self.forget(number),
            Command::CompareWith(source) => self.if_open(Effect::OtherVolume(source)),
            Command::Cancel => {
                let traced = std::mem::take(&mut self.document.view.traced_texture);
                let mut effects = vec![Effect::Cancel];
                effects.extend(traced.then_some(Effect::Texture));
                effects
            }
            Command::Solve => self.if_open(Effect::Follow { dragging: false }),
            Command::Dialog(dialog) => vec![Effect::Dialog(dialog)],
            Command::Window(window) => vec![Effect::Window(window)],
        }
    }

    fn if_open(&mut self, effect: Effect) -> Vec<Effect> {
        if self.scene.is_some() {
            return vec![effect];
        }
        self.log.warn(NOTHING_OPEN);
        Vec::new()
    }

    fn edit(
        &mut self,
        key: Key,
        dragging: bool,
        problem: Option<String>,
        change: impl FnOnce(&mut Edits),
    ) -> Vec<Effect> {
        if let Some(problem) = problem {
            self.log.warn(problem);
            return Vec::new();
        }
        let mut after = self.document.edits.clone();
        change(&mut after);
        if after == self.document.edits {
            return Vec::new();
        }
        let before = self.document.edits.clone();
        self.history.edit(&mut self.document.edits, after, key, dragging);
        self.follow_edits(&before, dragging)
    }

    /// What a step from `before` asks for: the light follows the scene, the measurement its choice.
    fn follow_edits(&mut self, before: &Edits, dragging: bool) -> Vec<Effect> {
        let after = &self.document.edits;
        let measured = after.placement != before.placement;
        let lit = Edits { placement: before.placement.clone(), ..after.clone() } != *before;
        let mut effects = if lit { self.rebuild(dragging) } else { Vec::new() };
        effects.extend(measured.then_some(Effect::Measure));
        effects
    }

    fn rebuild(&mut self, dragging: bool) -> Vec<Effect> {
        let edits = &self.document.edits;
        let known = self.bases.iter().find(|(added, _)| *added == edits.added);
        let Some((_, base)) = known else { return Vec::new() };
        let scene = edits.applied(base);
        let view = &mut self.document.view;
        view.selected = view.selected.filter(|&t| exists(&scene, t));
        let copied = view.copies;
        view.copies = copied.filter(|c| c.fits(&scene));
        let mut effects = Vec::new();
        effects.extend((view.copies != copied).then_some(Effect::Copies));
        self.base = Some(Arc::clone(base));
        self.scene = Some(Arc::new(scene));
        // A model that was added may be polished.
        let dull = self.base.as_deref().is_some_and(is_dull);
        self.light_paths = LightPaths::read(&self.document.view.paths, dull);
        effects.push(Effect::Follow { dragging });
        effects.extend(self.outdate_reference());
        effects
    }

    fn name(&self, target: Target) -> String {
        match self.scene.as_deref() {
            Some(scene) if exists(scene, target) => scene.target_name(target).to_owned(),
            _ => format!("{target:?}"),
        }
    }
}

const NOTHING_OPEN: &str = "no scene is open";
