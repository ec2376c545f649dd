//! What lights a point, taken apart; and the ages of samples.

use super::*;
use lumenscope_core::irradiance_volume::{inspect::ColourBy, lighting};

#[test]
fn the_samples_of_a_point_add_up_to_its_irradiance() {
    let (scene, light) = furnished();
    let world = World::new(&scene);
    let volume = build(&scene, &light, &small([4, 4, 5]));
    for volume in [volume.clone(), volume.with_guard(Some(&world))] {
        for i in 0..300 {
            let mut rng = Rng::new(4, i);
            let p = Vec3::new(rng.next_f32() * 3.0, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
            let n = uniform_direction(rng.next_vec2());
            let found = volume.lighting(p, n, Part::All);
            let sum: Vec3 = found.samples.iter().map(|s| s.irradiance * s.weight).sum();
            // Sums of eight in another order.
            assert!((sum - found.irradiance).length() <= 1e-4 * found.irradiance.length(), "{sum} at {p}");
            assert_eq!(found.irradiance, volume.irradiance(p, n, Part::All));
            assert!(found.samples.windows(2).all(|w| w[0].weight >= w[1].weight));
            let [low, high] = found.bounds;
            let inside = p.clamp(low, high);
            let (grid_low, grid_high) = volume.grid().bounds();
            assert!(inside.distance(p.clamp(grid_low, grid_high)) < 1e-4, "{p} in {low} to {high}");
            let again = low + found.offset * (high - low);
            assert!(again.distance(inside) < 1e-4, "{again} for {inside}");
        }
    }
}

#[test]
fn the_drawing_names_every_sample_with_its_share_and_state() {
    let (scene, light) = furnished();
    let volume = build(&scene, &light, &small([4, 4, 5]));
    // Beside the block: some of the samples around lie in it.
    let found = volume.lighting(Vec3::new(0.75, 0.6, 1.7), Vec3::Y, Part::All);
    let drawn = lighting::scene(&volume, &found, Part::All);
    assert_eq!(drawn.spheres.len(), found.samples.len());
    assert!(drawn.labels.iter().zip(&found.samples).all(|(l, s)| l.text.contains(s.word())));
    assert!(found.samples.iter().any(|s| s.word() == "masked" && s.weight == 0.0));
    assert!(drawn.notes[0].contains("offset") && drawn.notes.len() > found.samples.len());
    // A line to each sample, twelve edges of the cell, the normal.
    assert_eq!(drawn.lines.len(), found.samples.len() + 12 + 1);
}

#[test]
fn only_samples_whose_light_changed_grow_older() {
    let (mut scene, light) = furnished();
    let volume = build(&scene, &light, &small([4, 4, 5]));
    let world = World::new(&scene);
    assert!((0..volume.samples().len()).all(|s| volume.age(s) == 0));
    // Nothing changed: nobody is older.
    let same = volume.relight(&world, &light, &[]);
    assert!((0..volume.samples().len()).all(|s| same.age(s) == 0));
    // The panel shines down: samples under it change, those beside the ceiling hear nothing of it.
    let panel = scene.objects.iter().position(|o| o.name == "panel").unwrap();
    scene.objects[panel].dimmer = 0.5;
    let mut dimmed = world.clone();
    let changed = dimmed.follow(&scene);
    let relit = same.relight(&dimmed, &light, &changed);
    let mut ages = [0; 2];
    for s in 0..volume.samples().len() {
        let other = relit.sample_irradiance(s, Part::All) != volume.sample_irradiance(s, Part::All);
        assert_eq!(relit.age(s), u32::from(other), "sample {s}");
        ages[relit.age(s) as usize] += 1;
    }
    assert!(ages[0] > 0 && ages[1] > 0, "{ages:?}");
    let view = VolumeView { colour_by: ColourBy::Age, invalid: true, ..VolumeView::default() };
    let shown = volume_spheres(&relit, &dimmed, &light, &view, None);
    let seen: Vec<f32> = shown.spheres.iter().map(|s| shown.sphere_bins[s.first_bin as usize].x).collect();
    assert!(seen.contains(&0.0) && seen.contains(&1.0));
}
