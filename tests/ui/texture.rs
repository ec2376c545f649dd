//! The texture of a surface that is clicked, at its three stages, against the path tracer.

use crate::window::Window;
use egui_kittest::kittest::Queryable;
use lumenscope::{command::Command, grid_view::GridView, panels::texture};
use lumenscope_core::{measure::grid_texture::Prefilter, radiosity::texture::display::Filter};
use std::sync::Arc;

fn shown(window: &Window) -> Arc<GridView> {
    window.app().session().texture.clone().expect("a texture")
}

#[test]
fn a_clicked_wall_shows_its_texture_at_three_stages_and_how_far_each_is_off() {
    let mut window = Window::on_room();
    window.wait_picture();
    window.click("Texture");
    window.harness.get_by_label_contains("Click a surface to see the texture");
    window.harness.get_by_label("viewport").click();
    window.wait("the texture", |app| app.session().texture.is_some() && !app.is_busy());
    let pick = window.app().pick().unwrap().clone();
    let surface = window.view().surface.expect("what was clicked");
    assert_eq!((surface.triangle, surface.back), (pick.triangle, pick.back));
    let view = shown(&window);
    // The back wall, 4 × 3 m.
    assert!((view.grid.size_m.max_element() - 4.0).abs() < 1e-3, "{}", view.grid.size_m);
    for name in ["1 stored", "2 Hermite", "3 prefiltered"] {
        assert_eq!(window.harness.get_all_by_label(name).count(), 2, "{name}: its image and its numbers");
    }
    assert!(view.reference.is_none() && texture::text(&view).contains("–"));

    // Finer, filtered wider, looked up bicubically.
    let coarse = view.stages[1].texels();
    let mut look = window.view();
    look.stages.factor = 4;
    look.stages.shown = Filter::Mitchell;
    window.run(Command::View(Box::new(look)));
    window.wait("finer stages", |app| {
        app.session().texture.as_ref().is_some_and(|t| t.stages[1].texels() > coarse)
    });
    window.click("nearest");
    assert_eq!(window.view().stages.stored, Filter::Nearest);
    window.wait("the nearest node", |app| {
        app.session().texture.as_ref().is_some_and(|t| t.stages[0].filter == Filter::Nearest)
    });
    assert_eq!(shown(&window).stages[2].filter, Filter::Mitchell);

    let nodes = shown(&window).stages[0].texels();
    window.click("zero order");
    window.wait("a texel a leaf", |app| {
        app.session().texture.as_ref().is_some_and(|t| t.stages[0].texels() != nodes)
    });
    window.click("nodes");
    window.click("Compare with the path tracer");
    window.wait("a reference", |app| {
        let texture = app.session().texture.as_ref();
        texture.and_then(|t| t.reference.as_ref()).is_some_and(|r| r.paths >= 128)
    });
    window.harness.run_steps(2);
    window.keep("texture");
    let view = shown(&window);
    let traced = view.reference.clone().unwrap();
    let errors = traced.errors.map(|e| e.expect("every stage is judged"));
    // A wall by a small lamp, nodes half a metre apart: the light of each stage is the reference's but for the
    // bends between the nodes and the noise of the paths.
    assert!(errors.iter().all(|e| e.rel_mse > 0.0 && e.rel_mse < 0.05 && e.perceptual > 0.0), "{errors:?}");
    assert!(
        errors[1].rel_mse < errors[0].rel_mse,
        "a smooth function is nearer than the nearest node: {errors:?}"
    );
    let words = texture::text(&view);
    assert!(words.lines().count() == 4 && !words.contains('–'), "{words}");
    for name in ["stage 1 − path tracer", "path tracer", "stage 3, bands"] {
        window.harness.get_by_label(name);
    }

    // The same reference serves other settings; a stop ends it.
    let mut look = window.view();
    look.stages.prefilter = Prefilter::Gaussian(5);
    window.run(Command::View(Box::new(look)));
    window.wait("another prefilter", |app| {
        let reference = app.session().texture.as_ref().and_then(|t| t.reference.as_ref());
        reference.is_some_and(|r| r.paths >= traced.paths)
    });
    window.run(Command::Cancel);
    assert!(!window.view().traced_texture);
    window.wait("the stages alone", |app| {
        !app.is_busy() && app.session().texture.as_ref().is_some_and(|t| t.reference.is_none())
    });
}

#[test]
fn links_follow_the_element_that_is_clicked() {
    let mut window = Window::on_room();
    window.wait_picture();
    let mut look = window.view();
    look.views = vec!["radiosity.links".into()];
    window.run(Command::View(Box::new(look)));
    let rect = window.harness.get_by_label("viewport").rect();
    let from = |window: &mut Window, x: f32, y: f32| {
        window.click_at(rect.lerp_inside(egui::vec2(x, y)));
        window.wait("the links", |app| {
            !app.is_busy() && app.session().inspection.as_ref().is_some_and(|i| !i.labels.is_empty())
        });
        let pick = window.app().pick().unwrap().clone();
        let label = window.app().session().inspection.clone().unwrap().labels[0].position;
        // Elements are half a metre apart.
        assert!(label.distance(pick.position) < 0.4, "{label} is not {}", pick.position);
        label
    };
    let wall = from(&mut window, 0.7, 0.4);
    window.keep("links");
    let floor = from(&mut window, 0.7, 0.9);
    assert!(floor.distance(wall) > 0.5, "{floor} {wall}");
}
