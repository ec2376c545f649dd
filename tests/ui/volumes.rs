//! Volumes compared in the window.

use crate::window::Window;
use glam::Vec3;
use lumenscope::{
    app::LumenscopeApp, command::Command, export::Export, pipeline::VolumeSource, session::Against,
};
use lumenscope_core::scene::Target;

/// Largest value on screen by size, of the difference that is shown.
fn largest(window: &Window) -> f32 {
    shown(window.app())
}

fn shown(app: &LumenscopeApp) -> f32 {
    let inspection = app.session().inspection.clone().unwrap();
    let legend = inspection.legend.as_ref().unwrap();
    assert_eq!((legend.quantity.as_str(), legend.unit.as_str()), ("difference of irradiance", "lx"));
    legend.range[1]
}

#[test]
fn surfaces_are_ignored_and_volumes_kept_and_traced() {
    let mut window = Window::on_room();
    window.click("Views");
    let lamp = Target::Lamp(0);
    let mut view = window.view();
    view.selected = Some(lamp);
    window.run(Command::View(Box::new(view)));
    window.press(egui::Key::I);
    assert!(window.view().volume.ignored.contains(&lamp));
    window.click("Show the difference");
    window.wait("the difference", |app| !app.is_busy() && app.session().inspection.is_some());
    // Without its only lamp the room keeps what has bounced: the difference is what comes straight from it.
    let straight = largest(&window);
    assert!(straight > 10.0, "{straight}");
    window.keep("volume_difference");
    window.click("Count bulb");
    assert!(window.view().volume.ignored.is_empty());
    window.wait("no difference", |app| !app.is_busy());
    assert_eq!(largest(&window), 0.0);

    window.click("Keep this volume");
    assert_eq!(window.app().session().kept.len(), 1);
    assert_eq!(window.view().volume.against, Against::Kept(0));
    window.wait("the kept volume", |app| !app.is_busy());
    assert_eq!(largest(&window), 0.0);
    window.click("Path-trace a volume");
    window.wait("a traced volume", |app| app.session().kept.len() == 2 && !app.is_busy());
    assert_eq!(window.view().volume.against, Against::Kept(1));
    assert!(window.app().session().kept[1].name.contains("reference"));
    // The view follows a frame later.
    window.wait("the error of the volume", |app| app.session().inspection.is_some() && shown(app) > 0.0);
    let mut view = window.view();
    view.probe = Some((Vec3::new(1.0, 1.5, 0.5), Vec3::Y));
    window.run(Command::View(Box::new(view)));
    let file = window.folder.path().join("p.exr");
    window.run(Command::Export(Export::Panorama, file.clone()));
    window.wait("the panorama", |app| !app.is_busy() && file.exists());
    let list = window.folder.path().join("nodes.ron");
    std::fs::write(&list, r#"[(position: (1.0, 1.5, 0.5), file: "p.exr")]"#).unwrap();
    window.run(Command::CompareWith(VolumeSource::Panoramas(list)));
    window.wait("a volume from panoramas", |app| app.session().kept.len() == 3 && !app.is_busy());
    assert!(window.app().session().kept[2].name.contains("panoramas"));
    window.click("Forget");
    assert_eq!(window.app().session().kept.len(), 2);
    assert_eq!(window.view().volume.against, Against::Ignoring);
}
