//! Import of glTF and GLB.

use super::{files::*, *};

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
