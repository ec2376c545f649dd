//! What elements exchange: form factors, reciprocity, energy.

use super::{room, settings, solve, solved, total};
use glam::{Vec2, Vec3};
use lumenscope_core::{
    irradiance_volume::direct::solid_angle,
    radiosity::{
        RadiositySettings, RadiositySolution,
        surface_map::{BURIED, UNSOLVED},
    },
    scene::Scene,
};
use lumenscope_tests::{add, add_point_lamp, cuboid, diffuse, rectangle};

/// Mean share of rays from object `from` that reach object `to`, over area: the form factor.
fn form_factor(solution: &RadiositySolution, from: u32, to: u32) -> (f64, f64) {
    let transport = solution.transport();
    let (mut flux, mut area) = (0.0, 0.0);
    for i in solved(solution).filter(|&i| solution.elements()[i].object == from) {
        let reached = transport
            .row(i as u32)
            .iter()
            .filter(|&&hit| solution.elements().get(hit as usize).is_some_and(|e| e.object == to))
            .count();
        let a = f64::from(solution.elements()[i].area);
        flux += a * reached as f64 / f64::from(transport.rays);
        area += a;
    }
    (flux / area, area)
}

#[test]
fn plates_exchange_the_textbook_form_factors() {
    // Unit squares face to face 1 m apart, F = 0.199825; sharing an edge at a right angle, F = 0.200044
    // (Howell's catalogue C-11, C-14).
    let plate = |scene: &mut Scene, name: &str, corner: Vec3, u: Vec3, v: Vec3| {
        add(scene, name, rectangle(corner, u, v), diffuse(name, Vec3::splat(0.5), Vec3::ZERO))
    };
    let settings = RadiositySettings { gather_rays: 1024, ..settings(0.05) };
    for (corner, u, v, expected) in
        [(Vec3::Y, Vec3::X, Vec3::Z, 0.199_825), (Vec3::ZERO, Vec3::X, Vec3::Y, 0.200_044)]
    {
        let mut scene = Scene::default();
        plate(&mut scene, "floor", Vec3::ZERO, Vec3::Z, Vec3::X);
        plate(&mut scene, "other", corner, u, v);
        let (_, solution) = solve(&scene, &settings);
        for (a, b) in [(0, 1), (1, 0)] {
            let (factor, area) = form_factor(&solution, a, b);
            assert!((area - 1.0).abs() < 1e-4, "area {area}");
            println!(
                "F {factor:.5}, expected {expected}, off by {:+.3} %",
                100.0 * (factor / expected - 1.0)
            );
            assert!((factor / expected - 1.0).abs() < 0.005, "F {factor}, expected {expected}");
        }
    }
}

#[test]
fn closed_scene_loses_no_ray() {
    let scene = room();
    let (_, solution) = solve(&scene, &settings(0.1));
    let nothing = solution.elements().len() as u32;
    // Nodes under the block are inside it and see its black backs; everything else sees a wall.
    for i in solved(&solution) {
        let e = &solution.elements()[i];
        let under = e.position.y < 0.01
            && Vec2::new(e.position.x - 0.7, e.position.z - 0.7).abs().max_element() < 0.21;
        if !under {
            let lost = solution.transport().row(i as u32).iter().filter(|&&h| h == nothing).count();
            assert_eq!(lost, 0, "element {i} at {}", e.position);
        }
    }
}

#[test]
fn two_objects_exchange_the_same_flux_both_ways() {
    // A₁F₁₂ = A₂F₂₁ for a room and a block afloat in it. 1 %: all rays of the block reach the room; of
    // the room's half a million some 4 % reach the block, a standard error of 0.7 % unstratified.
    let mut scene = Scene::default();
    let wall = diffuse("wall", Vec3::splat(0.5), Vec3::ZERO);
    add(&mut scene, "room", cuboid(Vec3::ZERO, Vec3::new(2.0, 2.4, 3.0), true), wall.clone());
    add(&mut scene, "block", cuboid(Vec3::new(0.5, 0.7, 0.5), Vec3::new(0.9, 1.3, 0.9), false), wall);
    let (_, solution) = solve(&scene, &settings(0.1));
    let (there, a) = form_factor(&solution, 0, 1);
    let (back, b) = form_factor(&solution, 1, 0);
    assert!((back - 1.0).abs() < 1e-6, "a convex body sees only the room: {back}");
    println!("a block in a room: {:+.3} %", 100.0 * (there * a / (back * b) - 1.0));
    assert!((there * a / (back * b) - 1.0).abs() < 0.005, "{} and {}", there * a, back * b);
    // Plates of 1 m × 1 m and 1 m × 2 m at a right angle.
    let mut scene = Scene::default();
    for (u, v) in [(Vec3::Z, Vec3::X), (Vec3::X, 2.0 * Vec3::Y)] {
        add(&mut scene, "plate", rectangle(Vec3::ZERO, u, v), diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    }
    let (_, solution) = solve(&scene, &RadiositySettings { gather_rays: 1024, ..settings(0.05) });
    let [(there, a), (back, b)] = [(0, 1), (1, 0)].map(|(from, to)| form_factor(&solution, from, to));
    println!("plates: F {there:.5} and {back:.5}, {:+.3} %", 100.0 * (there * a / (back * b) - 1.0));
    assert!((there * a / (back * b) - 1.0).abs() < 0.005, "{} and {}", there * a, back * b);
}

#[test]
fn energy_received_is_energy_absorbed_in_a_closed_room() {
    // 1 %: the transport is sampled, not made symmetric.
    let (world, solution) = solve(&room(), &settings(0.1));
    let energy = solution.energy(&world);
    assert!((energy.absorbed_flux / energy.direct_flux - 1.0).abs() < 0.01, "{energy:?}");
    assert!(energy.indirect_flux > 0.0);
}

#[test]
fn rows_of_the_transport_sum_to_one_in_a_closed_room() {
    let mut scene = Scene::default();
    let wall = diffuse("wall", Vec3::splat(0.5), Vec3::ZERO);
    add(&mut scene, "room", cuboid(Vec3::ZERO, Vec3::new(2.0, 2.4, 3.0), true), wall.clone());
    add(&mut scene, "block", cuboid(Vec3::new(0.5, 0.7, 0.5), Vec3::new(0.9, 1.3, 0.9), false), wall);
    let (_, solution) = solve(&scene, &settings(0.1));
    let sums = solution.transport().gather(&vec![Vec3::ONE; solution.elements().len()]);
    let worst = solved(&solution).map(|i| (sums[i] - 1.0).abs().max_element()).fold(0.0, f32::max);
    println!("rows sum to 1 within {:.1e}", worst);
    assert!(worst <= 0.005, "{worst}");
}

#[test]
fn the_floor_beneath_the_top_of_a_desk_that_is_one_sheet_is_counted() {
    // The lamp stands beneath the sheet, whose black back takes what it is sent; all else arrives on the room. 2 %:
    // trapezoids over the floor 0.3 m below the lamp on elements of 0.1 m.
    let mut scene = Scene::default();
    let grey = diffuse("grey", Vec3::splat(0.5), Vec3::ZERO);
    add(&mut scene, "room", cuboid(Vec3::ZERO, Vec3::new(2.0, 2.4, 3.0), true), grey.clone());
    let top = rectangle(Vec3::new(0.4, 0.7, 1.1), Vec3::Z * 0.8, Vec3::X * 1.2);
    add(&mut scene, "top", top, grey);
    let lamp = Vec3::new(1.0, 0.3, 1.5);
    add_point_lamp(&mut scene, lamp, Vec3::splat(10.0));
    let (world, solution) = solve(&scene, &settings(0.1));
    let back: f64 = (12..14).map(|t| solid_angle(world.geometry.positions[t].map(|p| p - lamp))).sum();
    let (wanted, energy) = (10.0 * (2.0 * std::f64::consts::TAU - back), solution.energy(&world));
    println!("{:.1} lm of {wanted:.1}", energy.direct_flux);
    assert!((energy.direct_flux / wanted - 1.0).abs() < 0.02, "{energy:?} for {wanted}");
}

#[test]
fn a_triangular_floor_under_a_slab_stays_dark() {
    // Its nodes are buried and those outside the triangle have nobody to take light from.
    let mut scene = Scene::default();
    let grey = diffuse("grey", Vec3::splat(0.5), Vec3::ZERO);
    let mut floor = rectangle(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0);
    floor.triangles.truncate(1);
    add(&mut scene, "floor", floor, grey.clone());
    add(&mut scene, "slab", cuboid(Vec3::new(-1.0, 0.001, -1.0), Vec3::new(4.0, 0.5, 4.0), false), grey);
    add_point_lamp(&mut scene, Vec3::new(1.0, 2.0, 1.0), Vec3::splat(100.0));
    let (_, solution) = solve(&scene, &settings(0.2));
    let on_floor: Vec<usize> =
        (0..solution.elements().len()).filter(|&i| solution.elements()[i].object == 0).collect();
    let (unsolved, buried): (Vec<usize>, Vec<usize>) =
        on_floor.iter().partition(|&&i| solution.elements()[i].flags & UNSOLVED != 0);
    assert!(unsolved.len() > 20 && buried.len() > 20, "{} {}", unsolved.len(), buried.len());
    assert!(buried.iter().all(|&i| solution.elements()[i].flags & BURIED != 0));
    assert!(on_floor.iter().all(|&i| total(&solution, i) == Vec3::ZERO));
}
