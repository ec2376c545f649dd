//! The three stages: samples kept, no creases, nothing below zero, constants and ramps untouched.

use crate::{SHAPES, fold, points, random_tree, sampled};
use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{image::LinearImage, random::Rng},
    radiosity::texture::{
        Quadtree, RadiosityTexture, Shape,
        display::{Filter, mitchell},
        hermite::HermiteSurface,
        prefilter::{WIDEST, adaptive, gaussian},
    },
};

/// A smooth, positive function with features about a third of the square wide.
fn smooth(p: Vec2) -> Vec3 {
    Vec3::new(
        2.0 + (7.0 * p.x).sin() * (5.0 * p.y).cos(),
        (-9.0 * (p - Vec2::new(0.3, 0.4)).length_squared()).exp(),
        1.0 + p.x * p.y,
    )
}

#[test]
fn the_function_passes_through_every_sample() {
    for shape in SHAPES {
        for seed in 0..10 {
            let tree = random_tree(shape, 5, seed);
            let samples = sampled(&tree, smooth);
            let surface = HermiteSurface::new(shape, &samples);
            let resampled = surface.resampled(samples.side);
            for (i, sample) in samples.texels.iter().enumerate() {
                if let Some(sample) = sample {
                    assert_eq!(resampled.image.pixels[i], *sample, "vertex {i}");
                }
            }
        }
    }
}

#[test]
fn quadratics_come_back_from_full_trees() {
    // Central and one-sided quadratic differences are exact for them. Rounding of values up to 6: 1e-5.
    let quadratic = |p: Vec2| Vec3::splat(2.0 + p.x - 0.5 * p.y + 1.5 * p.x * p.x + p.x * p.y - p.y * p.y);
    for shape in SHAPES {
        let tree = Quadtree::full(shape, 3);
        let surface = HermiteSurface::new(shape, &sampled(&tree, quadratic));
        for p in points(shape, 500) {
            let found = surface.at(p);
            assert!((found - quadratic(p)).abs().max_element() < 1e-5, "{shape:?} {p}: {found}");
        }
    }
}

/// Largest jump of the slope across the lattice lines of a tree, where the one-sided slopes are taken over
/// `step`.
fn largest_crease(tree: &Quadtree, step: f32, value: impl Fn(Vec2) -> Vec3) -> f32 {
    let cells = (1u32 << tree.height()) as f32;
    let mut worst = 0f32;
    for i in 0..400u64 {
        let mut rng = Rng::new(7, i);
        let line = (1.0 + (rng.next_f32() * (cells - 1.0)).floor()) / cells;
        let along = 0.1 + 0.8 * rng.next_f32();
        for across in [Vec2::X, Vec2::Y] {
            let p = across * line + (Vec2::ONE - across) * along;
            if tree.shape() == Shape::Triangle && p.element_sum() > 0.95 {
                continue;
            }
            let slope = |from: f32| (value(p + across * (from + step)) - value(p + across * from)) / step;
            worst = worst.max((slope(0.0) - slope(-step)).abs().max_element());
        }
    }
    worst
}

#[test]
fn no_crease_inside_nor_at_t_vertices() {
    // Across lattice lines, T-vertices among them, the one-sided slopes over ε differ by ε times the second
    // derivative where the function is C¹ and by a constant where it is not. ε halves; rounding adds
    // 2 × 3 × 6e-8 / ε = 2e-4.
    for shape in SHAPES {
        for seed in 0..6 {
            let tree = random_tree(shape, 4, seed);
            let surface = HermiteSurface::new(shape, &sampled(&tree, smooth));
            let [wide, narrow] =
                [1.0 / 256.0, 1.0 / 512.0].map(|e| largest_crease(&tree, e, |p| surface.at(p)));
            assert!(narrow < 0.56 * wide + 1e-3, "{shape:?} {seed}: {wide} to {narrow}");
            let bilinear = surface.resampled(17);
            let [wide, narrow] = [1.0 / 256.0, 1.0 / 512.0]
                .map(|e| largest_crease(&tree, e, |p| bilinear.sample(p, Filter::Bilinear)));
            assert!(narrow > 0.9 * wide && wide > 0.3, "bilinear lookup has them: {wide} to {narrow}");
        }
    }
}

#[test]
fn no_overshoot_below_zero() {
    // Samples of 0 and 1 at random: steps of the greatest contrast. Rounding of weights of 1: 1e-6.
    for shape in SHAPES {
        let mut lowest_unlimited = 0f32;
        for seed in 0..10 {
            let tree = random_tree(shape, 4, seed);
            let samples = sampled(&tree, |p| {
                let item = (p.x * 64.0) as u64 * 100 + (p.y * 64.0) as u64;
                Vec3::splat(f32::from(Rng::new(seed, item).next_f32() < 0.3))
            });
            let surface = HermiteSurface::new(shape, &samples);
            for p in points(shape, 2000) {
                assert!(surface.at(p).min_element() > -1e-6, "{p}: {}", surface.at(p));
            }
            // The same through a filter that does overshoot, so that the test can fail.
            let display = surface.resampled(samples.side);
            lowest_unlimited = points(shape, 2000)
                .map(|p| display.sample(p, Filter::Mitchell).min_element())
                .fold(lowest_unlimited, f32::min);
        }
        assert!(lowest_unlimited < -0.01, "{lowest_unlimited}");
    }
}

fn texture_of(side: u32, value: impl Fn(Vec2) -> f32 + Sync) -> RadiosityTexture {
    RadiosityTexture::at_vertices(LinearImage::from_fn(side, side, |x, y| {
        Vec3::splat(value(Vec2::new(x as f32, y as f32) / (side - 1) as f32))
    }))
}

#[test]
fn gaussians_keep_constants_and_shift_nothing() {
    for width in 1..=WIDEST {
        let constant = gaussian(&texture_of(9, |_| 3.0), width);
        assert!(constant.image.pixels.iter().all(|p| (*p - 3.0).abs().max_element() < 1e-6));
        // A ramp stays itself away from the border, whichever side of a texel the filter's middle is on.
        let ramp = gaussian(&texture_of(17, |p| p.x + 2.0 * p.y), width);
        let middle = Vec2::new(0.47, 0.52);
        let found = ramp.sample(middle, Filter::Bilinear).x;
        assert!((found - (middle.x + 2.0 * middle.y)).abs() < 1e-5, "width {width}: {found}");
        // The variance of an impulse's image is (k − 1)/4 texels² along each axis, its sum 1.
        let spot = gaussian(&texture_of(17, |p| f32::from(p == Vec2::splat(0.5))), width);
        let (mut sum, mut square) = (0.0, 0.0);
        for (i, p) in spot.image.pixels.iter().enumerate() {
            let x = spot.first.x + spot.step.x * (i as u32 % spot.image.width) as f32;
            sum += p.x;
            square += p.x * ((x - 0.5) * 16.0).powi(2);
        }
        let wanted = (width - 1) as f32 / 4.0;
        assert!((sum - 1.0).abs() < 1e-5 && (square - wanted).abs() < 1e-4, "width {width}: {sum}, {square}");
    }
}

#[test]
fn gaussians_lessen_creases() {
    let spot = texture_of(9, |p| 1.0 / (1.0 + 30.0 * (p - Vec2::splat(0.4)).length_squared()));
    let tree = Quadtree::full(Shape::Quadrilateral, 3);
    let mut last = f32::INFINITY;
    for width in [1, 3, 5] {
        let filtered = gaussian(&spot, width);
        let crease = largest_crease(&tree, 1e-3, |p| filtered.sample(p, Filter::Bilinear));
        assert!(crease < 0.8 * last, "width {width}: {crease} after {last}");
        last = crease;
    }
}

#[test]
fn the_adaptive_filter_keeps_small_features_and_smooths_flat_light() {
    // A small spot on a rough, flat ground: the spot's top stays within the tolerance, the roughness goes.
    let rough = |p: Vec2| {
        let grain = 0.01 * ((p.x * 32.0).round() as i32 + (p.y * 32.0).round() as i32).rem_euclid(2) as f32;
        1.0 + grain + (-2000.0 * (p - Vec2::splat(0.5)).length_squared()).exp()
    };
    let texture = texture_of(33, rough);
    let (adapted, wide) = (adaptive(&texture, 0.02), gaussian(&texture, 5));
    let top = |t: &RadiosityTexture| t.image.at(16, 16).x;
    assert!((top(&adapted) - top(&texture)).abs() <= 0.0201 * top(&texture), "{}", top(&adapted));
    assert!(top(&wide) < 0.75 * top(&texture), "the wide one loses it: {}", top(&wide));
    let grain = |t: &RadiosityTexture| (t.image.at(4, 4).x - t.image.at(5, 4).x).abs();
    assert!(grain(&adapted) < 1e-4 && grain(&texture) > 0.009);
}

#[test]
fn mitchell_keeps_ramps_and_has_no_crease() {
    let ramp = texture_of(17, |p| p.x - 2.0 * p.y);
    for i in 0..200 {
        let p = 0.2 + 0.6 * Rng::new(5, i).next_vec2();
        let found = ramp.sample(p, Filter::Mitchell).x;
        assert!((found - (p.x - 2.0 * p.y)).abs() < 1e-5, "{p}: {found}");
    }
    let lowest = (0..200).map(|i| mitchell(i as f32 * 0.01)).fold(0.0, f32::min);
    assert!((-1.0 / 27.0..-1.0 / 28.0).contains(&lowest), "{lowest}");
    assert!((mitchell(1.0) - mitchell(1.0 - 1e-6)).abs() < 1e-5 && mitchell(2.0).abs() < 1e-6);
    let tree = Quadtree::full(Shape::Quadrilateral, 4);
    let texture = texture_of(17, |p| smooth(fold(Shape::Quadrilateral, p)).x);
    let [wide, narrow] =
        [1.0 / 256.0, 1.0 / 512.0].map(|e| largest_crease(&tree, e, |p| texture.sample(p, Filter::Mitchell)));
    assert!(narrow < 0.56 * wide + 1e-3, "{wide} to {narrow}");
}
