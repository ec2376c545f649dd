//! Radiosity against closed forms, invariants and the reference.

use glam::{Affine3A, Vec3};
use lumenscope_core::{
    math::progress::Progress,
    radiosity::{RadiositySettings, RadiositySolution, surface_map::UNSOLVED},
    scene::{Object, Part as ObjectPart, Scene, material::Material, mesh::Mesh, world::World},
};
use std::{f32::consts::PI, sync::Arc};

/// A scene of one object a mesh, each with its own material.
fn scene(parts: Vec<(Mesh, Material)>) -> Scene {
    let mut scene = Scene::default();
    for (i, (mesh, material)) in parts.into_iter().enumerate() {
        scene.meshes.push(Arc::new(mesh));
        scene.materials.push(material);
        scene.objects.push(Object {
            name: format!("object {i}"),
            parts: vec![ObjectPart { mesh: i, material: i }],
            world_from_object: Affine3A::IDENTITY,
            movable: false,
            dimmer: 1.0,
        });
    }
    scene
}

fn grey(reflectance: f32) -> Material {
    Material { reflectance: Vec3::splat(reflectance), ..Material::default() }
}

/// Six faces of a box, seen from inside.
fn faces_inwards(low: Vec3, high: Vec3) -> Vec<Mesh> {
    let p = |x: u8, y: u8, z: u8| Vec3::select(glam::BVec3::new(x == 1, y == 1, z == 1), high, low);
    vec![
        Mesh::quad([p(0, 0, 0), p(0, 0, 1), p(1, 0, 1), p(1, 0, 0)]),
        Mesh::quad([p(0, 1, 0), p(1, 1, 0), p(1, 1, 1), p(0, 1, 1)]),
        Mesh::quad([p(0, 0, 0), p(0, 1, 0), p(0, 1, 1), p(0, 0, 1)]),
        Mesh::quad([p(1, 0, 0), p(1, 0, 1), p(1, 1, 1), p(1, 1, 0)]),
        Mesh::quad([p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)]),
        Mesh::quad([p(0, 0, 1), p(0, 1, 1), p(1, 1, 1), p(1, 0, 1)]),
    ]
}

fn solve(scene: &Scene, settings: &RadiositySettings) -> (World, RadiositySolution) {
    let world = World::new(scene);
    let solution = RadiositySolution::solve(&world, settings, &Progress::silent()).expect("solves");
    assert!(
        solution.direct.iter().chain(&solution.indirect).all(|e| e.is_finite() && e.min_element() >= 0.0)
    );
    (world, solution)
}

/// Every element that lights something.
fn solved(solution: &RadiositySolution) -> impl Iterator<Item = usize> + '_ {
    (0..solution.elements().len()).filter(|&i| solution.elements()[i].flags & UNSOLVED == 0)
}

#[test]
fn faces_of_the_test_box_look_inwards() {
    for mesh in faces_inwards(Vec3::ZERO, Vec3::ONE) {
        let [a, ..] = mesh.corners(0);
        assert!(mesh.normals[0].dot(Vec3::splat(0.5) - a) > 0.0);
    }
}

#[test]
fn furnace_boxes_reach_e_over_one_minus_rho() {
    // Every wall emits L, so each point receives πL directly and πL / (1 − ρ) in all. 1 %: sweeps
    // stop at an error bound of 0.1 %; direct light is a closed form for polygons; rays never escape.
    for rho in [0.5, 0.9, 0.99, 0.999] {
        let material = Material { emission: Vec3::new(1.0, 2.0, 0.5), ..grey(rho) };
        let mut mesh = Mesh::default();
        for face in faces_inwards(Vec3::ZERO, Vec3::new(1.0, 2.0, 1.5)) {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(&face.positions);
            mesh.normals.extend(&face.normals);
            mesh.uvs.extend(&face.uvs);
            mesh.triangles.extend(face.triangles.iter().map(|t| t.map(|i| i + first)));
        }
        let scene = scene(vec![(mesh, material)]);
        let settings = RadiositySettings { element_spacing_m: Some(0.25), ..RadiositySettings::default() };
        let (_, solution) = solve(&scene, &settings);
        println!("{rho}: {:?} {:?}", solution.convergence(), solution.energy());
        let expected = Vec3::new(1.0, 2.0, 0.5) * (PI / (1.0 - rho));
        for i in solved(&solution) {
            let e = solution.direct[i] + solution.indirect[i];
            assert!(((e - expected) / expected).abs().max_element() < 0.01, "ρ {rho}: {e} for {expected}");
        }
    }
}
