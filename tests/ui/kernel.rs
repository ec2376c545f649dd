//! The kernel of a glossy surface follows the pointer.

use crate::window::{Window, room};
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use lumenscope::{
    command::Command,
    panels::kernel::rows,
    pipeline::KERNEL,
    viewport::screen::Screen,
    widgets::value_table::{Row, text},
};
use lumenscope_core::glossy::inspect::KernelView;
use std::{fs, sync::Arc};

/// The room with its block of rough metal; the block's front stands at z = −0.6.
fn on_polished_room() -> Window<'static> {
    let mut window = Window::empty();
    let scene = room(window.folder.path());
    let materials = "newmtl white\nKd 0.7 0.7 0.7\nnewmtl red\nKd 0.7 0.1 0.1\nPm 1\nPr 0.3\n";
    fs::write(window.folder.path().join("room.mtl"), materials).unwrap();
    window.run(Command::Open(scene));
    window.wait_lit();
    let mut look = window.view();
    look.show(KERNEL, true);
    window.run(Command::View(Box::new(look)));
    window.wait_picture();
    window
}

fn kernel(window: &Window) -> Arc<KernelView> {
    window.app().kernel().cloned().expect("a kernel")
}

/// Moves the pointer onto a point of the scene.
fn point_at(window: &mut Window, place: Vec3) {
    let rect = window.harness.get_by_label("viewport").rect();
    let screen = Screen { rect, camera: window.view().camera };
    let (at, _) = screen.project(place).unwrap();
    window.harness.hover_at(at);
    window.harness.run_steps(3);
}

#[test]
fn the_kernel_follows_the_pointer_over_what_is_glossy() {
    let mut window = on_polished_room();
    let first = kernel(&window);
    assert!(
        first.point.position.x < -0.39,
        "before the pointer is on the block: the middle of one of its faces"
    );

    let plain = window.picture();
    for place in [Vec3::new(-0.9, 0.3, -0.6), Vec3::new(-0.6, 0.8, -0.6)] {
        point_at(&mut window, place);
        let shown = kernel(&window);
        // A pixel of the viewport is some 4 mm wide there.
        assert!(shown.point.position.distance(place) < 0.01, "{} is not {place}", shown.point.position);
        assert!(shown.point.normal.distance(Vec3::Z) < 1e-5);
        let to_eye = (window.view().camera.eye - shown.point.position).normalize();
        assert!(shown.point.wo.distance(to_eye) < 1e-5, "the eye is the window's");
        // Closed form: mirrored about z, the ray leaves for where it meets the room's walls.
        let along = Vec3::new(-to_eye.x, -to_eye.y, to_eye.z);
        let (low, high) = (Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 3.0, 2.0));
        let walls = Vec3::select(along.cmpgt(Vec3::ZERO), high, low);
        let reach = ((walls - shown.point.position) / along).min_element();
        // Rays start some micrometres off their surface.
        assert!((shown.numbers.reach_m - reach).abs() < 1e-3, "{} m for {reach} m", shown.numbers.reach_m);
    }
    window.wait_other_picture(&plain);
    window.wait_picture();
    window.keep("kernel");

    // What can be copied is what was found.
    let shown = kernel(&window);
    let table = rows(&shown.numbers);
    let value = |name: &str| table.iter().find(|r: &&Row| r.name == name).unwrap().values[0];
    assert!((value("Samples needed") * value("One every") - 1f32.to_degrees()).abs() < 1e-3);
    assert_eq!(text(&table).lines().count(), table.len());
    window.harness.get_by_label("Copy numbers");

    // Off the block the last one stays, and turns with the camera; where its point is hidden it goes.
    point_at(&mut window, Vec3::new(1.0, 1.5, -2.0));
    assert_eq!(kernel(&window).point, shown.point);
    let mut look = window.view();
    look.camera.eye += Vec3::new(0.3, 0.2, 0.0);
    window.run(Command::View(Box::new(look.clone())));
    window.harness.run_steps(2);
    let turned = kernel(&window);
    assert!(turned.point.position.distance(shown.point.position) < 1e-3);
    assert!(turned.point.wo.distance((look.camera.eye - turned.point.position).normalize()) < 1e-5);
    look.camera.eye = Vec3::new(-0.8, 2.5, -1.9);
    look.camera.target = shown.point.position;
    window.run(Command::View(Box::new(look.clone())));
    window.harness.run_steps(2);
    assert!(window.app().kernel().is_none(), "from behind the block its front is not seen");
    look.show(KERNEL, false);
    window.run(Command::View(Box::new(look)));
    assert!(window.app().kernel().is_none());
}

#[test]
fn until_something_is_pointed_at_the_kernel_is_the_one_nearest_to_the_probe() {
    let mut window = on_polished_room();
    let first = kernel(&window);
    let (home, mut look) = (window.view(), window.view());
    // From within the block all of its faces are dark.
    look.camera.eye = Vec3::new(-0.8, 0.5, -1.0);
    window.run(Command::View(Box::new(look)));
    window.harness.run_steps(2);
    assert!(window.app().kernel().is_none());
    let mut look = home;
    window.run(Command::View(Box::new(look.clone())));
    window.harness.run_steps(2);
    assert_eq!(kernel(&window).point, first.point, "back before the block it appears");
    for place in [Vec3::new(-1.0, 0.2, -0.6), Vec3::new(-0.5, 0.9, -0.6)] {
        look.probe = Some((place + 0.02 * Vec3::Z, Vec3::Z));
        window.run(Command::View(Box::new(look.clone())));
        window.harness.run_steps(2);
        let found = kernel(&window).point.position;
        assert!(found.distance(place) < 1e-4, "{found} is not {place}");
    }
}
