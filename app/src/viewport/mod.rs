//! The viewport: the picture, the camera in it, what is picked and what is dragged.
//!
//! The picture is drawn off screen, by the graphics device or on the processor, and shown as an image;
//! everything that is not light (lamps, handles, axes, read-outs) is painted over it by egui. Nothing
//! here changes the session: camera, selection and placements leave as commands.

pub mod compared;
pub mod cpu_picture;
pub mod drag;
pub mod gizmo;
pub mod gpu_picture;
pub mod interaction;
mod kernel;
pub mod navigation;
pub mod overlay;
pub mod pick;
pub mod picture;
pub mod request;
pub mod screen;
mod shown;

pub use pick::Pick;

use crate::{
    command::Command,
    light_paths::LightPaths,
    pipeline::KERNEL,
    session::{Compare, View},
    widgets::{Probe, legend},
};
use egui::{Color32, Rect, Sense, pos2, vec2};
use interaction::Interaction;
use kernel::PointedKernel;
use lumenscope_core::{
    glossy::inspect::KernelView,
    inspection::{InspectionScene, Legend},
    math::image::LinearImage,
    scene::{Scene, Target, camera::Camera},
    transport::LightTransportSolution,
};
use picture::{Meter, Painted, Picture};
use request::{Request, Same};
use screen::Screen;
use shown::Shown;
use std::sync::Arc;

/// Seconds after the last change for which things count as moving.
const MOVING_SECONDS: f64 = 0.25;

/// What the viewport shows.
pub struct ViewportInput<'a> {
    /// The scene with the user's edits; `None` before one is open.
    pub scene: Option<&'a Arc<Scene>>,
    /// Its light, possibly of an earlier edit.
    pub solution: Option<&'a Arc<LightTransportSolution>>,
    /// The reference picture so far, cd/m², seen from the view's camera.
    pub reference: Option<&'a Arc<LinearImage>>,
    /// How it is looked at.
    pub view: &'a View,
    /// Which of its light is shown.
    pub light_paths: &'a LightPaths,
    /// The open spheres.
    pub probe: Option<&'a Arc<Probe>>,
    /// What the inspection views put into the scene.
    pub inspection: Option<&'a Arc<InspectionScene>>,
    /// The window's wgpu device; without it the picture is drawn on the CPU.
    pub render_state: Option<&'a egui_wgpu::RenderState>,
}

/// What the user did in the viewport this frame.
#[derive(Debug, Default)]
pub struct ViewportOutput {
    /// Commands for the history.
    pub commands: Vec<Command>,
    /// What was clicked, or what was clicked earlier read again because the light has changed.
    pub pick: Option<Pick>,
    /// The kernel under the pointer, where its view is on.
    pub kernel: Option<Arc<KernelView>>,
    /// Seconds the picture last took.
    pub frame_seconds: f64,
    /// Exposure value the picture is shown with: the view's own, or the metered one.
    pub ev100: f32,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Whether the picture is finished: nothing better is on its way.
    pub settled: bool,
}

/// The viewport's own state: nothing that a session would save.
#[derive(Default)]
pub struct Viewport {
    picture: Picture,
    meter: Meter,
    interaction: Interaction,
    last: Option<(Camera, Same<LightTransportSolution>)>,
    moved_at: f64,
    pick: Option<(Pick, Same<LightTransportSolution>)>,
    shown: Shown,
    kernel: PointedKernel,
}

impl Viewport {
    /// A viewport with nothing in it.
    pub fn new() -> Self {
        Self::default()
    }

    /// Shows the picture and answers to mouse and keys, filling the space that `ui` has.
    pub fn show(&mut self, ui: &mut egui::Ui, input: &ViewportInput<'_>) -> ViewportOutput {
        let size = ui.available_size().max(vec2(16.0, 16.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        let response = response.on_hover_cursor(egui::CursorIcon::Default);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "viewport"));
        let mut view = input.view.clone();
        let screen = Screen { rect, camera: view.camera };
        let outcome = self.interaction.update(ui, &response, &screen, input, &mut view);
        let clicked = response.clicked().then(|| response.interact_pointer_pos()).flatten();
        let painter = ui.painter_at(rect);
        // What is seen follows at once, a frame before the session does.
        let screen = Screen { rect, camera: view.camera };
        painter.rect_filled(rect, 0.0, Color32::from_gray(12));
        let moving = self.is_moving(ui, input, &view);
        let mut out = ViewportOutput {
            commands: outcome.commands,
            pick: outcome.pick,
            size: pixels(ui, rect),
            ev100: view.display.ev100,
            ..ViewportOutput::default()
        };
        self.follow_pick(input, &mut out);
        self.follow_kernel(input, &view, &mut out);
        let painted = self.paint_picture(ui, &screen, input, &view, moving, &mut out);
        self.paint_marks(&painter, &screen, input, &view);
        self.paint_words(ui, &painter, &screen, input, &view, painted.as_ref());
        if let Some(compared) = painted.as_ref().and_then(|p| p.compared.as_deref()) {
            compared.show(ui, &painter, &screen);
        }
        if input.scene.is_some()
            && let Some(side) = overlay::triad(ui, &painter, &screen, clicked)
        {
            view.camera = navigation::from_side(view.camera, side);
        }
        if view != *input.view {
            out.commands.push(Command::View(Box::new(view)));
        }
        out
    }

    /// Reads the last pick again when the light has changed under it.
    fn follow_pick(&mut self, input: &ViewportInput<'_>, out: &mut ViewportOutput) {
        let Some(solution) = input.solution else { return };
        let now = Same(Some(solution.clone()));
        if out.pick.is_none()
            && let Some((pick, then)) = &self.pick
        {
            if *then == now {
                return;
            }
            out.pick = pick.again(then.0.as_deref(), solution);
        }
        self.pick = out.pick.clone().map(|pick| (pick, now));
    }

    /// Lets the kernel follow the pointer.
    fn follow_kernel(&mut self, input: &ViewportInput<'_>, view: &View, out: &mut ViewportOutput) {
        match input.solution.filter(|_| view.shows(KERNEL)) {
            Some(solution) => {
                let (glance, place) = (self.interaction.glance.as_ref(), view.probe.map(|p| p.0));
                out.kernel = self.kernel.follow(&solution.world, view.camera.eye, glance, place);
            }
            None => self.kernel = PointedKernel::default(),
        }
    }

    fn is_moving(&mut self, ui: &egui::Ui, input: &ViewportInput<'_>, view: &View) -> bool {
        let now = ui.input(|i| i.time);
        let shown = Some((view.camera, Same(input.solution.cloned())));
        if self.last != shown || self.interaction.is_dragging() {
            if self.last.is_some() {
                self.moved_at = now;
            } else {
                self.moved_at = now - MOVING_SECONDS;
            }
            self.last = shown;
        }
        let moving = now - self.moved_at < MOVING_SECONDS || self.interaction.is_turning();
        if moving {
            ui.ctx().request_repaint_after_secs(0.05);
        }
        moving
    }

    fn paint_picture(
        &mut self,
        ui: &egui::Ui,
        screen: &Screen,
        input: &ViewportInput<'_>,
        view: &View,
        moving: bool,
        out: &mut ViewportOutput,
    ) -> Option<Painted> {
        let bounces = input.light_paths.single_bounces();
        let lit_as = (view.gloss(), view.detail);
        let light = input.solution.map(|solution| self.shown.lit(ui.ctx(), solution, lit_as, bounces));
        let display = match &light {
            Some(light) => self.meter.display(ui.ctx(), light, view, screen.aspect())?,
            None => view.display,
        };
        out.ev100 = display.ev100;
        let compare = if input.reference.is_some() { view.compare } else { Compare::Picture };
        let reference = input.reference.filter(|r| r.width > 0 && r.height > 0);
        let size = match (compare, reference) {
            (compare, Some(reference)) if compare.is_comparison() => [reference.width, reference.height],
            _ => pixels(ui, screen.rect),
        };
        let request = light.map(|light| Request {
            light,
            camera: view.camera,
            size,
            direct: view.direct,
            weights: view.weights,
            display,
            inspection: input.inspection.cloned(),
            colours: view.colours,
            compare,
            reference: reference.cloned(),
            highlighted: match view.selected {
                Some(Target::Object(i)) => Some(i as u32),
                _ => None,
            },
        });
        let reference = reference.filter(|_| compare == Compare::Reference).map(|r| (r, &display));
        let painted = self.picture.show(ui.ctx(), input.render_state, request.as_ref(), reference, moving)?;
        out.frame_seconds = painted.status.seconds;
        out.settled = painted.settled && !moving && !self.meter.is_metering() && !self.shown.is_coming();
        let rect = match painted.aspect {
            // The vertical field of view is the camera's: a wider picture shows more at its sides.
            Some(aspect) => Rect::from_center_size(
                screen.rect.center(),
                vec2(screen.rect.height() * aspect, screen.rect.height()),
            ),
            None => screen.rect,
        };
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter_at(screen.rect).image(painted.texture, rect, whole, Color32::WHITE);
        Some(painted)
    }

    fn paint_marks(&self, painter: &egui::Painter, screen: &Screen, input: &ViewportInput<'_>, view: &View) {
        let Some(scene) = input.scene else { return };
        if let Some(target @ Target::Object(i)) = view.selected
            && i < scene.objects.len()
            && interaction::is_movable(scene, target)
        {
            let (low, high) = interaction::own_box(scene, target);
            let moving = self.interaction.is_dragging();
            overlay::outline(painter, screen, scene.placement(target), low, high, moving);
        }
        if let Some(scene) = self.kernel.scene() {
            self.kernel.paint(painter, screen, &scene.colours(&view.colours));
        }
        overlay::lamps(painter, screen, scene, view.selected, self.interaction.hovered_lamp);
        if let Some(probe) = view.probe {
            overlay::probe(painter, screen, probe);
        }
        self.interaction.paint(painter, input, view);
    }

    fn paint_words(
        &self,
        ui: &egui::Ui,
        painter: &egui::Painter,
        screen: &Screen,
        input: &ViewportInput<'_>,
        view: &View,
        painted: Option<&Painted>,
    ) {
        if input.scene.is_none() {
            return;
        }
        let mut status = painted.map(|p| p.status.clone()).unwrap_or_default();
        if view.compare != Compare::Picture && input.reference.is_none() {
            status.compare = Some("no reference yet, the picture instead");
        }
        overlay::status(painter, screen, &status, input.solution.map(Arc::as_ref));
        if let (Some(solution), Some(glance)) = (input.solution, &self.interaction.glance) {
            overlay::read_out(painter, screen, solution, glance);
        }
        if let (Some(inspection), Some(solution)) = (input.inspection, input.solution) {
            overlay::labels(painter, screen, &solution.world, &inspection.labels);
        }
        let mut legends: Vec<(Legend, _)> = Vec::new();
        if let Some(compared) = painted.and_then(|p| p.compared.as_deref()) {
            legends.push((compared.legend(), compared.colours));
        } else if let Some(colours) = view.display.false_colour {
            legends.push((luminance_legend("luminance", [colours.low, colours.high]), colours));
        }
        let shown = [input.inspection.map(Arc::as_ref), self.kernel.scene()];
        for inspection in shown.into_iter().flatten() {
            if let Some(legend) = &inspection.legend {
                legends.push((legend.clone(), inspection.colours(&view.colours)));
            }
        }
        for (i, (legend, colours)) in legends.iter().enumerate() {
            let size = legend::size(legend);
            let corner = screen.rect.right_top() + vec2(-(size.x + 10.0) * (i + 1) as f32, 10.0);
            if screen.rect.height() > size.y + 20.0 {
                legend::paint(painter, Rect::from_min_size(corner, size), legend, colours, ui.visuals());
            }
        }
    }
}

/// A legend of luminance or of a difference of it.
fn luminance_legend(quantity: &str, range: [f32; 2]) -> Legend {
    Legend { quantity: quantity.into(), unit: "cd/m²".into(), range, names: &[] }
}

fn pixels(ui: &egui::Ui, rect: Rect) -> [u32; 2] {
    let size = rect.size() * ui.pixels_per_point();
    [size.x, size.y].map(|s| (s.round() as u32).clamp(16, 4096))
}
