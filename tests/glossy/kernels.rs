//! Synthetic mirror images: what every kernel must keep, and where two kernels must agree.

use glam::{Vec2, Vec3};
use lumenscope_core::{
    glossy::{
        convolution::{Convention, Masked, Way},
        invariant::{Kernel, Measure, SplitKernel, WIDEST, convolve},
        kernel::{GlossyPoint, Lens},
        lobes::LobeTable,
        pyramid::{Pyramid, Texel, level_size},
        variant::gather,
    },
    math::random::{hash2, r2_point},
    mirror::{pass::MirrorImage, reflectors::NO_REFLECTOR, views::Eye},
    scene::{
        brdf::{Brdf, Specular},
        camera::Camera,
    },
};

const SIZE: [u32; 2] = [64, 48];

/// A mirror across the view at 2 m, tilted by `tilt` about the vertical, that shows a wall `behind` m behind it.
struct Setting {
    lens: Lens,
    normal: Vec3,
    image: MirrorImage,
    eye_distance: Vec<f32>,
    alpha: f32,
}

fn setting(fov: f32, tilt: f32, alpha: f32, distance: impl Fn(usize) -> f32) -> Setting {
    let camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, vertical_fov: fov };
    let size = Vec2::new(SIZE[0] as f32, SIZE[1] as f32);
    let lens = Lens { eye: Eye::new(&camera, size.x / size.y), size, subpixel: Vec2::splat(0.5) };
    let normal = Vec3::new(tilt.sin(), 0.0, tilt.cos());
    let count = (SIZE[0] * SIZE[1]) as usize;
    let at = |i: usize| Vec2::new((i as u32 % SIZE[0]) as f32, (i as u32 / SIZE[0]) as f32) + 0.5;
    let eye_distance: Vec<f32> =
        (0..count).map(|i| -2.0 * normal.z / normal.dot(lens.direction(at(i)))).collect();
    let radiance = (0..count).map(|i| Vec3::splat((hash2(i as u32 / 5, 3) & 255) as f32)).collect();
    let image = MirrorImage {
        width: SIZE[0],
        height: SIZE[1],
        reflector: vec![0; count],
        radiance,
        distance: (0..count).map(distance).collect(),
        views: 1,
        holes: 0,
    };
    Setting { lens, normal, image, eye_distance, alpha }
}

impl Setting {
    fn point(&self, i: usize) -> GlossyPoint {
        let at = Vec2::new((i as u32 % SIZE[0]) as f32, (i as u32 / SIZE[0]) as f32) + 0.5;
        let from_eye = self.lens.direction(at) * self.eye_distance[i];
        GlossyPoint { from_eye, normal: self.normal, alpha: self.alpha }
    }

    fn variant(&self) -> Vec<Vec3> {
        let pyramid = Pyramid::new(&self.image, &self.eye_distance, |_| true);
        let table = LobeTable::new(self.alpha);
        (0..self.image.radiance.len())
            .map(|i| {
                if self.image.reflector[i] == NO_REFLECTOR {
                    return Vec3::ZERO;
                }
                let point = self.point(i);
                let support = table.at(point.cos_theta()).support;
                let pixel = [i as i32 % SIZE[0] as i32, i as i32 / SIZE[0] as i32];
                gather(&pyramid, &self.lens, &point, pixel, self.image.reflector[i], support).radiance
            })
            .collect()
    }

    /// The point in the middle, the nearness of what it mirrors and tan β of its lobe.
    fn middle(&self) -> (GlossyPoint, f32, f32) {
        let i = self.image.radiance.len() / 2 + SIZE[0] as usize / 2;
        let point = self.point(i);
        let nearness = 1.0 / (self.eye_distance[i] + self.image.distance[i]);
        (point, nearness, LobeTable::new(self.alpha).at(point.cos_theta()).support)
    }

    fn kernel(&self, pyramid: &Pyramid) -> SplitKernel {
        let (point, nearness, support) = self.middle();
        SplitKernel::new(&self.lens, &point, nearness, support, pyramid.levels.len())
    }

    /// One kernel for all pixels of reflector 0, with its level.
    fn invariant(&self) -> (Vec<Vec3>, SplitKernel) {
        let pyramid = Pyramid::new(&self.image, &self.eye_distance, |_| true);
        let kernel = self.kernel(&pyramid);
        let texels = convolve(&pyramid, 0, &kernel);
        let at = |i: usize| {
            let pixel = [i as i32 % SIZE[0] as i32, i as i32 / SIZE[0] as i32];
            kernel.at_pixel(&pyramid, &texels, 0, pixel, self.image.radiance[i])
        };
        ((0..self.image.radiance.len()).map(at).collect(), kernel)
    }
}

/// Roughness 0.05, 0.1, 0.2, 0.4.
const ALPHAS: [f32; 4] = [0.0025, 0.01, 0.04, 0.16];

#[test]
fn constant_light_stays_constant_under_every_kernel() {
    for alpha in ALPHAS {
        for tilt in [0.0, 0.9, 1.3] {
            // Near things before far ones, a hole, and a patch of another reflector.
            let mut s = setting(0.8, tilt, alpha, |i| if i % 7 < 3 { 0.02 } else { 1.0 + (i % 50) as f32 });
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
                assert!(error < 1e-4, "α {alpha}, tilt {tilt}: pixel {i} is {found}");
            }
            for (i, found) in s.invariant().0.iter().enumerate().filter(|(i, _)| s.image.reflector[*i] == 0) {
                let error = (*found - Vec3::new(3.0, 2.0, 1.0)).abs().max_element();
                assert!(error < 1e-4, "α {alpha}, tilt {tilt}: pixel {i} is {found}");
            }
        }
    }
}

#[test]
fn both_ways_of_summing_agree_keep_white_and_go_beyond_nothing_they_sum() {
    for radius in [1, 4, 9, 20] {
        let s = setting(0.8, 0.7, 0.04, |_| 3.0);
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
                    "{way:?}, {convention:?}, radius {radius}: {l}"
                );
            }
        }
    }
}

#[test]
fn forward_a_point_spreads_as_its_kernel_and_backward_as_the_kernel_turned() {
    // Seen aslant, a kernel is lopsided: it reaches further away from the eye than towards it.
    let s = setting(0.8, 1.2, 0.1, |_| 3.0);
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
    for alpha in ALPHAS {
        let mut s = setting(0.8, 0.7, alpha, |_| 3.0);
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
            "α {alpha}: level {}, radius {radius}, {:.0} % in the rest, worst {worst} of a change of {largest}, \
             at most {most}",
            peak.level,
            100.0 * beyond
        );
        assert!(worst < most && most < 0.04, "α {alpha}: {worst}, at most {most}");
    }
}

#[test]
fn a_reflector_is_measured_by_its_means() {
    let mut measure = Measure::default();
    assert!(measure.mean(Vec3::Z, 0.1).is_none());
    measure.add(Vec3::new(0.0, 0.0, -2.0), 2.0);
    measure.add(Vec3::new(0.0, 1.0, -2.0), f32::INFINITY);
    let (point, nearness) = measure.mean(Vec3::Z, 0.1).unwrap();
    assert_eq!((point.from_eye, measure.share), (Vec3::new(0.0, 0.5, -2.0), 1.5));
    // Three quarters of the unfolded way lie behind the mirror.
    assert!((1.0 - point.from_eye.length() * nearness - 0.75).abs() < 1e-6);
    let lens = setting(0.8, 0.3, 0.1, |_| 1.0).lens;
    let at = Vec2::new(20.3, 30.8);
    assert!(lens.place(3.0 * lens.direction(at)).distance(at) < 1e-3);
}

#[test]
fn both_kernels_agree_where_everything_is_equally_far() {
    for alpha in [0.0025, 0.01, 0.04] {
        // Seen through a narrow angle along the normal, distances and directions are equal to 1e-3.
        let s = setting(0.05, 0.0, alpha, |_| 0.15);
        let variant = s.variant();
        let (invariant, kernel) = s.invariant();
        let (mut worst, mut change) = (0.0f32, 0.0f32);
        for y in 12..36 {
            for x in 14..50 {
                let i = y * SIZE[0] as usize + x;
                worst = worst.max((variant[i] - invariant[i]).abs().max_element());
                change = change.max((s.image.radiance[i] - invariant[i]).abs().max_element());
            }
        }
        let (radius, level) = (kernel.peak.radius, kernel.peak.level);
        println!(
            "α {alpha}: peak of radius {radius} on level {level}, worst {worst} of a change of {change}"
        );
        // Beyond four pixels the variant kernel reads means of 2 × 2, and its tail goes on where the
        // invariant one is cut at 95 %.
        assert!(worst < 0.05 * 255.0, "α {alpha}: {worst}");
    }
}

#[test]
fn what_touches_the_surface_stays_sharp_and_what_is_far_is_blurred() {
    let blur = |distance: f32| {
        let s = setting(0.6, 0.5, 0.04, |_| distance);
        let found = s.variant();
        let change = found.iter().zip(&s.image.radiance).map(|(a, b)| (*a - *b).abs().x).sum::<f32>();
        change / found.len() as f32
    };
    let blurs = [0.0, 0.002, 0.05, 1.0, 20.0].map(blur);
    println!("mean change by distance: {blurs:?}");
    assert!(blurs[0] < 0.5 && blurs.windows(2).all(|w| w[0] < w[1]), "{blurs:?}");
}

#[test]
fn the_library_reflects_what_quadrature_says() {
    let gold = Vec3::new(0.63, 0.56, 0.37);
    for alpha in [0.01, 0.04, 0.16] {
        let table = LobeTable::new(alpha);
        for (metallic, cos) in [(1.0, 0.95), (1.0, 0.5), (1.0, 0.2), (0.0, 0.7), (0.0, 0.3)] {
            let specular = Specular { metal: gold, metallic, dielectric: 0.04, alpha, ..Specular::default() };
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
            println!("α {alpha} cos {cos} metallic {metallic}: {found} for {wanted}, {error:.4}");
            // A coat's angle is fitted; a metal's mean angle stands for a lobe of them.
            assert!(error < if metallic == 0.0 { 0.02 } else { 0.05 }, "{error}");
            assert!(found.max_element() <= 1.0 && table.at(cos).albedo <= 1.0);
        }
        let sharp = LobeTable::new(0.0025).at(0.7);
        assert!((sharp.albedo - 1.0).abs() < 2e-3 && (sharp.metal_cosine - 0.7).abs() < 0.01);
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
