//! Volumes whose radiance is given: repaired, with moments, through files, and files that lie.

use super::*;
use lumenscope_core::{
    io::{panorama as files, probe::write_probe},
    irradiance_volume::{
        moments::Order,
        panorama::{PanoramaNode, bins_of, half_turned},
        trust::SampleState,
    },
    math::image::LinearImage,
    superposition::panorama::panorama,
};
use lumenscope_tests::{cornell, solved};

fn traced(volume: &IrradianceVolume, world: &World) -> IrradianceVolume {
    volume.of_reference(world, 4, &Progress::silent()).unwrap()
}

#[test]
fn a_traced_volume_fills_what_the_one_it_follows_filled() {
    let (scene, light) = furnished();
    let settings = VolumeSettings { bins_n: 5, repair: Repair::Dilate, ..small([4, 4, 5]) };
    let volume = build(&scene, &light, &settings);
    let dilated: Vec<usize> =
        (0..volume.samples().len()).filter(|&s| volume.samples()[s].state == SampleState::Dilated).collect();
    assert!(!dilated.is_empty());
    let traced = traced(&volume, &World::new(&scene));
    for s in dilated {
        let e = traced.sample_irradiance(s, Part::All);
        assert!(e.iter().all(|e| e.max_element() > 0.0), "sample {s}: {:?}", volume.samples()[s]);
    }
}

#[test]
fn a_traced_volume_holds_moments_and_comes_back_from_its_file() {
    // A furnace: L = 6 everywhere, 3 of it after a bounce; every moment of constant radiance is πL.
    let mut scene = room([Vec3::splat(3.0); 6]);
    scene.materials.iter_mut().for_each(|m| m.reflectance = Vec3::splat(0.5));
    let world = World::new(&scene);
    let light = PerTriangle(vec![Vec3::splat(PI * 3.0); 12]);
    let orders = vec![Order::Infinite, Order::Finite(4), Order::IRRADIANCE];
    let settings = VolumeSettings { bins_n: 5, moments: orders, ..small([2, 2, 2]) };
    let traced = traced(&build(&scene, &light, &settings), &world);
    assert_eq!(traced.orders(), [Order::IRRADIANCE, Order::Finite(4), Order::Infinite]);
    let file = tempfile::NamedTempFile::new().unwrap();
    traced.save(file.path()).unwrap();
    let loaded = IrradianceVolume::load(file.path()).unwrap();
    assert_eq!(loaded.orders(), traced.orders());
    for order in loaded.orders() {
        // Emitters lie in the walls: what is seen of them is exact, to the codec's 4.9e-4.
        let direct = loaded.sample_moment(0, order, Part::Direct).unwrap();
        let off = direct.iter().map(|e| (e.x / (3.0 * PI) - 1.0).abs()).fold(0.0, f32::max);
        // Leaves of the walls count as one direction each: some per cent on a lobe of order 4.
        assert!(off < if order == Order::Infinite { 5e-4 } else { 0.08 }, "order {order}: {off}");
        let all = loaded.sample_moment(0, order, Part::All).unwrap();
        let mean = all.iter().map(|e| e.x).sum::<f32>() / all.len() as f32;
        // 4 paths in each of 50 bins, each spread by less than its mean.
        assert!((mean / (6.0 * PI) - 1.0).abs() < 0.08, "order {order}: {mean}");
    }
}

#[test]
fn a_picture_turned_half_round_twice_is_itself() {
    let image = LinearImage::from_fn(8, 3, |x, y| Vec3::new(x as f32, y as f32, 1.0));
    assert_ne!(half_turned(&image), image);
    assert_eq!(half_turned(&half_turned(&image)), image);
    // In an odd number of columns the sum of a row, its flux, stays.
    let odd = LinearImage::from_fn(5, 1, |x, _| Vec3::splat(x as f32));
    assert_eq!(half_turned(&odd).pixels.iter().map(|p| p.x).sum::<f32>(), 10.0);
}

#[test]
fn what_is_exported_of_a_probe_is_read_as_a_panorama_the_same_way_round() {
    let (scene, light) = furnished();
    let world = World::new(&scene);
    let probe = Probe::at(&world, &light, Vec3::new(0.5, 1.0, 3.0), 9, 4, 1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("probe.exr");
    write_probe(&path, &probe, &[], false).unwrap();
    let read = bins_of(&files::read(&path).unwrap(), probe.bins);
    let flux = |of: &dyn Fn(usize) -> f32| (0..probe.bins.len()).map(of).sum::<f32>();
    let all = flux(&|b| probe.radiance[b].y);
    // Maps of 90 rows: along the outlines of bins a pixel is its neighbour's.
    let off = flux(&|b| (read[b].y - probe.radiance[b].y).abs());
    assert!(off < 0.08 * all, "{off} of {all}");
}

#[test]
fn a_panorama_of_the_program_becomes_a_volume_that_answers_as_a_probe_there() {
    let solution = solved(cornell(), 0.25);
    let at = Vec3::new(0.1, 1.2, 0.1);
    let image = panorama(&solution, at, 128, 2, &Progress::silent()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.exr");
    files::write(&path, &image, at).unwrap();
    assert_eq!(files::read(&path).unwrap(), image);
    let node = PanoramaNode { position: at, image: files::read(&path).unwrap() };
    let volume =
        IrradianceVolume::from_panoramas(&[node], &VolumeSettings::default(), &Progress::silent()).unwrap();
    let probe = Probe::at(&solution.world, &*solution.radiosity, at, 17, 16, 1).unwrap();
    let exact = probe.irradiance(Part::All);
    let mean = exact.iter().map(|e| e.y).sum::<f32>() / exact.len() as f32;
    for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::NEG_Z] {
        let bin = probe.bins.bin(axis);
        let found = volume.irradiance(at, probe.bins.centre(bin), Part::All);
        // The lamp spans some of the picture's pixels of 1.4°, and some bins of 8° on the other side.
        let error = (found - exact[bin]).abs().max_element();
        assert!(error < 0.03 * mean, "{axis}: {found} for {}", exact[bin]);
    }
    // Red on the left, green on the right: a picture the wrong way round would swap them.
    let ratio = |n: Vec3| {
        let e = volume.irradiance(at, n, Part::All);
        e.x / e.y
    };
    assert!(ratio(Vec3::NEG_X) > 1.3 * ratio(Vec3::X));
}

/// A volume file with a body of one's own, its checksum right.
fn sealed(magic: &[u8; 8], body: &[u8]) -> Vec<u8> {
    let sum = body.chunks(8).fold(0xCBF2_9CE4_8422_2325 ^ body.len() as u64, |hash, chunk| {
        let mut word = [0u8; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        (hash ^ u64::from_le_bytes(word)).wrapping_mul(0x0000_0100_0000_01B3).rotate_left(29)
    });
    [magic, &sum.to_le_bytes()[..], body].concat()
}

#[test]
fn a_volume_file_from_before_there_were_pockets_is_read() {
    let (scene, light) = furnished();
    let volume = build(&scene, &light, &small([3, 3, 3]));
    let file = tempfile::NamedTempFile::new().unwrap();
    volume.save(file.path()).unwrap();
    let mut body = std::fs::read(file.path()).unwrap().split_off(16);
    let word = |at: usize| u32::from_le_bytes(body[at..at + 4].try_into().unwrap()) as usize;
    // Settings, six numbers of the bounds, the size, a flag a cell; then how many pockets there are.
    let size = 4 + word(0) + 24;
    let cells: usize = (0..3).map(|i| word(size + 4 * i)).product();
    let count = size + 12 + cells;
    assert_eq!(word(count), 0);
    body.drain(count..count + 4);
    std::fs::write(file.path(), sealed(b"LUMVOL02", &body)).unwrap();
    assert!(all_bytes(&IrradianceVolume::load(file.path()).unwrap()) == all_bytes(&volume));
}

#[test]
fn a_volume_file_that_promises_more_than_it_holds_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("crafted.volume");
    let refused = |settings: &VolumeSettings, corners: [f32; 6], size: [u32; 3]| {
        let json = serde_json::to_vec(settings).unwrap();
        let mut body = (json.len() as u32).to_le_bytes().to_vec();
        body.extend(json);
        corners.iter().for_each(|c| body.extend(c.to_le_bytes()));
        size.iter().for_each(|n| body.extend(n.to_le_bytes()));
        body.extend([1u8; 64]);
        std::fs::write(&path, sealed(b"LUMVOL03", &body)).unwrap();
        let error = IrradianceVolume::load(&path).unwrap_err().to_string();
        assert!(error.contains("crafted.volume") && !error.contains('\n'), "{error}");
        error
    };
    let unit = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let plain = plain_settings();
    assert!(refused(&plain, unit, [2, 2, 2]).contains("bytes"), "too short");
    assert!(refused(&plain, unit, [200; 3]).contains("GB"));
    let one_bin = VolumeSettings { bins_n: 1, second_level: 9, ..plain.clone() };
    assert!(refused(&one_bin, unit, [200; 3]).contains("GB"));
    assert!(refused(&plain, unit, [u32::MAX; 3]).contains("grid"));
    assert!(refused(&plain, [0.0, 0.0, 0.0, f32::INFINITY, 1.0, 1.0], [2, 2, 2]).contains("grid"));
    assert!(refused(&plain, [f32::NAN, 0.0, 0.0, 1.0, 1.0, 1.0], [2, 2, 2]).contains("grid"));
    let eight = VolumeSettings { bins_n: 128, moments: (2..10).map(Order::Finite).collect(), ..plain };
    assert!(refused(&eight, unit, [1, 1, 1]).contains("GB"));
}

#[test]
fn panoramas_that_are_none_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let hdr = |size: &str, rest: &[u8]| {
        [format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").as_bytes(), rest].concat()
    };
    let good = lumenscope_core::io::panorama::write;
    let path = folder.path().join("good.exr");
    good(&path, &LinearImage { width: 8, height: 4, pixels: vec![Vec3::ONE; 32] }, Vec3::ZERO).unwrap();
    let exr = std::fs::read(&path).unwrap();
    let mut wide = exr.clone();
    let at = exr.windows(10).position(|w| w == b"dataWindow").unwrap() + 21;
    wide[at + 8..at + 16].copy_from_slice(&[0xff, 0xff, 0xff, 0x3f, 0xff, 0xff, 0xff, 0x3f]);
    for (name, bytes) in [
        ("cut.exr", exr[..exr.len() / 2].to_vec()),
        ("wide.exr", wide),
        ("header.hdr", b"#?RADIANCE".to_vec()),
        ("no_size.hdr", hdr("", &[])),
        ("negative.hdr", hdr("-Y -5 +X -7", &[1; 64])),
        ("huge.hdr", hdr("-Y 4000000000 +X 4000000000", &[2; 64])),
        ("large.hdr", hdr("-Y 100000 +X 200000", &[2; 64])),
        ("empty.hdr", hdr("-Y 0 +X 0", &[])),
        ("short.hdr", hdr("-Y 64 +X 128", &[2, 2, 0, 128])),
        ("words.hdr", hdr("-Y a +X b", &[])),
        ("text.png", b"not a picture".to_vec()),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        match files::read(&path) {
            // A picture without pixels is refused by the volume.
            Ok(image) => assert!(image.pixels.is_empty(), "{name} was read"),
            Err(error) => {
                let error = error.to_string();
                assert!(error.contains(name) && !error.contains('\n'), "{error}");
            }
        }
    }
}

#[test]
fn a_radiance_hdr_is_read_with_minus_z_in_the_middle() {
    // Bright towards −z, in the middle of the picture; RGBE keeps powers of two exactly.
    let picture = image::Rgb32FImage::from_fn(64, 32, |x, _| {
        image::Rgb(if (24..40).contains(&x) { [8.0, 4.0, 2.0] } else { [0.5; 3] })
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.hdr");
    picture.save(&path).unwrap();
    let read = files::read(&path).unwrap();
    assert_eq!((read.width, read.height), (64, 32));
    assert_eq!((read.at(32, 16), read.at(2, 16)), (Vec3::new(8.0, 4.0, 2.0), Vec3::splat(0.5)));
    let node = PanoramaNode { position: Vec3::ZERO, image: read };
    let settings = VolumeSettings { bins_n: 9, ..VolumeSettings::default() };
    let volume = IrradianceVolume::from_panoramas(&[node], &settings, &Progress::silent()).unwrap();
    let at = |n: Vec3| volume.irradiance(Vec3::ZERO, n, Part::All).x;
    assert!(at(Vec3::NEG_Z) > 4.0 * at(Vec3::Z), "{} {}", at(Vec3::NEG_Z), at(Vec3::Z));
}
