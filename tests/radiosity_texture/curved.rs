//! Curved surfaces: a sphere of six patches without seam or pole, and patches with parameters u and v.

use crate::SHAPES;
use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{frame::uniform_direction, random::Rng},
    radiosity::texture::{
        Border, Quadtree, RadiosityTexture, Shape,
        adapt::{Subdivision, sample_adaptively},
        convert::{Gaps, fill_first_order},
        display::Filter,
        prefilter::gaussian,
        sphere::{SphereSurface, direction, direction_at, face_of, place_of},
        sphere_orders::{FirstOrder, zero_order_texture},
        tube::{self, TubeSurface},
    },
};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Irradiance of a unit sphere at a direction under lamps outside it: Σ I max(0, cos θ) / r².
fn lit(lamps: &[(Vec3, f32)], normal: Vec3) -> Vec3 {
    let e = lamps.iter().map(|(lamp, intensity)| {
        let to = *lamp - normal;
        intensity * to.dot(normal).max(0.0) / to.length().powi(3)
    });
    Vec3::splat(e.sum())
}

/// Two lamps, with their terminators across faces, edges and the seam.
const LAMPS: [(Vec3, f32); 2] = [(Vec3::new(1.2, 1.9, -2.0), 900.0), (Vec3::new(-0.5, -2.0, -1.5), 500.0)];

fn patches(most_level: u32, tolerance: f32) -> [(Quadtree, Gaps); 6] {
    let subdivision = Subdivision { least_level: 2, most_level, tolerance, restricted: false };
    std::array::from_fn(|face| {
        sample_adaptively(Shape::Quadrilateral, &subdivision, |uv| lit(&LAMPS, direction(face, uv)))
    })
}

/// Range of the light within 10° of a direction, lx; a hundredth of the whole range, 2 lx, where it is dark.
fn local_range(about: Vec3) -> f32 {
    let values = (0..400).map(|i| {
        let d = (about + 0.176 * uniform_direction(Rng::new(2, i).next_vec2())).normalize();
        lit(&LAMPS, d).x
    });
    let (low, high) = values.fold((f32::INFINITY, 0f32), |(l, h), v| (l.min(v), h.max(v)));
    (high - low).max(2.0)
}

#[test]
fn directions_and_places_are_inverse() {
    for i in 0..500 {
        let d = uniform_direction(Rng::new(1, i).next_vec2());
        let (face, uv) = face_of(d);
        assert!(direction(face, uv).distance(d) < 1e-5 && uv.min_element() >= 0.0 && uv.max_element() <= 1.0);
        assert!(direction_at(place_of(d)).distance(d) < 1e-5);
    }
}

/// Largest jump of a texture over the seam, and largest spread of values about a pole, relative to the local
/// range, where neighbouring points are a hundredth of a texel apart.
fn seam_and_poles(texture: &RadiosityTexture, filter: Filter) -> (f32, f32) {
    let step = 0.01 * texture.step;
    let seam = (1..60).map(|i| {
        let v = i as f32 / 60.0;
        let [left, right] = [1.0 - step.x, step.x].map(|u| texture.sample(Vec2::new(u, v), filter).x);
        (left - right).abs() / local_range(direction_at(Vec2::new(0.0, v)))
    });
    let poles = [(step.y, Vec3::Y), (1.0 - step.y, Vec3::NEG_Y)].map(|(v, pole)| {
        let round = (0..64).map(|i| texture.sample(Vec2::new(i as f32 / 64.0, v), filter).x);
        let (low, high) = round.fold((f32::INFINITY, 0f32), |(l, h), v| (l.min(v), h.max(v)));
        (high - low) / local_range(pole)
    });
    (seam.fold(0.0, f32::max), poles[0].max(poles[1]))
}

#[test]
fn a_sphere_of_six_patches_has_no_seam_and_no_poles() {
    let surface = SphereSurface::new(&patches(4, 2.0));
    let texture = surface.texture();
    assert_eq!((texture.image.width, texture.image.height), (64, 33));
    for width in [1, 3, 5] {
        let filtered = gaussian(&texture, width);
        // The thesis's pipelines: bilinear lookup with or without a prefilter, bicubic without.
        for filter in [Filter::Bilinear, Filter::Mitchell].into_iter().take(if width == 1 { 2 } else { 1 }) {
            let (seam, poles) = seam_and_poles(&filtered, filter);
            println!("Gauss {width}, {filter:?}: seam {seam:.5}, poles {poles:.5} of the local range");
            assert!(seam < 0.01 && poles < 0.01, "width {width}, {filter:?}: {seam}, {poles}");
        }
        // So that the test can fail: without padding the seam is open.
        let open = RadiosityTexture { border: Border::Clamp, ..filtered };
        assert!(seam_and_poles(&open, Filter::Bilinear).0 > 0.01);
    }
}

#[test]
fn patches_of_different_depth_meet_without_a_gap() {
    // The trees are unrestricted and differ from face to face. Values a thousandth of a cell on both sides of
    // an edge or corner of the cube differ by less than 1 % of the local range.
    let patches = patches(5, 4.0);
    let heights: Vec<u32> = patches.iter().map(|p| p.0.height()).collect();
    assert!(heights.iter().min() < heights.iter().max(), "{heights:?}");
    let (smooth, first) = (SphereSurface::new(&patches), FirstOrder::new(&patches));
    let worst = |at_face: &dyn Fn(usize, Vec2) -> Vec3| {
        let mut worst = 0f32;
        for (face, i) in (0..6).flat_map(|face| (0..200).map(move |i| (face, i))) {
            let along = i as f32 / 199.0;
            for (inside, beyond) in [
                (Vec2::new(1e-4, along), Vec2::new(-1e-4, along)),
                (Vec2::new(along, 1.0 - 1e-4), Vec2::new(along, 1.0 + 1e-4)),
            ] {
                let (other, there) = face_of(direction(face, beyond));
                assert!(i == 0 || i == 199 || other != face);
                let jump = (at_face(face, inside) - at_face(other, there)).x.abs();
                worst = worst.max(jump / local_range(direction(face, inside)));
            }
        }
        worst
    };
    let smooth = worst(&|face, uv| smooth.at_face(face, uv));
    let joined = worst(&|face, uv| first.at_face(face, uv));
    // So that the test can fail: patches of first order each by itself.
    let apart = patches.each_ref().map(|(tree, samples)| fill_first_order(tree, samples));
    let apart = worst(&|face, uv| apart[face].sample(uv, Filter::Bilinear));
    println!(
        "worst jump over an edge of the cube: smooth {smooth:.5}, first order {joined:.5} of the local range"
    );
    assert!(smooth < 0.01 && joined < 0.01 && apart > 0.05, "{smooth}, {joined}, apart {apart}");
}

#[test]
fn first_order_of_a_sphere_keeps_the_samples_and_zero_order_the_leaves() {
    let patches = patches(5, 4.0);
    let first = FirstOrder::new(&patches);
    for (face, (_, samples)) in patches.iter().enumerate() {
        for (sample, i) in samples.texels.iter().zip(0u32..) {
            let uv =
                Vec2::new((i % samples.side) as f32, (i / samples.side) as f32) / (samples.side - 1) as f32;
            let Some(sample) = sample else { continue };
            // On an edge the finer neighbour's sample is of the same place; directions differ by rounding.
            assert!((first.at_face(face, uv) - *sample).x.abs() < 1e-3 * sample.x.max(1.0), "{face} {uv}");
        }
    }
    let mut number = 0.0;
    let leaves = patches.each_ref().map(|(tree, _)| {
        let values = tree.leaves().into_iter().map(|_| {
            number += 1.0;
            Vec3::splat(number)
        });
        (tree.clone(), values.collect::<Vec<_>>())
    });
    let zero = zero_order_texture(&leaves);
    let height = patches.iter().map(|p| p.0.height()).max().expect("six patches");
    assert_eq!((zero.image.width, zero.border), (4 << height, Border::Sphere));
    for (face, (tree, values)) in leaves.iter().enumerate() {
        for (leaf, value) in tree.leaves().iter().zip(values).filter(|(leaf, _)| leaf.level < height) {
            let at = place_of(direction(face, leaf.centre(Shape::Quadrilateral)));
            assert_eq!(zero.sample(at, Filter::Nearest), *value, "face {face}, {leaf:?}");
        }
    }
}

#[test]
fn the_texture_of_a_sphere_is_its_light() {
    // Terminators crease: 2 % of the range at 32 cells a face, and less than half of it at twice as many.
    let error = |level: u32| {
        let texture = SphereSurface::new(&patches(level, 0.0)).texture();
        let worst = (0..2000).map(|i| {
            let d = uniform_direction(Rng::new(4, i).next_vec2());
            (texture.sample(place_of(d), Filter::Bilinear) - lit(&LAMPS, d)).x.abs()
        });
        let peak = (0..2000).map(|i| lit(&LAMPS, uniform_direction(Rng::new(4, i).next_vec2())).x);
        worst.fold(0.0, f32::max) / peak.fold(0.0, f32::max)
    };
    let (coarse, fine) = (error(4), error(5));
    println!("worst error {coarse:.4} and {fine:.4} of the peak");
    assert!(fine < 0.02 && fine < 0.6 * coarse, "{coarse}, {fine}");
}

#[test]
fn patches_with_parameters_are_sampled_where_their_light_bends() {
    // A quarter of a cylinder, u along and v round, under a lamp close by: the closed form on the mapped point.
    let value = |uv: Vec2| {
        let angle = FRAC_PI_2 * uv.y;
        let normal = Vec3::new(0.0, angle.sin(), angle.cos());
        let position = Vec3::new(4.0 * uv.x, 0.0, 0.0) + normal;
        let to = Vec3::new(0.9, 1.2, 1.2) - position;
        Vec3::splat(100.0 * to.dot(normal).max(0.0) / to.length().powi(3))
    };
    for (shape, tolerance) in SHAPES.into_iter().zip([0.7, 1.4]) {
        let adaptive = Subdivision { least_level: 2, most_level: 7, tolerance, restricted: true };
        let (tree, samples) = sample_adaptively(shape, &adaptive, value);
        let count = samples.texels.iter().flatten().count();
        let full = Quadtree::full(shape, 5);
        let uniform = crate::sampled(&full, value);
        assert!(count < uniform.texels.iter().flatten().count(), "{count} samples");
        let error = |texture: &RadiosityTexture| {
            let off =
                crate::points(shape, 4000).map(|p| (texture.sample(p, Filter::Bilinear) - value(p)).x.abs());
            off.fold(0.0, f32::max)
        };
        let (a, u) = (error(&fill_first_order(&tree, &samples)), error(&fill_first_order(&full, &uniform)));
        println!("{shape:?}: {count} samples, worst {a:.2} lx; uniform {u:.2} lx");
        assert!(a < 0.5 * u, "{shape:?}: {a} for {u}");
        assert!(
            tree.t_vertices().iter().all(|t| samples.texels[(t.y * samples.side + t.x) as usize].is_some())
        );
    }
}

#[test]
fn a_patch_that_closes_around_goes_round_and_its_ends_go_on() {
    let tree = Quadtree::full(Shape::Quadrilateral, 3);
    let value = |uv: Vec2| Vec3::splat(2.0 + uv.y + (TAU * uv.x).sin());
    let surface = TubeSurface::new(&tree, &crate::sampled(&tree, value));
    for i in 0..50 {
        let v = i as f32 / 49.0;
        // A quarter around is a vertex; along it is linear.
        assert!((surface.at(Vec2::new(0.25, v)).x - 3.0 - v).abs() < 1e-4);
        // Slopes at the seam are central differences over an eighth of the way: 8 sin(2π/8), from both sides.
        let slope =
            |u: [f32; 2]| (surface.at(Vec2::new(u[1], v)).x - surface.at(Vec2::new(u[0], v)).x) / 1e-3;
        let wanted = 8.0 * (TAU / 8.0).sin();
        for (side, found) in [("left", slope([-1e-3, 0.0])), ("right", slope([0.0, 1e-3]))] {
            assert!((found - wanted).abs() < 0.02 * wanted, "{side}: {found} for {wanted}");
        }
    }
    let texture = surface.sampled(16);
    assert_eq!((texture.image.width, texture.image.height, texture.border), (16, 17, Border::Tube));
    assert_eq!(texture.sample(Vec2::new(1.0, 0.5), Filter::Bilinear), surface.at(Vec2::new(0.0, 0.5)));
    // Where leaves on both sides of the line differ in depth, there is one value: the finer side's, its samples'.
    let mut tree = Quadtree::full(Shape::Quadrilateral, 1);
    tree.refine(4, |cell| cell.u == 0);
    let samples = crate::sampled(&tree, |uv| Vec3::splat(1.0 + (TAU * 2.0 * uv.y).sin().abs()));
    let texture = tube::first_order_texture(&tree, &samples);
    for row in 0..=16u32 {
        let sample = samples.texels[(row * samples.side) as usize].expect("a corner of fine leaves");
        assert_eq!(texture.image.at(0, row), sample);
        let near = texture.sample(Vec2::new(1.0 - 1e-5, row as f32 / 16.0), Filter::Bilinear);
        assert!((near - sample).x.abs() < 1e-3, "row {row}: {near} for {sample}");
    }
}
