//! Held to the reference path tracer.

use super::solve;
use lumenscope_core::{
    math::{colour::luminance, part::Part, progress::Progress},
    radiosity::{RadiositySettings, RadiositySolution},
    reference::{self, irradiance::irradiance_with},
    scene::{direct::Receiver, geometry::Surface, world::World},
};
use lumenscope_tests::golden::{self, Errors};
use rayon::prelude::*;

/// Errors at points of surfaces that can be seen. Direct light is evaluated at the point, as the picture does.
fn compare(
    world: &World,
    solution: &RadiositySolution,
    surfaces: &[Surface],
    truths: &[(f32, f32)],
) -> Errors {
    let estimates: Vec<f32> = surfaces
        .par_iter()
        .enumerate()
        .map(|(i, s)| luminance(solution.irradiance_exact_direct(world, s, Part::All, 256, i as u32)))
        .collect();
    let found = golden::errors(&estimates, truths);
    println!("{found:?}");
    found
}

/// The project's bounds: 3 % in the median, 15 % in the 95th percentile, 1.5 % of the mean.
fn assert_within_bounds(found: &Errors) {
    assert!(found.noise < 0.03, "the reference is too noisy to tell: {found:?}");
    assert!(found.median <= 0.03 && found.high <= 0.15, "{found:?}");
    assert!(found.signed.abs() <= 0.015 && found.flux.abs() <= 0.015, "{found:?}");
}

#[test]
fn cornell_box_agrees_with_the_reference() {
    let (world, solution) = solve(&lumenscope_tests::cornell(), &RadiositySettings::default());
    let surfaces = golden::surface_points(&world, 1000);
    let tracer = reference::path::PathTracer::new(&world);
    let truths: Vec<(f32, f32)> = surfaces
        .par_iter()
        .enumerate()
        .map(|(i, s)| {
            let truth = irradiance_with(&tracer, &Receiver::of(s), Part::All, 1024, i as u64);
            (luminance(truth.mean), luminance(truth.standard_error))
        })
        .collect();
    assert_within_bounds(&compare(&world, &solution, &surfaces, &truths));
}

#[test]
fn office_agrees_with_the_reference() {
    let world = golden::shipped("office/office.ron");
    let solution =
        RadiositySolution::solve(&world, &RadiositySettings::default(), &Progress::silent()).expect("solves");
    let surfaces = golden::surface_points(&world, golden::POINTS);
    let truths: Vec<(f32, f32)> =
        golden::read("surface").iter().map(|t| (t.all(), t.standard_error)).collect();
    assert_within_bounds(&compare(&world, &solution, &surfaces, &truths));
}

#[test]
fn the_offices_balance_closes_as_elements_shrink() {
    // Beside what stands on the floor and the desks light is looked up from nodes up to a spacing away, which see more
    // of the room than the place does: a surplus that goes with the spacing. 3 %: found 2.0 and 0.9.
    let world = golden::shipped("office/office.ron");
    let surplus = [None, Some(0.05)].map(|element_spacing_m| {
        let settings = RadiositySettings { element_spacing_m, ..RadiositySettings::default() };
        let solution = RadiositySolution::solve(&world, &settings, &Progress::silent()).expect("solves");
        let energy = solution.energy(&world);
        let (spacing, balance) =
            (solution.transport().map.spacing_m, energy.absorbed_flux / energy.direct_flux);
        println!("elements {spacing:.3} m apart: absorbed over sent {balance:.4}");
        balance - 1.0
    });
    assert!(surplus.iter().all(|s| s.abs() < 0.03) && surplus[1] < 0.6 * surplus[0], "{surplus:?}");
}
