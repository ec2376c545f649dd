//! Curved reflectors by maps of the light around them.

use glam::{Affine3A, Vec3};
use lumenscope_core::{
    glossy::{
        environment::{Environments, MOST_MAPS, MapOwner, left_out},
        inspect_maps::maps,
    },
    math::{frame::uniform_direction, random::Rng},
    reference::{path::PathTracer, radiance::radiance_with},
    scene::{Scene, accel::Ray, camera::Camera, geometry::Surface, material::Material, mesh::Mesh},
    superposition::{
        PassSettings,
        composite::DirectQuality,
        layers::Layer,
        plan::{Component, Plan},
        render,
    },
    transport::LightTransportSolution,
};
use lumenscope_tests::{add, box_room, cornell, merged, rectangle, solved};
use rayon::prelude::*;
use std::sync::Arc;

/// A ball of radius 1 around the origin.
fn ball() -> Mesh {
    let (rings, sides) = (24u32, 48u32);
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        for side in 0..=sides {
            let (sin, cos) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
            let (x, z) = (std::f32::consts::TAU * side as f32 / sides as f32).sin_cos();
            let p = Vec3::new(sin * x, cos, sin * z);
            mesh.positions.push(p);
            mesh.normals.push(p.normalize_or(Vec3::Y * cos.signum()));
            mesh.uvs.push(Default::default());
        }
    }
    for ring in 0..rings {
        for side in 0..sides {
            let a = ring * (sides + 1) + side;
            let below = a + sides + 1;
            mesh.triangles.extend([[a, below, a + 1], [a + 1, below, below + 1]]);
        }
    }
    mesh
}

pub fn with_ball(mut scene: Scene, at: Vec3, radius: f32, roughness: f32) -> Scene {
    let metal = Material { reflectance: Vec3::ONE, metallic: 1.0, roughness, ..Material::default() };
    let ball = add(&mut scene, "ball", ball(), metal);
    scene.objects[ball].world_from_object =
        Affine3A::from_translation(at) * Affine3A::from_scale(Vec3::splat(radius));
    scene
}

#[test]
fn constant_light_is_mirrored_as_it_is() {
    for (roughness, own_object) in [(0.0, true), (0.3, true), (0.0, false)] {
        let mut scene = with_ball(box_room(0.5, 10.0), Vec3::ZERO, 0.01, roughness);
        if !own_object {
            // As in a file that is one object: the ball skips itself, not the room that it belongs to.
            let mut ball = scene.objects.pop().unwrap().parts[0];
            let mut mesh = (*scene.meshes[ball.mesh]).clone();
            mesh.positions.iter_mut().for_each(|p| *p *= 0.01);
            scene.meshes.push(Arc::new(mesh));
            ball.mesh = scene.meshes.len() - 1;
            scene.objects[0].parts.push(ball);
        }
        let solution = solved(scene, 0.4);
        let [map] = &solution.environments.list[..] else { panic!("one curved reflector") };
        for i in 0..200 {
            let mut rng = Rng::new(2, i);
            let (n, d) = (uniform_direction(rng.next_vec2()), uniform_direction(rng.next_vec2()));
            let l = map.radiance(0.01 * n, d).x;
            // 10 / (1 − ½), up to the noise of radiosity.
            assert!((l / 20.0 - 1.0).abs() < 0.01, "{l}");
        }
    }
}

/// Mean absolute difference of what a solution shows of ball, the scene's last object, to the path tracer.
fn error(solution: &LightTransportSolution) -> f64 {
    let ball = solution.scene.objects.len() as u32 - 1;
    let geometry = &solution.world.geometry;
    error_where(solution, solution, |surface, _| geometry.object[surface.triangle as usize] == ball)
}

/// Mean absolute difference of what one solution shows to paths in another, over the mean of those, where surfaces
/// seen along directions are of interest.
pub fn error_where(
    shown: &LightTransportSolution,
    traced: &LightTransportSolution,
    is_of_interest: impl Fn(&Surface, Vec3) -> bool,
) -> f64 {
    let (camera, [w, h]) = (shown.scene.camera, [48, 48]);
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let (buffer, layers) = render(shown, &camera, w, h, &settings);
    let tracer = PathTracer::new(&traced.world);
    let rays: Vec<(usize, Ray)> = (0..buffer.triangle.len())
        .filter_map(|i| {
            let surface = buffer.surface(&shown.world, &camera, i)?;
            let along = (surface.position - camera.eye).normalize();
            is_of_interest(&surface, along).then(|| (i, Ray::new(camera.eye, along)))
        })
        .collect();
    assert!(rays.len() > 300, "{}", rays.len());
    let found: Vec<[f64; 2]> = rays
        .par_iter()
        .map(|(i, ray)| {
            let wanted = radiance_with(&tracer, ray, 256, *i as u64).mean;
            let shown = layers.get(Layer::Mirror).pixels[*i] + layers.get(Layer::Glossy).pixels[*i];
            [f64::from((shown - wanted).abs().x), f64::from(wanted.x)]
        })
        .collect();
    let [off, all] = found.iter().fold([0.0; 2], |s, f| [s[0] + f[0], s[1] + f[1]]);
    off / all
}

#[test]
fn the_view_of_maps_holds_the_walls_where_they_are() {
    let solution = solved(with_ball(box_room(0.5, 10.0), Vec3::new(0.2, 0.1, -0.3), 0.05, 0.0), 0.4);
    let (scene, geometry) = (&solution.scene, &solution.world.geometry);
    let view = maps(scene, geometry, &solution.environments).unwrap();
    assert!(view.images.len() == 1 && view.images[0].image.mean().x > 0.0 && view.labels[0].text == "ball");
    // Two metres wide about the origin: what the map holds lies on the walls, but for the share that is drawn nearer
    // and what lies between texels at an edge of the room.
    let off = |p: &Vec3| (p.abs().max_element() - 1.0).abs();
    let mut far: Vec<f32> = view.meshes[0].positions.iter().map(off).collect();
    far.sort_by(f32::total_cmp);
    assert!(far[far.len() * 9 / 10] < 0.02, "{:?}", &far[far.len() * 9 / 10..]);
    assert!(maps(scene, geometry, &Environments::default()).is_none());
}

#[test]
fn what_is_glossy_in_a_mirror_is_blurred() {
    let metal =
        |roughness| Material { reflectance: Vec3::ONE, metallic: 1.0, roughness, ..Material::default() };
    // A mirror for the left wall, a polished floor that shows a bright panel.
    let lit = |roughness: f32| {
        let mut scene = Scene::default();
        let (x, y, z) = (2.0 * Vec3::X, 2.0 * Vec3::Y, 2.0 * Vec3::Z);
        let low = Vec3::new(-1.0, 0.0, -1.0);
        add(&mut scene, "floor", rectangle(low, z, x), metal(roughness));
        add(&mut scene, "mirror", rectangle(low, y, z), metal(0.0));
        let dull = merged(&[rectangle(low, x, y), rectangle(low + x, z, y), rectangle(low + y, x, z)]);
        add(&mut scene, "walls", dull, Material::default());
        let bright = Material { emission: Vec3::splat(30.0), ..Material::default() };
        let panel = rectangle(Vec3::new(-0.7, 0.3, -0.95), Vec3::X * 0.6, Vec3::Y * 0.5);
        add(&mut scene, "panel", panel, bright);
        scene.camera = Camera {
            eye: Vec3::new(0.5, 0.7, 0.9),
            target: Vec3::new(-1.0, 0.3, 0.0),
            vertical_fov: 0.6,
            ..scene.camera
        };
        solved(scene, 0.1)
    };
    for roughness in [0.21, 0.3, 0.45] {
        let (solution, sharp) = (lit(roughness), lit(0.0));
        let plain = LightTransportSolution { environments: Default::default(), ..solution.clone() };
        let world = &solution.world;
        let is_floor_in_mirror = |surface: &Surface, along: Vec3| {
            let object = |t: u32| world.geometry.object[t as usize];
            object(surface.triangle) == 1
                && world.accel.trace(&surface.mirrored(along)).is_some_and(|hit| object(hit.triangle) == 0)
        };
        let [blurred, unblurred, as_wide] =
            [&solution, &sharp, &plain].map(|shown| error_where(shown, &solution, is_floor_in_mirror));
        println!("roughness {roughness}: {blurred:.3}, unblurred {unblurred:.3}, as if dull {as_wide:.3}");
        // One map for the whole floor, a lobe as wide at every angle: the wider, the more of the sharp picture's
        // error it takes away.
        assert!(blurred < unblurred && blurred < 0.5 * as_wide, "{blurred} {unblurred} {as_wide}");
    }
}

#[test]
fn curved_reflectors_leave_maps_to_flat_ones_in_mirrors() {
    let metal =
        |roughness| Material { reflectance: Vec3::ONE, metallic: 1.0, roughness, ..Material::default() };
    let mut scene = box_room(0.5, 10.0);
    for i in 0..MOST_MAPS {
        let corner = Vec3::new(-0.8 + 0.05 * i as f32, 0.5, 0.0);
        let mut curved = rectangle(corner, Vec3::X * 0.04, Vec3::Y * 0.04);
        curved.normals.iter_mut().for_each(|n| *n = (*n + 0.2 * Vec3::X).normalize());
        add(&mut scene, "curved", curved, metal(0.0));
    }
    let low = Vec3::splat(-0.9);
    add(&mut scene, "floor", rectangle(low, Vec3::Z, Vec3::X), metal(0.3));
    add(&mut scene, "mirror", rectangle(low, Vec3::Y, Vec3::Z), metal(0.0));
    let maps = &solved(scene, 0.4).environments.list;
    let flat = maps.iter().filter(|map| matches!(map.of, MapOwner::Flat { .. })).count();
    assert_eq!((maps.len(), flat), (MOST_MAPS, 1), "one curved reflector gives way to the floor");
}

#[test]
fn every_flat_glossy_reflector_of_a_dozen_has_a_map_and_what_is_left_out_of_more_is_counted() {
    let metal =
        |roughness| Material { reflectance: Vec3::ONE, metallic: 1.0, roughness, ..Material::default() };
    for (tiles, maps, without) in [(12, 12, 0), (18, MOST_MAPS / 2, 18 - MOST_MAPS / 2)] {
        let mut scene = box_room(0.5, 10.0);
        for i in 0..tiles {
            let corner = Vec3::new(-0.9 + 0.1 * i as f32, -0.9, 0.0);
            add(&mut scene, "tile", rectangle(corner, Vec3::Z * 0.05, Vec3::X * 0.05), metal(0.3));
        }
        add(&mut scene, "mirror", rectangle(Vec3::splat(-0.95), Vec3::Y, Vec3::Z), metal(0.0));
        let solution = solved(scene, 0.4);
        let found = (solution.environments.list.len(), left_out(&solution.world.geometry));
        assert_eq!(found, (maps, without), "{tiles} tiles");
        let plan = Plan::new(&solution.scene, &solution.world, 0.4, 1);
        let line = plan.lines.iter().find(|l| l.component == Component::Glossy).unwrap();
        assert!(
            line.used && line.reason.contains("2 more than have maps") == (without > 0),
            "{}",
            line.reason
        );
    }
}

#[test]
fn a_ball_shows_the_room_around_it() {
    // A map is exact in the middle of the ball: the error grows with its size. A lobe is as wide at every angle.
    for (roughness, radius, most) in [(0.0, 0.05, 0.08), (0.0, 0.35, 0.12), (0.3, 0.35, 0.4)] {
        let mut scene = with_ball(cornell(), Vec3::new(0.35, 1.2, 0.2), radius, roughness);
        let eye = Vec3::new(0.35, 1.3, 0.2 + 5.0 * radius);
        let vertical_fov = 2.0 * 0.22f32.atan();
        scene.camera = Camera { eye, target: Vec3::new(0.35, 1.2, 0.2), vertical_fov, ..scene.camera };
        let solution = solved(scene, 0.15);
        let plain = LightTransportSolution { environments: Default::default(), ..solution.clone() };
        let [by_map, as_wide] = [error(&solution), error(&plain)];
        println!("roughness {roughness}, radius {radius}: {by_map:.3} by the map, {as_wide:.3} as if dull");
        assert!(by_map < most && by_map < 0.5 * as_wide, "{by_map} {as_wide}");
    }
    // A coat is no mirror: the floor beneath gives most of the light.
    let mut coated = with_ball(cornell(), Vec3::new(0.35, 1.2, 0.2), 0.05, 0.0);
    coated.materials.iter_mut().find(|m| m.name == "white").unwrap().roughness = 0.0;
    let eye = Vec3::new(0.35, 1.3, 0.45);
    coated.camera = Camera { eye, target: Vec3::new(0.35, 1.2, 0.2), vertical_fov: 0.43, ..coated.camera };
    let by_map = error(&solved(coated, 0.15));
    println!("coated floor: {by_map:.3}");
    assert!(by_map < 0.15, "{by_map}");
    let dull = solved(cornell(), 0.4);
    assert!(Environments::new(&dull.world, &dull.radiosity, 1).list.is_empty());
}
