//! The program as its user meets it: the real window, without a screen.

mod copies;
mod edits;
mod inspector;
mod kernel;
mod light_paths;
mod lightmap;
mod mirrors;
mod placement;
mod pointer;
mod texture;
mod volumes;
mod window;

use egui_kittest::kittest::Queryable;
use glam::{Affine3A, Vec3};
use lumenscope::{command::Command, examples::Example, panels::status::Badge, session::Compare};
use lumenscope_core::scene::Target;
use std::{fs, sync::Arc};
use window::{ROOM, Window, room};

#[test]
fn the_empty_window_invites() {
    let mut window = Window::empty();
    window.keep("empty");
    for label in ["Open a scene…", "Open example: Office", "Open example: Cornell box"] {
        window.harness.get_by_label(label);
    }
    window.press(egui::Key::F1);
    window.harness.run_steps(3);
    window.keep("help");
    window.harness.get_by_label("Keys and mouse");
}

#[test]
fn layers_and_views_follow_their_keys() {
    let mut window = Window::on_room();
    window.wait_picture();
    window.keep("room");
    assert_eq!(window.app().session().scene.as_ref().unwrap().name, "room");
    let whole = window.picture();
    for (key, solo) in [
        (egui::Key::Num1, [1.0, 0.0, 0.0, 0.0, 0.0]),
        (egui::Key::Num2, [0.0, 1.0, 0.0, 0.0, 0.0]),
        (egui::Key::Num3, [0.0, 0.0, 1.0, 0.0, 0.0]),
    ] {
        window.press(key);
        assert_eq!(window.view().weights, solo);
        window.wait_other_picture(&whole);
        window.press(key);
        assert_eq!(window.view().weights, [1.0; 5]);
    }
    window.press(egui::Key::V);
    assert!(window.view().volume.shown);
    window.wait("volume spheres", |app| {
        app.session().inspection.as_ref().is_some_and(|i| !i.spheres.is_empty())
    });
    window.wait_picture();
    window.click("Views");
    window.keep("volume");
    for row in lumenscope_core::registry::VIEWS.iter().filter(|r| r.id != "irradiance_volume.spheres") {
        window.click(row.title);
        assert_eq!(window.view().views, [row.id]);
        window.wait("the view", |app| !app.is_busy());
        window.keep(row.id);
        window.click(row.title);
        assert!(window.view().views.is_empty());
    }
    window.press(egui::Key::V);
    assert!(window.app().session().inspection.is_none());
    for compare in [Compare::Reference, Compare::Difference, Compare::Flip, Compare::Picture] {
        window.press(egui::Key::R);
        assert_eq!(window.view().compare, compare);
        if compare.is_comparison() {
            // The error in numbers stands beside the picture, to be copied.
            window.wait_for_label("Copy the picture's error");
            window.keep(&format!("{compare:?}"));
            for name in ["relMSE", "FLIP", "perceptual", "worst pixel"] {
                assert!(window.harness.query_all_by_label(name).next().is_some(), "{name} is not shown");
            }
        }
        if compare == Compare::Reference {
            window
                .wait("a reference", |app| app.session().reference.as_ref().is_some_and(|r| r.samples >= 2));
        }
    }
}

#[test]
fn a_dragged_lamp_changes_the_light_and_undo_brings_it_back() {
    let mut window = Window::on_room();
    window.wait_picture();
    let bulb = Target::Lamp(0);
    let (scene, edits) = (window.scene(), window.edits_bytes());
    let (floor, picture) = (window.floor_irradiance(), window.picture());
    for step in 1..=5 {
        let at = Vec3::new(0.25 * step as f32, 2.5, 0.0);
        let placement = Affine3A::from_translation(at);
        window.run(Command::Place { target: bulb, placement, dragging: true });
        window.wait("light that follows", |app| app.session().is_lit_as_edited());
    }
    window.run(Command::EndDrag);
    window.wait_lit();
    window.wait_other_picture(&picture);
    window.keep("dragged");
    assert!(
        (window.floor_irradiance() - floor).abs() > 0.02 * floor,
        "the floor's irradiance follows the lamp"
    );
    assert_eq!(window.app().session().history.depth(), 1, "one drag is one step");
    let dragged = window.edits_bytes();

    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.harness.step();
    assert_eq!(window.edits_bytes(), edits);
    assert_eq!(window.scene().placement(bulb), scene.placement(bulb));
    window.wait_lit();
    let back = window.floor_irradiance();
    // Sweeps from another start stop within the radiosity's own tolerance, 1e-3 of the mean.
    assert!((back - floor).abs() < 5e-3 * floor, "{back} lx against {floor} lx before");
    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Y);
    window.harness.step();
    assert_eq!(window.edits_bytes(), dragged);
}

#[test]
fn a_dimmed_lamp_dims_the_room() {
    let mut window = Window::on_room();
    let floor = window.floor_irradiance();
    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.5, dragging: false });
    window.wait_lit();
    let dimmed = window.floor_irradiance();
    // Light is linear in its only lamp; the sweeps stop within 1e-3 of the mean.
    assert!((dimmed - 0.5 * floor).abs() < 5e-3 * floor, "{dimmed} lx is not half of {floor} lx");
}

#[test]
fn a_clicked_point_is_read_out_and_its_spheres_open() {
    let mut window = Window::on_room();
    window.wait_picture();
    window.harness.get_by_label("viewport").click();
    window.harness.step();
    window.wait("the spheres", |app| app.session().probe.is_some());
    window.wait_picture();
    window.keep("picked");
    let pick = window.app().pick().unwrap().clone();
    assert_eq!(pick.object, "walls");
    let irradiance = pick.irradiance_direct + pick.irradiance_indirect;
    assert!(irradiance.min_element() > 0.0);
    let weights: f32 = pick.lighting.iter().flat_map(|l| &l.samples).map(|s| s.weight).sum();
    assert!((weights - 1.0).abs() < 1e-4, "weights of the samples sum to {weights}");
    let probe = window.app().session().probe.clone().unwrap();
    assert_eq!(Some(probe.position), window.view().probe.map(|p| p.0));
    assert!(probe.position.distance(pick.position) < 0.2, "the spheres stand by the point");
    window.harness.get_by_label("Irradiance");
}

#[test]
fn what_cannot_be_opened_is_said_and_nothing_is_lost() {
    let mut window = Window::on_room();
    let scene = window.scene();
    for (name, bytes) in [
        ("broken.glb", b"glTF\x02\0\0\0garbage".as_slice()),
        ("broken.obj", b"v 0 0\nf 1 2 9\n"),
        ("broken.ron", b"(models: ["),
        ("broken.lumenscope", b"(scene: Some(\"nowhere.ron\"))"),
    ] {
        let path = window.folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        window.run(Command::Open(path));
        window.wait("a notice", |app| app.notice().is_some());
        let notice = window.app().notice().unwrap().clone();
        assert!(notice.text.contains("broken") || notice.text.contains("nowhere"), "{notice:?}");
        assert!(Arc::ptr_eq(&scene, &window.scene()), "{name}: the open scene stays");
        window.harness.run_steps(3);

        window.click("Dismiss");
        assert!(window.app().notice().is_none());
    }
    window.run(Command::SaveSession("/proc/nowhere/x.lumenscope".into()));
    assert!(window.app().notice().is_some());
}

#[test]
fn long_work_is_cancelled_and_taken_up_again() {
    let mut window = Window::empty();
    let scene = room(window.folder.path());
    let fine = ROOM.replace("gather_rays: Some(64)", "gather_rays: Some(4096)");
    let fine = fine.replace("element_spacing_m: Some(0.5)", "element_spacing_m: Some(0.03)");
    fs::write(&scene, fine).unwrap();
    window.run(Command::Open(scene.clone()));
    window.wait("the first light", |app| app.badge() == Badge::Solving);
    window.run(Command::Cancel);
    window.wait("the end of the work", |app| !app.is_busy());
    window.harness.run_steps(2);
    assert_eq!(window.app().badge(), Badge::Unlit);
    fs::write(&scene, ROOM).unwrap();
    window.run(Command::Open(scene));
    window.wait_lit();
    let floor = window.floor_irradiance();
    assert!(floor > 0.0);
    window.run(Command::Solve);
    window.wait_lit();
    assert_eq!(window.floor_irradiance(), floor, "solved again, nothing changes");
}

#[test]
fn panels_hide_and_the_light_theme_holds() {
    let mut window = Window::on_room();
    window.wait_picture();
    let bulb = window.harness.get_all_by_label_contains("bulb").next().unwrap();
    bulb.click();
    window.harness.run_steps(2);
    assert_eq!(window.view().selected, Some(Target::Lamp(0)));
    window.keep("selected");
    window.run(Command::Window(lumenscope::command::Window::Theme));
    window.harness.run_steps(2);
    window.keep("light");
    window.press(egui::Key::Escape);
    assert_eq!(window.view().selected, None);
    assert!(window.harness.query_by_label("Read-out").is_some());
    window.press(egui::Key::Tab);
    assert!(window.harness.query_by_label("Read-out").is_none());
}

/// Pictures of the examples for the eye, where the environment asks for them.
#[test]
fn examples_open() {
    assert!(Example::every().all(|e| e.path().unwrap().exists()));
    for example in Example::ALL {
        if std::env::var("LUMENSCOPE_SHOTS").is_ok() {
            let mut window = Window::empty();
            window.run(Command::OpenExample(example));
            window.wait_lit();
            window.harness.get_by_label("viewport").click();
            window.wait("the spheres", |app| app.session().probe.is_some());
            window.wait_picture();
            window.keep(example.title());
            window.press(egui::Key::V);
            window.click("Views");
            window.wait_picture();
            window.click("Plan");
            window.keep(&format!("{} volume", example.title()));
        }
    }
}
