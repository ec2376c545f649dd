//! Radiosity against closed forms, invariants and the reference path tracer.

mod against_paths;
mod closed_forms;
mod exchange;
mod relight;

use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{part::Part, progress::Progress},
    radiosity::{
        RadiosityError, RadiositySettings, RadiositySolution,
        lookup::{self, NO_ELEMENTS},
        smooth,
        surface_map::{SurfaceMap, UNSOLVED},
    },
    scene::{Scene, material::Material, world::World},
};
use lumenscope_tests::{add, add_point_lamp, cuboid, diffuse, rectangle};

fn settings(spacing: f32) -> RadiositySettings {
    RadiositySettings { element_spacing_m: Some(spacing), ..RadiositySettings::default() }
}

fn solve(scene: &Scene, settings: &RadiositySettings) -> (World, RadiositySolution) {
    let world = World::new(scene);
    let solution = RadiositySolution::solve(&world, settings, &Progress::silent()).expect("solves");
    assert!(solution.convergence().converged);
    assert!(
        solution.direct.iter().chain(&solution.indirect).all(|e| e.is_finite() && e.min_element() >= 0.0)
    );
    (world, solution)
}

/// Elements that are solved for themselves.
fn solved(solution: &RadiositySolution) -> impl Iterator<Item = usize> + '_ {
    (0..solution.elements().len()).filter(|&i| solution.elements()[i].flags & UNSOLVED == 0)
}

fn total(solution: &RadiositySolution, element: usize) -> Vec3 {
    solution.direct[element] + solution.indirect[element]
}

/// A box of grey walls, 2 m × 2.4 m × 3 m, with one point lamp and a small block on the floor.
fn room() -> Scene {
    let mut scene = Scene::default();
    let wall = diffuse("wall", Vec3::new(0.6, 0.5, 0.4), Vec3::ZERO);
    add(&mut scene, "room", cuboid(Vec3::ZERO, Vec3::new(2.0, 2.4, 3.0), true), wall.clone());
    let block = cuboid(Vec3::new(0.5, 0.0, 0.5), Vec3::new(0.9, 0.6, 0.9), false);
    add(&mut scene, "block", block, wall);
    add_point_lamp(&mut scene, Vec3::new(1.0, 1.8, 1.5), Vec3::new(100.0, 90.0, 60.0));
    scene
}

#[test]
fn same_bytes_at_any_thread_count() {
    let scene = lumenscope_tests::cornell();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| solve(&scene, &settings(0.1)).1)
    };
    let (one, two) = (run(1), run(2));
    assert_eq!(one.direct, two.direct);
    assert_eq!(one.indirect, two.indirect);
    assert_eq!(one.transport().hits, two.transport().hits);
}

#[test]
fn double_sided_plate_is_lit_on_both_sides_and_a_single_sided_back_is_black() {
    let mut scene = Scene::default();
    let plate = rectangle(Vec3::new(-0.5, 0.0, -0.5), Vec3::Z, Vec3::X);
    let material = diffuse("plate", Vec3::splat(0.5), Vec3::ZERO);
    add(&mut scene, "double", plate.clone(), Material { double_sided: true, ..material.clone() });
    let mut aside = plate;
    aside.positions.iter_mut().for_each(|p| p.x += 3.0);
    add(&mut scene, "single", aside, material);
    for x in [0.0, 3.0] {
        add_point_lamp(&mut scene, Vec3::new(x, 1.0, 0.0), Vec3::splat(10.0));
        add_point_lamp(&mut scene, Vec3::new(x, -1.0, 0.0), Vec3::splat(20.0));
    }
    let (_, solution) = solve(&scene, &settings(0.1));
    let at = |triangle, back| solution.irradiance(triangle, Vec2::new(0.0, 0.5), back, Part::Direct).x;
    // Directly below the lamps I/d², and 1/√10³ of the other pair's; bilinear error below 1 %.
    for (triangle, back, expected) in [(0, false, 10.0), (0, true, 20.0), (2, false, 10.0)] {
        let expected = expected * (1.0 + 0.1f32.powf(1.5));
        let e = at(triangle, back);
        assert!((e / expected - 1.0).abs() < 0.01, "{e} for {expected}");
        assert_ne!(solution.element_at(triangle, Vec2::new(0.3, 0.3), back), NO_ELEMENTS);
    }
    assert_eq!(at(2, true), 0.0);
    assert_eq!(solution.element_at(2, Vec2::new(0.3, 0.3), true), NO_ELEMENTS);
}

#[test]
fn weights_sum_to_one_and_reproduce_positions() {
    let scene = lumenscope_tests::cornell();
    let (world, solution) = solve(&scene, &settings(0.13));
    for triangle in 0..world.geometry.len() as u32 {
        for barycentric in [Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0), Vec2::new(0.2, 0.7), Vec2::splat(0.3)] {
            let side = solution.sides()[2 * triangle as usize];
            let blend = lookup::blend(&side, barycentric);
            assert!((blend.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{blend:?}");
            let there = world.geometry.surface(triangle, barycentric, Vec3::ZERO).position;
            let nodes: Vec<Vec3> = solution.elements().iter().map(|e| e.position).collect();
            // Nodes at the border are inset by at most 0.2 spacings an axis.
            let found = blend.sum(&nodes);
            assert!(found.distance(there) < 0.13 * 0.2 * 1.42, "{found} for {there}");
        }
    }
}

#[test]
fn smoothing_takes_noise_and_leaves_edges() {
    // A furnace has one irradiance: without smoothing few rays scatter around it, with it less.
    let mut scene = room();
    scene.lamps[0].dimmer = 0.0;
    scene.materials[0].emission = Vec3::ONE;
    let rough = RadiositySettings { gather_rays: 32, smoothing: 0.0, ..settings(0.1) };
    let smooth = RadiositySettings { smoothing: 1.0, ..rough };
    let roughness = |settings: &RadiositySettings| {
        let (_, solution) = solve(&scene, settings);
        let floor: Vec<f32> = solved(&solution)
            .filter(|&i| solution.elements()[i].position.y > 2.39)
            .map(|i| solution.indirect[i].x)
            .collect();
        let steps: f32 = floor.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
        (steps, floor.iter().sum::<f32>() / floor.len() as f32)
    };
    let ((before, mean), (after, kept)) = (roughness(&rough), roughness(&smooth));
    assert!(after < 0.5 * before, "{after} of {before}");
    // The weights are symmetric but for the borders: a mean moves by a fraction of the noise.
    assert!((kept / mean - 1.0).abs() < 0.01, "{kept} for {mean}");

    // Two nodes far apart for their noise keep their values, but for rounding.
    let (_, solution) = solve(&room(), &settings(0.1));
    let certain = vec![0.0; solution.elements().len()];
    let kept = smooth::smooth(solution.transport(), &solution.indirect, &certain, 1.0);
    for (kept, before) in kept.iter().zip(&solution.indirect) {
        assert!((*kept - *before).abs().max_element() <= 1e-6 * before.max_element(), "{kept} for {before}");
    }
}

#[test]
fn bad_requests_are_named_and_empty_scenes_are_dark() {
    let world = World::new(&room());
    let attempt = |settings: &RadiositySettings, progress: &Progress| {
        RadiositySolution::solve(&world, settings, progress).map(|_| ()).expect_err("refused")
    };
    let silent = Progress::silent();
    for spacing in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(attempt(&settings(spacing), &silent), RadiosityError::BadSpacing { .. }));
    }
    assert!(matches!(attempt(&settings(1e-4), &silent), RadiosityError::TooManyElements { .. }));
    let cancelled = Progress::silent();
    cancelled.cancel();
    assert_eq!(attempt(&settings(0.2), &cancelled), RadiosityError::Cancelled);

    let mut mirror = room();
    mirror.materials.iter_mut().for_each(|m| m.reflectance = Vec3::ONE);
    let error = RadiositySolution::solve(&World::new(&mirror), &settings(0.3), &silent).map(|_| ());
    assert!(matches!(error, Err(RadiosityError::NotConverged { .. })), "{error:?}");

    let (_, nothing) = solve(&Scene::default(), &RadiositySettings::default());
    assert!(nothing.elements().is_empty());
    assert_eq!(nothing.irradiance(3, Vec2::ZERO, false, Part::All), Vec3::ZERO);
}

#[test]
fn elements_of_a_long_strip_reflect_what_it_does() {
    let of = |length: f32, width: f32| {
        let mut scene = Scene::default();
        let strip = rectangle(Vec3::ZERO, Vec3::Z * width, Vec3::X * length);
        add(&mut scene, "strip", strip, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
        SurfaceMap::new(&World::new(&scene).geometry, Some(1.0))
    };
    let map = of(2000.0, 20.0).unwrap();
    assert_eq!(map.elements.len(), 2001 * 21);
    assert!(
        map.elements
            .iter()
            .all(|e| e.flags & UNSOLVED == 0 && (e.reflectance - 0.5).abs().max_element() < 1e-5)
    );
    let without = map.elements.iter().filter(|e| e.area == 0.0).count();
    let area = map.elements.iter().map(|e| f64::from(e.area)).sum::<f64>();
    println!("{without} of {} elements between the points", map.elements.len());
    assert!(
        (area / 40_000.0 - 1.0).abs() < 1e-3 && 50 * without < map.elements.len(),
        "{area} m², {without}"
    );
    // A spacing that is asked for is kept, as far as it can be.
    let charts = of(5000.0, 1.0).unwrap().charts;
    assert_eq!(charts[0].nx.max(charts[0].ny), 5001);
    let refused = of(70_000.0, 1.0).map(|_| ()).unwrap_err();
    assert_eq!(refused, RadiosityError::TooLong { nodes: 70_001, most: 65_535, spacing_m: 1.0 });
    assert!(matches!(of(1e9, 1e9).unwrap_err(), RadiosityError::TooManyElements { .. }));
}
