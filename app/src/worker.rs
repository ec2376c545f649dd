//! The worker: one background thread that does everything longer than a frame.
//!
//! Each kind of request has one slot and the latest wins; what is on screen never waits. Not a queue:
//! during a drag, all but the newest scene would be solved in vain. Not a pool: the solvers use every
//! core themselves.

mod bench;

use crate::{
    copies::CopiesRequest,
    export::ExportRequest,
    grid_view::{GridRequest, GridView, SurfacePoint},
    lightmaps::{JudgedLightmap, LightmapFile},
    pipeline::{Loaded, Source, VolumeSource},
    placement::Placement,
    session::{Kept, Reference, VolumeView},
    widgets::{Probe, moments::Spheres},
};
use bench::Bench;
use glam::Vec3;
use lumenscope_core::{
    inspection::InspectionScene,
    irradiance_volume::{
        IrradianceVolume,
        moments::Order,
        placement::{Measurement, requirement::Requirement},
    },
    math::{part::Part, progress::Progress},
    reference::expression::Expression,
    scene::{Scene, camera::Camera},
    superposition::plan::Plan,
    transport::LightTransportSolution,
};
use std::{
    collections::VecDeque,
    path::PathBuf,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, mpsc},
    thread::JoinHandle,
    time::Instant,
};

/// What came out of the worker.
pub enum News {
    /// A scene was loaded.
    Loaded(Box<Loaded>),
    /// There is better light for the scene.
    Solution(Arc<LightTransportSolution>),
    /// What the scene needs was planned.
    Plan(Arc<Plan>),
    /// A probe was sampled, and the same point at other resolutions and as moments where those are shown.
    Probe(Arc<Probe>, Vec<Probe>, Option<Spheres>),
    /// The texture of the surface that was clicked was made, or better compared; `None` where it has none.
    Texture(Option<Arc<GridView>>),
    /// A lightmap was held against our light.
    Lightmap(Arc<JudgedLightmap>),
    /// Illuminance was measured; `None` where there is nothing to measure.
    Measured(Option<Arc<Measurement>>),
    /// What the views show was made.
    Inspection(Option<Arc<InspectionScene>>),
    /// A volume was made to compare with, and where its light comes from.
    OtherVolume(Arc<IrradianceVolume>, String),
    /// The reference of the request with this number has more samples.
    Reference(Reference, u64),
    /// A file was written.
    Written(PathBuf),
    /// Something was cancelled.
    Cancelled(&'static str),
    /// Something could not be done; what it was, and why.
    Failed(&'static str, String),
}

/// A spot whose spheres are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeRequest {
    /// Position, m.
    pub position: Vec3,
    /// Rows of bins a hemisphere.
    pub n: u32,
    /// Whether every resolution of the thesis is wanted too.
    pub resolutions: bool,
    /// Whether its moments are: an order beside those of the thesis, and the part of the light.
    pub moments: Option<(Option<Order>, Part)>,
}

/// Views whose contents are wanted.
#[derive(Clone)]
pub struct InspectRequest {
    /// The light.
    pub solution: Arc<LightTransportSolution>,
    /// The open spheres.
    pub probe: Option<Arc<Probe>>,
    /// Illuminance where it is measured.
    pub measurement: Option<Arc<Measurement>>,
    /// What is asked of it.
    pub requirement: Requirement,
    /// The point that was clicked.
    pub surface: Option<SurfacePoint>,
    /// How the volume is shown.
    pub volume: VolumeView,
    /// Ids of the views switched on.
    pub views: Vec<String>,
    /// Volumes kept.
    pub kept: Vec<Kept>,
    /// The lightmap that is held against the light.
    pub lightmap: Option<Arc<JudgedLightmap>>,
}

/// A picture wanted from the path tracer.
#[derive(Clone, Debug)]
pub struct ReferenceRequest {
    /// Camera.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Paths that count; all of them without.
    pub paths: Option<Expression>,
}

/// The job at work.
#[derive(Clone, Debug)]
pub struct Job {
    /// What it is for.
    pub name: &'static str,
    /// How far it is.
    pub progress: Progress,
    /// When it began.
    pub began: Instant,
    yields_to: Rank,
}

/// What a request may interrupt: jobs that yield to its rank or to one below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Stop,
    Light,
    Probe,
    Inspect,
    Any,
}

#[derive(Default)]
struct Slots {
    load: Option<Source>,
    scene: Option<(Arc<Scene>, bool)>,
    refine: bool,
    probe: Option<ProbeRequest>,
    inspect: Option<InspectRequest>,
    /// A texture that is wanted, or that none is.
    texture: Option<Option<GridRequest>>,
    /// What is measured whenever the light changes.
    placement: Placement,
    /// Whether it has not been measured in the latest light.
    measure: bool,
    exports: VecDeque<ExportRequest>,
    reference: Option<Option<ReferenceRequest>>,
    /// Requests for a reference so far, forgetting it included.
    references: u64,
    /// A lightmap that is to be held against the light.
    lightmap: Option<LightmapFile>,
    /// A volume that is wanted to compare with.
    other_volume: Option<VolumeSource>,
    /// Copies that every light is shown with.
    copies: Option<CopiesRequest>,
    /// Whether what is shown is without them, or with others.
    dress: bool,
    /// Whether a task was taken and is not done; its job begins a little later and ends a little earlier.
    at_work: bool,
    /// The most urgent request since the task was taken, while it has no job to be interrupted by it.
    meanwhile: Option<Rank>,
    job: Option<Job>,
    quit: bool,
}

impl Slots {
    /// From now on no reference is news but that of this request.
    fn want_reference(&mut self, request: Option<ReferenceRequest>) {
        self.reference = Some(request);
        self.references += 1;
    }
}

struct Shared {
    slots: Mutex<Slots>,
    wake: Condvar,
}

impl Shared {
    fn slots(&self) -> MutexGuard<'_, Slots> {
        self.slots.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Handle on the worker; dropping it ends the thread.
pub struct Worker {
    shared: Arc<Shared>,
    news: mpsc::Receiver<News>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread; `wake` is called whenever there is news.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared { slots: Mutex::default(), wake: Condvar::new() });
        let (sender, news) = mpsc::channel();
        let bench = Bench::new(Arc::clone(&shared), sender, Box::new(wake));
        let thread = std::thread::Builder::new().name("worker".into()).spawn(|| bench.run())?;
        Ok(Self { shared, news, thread: Some(thread) })
    }

    /// What has come out since the last call, but for references of what is shown no more.
    pub fn news(&self) -> Vec<News> {
        let latest = self.shared.slots().references;
        let old = |news: &News| matches!(news, News::Reference(_, number) if *number != latest);
        self.news.try_iter().filter(|news| !old(news)).collect()
    }

    /// The job at work.
    pub fn job(&self) -> Option<Job> {
        self.shared.slots().job.clone()
    }

    /// Whether the light of the newest scene is still on its way.
    pub fn is_solving(&self) -> bool {
        let slots = self.shared.slots();
        slots.scene.is_some() || slots.refine || slots.job.as_ref().is_some_and(|j| j.name == LIGHT)
    }

    /// Whether anything is at work or waiting.
    pub fn is_busy(&self) -> bool {
        let slots = self.shared.slots();
        slots.at_work
            || slots.load.is_some()
            || slots.scene.is_some()
            || slots.refine
            || slots.probe.is_some()
            || slots.inspect.is_some()
            || slots.texture.is_some()
            || slots.lightmap.is_some()
            || slots.measure
            || slots.other_volume.is_some()
            || slots.dress
            || !slots.exports.is_empty()
    }

    /// Loads; whatever is at work is given up.
    pub fn load(&self, source: Source) {
        self.put(Rank::Stop, |slots| {
            slots.load = Some(source);
            slots.scene = None;
            slots.refine = false;
            slots.probe = None;
            slots.inspect = None;
            slots.texture = Some(None);
            slots.lightmap = None;
            slots.placement = Placement::default();
            slots.measure = false;
            slots.want_reference(None);
            slots.other_volume = None;
            slots.copies = None;
            slots.dress = false;
        });
    }

    /// Lets the light follow a scene; `dragging` while more of the same is to come.
    pub fn follow(&self, scene: Arc<Scene>, dragging: bool) {
        self.put(Rank::Light, |slots| slots.scene = Some((scene, dragging)));
    }

    /// Samples a probe.
    pub fn probe(&self, request: ProbeRequest) {
        self.put(Rank::Probe, |slots| slots.probe = Some(request));
    }

    /// Measures illuminance there, now and whenever the light changes.
    pub fn measure(&self, placement: Placement) {
        self.put(Rank::Inspect, |slots| {
            slots.placement = placement;
            slots.measure = true;
        });
    }

    /// Makes what the views show.
    pub fn inspect(&self, request: InspectRequest) {
        self.put(Rank::Inspect, |slots| slots.inspect = Some(request));
    }

    /// Makes the texture of a surface, or (with `None`) forgets it.
    pub fn texture(&self, request: Option<GridRequest>) {
        self.put(Rank::Inspect, |slots| slots.texture = Some(request));
    }

    /// Starts, resumes or (with `None`) forgets the reference picture.
    pub fn reference(&self, request: Option<ReferenceRequest>) {
        self.put(Rank::Any, |slots| slots.want_reference(request));
    }

    /// Shows every light with these copies from now on, or without any.
    pub fn copies(&self, copies: Option<CopiesRequest>) {
        self.put(Rank::Inspect, |slots| {
            slots.copies = copies;
            slots.dress = true;
        });
    }

    /// Holds a lightmap against the light.
    pub fn lightmap(&self, file: LightmapFile) {
        self.put(Rank::Any, |slots| slots.lightmap = Some(file));
    }

    /// Makes a volume to compare with.
    pub fn other_volume(&self, source: VolumeSource) {
        self.put(Rank::Any, |slots| slots.other_volume = Some(source));
    }

    /// Writes a file.
    pub fn export(&self, request: ExportRequest) {
        self.put(Rank::Any, |slots| slots.exports.push_back(request));
    }

    /// Gives up whatever is at work or waiting; true where that was putting copies in, which are gone then.
    pub fn cancel(&self) -> bool {
        let mut undressed = false;
        self.put(Rank::Stop, |slots| {
            let job = slots.job.as_ref().map(|j| j.name);
            // Copies that wait for light that is being solved go in whenever that is taken up again.
            let waiting = slots.dress && job != Some(LIGHT);
            undressed = waiting || job == Some(COPIES);
            if undressed {
                slots.copies = None;
            }
            // What is on screen may have had copies elsewhere.
            slots.dress = waiting;
            slots.load = None;
            slots.scene = None;
            slots.refine = false;
            slots.probe = None;
            slots.exports.clear();
            slots.lightmap = None;
            slots.want_reference(None);
            slots.other_volume = None;
            slots.measure = false;
        });
        undressed
    }

    fn put(&self, rank: Rank, change: impl FnOnce(&mut Slots)) {
        let mut slots = self.shared.slots();
        change(&mut slots);
        match &slots.job {
            Some(job) if rank <= job.yields_to => job.progress.cancel(),
            Some(_) => {}
            None => slots.meanwhile = Some(slots.meanwhile.map_or(rank, |r| r.min(rank))),
        }
        self.shared.wake.notify_one();
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.put(Rank::Stop, |slots| slots.quit = true);
        if let Some(thread) = self.thread.take() {
            // A panic there has been reported as news; nobody is left to hear another.
            let _ = thread.join();
        }
    }
}

const LIGHT: &str = "Solving light";
const COPIES: &str = "Putting the copies in";
