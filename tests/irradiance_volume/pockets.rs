//! Samples of their own where those of a cell mislead.

use super::*;
use lumenscope_core::{
    irradiance_volume::{pockets::POCKET_LEVEL, visibility::PointState},
    math::colour::luminance,
};

fn with_pockets(pocket_samples: u32) -> VolumeSettings {
    VolumeSettings { pocket_samples, guard: true, ..small([4, 4, 4]) }
}

/// A dark shelf of boards of 2 cm in a bright room, open at +x.
fn shelf() -> (Scene, PerTriangle) {
    let mut scene = room([Vec3::ZERO; 6]);
    let (low, high, board) = (Vec3::new(0.9, 0.6, 1.2), Vec3::new(1.5, 1.1, 2.2), Vec3::splat(0.02));
    let outer = faces(low - board, Vec3::new(high.x, high.y + board.y, high.z + board.z), false);
    let mut radiosity = vec![Vec3::splat(100.0); 12];
    for (boards, b) in [(faces(low, high, true), 2.0), (outer, 50.0)] {
        for mesh in boards.into_iter().enumerate().filter(|(face, _)| *face != 1).map(|f| f.1) {
            add(&mut scene, "board", mesh, Material::default());
            radiosity.extend([Vec3::splat(b); 2]);
        }
    }
    scene.lamps.push(point_lamp(Vec3::new(2.5, 2.2, 3.0), 40.0));
    (scene, PerTriangle(radiosity))
}

/// Where its pockets are.
fn pockets(volume: &IrradianceVolume) -> Vec<usize> {
    (0..volume.samples().len()).filter(|&s| volume.samples()[s].level == POCKET_LEVEL).collect()
}

#[test]
fn a_pocket_answers_with_what_its_sample_holds() {
    let (scene, light) = shelf();
    let volume = build(&scene, &light, &with_pockets(40));
    let found = pockets(&volume);
    assert!((4..=40).contains(&found.len()), "{}", found.len());
    for &s in &found {
        let at = volume.samples()[s].position;
        let weights = volume.weights(at);
        assert_eq!((weights.ids[0], weights.weights[0]), (s as u32, 1.0));
        assert_eq!(weights.state, PointState::Inside);
        for part in [Part::Direct, Part::Indirect] {
            for (bin, held) in volume.sample_irradiance(s, part).into_iter().enumerate().step_by(13) {
                let answer = volume.irradiance(at, volume.bins().centre(bin), part);
                // Directions are found to 2e-6 of a square.
                assert!((answer - held).abs().max_element() <= 1e-3 * held.max_element() + 1e-5);
            }
        }
    }
    // Without a guard they are not asked.
    let plain = build(&scene, &light, &with_pockets(0)).with_guard(None);
    let unguarded = volume.with_guard(None);
    let without = VolumeSettings { guard: false, ..with_pockets(40) };
    assert!(pockets(&build(&scene, &light, &without)).is_empty(), "nothing would ask them");
    let (p, n) = (volume.samples()[found[0]].position, Vec3::X);
    assert_eq!(unguarded.irradiance(p, n, Part::All), plain.irradiance(p, n, Part::All));
}

#[test]
fn pockets_bring_queries_nearer_to_the_light_that_is_there() {
    let (scene, light) = shelf();
    let world = World::new(&scene);
    let [without, with] = [0, 40].map(|count| build(&scene, &light, &with_pockets(count)));
    let mut sums = [0.0; 3];
    for &s in &pockets(&with) {
        let shift = with.grid().cell_size() / (16.0 * with.grid().inner() as f32);
        let p = with.samples()[s].position + shift * Vec3::new(1.0, -1.0, 0.5);
        let probe = Probe::at(&world, &light, p, 9, 1, 0).unwrap();
        for (b, exact) in probe.irradiance(Part::All).into_iter().enumerate().step_by(7) {
            let error = |v: &IrradianceVolume| {
                let found = luminance(v.irradiance(p, probe.bins.centre(b), Part::All));
                f64::from((found - luminance(exact)).abs())
            };
            sums[0] += error(&without);
            sums[1] += error(&with);
            sums[2] += f64::from(luminance(exact));
        }
    }
    let [before, after] = [sums[0] / sums[2], sums[1] / sums[2]];
    println!(
        "in pockets off by {:.1} % without and {:.1} % with samples of their own",
        100.0 * before,
        100.0 * after
    );
    assert!(after < 0.5 * before, "{before} {after}");
}

#[test]
fn pockets_are_the_same_on_any_threads_and_come_back_from_a_file() {
    let (scene, light) = shelf();
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build(&scene, &light, &with_pockets(40)))
    };
    let [one, two] = [1, 2].map(of);
    assert!(all_bytes(&one) == all_bytes(&two));
    let file = tempfile::NamedTempFile::new().unwrap();
    one.save(file.path()).unwrap();
    let loaded = IrradianceVolume::load(file.path()).unwrap();
    assert_eq!(loaded.samples(), one.samples());
    let loaded = loaded.with_guard(Some(&World::new(&scene)));
    for &s in &pockets(&one) {
        let p = one.samples()[s].position;
        assert_eq!(loaded.irradiance(p, Vec3::Y, Part::All), one.irradiance(p, Vec3::Y, Part::All));
    }
    // New light goes to them as to all samples.
    let brighter = PerTriangle(light.0.iter().map(|b| *b * 2.0).collect());
    let relit = one.relight(&World::new(&scene), &brighter, &[]);
    let &s = pockets(&one).first().unwrap();
    let [before, after] = [&one, &relit].map(|v| v.sample_irradiance(s, Part::Indirect)[3]);
    assert!((after - 2.0 * before).abs().max_element() <= 2e-3 * after.max_element());
}

#[test]
fn an_eighth_lit_by_the_sample_of_another_says_so() {
    // A closed box between the samples: of the eighths in it two have samples of their own.
    let (mut scene, mut light) = shelf();
    let (low, size) = (Vec3::new(2.05, 1.3, 2.05), Vec3::new(0.4, 0.3, 0.55));
    for (inward, by) in [(true, 0.0), (false, 0.01)] {
        for (face, mesh) in faces(low - by, low + size + by, inward).into_iter().enumerate() {
            add(&mut scene, "box", mesh, Material::default());
            let uneven = if face == 0 { 2000.0 } else { 10.0 };
            light.0.extend([Vec3::splat(if inward { 200.0 } else { uneven }); 2]);
        }
    }
    let volume = build(&scene, &light, &with_pockets(2));
    let mut lent = 0;
    for i in 0..4000 {
        let mut rng = Rng::new(2, i);
        let p = low + size * Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let weights = volume.weights(p);
        let sample = weights.ids[0];
        if weights.weights[0] != 1.0 || volume.samples()[sample as usize].level != POCKET_LEVEL {
            continue;
        }
        let own = volume.grid().pocket(volume.grid().locate(p).cell, p) == Some(sample);
        lent += usize::from(!own);
        assert_eq!(weights.state, if own { PointState::Inside } else { PointState::Borrowed }, "{p}");
        assert_eq!(volume.lighting(p, Vec3::Y, Part::All).notice().is_some(), !own);
    }
    assert!(lent > 10, "{lent} points");
}
