//! The dock: the viewport with the panels around it, to be dragged about as the user likes.

use super::{kernel, layers, lightmap, log, placement, plan, readout, scene, texture, views};
use crate::{
    command::Command,
    pipeline::KERNEL,
    session::{Session, View},
    viewport::{Pick, Viewport, ViewportInput},
    widgets::sphere_inspector,
};
use egui::{Color32, Margin, Stroke, Ui, Visuals, WidgetText};
use egui_tiles::{
    Behavior, Container, Linear, LinearDir, SimplificationOptions, TabState, Tile, TileId, Tiles, Tree,
    UiResponse,
};
use lumenscope_core::{glossy::inspect::KernelView, inspection::InspectionScene};
use std::sync::Arc;

/// What a tile can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pane {
    /// The picture.
    Viewport,
    /// Objects and lamps.
    Scene,
    /// Terms of the picture, exposure and false colour.
    Layers,
    /// Inspection views.
    Views,
    /// Spheres at the probe.
    Sphere,
    /// Numbers at the point picked.
    Readout,
    /// The kernel of the glossy surface under the pointer.
    Kernel,
    /// Illuminance where it is measured, held against a task.
    Placement,
    /// The texture of the surface that was clicked.
    Texture,
    /// A lightmap baked elsewhere.
    Lightmap,
    /// The log.
    Log,
    /// The rendering plan.
    Plan,
}

impl Pane {
    /// Title of its tab.
    pub fn title(self) -> &'static str {
        match self {
            Self::Viewport => "Picture",
            Self::Scene => "Scene",
            Self::Layers => "Layers",
            Self::Views => "Views",
            Self::Sphere => "Spheres",
            Self::Readout => "Read-out",
            Self::Kernel => "Kernel",
            Self::Placement => "Placement",
            Self::Texture => "Texture",
            Self::Lightmap => "Lightmap",
            Self::Log => "Log",
            Self::Plan => "Plan",
        }
    }
}

/// What the panels show this frame.
pub struct Shown<'a> {
    /// The session.
    pub session: &'a Session,
    /// What the inspection views put into the scene.
    pub inspection: Option<&'a Arc<InspectionScene>>,
    /// The window's wgpu device.
    pub render_state: Option<&'a egui_wgpu::RenderState>,
}

/// The layout, and what panels remember between frames.
pub struct Dock {
    tree: Tree<Pane>,
    scene: scene::State,
    log: log::State,
    plan: plan::State,
    texture: texture::State,
    lightmap: lightmap::State,
    /// What was picked last.
    pub pick: Option<Pick>,
    /// The kernel under the pointer, where its view is on.
    pub kernel: Option<Arc<KernelView>>,
    /// Whether that was on in the last frame.
    kernel_shown: bool,
    /// Size of the viewport in points.
    pub viewport_size: egui::Vec2,
    /// Whether the picture is finished: nothing better is on its way.
    pub settled: bool,
    /// Whether there is a picture at all.
    pub pictured: bool,
    /// Exposure value the picture was last shown with.
    pub ev100: f32,
}

impl Default for Dock {
    fn default() -> Self {
        Self {
            tree: layout(),
            scene: scene::State::default(),
            log: log::State::default(),
            plan: plan::State::default(),
            texture: texture::State::default(),
            lightmap: lightmap::State::default(),
            pick: None,
            kernel: None,
            kernel_shown: false,
            viewport_size: egui::vec2(640.0, 400.0),
            settled: false,
            pictured: false,
            ev100: f32::NAN,
        }
    }
}

impl Dock {
    /// Puts the panels back where they were at first.
    pub fn reset_layout(&mut self) {
        self.tree = layout();
    }

    /// Brings a panel to the front of its tabs.
    pub fn show_pane(&mut self, pane: Pane) {
        self.tree.make_active(|_, tile| matches!(tile, Tile::Pane(p) if *p == pane));
    }

    /// Shows the whole dock, or the viewport alone.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        viewport: &mut Viewport,
        shown: &Shown<'_>,
        alone: bool,
    ) -> Vec<Command> {
        let kernel_shown = shown.session.document.view.shows(KERNEL);
        if kernel_shown && !self.kernel_shown {
            self.show_pane(Pane::Kernel);
        }
        self.kernel_shown = kernel_shown;
        let mut frame = Frame {
            shown,
            viewport,
            scene: &mut self.scene,
            log: &mut self.log,
            plan: &mut self.plan,
            texture: &mut self.texture,
            lightmap: &mut self.lightmap,
            pick: &mut self.pick,
            kernel: &mut self.kernel,
            size: &mut self.viewport_size,
            settled: &mut self.settled,
            pictured: &mut self.pictured,
            ev100: &mut self.ev100,
            out: Vec::new(),
        };
        if alone {
            frame.viewport(ui);
        } else {
            self.tree.ui(&mut frame, ui);
        }
        frame.out
    }
}

fn layout() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let mut tabs = |panes: &[Pane]| {
        let children = panes.iter().map(|&p| tiles.insert_pane(p)).collect();
        tiles.insert_tab_tile(children)
    };
    let scene = tabs(&[Pane::Scene]);
    let layers = tabs(&[Pane::Layers, Pane::Views, Pane::Plan]);
    let spheres = tabs(&[Pane::Sphere, Pane::Placement, Pane::Texture, Pane::Lightmap, Pane::Kernel]);
    let readout = tabs(&[Pane::Readout]);
    let log = tabs(&[Pane::Log]);
    let viewport = tiles.insert_pane(Pane::Viewport);
    let mut linear = |dir: LinearDir, children: &[(TileId, f32)]| {
        let mut linear = Linear::new(dir, children.iter().map(|c| c.0).collect());
        for &(child, share) in children {
            linear.shares.set_share(child, share);
        }
        tiles.insert_container(Container::Linear(linear))
    };
    let left = linear(LinearDir::Vertical, &[(scene, 0.5), (layers, 0.5)]);
    let middle = linear(LinearDir::Vertical, &[(viewport, 0.86), (log, 0.14)]);
    let right = linear(LinearDir::Vertical, &[(spheres, 0.7), (readout, 0.3)]);
    let root = linear(LinearDir::Horizontal, &[(left, 0.212), (middle, 0.518), (right, 0.27)]);
    Tree::new(egui::Id::unique("dock"), root, tiles)
}

struct Frame<'a, 'b> {
    shown: &'a Shown<'b>,
    viewport: &'a mut Viewport,
    scene: &'a mut scene::State,
    log: &'a mut log::State,
    plan: &'a mut plan::State,
    texture: &'a mut texture::State,
    lightmap: &'a mut lightmap::State,
    pick: &'a mut Option<Pick>,
    kernel: &'a mut Option<Arc<KernelView>>,
    size: &'a mut egui::Vec2,
    settled: &'a mut bool,
    pictured: &'a mut bool,
    ev100: &'a mut f32,
    out: Vec<Command>,
}

impl Frame<'_, '_> {
    fn viewport(&mut self, ui: &mut Ui) {
        let session = self.shown.session;
        *self.size = ui.available_size();
        let reference = session.reference.as_ref().map(|r| &r.image);
        let output = self.viewport.show(
            ui,
            &ViewportInput {
                scene: session.scene.as_ref(),
                solution: session.solution.as_ref(),
                reference,
                view: &session.document.view,
                light_paths: &session.light_paths,
                probe: session.probe.as_ref(),
                inspection: self.shown.inspection,
                render_state: self.shown.render_state,
            },
        );
        self.out.extend(output.commands);
        *self.kernel = output.kernel;
        *self.ev100 = output.ev100;
        *self.settled = output.settled;
        *self.pictured = output.frame_seconds > 0.0;
        if output.pick.is_some() {
            *self.pick = output.pick;
        }
    }

    fn panel(&mut self, ui: &mut Ui, pane: Pane) {
        let session = self.shown.session;
        let view: &View = &session.document.view;
        match pane {
            Pane::Viewport => self.viewport(ui),
            Pane::Scene => scene::show(ui, self.scene, session, &mut self.out),
            Pane::Layers => layers::show(ui, session, &mut self.out),
            Pane::Views => views::show(ui, session, self.shown.inspection, &mut self.out),
            Pane::Sphere => {
                let probe = session.probe.as_deref();
                let moments = session.moments.as_deref();
                self.out.extend(sphere_inspector::show(
                    ui,
                    probe,
                    &session.resolutions,
                    moments,
                    session.two_volumes(),
                    view,
                ));
            }
            Pane::Readout => readout::show(ui, self.pick.as_ref(), session, &mut self.out),
            Pane::Kernel => kernel::show(ui, session, self.kernel.as_deref(), &mut self.out),
            Pane::Placement => placement::show(ui, session, &mut self.out),
            Pane::Texture => texture::show(ui, self.texture, session, &mut self.out),
            Pane::Lightmap => lightmap::show(ui, self.lightmap, session, &mut self.out),
            Pane::Log => log::show(ui, self.log, &session.log),
            Pane::Plan => plan::show(ui, self.plan, session, &mut self.out),
        }
    }
}

impl Behavior<Pane> for Frame<'_, '_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        if *pane == Pane::Viewport {
            self.viewport(ui);
        } else {
            let fill = ui.visuals().panel_fill;
            egui::Frame::new().fill(fill).inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
                ui.set_min_size(ui.available_size());
                egui::ScrollArea::vertical().auto_shrink(false).id_salt(pane.title()).show(ui, |ui| {
                    self.panel(ui, *pane);
                });
            });
        }
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.title().into()
    }

    fn tab_bar_color(&self, visuals: &Visuals) -> Color32 {
        if visuals.dark_mode { visuals.extreme_bg_color } else { visuals.widgets.inactive.bg_fill }
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        25.0
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        2.0
    }

    fn tab_outline_stroke(&self, _: &Visuals, _: &Tiles<Pane>, _: TileId, _: &TabState) -> Stroke {
        Stroke::NONE
    }

    fn tab_bar_hline_stroke(&self, visuals: &Visuals) -> Stroke {
        Stroke::new(1.0, visuals.panel_fill)
    }

    fn tab_text_color(&self, v: &Visuals, _: &Tiles<Pane>, _: TileId, state: &TabState) -> Color32 {
        if state.active { v.strong_text_color() } else { v.weak_text_color() }
    }

    fn is_tile_draggable(&self, tiles: &Tiles<Pane>, tile: TileId) -> bool {
        !matches!(tiles.get(tile), Some(Tile::Pane(Pane::Viewport)))
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { prune_single_child_tabs: false, ..SimplificationOptions::default() }
    }
}
