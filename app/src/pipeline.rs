//! What the worker does with a scene: read it, solve it, picture it. No thread and no window here.

use crate::{
    copies::CopyVolume,
    document::Document,
    examples, panoramas,
    placement::Placement,
    session::{Against, Reference},
    session_file,
    widgets::{Probe, moments::Spheres, resolutions::ROWS},
    worker::{InspectRequest, ProbeRequest, ReferenceRequest},
};
use anyhow::{Context as _, Result, bail};
use lumenscope_core::{
    inspection::{InspectionScene, Line, SphereGlyph, colours::ColourSettings},
    irradiance_volume::{
        IrradianceVolume, VolumeSettings,
        ignored::Ignored,
        inspect as volume_inspect,
        moments::Order,
        placement::{self, MeasureSettings, Measurement},
        probe::Quantity,
    },
    math::progress::Progress,
    reference::picture::ReferencePicture,
    registry::{self, ViewInput, ViewRow},
    scene::{
        Scene,
        check::{self, Severity},
        import,
        world::World,
    },
    superposition::plan::{DEFAULT_TOLERANCE, Plan},
    transport::{LightTransportSolution, solution::State},
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Seed of every random number in the window.
const SEED: u64 = 1;

/// Rays a bin of a probe: its bins are few, and it is looked at closely.
const SUPERSAMPLE: u32 = 4;

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
    let mut scene = read_scene(&examples::resolve(path)?, &document.edits.added)?;
    progress.begin("checking");
    let findings = check::check(&scene).into_iter().filter(|f| f.severity == Severity::Warning);
    scene.warnings.extend(findings.map(|f| format!("{}: {}; {}", f.object, f.what, f.advice)));
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

/// What a scene needs, planned from what is in it.
pub fn plan(scene: &Scene) -> Plan {
    Plan::new(scene, &World::new(scene), DEFAULT_TOLERANCE, SEED)
}

/// Whether a solution of `solved` can follow to `scene`: the same things, placed or dimmed otherwise.
pub fn can_follow(solved: &Scene, scene: &Scene) -> bool {
    let same_meshes = solved.meshes.iter().zip(&scene.meshes).all(|(a, b)| Arc::ptr_eq(a, b));
    same_meshes
        && solved.meshes.len() == scene.meshes.len()
        && solved.objects.len() == scene.objects.len()
        && solved.lamps.len() == scene.lamps.len()
}

/// Light at one point in the air, for every direction; and, where asked for, at every resolution of
/// the thesis, coarsest first, and as moments.
///
/// # Errors
/// If a setting is out of range or the work was cancelled.
pub fn probe(
    solution: &LightTransportSolution,
    request: &ProbeRequest,
    progress: &Progress,
) -> Result<(Probe, Vec<Probe>, Option<Spheres>)> {
    progress.begin("spheres");
    let ProbeRequest { position, n, resolutions, moments } = *request;
    let at = |n| Probe::at(&solution.world, &*solution.radiosity, position, n, SUPERSAMPLE, SEED);
    progress.report(0.0)?;
    let probe = at(n)?;
    let mut others = Vec::new();
    for rows in ROWS.into_iter().filter(|_| resolutions) {
        progress.report(others.len() as f32 / ROWS.len() as f32)?;
        others.push(at(rows)?);
    }
    let moments = moments.map(|(besides, part)| -> Result<Spheres> {
        let mut spheres = Spheres { part, of: Vec::new() };
        for order in Spheres::orders(besides) {
            progress.report(spheres.of.len() as f32 / Order::THESIS.len() as f32)?;
            spheres.of.push((order, probe.moment(order, part)));
        }
        Ok(spheres)
    });
    Ok((probe, others, moments.transpose()?))
}

/// Illuminance where a placement says; with the settings for moving things until the light is settled.
pub fn measure(solution: &LightTransportSolution, placement: &Placement) -> Option<Measurement> {
    let (name, grid) = placement.grid(&solution.scene, &solution.world.geometry)?;
    let fine = MeasureSettings {
        maintenance_factor: placement.maintenance_factor,
        seed: SEED,
        ..MeasureSettings::default()
    };
    let settled = solution.provenance.state == State::Settled;
    let settings = if settled { fine } else { fine.moving() };
    let volume = solution.volume.as_deref();
    Some(placement::measure(&solution.world, &*solution.radiosity, volume, &name, grid, &settings))
}

/// What the views switched on put into the scene; `None` when none is.
pub fn inspect(request: &InspectRequest) -> Option<InspectionScene> {
    let (low, high) = request.solution.world.geometry.bounds();
    let shown = &request.volume;
    let volume = volume_inspect::VolumeView {
        colour_by: shown.colour_by,
        moment: shown.moment,
        quantity: if shown.radiance { Quantity::Radiance } else { Quantity::Irradiance },
        part: shown.part,
        first_level: shown.first_level,
        second_level: shown.second_level,
        invalid: shown.colour_by == volume_inspect::ColourBy::Validity,
        size: shown.size,
        slice: shown.slice.map(|(axis, share)| {
            let a = usize::from(axis.min(2));
            (axis, low[a] + share.clamp(0.0, 1.0) * (high[a] - low[a]))
        }),
    };
    let against = compared(request);
    let kept = match request.volume.of {
        CopyVolume::Kept(number) => request.kept.get(number),
        CopyVolume::Present => None,
    };
    let of_kept = kept.map(|kept| LightTransportSolution {
        volume: Some(Arc::clone(&kept.volume)),
        ..(*request.solution).clone()
    });
    let input = ViewInput {
        solution: of_kept.as_ref().unwrap_or(&request.solution),
        probe: request.probe.as_deref(),
        point: request.surface.and_then(|s| s.place(&request.solution)),
        element: request.surface.and_then(|s| s.element(&request.solution)),
        volume: &volume,
        against: against.as_deref(),
        placement: request.measurement.as_deref().map(|m| (m, &request.requirement)),
        lightmap: request.lightmap.as_deref().map(|l| &l.report),
    };
    let spheres = shown.shown.then_some(SPHERES);
    let others = request.views.iter().map(String::as_str).filter(|v| ![SPHERES, KERNEL].contains(v));
    let ids = spheres.into_iter().chain(others);
    let made = ids.filter_map(registry::view).map(|row| (row.build)(&input).unwrap_or_else(|| nothing(row)));
    made.reduce(merge)
}

/// What is said where a view has nothing to show.
fn nothing(row: &ViewRow) -> InspectionScene {
    let note = format!("{}: nothing to show. {}", row.title, row.tooltip);
    InspectionScene { notes: vec![note], ..InspectionScene::default() }
}

/// The volume that the one shown is compared with; `None` where no view compares or nothing is chosen.
fn compared(request: &InspectRequest) -> Option<Arc<IrradianceVolume>> {
    let shown = &request.volume;
    let by_error = shown.shown && shown.colour_by == volume_inspect::ColourBy::Error;
    if !by_error && !request.views.iter().any(|v| DIFFERENCES.contains(&v.as_str())) {
        return None;
    }
    match request.volume.against {
        Against::Kept(number) => Some(Arc::clone(&request.kept.get(number)?.volume)),
        Against::Present => request.solution.volume.clone(),
        Against::Ignoring => {
            let solution = &request.solution;
            let volume = solution.volume.as_ref()?;
            let ignored = request.volume.left_out();
            Some(Arc::new(volume.ignoring(&solution.world, &*solution.radiosity, ignored)?))
        }
    }
}

/// Paths a bin of a path-traced volume: a standard error of some per cent in a room lit indirectly.
const VOLUME_PATHS: u32 = 16;

/// Where a volume to compare with comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum VolumeSource {
    /// The path tracer, with the present volume's samples.
    Reference,
    /// Panoramas, by the file that lists them.
    Panoramas(PathBuf),
    /// The present volume without the light of some surfaces and lamps, and their names.
    Ignoring(Ignored, String),
    /// A file that a volume was saved to.
    File(PathBuf),
}

impl VolumeSource {
    /// What its making is called.
    pub fn job(&self) -> &'static str {
        match self {
            Self::Reference => "Path tracing a volume",
            Self::Panoramas(_) => "Reading panoramas",
            Self::Ignoring(..) => "Leaving light out",
            Self::File(_) => "Reading a volume",
        }
    }

    /// Where its light comes from.
    pub fn name(&self) -> String {
        match self {
            Self::Reference => "reference".into(),
            Self::Panoramas(_) => "panoramas".into(),
            Self::Ignoring(_, names) => format!("without {names}"),
            Self::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }
}

/// A volume to compare that of a solution with.
///
/// # Errors
/// If there is no volume, a panorama cannot be read, or the work was cancelled.
pub fn other_volume(
    solution: &LightTransportSolution,
    source: &VolumeSource,
    progress: &Progress,
) -> Result<IrradianceVolume> {
    let Some(volume) = &solution.volume else { bail!("there is no volume to compare with yet") };
    match source {
        VolumeSource::File(path) => Ok(IrradianceVolume::load(path)?),
        VolumeSource::Ignoring(ignored, _) => {
            let without = volume.ignoring(&solution.world, &*solution.radiosity, ignored.clone());
            without.context("the present volume came from a file: what its rays met is not known")
        }
        VolumeSource::Reference => Ok(volume.of_reference(&solution.world, VOLUME_PATHS, progress)?),
        VolumeSource::Panoramas(list) => {
            progress.begin("reading panoramas");
            let nodes = panoramas::read(list)?;
            let settings = VolumeSettings { bins_n: volume.bins().n(), ..VolumeSettings::default() };
            Ok(IrradianceVolume::from_panoramas(&nodes, &settings, progress)?)
        }
    }
}

/// The views that compare two volumes.
pub const DIFFERENCES: [&str; 2] = ["irradiance_volume.difference", "irradiance_volume.difference_slice"];

/// The view that the volume's own switch shows.
pub const SPHERES: &str = "irradiance_volume.spheres";

/// The view that follows the pointer, made by the viewport.
pub const KERNEL: &str = "glossy.kernel";

/// Two views at once: spheres need one layout of bins and colours one legend, so the first has the say.
fn merge(mut first: InspectionScene, second: InspectionScene) -> InspectionScene {
    let colours = second.colours(&ColourSettings::default());
    let valued = second.value_lines.iter();
    first.lines.extend(valued.map(|l| Line { ends: l.ends, colour: colours.colour(l.value) }));
    if first.bins.is_none() || first.bins == second.bins {
        let shift = first.sphere_bins.len() as u32;
        first.bins = first.bins.or(second.bins);
        first
            .spheres
            .extend(second.spheres.into_iter().map(|s| SphereGlyph { first_bin: s.first_bin + shift, ..s }));
        first.sphere_bins.extend(second.sphere_bins);
    }
    first.meshes.extend(second.meshes);
    first.lines.extend(second.lines);
    first.labels.extend(second.labels);
    first.images.extend(second.images);
    first.curves.extend(second.curves);
    first.notes.extend(second.notes);
    first.legend = first.legend.or(second.legend);
    first
}

/// A reference picture in the making.
pub struct ReferenceWork {
    picture: ReferencePicture,
}

impl ReferenceWork {
    /// Samples a pixel after which it rests.
    pub const ENOUGH: u32 = 1024;

    /// Begins a picture.
    pub fn new(world: &Arc<World>, request: ReferenceRequest) -> Self {
        let ReferenceRequest { camera, size: [width, height], paths } = request;
        let picture = ReferencePicture::new(Arc::clone(world), camera, width, height, SEED);
        Self {
            picture: match paths {
                Some(paths) => picture.of_paths(paths),
                None => picture,
            },
        }
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
