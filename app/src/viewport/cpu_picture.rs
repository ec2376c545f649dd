//! The picture drawn on the processor, on threads of its own: the window never waits for it.
//!
//! While things move a coarse frame follows; at rest a sharp one lit from the elements replaces it, then
//! frames with shadow rays join a running mean, which is shown once its noise has gone down. A coarse
//! frame may start while another is still under way, so that the first move of the mouse shows at once.

use super::{
    compared::Compared,
    request::{DisplayKey, RenderKey, Request},
};
use egui::{ColorImage, TextureHandle, TextureOptions};
use lumenscope_core::{
    math::image::LinearImage,
    superposition::{
        self, PassSettings,
        accumulator::Accumulator,
        composite::{self, DirectQuality},
        gbuffer::GBuffer,
        layers::Layers,
        overlay,
    },
};
use std::{
    sync::{
        Arc,
        mpsc::{Receiver, TryRecvError, channel},
    },
    time::Instant,
};

/// A coarse frame aims at this many seconds.
const COARSE_SECONDS: f64 = 0.05;
/// Shadow rays an emitter in one full frame; the running mean does the rest.
const SAMPLES: u32 = 2;
/// Frames in the running mean of a picture at rest.
const FRAMES: u32 = 16;
/// The running mean is shown from this many frames on.
const FRAMES_TO_SHOW: u32 = 3;

/// A picture drawn on the processor.
#[derive(Default)]
pub struct CpuPicture {
    texture: Option<TextureHandle>,
    shown: Option<(RenderKey, DisplayKey)>,
    /// Frames in what is shown; 0 for one that the running mean will replace.
    pub frames: u32,
    /// Whether what is shown has fewer pixels than the viewport.
    pub coarse: bool,
    /// Seconds the last frame took.
    pub seconds: f64,
    /// How far what is shown is from the reference, where that is what it shows.
    pub compared: Option<Arc<Compared>>,
    kept: Option<Kept>,
    flights: Vec<Flight>,
    sharp: Option<(RenderKey, DisplayKey)>,
    wanted: Option<(RenderKey, DisplayKey)>,
    scale: f64,
}

/// The running mean of one point of view.
struct Kept {
    key: RenderKey,
    mean: Accumulator,
    buffer: GBuffer,
}

/// What a thread is drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Few pixels, lit from the elements.
    Coarse,
    /// All pixels, lit from the elements.
    Sharp,
    /// One more frame of the running mean.
    Mean,
}

struct Flight {
    stage: Stage,
    result: Receiver<Landed>,
}

struct Landed {
    key: RenderKey,
    display: DisplayKey,
    image: ColorImage,
    compared: Option<Arc<Compared>>,
    kept: Option<Kept>,
    frames: u32,
    seconds: f64,
    drew: bool,
}

impl CpuPicture {
    /// The latest picture, and work started on the next.
    pub fn show(&mut self, ctx: &egui::Context, request: &Request, moving: bool) -> Option<egui::TextureId> {
        self.land(ctx);
        let wanted = Some((request.render_key(), request.display_key()));
        let changed = self.wanted != wanted;
        let same_view = self.shown.as_ref().is_some_and(|(k, _)| *k == request.render_key());
        // A mean that is shown is brought to a new display by itself; anything less is drawn anew.
        let stale = self.shown != wanted && !(same_view && self.frames > 0);
        self.wanted = wanted;
        let coarse_flies = self.flights.iter().any(|f| f.stage == Stage::Coarse);
        let comparing = request.compare.is_comparison();
        if !coarse_flies && !comparing && stale && (changed || moving || self.texture.is_none()) {
            self.start_unaveraged(ctx, request.clone(), Stage::Coarse);
        } else if self.flights.is_empty() && !moving {
            if !comparing && self.coarse && self.sharp != self.wanted {
                self.sharp = self.wanted.clone();
                self.start_unaveraged(ctx, request.clone(), Stage::Sharp);
            } else {
                self.start_mean(ctx, request.clone());
            }
        }
        if moving {
            ctx.request_repaint();
        }
        self.texture.as_ref().map(TextureHandle::id)
    }

    /// Whether what is shown is the finished picture of what was asked for last.
    pub fn settled(&self, request: &Request) -> bool {
        self.flights.is_empty()
            && self.shown == Some((request.render_key(), request.display_key()))
            && self.frames >= frames_wanted(request)
    }

    /// Frames in the finished picture.
    pub fn frames_wanted(&self, request: &Request) -> u32 {
        frames_wanted(request)
    }

    fn land(&mut self, ctx: &egui::Context) {
        let mut flights = std::mem::take(&mut self.flights);
        flights.retain(|flight| match flight.result.try_recv() {
            Err(TryRecvError::Empty) => true,
            Err(TryRecvError::Disconnected) => false,
            Ok(landed) => {
                self.take(ctx, landed, flight.stage);
                false
            }
        });
        self.flights = flights;
    }

    fn take(&mut self, ctx: &egui::Context, landed: Landed, stage: Stage) {
        if landed.drew {
            self.seconds = landed.seconds;
        }
        if stage == Stage::Coarse {
            let ratio = (COARSE_SECONDS / landed.seconds.max(1e-4)).sqrt().clamp(0.7, 1.4);
            self.scale = (self.scale * ratio).clamp(0.15, 1.0);
        }
        let wanted = self.wanted.as_ref();
        let shows_wanted = self.shown.as_ref().is_some_and(|(k, _)| wanted.is_some_and(|w| w.0 == *k));
        let shows_display = self.shown.as_ref() == wanted;
        let is_wanted = wanted.is_some_and(|w| w.0 == landed.key);
        if let Some(kept) = landed.kept {
            self.kept = Some(kept);
        }
        // Coarse frames of a moment ago still show where things went; anything else that is old does not.
        let late = !is_wanted && (shows_wanted || stage != Stage::Coarse);
        let worse = shows_wanted
            && (self.frames > landed.frames || (stage == Stage::Coarse && !self.coarse && shows_display));
        let noisy = shows_wanted
            && stage == Stage::Mean
            && self.frames == 0
            && landed.compared.is_none()
            && landed.frames < FRAMES_TO_SHOW;
        if self.texture.is_some() && (late || worse || noisy) {
            return;
        }
        self.frames = landed.frames;
        self.coarse = stage == Stage::Coarse;
        self.compared = landed.compared;
        self.shown = Some((landed.key, landed.display));
        match &mut self.texture {
            Some(texture) => texture.set(landed.image, TextureOptions::LINEAR),
            None => self.texture = Some(ctx.load_texture("picture", landed.image, TextureOptions::LINEAR)),
        }
    }

    fn start_unaveraged(&mut self, ctx: &egui::Context, request: Request, stage: Stage) {
        if self.scale == 0.0 {
            self.scale = 0.4;
        }
        let scale = if stage == Stage::Coarse { self.scale } else { 1.0 };
        self.fly(ctx, stage, move || {
            let size = request.size.map(|s| ((f64::from(s) * scale) as u32).max(2));
            let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
            let (buffer, layers) = draw(&request, size, &settings);
            let picture = layers.sum(request.weights);
            let (image, compared) = to_display(&request, &picture, &buffer);
            Landed {
                key: request.render_key(),
                display: request.display_key(),
                image,
                compared,
                kept: None,
                frames: 0,
                seconds: 0.0,
                drew: true,
            }
        });
    }

    fn start_mean(&mut self, ctx: &egui::Context, request: Request) {
        let (key, display) = (request.render_key(), request.display_key());
        let current = self.kept.as_ref().is_some_and(|k| k.key == key);
        let enough =
            current && self.kept.as_ref().is_some_and(|k| k.mean.frames() >= frames_wanted(&request));
        let displayed =
            self.frames > 0 && self.shown.as_ref().is_some_and(|(k, d)| *k == key && *d == display);
        if enough && displayed {
            return;
        }
        let kept = self.kept.take().filter(|k| k.key == key);
        // A mean too short to be shown is not shown again but lengthened.
        let redisplay = kept.is_some() && !displayed && self.frames > 0;
        self.fly(ctx, Stage::Mean, move || {
            let (mut mean, buffer) = match kept {
                Some(k) => (k.mean, Some(k.buffer)),
                None => (Accumulator::new(), None),
            };
            let buffer = match buffer {
                Some(buffer) if redisplay => buffer,
                before => {
                    let (drawn, layers) = draw(&request, request.size, &settings(&request, mean.frames()));
                    mean.add(&layers);
                    // The first frame looks through the pixels' centres: its depths suit the overlay.
                    before.unwrap_or(drawn)
                }
            };
            let picture = mean.mean().sum(request.weights);
            let (image, compared) = to_display(&request, &picture, &buffer);
            let frames = mean.frames();
            let kept = Some(Kept { key: key.clone(), mean, buffer });
            Landed { key, display, image, compared, kept, frames, seconds: 0.0, drew: !redisplay }
        });
    }

    fn fly(&mut self, ctx: &egui::Context, stage: Stage, work: impl FnOnce() -> Landed + Send + 'static) {
        let (sender, result) = channel();
        let ctx = ctx.clone();
        let spawned = std::thread::Builder::new().name("picture".into()).spawn(move || {
            let start = Instant::now();
            let mut landed = work();
            landed.seconds = start.elapsed().as_secs_f64();
            // The window may have closed meanwhile: then nobody wants the picture.
            if sender.send(landed).is_ok() {
                ctx.request_repaint();
            }
        });
        match spawned {
            Ok(_) => self.flights.push(Flight { stage, result }),
            Err(error) => log::error!("no thread for the picture: {error}"),
        }
    }
}

fn draw(request: &Request, [width, height]: [u32; 2], settings: &PassSettings) -> (GBuffer, Layers) {
    let light = &request.light;
    superposition::render_lit(&light.solution, light.moved(), &request.camera, width, height, settings)
}

fn frames_wanted(request: &Request) -> u32 {
    // Without shadow rays the mean only smooths edges.
    if request.direct == DirectQuality::Elements { FRAMES / 2 } else { FRAMES }
}

fn settings(request: &Request, frame: u32) -> PassSettings {
    let direct = match request.direct {
        DirectQuality::PerPixel(samples) => DirectQuality::PerPixel(samples.clamp(1, SAMPLES)),
        DirectQuality::Elements => DirectQuality::Elements,
    };
    PassSettings { direct, frame, jitter: frame > 0, ..PassSettings::default() }
}

/// Brings a picture to the display: tone curve or comparison, then what the views draw over it.
fn to_display(
    request: &Request,
    picture: &LinearImage,
    buffer: &GBuffer,
) -> (ColorImage, Option<Arc<Compared>>) {
    let reference = request.reference.as_ref().filter(|r| {
        request.compare.is_comparison() && (r.width, r.height) == (picture.width, picture.height)
    });
    let (mut bytes, compared) = match reference {
        Some(reference) => {
            let (bytes, compared) = Compared::new(picture, reference, &request.display, request.compare);
            (bytes, Some(Arc::new(compared)))
        }
        None => (composite::display(picture, &request.display), None),
    };
    if let Some(inspection) = &request.inspection {
        overlay::draw(&mut bytes, buffer, &request.camera, inspection, &request.inspection_colours());
    }
    let size = [picture.width as usize, picture.height as usize];
    (ColorImage::from_rgba_unmultiplied(size, bytes.as_flattened()), compared)
}
