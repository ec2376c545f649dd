//! Layers, accumulation, display and overlay of the CPU renderer.

use glam::{Vec2, Vec3};
use lumenscope_core::{
    inspection::{InspectionScene, Line, SphereGlyph},
    irradiance_volume::panorama::direction,
    math::{
        colour::{luminance, srgb8},
        false_colour::{FalseColour, Palette},
        image::LinearImage,
        part::Part,
        progress::Progress,
        sphere_map::DirectionBins,
    },
    scene::{Scene, camera::Camera},
    superposition::{
        PassSettings,
        accumulator::Accumulator,
        composite::{self, DifferenceDisplay, DirectQuality, Display, FAULT, ToneCurve, auto_exposure},
        gbuffer::NO_TRIANGLE,
        layers::Layer,
        mean_of_frames, overlay,
        panorama::panorama,
        render,
    },
    transport::LightTransportSolution,
};
use lumenscope_tests::{add, add_point_lamp, cornell, diffuse, rectangle, with_moved_block};
use std::f32::consts::FRAC_1_PI;

/// Distance between elements, m.
const SPACING_M: f32 = 0.25;

fn solved(scene: Scene) -> LightTransportSolution {
    lumenscope_tests::solved(scene, SPACING_M)
}

/// The Cornell box with its short block moved and no new transport solved.
fn moved() -> (LightTransportSolution, u32) {
    with_moved_block(&solved(cornell()), Vec3::new(-0.3, 0.4, 0.1))
}

fn floor_and_lamp(position: Vec3, intensity: Vec3) -> Scene {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
    add(&mut scene, "floor", floor, diffuse("floor", Vec3::new(0.6, 0.5, 0.4), Vec3::ZERO));
    add_point_lamp(&mut scene, position, intensity);
    scene.camera =
        Camera { eye: Vec3::new(0.0, 3.0, 4.0), target: Vec3::ZERO, up: Vec3::Y, vertical_fov: 0.9 };
    scene
}

#[test]
fn a_panorama_shows_what_a_picture_does_with_mirrors_metals_and_moved_objects() {
    let mut scene = cornell();
    for material in &mut scene.materials {
        match material.name.as_str() {
            "red" => (material.metallic, material.roughness) = (0.9, 0.0),
            "tall" => (material.metallic, material.roughness) = (1.0, 0.9),
            _ => {}
        }
    }
    let (solution, _) = with_moved_block(&solved(scene), Vec3::new(-0.3, 0.4, 0.1));
    let (eye, height) = (Vec3::new(0.3, 0.9, 0.9), 12);
    let image = panorama(&solution, eye, height, 1, &Progress::silent()).unwrap();
    let settings = PassSettings { direct: DirectQuality::PerPixel(16), ..PassSettings::default() };
    let (mut sums, mut black) = ([0.0f32; 3], 0);
    for (i, shown) in image.pixels.iter().enumerate() {
        let [x, y] = [i as u32 % (2 * height), i as u32 / (2 * height)];
        let along = direction((Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(24.0, 12.0));
        let camera =
            Camera { eye, target: eye + along, up: along.any_orthonormal_vector(), vertical_fov: 0.1 };
        let (_, layers) = render(&solution, &camera, 1, 1, &settings);
        let pixel: Vec3 = layers.images.iter().map(|l| l.pixels[0]).sum();
        black += u32::from((*shown == Vec3::ZERO) != (pixel == Vec3::ZERO));
        sums[0] += (*shown - pixel).abs().x;
        sums[1] += shown.x;
        sums[2] += pixel.x;
    }
    // They differ in the scramble of their shadow rays alone.
    assert!(sums[0] < 0.02 * sums[2], "off by {} of {}", sums[0], sums[2]);
    assert_eq!(black, 0);
}

#[test]
fn a_point_lamp_over_a_floor_is_its_closed_form_at_every_pixel() {
    let (lamp, intensity) = (Vec3::new(0.7, 2.0, -0.4), Vec3::new(100.0, 80.0, 60.0));
    let solution = solved(floor_and_lamp(lamp, intensity));
    let (buffer, layers) = render(&solution, &solution.scene.camera, 64, 40, &PassSettings::default());
    let mut floor_pixels = 0;
    for (i, &triangle) in buffer.triangle.iter().enumerate() {
        let direct = layers.get(Layer::Direct).pixels[i];
        if triangle == NO_TRIANGLE {
            assert_eq!(direct, Vec3::ZERO);
            continue;
        }
        floor_pixels += 1;
        // The position comes from the ray and the plane y = 0, not from the buffer.
        let eye = solution.scene.camera.eye;
        let direction = lumenscope_core::superposition::gbuffer::pixel_direction(
            &solution.scene.camera,
            glam::UVec2::new(64, 40),
            glam::UVec2::new(i as u32 % 64, i as u32 / 64),
            Vec2::splat(0.5),
        );
        let p = eye + direction * (-eye.y / direction.y);
        let to_lamp = lamp - p;
        let wanted = Vec3::new(0.6, 0.5, 0.4)
            * FRAC_1_PI
            * intensity
            * (to_lamp.normalize().y / to_lamp.length_squared());
        // Rounding of f32 positions a few metres from the origin.
        assert!((direct - wanted).abs().max_element() <= 1e-4 * wanted.max_element(), "{direct} {wanted}");
    }
    assert!(floor_pixels > 1000);
}

#[test]
fn layers_sum_to_the_picture_and_weights_weigh_them() {
    let solution = solved(cornell());
    let (_, layers) = render(&solution, &solution.scene.camera, 48, 40, &PassSettings::default());
    for layer in [Layer::Emitted, Layer::Direct, Layer::Indirect] {
        assert!(layers.get(layer).mean().max_element() > 0.01, "{} is black", layer.name());
    }
    let picture = layers.total();
    let weighted = layers.sum([0.0, 2.0, 0.5, 3.0, 1.0]);
    for i in 0..picture.pixels.len() {
        let [e, d, n, mirror, glossy] = Layer::ALL.map(|l| layers.get(l).pixels[i].as_dvec3());
        assert_eq!((mirror, glossy), Default::default(), "nothing here has a lobe");
        let (sum, scale) = (picture.pixels[i].as_dvec3(), (e + d + n).max_element().max(1e-6));
        assert!((sum - (e + d + n)).abs().max_element() <= 1e-5 * scale);
        let wanted = d * 2.0 + n * 0.5;
        assert!((weighted.pixels[i].as_dvec3() - wanted).abs().max_element() <= 1e-5 * scale);
    }
}

#[test]
fn layers_are_what_the_solution_says_of_the_surface_seen() {
    let solution = solved(cornell());
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let camera = solution.scene.camera;
    let (buffer, layers) = render(&solution, &camera, 48, 40, &settings);
    for i in 0..buffer.triangle.len() {
        let Some(surface) = buffer.surface(&solution.world, &camera, i) else { continue };
        let (world, radiosity) = (&solution.world, &solution.radiosity);
        let wanted = [
            world.geometry.emission(&surface),
            radiosity.radiance(world, &surface, Part::Direct),
            radiosity.radiance(world, &surface, Part::Indirect),
        ];
        for (layer, wanted) in Layer::ALL.into_iter().zip(wanted) {
            let error = (layers.get(layer).pixels[i] - wanted).abs().max_element();
            // Two roundings of a product of three.
            assert!(error <= 1e-6 * wanted.max_element(), "{}: {error}", layer.name());
        }
    }
}

#[test]
fn a_closed_room_is_looked_into_from_outside() {
    let solution = solved(cornell());
    let camera =
        Camera { eye: Vec3::new(0.3, 5.0, 0.2), target: Vec3::ZERO, up: Vec3::Z, ..solution.scene.camera };
    let (buffer, _) = render(&solution, &camera, 32, 32, &PassSettings::default());
    let shell = solution.scene.objects.iter().position(|o| o.name == "shell").unwrap() as u32;
    let floor = buffer
        .triangle
        .iter()
        .zip(&buffer.position)
        .filter(|(t, p)| {
            **t != NO_TRIANGLE && solution.world.geometry.object[**t as usize] == shell && p.y.abs() < 1e-3
        })
        .count();
    assert!(floor > 200, "{floor} pixels of floor through the ceiling");
    assert!(!buffer.back.iter().any(|b| *b), "a back is shown");
    // The ceiling still keeps the light in: nothing of it is lit from above.
    assert!(buffer.depth.iter().all(|d| *d > 3.0));
}

#[test]
fn frames_accumulate_to_a_fine_one() {
    let solution = solved(cornell());
    let camera = solution.scene.camera;
    let frame = |rays, frame| {
        let settings =
            PassSettings { direct: DirectQuality::PerPixel(rays), frame, seed: 3, ..PassSettings::default() };
        render(&solution, &camera, 40, 32, &settings).1
    };
    let fine = frame(4096, 0);
    let error = |layers: &lumenscope_core::superposition::layers::Layers| {
        let (a, b) = (layers.get(Layer::Direct), fine.get(Layer::Direct));
        a.pixels.iter().zip(&b.pixels).map(|(a, b)| f64::from((*a - *b).length_squared())).sum::<f64>().sqrt()
    };
    let mut sum = Accumulator::new();
    let first = frame(4, 0);
    for i in 0..64 {
        sum.add(&frame(4, i));
    }
    assert_eq!(sum.frames(), 64);
    let (one, many) = (error(&first), error(&sum.mean()));
    // 64 independent frames cut the noise by 8, but the visible share of a lamp is a ratio of two
    // sums and keeps a bias of the order of 1 / rays: a third is asked for.
    assert!(many < one / 3.0, "{one} at one frame, {many} at 64");
    sum.clear();
    sum.add(&first);
    assert_eq!(sum.mean(), first);
}

#[test]
fn a_moved_object_is_lit_by_the_volume_and_shadows_at_once() {
    let (solution, block) = moved();
    let camera = solution.scene.camera;
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let (buffer, layers) = render(&solution, &camera, 60, 50, &settings);
    let (geometry, volume) = (&solution.world.geometry, solution.volume.as_ref().unwrap());
    let mut seen = 0;
    for (i, &t) in buffer.triangle.iter().enumerate() {
        if t == NO_TRIANGLE || geometry.object[t as usize] != block {
            continue;
        }
        seen += 1;
        let Vec2 { x: u, y: v } = buffer.barycentric[i];
        for (part, layer) in [(Part::Direct, Layer::Direct), (Part::Indirect, Layer::Indirect)] {
            let corner = |c: usize| {
                volume.irradiance(geometry.positions[t as usize][c], geometry.normals[t as usize][c], part)
            };
            let irradiance = corner(0) * (1.0 - u - v) + corner(1) * u + corner(2) * v;
            let wanted = geometry.material_of(t).reflectance * FRAC_1_PI * irradiance;
            let error = (layers.get(layer).pixels[i] - wanted).abs().max_element();
            assert!(error <= 1e-5 * wanted.max_element().max(1e-3), "{}: {error}", layer.name());
        }
    }
    assert!(seen > 50, "{seen} pixels of the moved block");

    // Without the block in the way, the floor where it stood gets direct light by shadow rays.
    let rays = PassSettings { direct: DirectQuality::PerPixel(16), ..PassSettings::default() };
    let before = render(
        &LightTransportSolution { moved_objects: vec![], ..solved(cornell()) },
        &camera,
        60,
        50,
        &rays,
    );
    let after = render(&solution, &camera, 60, 50, &rays);
    let changed = (0..after.0.triangle.len())
        .filter(|&i| {
            let t = after.0.triangle[i];
            t == before.0.triangle[i]
                && t != NO_TRIANGLE
                && geometry.object[t as usize] != block
                && (luminance(after.1.get(Layer::Direct).pixels[i])
                    - luminance(before.1.get(Layer::Direct).pixels[i]))
                .abs()
                    > 0.5
        })
        .count();
    assert!(changed > 20, "the shadow did not move: {changed} pixels changed");
}

#[test]
fn frames_share_the_light_on_moved_objects() {
    let (solution, _) = moved();
    let camera = &solution.scene.camera;
    for direct in [DirectQuality::Elements, DirectQuality::PerPixel(1)] {
        let settings = PassSettings { direct, seed: 3, ..PassSettings::default() };
        let silent = Progress::silent();
        let mean = mean_of_frames(&solution, camera, [32, 24], 3, &settings, &silent).unwrap();
        let mut each = Accumulator::new();
        for frame in 0..3 {
            let settings = PassSettings { frame, jitter: true, ..settings };
            each.add(&render(&solution, camera, 32, 24, &settings).1);
        }
        assert_eq!(mean, each.mean(), "{direct:?}: byte for byte");
    }
    let stopped = Progress::silent();
    stopped.cancel();
    let settings = PassSettings::default();
    assert!(mean_of_frames(&solution, camera, [32, 24], 3, &settings, &stopped).is_err());
}

#[test]
fn the_same_bytes_at_any_thread_count() {
    let (solution, _) = moved();
    let settings = PassSettings { frame: 5, jitter: true, ..PassSettings::default() };
    let at = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render(&solution, &solution.scene.camera, 40, 30, &settings))
    };
    let (one, two) = (at(1), at(2));
    let bits = |l: &lumenscope_core::superposition::layers::Layers| -> Vec<u32> {
        l.images.iter().flat_map(|i| &i.pixels).flat_map(|p| p.to_array().map(f32::to_bits)).collect()
    };
    assert_eq!(bits(&one.1), bits(&two.1));
    assert_eq!(one.0, two.0);
}

#[test]
fn tone_curves_are_monotone_from_black_to_white() {
    for tone in [ToneCurve::Linear, ToneCurve::Filmic] {
        let mut last = -1.0;
        for i in 0..4000 {
            let y = tone.apply(Vec3::splat(i as f32 * 0.005)).x;
            assert!(y >= last && (0.0..=1.0).contains(&y), "{tone:?} at {i}: {y} after {last}");
            last = y;
        }
        assert_eq!(tone.apply(Vec3::ZERO), Vec3::ZERO);
        assert_eq!(tone.apply(Vec3::splat(f32::MAX)), Vec3::ONE, "{tone:?}");
        assert_eq!(tone.apply(Vec3::splat(-1.0)), Vec3::ZERO);
    }
    // Narkowicz's curve at 0.6: (0.6 (1.506 + 0.03)) / (0.6 (1.458 + 0.59) + 0.14).
    let at_white = ToneCurve::Filmic.apply(Vec3::ONE).x;
    assert!((at_white - 0.9216 / 1.3688).abs() < 1e-6, "{at_white}");
}

#[test]
fn display_encodes_srgb_and_shows_what_is_not_a_number() {
    let mut picture = LinearImage::new(6, 1);
    // At EV 0 white is 1.2 cd/m².
    let values = [0.0, 0.6, 1.2, 240.0, f32::NAN, f32::INFINITY];
    for (pixel, value) in picture.pixels.iter_mut().zip(values) {
        *pixel = Vec3::splat(value);
    }
    picture.pixels[4] = Vec3::new(1.0, f32::NAN, 1.0);
    let linear = Display { ev100: 0.0, tone: ToneCurve::Linear, false_colour: None };
    let shown = composite::display(&picture, &linear);
    let grey = |v: u8| [v, v, v, 255];
    // sRGB of 0.5 is 187.5 of 255, rounded.
    assert_eq!(shown, [grey(0), grey(188), grey(255), grey(255), FAULT, FAULT]);

    let colour = FalseColour { palette: Palette::Inferno, low: 0.0, high: 2.4, logarithmic: false };
    let shown = composite::display(&picture, &Display { false_colour: Some(colour), ..linear });
    let [r, g, b] = srgb8(Palette::Inferno.colour(0.5));
    assert_eq!(shown[2], [r, g, b, 255], "1.2 of 2.4 cd/m² is the middle of the palette");
    assert_eq!(shown[4], FAULT);
    assert_ne!(shown[0], shown[3]);
}

#[test]
fn auto_exposure_puts_the_log_average_at_middle_grey() {
    let mut picture = LinearImage::new(4, 1);
    picture.pixels = vec![Vec3::splat(10.0), Vec3::splat(1000.0), Vec3::ZERO, Vec3::splat(f32::NAN)];
    let ev100 = auto_exposure(&picture).unwrap();
    let display = Display { ev100, tone: ToneCurve::Linear, false_colour: None };
    // The log average of 10 and 1000 is 100; black and NaN do not count.
    let grey = display.linear(Vec3::splat(100.0)).x;
    assert!((grey - 0.18).abs() < 1e-4, "{grey}");
    assert_eq!(auto_exposure(&LinearImage::new(3, 3)), None);
}

#[test]
fn differences_keep_their_sign() {
    let mut a = LinearImage::new(3, 1);
    let mut b = LinearImage::new(3, 1);
    a.pixels = vec![Vec3::splat(2.0), Vec3::splat(1.0), Vec3::splat(1.0)];
    b.pixels = vec![Vec3::splat(1.0), Vec3::splat(1.0), Vec3::splat(2.0)];
    let signed = composite::difference(&a, &b, &DifferenceDisplay::Signed { range: 1.0 });
    assert!(signed[0][0] > signed[0][2], "more is red: {:?}", signed[0]);
    assert_eq!(signed[1], [255; 4]);
    assert!(signed[2][2] > signed[2][0], "less is blue: {:?}", signed[2]);
    let colour = FalseColour { palette: Palette::Viridis, low: 0.0, high: 1.0, logarithmic: false };
    let absolute = composite::difference(&a, &b, &DifferenceDisplay::Absolute(colour));
    assert_eq!(absolute[0], absolute[2]);
    assert_ne!(absolute[0], absolute[1]);
    b.pixels[0].x = f32::NAN;
    assert_eq!(composite::difference(&a, &b, &DifferenceDisplay::Absolute(colour))[0], FAULT);
}

#[test]
fn the_overlay_draws_in_front_and_hides_behind() {
    let solution = solved(cornell());
    let camera = solution.scene.camera;
    let (buffer, layers) = render(&solution, &camera, 80, 80, &PassSettings::default());
    let plain = composite::display(&layers.total(), &Display::default());
    let bins = DirectionBins::new(3);
    let colour = FalseColour { palette: Palette::Viridis, low: 0.0, high: 1.0, logarithmic: false };
    let draw = |centre: Vec3, value: f32| {
        let scene = InspectionScene {
            spheres: vec![SphereGlyph { centre, radius: 0.2, first_bin: 0, sample: 0 }],
            sphere_bins: vec![Vec3::splat(value); bins.len()],
            bins: Some(bins),
            ..InspectionScene::default()
        };
        let mut picture = plain.clone();
        overlay::draw(&mut picture, &buffer, &camera, &scene, &colour);
        picture
    };
    let [r, g, b] = srgb8(Palette::Viridis.colour(1.0));
    let covered = |picture: &[[u8; 4]]| picture.iter().filter(|p| **p == [r, g, b, 255]).count() as f32;
    let front = draw(Vec3::new(0.0, 1.0, 0.5), 1.0);
    // Its disc: 4.1 m away, r / √(d² − r²) of a half height of tan 20°, in 40 pixels.
    let radius = 0.2 / (4.1f32 * 4.1 - 0.04).sqrt() / 20f32.to_radians().tan() * 40.0;
    let area = std::f32::consts::PI * radius * radius;
    // Half a pixel at the rim.
    assert!((covered(&front) - area).abs() < 0.5 * 6.3 * radius, "{} of {area} pixels", covered(&front));
    assert_eq!(covered(&draw(Vec3::new(0.0, 1.0, -3.0), 1.0)), 0.0, "seen through the back wall");
    assert_eq!(covered(&draw(Vec3::new(0.0, 1.0, 6.0), 1.0)), 0.0, "seen behind the eye");

    let line = |z: f32| {
        let ends = [Vec3::new(-0.9, 1.6, z), Vec3::new(0.9, 1.6, z)];
        let scene = InspectionScene {
            lines: vec![Line { ends, colour: Vec3::new(0.0, 1.0, 0.0) }],
            ..InspectionScene::default()
        };
        let mut picture = plain.clone();
        overlay::draw(&mut picture, &buffer, &camera, &scene, &colour);
        picture.iter().filter(|p| **p == [0, 255, 0, 255]).count()
    };
    assert!(line(0.5) > 40, "{} pixels of line", line(0.5));
    assert_eq!(line(-2.0), 0, "a line behind the wall");
}
