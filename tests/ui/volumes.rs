//! Volumes compared in the window.

use crate::window::Window;
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use lumenscope::{
    app::LumenscopeApp, command::Command, copies::CopyVolume, export::Export, pipeline::VolumeSource,
    session::Against,
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
    window.wait("the spheres", |app| !app.is_busy() && app.session().probe.is_some());
    window.click("Volumes");
    window.harness.get_by_label("A from B");
    window.keep("two_volumes");
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

#[test]
fn the_material_that_was_clicked_is_left_out_and_counted_again() {
    let mut window = Window::on_room();
    window.harness.get_by_label("viewport").click();
    window.harness.run_steps(2);
    let clicked = window.view().surface.unwrap();
    let solution = window.app().session().solution.clone().unwrap();
    let material = solution.world.geometry.material[clicked.triangle as usize];
    for left_out in [true, false] {
        window.harness.key_press_modifiers(egui::Modifiers::SHIFT, egui::Key::I);
        window.harness.run_steps(2);
        assert_eq!(window.view().volume.ignored_materials.contains(&material), left_out);
        assert!(window.view().volume.ignored.is_empty());
    }
}

#[test]
fn a_volume_without_some_light_is_kept_shown_and_taken_from() {
    let mut window = Window::on_room();
    window.click("Views");
    let mut view = window.view();
    view.volume.ignored.insert(Target::Lamp(0));
    view.views.push(lumenscope::pipeline::DIFFERENCES[0].to_owned());
    window.run(Command::View(Box::new(view)));
    window.wait("the difference", |app| !app.is_busy() && app.session().inspection.is_some());
    let straight = largest(&window);
    window.click("Keep without them");
    window.wait("the kept volume", |app| app.session().kept.len() == 1 && !app.is_busy());
    assert!(window.app().session().kept[0].name.contains("without bulb"));
    assert_eq!(largest(&window), straight, "it is what was compared with before");
    // The other way round: the kept one less the present one.
    let mut view = window.view();
    (view.volume.of, view.volume.against) = (CopyVolume::Kept(0), Against::Present);
    window.run(Command::View(Box::new(view)));
    window.wait("the difference turned", |app| {
        let notes = app.session().inspection.as_ref().map(|i| i.notes.join(" "));
        !app.is_busy() && notes.is_some_and(|n| n.contains("A − B: mean -"))
    });
    assert!((largest(&window) / straight - 1.0).abs() < 0.01);
    // A material of everything there is: what is left out is more than the lamp.
    let mut view = window.view();
    view.volume.of = CopyVolume::Present;
    view.volume.ignored_materials.extend(0..8);
    view.volume.against = Against::Ignoring;
    window.run(Command::View(Box::new(view)));
    window.wait("all light left out", |app| !app.is_busy() && shown(app) > 1.01 * straight);
    window.run(Command::ForgetVolume(0));
    assert_eq!(window.view().volume.of, CopyVolume::Present);
}

#[test]
fn a_volume_that_was_saved_is_opened_and_what_is_none_is_refused() {
    let mut window = Window::on_room();
    let file = window.folder.path().join("saved.volume");
    window.app().session().solution.as_ref().unwrap().volume.as_ref().unwrap().save(&file).unwrap();
    window.run(Command::CompareWith(VolumeSource::File(file.clone())));
    window.wait("the volume", |app| app.session().kept.len() == 1 && !app.is_busy());
    assert!(window.app().session().kept[0].name.contains("saved"));
    std::fs::write(&file, "nothing").unwrap();
    window.run(Command::CompareWith(VolumeSource::File(file)));
    window.wait("the refusal", |app| app.notice().is_some());
    let text = window.app().notice().unwrap().text.clone();
    assert!(text.contains("saved.volume") && !text.contains('\n'), "{text}");
    assert_eq!(window.app().session().kept.len(), 1);
}
