//! The picture in the viewport: who draws it, how it is exposed, what it is compared with.

use super::{
    compared::Compared,
    cpu_picture::CpuPicture,
    gpu_picture::GpuPicture,
    overlay::Status,
    request::{Lit, Request, Same},
};
use crate::session::{Compare, View};
use egui::{ColorImage, TextureHandle, TextureId, TextureOptions};
use egui_wgpu::RenderState;
use lumenscope_core::{
    math::image::LinearImage,
    scene::camera::Camera,
    superposition::{
        self, PassSettings,
        composite::{self, DirectQuality, Display},
        layers::Weights,
    },
};
use std::sync::{
    Arc,
    mpsc::{Receiver, TryRecvError, channel},
};

/// What is to be painted.
pub struct Painted {
    /// The texture.
    pub texture: TextureId,
    /// Width over height, where it is not the viewport's own.
    pub aspect: Option<f32>,
    /// What is said about it.
    pub status: Status,
    /// How far it is from the reference, where that is what it shows.
    pub compared: Option<Arc<Compared>>,
    /// Whether nothing better is on its way.
    pub settled: bool,
}

/// The picture in the viewport.
#[derive(Default)]
pub struct Picture {
    cpu: CpuPicture,
    gpu: Option<GpuPicture>,
    gpu_failed: bool,
    reference: Option<(Same<LinearImage>, Display, TextureHandle)>,
}

impl Picture {
    /// Draws what is wanted, or starts to, and answers with what there is.
    pub fn show(
        &mut self,
        ctx: &egui::Context,
        state: Option<&RenderState>,
        request: Option<&Request>,
        reference: Option<(&Arc<LinearImage>, &Display)>,
        moving: bool,
    ) -> Option<Painted> {
        if let Some((image, display)) = reference
            && request.is_none_or(|r| r.compare == Compare::Reference)
        {
            return self.reference(ctx, image, display);
        }
        let request = request?;
        let mut status = Status {
            compare: match request.compare {
                Compare::Difference => Some("difference to reference"),
                Compare::Flip => Some("noticeable difference to reference"),
                Compare::Picture | Compare::Reference => None,
            },
            ..Status::default()
        };
        let by_processor = request.compare.is_comparison() || request.light.solution.is_asked_at_pixels();
        let state = state.filter(|_| !by_processor);
        if let Some(state) = state
            && self.open(state)
            && let Some(gpu) = &mut self.gpu
        {
            let texture = gpu.show(ctx, state, request, moving);
            if gpu.failed {
                self.gpu = None;
                self.gpu_failed = true;
                ctx.request_repaint();
            }
            let (Some(texture), Some(gpu)) = (texture, &self.gpu) else { return None };
            status.frames = (gpu.frames, request.frames_wanted());
            status.seconds = gpu.seconds;
            status.backend.clone_from(&gpu.adapter);
            status.coarse = gpu.frames == 0 && gpu.scale < 0.99;
            let settled = gpu.settled(request);
            return Some(Painted { texture, aspect: None, status, compared: None, settled });
        }
        let texture = self.cpu.show(ctx, request, moving)?;
        status.frames = (self.cpu.frames, self.cpu.frames_wanted(request));
        status.seconds = self.cpu.seconds;
        status.backend = "processor".into();
        status.coarse = self.cpu.coarse;
        let aspect =
            request.compare.is_comparison().then(|| request.size[0] as f32 / request.size[1].max(1) as f32);
        let settled = self.cpu.settled(request);
        Some(Painted { texture, aspect, status, compared: self.cpu.compared.clone(), settled })
    }

    /// Opens the graphics device, unless it is software: then the processor does it better by itself.
    fn open(&mut self, state: &RenderState) -> bool {
        let wanted = state.adapter.get_info().device_type != wgpu::DeviceType::Cpu;
        if wanted && self.gpu.is_none() && !self.gpu_failed {
            match GpuPicture::new(state) {
                Ok(gpu) => self.gpu = Some(gpu),
                Err(error) => {
                    log::warn!("the processor draws the picture, as the graphics device cannot: {error}");
                    self.gpu_failed = true;
                }
            }
        }
        wanted && self.gpu.is_some()
    }

    fn reference(
        &mut self,
        ctx: &egui::Context,
        image: &Arc<LinearImage>,
        display: &Display,
    ) -> Option<Painted> {
        if image.width == 0 || image.height == 0 {
            return None;
        }
        let key = Same(Some(image.clone()));
        let current = self.reference.as_ref().is_some_and(|(k, d, _)| *k == key && d == display);
        if !current {
            let bytes = composite::display(image, display);
            let size = [image.width as usize, image.height as usize];
            let pixels = ColorImage::from_rgba_unmultiplied(size, bytes.as_flattened());
            match &mut self.reference {
                Some((k, d, texture)) => {
                    (*k, *d) = (key, *display);
                    texture.set(pixels, TextureOptions::LINEAR);
                }
                None => {
                    let texture = ctx.load_texture("reference", pixels, TextureOptions::LINEAR);
                    self.reference = Some((key, *display, texture));
                }
            }
        }
        let (_, _, texture) = self.reference.as_ref()?;
        Some(Painted {
            texture: texture.id(),
            aspect: Some(image.width as f32 / image.height as f32),
            status: Status { compare: Some("reference (path traced)"), ..Status::default() },
            compared: None,
            settled: true,
        })
    }
}

/// The display of a view with its exposure settled: metered from the picture where it follows it.
///
/// Metered on a thread of its own: what is on screen keeps its exposure until the next is known.
#[derive(Default)]
pub struct Meter {
    /// What was metered last, or is being metered.
    key: Option<MeterKey>,
    /// The answer on its way.
    flight: Option<Receiver<Option<f32>>>,
    ev100: Option<f32>,
}

type MeterKey = (Same<Lit>, Camera, Weights);

impl Meter {
    /// The view's display, exposure settled; `None` before the first exposure is known.
    pub fn display(
        &mut self,
        ctx: &egui::Context,
        light: &Arc<Lit>,
        view: &View,
        aspect: f32,
    ) -> Option<Display> {
        if !view.auto_exposure {
            *self = Self::default();
            return Some(view.display);
        }
        match self.flight.as_ref().map(Receiver::try_recv) {
            Some(Ok(found)) => {
                self.ev100 = found.or(self.ev100).or(Some(view.display.ev100));
                self.flight = None;
            }
            Some(Err(TryRecvError::Disconnected)) => {
                log::error!("the exposure was not found");
                self.ev100 = self.ev100.or(Some(view.display.ev100));
                self.flight = None;
            }
            Some(Err(TryRecvError::Empty)) | None => {}
        }
        let key: MeterKey = (Same(Some(light.clone())), view.camera, view.weights);
        if self.flight.is_none() && self.key.as_ref() != Some(&key) {
            self.start(ctx, light.clone(), view, aspect);
            self.key = Some(key);
        }
        Some(Display { ev100: self.ev100?, ..view.display })
    }

    /// Whether a better exposure is on its way.
    pub fn is_metering(&self) -> bool {
        self.flight.is_some()
    }

    fn start(&mut self, ctx: &egui::Context, light: Arc<Lit>, view: &View, aspect: f32) {
        let (sender, answer) = channel();
        let (camera, weights, ctx) = (view.camera, view.weights, ctx.clone());
        let spawned = std::thread::Builder::new().name("meter".into()).spawn(move || {
            // The window may have closed meanwhile.
            if sender.send(metered(&light, &camera, weights, aspect)).is_ok() {
                ctx.request_repaint();
            }
        });
        match spawned {
            Ok(_) => self.flight = Some(answer),
            Err(error) => {
                log::error!("no thread for the exposure: {error}");
                self.ev100 = self.ev100.or(Some(view.display.ev100));
            }
        }
    }
}

/// Exposure value that suits what a camera sees; `None` where all is black.
fn metered(light: &Lit, camera: &Camera, weights: Weights, aspect: f32) -> Option<f32> {
    const HEIGHT: u32 = 27;
    let width = ((HEIGHT as f32 * aspect) as u32).clamp(8, 96);
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let layers =
        superposition::render_lit(&light.solution, light.moved(), camera, width, HEIGHT, &settings).1;
    composite::auto_exposure(&layers.sum(weights))
}
