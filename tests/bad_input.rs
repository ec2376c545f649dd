//! Tests of bad input: whatever the bytes, a scene or an error of one line that names the file.

use lumenscope_core::{
    math::random::Rng,
    scene::{
        Scene,
        check::check,
        geometry::Geometry,
        import::{LARGEST_REFLECTANCE, SceneError, add_model, load},
        world::World,
    },
};
use lumenscope_tests::glb;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const OBJ: &str = "mtllib t.mtl\no first\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n\
    usemtl m\nf 1/1/1 2/2/1 3/3/1 4/1/1\ng second\nf -4 -3 -2\n";
const MTL: &str = "newmtl m\nKd 0.5 0.5 0.5\nKe 10 10 10\nmap_Kd t.png\nd 1.0\nillum 2\n";
const RON: &str = r#"(models: [(file: "t.obj", translate: (1.0, 0.0, 0.0), scale: 2.0)],
    lamps: [Point(name: "bulb", at: (0.0, 2.0, 0.0), intensity: (1.0, 1.0, 1.0)),
        Spot(name: "spot", at: (0.0, 2.0, 0.0), towards: (0.0, 0.0, 0.0), intensity: (1.0, 1.0, 1.0),
            inner_deg: 20.0, outer_deg: 30.0)],
    area_lamps: [(name: "panel", corner: (0.0, 3.0, 0.0), edge_u: (2.0, 0.0, 0.0), edge_v: (0.0, 0.0, 1.0),
        radiance: (100.0, 100.0, 100.0), texture: "t.png")],
    movable: ["first"],
    planes: [(name: "p", corner: (0.0, 0.0, 0.0), edge_u: (0.0, 0.0, 1.0), edge_v: (1.0, 0.0, 0.0))],
    plan: (element_spacing_m: 0.1))"#;

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

fn png() -> Vec<u8> {
    let picture = image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([x as u8 * 20, y as u8 * 30, 99]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// One textured quad in one buffer with its picture, and every accessor kind that is read.
fn gltf() -> (Value, Vec<u8>) {
    let floats: [f32; 32] = [
        0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1., 0., 0., 1., 0., 0., 1., 0.,
        1., 1., 1., 1., 0., 0., 0.,
    ];
    let mut bytes: Vec<u8> = floats.iter().flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    let picture = png();
    let at = bytes.len();
    bytes.extend(&picture);
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "spot", "intensity": 9, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.4}}]}},
        "nodes": [{"mesh": 0, "children": [2]}, {"camera": 0},
            {"translation": [0, 2, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3,
            "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
        "textures": [{"source": 0}], "images": [{"bufferView": 4, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 48},
            {"buffer": 0, "byteOffset": 96, "byteLength": 32}, {"buffer": 0, "byteOffset": 128, "byteLength": 12},
            {"buffer": 0, "byteOffset": at, "byteLength": picture.len()}],
        "buffers": [{"byteLength": bytes.len()}]
    });
    (json, bytes)
}

/// Every file of one small scene of each format.
fn write_all(folder: &Path) {
    write(folder, "t.obj", OBJ);
    write(folder, "t.mtl", MTL);
    write(folder, "t.png", png());
    write(folder, "t.ron", RON);
    let (mut json, binary) = gltf();
    write(folder, "t.glb", glb(&json, &binary));
    json["buffers"][0]["uri"] = json!("t.bin");
    write(folder, "t.bin", binary);
    write(folder, "t.gltf", json.to_string());
}

/// A scene is sound, or the error is one line that names one of the files.
fn judge(folder: &Path, result: &Result<Scene, SceneError>) {
    match result {
        Err(error) => {
            let text = error.to_string();
            assert!(!text.contains('\n') && text.contains(&folder.display().to_string()), "{text}");
            assert!(text.len() > folder.display().to_string().len() + 10, "{text}");
        }
        Ok(scene) => {
            let geometry = Geometry::new(scene);
            assert!(!geometry.is_empty());
            assert!(geometry.positions.iter().flatten().all(|p| p.is_finite()), "positions");
            assert!(geometry.normals.iter().flatten().all(|n| (n.length() - 1.0).abs() < 1e-3), "normals");
            assert!(geometry.uvs.iter().flatten().all(|uv| uv.is_finite()), "texture coordinates");
            assert!(scene.textures.iter().flat_map(|t| &t.pixels).all(|p| p.is_finite()), "textures");
            assert!(scene.warnings.iter().all(|w| !w.contains('\n')), "{:?}", scene.warnings);
            for material in &scene.materials {
                assert!(material.reflectance.is_finite() && material.emission.is_finite());
                assert!(material.reflectance.min_element() >= 0.0 && material.emission.min_element() >= 0.0);
            }
        }
    }
}

/// Loads `open` with `spoilt` replaced by what `spoil` makes of its bytes, `count` times.
fn spoil_many(open: &str, spoilt: &str, count: u64, spoil: impl Fn(Vec<u8>, u64) -> Vec<u8> + Sync) {
    let (oks, errors) = (0..count)
        .into_par_iter()
        .map(|i| {
            let folder = tempfile::tempdir().unwrap();
            write_all(folder.path());
            let path = folder.path().join(spoilt);
            let bytes = spoil(std::fs::read(&path).unwrap(), i);
            std::fs::write(&path, bytes).unwrap();
            let result = load(&folder.path().join(open));
            judge(folder.path(), &result);
            if i % 16 == 0
                && let Ok(scene) = &result
            {
                World::new(scene);
                check(scene);
            }
            if result.is_ok() { (1, 0) } else { (0, 1) }
        })
        .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    println!("{open} with {spoilt} spoilt: {oks} scenes, {errors} errors");
}

const PAIRS: [(&str, &str); 10] = [
    ("t.obj", "t.obj"),
    ("t.obj", "t.mtl"),
    ("t.obj", "t.png"),
    ("t.ron", "t.ron"),
    ("t.ron", "t.obj"),
    ("t.ron", "t.png"),
    ("t.glb", "t.glb"),
    ("t.gltf", "t.gltf"),
    ("t.gltf", "t.bin"),
    ("t.gltf", "t.obj"),
];

#[test]
fn whole_files_load() {
    let folder = tempfile::tempdir().unwrap();
    write_all(folder.path());
    for name in ["t.obj", "t.ron", "t.glb", "t.gltf"] {
        let result = load(&folder.path().join(name));
        judge(folder.path(), &result);
        assert!(result.is_ok(), "{name}: {result:?}");
    }
}

#[test]
fn truncated_files_never_panic() {
    for (open, spoilt) in PAIRS {
        spoil_many(open, spoilt, 150, |mut bytes, i| {
            bytes.truncate(bytes.len() * i as usize / 150);
            bytes
        });
    }
    // Cut short, a GLB or glTF is never a scene.
    let folder = tempfile::tempdir().unwrap();
    let (json, binary) = gltf();
    let whole = glb(&json, &binary);
    for length in (0..whole.len()).step_by(7) {
        assert!(load(&write(folder.path(), "cut.glb", &whole[..length])).is_err(), "{length} bytes");
    }
}

#[test]
fn flipped_bytes_never_panic() {
    for (open, spoilt) in PAIRS {
        spoil_many(open, spoilt, 250, |mut bytes, i| {
            let mut rng = Rng::new(17, i);
            for _ in 0..1 + rng.next_u32() % 4 {
                let at = rng.next_u32() as usize % bytes.len();
                bytes[at] = match rng.next_u32() % 3 {
                    0 => bytes[at] ^ (1 << (rng.next_u32() % 8)),
                    1 => rng.next_u32() as u8,
                    // A digit keeps text parsable, so that the fault reaches further in.
                    _ => b'0' + (rng.next_u32() % 10) as u8,
                };
            }
            bytes
        });
    }
}

#[test]
fn wrong_numbers_in_gltf_never_panic() {
    let numbers = [
        json!(-1),
        json!(0),
        json!(1),
        json!(3),
        json!(99),
        json!(4_294_967_295u64),
        json!(1e30),
        json!(null),
    ];
    let whole = gltf();
    let mut pointers = Vec::new();
    collect_numbers(&whole.0, String::new(), &mut pointers);
    assert!(pointers.len() > 40);
    for pointer in pointers {
        for number in &numbers {
            let mut spoilt = whole.clone();
            *spoilt.0.pointer_mut(&pointer).unwrap() = number.clone();
            let folder = tempfile::tempdir().unwrap();
            judge(folder.path(), &load(&write(folder.path(), "t.glb", glb(&spoilt.0, &spoilt.1))));
        }
    }
}

fn collect_numbers(value: &Value, at: String, out: &mut Vec<String>) {
    match value {
        Value::Number(_) => out.push(at),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, v)| collect_numbers(v, format!("{at}/{i}"), out))
        }
        Value::Object(map) => map.iter().for_each(|(k, v)| collect_numbers(v, format!("{at}/{k}"), out)),
        _ => {}
    }
}

#[test]
fn missing_keys_in_gltf_never_panic() {
    let whole = gltf();
    let mut paths = Vec::new();
    collect_keys(&whole.0, String::new(), &mut paths);
    for (parent, key) in paths {
        let mut spoilt = whole.clone();
        spoilt.0.pointer_mut(&parent).unwrap().as_object_mut().unwrap().remove(&key);
        let folder = tempfile::tempdir().unwrap();
        judge(folder.path(), &load(&write(folder.path(), "t.glb", glb(&spoilt.0, &spoilt.1))));
    }
}

fn collect_keys(value: &Value, at: String, out: &mut Vec<(String, String)>) {
    match value {
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, v)| collect_keys(v, format!("{at}/{i}"), out))
        }
        Value::Object(map) => map.iter().for_each(|(k, v)| {
            out.push((at.clone(), k.clone()));
            collect_keys(v, format!("{at}/{k}"), out);
        }),
        _ => {}
    }
}

fn error_of(name: &str, text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let result = load(&write(folder.path(), name, text));
    judge(folder.path(), &result);
    result.err().map_or_else(|| panic!("{text} loaded"), |e| e.to_string())
}

#[test]
fn errors_name_the_cause() {
    for (name, text, words) in [
        ("a.txt", "", "unknown kind of file"),
        ("a.obj", "", "contains no triangles"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "out of bounds"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "contains no triangles"),
        (
            "a.obj",
            "o wall\nv 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "object \"wall\" has a coordinate of NaN m",
        ),
        (
            "a.obj",
            "o wall\nv 0 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "object \"wall\" has a coordinate of inf m",
        ),
        (
            "a.obj",
            "o wall\nv 0 0 2e6\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "object \"wall\" has a coordinate of 2000000 m",
        ),
        ("a.gltf", "{}", "invalid glTF"),
        ("a.glb", "glTF", "invalid glTF"),
        ("a.ron", "(", "invalid RON"),
        ("a.ron", "(colour: 3)", "invalid RON"),
        ("a.ron", "()", "contains no triangles"),
        ("a.ron", "(models: [(file: \"none.obj\")])", "none.obj: cannot be read"),
        ("a.ron", "(models: [(file: \"a.ron\")])", "cannot be used as a model"),
        ("a.ron", "(models: [(file: \"t.obj\", scale: 0.0)])", "scale is 0.0"),
        ("a.ron", "(models: [(file: \"t.obj\", scale: 1e8)])", "coordinate of 100000000 m"),
        ("a.ron", "(models: [(file: \"t.obj\", translate: (NaN, 0.0, 0.0))])", "placement is"),
        (
            "a.ron",
            "(models: [(file: \"t.obj\")], lamps: [Point(name: \"b\", at: (0, 0, 0), intensity: (NaN, 0, 0))])",
            "lamp \"b\": intensity in cd is",
        ),
        (
            "a.ron",
            "(models: [(file: \"t.obj\")], lamps: [Point(name: \"b\", at: (inf, 0, 0), intensity: (1, 0, 0))])",
            "lamp \"b\": position in m is",
        ),
        (
            "a.ron",
            "(models: [(file: \"t.obj\")], lamps: [Spot(name: \"b\", at: (0, 0, 0), towards: (0, 1, 0), \
             intensity: (1, 1, 1), inner_deg: NaN, outer_deg: 30)])",
            "half angle in degrees",
        ),
        (
            "a.ron",
            "(models: [(file: \"t.obj\")], lamps: [Spot(name: \"b\", at: (0, 0, 0), towards: (0, 0, 0), \
             intensity: (1, 1, 1), inner_deg: 10, outer_deg: 30)])",
            "lamp \"b\": direction is",
        ),
        (
            "a.ron",
            "(area_lamps: [(name: \"p\", corner: (0, 0, 0), edge_u: (1, 0, 0), edge_v: (2, 0, 0), radiance: (1, 1, 1))])",
            "area lamp \"p\": area in m²",
        ),
        (
            "a.ron",
            "(models: [(file: \"t.obj\")], camera: (eye: (1, 1, 1), target: (1, 1, 1), up: (0, 1, 0), vertical_fov: 1))",
            "camera: target",
        ),
        ("a.ron", "(models: [(file: \"t.obj\")], plan: (gather_rays: 0))", "gather_rays is 0"),
    ] {
        let error = error_of(name, text);
        let named = [name, "none.obj", "t.obj"].iter().any(|file| error.contains(file));
        assert!(error.contains(words) && named, "{text}: {error}");
    }
    let nowhere = load(Path::new("/nowhere/at all.obj")).unwrap_err().to_string();
    assert!(nowhere.starts_with("/nowhere/at all.obj: cannot be read"), "{nowhere}");
}

#[test]
fn what_can_be_mended_is_mended_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\n";
    let warnings = |text: &str, mtl: &str| {
        write(folder.path(), "m.mtl", mtl);
        let path = write(folder.path(), "m.obj", text);
        let scene = load(&path);
        judge(folder.path(), &scene);
        scene.unwrap()
    };
    let has = |scene: &Scene, words: &str| {
        let count = scene.warnings.iter().filter(|w| w.contains(words)).count();
        assert_eq!(count, 1, "{words}: {:?}", scene.warnings);
    };
    // Missing library, material and picture.
    let scene = warnings(&format!("mtllib none.mtl\n{corners}usemtl m\nf 1 2 3\n"), "");
    has(&scene, "none.mtl");
    let scene = warnings(&format!("mtllib m.mtl\n{corners}usemtl other\nf 1 2 3\n"), "newmtl m\nKd 1 0 0\n");
    has(&scene, "without a known material are grey");
    let textured = format!("mtllib m.mtl\n{corners}usemtl m\nf 1 2 3\n");
    let scene = warnings(&textured, "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd none.png\n");
    has(&scene, "a texture is missing and shown white");
    assert_eq!(scene.materials[0].reflectance_texture, None);
    // Triangles of no area: counted once, the others stay.
    let scene = warnings(&format!("{corners}f 1 2 3\nf 1 1 2\nf 1 2 4\n"), "");
    has(&scene, "2 triangles of no area were dropped");
    assert_eq!(scene.triangle_count(), 1);
    // Reflectance out of range.
    let scene = warnings(&textured, "newmtl m\nKd 1.5 -0.5 0.999\nKe -1 0 0\n");
    has(&scene, "reflectance is lowered to 0.999: m");
    has(&scene, "negative reflectance or emission");
    assert_eq!(scene.materials[0].reflectance.to_array(), [LARGEST_REFLECTANCE, 0.0, 0.999]);
    // No lights.
    has(&scene, "no lamps: nothing is lit");
    write(folder.path(), "dark.ron", "(models: [(file: \"m.obj\")])");
    let scene = load(&folder.path().join("dark.ron")).unwrap();
    has(&scene, "no lamps: nothing is lit");
    assert!(scene.lamps.is_empty());
}

#[test]
fn adding_a_broken_model_leaves_the_scene_alone() {
    let folder = tempfile::tempdir().unwrap();
    write_all(folder.path());
    let mut scene = load(&folder.path().join("t.obj")).unwrap();
    let before = (scene.objects.len(), scene.meshes.len(), scene.materials.len(), scene.warnings.clone());
    let broken = write(folder.path(), "broken.obj", "v 0 0 0\nf 1 2 3\n");
    assert!(add_model(&mut scene, &broken).is_err());
    assert!(add_model(&mut scene, &folder.path().join("t.ron")).is_err());
    let after = (scene.objects.len(), scene.meshes.len(), scene.materials.len(), scene.warnings.clone());
    assert_eq!(before, after);
}

#[test]
fn nodes_in_a_circle_are_an_error() {
    let mut spoilt = gltf();
    spoilt.0["nodes"][2]["children"] = json!([0]);
    let folder = tempfile::tempdir().unwrap();
    let error = load(&write(folder.path(), "t.glb", glb(&spoilt.0, &spoilt.1))).unwrap_err().to_string();
    assert!(error.contains("two parents"), "{error}");
}
