//! How points of images-with-depth become pixels, by numbers.

use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::mirror::{
    images::{Point, Reprojected, Splat, reproject, reproject::footprint},
    views::Eye,
};

/// A point of a sample's pixel: its sample looks along −z from the origin through an element of slopes ±½.
fn frontal_point(resolution: u32, depth: f32) -> Point {
    let side = depth / resolution as f32;
    Point {
        position: Vec3::new(0.1, 0.05, -1.0) * depth,
        sides: [Vec3::X * side, Vec3::Y * side],
        colour: Vec3::ONE,
        triangle: 0,
    }
}

#[test]
fn a_points_size_is_that_of_equations_6_5_to_6_7() {
    for (source, wanted) in [(128, 256), (64, 480), (128, 100)] {
        for (source_depth, forward_m) in [(3.0, 0.0f32), (3.0, 1.2), (5.0, -4.0)] {
            for turn in [0.0f32, 0.3, 0.9] {
                let (sin, cos) = turn.sin_cos();
                let eye = Eye {
                    position: Vec3::NEG_Z * forward_m,
                    right: Vec3::new(cos, sin, 0.0),
                    up: Vec3::new(-sin, cos, 0.0),
                    forward: Vec3::NEG_Z,
                    half_size: Vec2::splat(0.5),
                };
                let point = frontal_point(source, source_depth);
                let (_, half, z) = footprint(&eye, UVec2::splat(wanted), &point).unwrap();
                let window = source as f32 / wanted as f32;
                let distance_scale = source_depth / (source_depth - forward_m);
                // By the axes of the source: both sides of a turned square widen its box.
                let directional = cos.abs() + sin.abs();
                let size = distance_scale * directional / window;
                assert!((2.0 * half - size).abs().max_element() < 1e-4 * size, "{half} for {size}");
                assert!((z - (source_depth - forward_m)).abs() < 1e-5);
            }
        }
    }
}

const SIZE: UVec2 = UVec2::new(32, 16);

/// The plane z = −1 seen from the origin, a metre a hundred pixels.
fn shown(points: &[Point], splat: Splat) -> Reprojected {
    let eye = Eye {
        position: Vec3::ZERO,
        right: Vec3::X,
        up: Vec3::Y,
        forward: Vec3::NEG_Z,
        half_size: Vec2::new(0.16, 0.08),
    };
    reproject(points, &eye, (SIZE, Vec2::splat(0.5)), &[true; 512], splat)
}

/// A point on that plane by its place in pixels and its half width, coloured.
fn plane_point(at: Vec2, half: f32, colour: Vec3) -> Point {
    let position = Vec3::new(0.01 * at.x - 0.16, 0.08 - 0.01 * at.y, -1.0);
    let side = 0.02 * half;
    Point { position, sides: [Vec3::X * side, Vec3::Y * side], colour, triangle: 0 }
}

fn middle_of(pixel: usize) -> Vec2 {
    Vec2::new((pixel % 32) as f32 + 0.5, (pixel / 32) as f32 + 0.5)
}

#[test]
fn gaussian_splats_are_the_weighted_mean_of_their_points() {
    // Off the pixels' middles, as wide as four pixels: σ is half of the half width, one pixel.
    let (a, b) = (Vec2::new(14.2, 8.3), Vec2::new(16.9, 7.1));
    let points = [plane_point(a, 2.0, Vec3::X), plane_point(b, 2.0, Vec3::Y)];
    let mut between = 0;
    for (i, radiance) in shown(&points, Splat::Gaussian).radiance.iter().enumerate() {
        let at = middle_of(i);
        let inside = |middle: Vec2, reach: f32| (at - middle).abs().max_element() <= reach;
        // Where a box covers a pixel its Gaussian reaches a pixel farther.
        if !(inside(a, 2.0) || inside(b, 2.0)) {
            assert_eq!(*radiance, Vec3::ZERO);
            continue;
        }
        let weight = |middle: Vec2| {
            if inside(middle, 3.0) { (-0.5 * (at - middle).length_squared()).exp() } else { 0.0 }
        };
        let wanted = Vec2::new(weight(a), weight(b)) / (weight(a) + weight(b));
        // Places are rounded at a hundredth of a metre a pixel: 1e-5 pixels; slopes of the weights are below 1.
        assert!((radiance.truncate() - wanted).abs().max_element() < 1e-4, "{at}: {radiance} for {wanted}");
        between += usize::from(wanted.min_element() > 0.1);
    }
    assert!(between >= 4, "both points count in {between} pixels");
}

#[test]
fn gaussian_splats_keep_a_constant_and_follow_a_ramp_better_than_boxes() {
    // Points every two pixels, from beyond the picture on.
    let points = |colour: &dyn Fn(Vec2) -> Vec3| -> Vec<Point> {
        let columns = (-3..20).map(|x| 2.0 * x as f32 + 0.3);
        let places = columns.flat_map(|x| (-3..12).map(move |y| Vec2::new(x, 2.0 * y as f32 + 0.7)));
        places.map(|at| plane_point(at, 1.0, colour(at))).collect()
    };
    let white = Vec3::new(3.0, 2.0, 1.0);
    for radiance in &shown(&points(&|_| white), Splat::Gaussian).radiance {
        assert!((*radiance - white).abs().max_element() < 1e-5, "{radiance}");
    }
    let ramp = points(&|at| Vec3::splat(at.x));
    let off = |splat| {
        let shown = shown(&ramp, splat);
        let error = |(i, r): (usize, &Vec3)| f64::from((r.x - middle_of(i).x).powi(2));
        (shown.radiance.iter().enumerate().map(error).sum::<f64>() / 512.0).sqrt()
    };
    let (gaussian, square) = (off(Splat::Gaussian), off(Splat::Box));
    println!("a ramp of 1 a pixel is off by {gaussian:.3} with Gaussians, {square:.3} with boxes");
    assert!(gaussian < 0.8 * square, "{gaussian} {square}");
}
