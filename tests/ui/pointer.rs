//! What the mouse does in the viewport.

use crate::window::Window;
use egui::Vec2;
use egui_kittest::kittest::Queryable;
use lumenscope::{session::View, viewport::screen::Screen};
use lumenscope_core::scene::Target;

/// The viewport as it maps the scene to the window.
fn screen(window: &Window) -> Screen {
    let rect = window.harness.get_by_label("viewport").rect();
    Screen { rect, camera: window.view().camera }
}

#[test]
fn a_clicked_volume_sphere_opens_its_own_light() {
    let mut window = Window::on_room();
    window.press(egui::Key::V);
    window.wait("volume spheres", |app| {
        app.session().inspection.as_ref().is_some_and(|i| !i.spheres.is_empty())
    });
    window.wait_picture();
    let screen = screen(&window);
    let inspection = window.app().session().inspection.clone().unwrap();
    let eye = screen.camera.eye;
    // The nearest sphere that can be seen whole: nothing can stand before it.
    let sphere = inspection
        .spheres
        .iter()
        .filter(|s| screen.project(s.centre).is_some_and(|(at, _)| screen.rect.shrink(60.0).contains(at)))
        .min_by(|a, b| a.centre.distance(eye).total_cmp(&b.centre.distance(eye)))
        .unwrap();
    let (at, _) = screen.project(sphere.centre).unwrap();
    window.click_at(at);
    assert_eq!(window.view().probe.map(|p| p.0), Some(sphere.centre), "the sample's own place is opened");
    window
        .wait("its spheres", |app| app.session().probe.as_ref().is_some_and(|p| p.position == sphere.centre));
    window.wait_picture();
    window.keep("sphere_clicked");
}

#[test]
fn a_clicked_lamp_is_selected_and_its_handles_come_up() {
    let mut window = Window::on_room();
    window.wait_picture();
    let before = window.picture();
    let screen = screen(&window);
    let bulb = window.scene().lamps[0].position();
    let (at, _) = screen.project(bulb).unwrap();
    assert!(screen.rect.contains(at), "the bulb can be seen: {at}");
    window.click_at(at);
    assert_eq!(window.view().selected, Some(Target::Lamp(0)));
    assert!(window.view().probe.is_none(), "a lamp is no point of a surface");
    window.harness.run_steps(3);
    assert_ne!(window.picture(), before, "the selected lamp is marked");
    window.keep("lamp_clicked");
}

#[test]
fn the_wheel_comes_nearer_to_what_lies_under_the_pointer() {
    let mut window = Window::on_room();
    window.wait_picture();
    let before = screen(&window);
    let whole = window.picture();
    let at = before.rect.lerp_inside(Vec2::new(0.35, 0.6));
    let turn = |window: &mut Window, lines: f32| -> View {
        window.harness.hover_at(at);
        window.harness.step();
        window.harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            source: egui::MouseWheelSource::Wheel,
            delta: Vec2::new(0.0, lines),
            modifiers: egui::Modifiers::NONE,
            phase: egui::TouchPhase::Move,
        });
        // egui spreads a turn of the wheel over some frames.
        window.harness.run_steps(30);
        window.view()
    };
    let near = turn(&mut window, 3.0);
    let there = before.ray(at).direction;
    let step = near.camera.eye - before.camera.eye;
    assert!(step.length() > 0.1, "three clicks of the wheel move the eye by {step}");
    assert!(step.normalize().dot(there) > 0.999, "the eye moves along {step}, the pointer is on {there}");
    window.wait_other_picture(&whole);
    window.wait_picture();
    window.keep("wheel");
    let back = turn(&mut window, -3.0);
    let rest = back.camera.eye.distance(before.camera.eye);
    assert!(rest < 0.3 * step.length(), "as many clicks back leave the eye {rest} m from where it was");
}
