//! Particles as a part of a solution that follows lamps.

use glam::{Affine3A, Vec3};
use lumenscope_core::{
    glossy::{
        GlossyMethod,
        particles::{
            light::{ParticleLight, wanted},
            trace::Particles,
        },
    },
    math::{image::LinearImage, progress::Progress},
    scene::{Scene, world::World},
    superposition::{PassSettings, layers::Layer, plan::Plan, render},
    transport::{LightTransportSolution, live::LiveTransport},
};
use lumenscope_tests::{add_point_lamp, cornell};
use std::sync::Arc;

/// A box with a polished block and a lamp of each kind.
fn scene() -> Scene {
    let mut scene = cornell();
    let tall = scene.materials.iter_mut().find(|m| m.name == "tall").unwrap();
    (tall.metallic, tall.roughness) = (1.0, 0.4);
    add_point_lamp(&mut scene, Vec3::new(0.3, 1.0, 0.6), Vec3::new(3.0, 4.0, 5.0));
    scene.plan.glossy = Some(GlossyMethod::Particles);
    scene.plan.glossy_particles = Some(20_000);
    scene.plan.element_spacing_m = Some(0.2);
    scene.plan.volume = Some(false);
    scene
}

fn followed(world: &World, scene: &Scene) -> World {
    let mut world = world.clone();
    world.follow(scene);
    world
}

fn glossy(solution: &LightTransportSolution) -> LinearImage {
    let camera = &solution.scene.camera;
    render(solution, camera, 64, 48, &PassSettings::default()).1.get(Layer::Glossy).clone()
}

#[test]
fn dimming_sends_nothing_and_moving_sends_the_moved_lamps_particles_alone() {
    let mut scene = scene();
    let world = World::new(&scene);
    let silent = Progress::silent();
    let first = ParticleLight::new(&world, 20_000, 3, &silent).unwrap();
    scene.lamps[0].dimmer = 0.5;
    let dimmed = first.followed(&followed(&world, &scene), 20_000);
    for (a, b) in first.particles.sent.iter().zip(&dimmed.particles.sent) {
        assert!(Arc::ptr_eq(&a.hits, &b.hits) && a.count == b.count);
    }
    assert_eq!(dimmed.particles.sent[0].flux, 0.5 * first.particles.sent[0].flux);
    assert_eq!(dimmed.particles.sent[1].flux, first.particles.sent[1].flux);
    // Each moved lamp sends some at once and, at rest, what it would have sent from there.
    scene.lamps[0].dimmer = 1.0;
    scene.lamps[0].world_from_lamp = Affine3A::from_translation(Vec3::new(-0.3, 1.2, 0.5));
    let there = followed(&world, &scene);
    let moving = first.followed(&there, 20_000);
    let [a, b] = [&moving, &first].map(|light| light.particles.sent[0].count);
    assert!(a > 0 && a < b / 4, "{a} of {b}");
    assert!(Arc::ptr_eq(&moving.particles.sent[1].hits, &first.particles.sent[1].hits));
    // A long drag ends with as many as a short one.
    let mut dragged = moving.clone();
    for step in 0..10 {
        scene.lamps[0].world_from_lamp.translation.x += 0.01 * if step % 2 == 0 { 1.0 } else { -1.0 };
        dragged = dragged.followed(&followed(&there, &scene), 20_000);
    }
    assert_eq!(dragged.particles.sent[0].count, a);
    let settled = moving.settled(&there, 20_000, &silent).unwrap();
    let mut fresh = Particles::new(&there, 3);
    fresh.trace(&there, 20_000, &silent).unwrap();
    assert!(settled.particles == fresh);
}

#[test]
fn a_solution_follows_its_lamps_and_its_plan_by_particles() {
    let mut scene = scene();
    let plan = Plan::new(&scene, &World::new(&scene), 0.1, 1);
    let silent = Progress::silent();
    let mut live =
        LiveTransport::solve(Arc::new(scene.clone()), plan.solve.clone(), &silent, &mut |_| {}).unwrap();
    let first = live.current().clone();
    let bright = glossy(&first);
    scene.lamps.iter_mut().for_each(|l| l.dimmer = 0.5);
    scene.objects.iter_mut().for_each(|o| o.dimmer *= 0.5);
    let dimmed = live.follow(Arc::new(scene.clone())).clone();
    let ratio = glossy(&dimmed).mean() / bright.mean();
    assert!((ratio - 0.5).abs().max_element() < 1e-5, "half of the light is {ratio}");
    while live.refine(&silent).unwrap().is_some() {}
    assert!(glossy(live.current()) == glossy(&dimmed), "the same particles at rest");
    // Another number sends anew, another method gives them up; the radiosity stays.
    let with = |live: &LiveTransport, particles, method| {
        let mut other = scene.clone();
        (other.plan.glossy, other.plan.glossy_particles) = (method, particles);
        let settings = Plan::new(&other, &World::new(&other), 0.1, 1).solve;
        live.with_settings(Arc::new(other), settings, &silent, &mut |_| {}).unwrap()
    };
    let more = with(&live, Some(40_000), Some(GlossyMethod::Particles));
    let sent = |live: &LiveTransport| live.current().particles.as_ref().map(|p| p.particles.count());
    assert!(sent(&more) > Some(40_000 - 1) && sent(&live).is_some_and(|n| n < 30_000));
    let none = with(&more, None, None);
    assert!(sent(&none).is_none() && Arc::ptr_eq(&none.current().radiosity, &live.current().radiosity));
}

#[test]
fn a_plan_wants_particles_where_something_is_glossy() {
    let mut scene = scene();
    let wanted = |scene: &Scene| wanted(&scene.plan, &World::new(scene).geometry);
    assert_eq!(wanted(&scene), Some(20_000));
    scene.plan.glossy = Some(GlossyMethod::Variant);
    assert_eq!(wanted(&scene), None);
    scene.plan.glossy = Some(GlossyMethod::Particles);
    scene.materials.iter_mut().for_each(|m| (m.metallic, m.roughness) = (0.0, 1.0));
    assert_eq!(wanted(&scene), None);
}
