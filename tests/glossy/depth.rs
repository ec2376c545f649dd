//! Glossy reflections seen in glossy ones, to a chosen depth.

use super::environment::{error_where, with_ball};
use glam::Vec3;
use lumenscope_core::{
    glossy::environment::{Environments, GLOSSY_DEPTH, LOBE_DIRECTIONS, depth_of},
    math::part::Part,
    scene::{Scene, accel::Ray, camera::Camera, geometry::Surface, material::Material, world::World},
    superposition::plan::{Component, Plan},
    transport::LightTransportSolution,
};
use lumenscope_tests::{add, cornell, rectangle, solved};
use std::sync::Arc;

/// Share of metal, which reflects everything; the rest is painted white and has no coat.
const F: f32 = 0.5;

/// Two plates that shine and face each other, as wide as four hundred times the distance between them.
fn plates(material: Material) -> Scene {
    let mut scene = Scene::default();
    let (x, z) = (400.0 * Vec3::X, 400.0 * Vec3::Z);
    let low = Vec3::new(-200.0, 0.0, -200.0);
    add(&mut scene, "below", rectangle(low, z, x), material.clone());
    add(&mut scene, "above", rectangle(low + Vec3::Y, x, z), material);
    scene
}

#[test]
fn two_glossy_plates_show_each_other_as_the_series_says() {
    let shining = Material { emission: Vec3::ONE, reflectance: Vec3::ZERO, ..Material::default() };
    // What the last reflection shows is what is stored: of plates that reflect nothing, each other's light alone.
    let dull = solved(plates(shining.clone()), 20.0);
    for roughness in [0.21f32, 0.3] {
        let metal = Material { metallic: F, roughness, ior: 1.0, reflectance: Vec3::ONE, ..shining.clone() };
        assert!((metal.diffuse_share() - (1.0 - F)).abs() < 1e-6 && metal.coat_reflectance() == 0.0);
        let world = World::new(&plates(metal));
        let hit = world.accel.trace(&Ray::new(Vec3::new(0.0, 0.5, 0.0), Vec3::Y)).unwrap();
        let e = dull.radiosity.irradiance(hit.triangle, hit.barycentric, false, Part::All).x;
        let mut before = 0.0;
        for depth in [1, 2, 3, 8] {
            let maps = Environments::new(&world, &dull.radiosity, depth);
            assert_eq!(maps.list.len(), 2);
            let found = maps.list[0].towards(Vec3::Y).x;
            // (Lₑ + ρ E/π) Σ_{k<n} Fᵏ + Fⁿ E/π, a geometric series, at any angle.
            let (power, stored) = (F.powi(depth as i32), e / std::f32::consts::PI);
            let wanted = (1.0 + (1.0 - F) * stored) * (1.0 - power) / (1.0 - F) + power * stored;
            println!("roughness {roughness}, depth {depth}: {found:.4} for {wanted:.4}");
            // The row of texels at the horizon, 2.8° high, is half dark. A lobe has this share beyond (half vectors over
            // 43.6° of GGX), and what it meets there has lost as much again.
            let alpha = roughness * roughness;
            let beyond = alpha * alpha / (alpha * alpha + 43.6f32.to_radians().tan().powi(2));
            assert!((found / wanted - 1.0).abs() < 2.0 * beyond + 1e-3, "{found} for {wanted}");
            assert!(found > before + 0.5 * (wanted - before).min(0.01), "no deeper than {before}: {found}");
            before = found;
        }
    }
}

#[test]
fn a_ball_in_a_ball_is_nearer_to_the_path_tracer_from_the_second_reflection_on() {
    for roughness in [0.2, 0.3] {
        let (near, far) = (Vec3::new(0.35, 1.2, 0.2), Vec3::new(-0.05, 1.2, 0.25));
        let mut scene = with_ball(with_ball(cornell(), far, 0.2, roughness), near, 0.04, roughness);
        // Where the nearer ball mirrors the other one.
        let (eye, target) = (Vec3::new(0.35, 1.2, 0.6), Vec3::new(0.3228, 1.2, 0.2292));
        scene.camera = Camera { eye, target, vertical_fov: 0.07, ..scene.camera };
        let solution = solved(scene, 0.15);
        let count = solution.scene.objects.len() as u32;
        let world = solution.world.clone();
        let is_ball_in_ball = |surface: &Surface, along: Vec3| {
            let object = |t: u32| world.geometry.object[t as usize];
            object(surface.triangle) == count - 1
                && world
                    .accel
                    .trace(&surface.mirrored(along))
                    .is_some_and(|h| object(h.triangle) == count - 2)
        };
        let of = |depth| {
            let (maps, light) = (&solution.environments, &solution.radiosity);
            let environments = Arc::new(maps.relit(&world, light, LOBE_DIRECTIONS, depth));
            let shown = LightTransportSolution { environments, ..solution.clone() };
            error_where(&shown, &solution, is_ball_in_ball)
        };
        let [once, twice, often] = [1, 2, 4].map(of);
        println!("roughness {roughness}: {once:.3} as if dull, {twice:.3} seen twice, {often:.3} four times");
        assert!(twice < 0.7 * once && often < 0.7 * once, "{once} {twice} {often}");
    }
}

#[test]
fn the_plan_says_how_many_glossy_reflections_maps_hold() {
    let mut scene = with_ball(cornell(), Vec3::new(0.35, 1.2, 0.2), 0.2, 0.25);
    let line = |scene: &Scene| {
        let plan = Plan::new(scene, &World::new(scene), 0.04, 1);
        plan.lines.into_iter().find(|l| l.component == Component::Glossy).unwrap()
    };
    assert_eq!(depth_of(&scene.plan), GLOSSY_DEPTH);
    assert!(!line(&scene).overridden && line(&scene).reason.contains("maps hold 2 glossy reflections"));
    scene.plan.glossy_depth = Some(1);
    assert!(line(&scene).overridden && line(&scene).reason.contains("maps hold 1 glossy reflection"));
    scene.plan.glossy_depth = Some(0);
    assert_eq!(scene.plan.problem(), Some(("glossy_depth", "0".into())));
}
