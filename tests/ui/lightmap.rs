//! A lightmap baked elsewhere, dropped onto the window.

use crate::window::Window;
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use lumenscope::{command::Command, lightmaps::LightmapFile, panels::lightmap};
use lumenscope_core::{io::exr, math::image::LinearImage, radiosity::faults::Fault};
use std::fs;

/// A square floor of 1 m with texture coordinates, a lamp over its middle.
const FLOOR: &str = "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nvt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3 4/4\n";
const SCENE: &str = r#"(
    models: [(file: "floor.obj")],
    lamps: [Point(name: "lamp", at: (0.5, 1.0, 0.5), intensity: (100.0, 100.0, 100.0))],
)"#;

#[test]
fn a_png_holds_encoded_shares_of_its_white() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.PNG");
    let grey = image::RgbImage::from_pixel(2, 2, image::Rgb([188, 0, 255]));
    grey.save(&path).unwrap();
    let file = LightmapFile { path, white: 200.0, paths: 0 };
    assert!(LightmapFile::is_one(&file.path));
    // ((188 / 255 + 0.055) / 1.055)^2.4 = 0.5029 by IEC 61966-2-1.
    let pixel = file.read().unwrap().pixels[3];
    assert!((pixel - Vec3::new(100.58, 0.0, 200.0)).abs().max_element() < 0.02, "{pixel}");
}

#[test]
fn a_dropped_lightmap_is_held_against_our_light_and_its_faults_are_marked() {
    let mut window = Window::empty();
    let folder = window.folder.path().to_path_buf();
    fs::write(folder.join("floor.obj"), FLOOR).unwrap();
    fs::write(folder.join("floor.ron"), SCENE).unwrap();
    window.run(Command::Open(folder.join("floor.ron")));
    window.wait_lit();

    // As the lamp lights the floor, I cos θ / r² = 100 / r³ for a height of 1 m, but black in a quarter.
    const SIDE: u32 = 32;
    let map = LinearImage::from_fn(SIDE, SIDE, |x, y| {
        let [u, v] = [x, y].map(|i| (i as f32 + 0.5) / SIDE as f32 - 0.5);
        let lit = x >= SIDE / 2 || y >= SIDE / 2;
        Vec3::splat(if lit { 100.0 * (1.0 + u * u + v * v).powf(-1.5) } else { 0.0 })
    });
    let file = folder.join("map.exr");
    exr::write_layers(&file, &[("", &map)], "lx").unwrap();
    let ctx = window.harness.ctx.clone();
    window.harness.state_mut().drop_file(&ctx, &file);
    window.wait("the lightmap", |app| app.session().lightmap.is_some());
    window.harness.run_steps(3);
    window.keep("lightmap");
    let judged = window.app().session().lightmap.clone().unwrap();
    assert_eq!(judged.report.texels.len(), (SIDE * SIDE) as usize);
    assert_eq!(judged.report.count(Fault::Dark), ((SIDE * SIDE / 4) as usize, "texels"));
    for fault in [Fault::Leak, Fault::Overlap, Fault::Stretched, Fault::Uneven] {
        assert_eq!(judged.report.count(fault).0, 0, "{}", fault.name());
    }
    // Three quarters are the closed form: what is left is its place in a texel.
    assert!(judged.errors.median < 1e-3, "{:?}", judged.errors);
    let dark = judged.fault_pixels().into_iter().filter(|p| *p == Fault::Dark.colour()).count();
    assert_eq!(dark, (SIDE * SIDE / 4) as usize);
    assert!(lightmap::text(&judged).contains("dark\t256\ttexels"));
    for name in ["lightmap", "our light on it", "difference", "faults"] {
        window.harness.get_by_label(name);
    }
    window.harness.get_by_label("256 texels");
    // On the floor itself: a quarter is black.
    window.harness.get_by_label("the lightmap").click();
    window.wait("the view", |app| app.session().inspection.as_ref().is_some_and(|i| !i.meshes.is_empty()));
    window.harness.run_steps(3);
    window.keep("lightmap_in_scene");
    let shown = window.app().session().inspection.clone().unwrap();
    let mesh = &shown.meshes[0];
    let black = mesh.values.iter().filter(|v| **v == Vec3::ZERO).count() as f32 / mesh.values.len() as f32;
    assert!((0.2..0.3).contains(&black), "{black}");

    // One that is no picture is said so once, and let go.
    let broken = folder.join("broken.exr");
    fs::write(&broken, "no picture").unwrap();
    window.run(Command::Lightmap(LightmapFile::new(broken)));
    window.wait("the notice", |app| !app.is_busy() && app.session().lightmap_file.is_none());
    // Nor does the scene keep showing the one before.
    window.wait("an empty view", |app| {
        let session = app.session();
        session.lightmap.is_none() && session.inspection.as_ref().is_some_and(|i| i.is_beside_the_scene())
    });

    // Another white, other light: twice as much as ours everywhere.
    window.run(Command::Lightmap(LightmapFile { white: 2.0, paths: 64, path: file.clone() }));
    window.wait("the lightmap again", |app| app.session().lightmap.is_some());
    let median = window.app().session().lightmap.as_ref().unwrap().errors.median;
    assert!((median - 1.0).abs() < 2e-3, "{median}");
    // And than the path tracer, which meets nothing but a point lamp and the floor: no noise.
    let traced = window.app().session().lightmap.as_ref().unwrap().traced.unwrap();
    assert!((traced.of_map.median - 1.0).abs() < 2e-3 && traced.of_ours.median < 1e-3, "{traced:?}");

    // What is no lightmap is said, and the scene stays.
    let broken = folder.join("broken.exr");
    fs::write(&broken, b"garbage").unwrap();
    window.harness.state_mut().drop_file(&ctx, &broken);
    window.wait("a notice", |app| app.notice().is_some());
    assert!(window.app().notice().unwrap().text.contains("broken.exr"));
    assert!(window.app().session().scene.is_some());
}
