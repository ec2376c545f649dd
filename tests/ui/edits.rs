//! What the user changes: kept, undone, asked about before it is lost.

use crate::window::{Window, cuboid};
use egui_kittest::kittest::Queryable;

use lumenscope::{
    command::{Command, Window as WindowCommand},
    export::Export,
    session::View,
};
use lumenscope_core::{
    glossy::GlossyMethod,
    irradiance_volume::{Basis, inspect::ColourBy, moments::Order},
    mirror::MirrorMethod,
    radiosity::lookup::Lookup,
    scene::{Target, file::PlanOverrides},
    superposition::plan::Component,
};
use std::{fs, sync::Arc};

#[test]
fn a_dropped_model_is_added_as_a_movable_object() {
    let mut window = Window::on_room();
    let before = window.scene().objects.len();
    let path = window.folder.path().join("stool.obj");
    let mut obj = String::from("o stool\n");
    cuboid(&mut obj, 1, [0.4, 0.0, -0.2], [0.8, 0.5, 0.2], false);
    fs::write(&path, obj).unwrap();
    let ctx = window.harness.ctx.clone();
    window.harness.state_mut().drop_file(&ctx, &path);
    window.harness.run_steps(3);
    window.click("Add to scene");
    window.wait("the stool", |app| app.session().scene.as_ref().is_some_and(|s| s.objects.len() > before));
    window.wait_lit();
    window.keep("added");
    assert!(window.scene().objects[before..].iter().all(|o| o.movable));
    assert_eq!(window.app().session().document.edits.added, [path]);
    assert_eq!(window.app().session().history.depth(), 1, "a model added is one step");
    let (with, edits) = (window.scene().triangle_count(), window.edits_bytes());

    window.run(Command::View(Box::new(View { selected: Some(Target::Object(before)), ..window.view() })));
    window.run(Command::Undo);
    assert_eq!(window.scene().objects.len(), before);
    assert_eq!(window.view().selected, None, "what is gone cannot stay selected");
    window.wait_lit();
    window.run(Command::Redo);
    assert_eq!((window.scene().triangle_count(), window.edits_bytes()), (with, edits));
    window.wait_lit();
}

#[test]
fn the_panel_says_what_glass_passes() {
    let mut window = Window::empty();
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/glass/glass.ron");
    window.run(Command::Open(path));
    window.wait("the scene", |app| app.session().scene.is_some());
    let named = |window: &Window, name: &str| {
        Some(Target::Object(window.scene().objects.iter().position(|o| o.name == name).unwrap()))
    };
    // Base colours of the file, all of it passing, by the front and the back; the back wall is plain.
    for (object, said) in [
        ("Pane", "glass, passes 0.95 0.66 0.25, both sides"),
        ("Ball", "glass, passes 0.98 0.99 0.98, both sides"),
    ] {
        let selected = named(&window, object);
        window.run(Command::View(Box::new(View { selected, ..window.view() })));
        window.wait_for_label(said);
    }
    let selected = named(&window, "Back wall");
    window.run(Command::View(Box::new(View { selected, ..window.view() })));
    window.harness.run_steps(2);
    assert!(window.harness.query_by_label_contains("glass, passes").is_none());
    assert!(window.harness.query_by_label_contains("ρ ").is_some());
}

#[test]
fn a_session_is_saved_and_reopened_and_pictures_are_exported() {
    let mut window = Window::on_room();
    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.25, dragging: false });
    let file = window.folder.path().join("kept.lumenscope");
    window.run(Command::SaveSession(file.clone()));
    assert!(!window.app().session().is_dirty());
    assert!(fs::read_to_string(&file).unwrap().contains("\"room.ron\""), "the scene's path is relative");
    let edits = window.edits_bytes();
    window.wait_lit();
    let (png, exr) = (window.folder.path().join("out.png"), window.folder.path().join("out.exr"));
    window.run(Command::Export(Export::Picture, png.clone()));
    window.run(Command::Export(Export::Layers, exr.clone()));
    window.wait("the exports", |app| !app.is_busy());
    let plain = image::open(&png).unwrap();
    assert!(plain.width() > 500);
    window.run(Command::Export(Export::Wall, png.clone()));
    window.wait("the wall", |app| !app.is_busy());
    let with_wall = image::open(&png).unwrap();
    assert_ne!(with_wall, plain, "612,000 polygons more");
    // The wall is weighted as everything is: light of no layer is no picture.
    let mut view = window.view();
    view.weights = [0.0; 5];
    window.run(Command::View(Box::new(view)));
    window.run(Command::Export(Export::Wall, png.clone()));
    window.wait("the wall in no light", |app| !app.is_busy());
    assert!(image::open(&png).unwrap().to_rgb8().pixels().all(|p| p.0 == [0; 3]));
    let layers = lumenscope_core::io::exr::read_layers(&exr).unwrap();
    let names = ["emitted", "direct", "indirect", "mirror", "glossy"];
    assert_eq!(layers.iter().map(|l| l.0.as_str()).collect::<Vec<_>>(), names);

    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 1.0, dragging: false });
    assert_ne!(window.edits_bytes(), edits);
    window.run(Command::Open(file.clone()));
    window.harness.run_steps(2);
    window.click("Discard");
    window.wait("the session", |app| !app.session().history.can_undo());
    window.wait_lit();
    assert_eq!(window.edits_bytes(), edits);
    assert_eq!(window.scene().lamps[0].dimmer, 0.25);
    assert_eq!(window.app().recent()[0], file);
}

/// Asks the window to close, as its frame's button does, and says whether it may.
fn closes(window: &mut Window) -> bool {
    let viewports = &mut window.harness.input_mut().viewports;
    let root = viewports.entry(egui::ViewportId::ROOT).or_default();
    root.events.push(egui::ViewportEvent::Close);
    window.harness.step();
    let commands = &window.harness.output().viewport_output[&egui::ViewportId::ROOT].commands;
    let stays = commands.contains(&egui::ViewportCommand::CancelClose);
    window.harness.step();
    !stays
}

#[test]
fn unsaved_edits_are_asked_about_before_they_are_lost() {
    let mut window = Window::on_room();
    assert!(closes(&mut window), "nothing is unsaved");
    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.5, dragging: false });
    let edits = window.edits_bytes();
    assert!(!closes(&mut window), "the window stays to ask");
    window.harness.run_steps(2);
    window.keep("unsaved");
    window.click("Cancel");
    assert!(window.app().asked().is_none() && window.edits_bytes() == edits);

    // Opening asks too; what is saved first is there afterwards.
    let file = window.folder.path().join("kept.lumenscope");
    window.run(Command::SaveSession(file.clone()));
    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.75, dragging: false });
    window.run(Command::Open(window.folder.path().join("room.ron")));
    assert!(window.app().asked().is_some());
    window.harness.run_steps(2);
    window.click("Save");
    window.wait("the room anew", |app| !app.session().history.can_undo());
    assert_eq!(window.scene().lamps[0].dimmer, 1.0);
    assert!(fs::read_to_string(&file).unwrap().contains("0.75"));

    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.5, dragging: false });
    window.run(Command::Window(WindowCommand::Quit));
    assert!(window.app().asked().is_some());
    window.harness.run_steps(2);
    window.click("Discard");
    assert!(closes(&mut window), "what was discarded is not asked about again");
}

#[test]
fn the_plan_is_overridden_line_by_line_and_taken_back() {
    let mut window = Window::on_room();
    window.click("Plan");
    let elements = |w: &Window| w.app().session().solution.as_ref().unwrap().radiosity.elements().len();
    let before = elements(&window);
    // The room's file fixes both lines: spacing 0.5 m, and a volume of 4³ samples.
    window.click("radiosity: fixed");
    window.harness.run_steps(2);
    window.keep("plan");
    window.click("Back to automatic");
    assert_eq!(window.scene().plan.element_spacing_m, None);
    assert_eq!(window.scene().plan.volume_bins_n, Some(5), "other lines stay");
    window.wait_lit();
    // A hundredth of the diagonal of 6.4 m is 6.4 cm: 61 times as many as half a metre apart.
    assert!(elements(&window) > 20 * before, "{} elements, {before} before", elements(&window));
    window.harness.get_by_label("radiosity: automatic");

    window.click("irradiance volume: fixed");
    window.harness.run_steps(2);
    window.click("fix Bins");
    window.click("Apply");
    assert_eq!(window.scene().plan.volume_bins_n, None);
    let light = window.app().session().solution.as_ref().unwrap().radiosity.clone();
    window.wait_lit();
    let solution = window.app().session().solution.clone().unwrap();
    assert!(Arc::ptr_eq(&light, &solution.radiosity), "the volume alone is built again");
    assert_eq!(solution.volume.as_ref().unwrap().bins().n(), 17);

    window.run(Command::Undo);
    window.run(Command::Undo);
    window.wait_lit();
    assert_eq!(elements(&window), before);

    // How light is looked up is a matter of the picture: nothing is solved again.
    let light = window.app().session().solution.as_ref().unwrap().radiosity.clone();
    window.click("radiosity: fixed");
    window.harness.run_steps(2);
    window.click("fix Lookup");
    window.harness.run_steps(2);
    window.click("Apply");
    assert_eq!(window.scene().plan.lookup, Some(Lookup::Bilinear));
    window
        .run(Command::Plan(PlanOverrides { lookup: Some(Lookup::Mitchell), ..window.scene().plan.clone() }));
    window.wait_lit();
    let solution = window.app().session().solution.clone().unwrap();
    assert!(Arc::ptr_eq(&light, &solution.radiosity) && solution.lookup() == Lookup::Mitchell);
    window.run(Command::Undo);
    window.run(Command::Undo);
    window.wait_lit();

    // Images of what mirrors show are taken beside the light that there is, and given up again.
    window.click("mirror: automatic");
    window.harness.run_steps(2);
    window.click("fix Mirrors from");
    window.harness.run_steps(2);
    window.click("Apply");
    assert_eq!(window.scene().plan.mirrors, Some(MirrorMethod::Geometry));
    let images = PlanOverrides { mirrors: Some(MirrorMethod::Images), ..window.scene().plan.clone() };
    window.run(Command::Plan(images));
    window.wait_lit();
    let solution = window.app().session().solution.clone().unwrap();
    assert!(Arc::ptr_eq(&light, &solution.radiosity) && solution.mirror_images.is_some());
    window.run(Command::Undo);
    window.run(Command::Undo);
    window.wait_lit();
    assert!(window.app().session().solution.as_ref().unwrap().mirror_images.is_none());
    // So is how glossy surfaces blur what they mirror.
    window.click("glossy: automatic");
    window.harness.run_steps(2);
    window.click("fix Convolution");
    window.harness.run_steps(2);
    window.click("Apply");
    assert_eq!(window.scene().plan.glossy, Some(GlossyMethod::Variant));
    window.wait_lit();
    let solution = window.app().session().solution.clone().unwrap();
    assert!(Arc::ptr_eq(&light, &solution.radiosity) && solution.scene.plan.glossy.is_some());
    window.click("glossy: fixed");
    window.harness.run_steps(2);
    window.click("Back to automatic");
    window.harness.run_steps(2);
    assert_eq!(window.scene().plan.glossy, None);
    window.run(Command::Undo);
    window.run(Command::Undo);
    window.wait_lit();

    let problem = PlanOverrides { gather_rays: Some(0), ..window.scene().plan.clone() };
    window.run(Command::Plan(problem));
    assert!(!window.app().session().history.can_undo(), "no rays at all cannot be asked for");

    // A plan is kept in the session.
    let wanted = Component::IrradianceVolume.freed(&window.scene().plan);
    window.run(Command::Plan(wanted.clone()));
    let file = window.folder.path().join("planned.lumenscope");
    window.run(Command::SaveSession(file.clone()));
    assert_eq!(lumenscope::session_file::read(&file).unwrap().edits.plan, Some(wanted));
}

#[test]
fn movable_objects_shine_by_a_moment_that_the_plan_asks_for() {
    let mut window = Window::on_room();
    window.wait_picture();
    let diffuse = window.picture();
    let order = Order::Finite(10);
    let view = View { gloss: Some(order), ..window.view() };
    window.run(Command::View(Box::new(view)));
    window.harness.get_by_label("The volume holds no moment of order 10: add it under Plan.");
    let plan = PlanOverrides { volume_moments: Some(vec![order]), ..window.scene().plan.clone() };
    window.run(Command::Plan(plan));
    window.wait_lit();
    assert!(window.harness.query_by_label_contains("holds no moment").is_none());
    window.wait_other_picture(&diffuse);
    window.keep("glossy");
}

#[test]
fn how_the_volume_is_asked_changes_without_new_rays() {
    let mut window = Window::on_room();
    let volume = |w: &Window| w.app().session().solution.as_ref().unwrap().volume.clone().unwrap();
    let before = volume(&window);
    let plan = PlanOverrides {
        volume_basis: Some(Basis::Harmonics),
        volume_guard: Some(true),
        volume_moments: Some(vec![Order::Finite(10)]),
        ..window.scene().plan.clone()
    };
    window.run(Command::Plan(plan));
    window.wait_lit();
    let after = volume(&window);
    assert_eq!((after.settings().basis, after.settings().guard), (Basis::Harmonics, true));
    assert_eq!(after.orders(), [Order::Finite(1), Order::Finite(10)]);
    assert_eq!(after.samples(), before.samples());

    let mut view = window.view().clone();
    view.volume.shown = true;
    view.volume.moment = Order::Finite(10);
    window.run(Command::View(Box::new(view.clone())));
    window.wait("the moments", |app| {
        let legend = app.session().inspection.as_ref().and_then(|i| i.legend.clone());
        legend.is_some_and(|l| l.quantity == "moment of order 10")
    });
    view.volume.colour_by = ColourBy::Validity;
    window.run(Command::View(Box::new(view)));
    window.wait("validity", |app| {
        let legend = app.session().inspection.as_ref().and_then(|i| i.legend.clone());
        legend.is_some_and(|l| l.names.contains(&"relocated") && l.range == [0.0, 3.0])
    });
    window.run(Command::Undo);
    window.wait_lit();
    assert_eq!(volume(&window).settings().basis, Basis::Bins);
}

#[test]
fn an_object_dragged_out_of_the_volume_is_named_in_the_log() {
    let mut window = Window::on_room();
    let placement = glam::Affine3A::from_translation(glam::Vec3::X * 9.0);
    let block = window.scene().objects.iter().position(|o| o.name.contains("block")).unwrap();
    window.run(Command::Place { target: Target::Object(block), placement, dragging: true });
    window.wait("the notice", |app| {
        app.session().log.lines().iter().any(|l| l.text.contains("outside the irradiance volume"))
    });
}
