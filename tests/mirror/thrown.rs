//! What mirrors and glossy surfaces throw onto dull ones.

use glam::{Affine3A, Vec2, Vec3};
use lumenscope_core::{
    math::{colour::luminance, image::LinearImage, part::Part, progress::Progress, random::r2_point},
    radiosity::{RadiositySettings, RadiositySolution},
    reference::{irradiance::irradiance_with, path::PathTracer},
    scene::{
        Scene, accel::Ray, direct::Receiver, fresnel, geometry::Surface, lamp::LampKind, material::Material,
        world::World,
    },
};
use lumenscope_tests::{
    add, add_point_lamp, box_room, cornell, diffuse,
    golden::{self, Errors},
    merged, rectangle,
};
use rayon::prelude::*;
use std::{f32::consts::PI, sync::Arc};

fn metal(normal_reflectance: Vec3, roughness: f32) -> Material {
    Material { reflectance: normal_reflectance, metallic: 1.0, roughness, ..Material::default() }
}

fn solve(scene: &Scene, spacing_m: f32, shadow_rays: u32) -> (World, RadiositySolution) {
    let world = World::new(scene);
    let spacing = RadiositySettings { element_spacing_m: Some(spacing_m), ..RadiositySettings::default() };
    let settings = RadiositySettings { shadow_rays, ..spacing };
    let solution = RadiositySolution::solve(&world, &settings, &Progress::silent()).unwrap();
    (world, solution)
}

#[test]
fn a_furnace_with_perfect_mirrors_for_walls_is_still_a_furnace() {
    let mut scene = box_room(0.5, 10.0);
    for x in [-0.999f32, 0.999] {
        let (u, v) = if x < 0.0 { (Vec3::Y * 2.0, Vec3::Z * 2.0) } else { (Vec3::Z * 2.0, Vec3::Y * 2.0) };
        add(&mut scene, "mirror", rectangle(Vec3::new(x, -1.0, -1.0), u, v), metal(Vec3::ONE, 0.0));
    }
    let (world, solution) = solve(&scene, 0.25, 2048);
    let exact = 10.0 * PI / (1.0 - 0.5);
    let mut found = Vec::new();
    for triangle in (0..12).filter(|&t| world.geometry.area_normal(t).x.abs() < 1e-3) {
        let at = |i| solution.irradiance(triangle, 0.5 * r2_point(i, triangle), false, Part::All).x / exact;
        found.extend((0..8).map(at));
    }
    // Each wall is a lamp half of which is behind mirrors, found by 2,048 rays; rays that come out of 32 mirrors
    // in turn are lost, less than 1e-3 of the light.
    let mean = found.iter().sum::<f32>() / found.len() as f32;
    let worst = found.iter().fold(0.0f32, |worst, e| worst.max((e - 1.0).abs()));
    println!("mean {mean}, worst {worst} of {}", found.len());
    assert!((mean - 1.0).abs() < 0.005 && worst < 0.05, "mean {mean}, worst off by {worst}");
}

/// A floor, a golden mirror beside it that may reflect on both sides, and a lamp without a surface.
fn lamp_and_mirror(kind: LampKind, double_sided: bool) -> Scene {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(0.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    add(&mut scene, "floor", floor, diffuse("floor", Vec3::splat(0.5), Vec3::ZERO));
    let (y, z) = (Vec3::Y, Vec3::Z * 2.0);
    // With its back to the floor it reflects only where it is double-sided.
    let (u, v) = if double_sided { (z, y) } else { (y, z) };
    let mirror = Material { double_sided, ..metal(GOLD, 0.0) };
    add(&mut scene, "mirror", rectangle(Vec3::new(0.0, 0.5, -1.0), u, v), mirror);
    let lamp = add_point_lamp(&mut scene, LAMP, Vec3::ZERO);
    scene.lamps[lamp].kind = kind;
    // A directional lamp shines along −z of its own: down and towards the mirror.
    scene.lamps[lamp].world_from_lamp *= Affine3A::from_rotation_y(1.2) * Affine3A::from_rotation_x(-0.6);
    scene
}

const GOLD: Vec3 = Vec3::new(0.9, 0.7, 0.4);
const LAMP: Vec3 = Vec3::new(1.0, 2.0, 0.1);
const LIGHT: Vec3 = Vec3::new(100.0, 80.0, 60.0);

#[test]
fn a_mirror_throws_a_lamps_light_as_its_image_would() {
    for (kind, double_sided) in [
        (LampKind::Point { intensity: LIGHT }, false),
        (LampKind::Point { intensity: LIGHT }, true),
        (LampKind::Directional { illuminance: LIGHT }, false),
    ] {
        let scene = lamp_and_mirror(kind, double_sided);
        let sun = (-scene.lamps[0].axis()) * Vec3::new(-1.0, 1.0, 1.0);
        let (world, solution) = solve(&scene, 0.1, 16);
        let tracer = PathTracer::new(&world);
        let (mut lit, mut dark) = (0, 0);
        for i in 0..400 {
            let p = r2_point(i, 3) * Vec2::new(4.0, 4.0) - Vec2::Y * 2.0;
            let p = Vec3::new(p.x, 0.0, p.y);
            let image = LAMP * Vec3::new(-1.0, 1.0, 1.0) - p;
            let (to, light) = match kind {
                LampKind::Directional { .. } => (sun, 1.0),
                _ => (image, 1.0 / image.length_squared()),
            };
            // Where the way to the image crosses the mirror's plane.
            let cross = p - to * (p.x / to.x);
            let inside = Vec2::new(cross.y - 1.0, cross.z).abs() - Vec2::new(0.5, 1.0);
            // On the edge of the light's shape elements blur, and at the border of the floor they lie to one side.
            if inside.max_element().abs() < 0.25 || Vec2::new(p.x - 2.0, p.z).abs().max_element() > 1.9 {
                continue;
            }
            let cosine = to.normalize();
            let share = GOLD.map(|f| fresnel::reflectance(f, cosine.x.abs()));
            let seen = inside.max_element() < 0.0 && to.x < 0.0;
            let exact = if seen { LIGHT * share * (cosine.y * light) } else { Vec3::ZERO };
            *(if seen { &mut lit } else { &mut dark }) += 1;
            let hit = world.accel.trace(&Ray::new(p + Vec3::Y * 0.1, Vec3::NEG_Y)).unwrap();
            let surface = world.geometry.surface(hit.triangle, hit.barycentric, Vec3::NEG_Y);
            let traced = irradiance_with(&tracer, &Receiver::of(&surface), Part::Indirect, 64, i.into()).mean;
            let off = (traced - exact).abs().max_element();
            assert!(off <= 1e-3 * exact.max_element(), "{kind:?} {p}: {traced} for {exact}");
            let e = solution.irradiance(hit.triangle, hit.barycentric, false, Part::Indirect);
            let off = (e - exact).abs().max_element();
            assert!(off < 0.01 * exact.max_element().max(1.0), "{kind:?} {p}: {e} for {exact}");
        }
        assert!(lit > 20 && dark > 5, "{kind:?}: {lit} {dark}");
    }
}

#[test]
fn what_a_mirror_throws_of_a_luminous_surface_depends_on_neither_its_mesh_nor_its_picture() {
    let emitter = |cuts: u32, picture: Option<Arc<LinearImage>>| {
        let mut scene = lamp_and_mirror(LampKind::Point { intensity: Vec3::ZERO }, false);
        // Facing the mirror and the floor, by (−0.6, −0.8, 0).
        let (u, v) = (Vec3::Z * 0.4, Vec3::new(-0.8, 0.6, 0.0) * 0.4);
        let (du, dv) = (u / cuts as f32, v / cuts as f32);
        let tiles = (0..cuts * cuts)
            .map(|i| rectangle(LAMP + du * (i % cuts) as f32 + dv * (i / cuts) as f32, du, dv));
        let bright = if picture.is_some() { 2.0 } else { 1.0 };
        let material = Material {
            emission: LIGHT * bright,
            emission_texture: picture.as_ref().map(|_| 0),
            ..diffuse("panel", Vec3::ZERO, Vec3::ZERO)
        };
        scene.textures.extend(picture);
        add(&mut scene, "panel", merged(&tiles.collect::<Vec<_>>()), material);
        // The image of many triangles is sampled over their area.
        solve(&scene, 0.1, 256).1
    };
    let grey = LinearImage { width: 2, height: 2, pixels: vec![Vec3::splat(0.5); 4] };
    let [whole, meshed, pictured] = [emitter(1, None), emitter(5, None), emitter(1, Some(Arc::new(grey)))];
    let world = World::new(&lamp_and_mirror(LampKind::Point { intensity: Vec3::ZERO }, false));
    let at = |i: u32| {
        let p = r2_point(i, 3) * Vec2::new(1.6, 3.0) - Vec2::Y * 1.5;
        let hit = world.accel.trace(&Ray::new(Vec3::new(p.x + 0.2, 0.1, p.y), Vec3::NEG_Y)).unwrap();
        let e = |s: &RadiositySolution| s.irradiance(hit.triangle, hit.barycentric, false, Part::Indirect).x;
        [&whole, &meshed, &pictured].map(e)
    };
    let found: Vec<[f32; 3]> = (0..200).map(at).collect();
    let most = found.iter().map(|e| e[0]).fold(0.0, f32::max);
    // Where the whole panel shows; sampled by 256 rays an element where it has many triangles or a picture.
    let lit: Vec<_> = found.iter().filter(|e| e[0] > 0.7 * most).collect();
    for [a, b, c] in &lit {
        assert!((b - a).abs() < 0.1 * a && (c - a).abs() < 0.1 * a, "{a}, {b}, {c}");
    }
    let [a, b, c] = [0, 1, 2].map(|i| found.iter().map(|e| e[i]).sum::<f32>() / found.len() as f32);
    println!("{} points; means {a}, {b}, {c}", lit.len());
    assert!(lit.len() > 30 && (b / a - 1.0).abs() < 0.01 && (c / a - 1.0).abs() < 0.01, "{a}, {b}, {c}");
}

/// Errors against the path tracer at points of dull surfaces.
fn errors(scene: &Scene, spacing_m: f32) -> Errors {
    let (world, solution) = solve(scene, spacing_m, 16);
    let tracer = PathTracer::new(&world);
    let dull = |s: &Surface| {
        world.geometry.brdf(s).specular.is_none() && world.geometry.reflectance(s) != Vec3::ZERO
    };
    let surfaces: Vec<Surface> = golden::surface_points(&world, 300).into_iter().filter(dull).collect();
    let found: Vec<(f32, (f32, f32))> = (surfaces.par_iter().enumerate())
        .map(|(i, surface)| {
            let found = solution.irradiance_exact_direct(&world, surface, Part::All, 256, i as u32);
            let truth = irradiance_with(&tracer, &Receiver::of(surface), Part::All, 8192, i as u64);
            (luminance(found), (luminance(truth.mean), luminance(truth.standard_error)))
        })
        .collect();
    let (estimates, truths): (Vec<f32>, Vec<(f32, f32)>) = found.into_iter().unzip();
    golden::errors(&estimates, &truths)
}

#[test]
fn polished_walls_and_blocks_light_a_room_as_the_path_tracer_says() {
    for (what, wall, block) in [
        ("mirror", metal(Vec3::splat(0.9), 0.0), metal(Vec3::new(0.9, 0.7, 0.4), 0.0)),
        ("rough metal", metal(Vec3::splat(0.9), 0.3), metal(Vec3::new(0.9, 0.7, 0.4), 0.2)),
        (
            "gloss paint",
            Material { reflectance: Vec3::splat(0.5), roughness: 0.3, ..Material::default() },
            metal(Vec3::ONE, 0.4),
        ),
    ] {
        let mut scene = cornell();
        for material in &mut scene.materials {
            let kind = match material.name.as_str() {
                "red" => &wall,
                "tall" => &block,
                _ => continue,
            };
            *material = Material { name: material.name.clone(), ..kind.clone() };
        }
        let found = errors(&scene, 0.08);
        println!("{what}: {found:?}");
        // The project's bounds.
        assert!(found.noise < 0.03 && found.median <= 0.04 && found.high <= 0.15, "{what}: {found:?}");
        assert!(found.signed.abs() <= 0.015 && found.flux.abs() <= 0.015, "{what}: {found:?}");
    }
}
