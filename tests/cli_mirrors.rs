//! Mirrors on the command line: images-with-depth, walks, reflectance.

use super::{folder, run, scene, text};
use glam::Vec3;
use lumenscope_core::io::exr;
use std::fs;

#[test]
fn mirrors_are_shown_from_images_and_judged_by_how_many() {
    let (_keep, out) = folder();
    let pyramid = scene("mirror/pyramid.ron");
    let few = ["--size", "60x45", "--count", "1,3", "--tolerance", "0.3"];
    run(&[&["images", &pyramid, "--out", text(&out)][..], &few].concat()).unwrap();
    let samples = fs::read_to_string(out.join("samples.csv")).unwrap();
    assert!(samples.starts_with("reflector,side,hemispheres,images_per_hemisphere,resolution,bytes\n"));
    assert!(samples.lines().count() > 4, "{samples}");
    let table = fs::read_to_string(out.join("images.csv")).unwrap();
    let cell = |row: &str, column: usize| -> f64 {
        let line = table.lines().find(|l| l.starts_with(row)).unwrap();
        line.split(',').nth(column).unwrap().parse().unwrap()
    };
    // Three splats and by id for two counts, layered in two ways, and the heading.
    assert_eq!(table.lines().count(), 11, "{table}");
    assert!(cell("3,box", 2) > cell("1,box", 2) && cell("3,box", 5) <= cell("1,box", 5), "{table}");
    // Light read where the pixel's ray meets a point's triangle is nearer than the point's own.
    assert!(cell("3,ids", 3) < cell("3,box", 3), "{table}");
    assert!(out.join("geometry.png").exists());
    // Holes are as many as they are shown, in magenta.
    for name in ["1_box", "1_ids", "3_ids", "layered_box"] {
        let picture = image::open(out.join(format!("{name}.png"))).unwrap().to_rgb8();
        let magenta = picture.pixels().filter(|p| p.0 == [255, 0, 255]).count();
        assert_eq!(magenta as f64, cell(&name.replace('_', ","), 7), "{name}: {table}");
    }
    assert!(cell("1,ids", 7) > 0.0, "{table}");
    let error = run(&["images", &pyramid, "--out", text(&out), "--resolution", "100"]).unwrap_err();
    assert!(error.contains("100") && error.contains("power of two") && error.lines().count() == 1, "{error}");
    let fine = ["--element", "0.01", "--resolution", "1024"];
    let error = run(&[&["images", &pyramid, "--out", text(&out)][..], &fine].concat()).unwrap_err();
    assert!(error.contains("GB") && error.lines().count() == 1, "{error}");
    let error = run(&["images", &scene("cornell/cornell.ron"), "--out", text(&out)]).unwrap_err();
    assert!(error.contains("nothing flat is polished"), "{error}");
}

#[test]
fn images_are_kept_when_something_moves_and_both_ways_are_timed() {
    let (_keep, out) = folder();
    let pyramid = scene("mirror/pyramid.ron");
    let moved = |names: &str| {
        let few = ["--size", "60x45", "--count", "1", "--tolerance", "0.3", "--by", "-0.1,0,0.05"];
        run(&[&["images", &pyramid, "--out", text(&out), "--move", names][..], &few].concat())
    };
    moved("Lamp").unwrap();
    let table = fs::read_to_string(out.join("moved.csv")).unwrap();
    let row = table.lines().nth(1).unwrap();
    let numbers: Vec<f64> = row.split(',').skip(1).map(|n| n.parse().unwrap()).collect();
    let [rays, points, share, changed, images, ..] = numbers[..] else { panic!("{table}") };
    assert!(row.starts_with("Lamp,") && rays > 0.0 && 10.0 * rays < points, "{table}");
    assert!((share - 100.0 * rays / points).abs() < 1e-9 && changed > 0.0 && changed <= images, "{table}");
    let error = moved("nobody").unwrap_err();
    assert!(error.contains("no object is called `nobody`") && error.lines().count() == 1, "{error}");
}

#[test]
fn a_picture_has_its_mirrors_from_images_where_it_is_asked_to() {
    let (_keep, out) = folder();
    let pyramid = scene("mirror/pyramid.ron");
    let layers = |mirrors: &str| {
        let folder = out.join(mirrors);
        let arguments = ["--size", "60x45", "--backend", "cpu", "--frames", "1", "--tolerance", "0.3"];
        let arguments =
            [&["render", &pyramid, "--out", text(&folder), "--mirrors", mirrors][..], &arguments].concat();
        run(&arguments).unwrap();
        let report: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(folder.join("report.json")).unwrap()).unwrap();
        let line =
            report["plan"].as_array().unwrap().iter().find(|l| l["component"] == "mirror").unwrap().clone();
        (exr::read_layers(&folder.join("layers.exr")).unwrap(), report["mirror_images_bytes"].clone(), line)
    };
    let (geometry, none, exact) = layers("geometry");
    let (images, bytes, unknown) = layers("images");
    assert!(none.is_null() && bytes.as_u64().unwrap() > 1_000_000);
    assert_eq!(exact["expected_error"], "exact");
    assert_eq!(unknown["expected_error"], "unknown");
    let mut same = 0;
    for ((name, a), (_, b)) in geometry.iter().zip(&images) {
        if ["emitted", "direct", "indirect"].contains(&name.as_str()) {
            assert!(a.pixels == b.pixels, "{name}");
        } else if name == "mirror" {
            let mirrored = a.pixels.iter().zip(&b.pixels).filter(|(a, _)| **a != Vec3::ZERO);
            let is_same = |(a, b): &(&Vec3, &Vec3)| (**a - **b).abs().max_element() < 1e-3 * a.max_element();
            let count = mirrored.clone().count();
            same = mirrored.filter(is_same).count();
            // What is not the same are edges, a pixel wide in so small a picture, and what no image has seen.
            assert!(same < count && 2 * same > count, "{same} of {count} pixels are the same");
        }
    }
    assert!(same > 100);
}

#[test]
fn a_walk_is_timed_by_reflectors_and_method() {
    let (_keep, out) = folder();
    let path = out.join("path.csv");
    let places = "0,1.1,0.95,1.9,0,0.3,0\n1,0.9,0.8,2.1,0,0.3,0\n";
    fs::write(&path, format!("seconds,eye_x,eye_y,eye_z,target_x,target_y,target_z\n{places}")).unwrap();
    let pyramid = scene("mirror/pyramid.ron");
    let short = [
        "--frames",
        "2",
        "--size",
        "64x48",
        "--mirrors",
        "geometry,images",
        "--count",
        "1",
        "--tolerance",
        "0.3",
    ];
    let walk = |reflectors: &str| {
        let arguments =
            ["fly", &pyramid, "--path", text(&path), "--out", text(&out), "--reflectors", reflectors];
        run(&[&arguments[..], &short].concat())
    };
    if let Err(error) = walk("1") {
        assert!(std::env::var_os("LUMENSCOPE_REQUIRE_GPU").is_none_or(|v| v != "1"), "{error}");
        return println!("skipped: {error}");
    }
    let table = fs::read_to_string(out.join("fly.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(rows.len(), 3, "{table}");
    assert_eq!(rows[0][..3], ["reflectors", "mirrors", "views"]);
    assert_eq!([rows[1][1], rows[2][1]], ["geometry", "1 image"]);
    assert_eq!(rows[1][2], rows[2][2], "as many views");
    let report = fs::read_to_string(out.join("fly.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["rows"][0]["images_an_element"].is_null() && report["rows"][1]["images_an_element"] == 1);
    assert!(out.join("fly.svg").exists() && image::open(out.join("fly.png")).is_ok());
    let error = walk("99").unwrap_err();
    assert!(error.contains("99 reflectors asked for") && error.lines().count() == 1, "{error}");
}

#[test]
fn reflectance_is_mapped_and_shown_in_three_pictures() {
    let (_keep, out) = folder();
    let pyramid = scene("mirror/pyramid.ron");
    let gold = ["--size", "60x45", "--metal", "0.63,0.56,0.37", "--tolerance", "0.3"];
    run(&[&["reflectance", &pyramid, "--out", text(&out)][..], &gold].concat()).unwrap();
    let table = fs::read_to_string(out.join("reflectance.csv")).unwrap();
    let of = |degrees: f32| -> Vec3 {
        let rows = table.lines().filter(|l| l.starts_with("metal 0.63 0.56 0.37,"));
        let numbers = rows.map(|l| l.split(',').skip(1).map(|n| n.parse().unwrap()).collect::<Vec<f32>>());
        let row = numbers.min_by(|a, b| (a[0] - degrees).abs().total_cmp(&(b[0] - degrees).abs())).unwrap();
        Vec3::from_slice(&row[1..])
    };
    assert!((of(0.0) - Vec3::new(0.63, 0.56, 0.37)).abs().max_element() < 1e-4);
    assert!((of(90.0) - Vec3::ONE).abs().max_element() < 1e-3);
    let triptych = image::open(out.join("triptych.png")).unwrap();
    assert_eq!((triptych.width(), triptych.height()), (180, 65));
    for name in ["mirrored", "modulated", "final", "reflectance"] {
        assert!(out.join(format!("{name}.png")).exists(), "{name}");
    }
    let error = run(&["reflectance", &scene("cornell/cornell.ron"), "--out", text(&out)]).unwrap_err();
    assert!(error.contains("nothing is polished"), "{error}");
}
