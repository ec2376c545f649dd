//! Scenes that place models and add what they lack.

use super::{files::*, *};
use lumenscope_core::scene::brdf::LobeShape;

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
    phong: ["pan*", "none"],
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
    assert_eq!(
        scene.warnings,
        ["movable: no object is named \"nothing\"", "phong: no material is named \"none\""]
    );
    let of_phong = scene.materials.iter().filter(|m| m.lobe_shape == LobeShape::Phong);
    assert_eq!(of_phong.map(|m| m.name.as_str()).collect::<Vec<_>>(), ["panel"]);
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
    let readme = include_str!("../../scenes/README.md");
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
