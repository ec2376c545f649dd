//! What mouse and keys do: turn the camera, pick, drag.

use super::{
    Pick, ViewportInput,
    drag::Drag,
    gizmo::{Handles, Mouse},
    navigation, overlay,
    pick::{Glance, first_sphere, first_surface},
    screen::Screen,
};
use crate::{command::Command, session::View};
use egui::{Key, PointerButton, Pos2, Response, Ui};
use glam::{Affine3A, Vec3};
use lumenscope_core::scene::{Scene, Target, geometry::Geometry};

/// Radians a point of mouse movement turns the camera.
const TURN: f32 = 0.006;
/// Metres a second of flying, as a share of the scene's size.
const FLY: f32 = 0.22;

/// What the mouse holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Hold {
    #[default]
    Nothing,
    Orbit,
    Pan,
    Target(Drag),
    Handle,
}

/// Mouse and keys, and what they hold.
#[derive(Default)]
pub struct Interaction {
    hold: Hold,
    handles: Handles,
    /// The lamp under the cursor.
    pub hovered_lamp: Option<usize>,
    /// What lies under the cursor.
    pub glance: Option<Glance>,
}

/// What came of a frame's input.
#[derive(Default)]
pub struct Outcome {
    /// Commands other than those of the view.
    pub commands: Vec<Command>,
    /// What was clicked.
    pub pick: Option<Pick>,
}

impl Interaction {
    /// Whether a target is being dragged.
    pub fn is_dragging(&self) -> bool {
        matches!(self.hold, Hold::Target(_) | Hold::Handle)
    }

    /// Whether the camera is being turned.
    pub fn is_turning(&self) -> bool {
        matches!(self.hold, Hold::Orbit | Hold::Pan)
    }

    /// Answers to this frame's input; the camera, the selection and the open point change in `view`.
    pub fn update(
        &mut self,
        ui: &Ui,
        response: &Response,
        screen: &Screen,
        input: &ViewportInput<'_>,
        view: &mut View,
    ) -> Outcome {
        let mut out = Outcome::default();
        let cursor = response.hover_pos().filter(|p| screen.rect.contains(*p));
        self.hovered_lamp = match (cursor, input.scene) {
            (Some(at), Some(scene)) if self.hold == Hold::Nothing => overlay::lamp_at(screen, scene, at),
            _ => None,
        };
        self.glance = match (cursor, input.solution) {
            (Some(at), Some(solution)) if self.hold == Hold::Nothing => {
                Glance::along(solution, &screen.ray(at))
            }
            _ => None,
        };
        self.handle(ui, response, screen, input, view, &mut out);
        self.press(ui, response, screen, input);
        self.follow(ui, response, screen, view, &mut out);
        if response.clicked_by(PointerButton::Primary)
            && let Some(at) = response.interact_pointer_pos()
            && !self.handles.wants_mouse()
            && !overlay::over_triad(screen, at)
        {
            click(screen, input, at, view, &mut out);
        }
        self.wheel(ui, response, screen, view);
        keys(ui, response, screen, input, view);
        self.cursor_icon(ui, response, input);
        out
    }

    /// Paints the handles of the selected target.
    pub fn paint(&self, painter: &egui::Painter, input: &ViewportInput<'_>, view: &View) {
        if let (Some(target), Some(scene)) = (view.selected, input.scene)
            && is_movable(scene, target)
            && !matches!(self.hold, Hold::Target(_))
        {
            self.handles.paint(painter);
        }
    }

    fn handle(
        &mut self,
        ui: &Ui,
        response: &Response,
        screen: &Screen,
        input: &ViewportInput<'_>,
        view: &View,
        out: &mut Outcome,
    ) {
        let was_held = self.hold == Hold::Handle;
        let target = match (view.selected, input.scene) {
            (Some(target), Some(scene)) if is_movable(scene, target) => target,
            _ => {
                self.handles = Handles::default();
                if was_held {
                    self.hold = Hold::Nothing;
                    out.commands.push(Command::EndDrag);
                }
                return;
            }
        };
        let Some(scene) = input.scene else { return };
        let placement = scene.placement(target);
        let (pointer, pressed, down) = ui.input(|i| {
            let p = &i.pointer;
            (p.latest_pos(), p.primary_pressed(), p.primary_down())
        });
        let free = matches!(self.hold, Hold::Nothing | Hold::Handle) && !ui.input(|i| i.modifiers.alt);
        let mouse = Mouse {
            at: pointer.unwrap_or(Pos2::new(-1e4, -1e4)),
            hovered: free && (response.hovered() || was_held),
            pressed: pressed && response.contains_pointer(),
            down: down && free,
        };
        let moved = self.handles.update(screen, target, placement, pivot(scene, target), mouse);
        if let Some(placement) = moved {
            out.commands.push(Command::Place { target, placement, dragging: true });
        }
        match (was_held, self.handles.is_active()) {
            (false, true) => self.hold = Hold::Handle,
            (true, false) => {
                self.hold = Hold::Nothing;
                out.commands.push(Command::EndDrag);
            }
            _ => {}
        }
    }

    fn press(&mut self, ui: &Ui, response: &Response, screen: &Screen, input: &ViewportInput<'_>) {
        if self.hold != Hold::Nothing || !response.drag_started() {
            return;
        }
        let modifiers = ui.input(|i| i.modifiers);
        let origin = ui.input(|i| i.pointer.press_origin());
        self.hold = if response.drag_started_by(PointerButton::Secondary) {
            Hold::Pan
        } else if response.drag_started_by(PointerButton::Middle) {
            if modifiers.shift { Hold::Pan } else { Hold::Orbit }
        } else if modifiers.alt || self.handles.wants_mouse() {
            Hold::Orbit
        } else {
            match origin.and_then(|at| grab(screen, input, at)) {
                Some(drag) => Hold::Target(drag),
                None => Hold::Orbit,
            }
        };
    }

    fn follow(&mut self, ui: &Ui, response: &Response, screen: &Screen, view: &mut View, out: &mut Outcome) {
        let delta = response.drag_delta();
        match &mut self.hold {
            Hold::Nothing | Hold::Handle => return,
            Hold::Orbit => {
                view.camera = navigation::orbit(view.camera, delta.x * TURN, delta.y * TURN);
            }
            Hold::Pan if flying(ui) != Vec3::ZERO => {
                view.camera = navigation::look(view.camera, delta.x * TURN * 0.6, delta.y * TURN * 0.6);
            }
            Hold::Pan => {
                let distance = view.camera.eye.distance(view.camera.target);
                let metres = 1.0 / screen.points_per_metre(distance);
                view.camera = navigation::pan(view.camera, -delta.x * metres, delta.y * metres);
            }
            Hold::Target(drag) => {
                let (at, shift) = ui.input(|i| (i.pointer.latest_pos(), i.modifiers.shift));
                view.selected = Some(drag.target);
                if let Some(at) = at
                    && drag.follow(&screen.ray(at), shift)
                {
                    let Drag { target, placement, .. } = *drag;
                    out.commands.push(Command::Place { target, placement, dragging: true });
                }
            }
        }
        let down = ui.input(|i| i.pointer.any_down());
        if response.drag_stopped() || !down {
            if matches!(self.hold, Hold::Target(_)) {
                out.commands.push(Command::EndDrag);
            }
            self.hold = Hold::Nothing;
        }
    }

    fn wheel(&self, ui: &Ui, response: &Response, screen: &Screen, view: &mut View) {
        let Some(at) = response.hover_pos() else { return };
        let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = (-scroll * 0.0025).exp() / zoom.max(1e-3);
        if factor == 1.0 {
            return;
        }
        let ray = screen.ray(at);
        let distance = match &self.glance {
            Some(glance) => glance.distance,
            None => view.camera.eye.distance(view.camera.target),
        };
        view.camera = navigation::dolly(view.camera, ray.origin + ray.direction * distance, factor);
    }

    fn cursor_icon(&self, ui: &Ui, response: &Response, input: &ViewportInput<'_>) {
        use egui::CursorIcon;
        if !response.hovered() && self.hold == Hold::Nothing {
            return;
        }
        let icon = match self.hold {
            Hold::Target(_) | Hold::Handle => CursorIcon::Grabbing,
            Hold::Orbit => CursorIcon::Move,
            Hold::Pan => CursorIcon::AllScroll,
            Hold::Nothing if self.handles.wants_mouse() || self.hovered_lamp.is_some() => CursorIcon::Grab,
            Hold::Nothing => {
                let grabs = match (&self.glance, input.solution) {
                    (Some(glance), Some(solution)) => {
                        let geometry = &solution.world.geometry;
                        geometry.movable[geometry.object[glance.surface.triangle as usize] as usize]
                    }
                    _ => false,
                };
                if grabs { CursorIcon::Grab } else { CursorIcon::Crosshair }
            }
        };
        ui.set_cursor_icon(icon);
    }
}

/// The drag that a press begins: a lamp's glyph, else a movable object.
fn grab(screen: &Screen, input: &ViewportInput<'_>, at: Pos2) -> Option<Drag> {
    let ray = screen.ray(at);
    let scene = input.scene?;
    if let Some(i) = overlay::lamp_at(screen, scene, at) {
        let lamp = &scene.lamps[i];
        return Some(Drag::new(Target::Lamp(i), lamp.world_from_lamp, lamp.position(), &ray));
    }
    let (surface, distance) = first_surface(&input.solution?.world, &ray)?;
    let geometry = &input.solution?.world.geometry;
    let object = geometry.object[surface.triangle as usize] as usize;
    if !geometry.movable[object] || object >= scene.objects.len() {
        return None;
    }
    if input.inspection.and_then(|i| first_sphere(i, &ray)).is_some_and(|(_, t)| t < distance) {
        return None;
    }
    let placement = scene.objects[object].world_from_object;
    Some(Drag::new(Target::Object(object), placement, surface.position, &ray))
}

fn click(screen: &Screen, input: &ViewportInput<'_>, at: Pos2, view: &mut View, out: &mut Outcome) {
    let ray = screen.ray(at);
    if let Some(i) = input.scene.and_then(|scene| overlay::lamp_at(screen, scene, at)) {
        view.selected = Some(Target::Lamp(i));
        return;
    }
    let surface = input.solution.and_then(|s| first_surface(&s.world, &ray));
    if let Some(inspection) = input.inspection
        && let Some((sphere, t)) = first_sphere(inspection, &ray)
        && surface.as_ref().is_none_or(|(_, far)| t < *far)
    {
        view.probe = Some((inspection.spheres[sphere].centre, Vec3::Y));
        return;
    }
    match (surface, input.solution) {
        (Some((surface, _)), Some(solution)) => {
            let pick = Pick::at(solution, &surface);
            view.selected = Some(pick.target);
            view.probe = Some(pick.probe());
            view.surface = Some(pick.surface());
            out.pick = Some(pick);
        }
        _ => view.selected = None,
    }
}

fn keys(ui: &Ui, response: &Response, screen: &Screen, input: &ViewportInput<'_>, view: &mut View) {
    if ui.ctx().egui_wants_keyboard_input() || !(response.hovered() || response.has_focus()) {
        return;
    }
    let step = flying(ui);
    let (dt, fast, secondary) =
        ui.input(|i| (i.stable_dt.min(0.1), i.modifiers.shift, i.pointer.secondary_down()));
    if secondary && step != Vec3::ZERO {
        let size = bounds(input).map_or(5.0, |(low, high)| (high - low).length());
        let speed = FLY * size * if fast { 4.0 } else { 1.0 };
        view.camera = navigation::fly(view.camera, step * (speed * dt));
        ui.ctx().request_repaint();
    }
    let (selection, all) = ui.input(|i| {
        let plain = !i.modifiers.any();
        (plain && i.key_pressed(Key::F), plain && i.key_pressed(Key::Home))
    });
    let boxed = if selection {
        let selected = input.scene.zip(view.selected).map(|(scene, target)| world_box(scene, target));
        selected.or_else(|| bounds(input))
    } else if all {
        bounds(input)
    } else {
        None
    };
    if let Some((low, high)) = boxed {
        view.camera = navigation::frame(view.camera, low, high, screen.aspect());
    }
}

/// Direction of flight asked for by the keys: right, up, forward.
fn flying(ui: &Ui) -> Vec3 {
    ui.input(|i| {
        let axis = |plus: Key, minus: Key| {
            f32::from(u8::from(i.key_down(plus))) - f32::from(u8::from(i.key_down(minus)))
        };
        Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S)).normalize_or_zero()
    })
}

/// Whether the user may drag a target.
pub fn is_movable(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Lamp(i) => i < scene.lamps.len(),
        Target::Object(i) => scene.objects.get(i).is_some_and(|o| o.movable),
    }
}

/// Box around a target in its own frame, m.
pub fn own_box(scene: &Scene, target: Target) -> (Vec3, Vec3) {
    let Target::Object(i) = target else { return (Vec3::splat(-0.1), Vec3::splat(0.1)) };
    let Some(object) = scene.objects.get(i) else { return (Vec3::ZERO, Vec3::ZERO) };
    let points = object.parts.iter().flat_map(|p| &scene.meshes[p.mesh].positions);
    span(points.copied()).unwrap_or((Vec3::ZERO, Vec3::ZERO))
}

fn world_box(scene: &Scene, target: Target) -> (Vec3, Vec3) {
    let placement: Affine3A = scene.placement(target);
    let (low, high) = own_box(scene, target);
    let corners = (0..8).map(|i| {
        let pick = |bit: usize, a: f32, b: f32| if i >> bit & 1 == 0 { a } else { b };
        placement.transform_point3(Vec3::new(
            pick(0, low.x, high.x),
            pick(1, low.y, high.y),
            pick(2, low.z, high.z),
        ))
    });
    span(corners).unwrap_or((low, high))
}

fn span(mut points: impl Iterator<Item = Vec3>) -> Option<(Vec3, Vec3)> {
    let first = points.next()?;
    Some(points.fold((first, first), |(low, high), p| (low.min(p), high.max(p))))
}

/// Point that the handles sit on and turn about.
fn pivot(scene: &Scene, target: Target) -> Vec3 {
    let (low, high) = own_box(scene, target);
    scene.placement(target).transform_point3(0.5 * (low + high))
}

/// Box around everything, m.
fn bounds(input: &ViewportInput<'_>) -> Option<(Vec3, Vec3)> {
    if let Some(solution) = input.solution {
        return Some(Geometry::bounds(&solution.world.geometry));
    }
    let scene = input.scene?;
    let boxes = (0..scene.objects.len()).map(|i| world_box(scene, Target::Object(i)));
    span(boxes.flat_map(|(low, high)| [low, high]))
}
