//! The command line: what it writes, and the one line it leaves when something is wrong.

mod cli_mirrors;

use glam::{Vec2, Vec3};
use lumenscope_core::{
    io::exr,
    math::colour::luminance,
    radiosity::{atlas::lookup, faults::Fault},
    scene::{import, world::World},
};
use lumenscope_tests::command_line::{folder, run, scene, text};
use std::{fs, path::Path};

#[test]
fn render_writes_picture_layers_and_report() {
    let (_keep, out) = folder();
    let size = ["--size", "48x32", "--backend", "cpu", "--frames", "2"];
    let point = scene("analytic/point_over_floor.ron");
    run(&[&["render", &point, "--out", text(&out)][..], &size].concat()).unwrap();
    let layers = exr::read_layers(&out.join("layers.exr")).unwrap();
    let names: Vec<&str> = layers.iter().map(|l| l.0.as_str()).collect();
    assert_eq!(names, ["", "emitted", "direct", "indirect", "mirror", "glossy"]);
    for (i, picture) in layers[0].1.pixels.iter().enumerate() {
        let sum = layers[1..].iter().map(|l| l.1.pixels[i]).sum::<glam::Vec3>();
        assert!((*picture - sum).abs().max_element() <= 1e-5 * picture.max_element(), "pixel {i}");
    }
    assert!(layers[0].1.mean().max_element() > 0.0);
    assert_eq!(image::open(out.join("picture.png")).unwrap().width(), 48);
    let report = fs::read_to_string(out.join("report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["stage_seconds"]["radiosity"].is_number() && report["plan"].is_array());
    assert!(report["volume"].is_null(), "nothing moves in this scene: no volume");
}

#[test]
fn irradiance_is_that_of_the_closed_form() {
    let (_keep, out) = folder();
    let points = out.join("in.csv");
    fs::write(&points, "x,y,z,nx,ny,nz\n0.1,0,0.1,0,1,0\n1,0,0.5,0,1,0\n").unwrap();
    let table = out.join("out.csv");
    for method in ["radiosity", "reference"] {
        let point = scene("analytic/point_over_floor.ron");
        let wanted = ["--points", text(&points), "--method", method, "--out", text(&table)];
        run(&[&["irradiance", &point][..], &wanted].concat()).unwrap();
        let table = fs::read_to_string(&table).unwrap();
        for (line, r2) in table.lines().skip(1).zip([0.02f32, 1.25]) {
            let columns: Vec<f32> = line.split(',').map(|v| v.parse().unwrap()).collect();
            let expected = 100.0 / (1.0 + r2).powf(1.5);
            // A point lamp's I cos θ / d² carries nothing but rounding.
            assert!(
                (columns[6] / expected - 1.0).abs() < 1e-4,
                "{method}: {} lx, not {expected}",
                columns[6]
            );
        }
        assert_eq!(table.lines().next().unwrap().contains("stderr_r"), method == "reference");
    }
}

#[test]
fn probe_and_volume_leave_files_that_open() {
    let (_keep, out) = folder();
    let wall = scene("analytic/bright_wall_x.ron");
    run(&["probe", &wall, "--at", "-0.0,0.5,0", "--out", text(&out), "--bins", "1682"]).unwrap();
    let layers = exr::read_layers(&out.join("probe.exr")).unwrap();
    // The map has six rows a row of bins, twice as many columns; the bins are two squares of 29.
    assert_eq!((layers[0].1.width, layers.last().unwrap().1.width), (348, 58));
    for file in ["radiance.png", "radiance_unfolded.png", "irradiance_lobe.png", "radiance_radial.svg"] {
        assert!(fs::metadata(out.join(file)).unwrap().len() > 500, "{file}");
    }
    let report = fs::read_to_string(out.join("probe.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let lit = |axis: &str| report["irradiance_lx"]["all"][axis].as_f64().unwrap();
    // 1.7408 lx in closed form; the bin that holds +x is up to 3° off it, 64 shadow rays see it whole.
    assert!((lit("+x") / 1.7408 - 1.0).abs() < 0.01, "{} lx", lit("+x"));
    assert!(lit("-x") < 0.01, "{} lx behind", lit("-x"));
    let file = out.join("room.volume");
    run(&["volume", &wall, "--out", text(&file)]).unwrap();
    assert!(lumenscope_core::irradiance_volume::IrradianceVolume::load(&file).unwrap().samples().len() > 8);
}

#[test]
fn a_volume_is_built_and_asked_as_wished() {
    let (_keep, out) = folder();
    let boxed = scene("analytic/closed_box.ron");
    let file = out.join("box.volume");
    let wished = ["--basis", "harmonics", "--repair", "relocate", "--guard", "--moments", "2,inf"];
    let more = ["--compare-bases", "--queries", "1000"];
    run(&[&["volume", &boxed, "--out", text(&file)][..], &wished, &more].concat()).unwrap();
    let volume = lumenscope_core::irradiance_volume::IrradianceVolume::load(&file).unwrap();
    let settings = serde_json::to_value(volume.settings()).unwrap();
    assert_eq!(settings["basis"], "harmonics");
    assert_eq!((&settings["repair"], &settings["guard"]), (&"relocate".into(), &true.into()));
    assert_eq!(volume.orders().len(), 3);
    let wrong = run(&["volume", &boxed, "--out", text(&file.join("no")), "--queries", "1"]).unwrap_err();
    assert!(wrong.contains("box.volume"), "{wrong}");

    let wall = scene("analytic/bright_wall_x.ron");
    let options = ["--at", "0,0.5,0", "--out", text(&out), "--bins", "578", "--moment", "2,inf"];
    run(&[&["probe", &wall][..], &options].concat()).unwrap();
    let report = fs::read_to_string(out.join("probe.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    // Order 2 is narrower than irradiance: nearer to πL = 3.14 lx towards a wall that fills its lobe.
    let towards = |of: &serde_json::Value| of["+x"].as_f64().unwrap();
    assert!(towards(&report["moments_lx"]["2"]) > 1.05 * towards(&report["irradiance_lx"]["all"]));
    let layers = exr::read_layers(&out.join("probe.exr")).unwrap();
    assert!(layers.iter().any(|l| l.0 == "moment_2_indirect_lx") && out.join("moment_2_lobe.png").exists());
    assert!(out.join("weights.png").exists());

    let office = scene("cornell/cornell.ron");
    let size = ["--size", "24x16", "--frames", "1", "--moment", "10", "--detail", "pixels"];
    run(&[&["render", &office, "--out", text(&out)][..], &size].concat()).unwrap();
    let report = fs::read_to_string(out.join("report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["backend"], "cpu", "only the processor asks at pixels");
}

#[test]
fn elements_are_laid_out_as_the_command_line_asks() {
    let (_keep, out) = folder();
    let cornell = scene("cornell/quadtrees.ron");
    let elements = |options: &[&str]| {
        let size = ["--size", "16x9", "--frames", "1", "--backend", "cpu", "--out", text(&out)];
        run(&[&["render", &cornell][..], &size, options].concat()).map(|_| {
            let report = fs::read_to_string(out.join("report.json")).unwrap();
            serde_json::from_str::<serde_json::Value>(&report).unwrap().to_string()
        })
    };
    let planned = elements(&[]).unwrap();
    assert!(
        planned.contains("split up to 3 times where light bends by more than 5.0 %, restricted"),
        "{planned}"
    );
    let asked = ["--element-levels", "1", "--element-tolerance", "0.2", "--element-restricted", "false"];
    let asked = elements(&asked).unwrap();
    assert!(asked.contains("split up to 1 time where light bends by more than 20.0 %\""), "{asked}");
    let error = elements(&["--element-levels", "9"]).unwrap_err();
    assert!(error.contains("element_levels cannot be 9"), "{error}");
}

#[test]
fn placement_writes_numbers_a_table_and_a_map_and_warns() {
    let (_keep, out) = folder();
    let point = scene("analytic/point_over_floor.ron");
    let plane = "Floor";
    let task = ["--task", "Technical drawing", "--max-lx", "1e5"];
    run(&[&["placement", &point, "--plane", plane, "--out", text(&out)][..], &task].concat()).unwrap();
    let report = fs::read_to_string(out.join("placement.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["sufficient"], false);
    let warnings = report["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|w| w.as_str().unwrap().contains("of 750 lx")), "{warnings:?}");
    let table = fs::read_to_string(out.join("placement.csv")).unwrap();
    let mut sum = 0.0;
    for line in table.lines().skip(1) {
        let c: Vec<f32> = line.split(',').map(|v| v.parse().unwrap()).collect();
        let (x, h, z, found) = (c[2], 1.0 - c[3], c[4], c[5]);
        // 100 cd at one metre over the floor: I h / d³, up to rounding.
        let expected = 100.0 * h / (h * h + x * x + z * z).powf(1.5);
        assert!((found / expected - 1.0).abs() < 1e-4, "{line}: {expected} lx");
        sum += found;
    }
    let (points, mean) = (table.lines().count() - 1, report["statistics"]["mean_lx"].as_f64().unwrap());
    assert!((f64::from(sum) / points as f64 / mean - 1.0).abs() < 1e-4);
    assert!(image::open(out.join("placement.png")).unwrap().width() >= 520);
    let top = ["--plane", "nothing of that name"];
    let error = run(&[&["placement", &point, "--out", text(&out)][..], &top].concat()).unwrap_err();
    assert!(error.contains("nothing of that name") && error.contains("point_over_floor"), "{error}");
}

#[test]
fn copies_are_lit_by_two_volumes_at_once() {
    let (_keep, out) = folder();
    let cornell = scene("cornell/cornell.ron");
    let lights = ["--left", "3:indirect", "--right", "17:all", "--size", "48x48", "--out", text(&out)];
    run(&[&["copies", &cornell, "--object", "Short block"][..], &lights].concat()).unwrap();
    let report = fs::read_to_string(out.join("copies.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let mean = |side: &str| report[side]["mean_illuminance_lx"].as_f64().unwrap();
    assert!(0.0 < mean("left") && mean("left") < mean("right"), "{report}");
    assert_eq!((report["left"]["bins"].as_u64(), report["right"]["bins"].as_u64()), (Some(18), Some(578)));
    assert_eq!(image::open(out.join("copies.png")).unwrap().width(), 48);
    let error = run(&["copies", &cornell, "--object", "Nobody", "--out", text(&out)]).unwrap_err();
    assert!(error.contains("Nobody"));
}

#[test]
fn a_wall_streams_by_and_a_moving_object_is_counted() {
    let (_keep, out) = folder();
    let furnace = scene("analytic/furnace_box_0_5.ron");
    let place = ["--corner", "-0.4,0.1,-0.3", "--edge-u", "0.8,0,0", "--edge-v", "0,0.8,0"];
    let small = ["--polygons", "2000", "--size", "48x32", "--shadow-rays", "0", "--out", text(&out)];
    run(&[&["wall", &furnace][..], &place, &small].concat()).unwrap();
    let report = fs::read_to_string(out.join("wall.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["polygons"].as_u64().unwrap() >= 2000 && report["pixels"].as_u64().unwrap() > 0);
    assert_eq!(image::open(out.join("wall.png")).unwrap().width(), 48);
    let table = out.join("cost.csv");
    let short = ["--frames", "2", "--size", "32x20", "--out", text(&table)];
    run(&[&["cost", &furnace][..], &short].concat()).unwrap();
    let table = fs::read_to_string(&table).unwrap();
    let polygons = |line: &str| line.split(',').nth(1).and_then(|v| v.parse::<f32>().ok());
    let found: Vec<f32> = table.lines().skip(1).filter_map(polygons).collect();
    assert_eq!(found.len(), 5);
    for (found, wanted) in found.iter().zip([1162.0, 1921.0, 3145.0, 4639.0, 6598.0]) {
        // A ball has whole numbers of rows and columns.
        assert!((found / wanted - 1.0).abs() < 0.06, "{found} polygons of {wanted}");
    }
    let error = run(&[&["wall", &furnace, "--edge-u", "0,1,0", "--edge-v", "0,2,0"][..], &small].concat());
    assert!(error.unwrap_err().contains("no area"));
}

#[test]
fn a_picture_equals_itself_and_resembles_the_reference() {
    let (_keep, out) = folder();
    let point = scene("analytic/point_over_floor.ron");
    let reference = out.join("reference.exr");
    let small = ["--size", "48x32"];
    run(&[&["reference", &point, "--out", text(&reference), "--spp", "64"][..], &small].concat()).unwrap();
    let cpu = ["--backend", "cpu", "--frames", "64"];
    run(&[&["render", &point, "--out", text(&out)][..], &small, &cpu].concat()).unwrap();
    let picture = out.join("layers.exr");
    run(&["compare", text(&picture), text(&picture)]).unwrap();
    let difference = out.join("difference");
    run(&["compare", text(&picture), text(&reference), "--out", text(&difference)]).unwrap();
    assert_eq!(image::open(difference.join("flip.png")).unwrap().width(), 48);
    let found = exr::read_layers(&difference.join("difference.exr")).unwrap();
    let wanted = exr::read_layers(&reference).unwrap();
    let (off, mean) = (luminance(found[0].1.mean()), luminance(wanted[0].1.mean()));
    // One lamp without area and no bounce: only pixels on the floor's edge differ.
    assert!(off < 0.02 * mean, "mean difference {off} of {mean} cd/m²");
}

#[test]
fn a_lightmap_is_held_against_our_light() {
    let (_keep, out) = folder();
    let map = out.join("map.exr");
    let grey = lumenscope_core::math::image::LinearImage::from_fn(64, 64, |_, _| glam::Vec3::splat(100.0));
    exr::write_layers(&map, &[("", &grey)], "lx").unwrap();
    let floor = "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nvt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3 4/4\n";
    fs::write(out.join("floor.obj"), floor).unwrap();
    let lamp = "Point(name: \"lamp\", at: (0.5, 1.0, 0.5), intensity: (100.0, 100.0, 100.0))";
    fs::write(out.join("floor.ron"), format!("(models: [(file: \"floor.obj\")], lamps: [{lamp}])")).unwrap();
    let point = out.join("floor.ron").display().to_string();
    run(&["lightmap", &point, "--map", text(&map), "--reference", "64", "--out", text(&out)]).unwrap();
    // The path tracer's light on the texels: a point lamp's I cos θ / d², without noise.
    let traced = &exr::read_layers(&out.join("reference.exr")).unwrap()[0].1;
    let corner = 100.0 / (1.0 + 2.0 * (0.5f32 - 0.5 / 64.0).powi(2)).powf(1.5);
    assert!((traced.at(0, 0).x / corner - 1.0).abs() < 1e-3, "{} lx, not {corner}", traced.at(0, 0).x);
    let bare = scene("analytic/point_over_floor.ron");
    let error = run(&["lightmap", &bare, "--map", text(&map)]).unwrap_err();
    assert!(error.contains("cover no texel"), "{error}");
    for name in ["difference.png", "faults.png"] {
        assert_eq!(image::open(out.join(name)).unwrap().width(), 64);
    }
    assert_eq!(exr::read_layers(&out.join("ours.exr")).unwrap()[0].1.width, 64);
    let missing = run(&["lightmap", &point, "--map", "nothing.exr"]).unwrap_err();
    assert!(missing.contains("nothing.exr"), "{missing}");
}

#[test]
fn light_is_baked_onto_the_coordinates_of_a_file_or_onto_packed_ones() {
    let (_keep, out) = folder();
    let (map, packed) = (out.join("light.exr"), out.join("packed.obj"));
    let bare = scene("analytic/point_over_floor.ron");
    let error = run(&["bake", &bare, "--out", text(&map)]).unwrap_err();
    assert!(error.contains("--atlas") && error.contains("cover no texel"), "{error}");
    run(&["bake", &bare, "--out", text(&map), "--atlas", text(&packed), "--padding", "2"]).unwrap();
    // What was written is a scene over whose coordinates the light lies.
    let again = import::load(&packed).unwrap();
    let world = World::new(&again);
    let light = &exr::read_layers(&map).unwrap()[0].1;
    for t in 0..world.geometry.len() as u32 {
        let uv = world.geometry.lightmap_uvs[t as usize];
        let position = world.geometry.positions[t as usize].into_iter().sum::<Vec3>() / 3.0;
        let found = luminance(lookup(light, uv.into_iter().sum::<Vec2>() / 3.0));
        let wanted = 100.0 / position.distance(Vec3::Y).powi(3);
        assert!((found - wanted).abs() < 0.02 * wanted, "{position}: {found} for {wanted}");
    }
    let size = run(&["bake", &bare, "--out", text(&map), "--size", "9000x10"]).unwrap_err();
    assert!(size.contains("9000"), "{size}");
}

#[test]
fn a_lightmap_packed_here_has_no_overlap_and_no_leak() {
    let (_keep, out) = folder();
    let (map, packed) = (out.join("light.exr"), out.join("packed.obj"));
    let ball = scene("cornell/ball.ron");
    run(&["bake", &ball, "--out", text(&map), "--atlas", text(&packed), "--padding", "2"]).unwrap();
    let judge = ["lightmap", &ball, "--map", text(&map), "--out", text(&out), "--coordinates"];
    run(&[&judge[..], &[text(&packed)]].concat()).unwrap();
    let faults = image::open(out.join("faults.png")).unwrap().to_rgb8();
    for fault in [Fault::Overlap, Fault::Leak, Fault::NotFinite] {
        let texels = faults.pixels().filter(|p| p.0 == fault.colour()).count();
        assert_eq!(texels, 0, "{}", fault.name());
    }
    let other = scene("cornell/cornell.ron");
    let error = run(&["lightmap", &other, "--map", text(&map), "--coordinates", text(&packed)]).unwrap_err();
    assert!(error.contains("2244 triangles"), "{error}");
}

#[test]
fn the_texture_of_a_triangle_and_of_a_column_is_judged() {
    let (_keep, out) = folder();
    let patches = scene("cornell/patches.ron");
    for (at, size) in [("-0.16,0.06,-0.09", [17, 17]), ("0.09,0.25,-0.119", [32, 33])] {
        run(&["textures", "--scene", &patches, "--at", at, "--out", text(&out)]).unwrap();
        let table = fs::read_to_string(out.join("stages.csv")).unwrap();
        assert_eq!(table.lines().count(), 6, "a header, two conversions, three stages");
        let stored = table.lines().find(|l| l.starts_with("1 stored")).unwrap();
        assert_eq!(
            stored.split(',').nth(1),
            Some((size[0] * size[1]).to_string().as_str()),
            "{at}: {stored}"
        );
        assert!(image::open(out.join("stages.png")).unwrap().height() > 300);
    }
}

#[test]
fn textures_are_judged_in_a_table_a_sheet_and_layers() {
    let (_keep, out) = folder();
    run(&["textures", "--out", text(&out), "--samples", "3", "--depths", "2"]).unwrap();
    let table = fs::read_to_string(out.join("table.csv")).unwrap();
    let layers = exr::read_layers(&out.join("textures_3.exr")).unwrap();
    assert_eq!(table.lines().count(), layers.len(), "a header and a reference");
    assert!(image::open(out.join("sheet_3.png")).unwrap().height() > 1000);
    // Each way at two depths; deeper ones come nearer with more texels, unless a wide prefilter undoes it.
    let depths = fs::read_to_string(out.join("depths.csv")).unwrap();
    assert_eq!(depths.lines().count() - 1, 2 * (table.lines().count() - 1));
    let of = |start: &str| {
        let line = depths.lines().find(|l| l.starts_with(start)).unwrap();
        let column = |i: usize| line.rsplit(',').nth(i).unwrap().parse::<f64>().unwrap();
        [column(8), column(4)]
    };
    let (coarse, fine) = (of("3,\"3 x 3 samples, bilinear"), of("5,\"5 x 5 samples, bilinear"));
    assert!(coarse[0] == 9.0 && fine[0] == 25.0 && coarse[1] > 2.0 * fine[1], "{coarse:?} {fine:?}");
    assert!(fs::read_to_string(out.join("depths.svg")).unwrap().contains("relMSE"));
    assert!(image::open(out.join("depths.png")).unwrap().width() > 2000);
    let error = run(&["textures", "--out", text(&out), "--samples", "6"]).unwrap_err();
    assert!(error.contains("--samples 6 is not a power of two plus 1"), "{error}");
}

#[test]
fn methods_are_charted_against_the_path_tracer() {
    let (_keep, out) = folder();
    let path = out.join("room.ron");
    let lamp = "(name: \"Lamp\", corner: (-1.4, 2.45, -0.3), edge_u: (0.6, 0.0, 0.0), edge_v: (0.0, 0.0, 0.6), \
                radiance: (1000.0, 1000.0, 1000.0))";
    let room = scene("analytic/closed_box.glb");
    let plan = "(element_spacing_m: 0.5, gather_rays: 16)";
    fs::write(&path, format!("(models: [(file: {room:?})], area_lamps: [{lamp}], plan: {plan})")).unwrap();
    let few = ["--points", "30", "--spp", "64", "--size", "16x9", "--methods", "radiosity,quadtrees,paths"];
    run(&[&["chart", text(&path), "--out", text(&out)][..], &few].concat()).unwrap();
    let table = fs::read_to_string(out.join("chart.csv")).unwrap();
    // Three numbers of rays at six spacings and at five of roots, six numbers of paths, a header.
    assert_eq!(table.lines().count(), 1 + 3 * 6 + 3 * 5 + 6);
    let error = |line: &str| line.rsplit(',').nth(7).unwrap().parse::<f64>().unwrap();
    assert!(table.lines().skip(1).all(|l| error(l) > 0.0 && error(l).is_finite()));
    let front: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(out.join("pareto.json")).unwrap()).unwrap();
    let front = front["pareto_front"]["picture"].as_array().unwrap();
    let falls = |w: &[serde_json::Value]| {
        let of = |i: usize, what: &str| w[i]["row"][what].as_f64().unwrap();
        let median = |i: usize| w[i]["row"]["picture"]["median"].as_f64().unwrap();
        of(0, "seconds") < of(1, "seconds") && median(0) > median(1)
    };
    assert!(!front.is_empty() && front.windows(2).all(falls), "{front:?}");
    let drawing = fs::read_to_string(out.join("chart.svg")).unwrap();
    assert!(drawing.contains("median error, %") && drawing.contains("Pareto front"));
    assert!(image::open(out.join("chart.png")).unwrap().width() > 800);
    // The light it found is read again, and held to the same surfaces.
    let known = ["--truth", text(&out.join("reference.csv")), "--methods", "paths", "--size", "16x9"]
        .map(str::to_owned);
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    run(&[&["chart", text(&path), "--out", text(&out)][..], &known].concat()).unwrap();
    assert_eq!(fs::read_to_string(out.join("chart.csv")).unwrap().lines().count(), 1 + 6);
}

#[test]
fn replay_times_every_step() {
    let (_keep, out) = folder();
    let script = out.join("drag.ron");
    fs::write(&script, "(target: \"Lamp\", steps: [(translate: (0.2, 0.0, 0.0)), (dimmer: 0.5)])").unwrap();
    let point = scene("analytic/point_over_floor.ron");
    run(&["replay", &point, "--script", text(&script), "--out", text(&out)]).unwrap();
    let table = fs::read_to_string(out.join("replay.csv")).unwrap();
    assert_eq!(table.lines().count(), 3);
    let settled: f32 = table.lines().nth(2).unwrap().split(',').nth(5).unwrap().parse().unwrap();
    assert!(settled < 1e-5, "a settled drag equals a fresh solve: {settled}");
}

#[test]
fn mistakes_are_told_in_one_line_that_names_the_file() {
    let (_keep, out) = folder();
    let point = scene("analytic/point_over_floor.ron");
    let bad = out.join("bad.csv");
    fs::write(&bad, "x,y,z\n1,2,3\n").unwrap();
    let file = out.join("file");
    fs::write(&file, "not a folder").unwrap();
    let inside = file.join("out");
    let broken = out.join("broken.glb");
    fs::write(&broken, b"glTF\x02\0\0\0").unwrap();
    let cases: [(&[&str], &str); 7] = [
        (&["check", "no/such/scene.glb"], "no/such/scene.glb"),
        (&["check", text(&broken)], "broken.glb"),
        (&["irradiance", &point, "--points", text(&bad), "--method", "volume", "--out", "x"], "bad.csv"),
        (&["render", &point, "--out", text(&inside), "--size", "8x8"], "out"),
        (&["probe", &point, "--at", "0,1,0", "--out", text(&out), "--bins", "100"], "100"),
        (&["compare", text(&broken), text(&broken)], "broken.glb"),
        (&["replay", &point, "--script", text(&bad), "--out", text(&out)], "bad.csv"),
    ];
    for (arguments, named) in cases {
        let error = run(arguments).expect_err(&format!("{arguments:?} is wrong"));
        assert!(error.contains(named), "{arguments:?}: {error}");
        assert_eq!(error.lines().count(), 1, "{arguments:?}: {error}");
    }
}

#[test]
fn volumes_are_compared_ignored_and_made_of_panoramas() {
    let (_keep, out) = folder();
    let point = scene("analytic/point_over_floor.ron");
    let whole = out.join("whole.volume");
    let small = ["--bins-n", "5", "--target-samples", "60", "--refine-tolerance", "0.3"];
    run(&[&["volume", &point, "--out", text(&whole)][..], &small].concat()).unwrap();
    let names = lumenscope_core::scene::import::load(Path::new(&point)).unwrap();
    let without = out.join("without.volume");
    let lamp = ["--ignore", &names.lamps[0].name];
    run(&[&["volume", &point, "--out", text(&without)][..], &small, &lamp].concat()).unwrap();
    run(&["compare", text(&whole), text(&without)]).unwrap();
    let error = run(&["volume", &point, "--out", text(&without), "--ignore", "nobody"]).unwrap_err();
    assert!(error.contains("nobody"), "{error}");

    for (i, at) in ["-0.5,1,0", "0.5,1,0"].into_iter().enumerate() {
        let file = out.join(format!("{i}.exr"));
        run(&["panorama", &point, "--at", at, "--out", text(&file), "--height", "16", "--rays", "1"])
            .unwrap();
        let image = &exr::read_layers(&file).unwrap()[0].1;
        assert_eq!((image.width, image.height), (32, 16));
        assert!(image.mean().max_element() > 0.0);
    }
    let list = out.join("nodes.ron");
    let lines =
        "[(position: (-0.5, 1.0, 0.0), file: \"0.exr\"), (position: (0.5, 1.0, 0.0), file: \"1.exr\")]";
    fs::write(&list, lines).unwrap();
    let pictures = out.join("pictures.volume");
    run(&["panoramas", text(&list), "--out", text(&pictures), "--bins-n", "5"]).unwrap();
    let made = lumenscope_core::irradiance_volume::IrradianceVolume::load(&pictures).unwrap();
    let down = made.irradiance(glam::Vec3::Y, glam::Vec3::NEG_Y, lumenscope_core::math::part::Part::All);
    assert!(down.x > 0.0 && made.samples().len() == 8);
    fs::write(&list, "[(position: (0.0, 1.0, 0.0), file: \"none.exr\")]").unwrap();
    let error = run(&["panoramas", text(&list), "--out", text(&pictures)]).unwrap_err();
    assert!(error.contains("none.exr"), "{error}");
}

#[test]
fn the_weights_of_one_point_are_printed_and_bad_points_are_named() {
    let (_keep, out) = folder();
    let walls = scene("analytic/four_walls.ron");
    let table = out.join("one.csv");
    let at = ["--at", "0,0,0", "--normal", "-1,0,0", "--weights", "--out", text(&table)];
    run(&[&["irradiance", &walls, "--samples", "5,5,5", "--bins-n", "29"][..], &at].concat()).unwrap();
    let written = fs::read_to_string(&table).unwrap();
    let values: Vec<f32> = written.lines().nth(1).unwrap().split(',').map(|v| v.parse().unwrap()).collect();
    // By hand 8.364 lx at the centre, see the scene's file, where a sample is; leaves of the walls that the horizon
    // cuts count as one direction each.
    assert!((values[6] / 8.364 - 1.0).abs() < 0.02, "{} lx", values[6]);
    let wrong = |options: &[&str]| run(&[&["irradiance", &walls], options].concat()).unwrap_err();
    assert!(wrong(&["--at", "0,0,0", "--normal", "0,0,0"]).contains("--normal"));
    assert!(wrong(&["--at", "0,0,0", "--weights", "--method", "reference"]).contains("--weights"));
}

#[test]
fn volumes_are_compared_in_maps_and_light_copies_from_files() {
    let (_keep, out) = folder();
    let cornell = scene("cornell/cornell.ron");
    let of = |name: &str, more: &[&str]| {
        let file = out.join(name).display().to_string();
        let common = ["volume", &cornell, "--out", &file, "--samples", "4,4,4", "--bins-n", "5"];
        run(&[&common[..], more].concat()).unwrap();
        file
    };
    let (all, without) = (of("all.volume", &[]), of("without.volume", &["--ignore", "Lamp"]));
    let maps = out.join("maps");
    run(&["compare", &all, &without, "--out", text(&maps)]).unwrap();
    assert!(image::open(maps.join("map.png")).unwrap().width() > 400);
    assert!(image::open(maps.join("histogram.png")).unwrap().height() > 200);
    let histogram = fs::read_to_string(maps.join("histogram.csv")).unwrap();
    let shares: f32 =
        histogram.lines().skip(1).map(|l| l.split(',').nth(1).unwrap().parse::<f32>().unwrap()).sum();
    assert!((shares - 100.0).abs() < 0.01, "{shares} %");
    let (left, right) = (format!("{all}:all"), format!("{without}:all"));
    let object = ["--object", "Short block", "--left", &left, "--right", &right, "--size", "48x32"];
    run(&[&["copies", &cornell, "--out", text(&out)][..], &object].concat()).unwrap();
    let report = fs::read_to_string(out.join("copies.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let mean = |side: &str| report[side]["mean_illuminance_lx"].as_f64().unwrap();
    assert!(mean("left") > 1.2 * mean("right") && mean("right") > 0.0, "{report}");
    let missing = format!("{}:all", out.join("none.volume").display());
    let object = ["--object", "Short block", "--left", &missing];
    let wrong = run(&[&["copies", &cornell, "--out", text(&out)][..], &object].concat()).unwrap_err();
    assert_eq!(wrong.matches("No such file").count(), 1, "{wrong}");
}

#[test]
fn leaks_are_printed_and_what_is_too_large_is_refused_in_one_line() {
    let rooms = scene("analytic/two_rooms.ron");
    let boxes = ["--lit", "-2,0,-1.5:0.29,2.5,1.5", "--dark", "0.31,0,-1.5:2,2.5,1.5"];
    run(&[&["volume", &rooms, "--samples", "5,4,4", "--second-level", "2", "--bins-n", "5"][..], &boxes]
        .concat())
    .unwrap();
    let error =
        run(&["volume", &rooms, "--out", "no.volume", "--samples", "200,200,200", "--guard", "false"])
            .unwrap_err();
    assert!(error.contains("GB") && !error.contains('\n'), "{error}");
    assert_eq!(error.matches("irradiance volume").count(), 1, "said once: {error}");
}

#[test]
fn views_are_written_with_their_legend_and_in_numbers() {
    let (_keep, out) = folder();
    let room = scene("cornell/cornell.ron");
    let views = "radiosity.irradiance,irradiance_volume.slice,radiosity.links,radiosity.seams";
    let how = ["--size", "160x200", "--percentiles", "0,100", "--slice", "y=0.3", "--at", "0,0,0"];
    run(&[&["view", &room, "--view", views, "--out", text(&out)][..], &how].concat()).unwrap();
    for view in views.split(',') {
        let picture = image::open(out.join(format!("{view}.png"))).unwrap();
        assert!(picture.width() > 200 && picture.height() == 200, "{view}: the legend stands beside");
        let report = fs::read_to_string(out.join(format!("{view}.json"))).unwrap();
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert!(report["unit"].is_string() && report["quantity"].is_string(), "{report}");
        let [low, high] = ["colours_from", "colours_to"].map(|key| report[key].as_f64().unwrap());
        assert!(low < high, "{report}");
    }
    // The floor's middle takes its light from many others: the notes say how much.
    let links = fs::read_to_string(out.join("radiosity.links.json")).unwrap();
    assert!(links.contains(" lx from other elements"), "{links}");
    let range = ["--range", "0,400", "--palette", "natural"];
    let one = ["--view", "radiosity.irradiance", "--size", "32x32", "--out", text(&out)];
    run(&[&["view", &room][..], &one, &range].concat()).unwrap();
    let report = fs::read_to_string(out.join("radiosity.irradiance.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!((&report["colours_from"], &report["colours_to"]), (&0.0.into(), &400.0.into()));
}

#[test]
fn a_view_holds_the_volume_against_a_file_or_against_itself_without_some_light() {
    let (_keep, out) = folder();
    let room = scene("cornell/cornell.ron");
    let file = out.join("present.volume");
    run(&["volume", &room, "--out", text(&file)]).unwrap();
    let most = |view: &str, how: &[&str]| {
        let fixed = ["view", &room, "--view", view, "--size", "32x32", "--out", text(&out)];
        run(&[&fixed[..], how].concat()).unwrap();
        let report = fs::read_to_string(out.join(format!("{view}.json"))).unwrap();
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        report["found"][1].as_f64().unwrap()
    };
    let against = ["--against", text(&file), "--colour-by", "error"];
    assert_eq!(most("irradiance_volume.spheres", &against), 0.0, "the same scene, the same volume");
    assert_eq!(most("irradiance_volume.difference", &["--against", text(&file)]), 0.0);
    assert!(most("irradiance_volume.difference", &["--ignore", "Lamp"]) > 100.0);
    assert!(
        run(&["view", &room, "--ignore", "Nothing", "--out", text(&out)]).unwrap_err().contains("Nothing")
    );
    assert!(run(&["view", &room, "--moment", "7", "--out", text(&out)]).unwrap_err().contains("--moment 7"));
}

#[test]
fn views_that_cannot_be_shown_say_so_in_a_line() {
    let (_keep, out) = folder();
    let room = scene("cornell/cornell.ron");
    let wrong = |arguments: &[&str]| {
        let error = run(&[&["view", &room, "--out", text(&out)][..], arguments].concat()).unwrap_err();
        assert_eq!(error.lines().count(), 1, "{error}");
        error
    };
    assert!(wrong(&["--view", "radiosity.nothing"]).contains("view --list"));
    assert!(wrong(&["--range", "5,5"]).contains("--range"));
    assert!(wrong(&["--sphere", "0"]).contains("--sphere"));
    assert!(wrong(&["--view", "mirror.images", "--size", "16x16"]).contains("mirror.images"));
}
