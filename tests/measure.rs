//! Tests of the measures and of the EXR files they read.

use glam::Vec3;
use lumenscope_core::{
    io::{
        exr::{read_layers, write_layers},
        png::write_png,
    },
    math::{image::LinearImage, random::Rng},
    measure::{
        MeasureError,
        chart::{cost_at, front, saving},
        image::{
            PIXELS_PER_DEGREE, flip, flip_displayed, mean_signed, mse, psnr, rel_mse, smape, worst_pixel,
        },
        irradiance::relative_errors,
        perceptual::{contrast_sensitivity, difference},
        significance::{critical_value, normal_quantile, z_test},
    },
    reference::Estimate,
};

fn uniform(width: u32, height: u32, value: f32) -> LinearImage {
    LinearImage::from_fn(width, height, |_, _| Vec3::splat(value))
}

fn noise(width: u32, height: u32, seed: u64) -> LinearImage {
    LinearImage::from_fn(width, height, |x, y| {
        let mut rng = Rng::new(seed, u64::from(y * width + x));
        Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32())
    })
}

/// 1 + a cos along x, with a whole number of periods across the picture.
fn grating(size: u32, periods: u32, amplitude: f64) -> LinearImage {
    LinearImage::from_fn(size, size, |x, _| {
        let phase = std::f64::consts::TAU * f64::from(periods * x) / f64::from(size);
        Vec3::splat((1.0 + amplitude * phase.cos()) as f32)
    })
}

#[test]
fn equal_images_differ_by_nothing() {
    let a = noise(31, 17, 1);
    assert_eq!(mse(&a, &a), Ok(0.0));
    assert_eq!(rel_mse(&a, &a), Ok(0.0));
    assert_eq!(smape(&a, &a), Ok(0.0));
    assert_eq!(mean_signed(&a, &a), Ok(Vec3::ZERO));
    assert_eq!(psnr(&a, &a, 1.0), Ok(f64::INFINITY));
    assert_eq!(worst_pixel(&a, &a).unwrap().difference, 0.0);
    assert_eq!(difference(&a, &a, 40.0), Ok(0.0));
    assert_eq!(flip(&a, &a, 1.0, PIXELS_PER_DEGREE).unwrap().mean, 0.0);
}

#[test]
fn values_computed_by_hand() {
    let reference = LinearImage { width: 2, height: 1, pixels: vec![Vec3::splat(1.0), Vec3::splat(3.0)] };
    let image = LinearImage { width: 2, height: 1, pixels: vec![Vec3::splat(2.0), Vec3::new(3.0, 3.0, 0.0)] };
    // Squared differences 1, 1, 1, 0, 0, 9 over six channels.
    assert!((mse(&image, &reference).unwrap() - 2.0).abs() < 1e-12);
    // Mean of the reference 2, so ε = 0.04: 3 · 1/1.04 + 9/9.04, over six.
    let wanted = (3.0 / 1.04 + 9.0 / 9.04) / 6.0;
    assert!((rel_mse(&image, &reference).unwrap() - wanted).abs() < 1e-12);
    // 2 · 1/3 three times and 2 · 3/3 once, over six.
    assert!((smape(&image, &reference).unwrap() - 4.0 / 6.0).abs() < 1e-12);
    assert_eq!(mean_signed(&image, &reference), Ok(Vec3::new(0.5, 0.5, -1.0)));
    // 10 log₁₀(100 / 2).
    assert!((psnr(&image, &reference, 10.0).unwrap() - 16.989_700_043).abs() < 1e-6);
    let worst = worst_pixel(&image, &reference).unwrap();
    assert_eq!((worst.x, worst.y, worst.difference), (1, 0, 3.0));
}

#[test]
fn measures_are_symmetric_or_scale_free_where_they_should_be() {
    let (a, b) = (noise(32, 24, 1), noise(32, 24, 2));
    assert_eq!(mse(&a, &b), mse(&b, &a));
    assert_eq!(smape(&a, &b), smape(&b, &a));
    assert_eq!(mean_signed(&a, &b).unwrap(), -mean_signed(&b, &a).unwrap());
    let close = |x: f64, y: f64| (x - y).abs() < 1e-5 * x.abs();
    assert!(close(difference(&a, &b, 40.0).unwrap(), difference(&b, &a, 40.0).unwrap()));
    let times = |i: &LinearImage| LinearImage { pixels: i.pixels.iter().map(|p| *p * 100.0).collect(), ..*i };
    assert!(close(rel_mse(&a, &b).unwrap(), rel_mse(&times(&a), &times(&b)).unwrap()));
    assert!(close(difference(&a, &b, 40.0).unwrap(), difference(&times(&a), &b, 40.0).unwrap()));
    assert!(close(1e4 * mse(&a, &b).unwrap(), mse(&times(&a), &times(&b)).unwrap()));
}

#[test]
fn flip_of_black_and_white_is_near_one_and_follows_the_pixels() {
    let found = flip(&uniform(32, 32, 0.0), &uniform(32, 32, 1.0), 1.0, PIXELS_PER_DEGREE).unwrap();
    // The largest colour difference of the metric lies between green and blue; black to white comes to 0.97.
    assert!((0.9..=1.0).contains(&found.mean), "{}", found.mean);
    assert_eq!(found.map.len(), 32 * 32);
    let mut one = uniform(64, 64, 0.5);
    one.pixels[20 * 64 + 40] = Vec3::new(1.0, 0.0, 0.0);
    let map = flip(&one, &uniform(64, 64, 0.5), 1.0, PIXELS_PER_DEGREE).unwrap().map;
    let worst = (0..map.len()).max_by(|&a, &b| map[a].total_cmp(&map[b])).unwrap();
    assert!((worst % 64).abs_diff(40) <= 1 && (worst / 64).abs_diff(20) <= 1, "{worst}");
    let (black, white) = (vec![[0, 0, 0, 255]; 1024], vec![[255; 4]; 1024]);
    assert_eq!(flip_displayed(&black, &white, 32, PIXELS_PER_DEGREE).unwrap(), found);
}

#[test]
fn perceptual_difference_of_a_grating_is_its_amplitude_times_the_sensitivity() {
    // 64 pixels at 128 pixels/degree are half a degree: 4 periods are 8 cycles/degree, 30 are 60.
    let (flat, size, ppd) = (uniform(64, 64, 1.0), 64, 128.0);
    let amplitude = 1e-3;
    for (periods, frequency) in [(1, 2.0), (4, 8.0), (15, 30.0), (30, 60.0)] {
        let found = difference(&grating(size, periods, amplitude), &flat, ppd).unwrap();
        // ∛(1 + a cos) ≈ 1 + a/3 cos, whose root mean square is a / (3 √2); the next term of the series
        // is a/3 as large, and single precision adds 6e-8 / 1e-3 of noise.
        let wanted = amplitude / 3.0 / 2f64.sqrt() * contrast_sensitivity(frequency);
        assert!(
            (found / wanted - 1.0).abs() < 2e-3,
            "{frequency} cycles/degree: {found:e} against {wanted:e}"
        );
    }
    let peak = (1..600)
        .map(|i| f64::from(i) * 0.1)
        .max_by(|a, b| contrast_sensitivity(*a).total_cmp(&contrast_sensitivity(*b)));
    // Mannos and Sakrison give the peak near 8 cycles/degree, about 0.98 high.
    assert!((7.0..9.0).contains(&peak.unwrap()), "{peak:?}");
    assert!((0.95..1.0).contains(&contrast_sensitivity(8.0)));
    assert!(contrast_sensitivity(60.0) < 0.05);
}

#[test]
fn irradiance_errors_by_hand() {
    let grey = |v: &[f32]| v.iter().map(|&v| Vec3::splat(v)).collect::<Vec<_>>();
    // Mean of the reference 50, so the floor is 2.5.
    let reference = grey(&[100.0, 100.0, 0.0, 50.0, 0.0]);
    let found = grey(&[110.0, 90.0, 1.0, 50.0, 0.0]);
    let s = relative_errors(&found, &reference).unwrap();
    assert_eq!((s.count, s.worst_index), (5, 2));
    // Single precision luminance: 1e-6.
    for (value, wanted) in
        [(s.median, 0.1), (s.max, 0.4), (s.mean_signed, 0.08), (s.percentile_95, 0.1 + 0.8 * 0.3)]
    {
        assert!((value - wanted).abs() < 1e-5, "{s:?}");
    }
}

#[test]
fn critical_values_are_those_of_the_tables() {
    assert!((normal_quantile(0.975) - 1.959_963_984_5).abs() < 1e-8);
    assert!((normal_quantile(0.001) + 3.090_232_306).abs() < 1e-8);
    assert!((critical_value(0.05, 1, u32::MAX) - 1.959_963_98).abs() < 1e-7);
    // Two-sided 5 % of Student's t with 10 and 60 degrees of freedom; the series stops at 1/ν².
    assert!((critical_value(0.05, 1, 10) - 2.228).abs() < 5e-3);
    assert!((critical_value(0.05, 1, 60) - 2.000).abs() < 1e-3);
    // Two values at 5 % together: 1 − √0.95 = 2.532 % each.
    assert!((critical_value(0.05, 2, u32::MAX) - 2.236_5).abs() < 1e-3);
    let of = |mean: f32, error: f32| Estimate {
        mean: Vec3::splat(mean),
        standard_error: Vec3::splat(error),
        degrees_of_freedom: 1_000_000,
    };
    let test = z_test(&[of(1.0, 0.3), of(3.0, 0.3)], &[of(1.0, 0.4), of(1.0, 0.4)], 0.01).unwrap();
    assert!((test.worst - 4.0).abs() < 1e-3 && test.worst_index == 1 && !test.passes(), "{test:?}");
    assert!(z_test(&[of(1.0, 0.3)], &[of(2.0, 0.4)], 0.01).unwrap().passes());
}

#[test]
fn what_cannot_be_compared_says_why() {
    let message = mse(&uniform(3, 2, 0.0), &uniform(2, 3, 0.0)).unwrap_err().to_string();
    assert!(message.contains("3x2") && message.contains("2x3"), "{message}");
    assert_eq!(mse(&uniform(0, 0, 0.0), &uniform(0, 0, 0.0)), Err(MeasureError::Empty));
    let mut broken = uniform(4, 4, 1.0);
    broken.pixels[5].y = f32::NAN;
    let wanted = MeasureError::NotFinite { which: "image", index: 5 };
    assert_eq!(mse(&broken, &uniform(4, 4, 1.0)), Err(wanted.clone()));
    assert_eq!(difference(&broken, &uniform(4, 4, 1.0), 40.0), Err(wanted));
}

#[test]
fn layers_come_back_bit_for_bit_under_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layers.exr");
    let mut odd = noise(37, 19, 3);
    odd.pixels[0] = Vec3::new(1e-30, -7.5, 65_000_000.0);
    odd.pixels[1] = Vec3::new(f32::INFINITY, f32::MIN_POSITIVE, -0.0);
    let (sum, direct) = (noise(37, 19, 4), noise(37, 19, 5));
    let layers = [("", &sum), ("emitted", &odd), ("direct", &direct)];
    write_layers(&path, &layers, "7 samples").unwrap();
    let read = read_layers(&path).unwrap();
    let names: Vec<&str> = read.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["", "emitted", "direct"]);
    for ((_, wanted), (_, found)) in layers.iter().zip(&read) {
        let bits =
            |i: &LinearImage| i.pixels.iter().map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!((found.width, found.height), (37, 19));
        assert_eq!(bits(found), bits(wanted));
    }
    // As another program would find them.
    let meta = exr::meta::MetaData::read_from_file(&path, true).unwrap();
    let mut channels: Vec<String> =
        meta.headers[0].channels.list.iter().map(|c| c.name.to_string()).collect();
    channels.sort();
    let wanted = ["B", "G", "R", "direct.B", "direct.G", "direct.R", "emitted.B", "emitted.G", "emitted.R"];
    assert_eq!(channels, wanted);
    assert_eq!(meta.headers[0].own_attributes.comments.as_ref().unwrap().to_string(), "7 samples");
}

#[test]
fn corrupt_layers_are_an_error_or_a_picture_never_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layers.exr");
    let image = noise(24, 18, 6);
    write_layers(&path, &[("", &image), ("direct", &image)], "").unwrap();
    let whole = std::fs::read(&path).unwrap();
    let broken = folder.path().join("broken.exr");
    for length in (0..whole.len()).step_by(whole.len() / 60) {
        std::fs::write(&broken, &whole[..length]).unwrap();
        let message = read_layers(&broken).unwrap_err().to_string();
        assert!(message.contains("broken.exr") && !message.contains('\n'), "{message}");
    }
    let mut failed = 0;
    for i in 0..600u64 {
        let mut bytes = whole.clone();
        let mut rng = Rng::new(9, i);
        // Half of them in the header, where the damage is worst.
        let range = if i % 2 == 0 { 500 } else { bytes.len() };
        let place = (rng.next_f32() * range as f32) as usize;
        bytes[place] ^= 1 << (rng.next_u32() % 8);
        std::fs::write(&broken, &bytes).unwrap();
        match read_layers(&broken) {
            Ok(layers) => {
                assert!(layers.iter().all(|(_, l)| l.pixels.len() == (l.width * l.height) as usize))
            }
            Err(error) => {
                failed += 1;
                assert!(error.to_string().contains("broken.exr"), "{error}");
            }
        }
    }
    assert!(failed > 60, "only {failed} of 600 flips were noticed");
}

#[test]
fn files_that_cannot_be_written_say_so_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing").join("layers.exr");
    let (small, large) = (uniform(2, 2, 1.0), uniform(3, 2, 1.0));
    let lines = [
        write_layers(&path, &[("", &small)], "").unwrap_err().to_string(),
        write_png(&path, 1, 1, &[[0u8, 0, 0]]).unwrap_err().to_string(),
        write_layers(&path, &[("", &small), ("direct", &large)], "").unwrap_err().to_string(),
        write_layers(&path, &[("a", &small), ("a", &small)], "").unwrap_err().to_string(),
        write_layers(&path, &[], "").unwrap_err().to_string(),
        write_png(&path, 2, 2, &[[0u8; 4]; 3]).unwrap_err().to_string(),
        read_layers(&path).unwrap_err().to_string(),
    ];
    for line in lines {
        assert!(line.contains("layers.exr: ") && !line.contains('\n'), "{line}");
    }
    let png = folder.path().join("two.png");
    write_png(&png, 2, 1, &[[255u8, 0, 0, 255], [0, 0, 255, 128]]).unwrap();
    let read = image::open(&png).unwrap().into_rgba8();
    assert_eq!(read.get_pixel(1, 0).0, [0, 0, 255, 128]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
}

#[test]
fn a_pareto_front_holds_what_nothing_beats() {
    let points = [
        [1.0, 8.0],
        [2.0, 9.0],
        [2.0, 4.0],
        [3.0, 4.0],
        [4.0, 1.0],
        [0.5, f64::NAN],
        [8.0, 0.0],
        [0.9, 20.0],
    ];
    assert_eq!(front(&points), [7, 0, 2, 4]);
    assert!(front(&[]).is_empty());
    // Nothing on the front is beaten, and everything off it is.
    let mut state = Rng::new(4, 1);
    let points: Vec<[f64; 2]> =
        (0..200).map(|_| [0.1 + state.next_f32(), 0.1 + state.next_f32()].map(f64::from)).collect();
    let kept = front(&points);
    let beaten = |p: &[f64; 2]| points.iter().any(|q| q != p && q[0] <= p[0] && q[1] <= p[1]);
    assert!((0..points.len()).all(|i| kept.contains(&i) != beaten(&points[i])));
}

#[test]
fn power_laws_differ_by_the_ratio_of_their_factors_at_equal_error() {
    // Error = (a / cost)^p comes down to e at a cost of a e^(-1/p): the ratio of two is a/b wherever both reach.
    let law = |a: f64, costs: &[f64]| costs.iter().map(|c| [*c, (a / c).powf(0.7)]).collect::<Vec<_>>();
    let (dear, cheap) = (law(3.0, &[1.0, 2.0, 5.0, 16.0, 50.0]), law(1.25, &[0.5, 0.7, 3.0, 9.0]));
    assert!((cost_at(&dear, 0.5).unwrap() / (3.0 * 0.5f64.powf(-1.0 / 0.7)) - 1.0).abs() < 1e-9);
    assert_eq!(cost_at(&dear, dear[2][1]), Some(5.0));
    assert_eq!(cost_at(&dear, 10.0), None);
    let found = saving(&dear, &cheap).unwrap();
    for ratio in [found.factor, found.least, found.most] {
        assert!((ratio / (3.0 / 1.25) - 1.0).abs() < 1e-9, "{found:?}");
    }
    assert_eq!(found.errors, [cheap[3][1], cheap[0][1]]);
    assert_eq!(saving(&[[1.0, 1.0]], &[[1.0, 0.5]]), None, "no error in common");
}
