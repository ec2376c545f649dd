//! Tests of scene: import of every format, placed geometry, and the checks.

mod checks;
mod files;
mod gltf;
mod obj;
mod ron;

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
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

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
