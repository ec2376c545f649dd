//! A solution that follows its lamps.

use super::{room, settings as at_spacing, solve};
use glam::{Affine3A, Vec3};
use lumenscope_core::{radiosity::RadiositySettings, scene::Target};
use lumenscope_tests::add_point_lamp;

#[test]
fn relighting_equals_a_fresh_solve() {
    // 0.1 %: both stop at a bound of 0.01 % of the mean; an element may be off by more than the mean is.
    let settings = |spacing| RadiositySettings { tolerance: 1e-4, ..at_spacing(spacing) };
    let mut scene = room();
    let (mut world, before) = solve(&scene, &settings(0.15));
    scene.place(Target::Lamp(0), Affine3A::from_translation(Vec3::new(0.6, 1.2, 2.2)));
    scene.lamps[0].dimmer = 0.7;
    let changed = world.follow(&scene);
    assert_eq!(changed, [Target::Lamp(0)]);
    let relit = before.relight(&world, &changed, 16, 100);
    assert!(relit.convergence().converged);
    let (_, fresh) = solve(&scene, &settings(0.15));
    assert_eq!(relit.direct, fresh.direct, "direct light is traced alike");
    let mean = fresh.indirect.iter().map(|e| e.x).sum::<f32>() / fresh.indirect.len() as f32;
    for (a, b) in relit.indirect.iter().zip(&fresh.indirect) {
        assert!((a.x - b.x).abs() < 0.001 * mean, "{a} and {b}, mean {mean}");
    }
    assert!(before.indirect.iter().zip(&relit.indirect).any(|(a, b)| (a.x - b.x).abs() > 0.1 * mean));
}

#[test]
fn dimming_to_nothing_equals_removing_and_back_costs_nothing() {
    let settings = |spacing| RadiositySettings { tolerance: 1e-4, ..at_spacing(spacing) };
    let mut scene = room();
    add_point_lamp(&mut scene, Vec3::new(0.4, 2.0, 2.5), Vec3::splat(50.0));
    let (mut world, lit) = solve(&scene, &settings(0.15));
    scene.lamps[1].dimmer = 0.0;
    let changed = world.follow(&scene);
    let dimmed = lit.relight(&world, &changed, 16, 100);
    let (_, removed) = solve(&room(), &settings(0.15));
    let mean = removed.indirect.iter().map(|e| e.x).sum::<f32>() / removed.indirect.len() as f32;
    assert_eq!(dimmed.direct, removed.direct);
    for (a, b) in dimmed.indirect.iter().zip(&removed.indirect) {
        assert!((a.x - b.x).abs() < 0.001 * mean, "{a} and {b}");
    }
    scene.lamps[1].dimmer = 1.0;
    let changed = world.follow(&scene);
    assert_eq!(dimmed.relight(&world, &changed, 16, 100).direct, lit.direct);
}

#[test]
fn lamp_that_was_off_from_the_start_lights_when_dimmed_up() {
    let mut scene = room();
    scene.lamps[0].dimmer = 0.0;
    let (mut world, dark) = solve(&scene, &at_spacing(0.2));
    assert!(dark.direct.iter().chain(&dark.indirect).all(|e| *e == Vec3::ZERO));
    scene.lamps[0].dimmer = 1.0;
    let changed = world.follow(&scene);
    let lit = dark.relight(&world, &changed, 16, 100);
    assert_eq!(lit.direct, solve(&room(), &at_spacing(0.2)).1.direct);
}

#[test]
fn what_moved_while_a_lamp_was_off_is_in_its_light_when_it_comes_back() {
    let mut scene = room();
    scene.objects[1].movable = true;
    let (mut world, before) = solve(&scene, &at_spacing(0.2));
    scene.place(Target::Object(1), Affine3A::from_translation(Vec3::new(0.4, 0.0, 0.8)));
    scene.lamps[0].dimmer = 0.0;
    world.follow(&scene);
    let dark = before.relight(&world, &[Target::Lamp(0)], 16, 100);
    scene.lamps[0].dimmer = 1.0;
    world.follow(&scene);
    let (back, at_once) =
        (dark.relight(&world, &[], 16, 100), before.relight(&world, &[Target::Lamp(0)], 16, 100));
    assert!(at_once.direct != before.direct && back.direct == at_once.direct);
}
