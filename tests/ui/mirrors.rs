//! Mirrors shown from images-with-depth while a lamp with a body is dragged.

use crate::window::{Window, cuboid, room};
use glam::{Affine3A, Vec3};
use lumenscope::command::Command;
use lumenscope_core::{
    math::progress::Progress,
    mirror::images::{ImageWithDepth, MirrorImages, pass::in_use},
    scene::Target,
};
use std::{fs, sync::Arc};

/// The room with a mirror at its back and a panel that shines down, instead of a bulb.
const MIRRORED: &str = r#"(
    models: [(file: "room.obj"), (file: "mirror.obj")],
    area_lamps: [(name: "panel", corner: (-0.3, 2.2, -0.2), edge_u: (0.6, 0.0, 0.0), edge_v: (0.0, 0.0, 0.4), radiance: (900.0, 850.0, 700.0))],
    movable: ["block"],
    camera: Some((eye: (0.3, 1.5, 1.9), target: (0.0, 1.2, -2.0), up: (0.0, 1.0, 0.0), vertical_fov: 1.2)),
    plan: (element_spacing_m: Some(0.5), gather_rays: Some(64), volume: Some(false), mirrors: Some(images)),
)"#;

fn images(of: &MirrorImages) -> impl Iterator<Item = &Arc<ImageWithDepth>> {
    of.sets.iter().flat_map(|set| set.elements.iter().flatten())
}

#[test]
fn a_lamp_that_is_dragged_keeps_what_mirrors_are_shown_from() {
    let mut window = Window::empty();
    let folder = window.folder.path().to_owned();
    let scene = room(&folder);
    let mut obj = String::from("mtllib mirror.mtl\no mirror\nusemtl silver\n");
    cuboid(&mut obj, 1, [-0.2, 0.3, -1.99], [1.6, 2.1, -1.95], false);
    fs::write(folder.join("mirror.obj"), obj).unwrap();
    fs::write(folder.join("mirror.mtl"), "newmtl silver\nKd 0.9 0.9 0.9\nPr 0\nPm 1\n").unwrap();
    fs::write(&scene, MIRRORED).unwrap();
    window.run(Command::Open(scene));
    window.wait_lit();
    let solution = |w: &Window| w.app().session().solution.clone().unwrap();
    let taken = solution(&window).mirror_images.clone().unwrap();
    assert!(taken.rays == taken.points() && !taken.sets.is_empty());
    window.wait_picture();
    let before = window.picture();

    let lamp = Target::Object(window.scene().objects.iter().position(|o| o.name == "panel").unwrap());
    let start = window.scene().placement(lamp);
    let drag = |window: &mut Window, by: Vec3| {
        let placement = Affine3A::from_translation(by) * start;
        window.run(Command::Place { target: lamp, placement, dragging: true });
        window.wait("light that has followed", |app| {
            let solution = app.session().solution.as_ref();
            solution.is_some_and(|s| s.scene.placement(lamp) == placement)
        });
    };
    for step in 1..=3 {
        drag(&mut window, Vec3::new(0.15, -0.05, -0.1) * step as f32);
        let light = solution(&window);
        let (now, _) = in_use(&light).expect("mirrors are shown from the geometry");
        let kept = images(&taken).zip(images(now)).filter(|(a, b)| Arc::ptr_eq(a, b)).count();
        let (rays, points) = (now.rays, now.points());
        println!("{rays} of {points} rays, {kept} of {} images as they were", images(now).count());
        assert!(rays > 0 && rays * 10 < points, "{rays} of {points}");
        let fresh = MirrorImages::automatic(&light.world, &Progress::silent()).unwrap();
        assert!(now.sets == fresh.sets, "step {step}: other points than those taken of nothing");
    }
    window.wait_other_picture(&before);
    window.keep("mirror_dragged");
    window.run(Command::EndDrag);
    window.wait_lit();
    let light = solution(&window);
    assert!(light.moved_objects.is_empty(), "the light is solved anew");
    let (now, _) = in_use(&light).unwrap();
    let fresh = MirrorImages::automatic(&light.world, &Progress::silent()).unwrap();
    assert!(now.sets == fresh.sets && now.rays * 10 < now.points());
    // Undone, they are those of before.
    window.run(Command::Undo);
    window.wait_lit();
    assert_eq!(solution(&window).scene.placement(lamp), start);
    assert!(in_use(&solution(&window)).unwrap().0.sets == taken.sets);
}
