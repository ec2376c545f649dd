//! Light-path expressions typed into the window.

use crate::window::{Window, room};
use egui_kittest::kittest::{NodeT, Queryable};
use lumenscope::{
    app::LumenscopeApp,
    command::Command,
    session::{Compare, Reference, View},
};
use lumenscope_core::{
    math::{colour::luminance, image::LinearImage, progress::Progress},
    reference::picture::ReferencePicture,
};
use std::fs;

fn show(window: &mut Window, paths: &str) {
    let field = "Expression of light paths";
    window.harness.get_by_label(field).focus();
    window.harness.run_steps(2);
    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.harness.run_steps(2);
    window.harness.get_by_label(field).type_text(paths);
    window.harness.run_steps(3);
    assert_eq!(window.view().paths, paths);
}

#[test]
fn light_paths_choose_layers_or_ask_for_the_reference() {
    let mut window = Window::on_room();
    window.wait_picture();
    show(&mut window, "L(D|S)+DE");
    assert_eq!(window.view().weights, [0.0, 0.0, 1.0, 0.0, 0.0]);
    window.keep("paths");
    let view = View { auto_exposure: false, ..window.view() };
    window.run(Command::View(Box::new(view)));
    window.wait("a picture at rest", LumenscopeApp::is_picture_settled);
    let indirect = window.picture();
    // Two bounces are less light of the same layer.
    show(&mut window, "LD{2}E");
    assert_eq!(window.view().weights, [0.0, 0.0, 1.0, 0.0, 0.0]);
    window.wait_other_picture(&indirect);
    window.wait("a picture at rest", LumenscopeApp::is_picture_settled);
    let sum = |picture: &[u8]| picture.iter().map(|c| u64::from(*c)).sum::<u64>();
    window.keep("two_bounces");
    let of_two = window.picture();
    assert!(sum(&of_two) < sum(&indirect), "{} {}", sum(&of_two), sum(&indirect));
    show(&mut window, "LD{2");
    window.harness.get_by_label_contains("a count that is not one of");
}

/// What the window has traced of the view as it is, after some samples.
fn traced(window: &mut Window) -> Reference {
    window.wait("a reference", |app| app.session().reference.as_ref().is_some_and(|r| r.samples >= 4));
    window.app().session().reference.clone().unwrap()
}

/// The same samples, traced here.
fn expected(window: &Window, like: &Reference, paths: Option<&str>) -> LinearImage {
    let solution = window.app().session().solution.clone().unwrap();
    let (camera, image) = (window.view().camera, &like.image);
    let picture = ReferencePicture::new(solution.world.clone(), camera, image.width, image.height, 1);
    let mut picture = match paths {
        Some(paths) => picture.of_paths(paths.parse().unwrap()),
        None => picture,
    };
    picture.add_samples(like.samples, &Progress::silent()).unwrap();
    picture.mean()
}

#[test]
fn the_reference_traces_the_expression_that_was_typed() {
    let mut window = Window::on_room();
    window.wait_picture();
    let mean = |image: &LinearImage| luminance(image.mean());
    // Two bounces, then in the same view the light straight from the lamp.
    for (i, paths) in ["LD{2}E", "LDE"].into_iter().enumerate() {
        show(&mut window, paths);
        if i == 0 {
            window.harness.get_by_label("Reference").click();
            window.harness.run_steps(2);
            assert_eq!(window.view().compare, Compare::Reference);
        }
        let found = traced(&mut window);
        let wanted = expected(&window, &found, Some(paths));
        let all = expected(&window, &found, None);
        let worst = found.image.pixels.iter().zip(&wanted.pixels).map(|(a, b)| (*a - *b).abs().max_element());
        // The same samples in the same order: only their grouping into sums differs.
        assert!(worst.fold(0.0, f32::max) < 1e-4 * mean(&wanted), "{paths}");
        assert!(mean(&wanted) < 0.8 * mean(&all), "{paths} is not all light");
    }
    assert!(!window.harness.get_by_label("Difference").accesskit_node().is_disabled());
}

#[test]
fn where_something_is_polished_only_the_reference_shows_single_bounces() {
    let mut window = Window::empty();
    let scene = room(window.folder.path());
    fs::write(
        window.folder.path().join("room.mtl"),
        "newmtl white\nKd 0.7 0.7 0.7\nPr 0.1\nnewmtl red\nKd 0.7 0.1 0.1\n",
    )
    .unwrap();
    window.run(Command::Open(scene));
    window.wait_lit();
    show(&mut window, "LD{2}E");
    window.harness.get_by_label("No sum of the layers is this light: the reference shows it (R).");
    assert!(window.harness.get_by_label("Difference").accesskit_node().is_disabled());
}
