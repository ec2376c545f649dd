//! What every kernel must keep, and where two kernels must agree.

use super::setting::{ALPHAS, SHAPES, Setting, lobes, setting};
use glam::{Vec2, Vec3};
use lumenscope_core::{
    glossy::{
        convolution::{Convention, Masked, Way},
        invariant::{Kernel, Measure, SplitKernel, WIDEST},
        lobes::LobeTable,
        pyramid::{Texel, level_size},
    },
    math::random::r2_point,
    mirror::reflectors::NO_REFLECTOR,
    scene::brdf::{Brdf, Lobe, LobeShape, Specular},
};

const SIZE: [u32; 2] = [64, 48];

fn ggx(alpha: f32) -> Lobe {
    Lobe::new(LobeShape::Ggx, alpha)
}

#[test]
fn constant_light_stays_constant_under_every_kernel() {
    for lobe in lobes() {
        for tilt in [0.0, 0.9, 1.3] {
            // Near things before far ones, a hole, and a patch of another reflector.
            let mut s =
                setting(
                    SIZE,
                    0.8,
                    tilt,
                    lobe,
                    |[x, y]| if (x + y) % 7 < 3 { 0.02 } else { 1.0 + (x % 50) as f32 },
                );
            s.image.radiance.fill(Vec3::new(3.0, 2.0, 1.0));
            for i in 1000..1200 {
                s.image.reflector[i] = NO_REFLECTOR;
                s.image.radiance[i] = Vec3::ZERO;
            }
            for i in 2000..2100 {
                (s.image.reflector[i], s.image.distance[i]) = (1, f32::INFINITY);
            }
            for (i, found) in s.variant().iter().enumerate() {
                let wanted = if s.image.reflector[i] == NO_REFLECTOR { 0.0 } else { 1.0 };
                // Asked for: 1e-3. Rounding of some hundred sums.
                let error = (*found - wanted * Vec3::new(3.0, 2.0, 1.0)).abs().max_element();
                assert!(error < 1e-4, "{lobe:?}, tilt {tilt}: pixel {i} is {found}");
            }
            for (i, found) in s.invariant().0.iter().enumerate().filter(|(i, _)| s.image.reflector[*i] == 0) {
                let error = (*found - Vec3::new(3.0, 2.0, 1.0)).abs().max_element();
                assert!(error < 1e-4, "{lobe:?}, tilt {tilt}: pixel {i} is {found}");
            }
        }
    }
}

#[test]
fn both_ways_of_summing_agree_keep_white_and_go_beyond_nothing_they_sum() {
    for (radius, lobe) in [1, 4, 9, 20].into_iter().flat_map(|r| SHAPES.map(|s| (r, Lobe::new(s, 0.04)))) {
        let s = setting(SIZE, 0.8, 0.7, lobe, |_| 3.0);
        let (point, nearness, _) = s.middle();
        let kernel = Kernel::on_level(&s.lens, &point, nearness, 0, radius);
        // A hole and a patch that weighs half.
        let mut mask = vec![1.0; s.image.radiance.len()];
        mask[900..1000].fill(0.0);
        mask[2000..2100].fill(0.5);
        let masked = Masked { size: SIZE, radiance: s.image.radiance.clone(), mask };
        let [direct, fourier] = Way::ALL.map(|way| masked.convolved(&kernel, Convention::Backward, way));
        let white = Masked { radiance: vec![Vec3::splat(7.0); masked.radiance.len()], ..masked.clone() };
        for (a, b) in direct.iter().zip(&fourier) {
            // Single precision of up to 41 × 41 sums.
            assert!((*a - *b).abs().max_element() < 1e-5 * 255.0 && a.min_element() >= 0.0, "{a} {b}");
            assert!(a.max_element() <= 255.0 * (1.0 + 1e-5));
        }
        for (way, convention) in Way::ALL.into_iter().flat_map(|way| Convention::ALL.map(|c| (way, c))) {
            for l in white.convolved(&kernel, convention, way) {
                // Black only where no neighbour counts, and the hole is not as wide as that here.
                assert!(
                    (l - Vec3::splat(7.0)).abs().max_element() < 7e-3,
                    "{lobe:?}, {way:?}, {convention:?}, radius {radius}: {l}"
                );
            }
        }
    }
}

#[test]
fn forward_a_point_spreads_as_its_kernel_and_backward_as_the_kernel_turned() {
    // Seen aslant, a kernel is lopsided: it reaches further away from the eye than towards it.
    let s = setting(SIZE, 0.8, 1.2, ggx(0.1), |_| 3.0);
    let (point, nearness, _) = s.middle();
    let kernel = Kernel::on_level(&s.lens, &point, nearness, 0, 6);
    let (total, edge) = (kernel.weights.iter().sum::<f32>(), 13);
    let (x0, y0) = (SIZE[0] as usize / 2, SIZE[1] as usize / 2);
    let mut radiance = vec![Vec3::ZERO; s.image.radiance.len()];
    radiance[y0 * SIZE[0] as usize + x0] = Vec3::ONE;
    let masked = Masked { size: SIZE, mask: vec![1.0; radiance.len()], radiance };
    let mut lopsided = 0.0f32;
    for way in Way::ALL {
        let [backward, forward] = Convention::ALL.map(|c| masked.convolved(&kernel, c, way));
        for i in 0..edge * edge {
            let (dx, dy) = (i % edge, i / edge);
            let at = |x: usize, y: usize| (y0 + y - 6) * SIZE[0] as usize + x0 + x - 6;
            let wanted = kernel.weights[i] / total;
            let [b, f] = [backward[at(12 - dx, 12 - dy)].x, forward[at(dx, dy)].x];
            assert!((f - wanted).abs() < 1e-6 && (b - wanted).abs() < 1e-6, "{way:?} {i}: {f} {b} {wanted}");
            lopsided = lopsided.max((kernel.weights[edge * edge - 1 - i] / kernel.weights[i] - 1.0).abs());
        }
        // What a point sends is shared out: no light is made, none is lost.
        for picture in [backward, forward] {
            let sum: f32 = picture.iter().map(|p| p.x).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{way:?}: {sum}");
        }
    }
    assert!(lopsided > 0.1, "both conventions are the same for this kernel: nothing was told apart");
}

#[test]
fn small_kernels_are_summed_and_large_ones_transformed() {
    let size = [720, 486];
    assert_eq!((Way::cheaper(size, 1), Way::cheaper(size, 60)), (Way::Direct, Way::Fourier));
    // One change only, and at it both are expected to cost the same within one step of the radius.
    let ways: Vec<Way> = (1..200).map(|r| Way::cheaper(size, r)).collect();
    assert_eq!(ways.windows(2).filter(|w| w[0] != w[1]).count(), 1);
}

#[test]
fn a_kernel_on_a_coarser_level_is_near_the_sum_over_every_pixel() {
    for lobe in lobes() {
        let mut s = setting(SIZE, 0.8, 0.7, lobe, |_| 3.0);
        let (point, nearness, support) = s.middle();
        let radius =
            point.radius_pixels(nearness, support, s.lens.pixel_angle()).ceil().clamp(1.0, 32.0) as i32;
        // A wave four radii long.
        let wave = std::f32::consts::TAU / (4 * radius) as f32;
        for (i, radiance) in s.image.radiance.iter_mut().enumerate() {
            *radiance = Vec3::splat(1.0 + (wave * (i as u32 % SIZE[0]) as f32).cos());
        }
        let (found, kernel) = s.invariant();
        let SplitKernel { peak, rest } = &kernel;
        assert_eq!(rest.is_none(), radius <= WIDEST as i32);
        // As far as the outermost texels reach, to half a pixel.
        let outer = rest.as_ref().unwrap_or(peak);
        let reach = (((2 * outer.radius + 1) << outer.level) / 2) as i32;
        let middle = s.lens.place(point.from_eye);
        let (mut worst, mut largest) = (0.0f32, 0.0f32);
        // At the edge of what is seen there is nothing to read between.
        let edge = 1 << outer.level;
        for y in (edge..SIZE[1] as i32 - edge).step_by(3) {
            for x in (edge..SIZE[0] as i32 - edge).step_by(3) {
                let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
                for dy in -reach..=reach {
                    for dx in -reach..=reach {
                        let (u, v) = (x + dx, y + dy);
                        if (0..SIZE[0] as i32).contains(&u) && (0..SIZE[1] as i32).contains(&v) {
                            let direction = s.lens.direction(middle + Vec2::new(dx as f32, dy as f32));
                            let weight = point.weight(direction, nearness, s.lens.pixel_angle());
                            sum += s.image.radiance[(v * SIZE[0] as i32 + u) as usize] * weight;
                            weights += weight;
                        }
                    }
                }
                let i = (y * SIZE[0] as i32 + x) as usize;
                worst = worst.max((found[i] - sum / weights).abs().max_element());
                largest = largest.max((s.image.radiance[i] - sum / weights).abs().max_element());
            }
        }
        // Means over texels of edge s and what lies between them add a variance of s²/12 + s²/6, which would take
        // k² s²/8 of a wave and is taken off again; weights are taken at the middles of texels, which differ from
        // their means by less than that; beside it rounding.
        let sum = |k: &Kernel| k.weights.iter().sum::<f32>();
        let blur = |k: &Kernel| if k.level == 0 { 0.0 } else { (wave * (1 << k.level) as f32).powi(2) / 8.0 };
        let beyond = rest.as_ref().map_or(0.0, |rest| sum(rest) / (sum(rest) + sum(peak)));
        let most = 1e-5 + (1.0 - beyond) * blur(peak) + beyond * rest.as_ref().map_or(0.0, blur);
        println!(
            "{lobe:?}: level {}, radius {radius}, {:.0} % in the rest, worst {worst} of a change of {largest}, \
             at most {most}",
            peak.level,
            100.0 * beyond
        );
        assert!(worst < most && most < 0.04, "{lobe:?}: {worst}, at most {most}");
    }
}

#[test]
fn a_reflector_is_measured_by_its_means() {
    let mut measure = Measure::default();
    assert!(measure.mean(Vec3::Z, ggx(0.1)).is_none());
    measure.add(Vec3::new(0.0, 0.0, -2.0), 2.0);
    measure.add(Vec3::new(0.0, 1.0, -2.0), f32::INFINITY);
    let (point, nearness) = measure.mean(Vec3::Z, ggx(0.1)).unwrap();
    assert_eq!((point.from_eye, measure.share), (Vec3::new(0.0, 0.5, -2.0), 1.5));
    // Three quarters of the unfolded way lie behind the mirror.
    assert!((1.0 - point.from_eye.length() * nearness - 0.75).abs() < 1e-6);
    let lens = setting(SIZE, 0.8, 0.3, ggx(0.1), |_| 1.0).lens;
    let at = Vec2::new(20.3, 30.8);
    assert!(lens.place(3.0 * lens.direction(at)).distance(at) < 1e-3);
}

/// A wall behind a mirror across the view at such a distance that the kernel has a radius of so many pixels: seen
/// through a narrow angle along the normal, distances are equal to 1e-3 and so are lobes.
fn equally_far(lobe: Lobe, radius: f32) -> Setting {
    const FOV: f32 = 0.02;
    let size = [192, 144];
    let share = radius * FOV / size[1] as f32 / LobeTable::new(lobe).at(1.0).support;
    setting(size, FOV, 0.0, lobe, |_| 2.0 * share / (1.0 - share))
}

#[test]
fn where_all_is_equally_far_both_kernels_have_the_same_weights() {
    for lobe in lobes() {
        let s = equally_far(lobe, 3.0);
        let variant = s.variant();
        let (point, nearness, _) = s.middle();
        let kernel = Kernel::on_level(&s.lens, &point, nearness, 0, 5);
        let (mut worst, mut change) = (0.0f32, 0.0f32);
        for (x, y) in (20..124).flat_map(|y| (20..172).map(move |x| (x, y))) {
            // The window of the variant one: ten pixels from four before each pair on.
            let (mut sum, mut weights) = (0.0, 0.0);
            for (tx, ty) in (0..100).map(|i| (x / 2 * 2 - 4 + i % 10, y / 2 * 2 - 4 + i / 10)) {
                let weight = kernel.weights[((ty + 5 - y) * 11 + tx + 5 - x) as usize];
                sum += weight * s.image.radiance[s.number([tx, ty])].x;
                weights += weight;
            }
            let i = s.number([x, y]);
            worst = worst.max((variant[i].x - sum / weights).abs());
            change = change.max((s.image.radiance[i].x - sum / weights).abs());
        }
        println!("{lobe:?}: worst {worst} of a change of {change}");
        // Of noise from 0 to 255.
        assert!(worst < 1e-3 * 255.0 && change > 50.0, "{lobe:?}: {worst} of {change}");
    }
}

#[test]
fn where_all_is_equally_far_both_kernels_give_the_same_picture() {
    // Phong's lobe ends where its support does; of GGX's as much lies beyond as the invariant kernel leaves out.
    for (alpha, radius) in ALPHAS.into_iter().flat_map(|alpha| [3.0, 6.0, 12.0].map(|radius| (alpha, radius)))
    {
        let lobe = Lobe::new(LobeShape::Phong, alpha);
        let wave = std::f32::consts::TAU / (24.0 * radius);
        let s = equally_far(lobe, radius);
        let s = s.showing(|[x, y]| 1.0 + 0.5 * (wave * (x as f32 + 0.5 * y as f32)).cos());
        let variant = s.variant();
        let (invariant, kernel) = s.invariant();
        let (mut worst, mut change) = (0.0f32, 0.0f32);
        for i in (40..104).flat_map(|y| (40..152).map(move |x| [x, y])).map(|p| s.number(p)) {
            worst = worst.max((variant[i].x / invariant[i].x - 1.0).abs());
            change = change.max((s.image.radiance[i].x / invariant[i].x - 1.0).abs());
        }
        println!("α {alpha}, radius {radius}: level {}, worst {worst} of {change}", kernel.peak.level);
        assert!(worst <= 1e-3 && change > 6e-3, "α {alpha}, radius {radius}: {worst} of {change}");
    }
}

#[test]
fn what_touches_the_surface_stays_sharp_and_what_is_far_is_blurred() {
    for shape in SHAPES {
        let lobe = Lobe::new(shape, 0.04);
        let blur = |distance: f32| {
            let s = setting(SIZE, 0.6, 0.5, lobe, |_| distance);
            let found = s.variant();
            let change = found.iter().zip(&s.image.radiance).map(|(a, b)| (*a - *b).abs().x).sum::<f32>();
            change / found.len() as f32
        };
        let blurs = [0.0, 0.002, 0.05, 1.0, 20.0].map(blur);
        println!("{shape:?}, mean change by distance: {blurs:?}");
        assert!(blurs[0] < 0.5 && blurs.windows(2).all(|w| w[0] < w[1]), "{blurs:?}");
    }
}

#[test]
fn the_library_reflects_what_quadrature_says() {
    let gold = Vec3::new(0.63, 0.56, 0.37);
    for (shape, alpha) in SHAPES.into_iter().flat_map(|s| [0.01, 0.04, 0.16].map(|alpha| (s, alpha))) {
        let table = LobeTable::new(Lobe::new(shape, alpha));
        for (metallic, cos) in [(1.0, 0.95), (1.0, 0.5), (1.0, 0.2), (0.0, 0.7), (0.0, 0.3)] {
            let specular =
                Specular { metal: gold, metallic, dielectric: 0.04, alpha, shape, ..Specular::default() };
            let brdf = Brdf { specular: Some(specular), ..Brdf::default() };
            let wo = Vec3::new((1.0f32 - cos * cos).sqrt(), 0.0, cos);
            let n = 20_000;
            let mut wanted = Vec3::ZERO;
            for i in 0..n {
                let u = r2_point(i, 5);
                if let Some(s) = brdf.sample(Vec3::Z, wo, 0.5, u) {
                    wanted += s.specular / n as f32;
                }
            }
            let found = table.modulation(&specular, cos);
            let error = ((found - wanted).abs() / wanted).max_element();
            println!("{shape:?}, α {alpha} cos {cos} metallic {metallic}: {found} for {wanted}, {error:.4}");
            // A coat's angle is fitted; a metal's mean angle stands for a lobe of them.
            assert!(error < if metallic == 0.0 { 0.02 } else { 0.05 }, "{error}");
            assert!(found.max_element() <= 1.0 && table.at(cos).albedo <= 1.0);
        }
        let sharp = LobeTable::new(Lobe::new(shape, 0.0025)).at(0.7);
        // Phong's lobe keeps as much as the cosine of its middle says.
        let kept = if shape == LobeShape::Phong { 0.7 } else { 1.0 };
        assert!((sharp.albedo - kept).abs() < 2e-3 && (sharp.metal_cosine - 0.7).abs() < 0.01);
        assert!((sharp.support - 0.0).abs() < 0.05 && table.at(0.7).support > sharp.support);
    }
}

#[test]
fn merged_texels_keep_the_mean_of_the_reflector_that_covers_most() {
    let t = |r: u32, l: f32, c: f32| Texel {
        radiance: Vec3::splat(l),
        nearness: 0.1 * l,
        coverage: c,
        reflector: r,
    };
    let m = Texel::merged([t(1, 2.0, 1.0), t(1, 4.0, 0.5), t(2, 9.0, 1.0), Texel::NONE]);
    assert_eq!((m.reflector, m.coverage), (1, 0.375));
    assert!((m.radiance.x - 4.0 / 1.5).abs() < 1e-6 && (m.nearness - 0.4 / 1.5).abs() < 1e-6);
    assert_eq!(Texel::merged([Texel::NONE; 4]), Texel::NONE);
    assert_eq!(level_size([5, 3], 2), [2, 1]);
}
