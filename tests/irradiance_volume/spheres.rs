//! Spheres of light: read by bin and smoothly, as lobes, at every resolution, and in files.

use super::*;
use lumenscope_core::{
    io::{exr::read_layers, probe as file},
    irradiance_volume::lobe,
    math::{
        colour::{Channel, luminance},
        sphere_values::SphereValues,
    },
};

/// Rows of bins of the thesis's spheres.
const ROWS: [u32; 5] = [9, 17, 29, 41, 49];

/// Irradiance sphere of a lamp far away on +x that gives 1 lx: E(n) = max(0, n·x).
fn one_lamp(bins: DirectionBins) -> Vec<Vec3> {
    (0..bins.len()).map(|b| Vec3::splat(bins.centre(b).x.max(0.0))).collect()
}

#[test]
fn the_lobe_of_one_lamp_is_a_sphere_through_the_point() {
    // r(n) = n·x is the sphere of radius ½ about x/2 (Thales), all of it on the lit side.
    for n in ROWS {
        let bins = DirectionBins::new(n);
        let values = one_lamp(bins);
        let sphere = SphereValues { bins, values: &values };
        let mesh = lobe::lobe(&sphere, true, luminance);
        let worst = mesh
            .positions
            .iter()
            .filter(|p| p.x > 0.2)
            .fold(0.0f32, |worst, p| worst.max((p.distance(Vec3::X * 0.5) - 0.5).abs()));
        // Bilinear reading of a function of slope and curvature 1 at most. A cell is up to 4/n rad by 2.2/n
        // rad wide: curvature costs an eighth of their squares. On the square's diagonals the radius
        // max(|u|, |v|) has a kink, which a cell across it cuts by up to 1/n.
        let bound = 1.0 / n as f32 + 2.6 / (n * n) as f32;
        assert!(worst < bound, "n = {n}: {worst}, at most {bound}");
    }
}

#[test]
fn the_lobe_of_even_light_is_a_ball_by_bin_and_smooth() {
    for n in ROWS {
        let bins = DirectionBins::new(n);
        let values = vec![Vec3::new(2.0, 3.0, 5.0); bins.len()];
        let sphere = SphereValues { bins, values: &values };
        for channel in Channel::ALL {
            let radius = channel.measure(values[0]);
            let smooth = lobe::lobe(&sphere, true, |v| channel.measure(v));
            assert!(smooth.positions.iter().all(|p| (p.length() / radius - 1.0).abs() < 1e-5), "{channel:?}");
            let by_bin = lobe::lobe(&sphere, false, |v| channel.measure(v));
            assert_eq!(by_bin.positions.len(), 5 * bins.len());
            // The volume of the pyramids' tops over the middle tends to that of the ball from below.
            let volume = |mesh: &lumenscope_core::inspection::ColouredMesh| -> f64 {
                let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
                mesh.triangles
                    .iter()
                    .map(|[a, b, c]| corner(*a).dot(corner(*b).cross(corner(*c))) / 6.0)
                    .sum()
            };
            let ball = 4.0 / 3.0 * std::f64::consts::PI * f64::from(radius).powi(3);
            for mesh in [&smooth, &by_bin] {
                let share = volume(mesh) / ball;
                // Chords of up to 0.53 rad (n = 9) cut off about half the square of an eighth of them twice.
                assert!(
                    share < 1.0 && share > 0.93,
                    "n = {n}, {channel:?}: {share} of the ball, turned outwards"
                );
            }
        }
    }
}

/// A room of six walls, each a constant colour.
fn room() -> (World, PerTriangle) {
    let colours = [0.2, 1.0, 0.5, 3.0, 0.1, 0.7];
    let mut scene = Scene::default();
    for (i, mesh) in faces(Vec3::splat(-1.0), Vec3::splat(1.0), true).into_iter().enumerate() {
        let grey = Material { reflectance: Vec3::splat(0.5), ..Material::default() };
        add(&mut scene, &format!("wall {i}"), mesh, grey);
    }
    let radiosity = colours.into_iter().flat_map(|c| [Vec3::new(c, c, 0.5 * c) * PI; 2]).collect();
    (World::new(&scene), PerTriangle(radiosity))
}

#[test]
fn finer_spheres_are_nearer_to_the_finest_and_files_hold_them_bit_by_bit() {
    let (world, light) = room();
    let at = Vec3::new(0.3, -0.2, 0.1);
    let probes = ROWS.map(|n| Probe::at(&world, &light, at, n, 4, 1).unwrap());
    let finest = probes[4].irradiance(Part::All);
    let finest = SphereValues { bins: probes[4].bins, values: &finest };
    let off = probes.each_ref().map(|p| {
        let values = p.irradiance(Part::All);
        SphereValues { bins: p.bins, values: &values }.relative_difference(&finest)
    });
    println!("irradiance against 4802 bins, root mean square over the mean: {off:?}");
    assert!(off[0] > off[1] && off[1] > off[2] && off[2] > off[3], "{off:?}");
    // The finest sphere is met at the centres of its own bins, up to rounding.
    assert!(off[4] < 1e-5, "{off:?}");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("probe.exr");
    let probe = &probes[1];
    file::write_probe(&path, probe, &[], false).unwrap();
    let layers = read_layers(&path).unwrap();
    let names: Vec<&str> = layers.iter().map(|l| l.0.as_str()).collect();
    assert_eq!(names[0], "latitude_longitude", "the map's plain R, G and B are what any viewer shows");
    assert_eq!(layers.len(), 1 + 2 * file::LAYERS.len());
    let n = probe.bins.n();
    for (name, quantity, part) in file::LAYERS {
        let values = probe.values(quantity, part);
        let of: Vec<_> = layers.iter().filter(|l| l.0 == name).map(|l| &l.1).collect();
        let [map, bins] = of[..] else { panic!("{name} is in both parts: {names:?}") };
        assert_eq!((bins.width, bins.height), (2 * n, n));
        for (bin, value) in values.iter().enumerate() {
            let (cell, lower) = (bin as u32 % (n * n), bin as u32 / (n * n));
            assert_eq!(bins.at(cell % n + lower * n, cell / n), *value, "{name}, bin {bin}");
        }
        // +x is in the middle of the left half, up on top.
        let seen = |d: Vec3| values[probe.bins.bin(d)];
        assert_eq!(map.at(map.width / 4, map.height / 2), seen(Vec3::new(1.0, -1e-3, -1e-3).normalize()));
        assert_eq!(
            map.at(map.width / 3, 0).x.to_bits(),
            seen(Vec3::new(0.02, 1.0, -0.01).normalize()).x.to_bits()
        );
    }
    let read = exr::prelude::read_all_data_from_file(&path).unwrap();
    let first = &read.layer_data[0].attributes;
    assert_eq!(first.environment_map, Some(exr::meta::attribute::EnvironmentMap::LatitudeLongitude));
    let said = format!("{:?}", first.other);
    assert!(said.contains("cd/m2") && said.contains("lx") && said.contains("0.3 -0.2 0.1 m"), "{said}");
}
