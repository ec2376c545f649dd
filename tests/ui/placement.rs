//! Illuminance measured on a plane or the top of an object.

use crate::window::Window;
use egui_kittest::kittest::Queryable;
use glam::{Affine3A, Vec3};
use lumenscope::{
    LumenscopeApp,
    command::Command,
    panels::status::Badge,
    placement::{PLACEMENT, Placement, Site},
};
use lumenscope_core::{irradiance_volume::placement::requirement::preset, scene::Target};

#[test]
fn illuminance_is_measured_where_asked_and_follows_the_lamp() {
    let mut window = Window::on_room();
    window.wait_picture();
    window.click("Placement");
    assert!(window.app().session().measurement.is_none());
    // Under the bulb, 0.75 m above the floor.
    let requirement = preset("Technical drawing").unwrap().requirement();
    let mut placement = Placement { site: Some(Site::Own), requirement, ..Placement::default() };
    let measure =
        |placement: &Placement| Command::Measure { placement: Box::new(placement.clone()), dragging: false };
    window.run(measure(&placement));
    window.wait("a measurement", |app| app.session().measurement.is_some() && !app.is_busy());
    let mean = |app: &LumenscopeApp| {
        app.session().measurement.as_ref().and_then(|m| m.statistics()).map_or(0.0, |s| s.mean_lx)
    };
    let bright = mean(window.app());
    // I / d² of about 280 cd at 1.75 m is 92 lx; the grey room adds less than that again.
    assert!((60.0..250.0).contains(&bright), "{bright} lx");
    window.harness.get_by_label("illuminance map");
    window.harness.get_by_label_contains("too little light");
    window.click("Show in the picture");
    assert_eq!(window.view().views, [PLACEMENT]);
    window.wait("lines of equal illuminance", |app| {
        app.session().inspection.as_ref().is_some_and(|i| !i.lines.is_empty() && !i.labels.is_empty())
    });
    window.keep("placement");

    // The bulb is carried off: the desk darkens while it moves.
    let light = window.app().session().solution.as_ref().map(|s| s.provenance.revision);
    for step in 1..=3 {
        let at = Affine3A::from_translation(Vec3::new(0.5 * step as f32, 2.5, 0.0));
        window.run(Command::Place { target: Target::Lamp(0), placement: at, dragging: true });
        window.wait("a darker desk", |app| mean(app) < bright - 2.0 * step as f32);
    }
    assert_ne!(window.app().session().solution.as_ref().map(|s| s.provenance.revision), light);
    window.run(Command::EndDrag);
    window.wait_lit();

    // The choice is an edit: one step, undone and redone without new light, kept in a session.
    placement.requirement = Default::default();
    placement.site = Some(Site::Top(1));
    window.run(measure(&placement));
    window.wait("the block's top", |app| {
        app.session().measurement.as_ref().is_some_and(|m| m.name == "Top of block")
    });
    window.run(Command::Undo);
    window.wait("the desk again", |app| {
        app.session().measurement.as_ref().is_some_and(|m| m.name == "Own plane")
    });
    assert_eq!(window.app().badge(), Badge::Settled, "a measurement needs no new light");
    let file = window.folder.path().join("measured.lumenscope");
    window.run(Command::SaveSession(file.clone()));
    window.run(Command::Open(file));
    window.wait("the session", |app| app.session().measurement.is_some() && !app.is_busy());
    assert_eq!(window.app().session().document.edits.placement.site, Some(Site::Own));
    window.run(measure(&Placement { site: Some(Site::Plane(7)), ..Placement::default() }));
    assert_eq!(
        window.app().session().document.edits.placement.site,
        Some(Site::Own),
        "there is no such plane"
    );
}
