//! The help window: keys, mouse, and what the colours mean.

use egui::{Align2, Context, Grid, RichText, Window};

const KEYS: [(&str, &str); 20] = [
    ("Ctrl+O", "Open a scene or session"),
    ("Ctrl+S", "Save the session"),
    ("Ctrl+Shift+S", "Save the session as a new file"),
    ("Ctrl+Z", "Undo"),
    ("Ctrl+Shift+Z, Ctrl+Y", "Redo"),
    ("1 to 5", "Show emitted, direct, indirect, mirror, glossy light alone; again for all"),
    ("R", "Picture, reference, difference, FLIP in turn"),
    ("V", "Volume of irradiance spheres on and off"),
    ("I, Shift+I", "Compare the volume without the light of what is selected, of the material clicked"),
    ("F", "Frame the selection, or everything"),
    ("Home", "Frame everything"),
    ("W A S D Q E", "Fly and look, with the right mouse button held; Shift flies faster"),
    ("Esc", "Drop the selection"),
    ("Tab", "Hide and show the panels"),
    ("F1", "This window"),
    ("Drag", "Orbit; with the right button, pan"),
    (
        "Drag a thing",
        "Move a lamp or a movable object; with Shift, up and down; with Alt, orbit all the same",
    ),
    ("Wheel", "Nearer and farther"),
    (
        "Click",
        "Pick a point: read-out, spheres, and its surface's texture; on a volume sphere, its own light",
    ),
    ("Drop a file", "Open a scene or session, add a model, or hold a lightmap against our light"),
];

const COLOURS: [(&str, &str); 4] = [
    ("Settled", "What is on screen is as good as the plan asks."),
    ("Refining", "What is on screen is right but coarse; better light is on its way."),
    ("Stale", "The scene has changed since this light was computed."),
    (
        "False colour",
        "Each colour is a value: read it off the legend, which names the quantity and its unit. \
         Values beyond the range take the end's colour.",
    ),
];

/// Shows the window while `open`.
pub fn show(ctx: &Context, open: &mut bool) {
    Window::new("Help")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .default_width(600.0)
        .show(ctx, |ui| {
            ui.label(
                "lumenscope shows how light flows in a scene. The picture is a sum of layers: light \
                 that emitters send to the eye, light that reached a surface straight from them, and \
                 light that reached it after at least one bounce.",
            );
            ui.add_space(6.0);
            ui.label(RichText::new("Keys and mouse").strong());
            table(ui, "keys", &KEYS);
            ui.add_space(6.0);
            ui.label(RichText::new("What the colours mean").strong());
            table(ui, "colours", &COLOURS);
            ui.add_space(6.0);
            ui.weak("Hover over anything for what it is and its equation. Numbers are photometric: lx, cd/m², lm.");
        });
}

fn table(ui: &mut egui::Ui, id: &str, rows: &[(&str, &str)]) {
    ui.spacing_mut().interact_size.y = 17.0;
    Grid::new(id).num_columns(2).spacing([18.0, 2.0]).show(ui, |ui| {
        for (left, right) in rows {
            ui.label(RichText::new(*left).color(crate::theme::accent(ui.visuals())));
            ui.add(egui::Label::new(*right).wrap());
            ui.end_row();
        }
    });
}
