//! Panoramas, and volumes made of them.

use super::*;
use lumenscope_core::{
    io::{exr, panorama as files},
    irradiance_volume::{
        difference::Difference,
        panorama::{PanoramaNode, bins_of, direction, place, render},
    },
    math::image::LinearImage,
    scene::accel::Ray,
};

#[test]
fn places_and_directions_are_each_others_inverse() {
    for i in 0..2000 {
        let d = uniform_direction(Rng::new(8, i).next_vec2());
        assert!((direction(place(d)) - d).length() < 2e-5, "{d}");
    }
    // −z in the middle, +x to the right of it, +y on top.
    for (at, d) in [
        (Vec2::new(0.5, 0.5), Vec3::NEG_Z),
        (Vec2::new(0.75, 0.5), Vec3::X),
        (Vec2::new(0.25, 0.5), Vec3::NEG_X),
        (Vec2::new(0.3, 0.0), Vec3::Y),
    ] {
        assert!((direction(at) - d).length() < 1e-6, "{at}");
    }
}

#[test]
fn the_bins_of_a_picture_keep_its_flux() {
    let bins = DirectionBins::new(17);
    let constant = LinearImage { width: 32, height: 16, pixels: vec![Vec3::splat(4.0); 512] };
    assert!(bins_of(&constant, bins).iter().all(|l| (l.x - 4.0).abs() < 1e-5));
    // A single bright pixel of solid angle Δφ (cos θ₁ − cos θ₂).
    let mut one = LinearImage::new(64, 32);
    one.pixels[10 * 64 + 40] = Vec3::splat(1000.0);
    let edge = |row: f32| (PI * row / 32.0).cos();
    let omega = std::f32::consts::TAU / 64.0 * (edge(10.0) - edge(11.0));
    let flux: f32 = bins_of(&one, bins).iter().map(|l| l.x * bins.solid_angle()).sum();
    // A bin's mean is taken over pieces, of which a bin gets the whole number nearest to its share.
    assert!((flux / (1000.0 * omega) - 1.0).abs() < 0.05, "{flux} for {}", 1000.0 * omega);
    // The vector irradiance of a function linear in direction, L = 1 + x, is 4π/3 along x.
    let linear = render(64, 1, |d| Vec3::splat(1.0 + d.x));
    let sums = bins_of(&linear, bins)
        .iter()
        .enumerate()
        .fold(Vec3::ZERO, |sum, (b, l)| sum + bins.centre(b) * l.x * bins.solid_angle());
    // Directions within a bin average to a vector some tenths of a per cent shorter than its centre's.
    assert!((sums - Vec3::X * 4.0 * PI / 3.0).length() < 0.02, "{sums}");
}

/// Radiance that arrives at a point of a scene whose triangles have a radiosity each.
fn seen(world: &World, light: &PerTriangle, from: Vec3, along: Vec3) -> Vec3 {
    let Some(hit) = world.accel.trace(&Ray::new(from, along)) else { return Vec3::ZERO };
    let surface = world.geometry.surface(hit.triangle, hit.barycentric, along);
    if world.geometry.is_lit(&surface) { light.0[hit.triangle as usize] / PI } else { Vec3::ZERO }
}

#[test]
fn pictures_at_the_samples_give_the_volume_back() {
    // Through files, as a user would: rendered at the samples, written, read, made into a volume.
    let scene = room([Vec3::ZERO; 6]);
    let mut rng = Rng::new(6, 0);
    let light = PerTriangle((0..12).map(|_| Vec3::splat(20.0 + 80.0 * rng.next_f32())).collect());
    let world = World::new(&scene);
    let settings = VolumeSettings { supersample: 16, ..small([3, 2, 3]) };
    let built = build(&scene, &light, &settings);
    let folder = tempfile::tempdir().unwrap();
    let nodes: Vec<PanoramaNode> = built
        .samples()
        .iter()
        .filter(|s| s.level == 1)
        .enumerate()
        .map(|(i, sample)| {
            let image = render(96, 2, |d| seen(&world, &light, sample.position, d));
            let path = folder.path().join(format!("{i}.exr"));
            exr::write_layers(&path, &[("", &image)], "cd/m2").unwrap();
            PanoramaNode { position: sample.position, image: files::read(&path).unwrap() }
        })
        .collect();
    let made = IrradianceVolume::from_panoramas(&nodes, &small([3, 2, 3]), &Progress::silent()).unwrap();
    // The lattice of the nodes is found by itself too.
    let found =
        IrradianceVolume::from_panoramas(&nodes, &VolumeSettings::default(), &Progress::silent()).unwrap();
    assert!(all_bytes(&made) == all_bytes(&found));
    let s = Difference::new(&made, &built, Part::All).statistics();
    eprintln!("volume from panoramas against the volume built: {s:?}");
    // Pixels of 1.9° against 16 rays in bins of 8°: outlines of walls err by some hundredths of a bin.
    assert!(s.mean_lx.abs() < 0.002 * s.mean_b_lx && s.percentile_95_relative < 0.01, "{s:?}");
    assert!(s.largest_lx.abs() < 0.03 * s.mean_b_lx, "{s:?}");
    assert!(made.samples().iter().zip(nodes).all(|(s, n)| s.position.distance(n.position) < 1e-5));
}

#[test]
fn between_nodes_radiance_is_blended() {
    let flat = |l: f32| LinearImage { width: 16, height: 8, pixels: vec![Vec3::splat(l); 128] };
    let node = |x: f32, l: f32| PanoramaNode { position: Vec3::new(x, 1.0, 0.0), image: flat(l) };
    let nodes = [node(0.0, 1.0), node(2.0, 3.0)];
    let settings = VolumeSettings { bins_n: 5, ..small([3, 2, 2]) };
    let volume = IrradianceVolume::from_panoramas(&nodes, &settings, &Progress::silent()).unwrap();
    let at = |x: f32, y: f32| volume.irradiance(Vec3::new(x, y, 0.0), Vec3::X, Part::All).x;
    // Half-way both count alike. The grid reaches ½ m to each side of the nodes' line, so its samples are
    // √½ m off it: at x = 0 the weights are as 1/0.5 to 1/4.5.
    assert!((at(1.0, 1.0) - 2.0 * PI).abs() < 0.01, "{}", at(1.0, 1.0));
    let end = (1.0 / 0.5 + 3.0 / 4.5) / (1.0 / 0.5 + 1.0 / 4.5);
    assert!((at(0.0, 0.5) - end * PI).abs() < 0.01, "{} {end}", at(0.0, 0.5));
    for broken in [
        vec![],
        vec![PanoramaNode { position: Vec3::NAN, ..nodes[0].clone() }],
        vec![PanoramaNode { position: Vec3::ZERO, image: LinearImage::default() }],
    ] {
        let result = IrradianceVolume::from_panoramas(&broken, &settings, &Progress::silent());
        assert!(matches!(result, Err(VolumeError::Setting { .. })));
    }
}
