//! Tests of scene: import of every format, placed geometry, and the checks.

use glam::{Affine3A, Quat, Vec2, Vec3};
use lumenscope_core::{
    math::{colour::linear_from_srgb, image::LinearImage},
    scene::{
        Object, Part, Scene, Target,
        camera::Camera,
        check::{Severity, check},
        geometry::Geometry,
        import::{ADDED_ILLUMINANCE, SceneError, add_model, load},
        lamp::{Lamp, LampKind},
        material::Material,
        mesh::Mesh,
        world::World,
    },
};
use lumenscope_tests::glb;
use serde_json::{Value, json};
use std::f64::consts::FRAC_1_SQRT_2;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

const CUBE_OBJ: &str = "mtllib cube.mtl\no cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    usemtl red\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nusemtl lamp\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";
const CUBE_MTL: &str = "newmtl red\nKd 0.6 0.1 0.1\nnewmtl lamp\nKd 0 0 0\nKe 100 200 300\n";

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

fn png(pixels: &[[u8; 3]]) -> Vec<u8> {
    let mut picture = image::RgbImage::new(pixels.len() as u32, 1);
    pixels.iter().enumerate().for_each(|(i, p)| picture.put_pixel(i as u32, 0, image::Rgb(*p)));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The buffer of one quad: positions, texture coordinates, indices; 48 + 32 + 12 bytes.
fn quad_bytes() -> Vec<u8> {
    let positions: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
    let uvs: [f32; 8] = [0., 1., 1., 1., 1., 0., 0., 0.];
    let mut bytes: Vec<u8> = positions.iter().chain(&uvs).flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

/// A file with one quad, used by two nodes in a hierarchy, a lit material, lamps and a camera.
fn quad_gltf() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_texture_transform"],
        "scene": 0,
        "scenes": [{"nodes": [0, 3, 4, 5, 6]}],
        "nodes": [
            {"name": "parent", "translation": [10, 0, 0], "scale": [2, 2, 2], "children": [1, 2]},
            {"name": "plain", "mesh": 0, "extras": {"movable": true}},
            {"name": "mirrored", "mesh": 0, "scale": [-1, 1, 1]},
            {"name": "bulb", "translation": [0, 3, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"name": "spot", "rotation": [-FRAC_1_SQRT_2, 0, 0, FRAC_1_SQRT_2],
                "extensions": {"KHR_lights_punctual": {"light": 1}}},
            {"name": "sun", "extensions": {"KHR_lights_punctual": {"light": 2}}},
            {"name": "view", "translation": [0, 1, 5], "camera": 0}
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "point", "color": [1, 0.5, 0.25], "intensity": 40},
            {"type": "spot", "intensity": 100, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5}},
            {"type": "directional", "intensity": 1000}
        ]}},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{
            "name": "paper",
            "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.75, 1], "metallicFactor": 0, "roughnessFactor": 0.5,
                "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}}},
            "emissiveFactor": [1, 0.5, 0],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 200}}
        }],
        "textures": [{"source": 0}],
        "images": [{"uri": "two%20tones.png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12}
        ],
        "buffers": [{"byteLength": 92, "uri": "quad.bin"}]
    })
}

fn write_quad(folder: &Path, gltf: &Value) -> PathBuf {
    write(folder, "two tones.png", png(&[[255, 255, 255], [128, 128, 128]]));
    write(folder, "quad.bin", quad_bytes());
    write(folder, "quad.gltf", gltf.to_string())
}

#[test]
fn lightmaps_take_the_second_set_of_texture_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let one = Geometry::new(&load(&write_quad(folder.path(), &quad_gltf())).unwrap());
    assert_eq!(one.lightmap_uvs, one.uvs);
    let mut gltf = quad_gltf();
    gltf["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(1);
    let scene = load(&write_quad(folder.path(), &gltf)).unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
    let two = Geometry::new(&scene);
    // As the file has them; the texture transform moves those of the pictures only.
    assert_eq!(two.lightmap_uvs[0], [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0)]);
    assert_eq!(two.uvs, one.uvs);
    assert_ne!(two.uvs, two.lightmap_uvs);
}

#[test]
fn gltf_gives_objects_materials_lamps_and_camera() {
    let folder = tempfile::tempdir().unwrap();
    let scene = load(&write_quad(folder.path(), &quad_gltf())).unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
    assert_eq!(scene.name, "quad");
    let names: Vec<_> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["plain", "mirrored"]);
    assert!(scene.objects[0].movable && !scene.objects[1].movable);

    // Hierarchy: 2·(1, 1, 0) + (10, 0, 0), and mirrored 2·(−1, 1, 0) + (10, 0, 0).
    let geometry = Geometry::new(&scene);
    let (low, high) = geometry.bounds();
    assert_eq!((low, high), (Vec3::new(8.0, 0.0, 0.0), Vec3::new(12.0, 2.0, 0.0)));
    // Both fronts face +z: the mirrored one had its winding turned.
    for t in 0..geometry.len() as u32 {
        assert_eq!(geometry.area_normal(t).normalize(), Vec3::Z);
        assert!(geometry.normals[t as usize].iter().all(|n| n.distance(Vec3::Z) < 1e-6));
    }

    let material = &scene.materials[0];
    assert!(material.double_sided);
    assert_eq!(material.emission, Vec3::new(200.0, 100.0, 0.0));
    assert_eq!((material.roughness, material.metallic), (0.5, 0.0));
    // Texture transform: u moves by half a picture of two pixels, so the left pixel is the grey one.
    let left = geometry.uvs[0][0] + Vec2::new(0.25, 0.0);
    let grey = linear_from_srgb(128.0 / 255.0);
    let reflectance = material.reflectance_at(left, &scene.textures);
    assert!(reflectance.distance(Vec3::new(0.5, 0.25, 0.75) * grey) < 1e-6, "{reflectance}");

    assert_eq!(scene.lamps.len(), 3);
    let [bulb, spot, sun] = [&scene.lamps[0], &scene.lamps[1], &scene.lamps[2]];
    assert_eq!(bulb.kind, LampKind::Point { intensity: Vec3::new(40.0, 20.0, 10.0) });
    assert_eq!(bulb.position(), Vec3::new(0.0, 3.0, 0.0));
    let angles = LampKind::Spot { intensity: Vec3::splat(100.0), inner_angle: 0.2, outer_angle: 0.5 };
    assert_eq!(spot.kind, angles);
    assert!(spot.axis().distance(Vec3::NEG_Y) < 1e-6, "{}", spot.axis());
    assert_eq!(sun.kind, LampKind::Directional { illuminance: Vec3::splat(1000.0) });
    assert!(sun.axis().distance(Vec3::NEG_Z) < 1e-6);
    assert_eq!((scene.camera.eye, scene.camera.vertical_fov), (Vec3::new(0.0, 1.0, 5.0), 0.8));
    assert_eq!(scene.camera.target - scene.camera.eye, Vec3::NEG_Z);
}

#[test]
fn instances_share_their_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let mut gltf = quad_gltf();
    gltf["nodes"][2]["scale"] = json!([1, 1, 1]);
    let scene = load(&write_quad(folder.path(), &gltf)).unwrap();
    assert_eq!(scene.objects[0].parts, scene.objects[1].parts);
    assert_eq!((scene.meshes.len(), scene.triangle_count()), (1, 4));
}

#[test]
fn glb_and_data_uris_hold_the_same_scene() {
    let folder = tempfile::tempdir().unwrap();
    let wanted = load(&write_quad(folder.path(), &quad_gltf())).unwrap();
    let mut binary = quad_bytes();
    let picture = png(&[[255, 255, 255], [128, 128, 128]]);
    let mut gltf = quad_gltf();
    gltf["images"] = json!([{"bufferView": 3, "mimeType": "image/png"}]);
    gltf["bufferViews"]
        .as_array_mut()
        .unwrap()
        .push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": picture.len()}));
    binary.extend(&picture);
    binary.resize(binary.len().next_multiple_of(4), 0);
    gltf["buffers"] = json!([{"byteLength": binary.len()}]);
    let scene = load(&write(folder.path(), "quad.GLB", glb(&gltf, &binary))).unwrap();
    assert_eq!((&scene.meshes, &scene.materials), (&wanted.meshes, &wanted.materials));
    assert_eq!(scene.textures, wanted.textures);
    // "AAAA…" is the base64 of zeros: a buffer in the JSON whose triangles have no area.
    gltf["buffers"] = json!([{"byteLength": 300, "uri": format!("data:application/octet-stream;base64,{}", "AAAA".repeat(100))}]);
    let error = load(&write(folder.path(), "zeros.gltf", gltf.to_string())).unwrap_err();
    assert!(matches!(error, SceneError::Empty { .. }), "{error}");
}

#[test]
fn glass_is_a_pane_or_with_a_volume_the_boundary_of_a_solid() {
    let folder = tempfile::tempdir().unwrap();
    let mut gltf = quad_gltf();
    let used = ["KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_ior"];
    gltf["extensionsUsed"].as_array_mut().unwrap().extend(used.map(|name| json!(name)));
    let transmission = json!({"transmissionFactor": 0.5});
    let volume = json!({"thicknessFactor": 0.01});
    let pbr = |roughness: f32| json!({"metallicFactor": 0.0, "roughnessFactor": roughness});
    let pane = json!({"name": "pane", "pbrMetallicRoughness": pbr(0.0),
        "extensions": {"KHR_materials_transmission": transmission, "KHR_materials_ior": {"ior": 1.33}}});
    let solid = json!({"name": "frosted", "pbrMetallicRoughness": pbr(0.4),
        "extensions": {"KHR_materials_transmission": transmission, "KHR_materials_volume": volume}});
    gltf["materials"].as_array_mut().unwrap().extend([pane, solid]);
    let scene = load(&write_quad(folder.path(), &gltf)).unwrap();
    let of = |name: &str| scene.materials.iter().find(|m| m.name == name).unwrap();
    let (pane, solid) = (of("pane"), of("frosted"));
    assert_eq!((pane.transmission, pane.ior, pane.solid, pane.double_sided), (0.5, 1.33, false, true));
    assert_eq!((solid.transmission, solid.ior, solid.solid, solid.double_sided), (0.5, 1.5, true, true));
    assert!(scene.warnings.iter().any(|w| w.contains("rough glass is shown clear: frosted")));
    assert!(!scene.warnings.iter().any(|w| w.contains("not read")), "{:?}", scene.warnings);
}

#[test]
fn what_is_unsupported_gives_one_warning_a_kind() {
    let folder = tempfile::tempdir().unwrap();
    let mut gltf = quad_gltf();
    gltf["extensionsUsed"]
        .as_array_mut()
        .unwrap()
        .extend([json!("KHR_materials_unlit"), json!("EXT_made_up")]);
    gltf["animations"] = json!([{"name": "spin", "channels": [], "samplers": []}]);
    let material = json!({"name": "chrome", "alphaMode": "BLEND", "extensions": {"KHR_materials_unlit": {}}});
    let mut twin = material.clone();
    twin["name"] = json!("brass");
    gltf["materials"].as_array_mut().unwrap().extend([material, twin]);
    let points = json!({"attributes": {"POSITION": 0}, "mode": 0});
    gltf["meshes"][0]["primitives"].as_array_mut().unwrap().extend([points.clone(), points]);
    let scene = load(&write_quad(folder.path(), &gltf)).unwrap();
    for (words, count) in [
        ("extensions not read: EXT_made_up", 1),
        ("animations", 1),
        ("unlit materials are lit: chrome and 1 more", 1),
        ("transparency is shown opaque: chrome and 1 more", 1),
        ("metal is shown as diffuse reflection: chrome and 1 more", 1),
        ("points and lines", 1),
    ] {
        let found = scene.warnings.iter().filter(|w| w.contains(words)).count();
        assert_eq!(found, count, "{words}: {:#?}", scene.warnings);
    }
    assert!(scene.warnings.iter().all(|w| !w.contains('\n')));
}

#[test]
fn obj_gives_parts_by_material_and_emission_in_nits() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cube.mtl", CUBE_MTL);
    let path = write(folder.path(), "cube.OBJ", CUBE_OBJ);
    let mut scene = load(&path).unwrap();
    assert_eq!((scene.objects.len(), scene.objects[0].parts.len(), scene.triangle_count()), (1, 2, 12));
    assert_eq!(scene.objects[0].name, "cube");
    let materials: Vec<_> = scene.objects[0].parts.iter().map(|p| &scene.materials[p.material]).collect();
    assert_eq!(materials[0].reflectance, Vec3::new(0.6, 0.1, 0.1));
    assert_eq!(materials[1].emission, Vec3::new(100.0, 200.0, 300.0));
    assert!(materials.iter().all(|m| !m.double_sided), "no light reaches the inside of a closed cube");
    assert!(scene.lamps.is_empty(), "an emissive surface lights the scene");
    assert_eq!(scene.warnings, Vec::<String>::new());
    assert!(!scene.objects[0].movable);

    let (before, emissive) = (scene.materials.len(), scene.emits(Target::Object(0)));
    assert_eq!(add_model(&mut scene, &path).unwrap(), 1..2);
    assert!(scene.objects[1].movable && emissive && scene.emits(Target::Object(1)));
    assert!(scene.objects[1].parts.iter().all(|p| p.material >= before));
}

#[test]
fn closed_shells_are_lit_on_the_side_that_light_can_reach() {
    let folder = tempfile::tempdir().unwrap();
    let cuboid = |first: usize, low: f32, high: f32, inward: bool| {
        let corner = |i: usize| [0, 1, 2].map(|a| if i >> a & 1 == 1 { high } else { low });
        let vertices = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = faces.map(|mut face: [usize; 4]| {
            if inward {
                face.reverse();
            }
            let [a, b, c, d] = face.map(|i| i + first);
            format!("f {a} {b} {c} {d}\n")
        });
        vertices.chain(faces).collect::<String>()
    };
    let double_sided = |walls_inward: bool| {
        let text =
            format!("o walls\n{}o block\n{}", cuboid(1, 0.0, 3.0, walls_inward), cuboid(9, 1.0, 1.5, false));
        let scene = load(&write(folder.path(), "room.obj", text)).unwrap();
        [0, 1].map(|o| scene.materials[scene.objects[o].parts[0].material].double_sided)
    };
    assert_eq!(double_sided(true), [false, false], "a room and a solid");
    assert_eq!(
        double_sided(false),
        [true, false],
        "walls that face outwards are seen from inside all the same"
    );
}

#[test]
fn obj_texture_coordinates_point_down() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "t.png", png(&[[255, 0, 0], [0, 0, 0]]));
    write(folder.path(), "t.mtl", "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd t.png\n");
    let text =
        "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvt 1 0.25\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
    let scene = load(&write(folder.path(), "t.obj", text)).unwrap();
    assert!(scene.materials[0].double_sided, "both sides of an open surface are seen");
    let mesh = &scene.meshes[0];
    let corner = mesh.positions.iter().position(|p| *p == Vec3::ZERO).unwrap();
    assert_eq!(mesh.uvs[corner], Vec2::new(0.0, 0.75));
    let middle_of_red = scene.materials[0].reflectance_at(Vec2::new(0.25, 0.5), &scene.textures);
    assert_eq!(middle_of_red, Vec3::new(0.5, 0.0, 0.0));
}

#[test]
fn a_model_without_emitter_gets_a_lamp_of_500_lux() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cube.mtl", "newmtl red\nKd 0.6 0.1 0.1\nnewmtl lamp\nKd 0.5 0.5 0.5\n");
    let scene = load(&write(folder.path(), "cube.obj", CUBE_OBJ)).unwrap();
    assert_eq!(scene.warnings, ["no lamps: nothing is lit; a lamp was placed above"]);
    let lamp = &scene.lamps[0];
    let centre = Vec3::splat(0.5);
    assert!(lamp.position().y > 1.0);
    let distance2 = lamp.position().distance_squared(centre);
    let illuminance = lamp.intensity_towards(Vec3::NEG_Y).x / distance2;
    // A quotient of two rounded products.
    assert!((illuminance - ADDED_ILLUMINANCE).abs() < 1e-5 * ADDED_ILLUMINANCE, "{illuminance}");
    // The first camera sees all corners of the box.
    let clip = scene.camera.clip_from_view(1.0, 0.01, 100.0) * scene.camera.view_from_world();
    for corner in 0..8 {
        let p = Vec3::new((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32);
        let ndc = clip.project_point3(p);
        assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0 && (0.0..1.0).contains(&ndc.z), "{ndc}");
    }
}

const RON: &str = r#"(
    models: [
        (file: "cube.obj", name: "crate", translate: (2.0, 0.0, 0.0), rotate_y_deg: 90.0, scale: 0.5),
        (file: "cube.obj", movable: true),
    ],
    lamps: [
        Point(name: "bulb", at: (0.0, 2.0, 0.0), intensity: (10.0, 20.0, 30.0)),
        Spot(name: "spot", at: (0.0, 2.0, 0.0), towards: (0.0, 0.0, 0.0), intensity: (1.0, 1.0, 1.0),
            inner_deg: 20.0, outer_deg: 30.0),
        Directional(name: "sun", direction: (0.0, -2.0, 0.0), illuminance: (5.0, 5.0, 5.0)),
    ],
    area_lamps: [(name: "panel", corner: (0.0, 3.0, 0.0), edge_u: (2.0, 0.0, 0.0), edge_v: (0.0, 0.0, 1.0),
        radiance: (100.0, 100.0, 100.0), texture: "half.png")],
    movable: ["cra*", "nothing"],
    camera: (eye: (5.0, 5.0, 5.0), target: (0.0, 0.0, 0.0), up: (0.0, 1.0, 0.0), vertical_fov: 0.7),
    planes: [(name: "floor", corner: (0.0, 0.0, 0.0), edge_u: (0.0, 0.0, 1.0), edge_v: (1.0, 0.0, 0.0))],
    plan: (gather_rays: 64, volume: Some(false)),
)"#;

#[test]
fn ron_places_models_and_adds_what_they_lack() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cube.mtl", CUBE_MTL);
    write(folder.path(), "cube.obj", CUBE_OBJ);
    write(folder.path(), "half.png", png(&[[188, 188, 188]]));
    let scene = load(&write(folder.path(), "room.ron", RON)).unwrap();
    assert_eq!(scene.warnings, ["movable: no object is named \"nothing\""]);
    let names: Vec<_> = scene.objects.iter().map(|o| (o.name.as_str(), o.movable)).collect();
    assert_eq!(names, [("crate", true), ("cube", true), ("panel", true)]);

    // A quarter turn about y takes +x to −z: [0, ½]³ becomes x ∈ [2, 2.5], z ∈ [−½, 0].
    let geometry = Geometry::new(&scene);
    let corners = geometry.object_triangles[0].clone().flat_map(|t| geometry.positions[t as usize]);
    let (low, high) = corners.fold((Vec3::MAX, Vec3::MIN), |(l, h), p| (l.min(p), h.max(p)));
    assert!(low.distance(Vec3::new(2.0, 0.0, -0.5)) < 1e-6 && high.distance(Vec3::new(2.5, 0.5, 0.0)) < 1e-6);

    // The panel: 2 m², facing down, centred on its placement, with a texture of about ½.
    let range = geometry.object_triangles[2].clone();
    let area: f32 = range.clone().map(|t| 0.5 * geometry.area_normal(t).length()).sum();
    assert!((area - 2.0).abs() < 1e-5);
    assert!(range.clone().all(|t| geometry.area_normal(t).normalize() == Vec3::NEG_Y));
    assert_eq!(Vec3::from(scene.objects[2].world_from_object.translation), Vec3::new(1.0, 3.0, 0.5));
    let material = geometry.material_of(range.start);
    let radiance = material.emission_at(Vec2::splat(0.5), &scene.textures);
    assert!((radiance.x - 100.0 * linear_from_srgb(188.0 / 255.0)).abs() < 1e-4);
    assert_eq!(material.reflectance, Vec3::ZERO);

    assert_eq!(scene.lamps.iter().map(|l| l.name.as_str()).collect::<Vec<_>>(), ["bulb", "spot", "sun"]);
    assert!(scene.lamps[1].axis().distance(Vec3::NEG_Y) < 1e-6);
    assert_eq!(scene.camera.eye, Vec3::splat(5.0));
    assert_eq!((scene.planes.len(), scene.plan.gather_rays, scene.plan.volume), (1, Some(64), Some(false)));
}

#[test]
fn the_example_in_the_readme_is_a_scene() {
    let readme = include_str!("../scenes/README.md");
    let example = readme.split("```ron").nth(1).unwrap().split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "chair.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write(folder.path(), "room.glb", glb(&quad_gltf(), &[0; 4]));
    write_quad(folder.path(), &quad_gltf());
    write(folder.path(), "panel.png", png(&[[255; 3]]));
    let scene = load(&write(folder.path(), "example.ron", example)).unwrap();
    assert_eq!(scene.objects.last().unwrap().name, "panel");
    assert_eq!(scene.plan.volume_samples, Some([8, 4, 8]));
}

#[test]
fn shared_models_load() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/models");
    let models = if models.is_dir() {
        models
    } else {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/models")
    };
    let Ok(list) = std::fs::read_dir(&models) else {
        println!("skipped: {} is not here", models.display());
        return;
    };
    for path in list.flatten().map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "obj")) {
        let scene = load(&path).unwrap();
        let geometry = Geometry::new(&scene);
        assert!(geometry.len() > 500, "{}: {} triangles", path.display(), geometry.len());
        assert!(geometry.normals.iter().flatten().all(|n| (n.length() - 1.0).abs() < 1e-4));
        println!("{}: {} triangles, {:?}", path.display(), geometry.len(), scene.warnings);
        for finding in check(&scene) {
            println!("  {finding}");
        }
    }
}

fn quad_object(name: &str, corners: [Vec3; 4]) -> (Mesh, Object) {
    let object = Object {
        name: name.into(),
        parts: vec![Part { mesh: 0, material: 0 }],
        world_from_object: Affine3A::IDENTITY,
        movable: true,
        dimmer: 1.0,
    };
    (Mesh::quad(corners), object)
}

fn scene_of(list: Vec<(Mesh, Object)>) -> Scene {
    let mut scene =
        Scene { name: "planted".into(), materials: vec![Material::default()], ..Scene::default() };
    for (i, (mesh, mut object)) in list.into_iter().enumerate() {
        object.parts[0].mesh = i;
        scene.meshes.push(Arc::new(mesh));
        scene.objects.push(object);
    }
    scene.lamps.push(Lamp {
        name: "bulb".into(),
        kind: LampKind::Point { intensity: Vec3::ONE },
        world_from_lamp: Affine3A::from_translation(Vec3::new(0.0, 3.0, 0.0)),
        dimmer: 1.0,
    });
    scene.camera = Camera { eye: Vec3::new(0.0, 3.0, 4.0), target: Vec3::ZERO, ..Camera::default() };
    scene
}

/// A quad on the ground, a metre wide, facing up.
fn ground(name: &str, x: f32, y: f32) -> (Mesh, Object) {
    quad_object(name, [[0., 1.], [1., 1.], [1., 0.], [0., 0.]].map(|[u, v]| Vec3::new(x + u, y, v)))
}

/// A closed cube of edge 1 with its low corner at `low`; front outside or inside.
fn cube(name: &str, low: Vec3, outside: bool) -> (Mesh, Object) {
    let mut mesh = Mesh::default();
    let corner = |i: usize| low + Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        let mut corners = face.map(corner);
        if !outside {
            corners.reverse();
        }
        let quad = Mesh::quad(corners);
        let first = mesh.positions.len() as u32;
        mesh.triangles.extend(quad.triangles.iter().map(|t| t.map(|i| i + first)));
        mesh.positions.extend(quad.positions);
        mesh.normals.extend(quad.normals);
        mesh.uvs.extend(quad.uvs);
    }
    let mut object = quad_object(name, [Vec3::ZERO; 4]).1;
    object.name = name.into();
    (mesh, object)
}

fn warnings(scene: &Scene) -> Vec<String> {
    check(scene).iter().filter(|f| f.severity == Severity::Warning).map(|f| f.to_string()).collect()
}

fn assert_warns(scene: &Scene, object: &str, words: &str) {
    let found = warnings(scene);
    let hits = found.iter().filter(|w| w.starts_with(&format!("warning: {object}: ")) && w.contains(words));
    assert_eq!(hits.count(), 1, "\"{words}\" about \"{object}\" in {found:#?}");
    assert!(found.iter().all(|w| !w.contains('\n')));
}

#[test]
fn a_sound_scene_has_no_warnings() {
    let scene = scene_of(vec![ground("floor", 0.0, 0.0), cube("box", Vec3::new(0.2, 0.5, 0.2), true)]);
    assert_eq!(warnings(&scene), Vec::<String>::new());
    // A room: closed, front inside, with the camera, the lamp and a box in it.
    let (mut room, object) = cube("room", Vec3::ZERO, false);
    room.positions.iter_mut().for_each(|p| *p = *p * 10.0 - Vec3::splat(5.0));
    let scene = scene_of(vec![(room, object), cube("box", Vec3::new(0.2, 0.5, 0.2), true)]);
    assert_eq!(warnings(&scene), Vec::<String>::new());
}

#[test]
fn checks_find_flipped_and_open_shells() {
    let at = Vec3::new(0.2, 0.5, 0.2);
    assert_warns(&scene_of(vec![cube("box", at, false)]), "box", "its front inside");
    assert_warns(&scene_of(vec![cube("box", at, false)]), "box", "black back");

    let (mut one_flipped, object) = cube("box", at, true);
    one_flipped.triangles[3].swap(1, 2);
    let scene = scene_of(vec![(one_flipped, object)]);
    assert_warns(&scene, "box", "3 edges join triangles wound opposite ways");
    assert_warns(&scene, "box", "1 triangles have shading normals that point to their back");

    let (mut open, object) = cube("box", at, true);
    open.triangles.pop();
    let findings = check(&scene_of(vec![(open, object)]));
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!((findings[0].severity, findings[0].object.as_str()), (Severity::Note, "box"));
    assert_eq!(findings[0].what, "3 open edges");

    let (mut floor, object) = ground("floor", 0.0, 0.0);
    floor.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    floor.normals.iter_mut().for_each(|n| *n = -*n);
    assert_warns(&scene_of(vec![(floor, object)]), "floor", "100 % of what the camera and the lamps see");

    let (mut room, object) = cube("room", Vec3::ZERO, true);
    room.positions.iter_mut().for_each(|p| *p = *p * 10.0 - Vec3::splat(5.0));
    assert_warns(&scene_of(vec![(room, object)]), "room", "around the camera with its front outside");
}

#[test]
fn checks_find_coincident_faces() {
    // Overlapping by half, at the same height; neighbours that only touch do not count.
    let scene = scene_of(vec![ground("a", 0.0, 0.0), ground("b", 0.5, 0.0), ground("c", 1.5, 0.0)]);
    let found = warnings(&scene);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_warns(&scene, "a", "coincide with those of \"b\"");
    let apart = scene_of(vec![ground("a", 0.0, 0.0), ground("b", 0.5, 0.01)]);
    assert_eq!(warnings(&apart), Vec::<String>::new());
}

#[test]
fn checks_find_materials_emitters_and_units() {
    let plain = || scene_of(vec![ground("floor", 0.0, 0.0)]);
    let mut white = plain();
    white.materials[0].reflectance = Vec3::splat(0.95);
    assert_warns(&white, "floor", "reflects 0.950");
    white.materials[0].reflectance = Vec3::new(1.2, 0.0, 0.0);
    assert_warns(&white, "floor", "will not settle");

    let mut dark = plain();
    dark.lamps[0].kind = LampKind::Point { intensity: Vec3::ZERO };
    assert_warns(&dark, "bulb", "lamp of no light");
    dark.lamps.clear();
    assert_warns(&dark, "planted", "nothing emits light");
    dark.materials[0].emission = Vec3::ONE;
    assert_eq!(warnings(&dark), Vec::<String>::new());
    dark.textures.push(Arc::new(LinearImage::new(2, 2)));
    dark.materials[0].emission_texture = Some(0);
    assert_warns(&dark, "floor", "emission texture is black");

    for scale in [1e-3, 1e4] {
        let mut scene = plain();
        scene.objects[0].world_from_object = Affine3A::from_scale(Vec3::splat(scale));
        assert_warns(&scene, "planted", "check the unit");
    }
    assert_warns(&Scene { name: "nothing".into(), ..Scene::default() }, "nothing", "no triangles");
}

#[test]
fn geometry_follows_placements() {
    let mut scene = scene_of(vec![ground("a", 0.0, 0.0), cube("box", Vec3::ZERO, true)]);
    let mut world = World::new(&scene);
    let turn = Affine3A::from_scale_rotation_translation(
        Vec3::new(1.0, 2.0, 0.5),
        Quat::from_rotation_z(0.7),
        Vec3::new(3.0, -1.0, 2.0),
    );
    scene.place(Target::Object(1), turn);
    assert_eq!(world.follow(&scene), [Target::Object(1)]);
    let fresh = Geometry::new(&scene);
    for t in 0..fresh.len() {
        for corner in 0..3 {
            // Coordinates up to 5 m, moved by a product of matrices: a few units of rounding of 5.
            let difference = world.geometry.positions[t][corner] - fresh.positions[t][corner];
            assert!(difference.abs().max_element() < 5.0 * 8.0 * f32::EPSILON, "{difference}");
            let normal = world.geometry.normals[t][corner];
            assert!(normal.distance(fresh.normals[t][corner]) < 1e-5);
            // The normal stays perpendicular to its face under the uneven scale.
            let face = fresh.area_normal(t as u32).normalize();
            assert!(normal.distance(face) < 1e-5, "{normal} {face}");
        }
    }
}
