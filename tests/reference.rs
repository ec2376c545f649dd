//! Tests of the path tracer: closed forms, an independent estimator, honest errors, equal bytes.

use glam::{DVec3, Vec3};
use lumenscope_core::{
    math::{
        frame::{cosine_direction, frame_from_normal},
        image::LinearImage,
        part::Part,
        progress::Progress,
        random::Rng,
    },
    reference::{
        Estimate, brute::irradiance_brute, irradiance::irradiance, path::receiver_of,
        picture::ReferencePicture, radiance::radiance,
    },
    scene::{Scene, accel::Ray, direct::Receiver, world::World},
};
use lumenscope_tests::{add, add_point_lamp, box_room, cornell, diffuse, rectangle};
use rayon::prelude::*;
use std::{f32::consts::PI, sync::Arc};

/// Chance of a false alarm that each test below allows itself; the seeds are fixed, so it is spent once.
const FALSE_ALARM: f64 = 0.01;

/// Largest |z| over all values that chance allows: Šidák's correction for `count` comparisons, and
/// Student's t for a standard error that itself comes from `freedom` + 1 values (Cornish–Fisher).
fn critical_value(count: usize, freedom: u32) -> f64 {
    let each = 1.0 - (1.0 - FALSE_ALARM).powf(1.0 / count as f64);
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..200 {
        let z = 0.5 * (low + high);
        if 2.0 * normal_tail(z) > each { low = z } else { high = z }
    }
    let (z, v) = (low, f64::from(freedom));
    z + (z.powi(3) + z) / (4.0 * v) + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * v * v)
}

/// Probability that a standard normal number exceeds z > 0, by quadrature of its density.
fn normal_tail(z: f64) -> f64 {
    let steps = 4000;
    let width = 12.0 / f64::from(steps);
    (0..steps).map(|i| z + (f64::from(i) + 0.5) * width).map(|x| (-0.5 * x * x).exp() * width).sum::<f64>()
        / std::f64::consts::TAU.sqrt()
}

/// |difference| in standard errors, worst channel; single precision allows 1e-5 of the value.
fn worst_z(found: &Estimate, wanted: Vec3, wanted_error: Vec3) -> f64 {
    (0..3)
        .map(|c| {
            let floor = 1e-5 * f64::from(wanted[c].abs());
            let error = f64::from(found.standard_error[c]).hypot(f64::from(wanted_error[c]));
            (f64::from(found.mean[c] - wanted[c]).abs() - floor).max(0.0) / error.max(1e-12)
        })
        .fold(0.0, f64::max)
}

/// Points on the surfaces of a world, uniform over its triangles, front sides.
fn surface_receivers(world: &World, count: usize, seed: u64) -> Vec<Receiver> {
    (0..count as u64)
        .map(|i| {
            let mut rng = Rng::new(seed, i);
            let triangle = (rng.next_f32() * world.geometry.len() as f32) as u32;
            let u = rng.next_vec2();
            let bary = if u.x + u.y > 1.0 { glam::Vec2::ONE - u } else { u };
            let inwards = -world.geometry.area_normal(triangle).normalize();
            receiver_of(&world.geometry.surface(triangle, bary, inwards))
        })
        .collect()
}

#[test]
fn point_lamp_over_a_floor_is_i_cos_over_d_squared() {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
    add(&mut scene, "floor", floor, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    let intensity = Vec3::new(100.0, 80.0, 30.0);
    add_point_lamp(&mut scene, Vec3::new(0.5, 2.0, -0.25), intensity);
    let world = World::new(&scene);
    for (x, z) in [(0.0, 0.0), (0.5, -0.25), (3.0, 2.0), (-4.5, 4.5)] {
        let receiver = Receiver::new(Vec3::new(x, 0.0, z), Vec3::Y);
        let d2: f32 = (x - 0.5) * (x - 0.5) + 4.0 + (z + 0.25) * (z + 0.25);
        let wanted = intensity * (2.0 / d2.sqrt() / d2);
        let found = irradiance(&world, &receiver, Part::Direct, 4, 1).mean;
        // Single precision: some ten operations of 6e-8 each.
        assert!((found - wanted).abs().max_element() <= 1e-6 * wanted.x, "{found} against {wanted}");
        let indirect = irradiance(&world, &receiver, Part::Indirect, 64, 1).mean;
        assert_eq!(indirect, Vec3::ZERO, "a lone plane lights nothing");
        let seen = radiance(&world, &Ray::new(Vec3::new(x, 1.0, z), Vec3::NEG_Y), 4, 1).mean;
        assert!((seen - wanted * (0.5 / PI)).abs().max_element() <= 1e-6 * wanted.x);
    }
}

#[test]
fn furnace_radiance_is_emission_over_one_less_reflectance() {
    for (reflectance, samples) in [(0.5, 2048), (0.9, 1024), (0.99, 512), (0.999, 256)] {
        let world = World::new(&box_room(reflectance, 3.0));
        let wanted = Vec3::splat(3.0 / (1.0 - reflectance));
        let rays: Vec<Ray> = (0..16)
            .map(|i| {
                let mut rng = Rng::new(5, i);
                let origin = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) - Vec3::splat(0.5);
                Ray::new(origin, lumenscope_core::math::frame::uniform_direction(rng.next_vec2()))
            })
            .collect();
        let found: Vec<Estimate> =
            rays.par_iter().enumerate().map(|(i, ray)| radiance(&world, ray, samples, i as u64)).collect();
        let limit = critical_value(rays.len(), 63);
        for estimate in &found {
            let z = worst_z(estimate, wanted, Vec3::ZERO);
            assert!(z < limit, "reflectance {reflectance}: {estimate:?} against {wanted}, z {z:.1}");
        }
        // The mean over all rays is four times as sharp and catches what a single one cannot.
        let mean = found.iter().fold(DVec3::ZERO, |s, e| s + e.mean.as_dvec3()) / 16.0;
        let error = found.iter().map(|e| f64::from(e.standard_error.x).powi(2)).sum::<f64>().sqrt() / 16.0;
        let z = (mean.x - f64::from(wanted.x)).abs() / error;
        assert!(z < critical_value(4, 1000), "reflectance {reflectance}: mean {mean}, z {z:.1}");
        println!(
            "reflectance {reflectance}: {:.4} of wanted, ± {:.4}",
            mean.x / f64::from(wanted.x),
            error / f64::from(wanted.x)
        );
    }
}
