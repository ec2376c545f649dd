//! Volumes that ignore surfaces and lamps.

use super::*;
use lumenscope_core::irradiance_volume::ignored::Ignored;

fn objects(list: &[u32]) -> Ignored {
    Ignored { objects: list.iter().copied().collect(), ..Ignored::default() }
}

#[test]
fn what_is_ignored_is_what_the_surface_sent() {
    let (scene, light) = furnished();
    let world = World::new(&scene);
    let volume = build(&scene, &light, &small([4, 3, 4]));
    // Object 3, the ceiling, has triangles 6 and 7; the panel, the last object, emits.
    let panel = scene.objects.len() as u32 - 1;
    let without = volume.ignoring(&world, &light, objects(&[3, panel])).unwrap();
    let only = PerTriangle(
        light
            .0
            .iter()
            .enumerate()
            .map(|(t, b)| {
                let of = world.geometry.object[t];
                if of == 3 || of == panel { *b } else { Vec3::ZERO }
            })
            .collect(),
    );
    let sent = build(&scene, &only, &small([4, 3, 4]));
    for sample in 0..volume.samples().len() {
        let of = |v: &IrradianceVolume, part| v.sample_irradiance(sample, part);
        let (all, rest, part) =
            (of(&volume, Part::Indirect), of(&without, Part::Indirect), of(&sent, Part::Indirect));
        for ((all, rest), part) in all.iter().zip(&rest).zip(&part) {
            // Three codes of 4.9e-4 each.
            assert!((all.x - rest.x - part.x).abs() <= 1.5e-3 * all.x + 1e-4, "{all} {rest} {part}");
        }
    }
    let direct = without.irradiance(Vec3::new(1.5, 1.6, 2.0), Vec3::Y, Part::Direct);
    let mut dark = scene.clone();
    dark.objects[panel as usize].dimmer = 0.0;
    let lamp = build(&dark, &light, &small([4, 3, 4]));
    let expected = lamp.irradiance(Vec3::new(1.5, 1.6, 2.0), Vec3::Y, Part::Direct);
    assert_eq!(direct, expected);
}

#[test]
fn before_and_after_the_solve_are_one() {
    let (mut scene, light) = furnished();
    let ignored = Ignored { lamps: [0].into(), materials: [2].into(), objects: [5].into() };
    let after = build(&scene, &light, &small([4, 3, 4]))
        .ignoring(&World::new(&scene), &light, ignored.clone())
        .unwrap();
    let settings = VolumeSettings { ignored, ..small([4, 3, 4]) };
    let before = build(&scene, &light, &settings);
    assert!(all_bytes(&before) == all_bytes(&after));
    // It goes on ignoring when the light changes, and stops when asked to.
    scene.lamps[0] = point_lamp(Vec3::new(0.4, 1.8, 0.7), 60.0);
    let world = World::new(&scene);
    let moved = after.relight(&world, &light, &[Target::Lamp(0)]);
    assert!(all_bytes(&moved) == all_bytes(&build(&scene, &light, &settings)));
    let whole = moved.ignoring(&world, &light, Ignored::default()).unwrap();
    assert!(all_bytes(&whole) == all_bytes(&build(&scene, &light, &small([4, 3, 4]))));
    assert!(all_bytes(&whole) != all_bytes(&moved));
}
