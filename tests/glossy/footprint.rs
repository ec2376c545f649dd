//! The shape of a lobe's footprint in the mirror image, and what becomes of it at the edge of something near.

use super::setting::{ALPHAS, SHAPES, Setting, setting};
use lumenscope_core::{
    glossy::{
        convolution::{Convention, Masked, Way},
        invariant::Kernel,
    },
    scene::brdf::{Lobe, LobeShape},
};

/// Width between the first and the last place along a line where it rises above and falls below half of its largest.
fn width_at_half(line: &[f32]) -> f32 {
    let half = 0.5 * line.iter().copied().fold(0.0, f32::max);
    let crossings = line.windows(2).enumerate().filter(|(_, w)| (w[0] < half) != (w[1] < half));
    let places: Vec<f32> = crossings.map(|(i, w)| i as f32 + (half - w[0]) / (w[1] - w[0])).collect();
    places[places.len() - 1] - places[0]
}

/// Widths at half of the peak of a narrow lobe, in the plane of incidence and across it, rad.
///
/// GGX: f cos θᵢ ~ D(h) ~ (1 + tan² θₕ / α²)⁻² falls to half at tan θₕ = τ = α √(√2 − 1). In the plane a half vector
/// that leans by τ turns the direction by 2τ; across it h ~ ωₒ + ωᵢ = 2 cos θ n + φ y leans by φ / (2 cos θ), so that
/// φ = 2τ cos θ: the footprint is 1 / cos θ times as long as wide. Phong: cosⁿ is round at any angle.
fn half_widths(lobe: Lobe, cos_theta: f32) -> [f32; 2] {
    match lobe {
        Lobe::Ggx { alpha } => {
            let tau = alpha * (2f32.sqrt() - 1.0).sqrt();
            [4.0 * tau, 4.0 * tau * cos_theta]
        }
        Lobe::Phong { exponent } => [2.0 * 0.5f32.powf(1.0 / exponent).acos(); 2],
    }
}

#[test]
fn a_microfacet_footprint_is_as_much_longer_as_the_cosine_says_and_phongs_is_round() {
    for shape in SHAPES {
        for degrees in [0.0f32, 45.0, 60.0, 75.0, 80.0] {
            let lobe = Lobe::new(shape, 0.005);
            let theta = degrees.to_radians();
            // Infinitely far: directions from the point are those from the eye.
            let s = setting([128, 128], 0.032, theta, lobe, |_| f32::INFINITY);
            let (point, nearness, _) = s.middle();
            let radius = 60;
            let kernel = Kernel::on_level(&s.lens, &point, nearness, 0, radius);
            let edge = 2 * radius as usize + 1;
            let row: Vec<f32> = (0..edge).map(|x| kernel.weights[radius as usize * edge + x]).collect();
            let column: Vec<f32> = (0..edge).map(|y| kernel.weights[y * edge + radius as usize]).collect();
            let found = [row, column].map(|line| width_at_half(&line) * s.lens.pixel_angle());
            let wanted = half_widths(lobe, theta.cos());
            println!(
                "{shape:?} at {degrees}°: {found:?} for {wanted:?}, {:.3} times as long, 1 / cos θ {:.3}",
                found[0] / found[1],
                1.0 / theta.cos()
            );
            // Reading between pixels, and what α tan θ, at most 0.028, does to second order.
            for k in 0..2 {
                assert!(
                    (found[k] / wanted[k] - 1.0).abs() < 0.01,
                    "{shape:?} at {degrees}°: {found:?}, {wanted:?}"
                );
            }
        }
    }
}

/// Pixels over which a step of light across a picture goes from a quarter to three quarters along a line.
fn quartiles(line: &[f32]) -> f32 {
    let at = |value: f32| {
        let i = line.windows(2).position(|w| w[0] < value && w[1] >= value).unwrap();
        i as f32 + (value - line[i]) / (line[i + 1] - line[i])
    };
    at(0.75) - at(0.25)
}

#[test]
fn pictures_stretch_at_grazing_angles_as_their_lobes_do() {
    let in_full = |s: &Setting| {
        let (point, nearness, _) = s.middle();
        let kernel = Kernel::on_level(&s.lens, &point, nearness, 0, 100);
        let (radiance, mask) = (s.image.radiance.clone(), vec![1.0; s.image.radiance.len()]);
        Masked { size: s.size, radiance, mask }.convolved(&kernel, Convention::Backward, Way::Fourier)
    };
    let by = |s: &Setting| [s.variant(), s.invariant().0, in_full(s)];
    for (shape, degrees) in [(LobeShape::Ggx, 60.0f32), (LobeShape::Ggx, 75.0), (LobeShape::Phong, 75.0)] {
        let lobe = Lobe::new(shape, 0.0025);
        let theta = degrees.to_radians();
        let step = |along: usize| {
            let s = setting([256, 256], 0.06, theta, lobe, |_| f32::INFINITY);
            s.showing(|p| f32::from(u8::from(p[along] >= 128)))
        };
        let steps = [step(0), step(1)];
        let [in_plane, across] = steps.each_ref().map(by);
        let wanted = if shape == LobeShape::Ggx { 1.0 / theta.cos() } else { 1.0 };
        for (k, name) in ["variant", "invariant", "in full"].into_iter().enumerate() {
            let row: Vec<f32> = (0..256).map(|x| in_plane[k][steps[0].number([x, 128])].x).collect();
            let column: Vec<f32> = (0..256).map(|y| across[k][steps[1].number([128, y])].x).collect();
            let [long, wide] = [row, column].map(|line| quartiles(&line));
            let ratio = long / wide;
            println!(
                "{shape:?} at {degrees}°, {name}: {long:.1} by {wide:.1} pixels, {ratio:.3} for {wanted:.3}"
            );
            // The angle changes by 1° over the step; beyond the support kernels end.
            // Known: the texels of one kernel a reflector are square and as coarse as its length allows, so that at
            // 75° it is twice as long as wide.
            let wanted = if name == "invariant" && wanted > 3.0 { 2.0 } else { wanted };
            assert!(
                (ratio / wanted - 1.0).abs() < 0.1,
                "{shape:?} at {degrees}°, {name}: {ratio} for {wanted}"
            );
        }
    }
}

/// Share of a narrow GGX lobe along the normal that lies to one side of a straight line, at a slope from its middle: the
/// lobe is 1 / (π a² (1 + s²/a²)²) over slopes, a = 2α, whose integral along the line and then up to it is
/// ½ (1 + x / √(a² + x²)).
fn share_within(x: f32, a: f32) -> f32 {
    0.5 * (1.0 + x / (a * a + x * x).sqrt())
}

/// A mirror across the view whose left half shows a white wall `near` m behind it, its right half a black one `far` m
/// behind.
fn two_walls(alpha: f32, [near, far]: [f32; 2]) -> Setting {
    let lobe = Lobe::new(LobeShape::Ggx, alpha);
    let s = setting([256, 192], 0.5, 0.0, lobe, |[x, _]| if x < 128 { near } else { far });
    s.showing(|[x, _]| if x < 128 { 1.0 } else { 0.0 })
}

#[test]
fn across_a_depth_edge_no_more_comes_than_the_point_sees_of_it_at_its_own_depth() {
    // Slope of the eye's ray through a pixel of the middle row from that through the edge.
    let slope = |x: u32| 2.0 * (x as f32 + 0.5 - 128.0) / 192.0 * 0.25f32.tan();
    for (alpha, walls) in [(0.01, [0.1, 3.0]), (0.04, [0.02, 1.0]), (0.04, [0.1, 3.0]), (0.04, [3.0, 0.1])] {
        let s = two_walls(alpha, walls);
        let found = s.variant();
        let (a, nearer) = (2.0 * alpha, usize::from(walls[1] < walls[0]));
        let (mut excess, mut worst) = (0.0f32, 0.0f32);
        for x in 64..192 {
            // From a point of the mirror, 2 m before the eye, the edge of what lies d behind is seen at the slope
            // (2 + d)(e − p) / d from the mirrored direction.
            let seen = walls.map(|d| -(2.0 + d) * slope(x) / d);
            let shares = [share_within(seen[0], a), 1.0 - share_within(seen[1], a)];
            let own = usize::from(x >= 128);
            let white = found[s.number([x, 96])].x;
            let other = [1.0 - white, white][own];
            let wanted = shares[1 - own] / (shares[0] + shares[1]);
            excess = excess.max(other - wanted);
            // The kernel of what is near ends before it has met all of what is far.
            if own != nearer {
                worst = worst.max((other - wanted).abs());
            }
        }
        println!(
            "α {alpha}, {walls:?} m: at most {excess:.4} more than seen, {worst:.4} beside it before what is near"
        );
        // Weights are taken at the middles of texels; by the pixel's own depth it would be up to a half.
        assert!(excess < 0.015 && worst < 0.05, "α {alpha}, {walls:?} m: {excess}, {worst}");
    }
}

#[test]
fn nothing_bleeds_across_the_edge_of_what_touches_the_mirror() {
    for alpha in ALPHAS {
        let s = two_walls(alpha, [0.0, 2.0]);
        let found = s.variant();
        // A touching texel counts as half its edge away and as if in the mirrored direction: with four times the
        // lobe's peak, 1 / (π a²), a = 2α, against half a lobe at most of what is far.
        let touching = 1.0 / (std::f32::consts::PI * alpha * alpha);
        let most = 0.5 / (0.5 + touching);
        let other = |x: u32| {
            let white = found[s.number([x, 96])].x;
            if x < 128 { 1.0 - white } else { white }
        };
        let worst = (64..192).map(other).fold(0.0, f32::max);
        println!("α {alpha}: {worst:.2e}, at most {most:.2e}");
        assert!(worst <= most, "α {alpha}: {worst}, at most {most}");
    }
}
