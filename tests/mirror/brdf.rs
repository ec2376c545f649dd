//! Lobes against quadrature, and the path tracer that follows them against a second estimator.

use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{part::Part, random::r2_point},
    measure::significance::z_test,
    reference::{brute::irradiance_brute, irradiance::irradiance, radiance::radiance},
    scene::{
        Scene,
        accel::Ray,
        brdf::{Brdf, Lobe, LobeShape, Specular},
        direct::Receiver,
        fresnel,
        material::Material,
        world::World,
    },
};
use lumenscope_tests::{add, add_point_lamp, cuboid, rectangle};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

const LOBES: [Lobe; 7] = [
    Lobe::Ggx { alpha: 0.04 },
    Lobe::Ggx { alpha: 0.16 },
    Lobe::Ggx { alpha: 1.0 },
    Lobe::Phong { exponent: 0.0 },
    Lobe::Phong { exponent: 20.0 },
    Lobe::Phong { exponent: 400.0 },
    // Roughness 0.05.
    Lobe::Phong { exponent: 80_000.0 },
];

fn towards(cos: f32, phi: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).sqrt();
    Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

/// ∫ g(wi) dω over the hemisphere about z, with points crowded about the mirrored direction of `wo` as the
/// lobe's own quadrature would be: spherical coordinates about it, radius by the square of a number.
fn integral(wo: Vec3, g: impl Fn(Vec3) -> f32) -> f32 {
    let axis = Vec3::new(-wo.x, -wo.y, wo.z);
    let frame = lumenscope_core::math::frame::frame_from_normal(axis);
    let (rings, spokes) = (1200, 400);
    let mut sum = 0.0f64;
    for i in 0..rings {
        let s = (i as f32 + 0.5) / rings as f32;
        let theta = PI * s * s;
        let width = 2.0 * PI * s / rings as f32;
        for j in 0..spokes {
            let (sin, cos) = (TAU * (j as f32 + 0.5) / spokes as f32).sin_cos();
            let wi = frame * Vec3::new(theta.sin() * cos, theta.sin() * sin, theta.cos());
            sum += f64::from(g(wi) * theta.sin() * width) * f64::from(TAU) / f64::from(spokes);
        }
    }
    sum as f32
}

#[test]
fn densities_integrate_to_one_but_for_what_falls_below_the_surface() {
    for lobe in LOBES {
        for cos in [1.0, 0.7, 0.3] {
            let wo = towards(cos, 0.4);
            let inside = integral(wo, |wi| lobe.density(Vec3::Z, wi, wo));
            let n = 40_000;
            let kept = (0..n).filter(|&i| lobe.sample(Vec3::Z, wo, r2_point(i, 7)).is_some()).count();
            let share = kept as f32 / n as f32;
            // Quadrature of a kink at the horizon, and 1/√n of a well-spread sequence.
            assert!((inside - share).abs() < 4e-3, "{lobe:?} at {cos}: {inside} of {share}");
            if let (Lobe::Ggx { alpha }, 1.0) = (lobe, cos) {
                // Normals more than 45° off send the view below the horizon: their share is α² / (1 + α²).
                let wanted = 1.0 / (1.0 + alpha * alpha);
                assert!((inside - wanted).abs() < 1e-3, "{alpha}: {inside} for {wanted}");
            }
        }
    }
}

#[test]
fn samples_are_distributed_as_the_density_says() {
    // The mean of any function over the samples is its integral times the density.
    let test = |wi: Vec3| 1.0 + wi.x + 0.5 * wi.y * wi.z;
    for lobe in LOBES {
        for cos in [0.9, 0.4] {
            let wo = towards(cos, 1.1);
            let wanted = integral(wo, |wi| test(wi) * lobe.density(Vec3::Z, wi, wo));
            let n = 60_000;
            let sum: f32 = (0..n).filter_map(|i| lobe.sample(Vec3::Z, wo, r2_point(i, 3))).map(test).sum();
            assert!((sum / n as f32 - wanted).abs() < 5e-3, "{lobe:?}: {} for {wanted}", sum / n as f32);
        }
    }
}

#[test]
fn lobes_are_reciprocal_and_reflect_no_more_than_arrives() {
    for lobe in LOBES {
        for i in 0..200 {
            let [a, b] = [1, 2].map(|k| r2_point(i, k));
            let [wi, wo] = [a, b].map(|u: Vec2| towards(0.02 + 0.98 * u.x, TAU * u.y));
            let [ab, ba] = [lobe.value(Vec3::Z, wi, wo), lobe.value(Vec3::Z, wo, wi)];
            assert!((ab - ba).abs() <= 2e-3 * ab.max(ba) + 1e-6, "{lobe:?}: {ab} {ba}");
        }
        for cos in [1.0, 0.8, 0.5, 0.2, 0.1] {
            let wo = towards(cos, 0.0);
            let reflected = integral(wo, |wi| lobe.value(Vec3::Z, wi, wo) * wi.z.max(0.0));
            assert!(reflected <= 1.001, "{lobe:?} at {cos} reflects {reflected}");
            // Smooth microfacets lose next to nothing by bouncing twice.
            if lobe == (Lobe::Ggx { alpha: 0.04 }) && cos > 0.4 {
                assert!(reflected > 0.995, "{reflected}");
            }
        }
    }
}

#[test]
fn lobes_of_a_width_are_as_wide_and_phongs_keeps_as_much_as_its_cosine() {
    for alpha in [0.0025f32, 0.01, 0.04, 0.16, 1.0] {
        let [ggx, phong] = [LobeShape::Ggx, LobeShape::Phong].map(|shape| Lobe::new(shape, alpha));
        assert!((phong.alpha() / alpha - 1.0).abs() < 1e-5 && ggx.alpha() == alpha);
        // Peaks along the normal: 1 / (4 π α²) and (n + 2) / 2π = (1 / (2 α²) + 3/2) / 2π.
        let [a, b] = [ggx, phong].map(|lobe| lobe.value(Vec3::Z, Vec3::Z, Vec3::Z));
        let wanted = 0.25 / (PI * alpha * alpha);
        assert!((a / wanted - 1.0).abs() < 1e-3 && ((b - 1.5 / TAU) / wanted - 1.0).abs() < 1e-3, "{a} {b}");
        for cos in [1.0f32, 0.7, 0.5] {
            let wo = towards(cos, 0.3);
            let reflected = integral(wo, |wi| phong.value(Vec3::Z, wi, wo) * wi.z.max(0.0));
            let specular = Specular { shape: LobeShape::Phong, ..specular(1.0, alpha) };
            let kept = specular.of_uniform_light(cos) / specular.reflectance(cos);
            assert!((kept - cos).abs().max_element() < 1e-6);
            // Where the horizon does not cut the lobe, four of its widths of 2α off.
            if 8.0 * alpha < (0.5 * PI - cos.acos()).max(1e-3) {
                assert!((reflected - cos).abs() < 1e-3, "α {alpha} at {cos}: {reflected}");
            }
        }
    }
}

fn specular(metallic: f32, alpha: f32) -> Specular {
    Specular { metal: Vec3::new(0.63, 0.56, 0.37), metallic, dielectric: 0.04, alpha, ..Specular::default() }
}

#[test]
fn a_white_furnace_gives_back_the_albedo_however_it_is_sampled() {
    let (ggx, phong) = (LobeShape::Ggx, LobeShape::Phong);
    for (shape, metallic, alpha) in [
        (ggx, 1.0, 0.0),
        (ggx, 1.0, 0.1),
        (ggx, 0.0, 0.04),
        (ggx, 0.5, 0.16),
        (phong, 1.0, 0.0),
        (phong, 1.0, 0.1),
        (phong, 0.5, 0.16),
    ] {
        let specular = Specular { shape, ..specular(metallic, alpha) };
        let coat = 1.0 - fresnel::hemispherical(0.04);
        let diffuse = Vec3::new(0.9, 0.5, 0.1) * ((1.0 - metallic) * coat);
        let brdf = Brdf { diffuse, specular: Some(specular), glass: None };
        for cos in [0.95, 0.5] {
            let wo = towards(cos, 0.3);
            let lobe = if alpha == 0.0 {
                specular.reflectance(cos)
            } else {
                Vec3::from_array(std::array::from_fn(|c| {
                    integral(wo, |wi| brdf.value(Vec3::Z, wi, wo)[1][c] * wi.z.max(0.0))
                }))
            };
            let n = 60_000;
            let mut found = [Vec3::ZERO; 2];
            for i in 0..n {
                let pick = lumenscope_core::math::random::unit_f32(2_654_435_769u32.wrapping_mul(i));
                let Some(s) = brdf.sample(Vec3::Z, wo, pick, r2_point(i, 5)) else { continue };
                found = [found[0] + s.diffuse / n as f32, found[1] + s.specular / n as f32];
            }
            let errors = [(found[0] - diffuse).abs(), (found[1] - lobe).abs()].map(Vec3::max_element);
            assert!(errors.iter().all(|e| *e < 8e-3), "{specular:?} {cos}: {errors:?}");
        }
    }
}

#[test]
fn uniform_light_is_never_made_more() {
    // Hemispherical mean of what a coated white surface reflects: 2 ∫ (ρ + F(θ)) cos θ sin θ dθ.
    for (metallic, base) in [(0.0, 0.999), (0.5, 0.999), (1.0, 0.9), (0.2, 0.5)] {
        let material =
            Material { reflectance: Vec3::splat(base), metallic, roughness: 0.0, ..Material::default() };
        let brdf = material.brdf_at(Vec2::ZERO, &[]);
        let n = 4000;
        let lobe: f32 = (0..n)
            .map(|i| brdf.specular.unwrap().reflectance(((i as f32 + 0.5) / n as f32).sqrt()).x / n as f32)
            .sum();
        assert!(brdf.diffuse.x + lobe <= 1.0, "{}", brdf.diffuse.x + lobe);
    }
    let rough = Material { metallic: 1.0, roughness: 0.6, ..Material::default() };
    assert_eq!(rough.brdf_at(Vec2::ZERO, &[]), Brdf { diffuse: rough.reflectance, ..Brdf::default() });
}

/// A closed box of glossy walls that emit, with a glossy block and a dark panel in it. Not one small lamp: what
/// the second estimator finds of that by chance has no variance worth the name.
fn glossy_room(lobe_shape: LobeShape, roughness: f32) -> Scene {
    let mut scene = Scene::default();
    let base = Vec3::new(0.3, 0.2, 0.1);
    let glossy = Material { reflectance: base, metallic: 0.6, roughness, lobe_shape, ..Material::default() };
    let walls = Material { emission: Vec3::new(1.0, 2.0, 3.0), ..glossy.clone() };
    add(&mut scene, "walls", cuboid(Vec3::splat(-1.0), Vec3::ONE, true), walls);
    add(&mut scene, "block", cuboid(Vec3::new(-0.3, -1.0, -0.5), Vec3::new(0.4, 0.1, 0.2), false), glossy);
    let panel = rectangle(Vec3::new(-0.99, -0.9, -0.9), Vec3::Y * 1.8, Vec3::Z * 1.8);
    add(&mut scene, "panel", panel, lumenscope_tests::diffuse("panel", Vec3::ZERO, Vec3::ZERO));
    scene
}

#[test]
fn two_estimators_agree_on_irradiance_among_glossy_walls() {
    for shape in [LobeShape::Ggx, LobeShape::Phong] {
        let world = World::new(&glossy_room(shape, 0.45));
        let receivers: Vec<_> = (0..12)
            .map(|i| {
                let triangle = i % 12;
                let inwards = -world.geometry.area_normal(triangle).normalize();
                Receiver::of(&world.geometry.surface(triangle, 0.5 * r2_point(i, 9), inwards))
            })
            .collect();
        let [found, wanted] = [false, true].map(|brute| {
            let estimate = |(i, r): (usize, &Receiver)| {
                if brute {
                    irradiance_brute(&world, r, Part::All, 150_000, i as u64)
                } else {
                    irradiance(&world, r, Part::All, 8_000, 100 + i as u64)
                }
            };
            receivers.par_iter().enumerate().map(estimate).collect::<Vec<_>>()
        });
        let test = z_test(&found, &wanted, 0.01).unwrap();
        println!("{shape:?}: {test:?}");
        assert!(test.passes(), "{shape:?}: {test:?}");
    }
}

#[test]
fn an_emitter_in_an_ideal_mirror_is_its_radiance_times_fresnel() {
    let mut scene = Scene::default();
    let gold = Vec3::new(0.63, 0.56, 0.37);
    let material = Material { reflectance: gold, metallic: 1.0, roughness: 0.0, ..Material::default() };
    add(&mut scene, "mirror", rectangle(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0), material);
    let panel = rectangle(Vec3::new(-50.0, 3.0, -50.0), Vec3::X * 100.0, Vec3::Z * 100.0);
    let emission = Vec3::new(10.0, 20.0, 30.0);
    add(&mut scene, "panel", panel, lumenscope_tests::diffuse("panel", Vec3::ZERO, emission));
    let world = World::new(&scene);
    for angle in [0.0f32, 0.6, 1.2, 1.4] {
        let direction = Vec3::new(angle.sin(), -angle.cos(), 0.0);
        let found = radiance(&world, &Ray::new(-direction, direction), 256, 1);
        let wanted = emission * fresnel::reflectance_rgb(gold, angle.cos());
        assert!((found.mean - wanted).abs().max_element() < 1e-4 * 30.0, "{found:?} for {wanted}");
    }
}

#[test]
fn a_lamp_over_a_glossy_floor_is_its_closed_form() {
    for lobe_shape in [LobeShape::Ggx, LobeShape::Phong] {
        let mut scene = Scene::default();
        let material = Material { metallic: 1.0, roughness: 0.4, lobe_shape, ..Material::default() };
        let floor = rectangle(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
        add(&mut scene, "floor", floor, material.clone());
        let lamp = Vec3::new(1.0, 2.0, 0.0);
        add_point_lamp(&mut scene, lamp, Vec3::splat(100.0));
        let world = World::new(&scene);
        let eye = Vec3::new(-1.0, 1.5, 0.4);
        let (wi, wo) = (lamp.normalize(), eye.normalize());
        let found = radiance(&world, &Ray::new(eye, -wo), 64, 1).mean;
        let f = material.brdf_at(Vec2::ZERO, &[]).value(Vec3::Y, wi, wo)[1];
        let wanted = f * (100.0 * wi.y / lamp.length_squared());
        assert!((found - wanted).abs().max_element() < 1e-4 * wanted.x, "{found} for {wanted}");
    }
}
