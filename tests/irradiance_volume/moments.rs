//! Irradiance moments against closed forms; the room with four constant walls.

use super::*;
use lumenscope_core::{
    irradiance_volume::{
        dynamic_object::Gloss,
        moments::{Order, moment_by_definition},
    },
    math::frame::mirrored,
    radiosity::RadiositySettings,
    superposition::{
        composite::DirectQuality,
        pass::{PassSettings, render},
    },
    transport::live::{LiveTransport, SolveSettings},
};
use lumenscope_tests::{add, box_room, cuboid, diffuse};

fn with_all_orders(samples: [u32; 3]) -> VolumeSettings {
    VolumeSettings { moments: Order::THESIS.to_vec(), ..small(samples) }
}

#[test]
fn constant_radiance_reads_pi_l_at_every_order() {
    let scene = room([Vec3::ZERO; 6]);
    let light = PerTriangle(vec![Vec3::splat(PI * 7.0); 12]);
    let volume = build(&scene, &light, &with_all_orders([3, 3, 4]));
    assert_eq!(volume.orders(), Order::THESIS);
    for order in Order::THESIS {
        for i in 0..200 {
            let mut rng = Rng::new(1, i);
            let p = Vec3::new(rng.next_f32() * 3.0, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
            let h = volume.moment(p, uniform_direction(rng.next_vec2()), order, Part::All).unwrap();
            // 4.9e-4 of the codec and the rounding of sums.
            assert!((h / (PI * 7.0) - Vec3::ONE).abs().max_element() < 6e-4, "order {order}: {h}");
        }
    }
    assert_eq!(volume.moment(Vec3::ONE, Vec3::Y, Order::Finite(3), Part::All), None);
}

#[test]
fn a_bright_cap_has_its_closed_form() {
    // Radiance 1 within an angle α of the pole: Hⁿ towards it is (n + 1)/2 · 2π ∫ cosⁿ sin = π (1 − cosⁿ⁺¹ α).
    // Towards the other pole it is 0, and the mean of Hⁿ over all directions is its mean radiance times π.
    for (n, rings, worst) in [(17, 5, 0.02), (49, 15, 0.006)] {
        let bins = DirectionBins::new(n);
        // A square of bins around the pole is a disc of this radius, and lifted a cap: cos α = 1 − r².
        let edge = 1.0 - ((2 * rings + 1) as f32 / n as f32).powi(2);
        let cap: Vec<Vec3> =
            (0..bins.len()).map(|b| Vec3::splat(f32::from(u8::from(bins.centre(b).y > edge)))).collect();
        let share = cap.iter().map(|c| c.x).sum::<f32>() / cap.len() as f32;
        for order in Order::THESIS {
            let moment = moment_by_definition(bins, &cap, order);
            let exact = match order {
                Order::Finite(n) => PI * (1.0 - edge.powi(n as i32 + 1)),
                Order::Infinite => PI,
            };
            let up = moment[bins.bin(Vec3::Y)].x;
            // The mid-point rule over a cosine, and over bins that are not square at the corners.
            assert!((up / exact - 1.0).abs() < worst, "n = {n}, order {order}: {up} for {exact}");
            assert!(moment[bins.bin(Vec3::NEG_Y)].x < 1e-6);
            let mean = moment.iter().map(|m| m.x).sum::<f32>() / moment.len() as f32;
            assert!((mean / (PI * share) - 1.0).abs() < worst, "n = {n}, order {order}: {mean}");
        }
    }
}

#[test]
fn moments_approach_radiance() {
    let bins = DirectionBins::new(49);
    let light = |d: Vec3| 2.0 + d.x + 0.5 * d.y * d.z;
    let radiance: Vec<Vec3> = (0..bins.len()).map(|b| Vec3::splat(light(bins.centre(b)))).collect();
    let mut before = f32::INFINITY;
    for order in [1, 2, 4, 10, 100, Order::HIGHEST].map(Order::Finite) {
        let moment = moment_by_definition(bins, &radiance, order);
        let error = moment.iter().zip(&radiance).map(|(h, l)| (h.x / PI - l.x).abs()).fold(0.0, f32::max);
        assert!(error < before, "order {order}: {error} after {before}");
        before = error;
    }
    // cos¹⁰⁰⁰⁰ is a degree wide, a bin 2.9°: the neighbours weigh under 1e-5.
    assert!(before < 1e-4, "{before}");
    let limit = moment_by_definition(bins, &radiance, Order::Infinite);
    assert!(limit.iter().zip(&radiance).all(|(h, l)| (h.x / PI - l.x).abs() < 1e-6));
}

#[test]
fn weights_integrate_to_pi() {
    for order in [1, 2, 4, 10, 100].map(Order::Finite) {
        let steps = 20_000;
        let sum: f64 = (0..steps)
            .map(|i| f64::from(order.weight((i as f32 + 0.5) / steps as f32)) / f64::from(steps))
            .sum();
        assert!((2.0 * sum - 1.0).abs() < 1e-4, "order {order}: {sum}");
        assert_eq!(order.weight(-0.5), 0.0);
        assert_eq!(order.to_string().parse::<Order>(), Ok(order));
    }
    for (text, order) in [("inf", Order::Infinite), ("∞", Order::Infinite), ("7", Order::Finite(7))] {
        assert_eq!(text.parse::<Order>(), Ok(order));
    }
    for wrong in ["0", "-1", "1.5", "10001", "", "many"] {
        assert!(wrong.parse::<Order>().unwrap_err().contains(wrong), "{wrong}");
    }
}

#[test]
fn a_volume_holds_at_its_samples_what_a_probe_sees_there() {
    let (scene, light) = furnished();
    let world = World::new(&scene);
    let settings = VolumeSettings { direct_samples: 64, ..with_all_orders([3, 3, 3]) };
    let volume = build(&scene, &light, &settings);
    for (i, sample) in volume.samples().iter().enumerate().step_by(11) {
        let probe = Probe::at(&world, &light, sample.position, 17, 1, 0).unwrap();
        for (order, part) in
            Order::THESIS.into_iter().zip([Part::Direct, Part::Indirect, Part::All].repeat(2))
        {
            let held = volume.sample_moment(i, order, part).unwrap();
            for (a, b) in probe.moment(order, part).iter().zip(held) {
                // 4.9e-4 of the codec, and sums in another order.
                assert!(
                    (*a - b).abs().max_element() <= 1e-3 * a.max_element() + 1e-4,
                    "order {order}: {a} {b}"
                );
            }
        }
    }
}

#[test]
fn moments_follow_the_light_and_come_back_from_a_file() {
    let (mut scene, light) = furnished();
    let settings = VolumeSettings { moments: vec![Order::Finite(10), Order::Infinite], ..small([4, 3, 4]) };
    let volume = build(&scene, &light, &settings);
    scene.lamps[0] = point_lamp(Vec3::new(0.4, 1.8, 0.7), 60.0);
    let relit = volume.relight(&World::new(&scene), &light, &[Target::Lamp(0)]);
    assert!(all_bytes(&relit) == all_bytes(&build(&scene, &light, &settings)));
    assert!(all_bytes(&relit) != all_bytes(&volume));
    let file = tempfile::NamedTempFile::new().unwrap();
    relit.save(file.path()).unwrap();
    let loaded = IrradianceVolume::load(file.path()).unwrap();
    let at = |v: &IrradianceVolume| v.moment(Vec3::new(1.0, 1.5, 3.0), Vec3::Y, Order::Finite(10), Part::All);
    assert_eq!(at(&loaded), at(&relit));
    assert!(at(&loaded).is_some());
}

#[test]
fn mirrored_is_the_law_of_reflection() {
    for i in 0..200 {
        let mut rng = Rng::new(6, i);
        let (n, v) = (uniform_direction(rng.next_vec2()), uniform_direction(rng.next_vec2()));
        let r = mirrored(v, n);
        assert!((r.length() - 1.0).abs() < 1e-5 && (r.dot(n) - v.dot(n)).abs() < 1e-5);
        assert!((r + v - 2.0 * v.dot(n) * n).length() < 1e-5);
    }
}

#[test]
fn a_glossy_object_in_a_furnace_cannot_be_seen() {
    // Walls and object emit 1 − ρ: L = 1 everywhere, so what the object reflects is ρ at every order.
    let mut scene = box_room(0.5, 0.5);
    let mesh = cuboid(Vec3::new(-0.4, -0.7, -0.6), Vec3::new(0.2, -0.1, -0.1), false);
    let object = add(&mut scene, "block", mesh, diffuse("block", Vec3::splat(0.5), Vec3::splat(0.5)));
    scene.objects[object].movable = true;
    let volume = VolumeSettings { moments: Order::THESIS.to_vec(), second_level: 2, ..small([6, 6, 6]) };
    let radiosity =
        RadiositySettings { gather_rays: 64, element_spacing_m: Some(0.25), ..RadiositySettings::default() };
    let settings = SolveSettings { radiosity, volume: Some(volume), preview: false };
    let live = LiveTransport::solve(Arc::new(scene), settings, &Progress::silent(), &mut |_| {}).unwrap();
    let solution = live.current();
    for order in Order::THESIS {
        let settings = PassSettings { direct: DirectQuality::PerPixel(1), ..PassSettings::default() };
        let camera = solution.scene.camera;
        let glossy = solution.with_gloss(Some(Gloss { order, eye: camera.eye }));
        let (buffer, layers) = render(&glossy, &camera, 48, 36, &settings);
        let picture = layers.total();
        let geometry = &solution.world.geometry;
        let on_block: Vec<f32> = buffer
            .triangle
            .iter()
            .zip(&picture.pixels)
            .filter(|(t, _)| geometry.object.get(**t as usize).is_some_and(|o| *o as usize == object))
            .map(|(_, p)| p.x)
            .collect();
        assert!(on_block.len() > 50, "{}", on_block.len());
        let mean = on_block.iter().sum::<f32>() / on_block.len() as f32;
        let at = Vec3::new(0.5, 0.4, 0.3);
        let parts = [Part::Direct, Part::Indirect].map(|part| {
            let of = |i| {
                solution.volume.as_ref().unwrap().moment(
                    at,
                    uniform_direction(Rng::new(4, i).next_vec2()),
                    order,
                    part,
                )
            };
            (0..200).filter_map(of).map(|h| h.x).sum::<f32>() / 200.0 / PI
        });
        eprintln!(
            "furnace, order {order}: block {mean:.4}, direct {:.4}, indirect {:.4} of 0.5",
            parts[0], parts[1]
        );
        // Half of it is emitted and exact; the rest is a lobe over 578 bins of emitters cut into leaves 0.35 rad
        // wide, narrower than the lobe up to order 10.
        let worst = if order <= Order::Finite(10) { 0.025 } else { 0.06 };
        assert!((mean - 1.0).abs() < worst, "order {order}: {mean}");
    }
}

#[test]
fn four_constant_walls_are_those_of_the_thesis() {
    // Fig. 3.1: at x in the middle of a square room the radiance towards the left wall is 4 everywhere on it;
    // we give the others 3, 2 and 1, and floor and ceiling none. A ray's radiance is its wall's, exactly.
    let side = [4.0, 2.0, 0.0, 0.0, 3.0, 1.0];
    let mut scene = Scene::default();
    add_box(&mut scene, Vec3::splat(-1.0), Vec3::ONE, true, [Vec3::ZERO; 6]);
    let light = PerTriangle((0..12).map(|t| Vec3::splat(PI * side[t / 2])).collect());
    let world = World::new(&scene);
    // Sixteen rays a bin: the walls meet along the diagonals of the bins, where one ray would take sides.
    let probe = Probe::at(&world, &light, Vec3::ZERO, 49, 16, 0).unwrap();
    for bin in 0..probe.bins.len() {
        let d = probe.bins.centre(bin);
        let axis = (0..3).max_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs())).unwrap();
        // Bins of 2.9°, up to twice as long, that an edge runs through.
        if d[axis].abs() < 1.2 * d[(axis + 1) % 3].abs().max(d[(axis + 2) % 3].abs()) {
            continue;
        }
        let wall = 2 * axis + usize::from(d[axis] > 0.0);
        assert!((probe.radiance[bin].x - side[wall]).abs() < 1e-5, "towards {d}");
    }
    // A side of the cube gives a plane facing it 4/√2 atan(1/√2) = 1.7408 sr, one at a right angle
    // (π − 1.7408)/4 = 0.3502 sr, one turned away nothing. So facing the left: 4 · 1.7408 + (3 + 1) · 0.3502.
    let (facing, beside) = (4.0 / 2f32.sqrt() * (1.0 / 2f32.sqrt()).atan(), 0.350_2);
    assert!((facing + 4.0 * beside - PI).abs() < 1e-3);
    let hand = [
        (Vec3::NEG_X, 4.0 * facing + (3.0 + 1.0) * beside),
        (Vec3::X, 2.0 * facing + (3.0 + 1.0) * beside),
        (Vec3::NEG_Z, 3.0 * facing + (4.0 + 2.0) * beside),
        (Vec3::Z, facing + (4.0 + 2.0) * beside),
        (Vec3::Y, (4.0 + 3.0 + 2.0 + 1.0) * beside),
    ];
    for (n, exact) in hand {
        let around = Directions::new(probe.bins).interpolated(n);
        let e: f32 = (0..4).map(|i| probe.indirect[around.bins[i] as usize].x * around.weights[i]).sum();
        // A wall's edge runs through bins of 2.9°.
        assert!((e / exact - 1.0).abs() < 0.01, "facing {n}: {e} lx, by hand {exact} lx");
    }
}
