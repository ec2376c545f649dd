//! Import of OBJ, and of what no format says.

use super::{files::*, *};

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
