//! What the session asks for, carried out: the worker, files, dialogs, the window.

use super::LumenscopeApp;
use crate::{
    command::{Command, Dialog, Window},
    export::{Export, ExportRequest},
    grid_view::GridRequest,
    lightmaps::{EXTENSIONS, LightmapFile},
    panels::notice::UnsavedAnswer,
    pipeline::{Source, VolumeSource},
    session::Effect,
    session_file,
    worker::{InspectRequest, ProbeRequest, ReferenceRequest},
};
use egui::ViewportCommand;
use lumenscope_core::{superposition::composite::DirectQuality, transport::solution::State};
use std::{
    path::PathBuf,
    sync::{Arc, mpsc::Sender},
};

/// Widest reference traced while looking: larger ones take seconds a sample on two cores.
const REFERENCE_WIDTH: u32 = 480;

impl LumenscopeApp {
    pub(super) fn carry_out(&mut self, ctx: &egui::Context, effect: Effect) {
        match effect {
            Effect::Load(path) => self.worker.load(Source::File(path)),
            Effect::LoadExample(example) => self.worker.load(Source::File(example.key().into())),
            Effect::Replace(document) => self.worker.load(Source::Document(document)),
            Effect::AddModel(path) => {
                let mut document = self.session.document.clone();
                document.edits.added.push(path);
                self.worker.load(Source::Models(Box::new(document)));
            }
            Effect::Follow { dragging } => {
                if let Some(scene) = self.session.scene.clone() {
                    self.worker.follow(scene, dragging);
                }
            }
            Effect::Probe => {
                let view = &self.session.document.view;
                if let Some((position, _)) = view.probe {
                    self.worker.probe(ProbeRequest {
                        position,
                        n: view.probe_bins_n,
                        resolutions: view.probe_resolutions,
                        moments: view.moments(),
                    });
                }
            }
            Effect::Texture => {
                let view = &self.session.document.view;
                if view.surface.is_none() {
                    self.session.texture = None;
                }
                self.worker.texture(view.surface.map(|surface| GridRequest {
                    surface,
                    settings: view.stages,
                    traced: view.traced_texture,
                }));
            }
            Effect::Lightmap => {
                let settled =
                    self.session.solution.as_ref().is_some_and(|s| s.provenance.state == State::Settled);
                if let Some(file) = self.session.lightmap_file.clone().filter(|_| settled) {
                    self.worker.lightmap(file);
                }
            }
            Effect::Measure => self.worker.measure(self.session.document.edits.placement.clone()),
            Effect::Inspect => self.inspect(),
            Effect::Reference => {
                let Ok(paths) = self.session.light_paths.traced() else { return };
                let paths = paths.cloned();
                let size = self.picture_size(REFERENCE_WIDTH);
                let camera = self.session.document.view.camera;
                self.worker.reference(Some(ReferenceRequest { camera, size, paths }));
            }
            Effect::Copies => {
                let copies = self.session.document.view.copies;
                self.worker.copies(copies.map(|c| c.request(&self.session.kept)));
            }
            Effect::OtherVolume(source) => self.worker.other_volume(source),
            Effect::DropReference => self.worker.reference(None),
            Effect::Save(path) => self.save(path),
            Effect::Export(what, path) => self.export(what, path),
            Effect::Cancel => {
                if self.worker.cancel() {
                    self.session.document.view.copies = None;
                }
            }
            Effect::Dialog(dialog) => self.ask(dialog, None, ctx),
            Effect::Window(window) => self.change_window(window, ctx),
        }
    }

    fn inspect(&mut self) {
        let view = &self.session.document.view;
        let Some(solution) = self.session.solution.clone() else { return };
        if !view.volume.shown && view.views.is_empty() {
            self.session.inspection = None;
            return;
        }
        self.worker.inspect(InspectRequest {
            solution,
            probe: self.session.probe.clone(),
            measurement: self.session.measurement.clone(),
            requirement: self.session.document.edits.placement.requirement.clone(),
            surface: view.surface,
            volume: view.volume.clone(),
            views: view.views.clone(),
            kept: self.session.kept.clone(),
            lightmap: self.session.lightmap.clone(),
        });
    }

    fn picture_size(&self, width: u32) -> [u32; 2] {
        let shown = self.dock.viewport_size;
        let height = (width as f32 * shown.y / shown.x.max(1.0)).round();
        [width, height.clamp(1.0, 4.0 * width as f32) as u32]
    }

    fn save(&mut self, path: PathBuf) {
        let path =
            if session_file::is_session(&path) { path } else { path.with_extension(session_file::EXTENSION) };
        match session_file::write(&path, &self.session.document) {
            Ok(()) => {
                self.session.log.info(format!("session saved to {}", path.display()));
                if let Err(error) = self.recent.add(&path) {
                    self.session.log.warn(format!("the list of recent files was not saved: {error:#}"));
                }
                self.session.set_saved(path);
            }
            Err(error) => self.fail("Saving failed".into(), format!("{error:#}")),
        }
    }

    fn export(&mut self, what: Export, path: PathBuf) {
        let Some(solution) = self.session.solution.clone() else {
            self.fail("Nothing to export yet".into(), "the scene has no light so far".into());
            return;
        };
        let view = &self.session.document.view;
        self.worker.export(ExportRequest {
            what,
            path,
            solution: Arc::new(solution.with_gloss(view.gloss()).with_detail(view.detail)),
            camera: view.camera,
            size: self.picture_size(self.dock.viewport_size.x.clamp(16.0, 4096.0) as u32),
            weights: view.weights,
            display: view.display,
            shadow_rays: match view.direct {
                DirectQuality::Elements => 0,
                DirectQuality::PerPixel(rays) => rays.max(16),
            },
            probe: self.session.probe.clone(),
            orders: self.session.moments.iter().flat_map(|m| &m.of).map(|m| m.0).collect(),
            at: view.probe.map(|p| p.0),
        });
    }

    /// Asks for a file; `then` is carried out after the command that follows from the answer.
    fn ask(&mut self, dialog: Dialog, then: Option<Command>, ctx: &egui::Context) {
        let name = self.session.scene.as_ref().map_or("scene", |s| s.name.as_str());
        let sender = self.chosen.0.clone();
        if let Err(error) = ask_for_file(dialog, name, then, sender, ctx.clone()) {
            self.fail("The file dialog did not open".into(), error.to_string());
        }
    }

    /// Does what was answered about unsaved edits, then what would have lost them.
    pub(super) fn leave(&mut self, ctx: &egui::Context, answer: UnsavedAnswer, command: Command) {
        match (answer, self.session.file.clone()) {
            (UnsavedAnswer::Cancel, _) => {}
            (UnsavedAnswer::Discard, _) => self.run_anyway(ctx, command),
            (UnsavedAnswer::Save, Some(file)) => {
                self.run(ctx, Command::SaveSession(file));
                if !self.session.is_dirty() {
                    self.run_anyway(ctx, command);
                }
            }
            (UnsavedAnswer::Save, None) => self.ask(Dialog::SaveSession, Some(command), ctx),
        }
    }

    fn change_window(&mut self, window: Window, ctx: &egui::Context) {
        match window {
            Window::Help => self.help = !self.help,
            Window::Panels => self.alone = !self.alone,
            Window::ResetPanels => {
                self.alone = false;
                self.dock.reset_layout();
            }
            Window::Theme => ctx.set_theme(match ctx.theme() {
                egui::Theme::Dark => egui::Theme::Light,
                egui::Theme::Light => egui::Theme::Dark,
            }),
            Window::Quit => {
                self.leaving = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }
}

/// Opens a file dialog and sends the command that follows from its answer. The dialog is made here, as
/// some systems want it on the window's thread, and awaited on one of its own.
fn ask_for_file(
    dialog: Dialog,
    name: &str,
    then: Option<Command>,
    sender: Sender<Command>,
    ctx: egui::Context,
) -> std::io::Result<()> {
    let models = ["glb", "gltf", "obj"];
    let ask = rfd::AsyncFileDialog::new();
    let answer: std::pin::Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match dialog {
        Dialog::Open => {
            let all = ["glb", "gltf", "obj", "ron", session_file::EXTENSION];
            Box::pin(ask.set_title("Open a scene or session").add_filter("Scenes", &all).pick_file())
        }
        Dialog::AddModel => Box::pin(ask.set_title("Add a model").add_filter("Models", &models).pick_file()),
        Dialog::SaveSession => {
            let ask = ask.set_title("Save the session").set_file_name(format!("{name}.lumenscope"));
            Box::pin(ask.add_filter("Sessions", &[session_file::EXTENSION]).save_file())
        }
        Dialog::Export(what) => {
            let (format, extension) = what.format();
            let ask = ask.set_title(what.title()).set_file_name(what.file_name(name));
            Box::pin(ask.add_filter(format, &[extension]).save_file())
        }
        Dialog::Lightmap => {
            let ask = ask.set_title("A lightmap over the scene's texture coordinates");
            Box::pin(ask.add_filter("Lightmaps", &EXTENSIONS).pick_file())
        }
        Dialog::Volume => Box::pin(
            ask.set_title("Open an irradiance volume").add_filter("Volumes", &["volume"]).pick_file(),
        ),
        Dialog::Panoramas => {
            let ask = ask.set_title("A volume from panoramas: the list of nodes");
            Box::pin(ask.add_filter("List of nodes", &["ron"]).pick_file())
        }
    };
    std::thread::Builder::new().name("file dialog".into()).spawn(move || {
        let Some(file) = pollster::block_on(answer) else { return };
        let path = file.path().to_path_buf();
        let command = match dialog {
            Dialog::Open => Command::Open(path),
            Dialog::AddModel => Command::AddModel(path),
            Dialog::SaveSession => Command::SaveSession(path),
            Dialog::Export(what) => Command::Export(what, path),
            Dialog::Lightmap => Command::Lightmap(LightmapFile::new(path)),
            Dialog::Volume => Command::CompareWith(VolumeSource::File(path)),
            Dialog::Panoramas => Command::CompareWith(VolumeSource::Panoramas(path)),
        };
        // Without a receiver the window is gone.
        let _ = sender.send(command);
        if let Some(then) = then {
            let _ = sender.send(then);
        }
        ctx.request_repaint();
    })?;
    Ok(())
}
