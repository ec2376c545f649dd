//! The thread behind the worker: takes what is wanted most and does it.

use super::{ExportRequest, Job, LIGHT, News, ProbeRequest, ReferenceRequest, Shared, Slots, Source};
use crate::{export, pipeline};
use anyhow::Result;
use lumenscope_core::{
    math::progress::{Cancelled, Progress},
    scene::Scene,
    transport::LightTransportSolution,
};
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, PoisonError, mpsc::Sender},
    time::Instant,
};

enum Task {
    Load(Source),
    Light(Arc<Scene>, bool),
    Probe(ProbeRequest),
    Export(Box<ExportRequest>),
    Reference(Option<ReferenceRequest>),
    MoreSamples,
}

/// What the thread keeps between jobs.
pub(super) struct Bench {
    shared: Arc<Shared>,
    news: Sender<News>,
    wake: Box<dyn Fn() + Send>,
    solution: Option<Arc<LightTransportSolution>>,
    reference: Option<pipeline::ReferenceWork>,
    revision: u64,
}

impl Bench {
    pub(super) fn new(shared: Arc<Shared>, news: Sender<News>, wake: Box<dyn Fn() + Send>) -> Self {
        Self { shared, news, wake, solution: None, reference: None, revision: 0 }
    }

    /// Works until told to quit.
    pub(super) fn run(mut self) {
        while let Some(task) = self.next() {
            match task {
                Task::Load(source) => self.load(source),
                Task::Light(scene, dragging) => self.light(&scene, dragging),
                Task::Probe(request) => self.probe(request),
                Task::Export(request) => {
                    if let Some(()) = self.job("Exporting", false, |_, p| export::write(&request, p)) {
                        self.tell(News::Written(request.path));
                    }
                }
                Task::Reference(request) => self.begin_reference(request),
                Task::MoreSamples => self.more_samples(),
            }
        }
    }

    /// The task wanted most; waits for one. `None` to quit.
    fn next(&self) -> Option<Task> {
        let mut slots = self.shared.slots();
        loop {
            if slots.quit {
                return None;
            }
            if let Some(task) = self.take(&mut slots) {
                return Some(task);
            }
            slots = self.shared.wake.wait(slots).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn take(&self, slots: &mut Slots) -> Option<Task> {
        if let Some(source) = slots.load.take() {
            return Some(Task::Load(source));
        }
        if let Some((scene, dragging)) = slots.scene.take() {
            return Some(Task::Light(scene, dragging));
        }
        if self.solution.is_some()
            && let Some(request) = slots.probe.take()
        {
            return Some(Task::Probe(request));
        }
        if let Some(request) = slots.exports.pop_front() {
            return Some(Task::Export(Box::new(request)));
        }
        if let Some(request) = slots.reference.take() {
            return Some(Task::Reference(request));
        }
        self.reference.as_ref().is_some_and(|r| !r.is_done()).then_some(Task::MoreSamples)
    }

    fn load(&mut self, source: Source) {
        if let Some(loaded) = self.job("Opening", false, |_, progress| pipeline::load(source, progress)) {
            self.solution = None;
            self.reference = None;
            self.tell(News::Loaded(Box::new(loaded)));
        }
    }

    fn light(&mut self, scene: &Arc<Scene>, _dragging: bool) {
        self.revision += 1;
        let revision = self.revision;
        let mut newest = None;
        self.job(LIGHT, false, |bench, progress| {
            pipeline::solve(scene, revision, progress, &mut |solution| {
                let solution = Arc::new(solution);
                newest = Some(Arc::clone(&solution));
                bench.tell(News::Solution(solution));
            })
        });
        if newest.is_some() {
            self.solution = newest;
        }
    }

    fn probe(&mut self, request: ProbeRequest) {
        let Some(solution) = self.solution.clone() else { return };
        let ProbeRequest { position, normal, n } = request;
        if let Some(probe) = self.job("Sampling the spheres", true, |_, progress| {
            pipeline::probe(&solution, position, normal, n, progress)
        }) {
            self.tell(News::Probe(Arc::new(probe)));
        }
    }

    fn begin_reference(&mut self, request: Option<ReferenceRequest>) {
        self.reference = match (request, &self.solution) {
            (Some(request), Some(solution)) => {
                Some(pipeline::ReferenceWork::new(&solution.world, request.camera, request.size))
            }
            _ => None,
        };
    }

    fn more_samples(&mut self) {
        let Some(mut work) = self.reference.take() else { return };
        let done = self.job("Path tracing the reference", true, |_, progress| work.more(progress));
        if let Some(picture) = done {
            self.tell(News::Reference(picture));
        }
        self.reference = Some(work);
    }

    /// Runs a job with its progress on show; what goes wrong becomes news.
    fn job<T>(
        &mut self,
        name: &'static str,
        preemptible: bool,
        work: impl FnOnce(&Self, &Progress) -> Result<T>,
    ) -> Option<T> {
        let progress = Progress::default();
        let job = Job { name, progress: progress.clone(), began: Instant::now(), preemptible };
        self.shared.slots().job = Some(job);
        let bench = &*self;
        let outcome = catch_unwind(AssertUnwindSafe(|| work(bench, &progress)));
        self.shared.slots().job = None;
        (self.wake)();
        match outcome {
            Ok(Ok(value)) => return Some(value),
            Ok(Err(_)) if progress.is_cancelled() && preemptible => {}
            Ok(Err(error)) if progress.is_cancelled() || error.is::<Cancelled>() => {
                self.tell(News::Cancelled(name));
            }
            Ok(Err(error)) => self.tell(News::Failed(name, format!("{error:#}"))),
            Err(_) => self.tell(News::Failed(name, "the work stopped on a fault of the program".into())),
        }
        None
    }

    fn tell(&self, news: News) {
        // Without a receiver the window is gone, and the quit flag will be seen next.
        let _ = self.news.send(news);
        (self.wake)();
    }
}
