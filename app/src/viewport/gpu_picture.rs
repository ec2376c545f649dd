//! The picture drawn by the graphics device into a texture that egui shows.

use super::request::{DisplayKey, Lit, RenderKey, Request, Same};
use egui::TextureId;
use egui_wgpu::RenderState;
use lumenscope_core::{
    gpu::{
        device::GpuError,
        renderer::{FrameSettings, GpuRenderer},
    },
    inspection::InspectionScene,
    math::false_colour::FalseColour,
    superposition::composite::DirectQuality,
};
use std::{
    sync::{Arc, Mutex, PoisonError},
    time::Instant,
};

/// While things move, a frame aims at this many seconds.
const MOVING_SECONDS: f64 = 1.0 / 20.0;

/// A picture drawn by the graphics device.
pub struct GpuPicture {
    renderer: GpuRenderer,
    texture: Option<TextureId>,
    texture_size: [u32; 2],
    uploaded: Same<Lit>,
    inspected: Option<(Same<InspectionScene>, FalseColour)>,
    last: Option<RenderKey>,
    /// Frames in what is shown.
    pub frames: u32,
    /// Seconds the last frame took.
    pub seconds: f64,
    /// Name of the adapter.
    pub adapter: String,
    /// Pixels along a side over those there are.
    pub scale: f64,
    /// Whether the device has turned out to offer too little for the scene.
    pub failed: bool,
    in_flight: Option<Arc<Mutex<Option<f64>>>>,
    displayed: Option<DisplayKey>,
}

impl GpuPicture {
    /// Builds the renderer on egui's device.
    ///
    /// # Errors
    /// Where the device offers too little.
    pub fn new(state: &RenderState) -> Result<Self, GpuError> {
        let renderer = GpuRenderer::new(&state.device, wgpu::TextureFormat::Rgba8Unorm)?;
        Ok(Self {
            renderer,
            texture: None,
            texture_size: [0; 2],
            uploaded: Same(None),
            inspected: None,
            last: None,
            frames: 0,
            seconds: 0.0,
            adapter: state.adapter.get_info().name,
            scale: 0.7,
            failed: false,
            in_flight: None,
            displayed: None,
        })
    }

    /// Draws what is wanted if the device is free, and answers with the texture to show.
    pub fn show(
        &mut self,
        ctx: &egui::Context,
        state: &RenderState,
        request: &Request,
        moving: bool,
    ) -> Option<TextureId> {
        if !self.is_free(state) {
            ctx.request_repaint();
            return self.texture;
        }
        let key = request.render_key();
        let changed = self.last.as_ref() != Some(&key);
        let finished = !changed
            && self.frames >= request.frames_wanted()
            && self.displayed == Some(request.display_key());
        if finished || request.light.ready(ctx).is_none() {
            return self.texture;
        }
        if let Err(error) = self.upload(state, request) {
            log::error!("the graphics device cannot hold the scene: {error}");
            self.failed = true;
            return None;
        }
        let rest = !changed && !moving;
        let frame = self.frame(request, rest);
        let start = Instant::now();
        let mut encoder =
            state.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("picture") });
        self.renderer.render(&state.device, &state.queue, &mut encoder, &frame);
        state.queue.submit([encoder.finish()]);
        let seconds = Arc::new(Mutex::new(None));
        let done = seconds.clone();
        state.queue.on_submitted_work_done(move || {
            *done.lock().unwrap_or_else(PoisonError::into_inner) = Some(start.elapsed().as_secs_f64());
        });
        self.in_flight = Some(seconds);
        self.frames = if rest { frame.frame_index + 1 } else { 0 };
        self.last = Some(key);
        self.displayed = Some(request.display_key());
        self.present(state, self.renderer.size());
        ctx.request_repaint();
        self.texture
    }

    /// Whether what is shown is the finished picture of what was asked for last.
    pub fn settled(&self, request: &Request) -> bool {
        self.last == Some(request.render_key())
            && self.frames >= request.frames_wanted()
            && self.displayed == Some(request.display_key())
    }

    fn is_free(&mut self, state: &RenderState) -> bool {
        let Some(flight) = &self.in_flight else { return true };
        if let Err(error) = state.device.poll(wgpu::PollType::Poll) {
            log::error!("graphics device: {error}");
        }
        let seconds = *flight.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(seconds) = seconds else { return false };
        self.seconds = seconds;
        self.in_flight = None;
        if self.frames == 0 {
            let ratio = (MOVING_SECONDS / seconds.max(1e-4)).sqrt().clamp(0.7, 1.3);
            self.scale = (self.scale * ratio).clamp(0.25, 1.0);
        }
        true
    }

    fn upload(&mut self, state: &RenderState, request: &Request) -> Result<(), GpuError> {
        let light = Same(Some(request.light.clone()));
        if self.uploaded != light {
            let (solution, moved) = (&request.light.solution, request.light.moved());
            self.renderer.upload_lit(&state.device, &state.queue, solution, moved)?;
            self.uploaded = light;
        }
        let colours = request.inspection_colours();
        let inspected = Some((Same(request.inspection.clone()), colours));
        if self.inspected != inspected {
            let scene = request.inspection.as_deref();
            self.renderer.set_inspection(&state.device, &state.queue, scene, &colours)?;
            self.inspected = inspected;
        }
        Ok(())
    }

    fn frame(&self, request: &Request, rest: bool) -> FrameSettings {
        // Crisp shadows while moving only where the last frame says that there is time for them, and at
        // rest as many at once as keep the device ready for the next move.
        let quick = self.seconds > 0.0 && self.seconds < 0.5 * MOVING_SECONDS;
        let slow = self.seconds > 2.0 * MOVING_SECONDS;
        let direct = match request.direct {
            DirectQuality::PerPixel(_) if (rest && slow) || (!rest && quick) => DirectQuality::PerPixel(1),
            quality if rest => quality,
            _ => DirectQuality::Elements,
        };
        let scale = if rest { 1.0 } else { self.scale };
        FrameSettings {
            camera: request.camera,
            size: request.size.map(|s| ((f64::from(s) * scale) as u32).max(2)),
            weights: request.weights,
            display: request.display,
            direct,
            frame_index: if rest { self.frames.min(request.frames_wanted()) } else { 0 },
            accumulate: rest,
            highlighted: request.highlighted,
            seed: 1,
        }
    }

    fn present(&mut self, state: &RenderState, size: [u32; 2]) {
        let mut egui = state.renderer.write();
        let filter = wgpu::FilterMode::Linear;
        match self.texture {
            None => {
                let output = self.renderer.output();
                self.texture = Some(egui.register_native_texture(&state.device, output, filter));
            }
            Some(id) if self.texture_size != size => {
                let output = self.renderer.output();
                egui.update_egui_texture_from_wgpu_texture(&state.device, output, filter, id);
            }
            Some(_) => {}
        }
        self.texture_size = size;
    }
}
