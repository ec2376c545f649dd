//! Where a volume is known to fail: thin walls, samples in solids, points outside.

use super::*;
use lumenscope_core::{
    irradiance_volume::{trust::SampleState, visibility::PointState},
    math::colour::luminance,
    radiosity::{RadiositySettings, RadiositySolution},
    reference::irradiance::irradiance,
    scene::{direct::Receiver, import},
};

fn solved(path: &str, settings: &VolumeSettings) -> (World, IrradianceVolume) {
    solved_by(32, path, settings)
}

/// By so many gather rays an element.
fn solved_by(gather_rays: u32, path: &str, settings: &VolumeSettings) -> (World, IrradianceVolume) {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let world = World::new(&import::load(&root.join(path)).unwrap());
    let radiosity =
        RadiositySettings { gather_rays, element_spacing_m: Some(0.2), ..RadiositySettings::default() };
    let radiosity = RadiositySolution::solve(&world, &radiosity, &Progress::silent()).unwrap();
    let volume = IrradianceVolume::build(&world, &radiosity, settings, &Progress::silent()).unwrap();
    (world, volume)
}

/// Mean illuminance over random points of a box and random directions, and the largest, lx.
fn light_in(volume: &IrradianceVolume, low: Vec3, high: Vec3) -> (f32, f32) {
    let light = lumenscope_core::measure::leak::light_in(volume, [low, high]);
    (light.mean_lx, light.most_lx)
}

#[test]
fn light_leaks_through_a_thin_wall_unless_guarded() {
    // A wall of 2 cm: no sample lies in it, and the cells that it runs through hold samples of both rooms.
    // Cells of 12 cm beside it, of 50 cm, and of 1 m.
    let mut coarsest = 0.0;
    for (samples, second_level) in [(None, 3), (Some([9, 6, 7]), 2), (Some([5, 4, 4]), 2)] {
        let settings = VolumeSettings { samples, second_level, ..plain_settings() };
        let (world, plain) = solved("analytic/two_rooms.ron", &settings);
        let guarded = plain.with_guard(Some(&world));
        let leak = |volume: &IrradianceVolume| {
            let (lit, _) = light_in(volume, Vec3::new(-2.0, 0.0, -1.5), Vec3::new(0.29, 2.5, 1.5));
            let (dark, most) = light_in(volume, Vec3::new(0.31, 0.0, -1.5), Vec3::new(2.0, 2.5, 1.5));
            (dark / lit, most / lit)
        };
        let (before, after) = (leak(&plain), leak(&guarded));
        eprintln!(
            "{} samples: leak {:.3} %, at worst {:.1} %, trilinear; {:.4} %, at worst {:.4} %, guarded",
            plain.samples().len(),
            100.0 * before.0,
            100.0 * before.1,
            100.0 * after.0,
            100.0 * after.1
        );
        assert!(before.1 > 0.05, "{before:?}");
        assert!(after.0 <= 0.01 && after.1 <= 0.01, "{after:?}");
        coarsest = before.0;
        // What the guard takes away on the dark side it gives back on the lit one.
        let near = |volume: &IrradianceVolume| {
            light_in(volume, Vec3::new(0.2, 0.5, -1.0), Vec3::new(0.289, 2.0, 1.0)).0
        };
        assert!(near(&guarded) > 1.1 * near(&plain));
    }
    assert!(coarsest > 0.01, "{coarsest}");
}

#[test]
fn a_guard_changes_nothing_where_nothing_stands() {
    let scene = room([Vec3::ZERO; 6]);
    let light = PerTriangle((0..12).map(|t| Vec3::splat(10.0 + t as f32)).collect());
    let plain = build(&scene, &light, &small([4, 3, 4]));
    let guarded = plain.with_guard(Some(&World::new(&scene)));
    for i in 0..2000 {
        let mut rng = Rng::new(2, i);
        let p = Vec3::new(rng.next_f32() * 3.0, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
        let n = uniform_direction(rng.next_vec2());
        assert_eq!(plain.irradiance(p, n, Part::All), guarded.irradiance(p, n, Part::All), "at {p}");
    }
    // Points on the walls themselves, too: the rays stop short of them.
    for p in [Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 2.5, 3.0), Vec3::new(1.3, 0.0, 0.4)] {
        assert_eq!(plain.weights(p).weights, guarded.weights(p).weights, "at {p}");
    }
}

#[test]
fn a_closed_box_stays_dark_and_says_why() {
    let settings = VolumeSettings { guard: true, ..plain_settings() };
    let (_, guarded) = solved("analytic/closed_box.ron", &settings);
    let (world, plain) = solved("analytic/closed_box.ron", &plain_settings());
    let (low, high) = (Vec3::new(-0.3, 0.21, -0.3), Vec3::new(0.3, 0.81, 0.3));
    let (lit, _) = light_in(&plain, Vec3::new(-1.5, 1.1, -1.5), Vec3::new(1.5, 2.4, 1.5));
    let (inside_plain, _) = light_in(&plain, low, high);
    let (inside, most) = light_in(&guarded, low, high);
    eprintln!(
        "closed box: {:.2} % trilinear, {:.3} % guarded",
        100.0 * inside_plain / lit,
        100.0 * inside / lit
    );
    assert!(inside <= 0.01 * lit && most <= 0.05 * lit, "{inside} {most} of {lit} lx");
    // A probe in the wall sees backs alone, and the samples there are masked.
    let in_wall = Vec3::new(0.4, 0.5, 0.0);
    let radiosity = RadiositySolution::solve(
        &world,
        &RadiositySettings { gather_rays: 8, ..Default::default() },
        &Progress::silent(),
    );
    let probe = Probe::at(&world, &radiosity.unwrap(), in_wall, 9, 1, 0).unwrap();
    assert!(probe.back_face_fraction > 0.9, "{}", probe.back_face_fraction);
    let wall = |p: Vec3| {
        p.cmpgt(Vec3::new(-0.49, 0.02, -0.49)).all()
            && p.cmplt(Vec3::new(0.49, 1.0, 0.49)).all()
            && !(p.cmpgt(low - 0.01).all() && p.cmplt(high + 0.01).all())
    };
    let in_walls: Vec<_> = plain.samples().iter().filter(|s| wall(s.position)).collect();
    assert!(
        in_walls.len() > 10 && in_walls.iter().all(|s| s.state == SampleState::Masked),
        "{}",
        in_walls.len()
    );
}

#[test]
fn a_tunnel_darkens_steadily() {
    let settings = VolumeSettings { guard: true, ..plain_settings() };
    let (_, volume) = solved("analytic/tunnel.ron", &settings);
    let at = |x: f32| luminance(volume.irradiance(Vec3::new(x, 1.0, 0.0), Vec3::NEG_X, Part::All));
    let mut before = f32::INFINITY;
    for i in 1..12 {
        let e = at(i as f32);
        assert!(e > 0.0 && e < before, "{e} lx at {i} m after {before} lx");
        before = e;
    }
}

#[test]
fn a_tunnel_is_lit_as_the_path_tracer_says() {
    // A bin of 8° is wider than the lit end looks from afar: it is asked by several rays.
    let settings = VolumeSettings {
        samples: Some([25, 5, 5]),
        second_level: 2,
        supersample: 16,
        ..VolumeSettings::default()
    };
    // Far down the tunnel few of an element's rays meet what is bright.
    let (world, volume) = solved_by(512, "analytic/tunnel.ron", &settings);
    let mut sum = 0.0;
    let count = 24;
    for i in 0..count {
        let p = Vec3::new(1.5 + 0.4 * i as f32, 1.0, 0.0);
        let receiver = Receiver::new(p, Vec3::NEG_X);
        let exact = irradiance(&world, &receiver, Part::Indirect, 65_536, i);
        let (mean, error) = (luminance(exact.mean), luminance(exact.standard_error));
        let found = luminance(volume.irradiance(p, Vec3::NEG_X, Part::Indirect));
        eprintln!("{:.1} m: {found:.3} lx, {mean:.3} ± {error:.3} by the path tracer", p.x);
        // Elements of 20 cm, bins of 8° that look along the tunnel, and light that bends between samples half a
        // metre apart: some per cent a point.
        assert!((found - mean).abs() < 4.0 * error + 0.1 * mean, "{found} for {mean} ± {error} at {p}");
        sum += found / mean - 1.0;
    }
    let mean = sum / count as f32;
    assert!(mean.abs() < 0.05, "{mean}");
}

#[test]
fn relocated_samples_leak_no_more_than_masked_ones_through_a_thin_wall() {
    use lumenscope_core::measure::leak::leak;
    let rooms = [
        [Vec3::new(-2.0, 0.0, -1.5), Vec3::new(0.29, 2.5, 1.5)],
        [Vec3::new(0.31, 0.0, -1.5), Vec3::new(2.0, 2.5, 1.5)],
    ];
    for repair in Repair::ALL {
        let settings =
            VolumeSettings { repair, samples: Some([9, 6, 7]), second_level: 2, ..plain_settings() };
        let (world, plain) = solved("analytic/two_rooms.ron", &settings);
        let guarded = leak(&plain.with_guard(Some(&world)), rooms[0], rooms[1]).unwrap();
        let plain = leak(&plain, rooms[0], rooms[1]).unwrap();
        eprintln!("{}: {plain:?} plain, {guarded:?} guarded", repair.name());
        assert!(plain.worst > 0.05 && guarded.mean <= 0.01 && guarded.worst <= 0.01, "{repair:?}");
    }
}

#[test]
fn samples_in_solids_are_masked_dilated_or_relocated() {
    let (scene, light) = furnished();
    let of = |repair| build(&scene, &light, &VolumeSettings { repair, ..small([6, 5, 7]) });
    let (masked, dilated, relocated) = (of(Repair::Mask), of(Repair::Dilate), of(Repair::Relocate));
    let (low, high) = (Vec3::new(0.8, 0.0, 1.0), Vec3::new(2.0, 1.1, 2.6));
    let count = |v: &IrradianceVolume, state| v.samples().iter().filter(|s| s.state == state).count();
    let inside = count(&masked, SampleState::Masked);
    assert!(inside >= 8);
    assert_eq!(count(&dilated, SampleState::Dilated), inside);
    let moved = count(&relocated, SampleState::Relocated);
    assert!(moved > 0 && moved + count(&relocated, SampleState::Masked) == inside, "{moved} of {inside}");
    let cell = relocated.grid().cell_size();
    for (sample, place) in relocated.samples().iter().zip(relocated.grid().places()) {
        let shift = (sample.position - place.position).abs();
        if sample.state == SampleState::Relocated {
            let reach = 0.5 * cell / if sample.level == 1 { 1.0 } else { relocated.grid().inner() as f32 };
            assert!(shift.cmple(reach + 1e-5).all() && shift.length() > 0.0);
            let p = sample.position;
            assert!(!(p.cmpgt(low).all() && p.cmplt(high).all()), "{p} is still in the block");
            assert!(sample.back_face_fraction <= 0.25);
        } else {
            assert_eq!(shift, Vec3::ZERO);
        }
    }
    // A dilated sample lies between the darkest and the brightest of what is around it.
    for (i, sample) in dilated.samples().iter().enumerate().filter(|(_, s)| s.state == SampleState::Dilated) {
        let e = dilated.sample_irradiance(i, Part::Indirect)[0].x;
        let all: Vec<f32> = dilated
            .samples()
            .iter()
            .enumerate()
            .filter(|(_, s)| s.state == SampleState::Free)
            .map(|(k, _)| dilated.sample_irradiance(k, Part::Indirect)[0].x)
            .collect();
        let (least, most) = all.iter().fold((f32::INFINITY, 0.0f32), |(a, b), v| (a.min(*v), b.max(*v)));
        assert!(e >= 0.999 * least && e <= 1.001 * most, "{sample:?}: {e}");
    }
    for volume in [&masked, &dilated, &relocated] {
        let file = tempfile::NamedTempFile::new().unwrap();
        volume.save(file.path()).unwrap();
        let loaded = IrradianceVolume::load(file.path()).unwrap();
        assert_eq!(loaded.samples(), volume.samples());
        let (p, n) = (Vec3::new(0.7, 0.5, 0.9), Vec3::X);
        assert_eq!(loaded.irradiance(p, n, Part::All), volume.irradiance(p, n, Part::All));
    }
    // Relighting gives the same bytes as building, whatever was done to the samples.
    let other = PerTriangle(light.0.iter().map(|b| *b * 0.5).collect());
    for repair in Repair::ALL {
        let settings = VolumeSettings { repair, ..small([6, 5, 7]) };
        let relit = of(repair).relight(&World::new(&scene), &other, &[]);
        assert!(all_bytes(&relit) == all_bytes(&build(&scene, &other, &settings)), "{repair:?}");
    }
}

#[test]
fn points_outside_fade_to_the_nearest_sample_and_say_so() {
    let (scene, light) = furnished();
    let volume = build(&scene, &light, &small([4, 4, 4]));
    let (low, high) = volume.grid().bounds();
    let cell = volume.grid().cell_size();
    let start = Vec3::new(high.x, 1.9, 3.1);
    let beyond = |cells: f32| volume.weights(start + Vec3::X * cells * cell.x);
    assert_eq!(volume.weights((low + high) * 0.5).state, PointState::Inside);
    assert_eq!(beyond(0.2).weights, beyond(0.0).weights);
    // A guarded volume, whose samples the walls hide from there, answers no less.
    let guarded = volume.with_guard(Some(&World::new(&scene)));
    assert_eq!(guarded.weights(start + Vec3::X * cell).weights.iter().sum::<f32>(), 1.0);
    let mut largest = 0.0f32;
    for i in 0..=20 {
        let at = beyond(0.1 * i as f32);
        if i > 0 {
            assert!(matches!(at.state, PointState::Outside(m) if (m - 0.1 * i as f32 * cell.x).abs() < 1e-4));
        }
        assert!((at.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        let most = at.weights.iter().copied().fold(0.0, f32::max);
        assert!(most >= largest - 1e-5, "at {i}: {at:?}");
        largest = most;
    }
    assert!((largest - 1.0).abs() < 1e-5);
    let far = beyond(40.0);
    let alone = (0..8).find(|&i| far.weights[i] > 0.5).unwrap();
    let position = |i: usize| volume.samples()[far.ids[i] as usize].position;
    let nearest =
        (0..8).map(|i| position(i).distance(start + Vec3::X * 40.0 * cell.x)).fold(f32::INFINITY, f32::min);
    assert!(position(alone).distance(start + Vec3::X * 40.0 * cell.x) <= nearest + 1e-4);
}
