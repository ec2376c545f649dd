//! Tests of the path tracer: closed forms, an independent estimator, honest errors, equal bytes.

use glam::{Affine3A, DVec3, Vec3};
use lumenscope_core::{
    math::{
        colour::luminance, frame::uniform_direction, image::LinearImage, part::Part, progress::Progress,
        random::Rng,
    },
    measure::significance::{critical_value, z_test},
    reference::{
        Estimate, brute::irradiance_brute, irradiance::irradiance, picture::ReferencePicture,
        radiance::radiance,
    },
    scene::{Scene, accel::Ray, direct::Receiver, lamp::LampKind, mesh::Mesh, world::World},
};
use lumenscope_tests::{
    add, add_point_lamp, box_room, cornell, diffuse,
    golden::{self, Truth},
    rectangle,
};
use rayon::prelude::*;
use std::{f32::consts::PI, sync::Arc};

/// Chance of a false alarm that each test below allows itself; the seeds are fixed, so it is spent once.
const FALSE_ALARM: f64 = 0.01;

/// An estimate that is exact.
fn exactly(mean: Vec3) -> Estimate {
    Estimate { mean, standard_error: Vec3::ZERO, degrees_of_freedom: 0 }
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
            Receiver::of(&world.geometry.surface(triangle, bary, inwards))
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
    for (reflectance, samples) in [(0.5, 4096), (0.9, 4096), (0.99, 1024), (0.999, 128)] {
        let world = World::new(&box_room(reflectance, 3.0));
        let wanted = exactly(Vec3::splat(3.0 / (1.0 - reflectance)));
        let found: Vec<Estimate> = (0..16u64)
            .into_par_iter()
            .map(|i| {
                let mut rng = Rng::new(5, i);
                let origin = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) - Vec3::splat(0.5);
                let ray = Ray::new(origin, uniform_direction(rng.next_vec2()));
                radiance(&world, &ray, samples, i)
            })
            .collect();
        let test = z_test(&found, &vec![wanted; found.len()], FALSE_ALARM).unwrap();
        assert!(test.passes(), "reflectance {reflectance}: {test:?}");
        // The mean over all rays is four times as sharp and catches what a single one cannot.
        let n = found.len() as f64;
        let mean = found.iter().map(|e| f64::from(e.mean.x)).sum::<f64>() / n;
        let error = found.iter().map(|e| f64::from(e.standard_error.x).powi(2)).sum::<f64>().sqrt() / n;
        let z = (mean - f64::from(wanted.mean.x)) / error;
        println!(
            "reflectance {reflectance}: mean {mean:.4} ± {error:.4}, wanted {:.4}, z {z:.2}",
            wanted.mean.x
        );
        assert!(z.abs() < critical_value(FALSE_ALARM, 4, 1000), "reflectance {reflectance}: z {z:.1}");
    }
}

#[test]
fn spot_and_directional_lamps_give_their_closed_forms() {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
    add(&mut scene, "floor", floor, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    let lamp = add_point_lamp(&mut scene, Vec3::Y * 2.0, Vec3::ONE);
    let downwards = Affine3A::from_rotation_x(-0.5 * PI);
    scene.lamps[lamp].world_from_lamp = Affine3A::from_translation(Vec3::Y * 2.0) * downwards;
    let intensity = Vec3::new(100.0, 80.0, 30.0);
    let (inner, outer) = (0.3f32, 0.6f32);
    scene.lamps[lamp].kind = LampKind::Spot { intensity, inner_angle: inner, outer_angle: outer };
    let at = |scene: &Scene, x: f32| {
        irradiance(&World::new(scene), &Receiver::new(Vec3::X * x, Vec3::Y), Part::All, 4, 1).mean
    };
    for angle in [0.0f32, 0.29, 0.4, 0.55, 0.61] {
        // I cos³θ / h² under the lamp, times the falloff t² of glTF's extension between the two cones.
        let t = ((angle.cos() - outer.cos()) / (inner.cos() - outer.cos())).clamp(0.0, 1.0);
        let wanted = intensity * (angle.cos().powi(3) / 4.0 * t * t);
        let found = at(&scene, 2.0 * angle.tan());
        // Single precision: differences of cosines lose two digits at the edge of the cone.
        assert!((found - wanted).abs().max_element() <= 1e-5 * intensity.x, "{angle}: {found} for {wanted}");
    }
    scene.lamps[lamp].kind = LampKind::Directional { illuminance: intensity };
    scene.lamps[lamp].world_from_lamp = Affine3A::from_rotation_x(-0.25 * PI);
    let wanted = intensity * 0.5f32.sqrt();
    assert!((at(&scene, 1.0) - wanted).abs().max_element() <= 1e-6 * intensity.x, "{}", at(&scene, 1.0));
    // And nothing behind what stands in the way, however far.
    let roof = rectangle(Vec3::new(-50.0, 30.0, -50.0), Vec3::X * 100.0, Vec3::Z * 100.0);
    add(&mut scene, "roof", roof, diffuse("roof", Vec3::ZERO, Vec3::ZERO));
    assert_eq!(at(&scene, 1.0), Vec3::ZERO);
}

#[test]
fn next_event_estimation_agrees_with_blind_search_for_light() {
    let cases = [
        ("wide panel", wide_panel(), [Part::Direct, Part::Indirect].as_slice()),
        ("many panels", many_panels(), &[Part::All]),
        ("textured panel", textured_panel(), &[Part::Direct]),
    ];
    for (name, scene, parts) in cases {
        let world = World::new(&scene);
        let receivers = surface_receivers(&world, 100, 11);
        for &part in parts {
            let pairs: Vec<(Estimate, Estimate)> = receivers
                .par_iter()
                .enumerate()
                .map(|(i, r)| {
                    let seed = i as u64;
                    (irradiance(&world, r, part, 4096, seed), irradiance_brute(&world, r, part, 32_768, seed))
                })
                .collect();
            // Where light comes from a sliver of the sphere the blind search hits it so rarely that its mean
            // is far from normal: such points prove nothing and are left out.
            let mean = pairs.iter().map(|p| p.0.mean.y).sum::<f32>() / pairs.len() as f32;
            let (found, brute): (Vec<_>, Vec<_>) =
                pairs.into_iter().filter(|p| p.0.mean.y > 0.1 * mean).unzip();
            assert!(found.len() >= 50, "{name} {part:?}: {} points are lit", found.len());
            let test = z_test(&found, &brute, FALSE_ALARM).unwrap();
            println!("{name} {part:?}: {test:?}");
            assert!(test.passes(), "{name} {part:?}: {test:?}");
            // z has mean 0; its three channels are one and the same number of independent values.
            let limit = critical_value(FALSE_ALARM, 3, u32::MAX) / (found.len() as f64).sqrt();
            assert!(test.mean.abs() < limit, "{name} {part:?}: biased, {test:?}");
        }
    }
}

/// The box under a panel so large that a blind search finds it often.
fn wide_panel() -> Scene {
    let mut scene = cornell();
    let panel = rectangle(Vec3::new(-0.8, 1.95, -0.8), Vec3::X * 1.6, Vec3::Z * 1.6);
    scene.meshes[3] = Arc::new(panel);
    scene
}

/// The wide panel under a picture of four colours, one of them black.
fn textured_panel() -> Scene {
    let mut scene = wide_panel();
    let colours = [Vec3::X, Vec3::ONE, Vec3::ZERO, Vec3::new(0.1, 0.5, 1.0)];
    scene.textures.push(Arc::new(LinearImage { width: 2, height: 2, pixels: colours.to_vec() }));
    scene.materials[3].emission_texture = Some(0);
    scene
}

/// More panels than the first vertex samples one by one, some two-sided, the others shining upwards or down.
fn many_panels() -> Scene {
    let mut scene = wide_panel();
    for i in 0..10 {
        let x = -0.95 + 0.19 * i as f32;
        let panel = rectangle(Vec3::new(x, 1.6, -0.4), Vec3::X * 0.15, Vec3::new(0.0, 0.1, 0.8));
        let mut material = diffuse("strip", Vec3::splat(0.3), Vec3::new(20.0, 10.0 * i as f32, 200.0));
        material.double_sided = i % 2 == 0;
        let panel = if i % 4 == 1 { flipped(panel) } else { panel };
        add(&mut scene, "strip", panel, material);
    }
    scene
}

/// The same surface with its front on the other side.
fn flipped(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh
}

#[test]
fn black_backs_neither_emit_nor_reflect() {
    let mut scene = Scene::default();
    let up = rectangle(Vec3::new(-1.0, 1.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    add(&mut scene, "panel facing up", up, diffuse("panel", Vec3::splat(0.8), Vec3::splat(50.0)));
    let floor = rectangle(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    add(&mut scene, "floor", floor, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    let below = Receiver::new(Vec3::ZERO, Vec3::Y);
    let above = Receiver::new(Vec3::new(0.0, 2.0, 0.0), Vec3::NEG_Y);
    let world = World::new(&scene);
    assert_eq!(irradiance(&world, &below, Part::All, 256, 3).mean, Vec3::ZERO);
    assert_eq!(irradiance_brute(&world, &below, Part::All, 256, 3).mean, Vec3::ZERO);
    assert!(irradiance(&world, &above, Part::Direct, 256, 3).mean.x > 10.0);
    scene.materials[0].double_sided = true;
    assert!(irradiance(&World::new(&scene), &below, Part::All, 256, 3).mean.x > 10.0);
}

#[test]
fn standard_errors_are_the_spread_over_seeds() {
    let world = World::new(&cornell());
    for receiver in surface_receivers(&world, 4, 21) {
        let estimates: Vec<Estimate> =
            (0..256u64).into_par_iter().map(|s| irradiance(&world, &receiver, Part::All, 256, s)).collect();
        let means: Vec<DVec3> = estimates.iter().map(|e| e.mean.as_dvec3()).collect();
        let reported = estimates.iter().map(|e| f64::from(e.standard_error.x).powi(2)).sum::<f64>() / 256.0;
        let spread = 16.0 * f64::from(Estimate::from_values(&means).standard_error.x);
        let ratio = reported.sqrt() / spread;
        println!("reported {:.4} lx, spread {spread:.4} lx", reported.sqrt());
        // The spread of 256 values is known to 1/√512 = 4.4 %, more for long tails: allow 25 %.
        assert!((ratio - 1.0).abs() < 0.25, "reported {:.4}, spread {spread:.4} lx", reported.sqrt());
    }
}

#[test]
fn picture_variance_is_the_spread_over_seeds() {
    let world = Arc::new(World::new(&cornell()));
    let pictures: Vec<ReferencePicture> = (0..64)
        .map(|seed| {
            let mut picture = ReferencePicture::new(world.clone(), cornell().camera, 8, 8, seed);
            picture.add_samples(32, &Progress::silent()).unwrap();
            picture
        })
        .collect();
    let (mut reported, mut spread) = (0.0, 0.0);
    for pixel in 0..64 {
        let values: Vec<DVec3> = pictures.iter().map(|p| p.mean().pixels[pixel].as_dvec3()).collect();
        let error = Estimate::from_values(&values).standard_error.as_dvec3() * 8.0;
        spread += (error * error).element_sum();
        reported +=
            pictures.iter().map(|p| f64::from(p.variance_of_mean().pixels[pixel].element_sum())).sum::<f64>()
                / 64.0;
    }
    let ratio = (reported / spread).sqrt();
    println!("reported standard error over spread: {ratio:.3}");
    // 64 pixels times 63 degrees of freedom would be known to 1 %; a few bright edge pixels dominate.
    assert!((ratio - 1.0).abs() < 0.25, "reported over spread {ratio}");
}

#[test]
fn layers_sum_to_the_picture_and_the_light_is_where_it_belongs() {
    let scene = cornell();
    let mut picture = ReferencePicture::new(Arc::new(World::new(&scene)), scene.camera, 48, 48, 7);
    picture.add_samples(16, &Progress::silent()).unwrap();
    let [emitted, direct, indirect, mirror, glossy] = picture.layers();
    for (i, mean) in picture.mean().pixels.iter().enumerate() {
        let sum = emitted.pixels[i] + direct.pixels[i] + indirect.pixels[i];
        // Three roundings of single precision.
        assert!((sum - *mean).abs().max_element() <= 4e-7 * mean.max_element(), "{sum} against {mean}");
        assert!(mean.is_finite() && mean.min_element() >= 0.0);
    }
    assert_eq!(picture.rejected(), 0);
    assert!([&mirror, &glossy].iter().all(|layer| layer.mean() == Vec3::ZERO), "nothing here has a lobe");
    let means = [&emitted, &direct, &indirect].map(|layer| layer.mean().x);
    println!("means {means:?} cd/m²");
    assert!(means.iter().all(|&m| m > 0.1), "a layer is missing: {means:?}");
    let left: f32 = (10..40).map(|y| indirect.at(8, y).x / indirect.at(8, y).y.max(1e-6)).sum::<f32>() / 30.0;
    assert!(left > 2.0, "the left wall is red: R/G {left}");
}

#[test]
fn bytes_depend_on_neither_threads_nor_calls() {
    let scene = cornell();
    let world = Arc::new(World::new(&scene));
    let run = |threads: usize, calls: &[u32]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut picture = ReferencePicture::new(world.clone(), scene.camera, 33, 17, 42);
        for &spp in calls {
            pool.install(|| picture.add_samples(spp, &Progress::silent())).unwrap();
        }
        assert_eq!(picture.samples(), calls.iter().sum::<u32>());
        (picture.mean(), picture.layers(), picture.variance_of_mean(), picture.luminance_variance_of_mean())
    };
    let one = run(1, &[7]);
    assert_eq!(one, run(2, &[7]));
    assert_eq!(one, run(2, &[1, 5, 1]));
    assert_ne!(one.0, run(1, &[6]).0, "samples must change the picture");
}

#[test]
fn a_cancelled_picture_stays_even_and_can_go_on() {
    let scene = cornell();
    let mut picture = ReferencePicture::new(Arc::new(World::new(&scene)), scene.camera, 16, 16, 1);
    picture.add_samples(4, &Progress::silent()).unwrap();
    let before = picture.mean();
    let progress = Progress::silent();
    progress.cancel();
    assert!(picture.add_samples(4, &progress).is_err());
    assert_eq!((picture.samples(), picture.mean()), (4, before));
    picture.add_samples(4, &Progress::silent()).unwrap();
    assert_eq!(picture.samples(), 8);
}

/// Irradiance at a receiver by `paths` paths, a quarter as many for the direct part.
fn truth(world: &World, receiver: &Receiver, paths: u32, seed: u64) -> Truth {
    let indirect = irradiance(world, receiver, Part::Indirect, paths, seed);
    let direct = irradiance(world, receiver, Part::Direct, paths / 4, seed + 1);
    // The channels of one estimate err together, the two parts apart.
    let error = |e: &Estimate| luminance(e.standard_error);
    Truth {
        direct: luminance(direct.mean),
        indirect: luminance(indirect.mean),
        standard_error: error(&indirect).hypot(error(&direct)),
    }
}

#[test]
fn golden_irradiance_is_what_the_tracer_finds() {
    let [office, cornell] = ["office/office.ron", "cornell/cornell.ron"].map(golden::shipped);
    let surfaces = golden::surface_points(&office, golden::POINTS);
    let sets = [
        ("surface", &office, surfaces.iter().map(Receiver::of).collect()),
        ("air", &office, golden::air_points(&office, golden::POINTS)),
        ("cornell_air", &cornell, golden::air_points(&cornell, golden::POINTS)),
    ];
    // LUMENSCOPE_GOLDEN_PATHS=65536 rewrites the files, in about ten minutes on two cores.
    let rewrite = std::env::var("LUMENSCOPE_GOLDEN_PATHS").ok().and_then(|paths| paths.parse().ok());
    for (name, world, receivers) in sets {
        let receivers: Vec<Receiver> = receivers;
        if let Some(paths) = rewrite {
            let all: Vec<Truth> =
                receivers.par_iter().enumerate().map(|(i, r)| truth(world, r, paths, 2 * i as u64)).collect();
            golden::write(name, &all);
        }
        let kept = golden::read(name);
        assert_eq!(kept.len(), golden::POINTS);
        // Every fortieth point again, from other random numbers. Rare bright paths make the mean of
        // 4096 skewed: 5 standard errors, where the normal law would give 3.7 for 25 points at 0.01.
        for i in (0..golden::POINTS).step_by(40) {
            let again = truth(world, &receivers[i], 4096, 1_000_000 + 2 * i as u64);
            let error = again.standard_error.hypot(kept[i].standard_error);
            let z = (again.all() - kept[i].all()) / error;
            assert!(z.abs() < 5.0, "{name} {i}: {} kept, {} ± {error} found", kept[i].all(), again.all());
        }
    }
}
