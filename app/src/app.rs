//! The application: owns session, worker, viewport and dock, and forwards between them.
//!
//! Each frame: take the worker's news, show the panels, apply the commands they return, carry out the
//! effects. Nothing here waits.

mod effects;
mod keys;

use crate::{
    command::{Command, Window as WindowCommand},
    lightmaps::{JUDGING, LIGHTMAPS, LightmapFile},
    panels::{
        dock::{Dock, Pane, Shown},
        empty, help, menu,
        notice::{self, DropAnswer, Notice},
        status::{self, Badge},
    },
    pipeline::VolumeSource,
    placement::PLACEMENT,
    session::{Document, Effect, Session},
    session_file::{self, RecentFiles},
    viewport::Viewport,
    worker::{News, Worker},
};
use egui::{CentralPanel, Frame, Margin, Panel, Ui};
use lumenscope_core::glossy::inspect::KernelView;
use std::{
    path::{Path, PathBuf},
    sync::{Arc, mpsc},
    time::Instant,
};

/// Where the program keeps what outlives a session.
#[derive(Clone, Debug, Default)]
pub struct Config {
    /// Folder for the list of recent files; `None` keeps it in memory.
    pub folder: Option<PathBuf>,
}

impl Config {
    /// This user's own.
    pub fn of_user() -> Self {
        Self { folder: session_file::config_folder() }
    }
}

/// The application.
pub struct LumenscopeApp {
    session: Session,
    worker: Worker,
    viewport: Viewport,
    dock: Dock,
    recent: RecentFiles,
    chosen: (mpsc::Sender<Command>, mpsc::Receiver<Command>),
    render_state: Option<egui_wgpu::RenderState>,
    notice: Option<Notice>,
    dropped: Option<PathBuf>,
    /// What would lose unsaved edits, until the user has said what to do about them.
    asked: Option<Command>,
    /// Whether the window may close whatever is unsaved.
    leaving: bool,
    help: bool,
    alone: bool,
    lit: Option<Instant>,
    /// Whether the worker was at work when its news was last read: there may be more.
    expecting: bool,
}

impl LumenscopeApp {
    /// An application that opens a document, or none; its settings are this user's.
    ///
    /// # Errors
    /// If the system gives no thread to work on.
    pub fn new(cc: &eframe::CreationContext<'_>, document: Document) -> std::io::Result<Self> {
        Self::with_config(cc, document, &Config::of_user())
    }

    /// An application with settings kept elsewhere.
    ///
    /// # Errors
    /// If the system gives no thread to work on.
    pub fn with_config(
        cc: &eframe::CreationContext<'_>,
        document: Document,
        config: &Config,
    ) -> std::io::Result<Self> {
        crate::theme::install(&cc.egui_ctx);
        let ctx = cc.egui_ctx.clone();
        let mut app = Self {
            session: Session::default(),
            worker: Worker::start(move || ctx.request_repaint())?,
            viewport: Viewport::new(),
            dock: Dock::default(),
            recent: RecentFiles::load(config.folder.as_deref()),
            chosen: mpsc::channel(),
            render_state: cc.wgpu_render_state.clone(),
            notice: None,
            dropped: None,
            asked: None,
            leaving: false,
            help: false,
            alone: false,
            lit: None,
            expecting: false,
        };
        if let Some(path) = document.scene.clone() {
            if document == (Document { scene: Some(path.clone()), ..Document::default() }) {
                app.run(&cc.egui_ctx, Command::Open(path));
            } else {
                app.run(&cc.egui_ctx, Command::Replace(Box::new(document)));
            }
        }
        Ok(app)
    }

    /// The session, to look at.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// What was picked last.
    pub fn pick(&self) -> Option<&crate::viewport::Pick> {
        self.dock.pick.as_ref()
    }

    /// The kernel under the pointer, where its view is on and it has been on something glossy.
    pub fn kernel(&self) -> Option<&Arc<KernelView>> {
        self.dock.kernel.as_ref()
    }

    /// Files opened lately.
    pub fn recent(&self) -> &[PathBuf] {
        self.recent.files()
    }

    /// What the status badge says.
    pub fn badge(&self) -> Badge {
        Badge::of(&self.session, self.worker.is_solving())
    }

    /// Whether the worker has anything to do, or has done something that is not on screen yet.
    pub fn is_busy(&self) -> bool {
        self.expecting || self.worker.is_busy()
    }

    /// Whether there is a picture on screen, finished or not.
    pub fn has_picture(&self) -> bool {
        self.dock.pictured
    }

    /// Whether the picture on screen is finished.
    pub fn is_picture_settled(&self) -> bool {
        self.dock.settled
    }

    /// What could not be done, if it was not dismissed.
    pub fn notice(&self) -> Option<&Notice> {
        self.notice.as_ref()
    }

    /// What waits for the user to say whether unsaved edits are saved, if anything does.
    pub fn asked(&self) -> Option<&Command> {
        self.asked.as_ref()
    }

    /// Carries a command out; one that would lose unsaved edits asks first.
    pub fn run(&mut self, ctx: &egui::Context, command: Command) {
        if command.leaves() && self.session.is_dirty() {
            self.asked = Some(command);
        } else {
            self.run_anyway(ctx, command);
        }
    }

    fn run_anyway(&mut self, ctx: &egui::Context, command: Command) {
        for effect in self.session.apply(command) {
            self.carry_out(ctx, effect);
        }
    }

    /// A file was dropped onto the window.
    pub fn drop_file(&mut self, ctx: &egui::Context, path: &Path) {
        let is_model = path
            .extension()
            .is_some_and(|e| ["glb", "gltf", "obj"].iter().any(|m| e.eq_ignore_ascii_case(m)));
        if is_model && self.session.scene.is_some() {
            self.dropped = Some(path.to_path_buf());
        } else if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("volume"))
            && self.session.scene.is_some()
        {
            self.run(ctx, Command::CompareWith(VolumeSource::File(path.to_path_buf())));
        } else if LightmapFile::is_one(path) && self.session.scene.is_some() {
            self.dock.show_pane(Pane::Lightmap);
            self.run(ctx, Command::Lightmap(LightmapFile::new(path.to_path_buf())));
        } else {
            self.run(ctx, Command::Open(path.to_path_buf()));
        }
    }

    fn take_news(&mut self, ctx: &egui::Context) {
        self.expecting = self.worker.is_busy();
        for news in self.worker.news() {
            match news {
                News::Loaded(loaded) => self.take_scene(ctx, *loaded),
                News::Solution(solution) => {
                    self.session.take_light(solution);
                    self.lit = Some(Instant::now());
                    self.carry_out(ctx, Effect::Probe);
                    self.carry_out(ctx, Effect::Inspect);
                    self.carry_out(ctx, Effect::Texture);
                    self.carry_out(ctx, Effect::Lightmap);
                }
                News::Texture(made) => {
                    self.session.texture_awaited = false;
                    self.session.texture = made.filter(|_| self.session.document.view.surface.is_some());
                }
                News::Lightmap(judged) => {
                    // Another may have been opened meanwhile.
                    if self.session.lightmap_file.as_ref() == Some(&judged.file) {
                        self.session.lightmap = Some(judged);
                        if LIGHTMAPS.into_iter().any(|id| self.session.document.view.shows(id)) {
                            self.carry_out(ctx, Effect::Inspect);
                        }
                    }
                }
                News::Plan(plan) => self.session.plan = Some(plan),
                News::Measured(measured) => {
                    self.session.measurement = measured;
                    if self.session.document.view.shows(PLACEMENT) {
                        self.carry_out(ctx, Effect::Inspect);
                    }
                }
                News::Inspection(made) => {
                    let view = &self.session.document.view;
                    let wanted = view.volume.shown || !view.views.is_empty();
                    self.session.inspection = made.filter(|_| wanted);
                }
                News::Probe(probe, resolutions, moments) => {
                    if self.session.document.view.probe.is_some() {
                        self.session.probe = Some(probe);
                        self.session.resolutions = Arc::new(resolutions);
                        self.session.moments = moments.map(Arc::new);
                        if !self.session.document.view.views.is_empty() {
                            self.carry_out(ctx, Effect::Inspect);
                        }
                    }
                }
                News::OtherVolume(volume, source) => {
                    self.session.keep(volume, &source);
                    self.carry_out(ctx, Effect::Inspect);
                }
                News::Reference(reference, _) => self.session.reference = Some(reference),
                News::Written(path) => self.session.log.info(format!("{} written", path.display())),
                News::Cancelled(what) => {
                    self.give_up(ctx, what);
                    self.session.log.warn(format!("{what}: cancelled"));
                }
                News::Failed(what, why) => {
                    self.give_up(ctx, what);
                    self.fail(format!("{what} failed"), why);
                }
            }
        }
        while let Ok(command) = self.chosen.1.try_recv() {
            self.run(ctx, command);
        }
    }

    /// Lets go of what a job that ended early was for: it would be asked for again with every new light.
    fn give_up(&mut self, ctx: &egui::Context, what: &str) {
        if what == JUDGING {
            (self.session.lightmap_file, self.session.lightmap) = (None, None);
            self.carry_out(ctx, Effect::Inspect);
        }
    }

    fn take_scene(&mut self, ctx: &egui::Context, loaded: crate::pipeline::Loaded) {
        let scene = loaded.scene;
        let (triangles, name) = (scene.triangle_count(), scene.name.clone());
        for warning in &scene.warnings {
            self.session.log.warn(warning.clone());
        }
        let shown = loaded.session_file.clone().or_else(|| loaded.document.scene.clone());
        let effects = if loaded.added_only {
            self.session.reopen(loaded.document.edits.added, scene)
        } else {
            self.session.open(loaded.document, scene, loaded.session_file, loaded.fresh);
            self.viewport = Viewport::new();
            self.dock.pick = None;
            self.notice = None;
            vec![Effect::Follow { dragging: false }]
        };
        self.session.log.info(format!("{name} opened: {triangles} triangles"));
        if let Some(path) = shown
            && let Err(error) = self.recent.add(&path)
        {
            self.session.log.warn(format!("the list of recent files was not saved: {error:#}"));
        }
        self.carry_out(ctx, Effect::Measure);
        self.carry_out(ctx, Effect::Copies);
        for effect in effects {
            self.carry_out(ctx, effect);
        }
    }

    fn fail(&mut self, title: String, text: String) {
        self.session.log.error(format!("{title}: {text}"));
        self.notice = Some(Notice { title, text });
    }

    /// Takes note of the exposure that the viewport metered, to be shown and exported.
    fn expose(&mut self) {
        if self.session.document.view.auto_exposure && self.dock.ev100.is_finite() {
            self.session.document.view.display.ev100 = self.dock.ev100;
        }
    }

    fn windows(&mut self, ctx: &egui::Context) {
        help::show(ctx, &mut self.help);
        notice::show(ctx, &mut self.notice);
        if let Some(command) = self.asked.clone()
            && let Some(answer) = notice::ask_unsaved(ctx, &self.session)
        {
            self.asked = None;
            self.leave(ctx, answer, command);
        }
        if let Some(path) = self.dropped.clone()
            && let Some(answer) = notice::ask_drop(ctx, &path)
        {
            self.dropped = None;
            match answer {
                DropAnswer::Open => self.run(ctx, Command::Open(path)),
                DropAnswer::Add => self.run(ctx, Command::AddModel(path)),
                DropAnswer::Nothing => {}
            }
        }
        let dropped: Vec<PathBuf> =
            ctx.input(|i| i.raw.dropped_files.iter().map(|f| f.path().to_path_buf()).collect());
        for path in dropped {
            self.drop_file(ctx, &path);
        }
    }
}

impl eframe::App for LumenscopeApp {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        if !self.leaving && self.session.is_dirty() && ctx.input(|i| i.viewport().close_requested()) {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.asked = Some(Command::Window(WindowCommand::Quit));
        }
        self.take_news(&ctx);
        let mut out = Vec::new();
        keys::commands(&ctx, &self.session, &mut out);
        let bar = |ui: &Ui| Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(8, 3));
        let frame = bar(ui);
        Panel::top("menu")
            .frame(frame)
            .show_separator_line(false)
            .show(ui, |ui| menu::show(ui, &self.session, self.recent.files(), &mut out));
        let (badge, job) = (self.badge(), self.worker.job());
        if self.session.scene.is_some() {
            let age = self.lit.map(|l| l.elapsed());
            let frame = bar(ui);
            Panel::top("tools").frame(frame).exact_size(34.0).show(ui, |ui| {
                status::show(ui, &self.session, job.as_ref(), badge, age, &mut out);
            });
        }
        CentralPanel::default().frame(Frame::new().fill(ui.visuals().extreme_bg_color)).show(ui, |ui| {
            if self.session.scene.is_none() {
                empty::show(ui, self.recent.files(), self.worker.is_busy(), &mut out);
                return;
            }
            let shown = Shown {
                session: &self.session,
                inspection: self.session.inspection.as_ref(),
                render_state: self.render_state.as_ref(),
            };
            out.extend(self.dock.show(ui, &mut self.viewport, &shown, self.alone));
        });
        self.expose();
        self.windows(&ctx);
        for command in out {
            self.run(&ctx, command);
        }
        if job.is_some() {
            ctx.request_repaint_after(std::time::Duration::from_millis(100));
        }
    }
}
