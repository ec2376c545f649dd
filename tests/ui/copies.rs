//! Two copies of one thing, each lit from a volume of its own.

use crate::window::Window;
use egui_kittest::kittest::Queryable;
use lumenscope::{
    command::Command,
    copies::{Copies, CopyVolume},
    pipeline::VolumeSource,
    session::View,
    worker::Worker,
};
use lumenscope_core::{irradiance_volume::moments::Order, math::part::Part, scene::Target};
use std::{
    thread::sleep,
    time::{Duration, Instant},
};

#[test]
fn two_copies_are_lit_by_two_volumes_at_once() {
    let mut window = Window::on_room();
    window.wait_picture();
    let mut view = window.view();
    view.selected = Some(Target::Object(1));
    window.run(Command::View(Box::new(view)));
    window.run(Command::KeepVolume);
    window.wait_picture();
    let before = window.picture();
    window.click("Views");
    window.click("Copies of block");
    let copies = window.view().copies.expect("the box was ticked");
    assert_eq!((copies.object, copies.lights[1].part), (1, Part::Indirect));
    window.wait("the copies", |app| app.session().solution.as_ref().is_some_and(|s| s.guests.len() == 2));
    assert!(window.app().session().is_lit_as_edited(), "copies need no new light");
    window.wait_other_picture(&before);
    window.keep("copies");

    // What a copy cannot be shown with is said once for each.
    let mut view = window.view();
    view.gloss = Some(Order::Finite(10));
    window.run(Command::View(Box::new(view.clone())));
    for side in ["left", "right"] {
        let said = format!("The {side} copy's volume holds no moment of order 10: it is drawn matt.");
        window.harness.get_by_label(&said);
    }
    view.gloss = None;
    window.run(Command::View(Box::new(view)));

    // The right one from the volume that was kept; the light goes on following the lamp with them in it.
    let mut view = window.view();
    let mut lights = copies.lights;
    lights[1].volume = CopyVolume::Kept(0);
    view.copies = Some(Copies { lights, ..copies });
    window.run(Command::View(Box::new(view)));
    let kept = window.app().session().kept[0].volume.clone();
    window.wait("the kept volume", |app| {
        let guests = app.session().solution.as_ref().map(|s| s.guests.clone());
        guests.is_some_and(|g| g.len() == 2 && std::sync::Arc::ptr_eq(&g[1].volume, &kept))
    });
    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.5, dragging: false });
    window.wait_lit();
    let solution = window.app().session().solution.clone().expect("there is light");
    let dimmed = solution.volume.clone().expect("there is a volume");
    assert!(std::sync::Arc::ptr_eq(&solution.guests[0].volume, &dimmed), "the left one follows the light");
    assert!(std::sync::Arc::ptr_eq(&solution.guests[1].volume, &kept), "the right one keeps its volume");

    // Nonsense is left out, and without the copies the scene is as it was.
    let mut view = window.view();
    view.copies = Some(Copies { object: 99, ..copies });
    window.run(Command::View(Box::new(view)));
    assert!(window.view().copies.is_none());
    window
        .wait("the scene alone", |app| app.session().solution.as_ref().is_some_and(|s| s.guests.is_empty()));
}

#[test]
fn copies_that_were_stopped_are_gone_from_the_view_too() {
    let mut window = Window::on_room();
    window.wait_picture();
    let ctx = window.harness.ctx.clone();
    let copies = Some(Copies::of(&window.scene(), 1));
    let view = View { copies, ..window.view() };
    // While a volume is traced, the copies wait.
    let app = window.harness.state_mut();
    app.run(&ctx, Command::CompareWith(VolumeSource::Reference));
    app.run(&ctx, Command::View(Box::new(view)));
    app.run(&ctx, Command::Cancel);
    window.wait("the end of the work", |app| !app.is_busy());
    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.5, dragging: false });
    window.wait_lit();
    let guests = window.app().session().solution.as_ref().map_or(0, |s| s.guests.len());
    assert_eq!((window.view().copies.is_some(), guests), (false, 0));
}

#[test]
fn copies_wanted_where_there_is_no_light_keep_nobody_busy() {
    // As a scene is opened and given up before its light is begun.
    let worker = Worker::start(|| {}).unwrap();
    worker.copies(None);
    let began = Instant::now();
    while worker.is_busy() {
        assert!(began.elapsed() < Duration::from_secs(20), "busy with nothing");
        sleep(Duration::from_millis(1));
    }
}
