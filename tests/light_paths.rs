//! Light-path expressions: what they mean, and the light they leave.

use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{image::LinearImage, progress::Progress, random::Rng},
    measure::significance::z_test,
    reference::{
        Estimate,
        expression::{Bounces, Expression, ExpressionError},
        path::PathTracer,
        picture::ReferencePicture,
    },
    scene::{accel::Ray, camera::Camera, material::Material, world::World},
    superposition::{PassSettings, composite::DirectQuality, layers::Layer, render},
    transport::LightTransportSolution,
};
use lumenscope_tests::{add, box_room, cornell, rectangle, solved};

fn paths(text: &str) -> Expression {
    text.parse().unwrap()
}

#[test]
fn expressions_hold_the_paths_they_say() {
    let all = ["LE", "LDE", "LSE", "LDDE", "LDSE", "LSDE", "LSSE", "LDDDE", "LDDSE"];
    for (text, held) in [
        ("LE", vec!["LE"]),
        ("LDE", vec!["LDE"]),
        ("L(D|S)*SE", vec!["LSE", "LDSE", "LSSE", "LDDSE"]),
        ("L.+DE", vec!["LDDE", "LSDE", "LDDDE"]),
        ("LD{2}E|LS?E", vec!["LE", "LSE", "LDDE"]),
        ("L D* E", vec!["LE", "LDE", "LDDE", "LDDDE"]),
        ("L(D|S)*E", all.to_vec()),
    ] {
        let expression = paths(text);
        let found: Vec<_> = all.into_iter().filter(|path| expression.holds(path)).collect();
        assert_eq!(found, held, "{text}");
        assert!(!expression.holds("DE") && !expression.holds("LD") && !expression.holds("LXE"));
    }
}

#[test]
fn the_terms_that_an_expression_means_are_found() {
    for (text, terms) in [
        ("L(D|S)*E", Some([true; 4])),
        ("LE", Some([true, false, false, false])),
        ("LDE|LE", Some([true, true, false, false])),
        ("L(D|S)+DE", Some([false, false, true, false])),
        ("L(D|S)*DE", Some([false, true, true, false])),
        ("L(D|S)*SE", Some([false, false, false, true])),
        ("LD{2}E", None),
        ("LSE", None),
    ] {
        assert_eq!(paths(text).of_terms(), terms, "{text}");
    }
}

#[test]
fn what_is_no_expression_is_said_where() {
    let error = |text: &str| text.parse::<Expression>().unwrap_err();
    for (text, place) in [("L(DE", 5), ("LXE", 2), ("L)E", 2), ("LD{99}E", 3), ("L*+E", 3)] {
        match error(text) {
            ExpressionError::Syntax { place: found, .. } => assert_eq!(found, place, "{text}"),
            other => panic!("{text}: {other}"),
        }
    }
    assert!(matches!(error(""), ExpressionError::Nothing(_)));
    assert!(matches!(error("DE"), ExpressionError::Nothing(_)));
    assert!(matches!(error("L.{8}D.*E"), ExpressionError::TooLong(_)));
    // Whatever is typed, the answer comes at once and in a line.
    let nested = |n: usize| format!("L{}D{}E", "(".repeat(n), ")".repeat(n));
    assert!(nested(32).parse::<Expression>().is_ok());
    assert!(matches!(error(&nested(33)), ExpressionError::Syntax { place: 34, .. }));
    let grown = |count: &str| format!("L{}D{}E", "(".repeat(20), format!("){count}").repeat(20));
    for text in [nested(50_000), "D".repeat(100_000), grown("{16}"), grown("{16}?"), grown("|S)+(D").clone()]
    {
        assert!(error(&text).to_string().len() < 512);
    }
    assert!(matches!(error(&grown("{16}")), ExpressionError::TooLong(_)));
    assert_eq!(paths(&grown("+")).of_terms(), paths("LD+E").of_terms());
}

/// Mean and standard error of what arrives along rays from the camera by some paths, first channel.
fn mean(world: &World, camera: &Camera, paths: Option<&Expression>, rays: u64) -> [f64; 2] {
    let tracer = PathTracer::new(world);
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..rays {
        let mut rng = Rng::new(5, i);
        let ray = Ray::new(camera.eye, camera.ray_direction(rng.next_vec2(), 1.0));
        let value = f64::from(match paths {
            Some(paths) => tracer.radiance_by(&ray, paths, &mut rng).x,
            None => tracer.radiance(&ray, &mut rng).all().iter().sum::<Vec3>().x,
        });
        sum += value;
        squares += value * value;
    }
    let (n, mean) = (rays as f64, sum / rays as f64);
    [mean, ((squares / n - mean * mean).max(0.0) / n).sqrt()]
}

#[test]
fn each_bounce_in_a_furnace_is_a_power_of_the_reflectance() {
    // Walls emit L and reflect half of it: k bounces carry L / 2^k along every ray.
    let scene = box_room(0.5, 0.5);
    let (world, camera) = (World::new(&scene), scene.camera);
    let [emitted, _] = mean(&world, &camera, Some(&paths("LE")), 64);
    for bounces in 1..=4 {
        let [found, error] = mean(&world, &camera, Some(&paths(&format!("LD{{{bounces}}}E"))), 20_000);
        let exact = emitted * 0.5f64.powi(bounces);
        // Five standard errors, once in 1.7 million.
        assert!((found - exact).abs() < 5.0 * error + 1e-6, "{bounces}: {found} ± {error}, {exact}");
    }
    let [none, _] = mean(&world, &camera, Some(&paths("L(D|S)*SE")), 256);
    assert_eq!(none, 0.0, "nothing shines here");
}

#[test]
fn parts_of_the_light_sum_to_all_of_it() {
    let mut scene = cornell();
    for material in &mut scene.materials {
        (material.roughness, material.metallic) = (0.4, 0.3);
    }
    let (world, camera) = (World::new(&scene), scene.camera);
    let [all, error] = mean(&world, &camera, None, 40_000);
    let parts = ["LE", "LDE", "L(D|S)+DE", "LSE", "L(D|S)+SE"]
        .map(|p| mean(&world, &camera, Some(&paths(p)), 40_000));
    let (sum, spread) = parts.iter().fold((0.0, error * error), |(s, e), p| (s + p[0], e + p[1] * p[1]));
    println!("{all} ± {error}, parts {parts:?}");
    assert!((sum - all).abs() < 5.0 * spread.sqrt(), "{sum} against {all} ± {}", spread.sqrt());
    assert!(parts.iter().all(|p| p[0] > 0.0));
    let terms = PathTracer::new(&world)
        .radiance(&Ray::new(camera.eye, camera.ray_direction(Vec2::splat(0.5), 1.0)), &mut Rng::new(1, 1));
    assert!(terms.all().iter().all(|t| t.is_finite()));
}

#[test]
fn the_diffuse_bounces_that_are_meant_are_found() {
    for (text, counted, rest) in [
        ("LD*E", vec![true], true),
        ("LDE|LE", vec![true, true], false),
        ("LD{2}E", vec![false, false, true], false),
        ("LD{3}D*E", vec![false, false, false, true], true),
        ("L(D|S)*SE", vec![false], false),
    ] {
        assert_eq!(paths(text).bounces(), Bounces { counted, rest }, "{text}");
    }
    // Every other one: as many as are told apart.
    let every_other = paths("L(DD)*E").bounces();
    assert!(every_other.counted.iter().enumerate().all(|(k, counted)| *counted == (k % 2 == 0)));
    assert!(every_other.counted.len() > 100 && !every_other.rest);
}

#[test]
fn radiosity_shows_single_bounces_as_the_path_tracer_does() {
    let solution = solved(cornell(), 0.15);
    let camera = solution.scene.camera;
    let settings = PassSettings { direct: DirectQuality::PerPixel(16), ..PassSettings::default() };
    let shown = |text: &str| {
        let (of_paths, terms) = solution.with_paths(&paths(text)).unwrap();
        let (_, layers) = render(&of_paths, &camera, 32, 32, &settings);
        let [e, d, i, s] = terms.map(|t| f32::from(u8::from(t)));
        f64::from(layers.sum([e, d, i, s, s]).mean().x)
    };
    for text in ["LD{2}E", "LD{3}E", "LD{2}D+E", "LE|LD{3}E"] {
        let [wanted, error] = mean(&solution.world, &camera, Some(&paths(text)), 60_000);
        let found = shown(text);
        println!("{text}: {found:.4} for {wanted:.4} ± {error:.4}");
        // Radiosity's own bound, 1.5 % of the mean, and three standard errors.
        assert!(
            (found - wanted).abs() < 0.015 * wanted + 3.0 * error,
            "{text}: {found} for {wanted} ± {error}"
        );
    }
    // Bounces sum to what the solver found at once.
    let sum = ["LE", "LDE", "LD{2}E", "LD{3}E", "LD{3}D+E"].map(shown).iter().sum::<f64>();
    assert!((sum / shown("LD*E") - 1.0).abs() < 2e-3, "{sum}");
    // With something polished only the path tracer knows.
    let mut scene = cornell();
    scene.materials[1].roughness = 0.1;
    assert!(solved(scene, 0.5).with_paths(&paths("LD{2}E")).is_none());
}

/// Sides of the picture and of its blocks, pixels.
const SIDE: u32 = 32;
const BLOCK: u32 = 8;

/// Each block of a picture, mean over its pixels.
fn blocks(picture: &LinearImage) -> Vec<Vec3> {
    let across = SIDE / BLOCK;
    let mean = |b: u32| {
        let (x, y) = (b % across * BLOCK, b / across * BLOCK);
        let pixels = (0..BLOCK * BLOCK).map(|i| picture.at(x + i % BLOCK, y + i / BLOCK));
        pixels.sum::<Vec3>() / (BLOCK * BLOCK) as f32
    };
    (0..across * across).map(mean).collect()
}

/// Means and standard errors over independent pictures of the same thing.
fn estimates(pictures: &[Vec<Vec3>]) -> Vec<Estimate> {
    (0..pictures[0].len())
        .map(|b| Estimate::from_values(&pictures.iter().map(|p| p[b].as_dvec3()).collect::<Vec<_>>()))
        .collect()
}

/// Holds sums of layers of pictures to the path tracer that follows the same paths. What the solver interpolates between
/// elements is off by up to `bias` of the light, its own bound in a room.
fn hold_to_paths(solution: &LightTransportSolution, terms: &[(&str, &[Layer], f32)]) {
    const FRAMES: u64 = 24;
    let camera = solution.scene.camera;
    let frame = |seed: u64| {
        let direct = DirectQuality::PerPixel(2);
        let settings = PassSettings { direct, frame: seed as u32, jitter: true, seed };
        render(solution, &camera, SIDE, SIDE, &settings).1
    };
    let frames: Vec<_> = (1..=FRAMES).map(frame).collect();
    for &(text, layers, bias) in terms {
        let weights = Layer::ALL.map(|layer| f32::from(u8::from(layers.contains(&layer))));
        let found = estimates(&frames.iter().map(|f| blocks(&f.sum(weights))).collect::<Vec<_>>());
        let traced = (1..=FRAMES).map(|seed| {
            let picture = ReferencePicture::new(solution.world.clone(), camera, SIDE, SIDE, 1000 + seed);
            let mut picture = picture.of_paths(paths(text));
            picture.add_samples(8, &Progress::silent()).unwrap();
            blocks(&picture.mean())
        });
        let mut wanted = estimates(&traced.collect::<Vec<_>>());
        for (w, f) in wanted.iter_mut().zip(&found) {
            // Towards what was found, by as much as it may be off.
            let off = f.mean - w.mean;
            w.mean += off.clamp(-bias * w.mean, bias * w.mean);
        }
        let test = z_test(&found, &wanted, 1e-4).unwrap();
        println!("{text}: worst |z| {:.2} of {:.2}, rms {:.2}", test.worst, test.critical, test.rms);
        assert!(test.passes(), "{text}: {test:?}");
        assert!(found.iter().map(|e| e.mean.x).sum::<f32>() > 0.0, "{text} is black");
    }
}

#[test]
fn each_term_of_the_picture_is_that_of_the_path_tracer_within_noise() {
    let terms: [(&str, &[Layer], f32); 4] = [
        ("LE", &[Layer::Emitted], 0.0),
        ("LDE", &[Layer::Direct], 0.0),
        ("L(D|S)+DE", &[Layer::Indirect], 0.03),
        ("L(D|S)*E", &Layer::ALL, 0.03),
    ];
    hold_to_paths(&solved(cornell(), 0.05), &terms);
}

/// The Cornell box whose wall at the back is golden: it shows the lamp, the room, and what it throws there itself.
fn golden_wall(roughness: f32) -> LightTransportSolution {
    let mut scene = cornell();
    let gold = Vec3::new(0.9, 0.7, 0.4);
    let mirror = Material { reflectance: gold, metallic: 1.0, roughness, ..Material::default() };
    let wall = rectangle(Vec3::new(-1.0, 0.0, -0.999), Vec3::X * 2.0, Vec3::Y * 2.0);
    add(&mut scene, "mirror", wall, mirror);
    solved(scene, 0.05)
}

#[test]
fn what_a_mirror_shows_of_light_that_went_between_walls_is_that_of_the_path_tracer() {
    let terms: [(&str, &[Layer], f32); 3] = [
        ("L(D|S)*SE", &[Layer::Mirror], 0.03),
        ("L(D|S)+DE", &[Layer::Indirect], 0.03),
        ("L(D|S)*E", &Layer::ALL, 0.03),
    ];
    hold_to_paths(&golden_wall(0.0), &terms);
}

#[test]
fn what_a_rough_wall_shows_is_that_of_the_path_tracer() {
    let terms: [(&str, &[Layer], f32); 3] = [
        ("L(D|S)*SE", &[Layer::Glossy], 0.05),
        ("L(D|S)+DE", &[Layer::Indirect], 0.03),
        ("L(D|S)*E", &Layer::ALL, 0.03),
    ];
    hold_to_paths(&golden_wall(0.3), &terms);
}
