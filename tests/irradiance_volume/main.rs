//! The irradiance volume against closed forms, hand counts, the reference and itself.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod accuracy;
mod comparison;
mod copies;
mod given;
mod harmonics;
mod ignored;
mod lighting;
mod moments;
mod moving;
mod overrides;
mod panorama;
mod placement;
mod pockets;
mod sampling;
mod spheres;
mod trust;
mod wall;

use glam::{Affine3A, UVec3, Vec2, Vec3};
use lumenscope_core::{
    irradiance_volume::{
        Basis, IrradianceVolume, SurfaceLight, VolumeError, VolumeSettings,
        directions::Directions,
        grid::{BilevelGrid, trilinear},
        inspect::{VolumeView, grid_lines, probe_scene, volume_spheres},
        probe::{Probe, Quantity},
        trust::Repair,
    },
    math::{
        frame::uniform_direction, part::Part, progress::Progress, random::Rng, sphere_map::DirectionBins,
    },
    scene::{
        Scene, Target,
        direct::polygon_irradiance,
        lamp::{Lamp, LampKind},
        material::Material,
        mesh::Mesh,
        world::World,
    },
};
use lumenscope_tests::add;
use std::{
    f32::consts::{PI, TAU},
    sync::Arc,
};

/// Radiosity given a triangle: element number and triangle number are the same.
struct PerTriangle(Vec<Vec3>);

impl SurfaceLight for PerTriangle {
    fn element_at(&self, triangle: u32, _: Vec2, _: bool) -> u32 {
        triangle
    }

    fn radiosity(&self) -> &[Vec3] {
        &self.0
    }
}

/// Six quads of a box, looking inwards or outwards: −x, +x, −y, +y, −z, +z.
fn faces(low: Vec3, high: Vec3, inwards: bool) -> [Mesh; 6] {
    std::array::from_fn(|face| {
        let (axis, far) = (face / 2, face % 2 == 1);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut corners = [low; 4];
        for (i, corner) in corners.iter_mut().enumerate() {
            corner[axis] = if far { high[axis] } else { low[axis] };
            corner[u] = if i == 1 || i == 2 { high[u] } else { low[u] };
            corner[v] = if i >= 2 { high[v] } else { low[v] };
        }
        if far == inwards {
            corners.reverse();
        }
        Mesh::quad(corners)
    })
}

/// One object a face, each with its own material; face i has triangles 2i and 2i + 1.
fn add_box(scene: &mut Scene, low: Vec3, high: Vec3, inwards: bool, emission: [Vec3; 6]) {
    for (mesh, emission) in faces(low, high, inwards).into_iter().zip(emission) {
        add(scene, "face", mesh, Material { emission, ..Material::default() });
    }
}

fn room(emission: [Vec3; 6]) -> Scene {
    let mut scene = Scene::default();
    add_box(&mut scene, Vec3::ZERO, Vec3::new(3.0, 2.5, 4.0), true, emission);
    scene
}

fn point_lamp(at: Vec3, intensity: f32) -> Lamp {
    Lamp {
        name: "lamp".into(),
        kind: LampKind::Point { intensity: Vec3::splat(intensity) },
        world_from_lamp: Affine3A::from_translation(at),
        dimmer: 1.0,
    }
}

/// A room with a solid block in it, two lamps and uneven walls.
fn furnished() -> (Scene, PerTriangle) {
    let mut scene = room([Vec3::ZERO; 6]);
    add_box(&mut scene, Vec3::new(0.8, 0.0, 1.0), Vec3::new(2.0, 1.1, 2.6), false, [Vec3::ZERO; 6]);
    let panel = [0.0, 1.0, 1.0, 0.0].zip4([0.0, 0.0, 1.0, 1.0]);
    let shining = Material { emission: Vec3::new(500.0, 450.0, 400.0), ..Material::default() };
    add(&mut scene, "panel", Mesh::quad(panel.map(|(x, z)| Vec3::new(1.0 + x, 2.49, 1.5 + z))), shining);
    scene.lamps.push(point_lamp(Vec3::new(0.5, 2.0, 0.5), 40.0));
    let mut rng = Rng::new(3, 0);
    let radiosity = (0..scene.triangle_count()).map(|_| Vec3::splat(100.0 * rng.next_f32())).collect();
    (scene, PerTriangle(radiosity))
}

trait Zip4 {
    fn zip4(self, other: Self) -> [(f32, f32); 4];
}

impl Zip4 for [f32; 4] {
    fn zip4(self, other: Self) -> [(f32, f32); 4] {
        std::array::from_fn(|i| (self[i], other[i]))
    }
}

fn small(samples: [u32; 3]) -> VolumeSettings {
    VolumeSettings { samples: Some(samples), ..plain_settings() }
}

/// Samples in solids left out and nothing guarded: plain trilinear interpolation.
fn plain_settings() -> VolumeSettings {
    VolumeSettings { repair: Repair::Mask, guard: false, ..VolumeSettings::default() }
}

fn build(scene: &Scene, light: &PerTriangle, settings: &VolumeSettings) -> IrradianceVolume {
    IrradianceVolume::build(&World::new(scene), light, settings, &Progress::silent()).unwrap()
}

fn all_bytes(volume: &IrradianceVolume) -> Vec<u8> {
    let file = tempfile::NamedTempFile::new().unwrap();
    volume.save(file.path()).unwrap();
    std::fs::read(file.path()).unwrap()
}

#[test]
fn constant_radiance_reads_pi_l_in_every_direction() {
    let radiance = 7.0;
    let scene = room([Vec3::ZERO; 6]);
    let light = PerTriangle(vec![Vec3::splat(PI * radiance); 12]);
    let volume = build(&scene, &light, &small([3, 3, 4]));
    let nearest = volume.with_basis(Basis::NearestBin);
    for i in 0..2000 {
        let mut rng = Rng::new(1, i);
        let p = Vec3::new(rng.next_f32() * 3.0, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
        let n = uniform_direction(rng.next_vec2());
        for e in [&volume, &nearest].map(|v| v.irradiance(p, n, Part::All)) {
            // 4.9e-4 of the codec and the rounding of sums.
            assert!((e / (PI * radiance) - Vec3::ONE).abs().max_element() < 6e-4, "{e} at {p} towards {n}");
        }
    }
}

#[test]
fn a_room_of_light_reads_pi_l_directly() {
    let radiance = 7.0;
    let scene = room([Vec3::splat(radiance); 6]);
    let light = PerTriangle(vec![Vec3::ZERO; 12]);
    let volume = build(&scene, &light, &small([3, 3, 4]));
    let mut worst = 0.0f32;
    for sample in 0..volume.samples().len() {
        for e in volume.sample_irradiance(sample, Part::All) {
            worst = worst.max((e.x / (PI * radiance) - 1.0).abs());
        }
    }
    // Leaves are exact above the horizon; those it cuts count as if their light came from one direction.
    // A leaf is at most 0.35 wide, and what the horizon cuts off leans the cosine by its square.
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn a_bright_wall_lights_the_side_that_faces_it() {
    let centre = Vec3::new(1.5, 1.25, 2.0);
    for wall in 0..6 {
        let mut emission = [Vec3::ZERO; 6];
        emission[wall] = Vec3::splat(100.0);
        let scene = room(emission);
        let world = World::new(&scene);
        let mut radiosity = vec![Vec3::ZERO; 12];
        radiosity[2 * wall] = Vec3::splat(PI * 100.0);
        radiosity[2 * wall + 1] = Vec3::splat(PI * 100.0);
        let volume = build(&scene, &PerTriangle(radiosity), &small([3, 3, 3]));
        let side = |face: usize| Vec3::AXES[face / 2] * if face % 2 == 1 { 1.0 } else { -1.0 };
        for part in [Part::Direct, Part::Indirect] {
            let at = |n: Vec3| volume.irradiance(centre, n, part).x;
            let exact: f64 = (2 * wall..2 * wall + 2)
                .map(|t| polygon_irradiance(centre, side(wall), &world.geometry.positions[t]))
                .sum();
            let lit = at(side(wall));
            // Interpolation between bins 0.15 rad apart flattens the top of a cosine by 0.15²/8; 578 bins
            // see the wall's outline to about 2 %.
            let share = f64::from(lit) / (100.0 * exact);
            assert!((share - 1.0).abs() < 0.03, "wall {wall} {part:?}: {share}");
            for other in (0..6).filter(|&f| f != wall) {
                assert!(at(side(other)) < 0.7 * lit, "wall {wall} lights side {other}");
            }
            assert!(at(-side(wall)) < 0.02 * lit, "the far side of wall {wall} is dark");
        }
    }
}

#[test]
fn a_point_lamp_gives_i_cos_over_d2_at_a_sample() {
    let mut scene = room([Vec3::ZERO; 6]);
    scene.lamps.push(point_lamp(Vec3::new(0.5, 2.0, 0.5), 40.0));
    let volume = build(&scene, &PerTriangle(vec![Vec3::ZERO; 12]), &small([3, 3, 3]));
    for (i, sample) in volume.samples().iter().enumerate() {
        let to_lamp = Vec3::new(0.5, 2.0, 0.5) - sample.position;
        for (bin, e) in volume.sample_irradiance(i, Part::Direct).iter().enumerate() {
            let cosine = volume.bins().centre(bin).dot(to_lamp.normalize()).max(0.0);
            let exact = 40.0 * cosine / to_lamp.length_squared();
            assert!((e.x - exact).abs() <= 4.9e-4 * exact + 1e-5, "{} for {exact}", e.x);
        }
    }
}

#[test]
fn cell_arithmetic_is_the_thesis_example() {
    // Fig. 4.12: a 4 × 2 grid over 32 × 18, the point (17, 12): cell [2, 1], offsets 0.125 and 1/3.
    let grid = BilevelGrid::new(Vec3::ZERO, Vec3::new(32.0, 18.0, 1.0), UVec3::new(5, 3, 2), 3, &[false; 8]);
    let at = grid.locate(Vec3::new(17.0, 12.0, 0.0));
    assert_eq!((at.cell, at.level), (4 + 2, 1));
    assert_eq!(at.offset.x, 0.125);
    assert!((at.offset.y - 1.0 / 3.0).abs() < 1e-6);
}

#[test]
fn shared_samples_are_counted_once() {
    // 3³ corners; two neighbouring cells of 3³: 27 − 8 new each, less 9 − 4 on the face they share.
    let mut flags = [false; 8];
    flags[0] = true;
    flags[1] = true;
    let grid = BilevelGrid::new(Vec3::ZERO, Vec3::ONE, UVec3::splat(3), 3, &flags);
    assert_eq!(grid.places().len(), 27 + 2 * 19 - 5);
    assert_eq!(grid.cells().len(), 8 + 2 * 8);
    assert_eq!(grid.second_level_grids(), 2);
    // Greger's office, counted without sharing 343 + 72 · 27 = 2,287: 72 cells in a slab share more.
    let flags: Vec<bool> = (0..216).map(|c| c < 72).collect();
    let grid = BilevelGrid::new(Vec3::ZERO, Vec3::ONE, UVec3::splat(7), 3, &flags);
    // The refined slab is 6 × 6 × 2 cells, 13 × 13 × 5 samples, of which 7 × 7 × 3 are corners.
    assert_eq!(grid.places().len(), 343 + 13 * 13 * 5 - 7 * 7 * 3);
    assert!(grid.places().len() <= 2287);
}

#[test]
fn weights_sum_to_one_and_reproduce_linear_functions() {
    let flags: Vec<bool> = (0..27).map(|c| c % 3 == 1).collect();
    let (low, high) = (Vec3::new(-1.0, 0.0, 2.0), Vec3::new(2.0, 1.0, 4.0));
    let grid = BilevelGrid::new(low, high, UVec3::splat(4), 4, &flags);
    let mut levels = [0; 3];
    for i in 0..5000 {
        let mut rng = Rng::new(2, i);
        let p = low + (high - low) * Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let at = grid.locate(p);
        levels[at.level as usize] += 1;
        let weights = trilinear(at.offset);
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        let ids = grid.cells()[at.cell as usize].samples;
        // Each coordinate is a linear function of position.
        let back: Vec3 = ids.iter().zip(weights).map(|(&s, w)| grid.places()[s as usize].position * w).sum();
        assert!((back - p).length() < 1e-5, "{back} for {p}");
    }
    assert!(levels[1] > 1000 && levels[2] > 1000);
}

#[test]
fn just_outside_is_the_nearest_point_inside_and_nonsense_is_finite() {
    let (scene, light) = furnished();
    let volume = build(&scene, &light, &small([4, 4, 4]));
    let (low, high) = volume.grid().bounds();
    // Less than a quarter of a cell of 1 m and more beyond two faces.
    let outside = Vec3::new(low.x - 0.1, 1.0, high.z + 0.2);
    let n = Vec3::new(0.6, 0.0, 0.8);
    let at = |p, n| volume.irradiance(p, n, Part::All);
    let nearest = volume.with_basis(Basis::NearestBin);
    assert_eq!(at(outside, n), at(outside.clamp(low, high), n));
    for p in [Vec3::NAN, Vec3::INFINITY, Vec3::NEG_INFINITY, Vec3::splat(1e30)] {
        for n in [Vec3::NAN, Vec3::ZERO, Vec3::splat(f32::INFINITY), n] {
            assert!(at(p, n).is_finite(), "{p} {n}");
            assert!(nearest.irradiance(p, n, Part::All).is_finite(), "{p} {n}");
        }
    }
}

#[test]
fn relight_is_rebuild() {
    let (mut scene, light) = furnished();
    let volume = build(&scene, &light, &small([4, 3, 4]));
    // Within its cell: in another one a new volume would refine elsewhere, and relight keeps the samples.
    scene.lamps[0] = point_lamp(Vec3::new(0.4, 1.8, 0.7), 60.0);
    let other = PerTriangle(light.0.iter().map(|b| *b * Vec3::new(0.5, 1.5, 2.0)).collect());
    let relit = volume.relight(&World::new(&scene), &other, &[Target::Lamp(0)]);
    let rebuilt = build(&scene, &other, &small([4, 3, 4]));
    assert!(all_bytes(&relit) == all_bytes(&rebuilt));
    assert!(all_bytes(&relit) != all_bytes(&volume));
}

#[test]
fn a_moving_panel_is_lit_nearly_as_at_rest_and_then_exactly() {
    let (mut scene, light) = furnished();
    let volume = build(&scene, &light, &small([6, 5, 7]));
    let panel = Target::Object(scene.objects.len() - 1);
    scene.place(panel, Affine3A::from_translation(Vec3::new(0.3, -0.2, -0.6)));
    let world = World::new(&scene);
    let rest = volume.relight(&world, &light, &[panel]);
    let moving = volume.relight_moving(&world, &light, &[panel], &[panel]);
    let sum = |of: &dyn Fn(Vec3, Vec3) -> f32| -> f64 {
        let samples = (0..rest.samples().len()).filter(|&s| rest.samples()[s].valid);
        let pairs = samples.flat_map(|s| {
            let [a, b] = [&rest, &moving].map(|v| v.sample_irradiance(s, Part::Direct));
            a.into_iter().zip(b)
        });
        pairs.map(|(a, b)| f64::from(of(a, b))).sum()
    };
    let (mean, error) = (sum(&|a, _| a.y), sum(&|a, b| (a.y - b.y).abs()));
    let signed = sum(&|a, b| b.y - a.y);
    println!("off by {:.2} %, signed {:+.2} %", 100.0 * error / mean, 100.0 * signed / mean);
    // A leaf in full view sends what it should; a shadow's edge comes in steps of the panel's eighth.
    assert!(error < 0.02 * mean && error > 0.0, "{error} of {mean}");
    let settled = moving.relight(&world, &light, &[panel]);
    assert!(settled.tables() == rest.tables());
    let dimmed = volume.relight_moving(&world, &light, &[panel], &[]);
    assert!(dimmed.tables()[0] == rest.tables()[0], "only what moves is asked coarsely");
}

#[test]
fn one_thread_and_two_give_the_same_bytes() {
    let (scene, light) = furnished();
    let settings = VolumeSettings { supersample: 2, ..small([4, 4, 4]) };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| all_bytes(&build(&scene, &light, &settings)))
    };
    assert!(with(1) == with(2));
}

#[test]
fn samples_inside_a_solid_are_found_and_not_used() {
    let (scene, light) = furnished();
    let volume = build(&scene, &light, &small([6, 5, 7]));
    let (low, high) = (Vec3::new(0.8, 0.0, 1.0), Vec3::new(2.0, 1.1, 2.6));
    let mut inside_count = 0;
    for sample in volume.samples() {
        let inside = sample.position.cmpgt(low).all() && sample.position.cmplt(high).all();
        inside_count += usize::from(inside);
        assert_eq!(sample.valid, !inside, "{sample:?}");
    }
    assert!(inside_count >= 8, "{inside_count}");
    for i in 0..3000 {
        let mut rng = Rng::new(4, i);
        let p = Vec3::new(rng.next_f32() * 3.0, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
        let w = volume.weights(p);
        assert!((w.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        for k in 0..8 {
            assert!(w.valid[k] || w.weights[k] == 0.0 || w.valid == [false; 8], "{w:?}");
        }
    }
}

#[test]
fn fast_directions_agree_with_the_map() {
    for n in [1, 2, 9, 17, 49] {
        let bins = DirectionBins::new(n);
        let fast = Directions::new(bins);
        for bin in 0..bins.len() {
            assert_eq!(fast.nearest(bins.centre(bin)), bin);
            let b = fast.interpolated(bins.centre(bin));
            let own: f32 = (0..4).filter(|&k| b.bins[k] as usize == bin).map(|k| b.weights[k]).sum();
            // Half a bin of 1/n in steps of the square root's rounding near the pole.
            assert!(own > 0.98, "n = {n}, bin {bin}: {b:?}");
        }
        let mut differ = 0;
        for i in 0..20_000 {
            let d = uniform_direction(Rng::new(5, i).next_vec2());
            differ += u32::from(fast.nearest(d) != bins.bin(d));
            let b = fast.interpolated(d);
            assert!((b.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            // At the equator a step of one bin is 4/n rad outwards, a third more along the diagonal.
            let near = b.bins.iter().all(|&k| bins.centre(k as usize).dot(d) > 1.0 - 20.0 / (n * n) as f32);
            assert!(near, "n = {n}: {b:?} around {d}");
        }
        // Only directions within 2e-6 of a bin's edge may fall on its other side: n edges of 20,000.
        assert!(differ < 12, "n = {n}: {differ}");
        // On the equator the hemispheres weigh the same, at the corners of their squares too: height is zero.
        for i in 0..720 {
            let (z, x) = (i as f32 / 720.0 * TAU).sin_cos();
            let b = fast.interpolated(Vec3::new(x, 0.0, z));
            let height: f32 = (0..4).map(|k| b.weights[k] * bins.centre(b.bins[k] as usize).y).sum();
            assert!(height.abs() < 1e-5, "n = {n}, {i}: {b:?}");
        }
    }
}

#[test]
fn a_volume_comes_back_from_its_file_and_damage_is_named() {
    let (scene, light) = furnished();
    let volume = build(&scene, &light, &small([4, 3, 4]));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.volume");
    volume.save(&path).unwrap();
    let loaded = IrradianceVolume::load(&path).unwrap();
    assert_eq!(loaded.samples(), volume.samples());
    let (p, n) = (Vec3::new(1.0, 1.5, 3.0), Vec3::Y);
    assert_eq!(loaded.irradiance(p, n, Part::All), volume.irradiance(p, n, Part::All));
    assert!(!loaded.can_relight());

    let bytes = std::fs::read(&path).unwrap();
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    for broken in [&bytes[..bytes.len() - 5], &bytes[..20], b"", b"not a volume at all", &flipped] {
        std::fs::write(&path, broken).unwrap();
        let error = IrradianceVolume::load(&path).unwrap_err();
        assert!(matches!(error, VolumeError::Format { .. }), "{error}");
        assert!(error.to_string().contains("room.volume"), "{error}");
    }
    let missing = IrradianceVolume::load(&folder.path().join("none")).unwrap_err();
    assert!(matches!(missing, VolumeError::File { .. }), "{missing}");
}

#[test]
fn bad_settings_and_cancellation_are_errors() {
    let (scene, light) = furnished();
    let world = World::new(&scene);
    for settings in [
        small([1, 3, 3]),
        VolumeSettings { bins_n: 0, ..VolumeSettings::default() },
        VolumeSettings { second_level: 1, ..VolumeSettings::default() },
        VolumeSettings { supersample: 0, ..VolumeSettings::default() },
        VolumeSettings { back_face_limit: f32::NAN, ..VolumeSettings::default() },
    ] {
        let result = IrradianceVolume::build(&world, &light, &settings, &Progress::silent());
        assert!(matches!(result, Err(VolumeError::Setting { .. })));
    }
    let progress = Progress::silent();
    progress.cancel();
    let result = IrradianceVolume::build(&world, &light, &small([3, 3, 3]), &progress);
    assert!(matches!(result, Err(VolumeError::Cancelled(_))));
    let mut broken = scene.clone();
    broken.objects[0].world_from_object = Affine3A::from_translation(Vec3::NAN);
    let result = IrradianceVolume::build(
        &World::new(&broken),
        &light,
        &VolumeSettings::default(),
        &Progress::silent(),
    );
    assert!(result.unwrap().irradiance(Vec3::ZERO, Vec3::Y, Part::All).is_finite());
    let nothing = IrradianceVolume::build(
        &World::new(&Scene::default()),
        &PerTriangle(Vec::new()),
        &VolumeSettings::default(),
        &Progress::silent(),
    );
    assert_eq!(nothing.unwrap().irradiance(Vec3::ZERO, Vec3::Y, Part::All), Vec3::ZERO);
}

#[test]
fn a_probe_at_a_sample_is_that_sample() {
    let (scene, light) = furnished();
    let world = World::new(&scene);
    let settings = VolumeSettings { direct_samples: 64, ..small([4, 4, 4]) };
    let volume = build(&scene, &light, &settings);
    for (i, sample) in volume.samples().iter().enumerate().step_by(7) {
        let probe = Probe::at(&world, &light, sample.position, 17, 1, 0).unwrap();
        for part in [Part::Direct, Part::Indirect, Part::All] {
            for (a, b) in probe.irradiance(part).iter().zip(volume.sample_irradiance(i, part)) {
                assert!((*a - b).abs().max_element() <= 1e-3 * a.max_element() + 1e-6, "{a} {b}");
            }
        }
        assert_eq!(probe.radiance, volume.sample_radiance(i, &world, &light, Part::All));
    }
}

#[test]
fn views_show_what_is_asked_for() {
    let (scene, light) = furnished();
    let world = World::new(&scene);
    let volume = build(&scene, &light, &small([4, 4, 4]));
    let valid = volume.samples().iter().filter(|s| s.valid).count();
    let view = VolumeView::default();
    let all = volume_spheres(&volume, &world, &light, &view, None);
    assert_eq!(all.spheres.len(), valid);
    assert_eq!(all.sphere_bins.len(), valid * 578);
    let legend = all.legend.unwrap();
    assert_eq!((legend.quantity.as_str(), legend.unit.as_str()), ("irradiance", "lx"));
    assert!(legend.range[1] > legend.range[0]);
    let first =
        volume_spheres(&volume, &world, &light, &VolumeView { second_level: false, ..view.clone() }, None);
    let second =
        volume_spheres(&volume, &world, &light, &VolumeView { first_level: false, ..view.clone() }, None);
    assert_eq!(first.spheres.len() + second.spheres.len(), valid);
    let y = volume.samples()[0].position.y;
    let slice = VolumeView { slice: Some((1, y)), second_level: false, invalid: true, ..view.clone() };
    assert_eq!(volume_spheres(&volume, &world, &light, &slice, None).spheres.len(), 16);
    let radiance = VolumeView { quantity: Quantity::Radiance, ..view };
    assert_eq!(volume_spheres(&volume, &world, &light, &radiance, None).legend.unwrap().unit, "cd/m²");
    // A 3³ lattice of cells has 3 axes of 4 × 4 lines.
    let first = VolumeView { second_level: false, ..VolumeView::default() };
    assert_eq!(grid_lines(&volume, &first).value_lines.len(), 48);

    let probe = Probe::at(&world, &light, Vec3::new(1.5, 1.7, 2.0), 9, 4, 0).unwrap();
    let shown = probe_scene(&probe, Quantity::Irradiance, Part::All, 0.1);
    assert_eq!((shown.spheres.len(), shown.sphere_bins.len()), (1, 162));
    assert_eq!((shown.curves.len(), shown.images.len()), (3, 2));
    assert_eq!(shown.images[0].image.width, 9);
    let s = probe.statistics(Part::All);
    assert!(s.min_lx <= s.mean_lx && s.mean_lx <= s.max_lx && s.max_radiance >= 500.0 * 0.9);
}
