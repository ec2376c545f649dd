//! What the worker does with a scene: read it, solve it, picture it. No thread and no window here.

use crate::{document::Document, examples, session::Reference, session_file, widgets::Probe};
use anyhow::{Result, bail};
use glam::Vec3;
use lumenscope_core::{
    irradiance_volume::{IrradianceVolume, VolumeSettings},
    math::progress::Progress,
    radiosity::{RadiositySettings, RadiositySolution},
    reference::picture::ReferencePicture,
    scene::{Scene, camera::Camera, import, world::World},
    transport::{
        LightTransportSolution,
        solution::{Provenance, State},
    },
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// What is asked to be loaded.
#[derive(Clone, Debug)]
pub enum Source {
    /// A scene or session file.
    File(PathBuf),
    /// A document held in memory.
    Document(Box<Document>),
    /// The open document with other models added.
    Models(Box<Document>),
}

/// A scene that was loaded.
pub struct Loaded {
    /// The document it belongs to.
    pub document: Document,
    /// The session file it came from.
    pub session_file: Option<PathBuf>,
    /// The scene as its files say.
    pub scene: Arc<Scene>,
    /// Whether the document says nothing about the view.
    pub fresh: bool,
    /// Whether only models were added to what is open.
    pub added_only: bool,
}

/// Loads a scene, session or document.
///
/// # Errors
/// With the name of the file that cannot be read, and why.
pub fn load(source: Source, progress: &Progress) -> Result<Loaded> {
    progress.begin("reading");
    let added_only = matches!(source, Source::Models(_));
    let (document, session_file, fresh) = match source {
        Source::File(path) if session_file::is_session(&path) => {
            (session_file::read(&path)?, Some(path), false)
        }
        Source::File(path) => (Document { scene: Some(path), ..Document::default() }, None, true),
        Source::Document(document) | Source::Models(document) => (*document, None, false),
    };
    let Some(path) = &document.scene else { bail!("the session names no scene") };
    let scene = read_scene(&examples::resolve(path), &document.added)?;
    progress.report(1.0)?;
    Ok(Loaded { document, session_file, scene: Arc::new(scene), fresh, added_only })
}

fn read_scene(path: &Path, added: &[PathBuf]) -> Result<Scene> {
    let mut scene = import::load(path)?;
    for model in added {
        import::add_model(&mut scene, model)?;
    }
    Ok(scene)
}

/// Solves a scene, publishing what can be shown on the way: first the light on surfaces, then with the
/// light in the air.
///
/// # Errors
/// If the scene cannot be solved or the work was cancelled.
pub fn solve(
    scene: &Arc<Scene>,
    revision: u64,
    progress: &Progress,
    publish: &mut dyn FnMut(LightTransportSolution),
) -> Result<()> {
    progress.begin("sorting triangles");
    let world = Arc::new(World::new(scene));
    progress.begin("radiosity");
    progress.report(0.0)?;
    let radiosity = Arc::new(RadiositySolution::solve(&world, &RadiositySettings::default(), progress)?);
    let mut solution = LightTransportSolution {
        scene: Arc::clone(scene),
        world,
        radiosity,
        volume: None,
        moved_objects: Vec::new(),
        provenance: Provenance { revision, state: State::Refining, ..Provenance::default() },
    };
    publish(solution.clone());
    let volume =
        IrradianceVolume::build(&solution.world, &*solution.radiosity, &VolumeSettings::default(), progress)?;
    solution.volume = Some(Arc::new(volume));
    solution.provenance.state = State::Settled;
    publish(solution);
    Ok(())
}

/// Rays into each bin of a probe.
const PROBE_RAYS: u32 = 4;

/// Light at one point in the air, for every direction.
///
/// # Errors
/// If the work was cancelled.
pub fn probe(
    solution: &LightTransportSolution,
    position: Vec3,
    _normal: Vec3,
    n: u32,
    _progress: &Progress,
) -> Result<Probe> {
    Ok(Probe::at(&solution.world, &*solution.radiosity, position, n, PROBE_RAYS, 1)?)
}

/// A reference picture in the making.
pub struct ReferenceWork {
    picture: ReferencePicture,
}

impl ReferenceWork {
    /// Samples a pixel after which it rests.
    pub const ENOUGH: u32 = 1024;

    /// Begins a picture.
    pub fn new(world: &Arc<World>, camera: Camera, [width, height]: [u32; 2]) -> Self {
        Self { picture: ReferencePicture::new(Arc::clone(world), camera, width, height, 1) }
    }

    /// Whether it has all its samples.
    pub fn is_done(&self) -> bool {
        self.picture.samples() >= Self::ENOUGH
    }

    /// Adds as many samples a pixel as it has, up to eight: quick to the first picture, then steady.
    ///
    /// # Errors
    /// If the work was cancelled; the samples so far stay.
    pub fn more(&mut self, progress: &Progress) -> Result<Reference> {
        self.picture.add_samples(self.picture.samples().clamp(1, 8), progress)?;
        Ok(Reference { image: Arc::new(self.picture.mean()), samples: self.picture.samples() })
    }
}
