//! The tool bar: whether the light on screen is settled, what is at work, and how to stop it.

use super::edit_view;
use crate::{
    command::{Command, Dialog},
    session::{Compare, Session},
    worker::Job,
};
use egui::{Align, Color32, Layout, ProgressBar, RichText, Ui, vec2};
use lumenscope_core::transport::solution::State;
use std::time::Duration;

/// Work shorter than this shows no bar: it would only flicker.
const PATIENCE: Duration = Duration::from_millis(500);

/// What the badge says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Badge {
    /// Nothing is open.
    Empty,
    /// The first light is on its way.
    Solving,
    /// There is no light, and none is on its way.
    Unlit,
    /// As good as the plan asks.
    Settled,
    /// Right but coarse, or on its way to a changed scene.
    Refining,
    /// Right but coarse, and stopped there.
    Coarse,
    /// The scene has changed since.
    Stale,
}

impl Badge {
    /// What to say of a session.
    pub fn of(session: &Session, solving: bool) -> Self {
        match (&session.scene, &session.solution) {
            (None, _) => Self::Empty,
            (Some(_), None) if solving => Self::Solving,
            (Some(_), None) => Self::Unlit,
            (Some(_), Some(_)) if solving => Self::Refining,
            (Some(_), Some(_)) if !session.is_lit_as_edited() => Self::Stale,
            (Some(_), Some(solution)) => match solution.provenance.state {
                State::Settled => Self::Settled,
                State::Refining => Self::Coarse,
                State::Stale => Self::Stale,
            },
        }
    }

    /// The word on it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Empty => "no scene",
            Self::Solving => "solving",
            Self::Unlit => "unlit",
            Self::Settled => "settled",
            Self::Refining => "refining",
            Self::Coarse => "coarse",
            Self::Stale => "stale",
        }
    }

    fn colour(self, ui: &Ui) -> Color32 {
        match self {
            Self::Settled => Color32::from_rgb(106, 176, 116),
            Self::Refining | Self::Solving | Self::Coarse => crate::theme::accent(ui.visuals()),
            Self::Stale | Self::Unlit => ui.visuals().error_fg_color,
            Self::Empty => ui.visuals().weak_text_color(),
        }
    }
}

/// Shows the tool bar; `age` is how old the light on screen is.
pub fn show(
    ui: &mut Ui,
    session: &Session,
    job: Option<&Job>,
    badge: Badge,
    age: Option<Duration>,
    out: &mut Vec<Command>,
) {
    ui.horizontal_centered(|ui| {
        if ui.button("Open…").on_hover_text("Open a scene or session (Ctrl+O)").clicked() {
            out.push(Command::Dialog(Dialog::Open));
        }
        let undo = ui.add_enabled(session.history.can_undo(), egui::Button::new("↶ Undo"));
        if undo.on_hover_text("Take the last step back (Ctrl+Z)").clicked() {
            out.push(Command::Undo);
        }
        let redo = ui.add_enabled(session.history.can_redo(), egui::Button::new("↷ Redo"));
        if redo.on_hover_text("Make the step again (Ctrl+Y)").clicked() {
            out.push(Command::Redo);
        }
        ui.separator();
        compare(ui, session, out);
        ui.separator();
        badge_ui(ui, badge, age);
        if matches!(badge, Badge::Unlit | Badge::Coarse | Badge::Stale)
            && ui.button("Solve").on_hover_text("Go on with the light where it was stopped").clicked()
        {
            out.push(Command::Solve);
        }
        if let Some(job) = job.filter(|j| j.began.elapsed() > PATIENCE) {
            let (stage, done) = job.progress.state();
            ui.label(RichText::new(job.name).weak());
            ui.add(ProgressBar::new(done).desired_width(170.0).desired_height(16.0).text(stage));
            if ui.button("Cancel").on_hover_text("Stop; what is on screen stays").clicked() {
                out.push(Command::Cancel);
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| title(ui, session));
    });
}

fn title(ui: &mut Ui, session: &Session) {
    let Some(scene) = &session.scene else { return };
    let changed = if session.is_dirty() { " •" } else { "" };
    let facts = format!("{} triangles, {} objects", scene.triangle_count(), scene.objects.len());
    ui.label(RichText::new(format!("{}{changed}", scene.name)).strong()).on_hover_text(match &session.file {
        Some(file) => format!("{}\n{facts}", file.display()),
        None => facts.clone(),
    });
    ui.label(RichText::new(facts).small().weak());
}

/// Why there is no difference to be shown.
const NOT_COMPARABLE: &str =
    "No sum of the layers is the light of this expression: there is nothing to compare the reference with.";

fn compare(ui: &mut Ui, session: &Session, out: &mut Vec<Command>) {
    let view = &session.document.view;
    for (compare, label, hint) in [
        (Compare::Picture, "Picture", "The superposition renderer's picture: a weighted sum of layers."),
        (
            Compare::Reference,
            "Reference",
            "The path tracer's picture, the ground truth: unbiased, and noisy until it has many samples.",
        ),
        (Compare::Difference, "Difference", "|Y − Y_ref|: absolute difference of luminance, cd/m²."),
        (
            Compare::Flip,
            "FLIP",
            "What an observer would notice who flips between picture and reference on this display, from 0 to 1 \
             (Andersson and others, 2020).",
        ),
    ] {
        let comparable = !compare.is_comparison() || session.light_paths.is_comparable();
        let enabled = session.scene.is_some() && comparable;
        let button = ui
            .add_enabled(enabled, egui::Button::selectable(view.compare == compare, label))
            .on_disabled_hover_text(NOT_COMPARABLE);
        if button.on_hover_text(format!("{hint} (R)")).clicked() {
            edit_view(view, out, |v| v.compare = compare);
        }
    }
    if view.compare != Compare::Picture
        && let Some(reference) = &session.reference
    {
        ui.label(RichText::new(format!("{} samples a pixel", reference.samples)).small().weak());
    }
}

fn badge_ui(ui: &mut Ui, badge: Badge, age: Option<Duration>) {
    let colour = badge.colour(ui);
    let (dot, _) = ui.allocate_exact_size(vec2(10.0, 10.0), egui::Sense::hover());
    ui.painter().circle_filled(dot.center(), 4.0, colour);
    let aged = match (badge, age) {
        (Badge::Stale | Badge::Refining, Some(age)) => {
            format!("{} · {:.1} s", badge.label(), age.as_secs_f64())
        }
        _ => badge.label().to_owned(),
    };
    ui.label(RichText::new(aged).color(colour)).on_hover_text(
        "Whether the light on screen belongs to the scene as it stands, and how old it is.\n\
         settled: as good as the plan asks\n\
         refining: better light is on its way\n\
         coarse: right, but stopped before it was refined\n\
         stale: the scene has changed since",
    );
}
