//! The compact basis against closed forms and against the bins.

use super::*;
use lumenscope_core::{
    irradiance_volume::{
        Basis,
        codec::{Texel, encode_rgb},
        harmonics::{Coefficients, Projection},
        moments::Order,
    },
    math::spherical_harmonics::{BAND, CLAMPED_COSINE, basis},
};

fn texels(bins: DirectionBins, of: impl Fn(Vec3) -> f32) -> Vec<Texel> {
    (0..bins.len()).map(|b| encode_rgb(Vec3::splat(of(bins.centre(b))))).collect()
}

fn evaluated(coefficients: &[Vec3; 9], normal: Vec3) -> f32 {
    coefficients.iter().zip(basis(normal)).map(|(c, y)| c.x * y).sum()
}

#[test]
fn what_nine_functions_can_hold_they_hold_at_any_number_of_bins() {
    for n in [3, 9, 17, 29] {
        let bins = DirectionBins::new(n);
        let light = |d: Vec3| 5.0 + 2.0 * d.x - d.y + 0.5 * d.x * d.z + 1.5 * d.y * d.y;
        let coefficients = Projection::new(bins).project(&texels(bins, light));
        for i in 0..200 {
            let d = uniform_direction(Rng::new(11, i).next_vec2());
            // 4.9e-4 of the codec at the largest value, 8.5.
            assert!((evaluated(&coefficients, d) - light(d)).abs() < 5e-3, "n = {n} towards {d}");
        }
    }
    for n in [1, 2] {
        let bins = DirectionBins::new(n);
        let coefficients = Projection::new(bins).project(&texels(bins, |_| 3.0));
        assert!((evaluated(&coefficients, Vec3::new(0.6, 0.0, 0.8)) - 3.0).abs() < 5e-3, "n = {n}");
    }
}

#[test]
fn a_far_lamp_has_the_coefficients_of_the_clamped_cosine() {
    // E(n) = max(0, n·d) is a delta of radiance towards d, so E_lm = Â_l Y_lm(d) (Ramamoorthi and Hanrahan).
    for n in [17u32, 49] {
        let bins = DirectionBins::new(n);
        // The mid-point rule over a kink: its error falls with the square of a bin's width.
        let tolerance = 6e-3 * (17.0 / n as f32).powi(2) + 5e-4;
        for d in [Vec3::Y, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, -0.6, 0.64)] {
            let coefficients = Projection::new(bins).project(&texels(bins, |n| n.dot(d).max(0.0)));
            for (i, y) in basis(d).into_iter().enumerate() {
                let exact = CLAMPED_COSINE[BAND[i]] * y;
                assert!((coefficients[i].x - exact).abs() < tolerance, "{i}: {coefficients:?} for {exact}");
            }
            // The Legendre series of max(0, x) to band 2 is 1/4 + x/2 + 5/32 (3x² − 1): 1/16 too much at x = 1,
            // and 1/16 where the cosine is 0 behind the lamp's back.
            assert!((evaluated(&coefficients, d) - 1.0625).abs() < tolerance);
            assert!((evaluated(&coefficients, -d) - 0.0625).abs() < tolerance);
        }
    }
}

#[test]
fn coefficients_come_back() {
    let c: [Vec3; 9] = std::array::from_fn(|i| Vec3::new(i as f32, 10.0 + i as f32, -(i as f32)));
    for (a, b) in Coefficients::new(c).get().iter().zip(c) {
        assert!((*a - b).abs().max_element() < 1e-5, "{a} for {b}");
    }
}

#[test]
fn constant_radiance_reads_pi_l_in_every_basis() {
    let scene = room([Vec3::ZERO; 6]);
    let light = PerTriangle(vec![Vec3::splat(PI * 7.0); 12]);
    let volume = build(&scene, &light, &small([3, 3, 4]));
    for basis in Basis::ALL {
        let volume = volume.with_basis(basis);
        for i in 0..500 {
            let mut rng = Rng::new(1, i);
            let p = Vec3::new(rng.next_f32() * 3.0, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
            let e = volume.irradiance(p, uniform_direction(rng.next_vec2()), Part::All);
            // 4.9e-4 of the codec and the rounding of sums.
            assert!((e / (PI * 7.0) - Vec3::ONE).abs().max_element() < 6e-4, "{basis:?}: {e}");
        }
    }
}

#[test]
fn a_batch_gives_what_single_queries_give_and_parts_add_up() {
    let (scene, light) = furnished();
    let volume = build(&scene, &light, &small([5, 4, 6]));
    let queries: Vec<(Vec3, Vec3)> = (0..3000)
        .map(|i| {
            let mut rng = Rng::new(8, i);
            let p = Vec3::new(rng.next_f32() * 3.4 - 0.2, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
            (p, uniform_direction(rng.next_vec2()))
        })
        .collect();
    let mut out = vec![Vec3::ZERO; queries.len()];
    for basis in Basis::ALL {
        let volume = volume.with_basis(basis);
        for part in [Part::Direct, Part::Indirect, Part::All] {
            volume.irradiance_batch(&queries, part, &mut out);
            for ((p, n), e) in queries.iter().zip(&out) {
                assert_eq!(*e, volume.irradiance(*p, *n, part));
            }
            volume.irradiance_many(&queries, part, &mut out);
            assert_eq!(out[2500], volume.irradiance(queries[2500].0, queries[2500].1, part));
        }
    }
    for p in [Vec3::NAN, Vec3::INFINITY, Vec3::splat(1e30)] {
        for n in [Vec3::NAN, Vec3::ZERO, Vec3::splat(f32::INFINITY)] {
            assert!(volume.irradiance_harmonics(p, n, Part::All).is_finite(), "{p} {n}");
        }
    }
}

#[test]
fn each_basis_is_as_close_as_it_should_be() {
    let (scene, light) = furnished();
    let volume = build(&scene, &light, &small([5, 4, 6]));
    for part in [Part::Indirect, Part::All] {
        let errors = volume.compare_bases(&World::new(&scene), &light, part, 200, 40);
        for e in &errors {
            eprintln!("{part:?}, {e}");
        }
        let [bins, nearest, harmonics] = errors[..] else { panic!("three bases") };
        // Bins 0.15 rad apart: bilinear errs by 0.15²/8 of a cosine, the nearest by up to 0.08 of its flank;
        // nine functions leave out band 4, π/24 of what a lamp sends.
        assert!(bins.median < 0.004 && nearest.median < 0.03 && harmonics.median < 0.03);
        assert!(bins.percentile_95 < nearest.percentile_95 && bins.median < harmonics.median);
        assert!(bins.mean_signed.abs() < 0.002 && harmonics.mean_signed.abs() < 0.01);
        assert_eq!(harmonics.bytes, 128 * volume.samples().len());
    }
    let view = VolumeView::default();
    let scene = volume.basis_scene(&World::new(&scene), &light, &view).unwrap();
    assert_eq!(scene.spheres.len() * scene.bins.unwrap().len(), scene.sphere_bins.len());
    // What is shown is about what the words say: its 98 directions lie elsewhere between the bins' centres
    // than random ones, so the medians are alike and not the same.
    let median = volume.compare_bases(&World::new(&furnished().0), &light, Part::All, 400, 40)[0].median;
    let mut shown: Vec<f32> = scene.sphere_bins.iter().map(|e| 0.01 * e.x).collect();
    shown.sort_by(f32::total_cmp);
    let shown = shown[shown.len() / 2];
    assert!((0.5..2.0).contains(&(shown / median)), "{shown} {median}");
}

#[test]
fn both_parts_at_once_are_each_alone() {
    let (scene, light) = furnished();
    let settings = VolumeSettings { guard: true, moments: vec![Order::Finite(10)], ..small([5, 4, 5]) };
    let volume = build(&scene, &light, &settings);
    for i in 0..500 {
        let mut rng = Rng::new(6, i);
        let p = Vec3::new(rng.next_f32() * 3.0, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
        let n = uniform_direction(rng.next_vec2());
        let parts = [Part::Direct, Part::Indirect];
        for basis in Basis::ALL {
            let volume = volume.with_basis(basis);
            assert_eq!(volume.irradiance_parts(p, n), parts.map(|part| volume.irradiance(p, n, part)));
        }
        let order = Order::Finite(10);
        let alone = parts.map(|part| volume.moment(p, n, order, part).unwrap());
        assert_eq!(volume.moment_parts(p, n, order), Some(alone));
    }
    assert!(volume.moment_parts(Vec3::ONE, Vec3::Y, Order::Finite(3)).is_none());
}
