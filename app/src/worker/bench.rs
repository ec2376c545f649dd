//! The thread behind the worker: takes what is wanted most and does it.

use super::{
    COPIES, InspectRequest, Job, LIGHT, News, ProbeRequest, Rank, ReferenceRequest, Shared, Slots, Source,
    VolumeSource,
};
use crate::{
    export::{self, ExportRequest},
    grid_view::{GridRequest, GridWork},
    lightmaps::{JUDGING, JudgedLightmap, LightmapFile},
    pipeline,
    placement::Placement,
};
use anyhow::Result;
use lumenscope_core::{
    irradiance_volume::dynamic_object::DynamicObject,
    math::progress::{Cancelled, Progress},
    scene::{Scene, mesh::Mesh},
    transport::{
        LightTransportSolution,
        live::{LiveTransport, SolveSettings},
    },
};
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, PoisonError, mpsc::Sender},
    time::Instant,
};

enum Task {
    Load(Source),
    Light(Arc<Scene>, bool),
    Refine,
    Probe(ProbeRequest),
    Measure(Placement),
    Inspect(Box<InspectRequest>),
    Export(Box<ExportRequest>),
    Reference(Option<ReferenceRequest>, u64),
    MoreSamples,
    Texture(Option<GridRequest>),
    MoreTexture,
    Lightmap(LightmapFile),
    OtherVolume(VolumeSource),
    Dress,
}

/// What the thread keeps between jobs.
pub(super) struct Bench {
    shared: Arc<Shared>,
    news: Sender<News>,
    wake: Box<dyn Fn() + Send>,
    live: Option<LiveTransport>,
    solution: Option<Arc<LightTransportSolution>>,
    /// The reference in the making, and the number of its request.
    reference: Option<(pipeline::ReferenceWork, u64)>,
    /// The texture of the surface that was clicked.
    texture: Option<GridWork>,
    /// Nodes of the copies, and of which object of which scene.
    copied: Option<(usize, Arc<Mesh>, Arc<DynamicObject>)>,
    /// Whether the last task was light: then what is watched of it goes first.
    lit: bool,
}

impl Bench {
    pub(super) fn new(shared: Arc<Shared>, news: Sender<News>, wake: Box<dyn Fn() + Send>) -> Self {
        Self {
            shared,
            news,
            wake,
            live: None,
            solution: None,
            reference: None,
            texture: None,
            copied: None,
            lit: false,
        }
    }

    /// Works until told to quit.
    pub(super) fn run(mut self) {
        while let Some(task) = self.next() {
            match task {
                Task::Load(source) => self.load(source),
                Task::Light(scene, dragging) => self.light(&scene, dragging),
                Task::Refine => self.refine(),
                Task::Probe(request) => self.probe(&request),
                Task::Measure(placement) => self.measure(&placement),
                Task::Inspect(request) => {
                    let made = self.job("Making the views", Rank::Inspect, |_, progress| {
                        progress.begin("views");
                        Ok(pipeline::inspect(&request).map(Arc::new))
                    });
                    if let Some(made) = made {
                        self.tell(News::Inspection(made));
                    }
                }
                Task::Export(request) => {
                    if let Some(()) = self.job("Exporting", Rank::Stop, |_, p| export::write(&request, p)) {
                        self.tell(News::Written(request.path));
                    }
                }
                Task::Reference(request, number) => self.begin_reference(request, number),
                Task::MoreSamples => self.more_samples(),
                Task::Texture(request) => self.texture(request),
                Task::Lightmap(file) => self.lightmap(&file),
                Task::MoreTexture => self.more_texture(),
                Task::OtherVolume(source) => self.other_volume(&source),
                Task::Dress => self.dress(),
            }
        }
    }

    /// The task wanted most; waits for one. `None` to quit.
    fn next(&mut self) -> Option<Task> {
        let shared = Arc::clone(&self.shared);
        let mut slots = shared.slots();
        loop {
            slots.at_work = false;
            if slots.quit {
                return None;
            }
            if let Some(task) = self.take(&mut slots) {
                (slots.at_work, slots.meanwhile) = (true, None);
                self.lit = matches!(task, Task::Light(..) | Task::Refine);
                return Some(task);
            }
            slots = shared.wake.wait(slots).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn take(&self, slots: &mut Slots) -> Option<Task> {
        if let Some(source) = slots.load.take() {
            return Some(Task::Load(source));
        }
        // Between two steps of a drag, what is watched of the light: else it would wait for the drag's end.
        if self.solution.is_some() && std::mem::take(&mut slots.measure) {
            return Some(Task::Measure(slots.placement.clone()));
        }
        // Without light there is nothing to put copies into: they go in when there is some.
        if std::mem::take(&mut slots.dress) && self.solution.is_some() {
            return Some(Task::Dress);
        }
        if self.lit
            && let Some(request) = slots.inspect.take()
        {
            return Some(Task::Inspect(Box::new(request)));
        }
        if let Some((scene, dragging)) = slots.scene.take() {
            return Some(Task::Light(scene, dragging));
        }
        if self.solution.is_some()
            && let Some(request) = slots.probe.take()
        {
            return Some(Task::Probe(request));
        }
        if let Some(request) = slots.inspect.take() {
            return Some(Task::Inspect(Box::new(request)));
        }
        // Without light these come to nothing, and are asked for again when there is some.
        if let Some(request) = slots.texture.take() {
            return Some(Task::Texture(request));
        }
        if std::mem::take(&mut slots.refine) {
            return Some(Task::Refine);
        }
        if let Some(file) = slots.lightmap.take() {
            return Some(Task::Lightmap(file));
        }
        if let Some(request) = slots.exports.pop_front() {
            return Some(Task::Export(Box::new(request)));
        }
        if self.solution.is_some()
            && let Some(source) = slots.other_volume.take()
        {
            return Some(Task::OtherVolume(source));
        }
        if self.solution.is_some()
            && let Some(request) = slots.reference.take()
        {
            return Some(Task::Reference(request, slots.references));
        }
        if self.texture.as_ref().is_some_and(GridWork::wants_more) {
            return Some(Task::MoreTexture);
        }
        self.reference.as_ref().is_some_and(|r| !r.0.is_done()).then_some(Task::MoreSamples)
    }

    fn load(&mut self, source: Source) {
        if let Some(loaded) = self.job("Opening", Rank::Stop, |_, progress| pipeline::load(source, progress))
        {
            self.live = None;
            self.solution = None;
            self.reference = None;
            self.texture = None;
            self.tell(News::Loaded(Box::new(loaded)));
        }
    }

    fn light(&mut self, scene: &Arc<Scene>, dragging: bool) {
        let can_follow = |l: &LiveTransport| pipeline::can_follow(&l.current().scene, scene);
        match self.live.take().filter(can_follow) {
            Some(live) if Arc::ptr_eq(&live.current().scene, scene) => {
                self.live = Some(live);
                self.shared.slots().refine = !dragging;
            }
            Some(live) if live.current().scene.plan != scene.plan => self.replan(live, scene),
            Some(mut live) => {
                let light = self.job(LIGHT, Rank::Stop, |_, progress| {
                    progress.begin("following");
                    Ok(Arc::new(live.follow(Arc::clone(scene)).clone()))
                });
                // After a fault the transport is not to be trusted: the next change solves anew.
                if let Some(light) = light {
                    self.live = Some(live);
                    self.show(light);
                }
                self.shared.slots().refine = !dragging && self.live.is_some();
            }
            None => {
                let live = self.job(LIGHT, Rank::Stop, |bench, progress| {
                    let settings = bench.plan(scene, progress);
                    let show = &mut |light: &_| bench.tell_light(light);
                    Ok(LiveTransport::solve(Arc::clone(scene), settings, progress, show)?)
                });
                self.solution = live.as_ref().map(|l| Arc::new(l.current().clone()));
                self.live = live;
                // Without light there is nothing to measure or to put copies into.
                let lit = self.live.is_some();
                let mut slots = self.shared.slots();
                slots.measure = lit;
                slots.dress = lit && (slots.dress || slots.copies.is_some());
            }
        }
    }

    /// Solves again what other overrides of the plan change; where that fails, the light stays.
    fn replan(&mut self, live: LiveTransport, scene: &Arc<Scene>) {
        let solved = self.job(LIGHT, Rank::Stop, |bench, progress| {
            let settings = bench.plan(scene, progress);
            let show = &mut |light: &_| bench.tell_light(light);
            Ok(live.with_settings(Arc::clone(scene), settings, progress, show)?)
        });
        let live = solved.unwrap_or(live);
        self.solution = Some(Arc::new(live.current().clone()));
        self.live = Some(live);
    }

    fn plan(&self, scene: &Scene, progress: &Progress) -> SolveSettings {
        progress.begin("planning");
        let plan = pipeline::plan(scene);
        let settings = SolveSettings { preview: true, ..plan.solve.clone() };
        self.tell(News::Plan(Arc::new(plan)));
        settings
    }

    /// One step towards settled light. Interrupted, it is asked for again by what interrupted it.
    fn refine(&mut self) {
        let Some(mut live) = self.live.take() else { return };
        let refined = self.job(LIGHT, Rank::Light, |_, progress| {
            progress.begin("refining");
            Ok(live.refine(progress)?.map(|light| Arc::new(light.clone())))
        });
        self.live = Some(live);
        if let Some(Some(light)) = refined {
            self.shared.slots().refine = true;
            self.show(light);
        }
    }

    fn show(&mut self, light: Arc<LightTransportSolution>) {
        self.solution = Some(Arc::clone(&light));
        self.shared.slots().measure = true;
        self.dress();
    }

    /// Shows the light, with the copies in it where there are any.
    fn dress(&mut self) {
        let Some(bare) = self.solution.clone() else { return };
        let Some(request) = self.shared.slots().copies.clone() else {
            return self.tell(News::Solution(bare));
        };
        let mesh = bare.scene.objects.get(request.copies.object).and_then(|o| o.parts.first());
        let mesh = mesh.map(|p| bare.scene.meshes[p.mesh].clone());
        let known = self.copied.as_ref().filter(|(object, of, _)| {
            *object == request.copies.object && mesh.as_ref().is_some_and(|m| Arc::ptr_eq(m, of))
        });
        let known = known.map(|c| c.2.clone());
        let dressed = self.job(COPIES, Rank::Stop, |_, progress| {
            progress.begin("copies");
            request.dress(&bare, known.as_ref())
        });
        // A stop may have taken the copies away meanwhile.
        let wanted = self.shared.slots().copies.is_some();
        let Some(dressed) = dressed.filter(|_| wanted) else { return self.tell(News::Solution(bare)) };
        if let (Some(mesh), Some(guest)) = (mesh, dressed.guests.first()) {
            self.copied = Some((request.copies.object, mesh, guest.known.clone()));
        }
        self.tell(News::Solution(Arc::new(dressed)));
    }

    fn measure(&mut self, placement: &Placement) {
        let Some(solution) = self.solution.clone() else { return };
        if placement.site.is_none() {
            return self.tell(News::Measured(None));
        }
        let measured = self.job("Measuring illuminance", Rank::Stop, |_, progress| {
            progress.begin("illuminance");
            Ok(pipeline::measure(&solution, placement))
        });
        if let Some(measured) = measured {
            self.tell(News::Measured(measured.map(Arc::new)));
        }
    }

    fn probe(&mut self, request: &ProbeRequest) {
        let Some(solution) = self.solution.clone() else { return };
        let sampled = self.job("Sampling the spheres", Rank::Probe, |_, progress| {
            pipeline::probe(&solution, request, progress)
        });
        if let Some((probe, resolutions, moments)) = sampled {
            self.tell(News::Probe(Arc::new(probe), resolutions, moments));
        }
    }

    fn begin_reference(&mut self, request: Option<ReferenceRequest>, number: u64) {
        self.reference = match (request, &self.solution) {
            (Some(request), Some(solution)) => {
                Some((pipeline::ReferenceWork::new(&solution.world, request), number))
            }
            _ => None,
        };
    }

    fn texture(&mut self, request: Option<GridRequest>) {
        let known = self.texture.take();
        if let (Some(request), Some(solution)) = (request, self.solution.clone()) {
            let made = self.job("Making a texture", Rank::Stop, |_, progress| {
                progress.begin("texture");
                let work = GridWork::new(known, &solution, &request);
                Ok(work.map(|work| (Arc::new(work.view()), work)))
            });
            let Some(made) = made else { return };
            let (view, work) = made.unzip();
            self.texture = work;
            self.tell(News::Texture(view));
        }
    }

    fn lightmap(&mut self, file: &LightmapFile) {
        let Some(solution) = self.solution.clone() else { return };
        let judged =
            self.job(JUDGING, Rank::Stop, |_, progress| JudgedLightmap::new(file, &solution, progress));
        if let Some(judged) = judged {
            self.tell(News::Lightmap(Arc::new(judged)));
        }
    }

    fn more_texture(&mut self) {
        let Some(mut work) = self.texture.take() else { return };
        let done = self.job("Path tracing a texture", Rank::Any, |_, progress| work.more(progress));
        if let Some(view) = done {
            self.tell(News::Texture(Some(Arc::new(view))));
        }
        self.texture = Some(work);
    }

    fn other_volume(&mut self, source: &VolumeSource) {
        let Some(solution) = self.solution.clone() else { return };
        let made = self
            .job(source.job(), Rank::Stop, |_, progress| pipeline::other_volume(&solution, source, progress));
        if let Some(volume) = made {
            self.tell(News::OtherVolume(Arc::new(volume), source.name()));
        }
    }

    fn more_samples(&mut self) {
        let Some((mut work, number)) = self.reference.take() else { return };
        let done = self.job("Path tracing the reference", Rank::Any, |_, progress| work.more(progress));
        if let Some(picture) = done {
            self.tell(News::Reference(picture, number));
        }
        self.reference = Some((work, number));
    }

    /// Runs a job with its progress on show; what goes wrong becomes news.
    fn job<T>(
        &mut self,
        name: &'static str,
        yields_to: Rank,
        work: impl FnOnce(&Self, &Progress) -> Result<T>,
    ) -> Option<T> {
        let progress = Progress::default();
        let job = Job { name, progress: progress.clone(), began: Instant::now(), yields_to };
        let mut slots = self.shared.slots();
        if slots.meanwhile.take().is_some_and(|rank| rank <= yields_to) {
            progress.cancel();
        }
        slots.job = Some(job);
        drop(slots);
        let bench = &*self;
        let outcome = catch_unwind(AssertUnwindSafe(|| work(bench, &progress)));
        self.shared.slots().job = None;
        (self.wake)();
        match outcome {
            Ok(Ok(value)) => return Some(value),
            Ok(Err(_)) if progress.is_cancelled() && yields_to > Rank::Stop => {}
            Ok(Err(error)) if progress.is_cancelled() || error.is::<Cancelled>() => {
                self.tell(News::Cancelled(name));
            }
            Ok(Err(error)) => self.tell(News::Failed(name, format!("{error:#}"))),
            Err(_) => self.tell(News::Failed(name, "the work stopped on a fault of the program".into())),
        }
        None
    }

    fn tell_light(&self, light: &LightTransportSolution) {
        self.tell(News::Solution(Arc::new(light.clone())));
    }

    fn tell(&self, news: News) {
        // Without a receiver the window is gone, and the quit flag will be seen next.
        let _ = self.news.send(news);
        (self.wake)();
    }
}
