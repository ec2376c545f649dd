//! The command line of glossy reflection, and its line in the plan.

use glam::Vec3;
use lumenscope_core::{
    glossy::GlossyMethod,
    io::exr,
    scene::{import, world::World},
    superposition::plan::{Component, Plan},
};
use lumenscope_tests::command_line::{folder, run, scene, text};
use std::{fs, path::Path};

#[test]
fn methods_are_judged_in_a_table_with_a_sheet() {
    let (_keep, out) = folder();
    let small = ["--size", "64x36", "--spp", "256", "--paths", "4", "--frames", "2", "--particles", "100"];
    let teapot = scene("glossy/teapot.ron");
    run(&[&["glossy", &teapot, "--out", text(&out), "--roughness", "0.2"][..], &small].concat()).unwrap();
    let table = fs::read_to_string(out.join("glossy.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
    // Every method, the kernel in full, particles with straight light and without.
    assert_eq!(rows.len(), 1 + GlossyMethod::OF_IMAGE.len() + 1 + 2);
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{table}");
    let rel_mse = |name: &str| {
        let row = rows.iter().find(|row| row[1] == name).unwrap();
        row[2].parse::<f64>().unwrap()
    };
    let [variant, half, sharp] = ["variant", "variant_half", "sharp"].map(rel_mse);
    assert!(0.0 < variant && variant < 0.5 * sharp && half < 0.5 * sharp, "{variant} {half} {sharp}");
    assert!(image::open(out.join("sheet_0.2.png")).unwrap().width() > 5 * 64);
}

#[test]
fn a_comparison_that_measures_nothing_is_an_error() {
    let (_keep, out) = folder();
    let file = out.join("dark.ron");
    let table = scene("glossy/teapot.glb");
    let lamp = "area_lamps: [(name: \"Lamp\", corner: (-0.5, 1.5, 0.1), edge_u: (1.0, 0.0, 0.0), \
                edge_v: (0.0, 0.0, 0.6), radiance: (900.0, 850.0, 760.0))],";
    let camera = |target: &str| {
        format!("camera: (eye: (0.35, 0.46, 1.25), target: {target}, up: (0.0, 1.0, 0.0), vertical_fov: 0.6)")
    };
    let small = ["--size", "32x18", "--spp", "2", "--paths", "0", "--frames", "1", "--particles", "100"];
    let cases = [
        ("", camera("(0.0, 0.1, -0.1)"), "nothing can be compared"),
        (lamp, camera("(0.35, 5.0, 1.3)"), "sees no flat glossy reflector"),
    ];
    for (lamps, camera, says) in cases {
        fs::write(&file, format!("(models: [(file: \"{table}\")], {lamps} {camera})")).unwrap();
        let arguments = ["glossy", text(&file), "--out", text(&out), "--roughness", "0.2"];
        let error = run(&[&arguments[..], &small].concat()).unwrap_err();
        assert!(error.contains(says) && error.contains("dark.ron") && error.lines().count() == 1, "{error}");
    }
    let error = run(&["glossy", &scene("cornell/cornell.ron"), "--out", text(&out)]).unwrap_err();
    assert!(error.contains("nothing flat is glossy"), "{error}");
}

#[test]
fn kernels_are_timed_by_radius_and_roughness() {
    let (_keep, out) = folder();
    let teapot = scene("glossy/teapot.ron");
    let small = ["--size", "64x48", "--roughness", "0.1,0.4"];
    run(&[&["glossy", &teapot, "--kernels", "--out", text(&out)][..], &small].concat()).unwrap();
    let table = fs::read_to_string(out.join("kernels.csv")).unwrap();
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let [apart, white] = [5, 6].map(|i| cells[i].parse::<f32>().unwrap());
        assert!(apart < 1e-4 && white < 1e-3 && cells[7].parse::<f32>().unwrap() < 1.0, "{row}");
    }
    assert_eq!(table.lines().count(), 1 + 10 + 2);
}

#[test]
fn the_kernel_of_a_point_is_drawn_and_counted() {
    let (_keep, out) = folder();
    let teapot = scene("glossy/teapot.ron");
    let small = ["--size", "96x54", "--frames", "1"];
    run(&[&["kernel", &teapot, "--out", text(&out)][..], &small].concat()).unwrap();
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(out.join("kernel.json")).unwrap()).unwrap();
    // The table of the scene: roughness 0.2, flat at height 0.
    assert!((report["roughness"].as_f64().unwrap() - 0.2).abs() < 1e-5);
    assert!(report["at_m"][1].as_f64().unwrap().abs() < 1e-3);
    assert!(report["samples_per_radian"].as_f64().unwrap() > 2.0);
    assert!(image::open(out.join("kernel.png")).unwrap().width() > 96);
    assert!(fs::read_to_string(out.join("spectrum.csv")).unwrap().lines().count() > 10);
    let outside = run(&["kernel", &teapot, "--out", text(&out), "--pixel", "5000,1"]).unwrap_err();
    assert!(outside.contains("--pixel 5000,1"), "{outside}");
    let dull = run(&["kernel", &scene("cornell/cornell.ron"), "--out", text(&out)]).unwrap_err();
    assert!(dull.contains("nothing glossy is seen"), "{dull}");
}

#[test]
fn render_takes_the_method_and_the_report_says_which() {
    let teapot = scene("glossy/teapot.ron");
    let glossy = |method: &str| {
        let (_keep, out) = folder();
        let small = ["--size", "64x36", "--backend", "cpu", "--frames", "1"];
        run(&[&["render", &teapot, "--out", text(&out), "--glossy", method][..], &small].concat()).unwrap();
        let report: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(out.join("report.json")).unwrap()).unwrap();
        let line = report["plan"].as_array().unwrap().iter().find(|l| l["component"] == "glossy").unwrap();
        let layers = exr::read_layers(&out.join("layers.exr")).unwrap();
        let layer = layers.into_iter().find(|(name, _)| name == "glossy").unwrap().1;
        (layer, line["settings"].as_str().unwrap().to_owned(), line["overridden"] == true)
    };
    let found = GlossyMethod::ALL.map(|m| glossy(m.name()));
    for (i, (layer, words, overridden)) in found.iter().enumerate() {
        assert!(*overridden && layer.mean().max_element() > 0.0, "{words}");
        for (other, ..) in &found[..i] {
            assert!(layer != other, "{words}: another method's picture");
        }
    }
    assert!(found[2].1.contains("one kernel a reflector"), "{}", found[2].1);
    let (_keep, out) = folder();
    let few = ["--glossy", "particles", "--particles", "1000", "--size", "32x18", "--backend", "cpu"];
    run(&[&["render", &teapot, "--out", text(&out)][..], &few].concat()).unwrap();
    let report = fs::read_to_string(out.join("report.json")).unwrap();
    assert!(report.contains("\"1000 particles of light"), "{report}");
}

#[test]
fn the_plan_frees_what_was_fixed_of_glossy_reflection() {
    let mut scene = import::load(Path::new(&scene("glossy/teapot.ron"))).unwrap();
    scene.plan.glossy = Some(GlossyMethod::Invariant);
    let plan = Plan::new(&scene, &World::new(&scene), 0.04, 1);
    let line = plan.lines.iter().find(|l| l.component == Component::Glossy).unwrap();
    assert!(line.used && line.overridden, "{line:?}");
    assert!(!plan.lines.iter().any(|l| l.component == Component::Mirror && l.overridden));
    let freed = Component::Glossy.freed(&scene.plan);
    assert!(freed.glossy.is_none() && freed.volume == scene.plan.volume);
    // Nothing flat is glossy: no pass, and the line says so.
    scene.materials.iter_mut().for_each(|m| (m.metallic, m.roughness) = (0.0, 1.0));
    scene.plan.glossy = None;
    let plan = Plan::new(&scene, &World::new(&scene), 0.04, 1);
    let line = plan.lines.iter().find(|l| l.component == Component::Glossy).unwrap();
    assert!(!line.used && line.reason.contains("nothing flat is glossy"), "{line:?}");
    assert_ne!(scene.camera.eye, Vec3::ZERO);
}
