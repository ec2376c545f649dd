//! High complexity: a generated wall, streamed by, lit from the volume and forgotten.

use glam::{DVec3, UVec2, Vec2, Vec3};
use lumenscope_core::{
    irradiance_volume::{IrradianceVolume, VolumeSettings},
    math::{image::LinearImage, progress::Progress},
    radiosity::{RadiositySettings, RadiositySolution},
    scene::{camera::Camera, world::World},
    superposition::{
        gbuffer::GBuffer,
        layers::Layers,
        streamed::{StreamedPicture, Strip},
    },
};
use lumenscope_scenes::wall::{Wall, height};
use lumenscope_tests::box_room;

fn wall(polygons: u32) -> Wall {
    // Across the box room, its front towards +z.
    Wall::new(DVec3::new(-0.8, -0.9, -0.5), DVec3::X * 1.6, DVec3::Y * 1.2, polygons)
}

#[test]
fn a_wall_comes_out_the_same_however_it_is_cut() {
    let office = Wall::new(DVec3::ZERO, DVec3::Z * -6.0, DVec3::Y * 2.8, 612_000);
    assert!((612_000..625_000).contains(&office.polygons()), "{}", office.polygons());
    let wall = wall(4_000);
    let count = |rows| -> usize { wall.strips(rows).map(|s| s.triangles.len()).sum() };
    assert_eq!(count(1), wall.polygons() as usize);
    assert_eq!(count(7), wall.polygons() as usize);
    let width = wall.columns as usize + 1;
    let mut last: Option<Vec<Vec3>> = None;
    for strip in wall.strips(3) {
        // Neighbours share their row of vertices to the bit.
        if let Some(last) = last {
            assert_eq!(last, strip.positions[..width]);
        }
        last = Some(strip.positions[strip.positions.len() - width..].to_vec());
        for (p, n) in strip.positions.iter().zip(&strip.normals) {
            assert!((n.length() - 1.0).abs() < 1e-5 && n.z > 0.0, "{n}");
            assert!((p.z + 0.5).abs() < 0.012, "{p} stands a centimetre off the wall");
        }
        for t in &strip.triangles {
            let [a, b, c] = t.map(|i| strip.positions[i as usize]);
            assert!((b - a).cross(c - a).z > 0.0, "fronts look out of the wall");
        }
    }
    // Mortar lies behind the blocks.
    let mean = |x: f64, y: f64| {
        (0..50).map(|i| height(glam::DVec2::new(x + 0.002 * f64::from(i), y))).sum::<f64>() / 50.0
    };
    assert!(mean(0.1, 0.2) < mean(0.1, 0.1) - 0.002);
}

/// The furnace, its volume and what a camera in it sees.
fn furnace(reflectance: f32, emission: f32) -> (World, IrradianceVolume, Camera, GBuffer) {
    let scene = box_room(reflectance, emission);
    let world = World::new(&scene);
    let settings =
        RadiositySettings { element_spacing_m: Some(0.5), gather_rays: 64, ..RadiositySettings::default() };
    let light = RadiositySolution::solve(&world, &settings, &Progress::silent()).unwrap();
    let settings = VolumeSettings { samples: Some([3; 3]), bins_n: 9, ..VolumeSettings::default() };
    let volume = IrradianceVolume::build(&world, &light, &settings, &Progress::silent()).unwrap();
    let camera =
        Camera { eye: Vec3::new(0.0, -0.2, 0.9), target: Vec3::new(0.0, -0.3, -1.0), ..Camera::default() };
    let buffer = GBuffer::new(&world, &camera, UVec2::new(96, 64), Vec2::splat(0.5));
    (world, volume, camera, buffer)
}

fn streamed(rows: u32, shadow_rays: u32, cover: bool) -> (LinearImage, usize) {
    let (world, volume, camera, mut buffer) = furnace(0.5, 10.0);
    if cover {
        // Something stands in front of the left half.
        for (i, depth) in buffer.depth.iter_mut().enumerate() {
            *depth = if i % 96 < 48 { 0.1 } else { *depth };
        }
    }
    let mut stream = StreamedPicture::new(&buffer, &camera, &volume, Vec3::new(0.2, 0.4, 0.8));
    for strip in wall(20_000).strips(rows) {
        stream.draw(&Strip {
            positions: &strip.positions,
            normals: &strip.normals,
            triangles: &strip.triangles,
        });
    }
    let counts = stream.counts();
    assert_eq!(counts.polygons, wall(20_000).polygons() as usize);
    let mut layers = Layers::new(96, 64);
    stream.composite(&mut layers, &world, shadow_rays, &Progress::silent()).unwrap();
    (layers.total(), stream.pixels())
}

#[test]
fn streamed_geometry_in_a_furnace_shines_as_everything_does() {
    // Radiance 20 cd/m² from everywhere: irradiance 20 π on any normal, radiance ρ · 20.
    let (picture, pixels) = streamed(4, 0, false);
    assert!(pixels > 1500, "{pixels} pixels");
    let lit: Vec<&Vec3> = picture.pixels.iter().filter(|p| **p != Vec3::ZERO).collect();
    assert_eq!(lit.len(), pixels);
    for p in lit {
        // Constant radiance is read exactly, but for 16 bits a channel and the sweeps' tolerance.
        assert!((*p / Vec3::new(4.0, 8.0, 16.0) - 1.0).abs().max_element() < 5e-3, "{p}");
    }
    // The picture does not depend on how much is held at a time.
    assert_eq!(picture, streamed(1, 0, false).0);
    assert_eq!(picture, streamed(1000, 0, false).0);
    // Rays at the pixels find the same direct light: everything emits alike, nothing hides it.
    let (exact, _) = streamed(4, 64, false);
    let mean = |p: &LinearImage| p.mean().y;
    // Twelve emissive triangles in closed form, clipped at the receiver's horizon.
    assert!((mean(&exact) / mean(&picture) - 1.0).abs() < 0.01, "{} {}", mean(&exact), mean(&picture));
    let (half, pixels_left) = streamed(4, 0, true);
    assert!(pixels_left < pixels * 6 / 10);
    assert!((0..half.pixels.len()).all(|i| i % 96 >= 48 || half.pixels[i] == Vec3::ZERO));
}

#[test]
fn a_wall_of_612_000_polygons_is_held_a_strip_at_a_time() {
    let (_, volume, camera, buffer) = furnace(0.5, 10.0);
    let wall = wall(612_000);
    let mut stream = StreamedPicture::new(&buffer, &camera, &volume, Vec3::splat(0.5));
    let mut whole = 0;
    for strip in wall.strips(8) {
        let strip =
            Strip { positions: &strip.positions, normals: &strip.normals, triangles: &strip.triangles };
        whole += size_of_val(strip.positions) + size_of_val(strip.normals) + size_of_val(strip.triangles);
        stream.draw(&strip);
    }
    let counts = stream.counts();
    assert!(counts.polygons >= 612_000 && counts.polygons == wall.polygons() as usize);
    println!("{} bytes of {whole} held, {} polygons", counts.held_bytes, counts.polygons);
    // Nine rows of vertices: place and normal, the same as a query, two parts of light; sixteen triangles a column.
    let columns = wall.columns as usize;
    assert_eq!(counts.held_bytes, 9 * (columns + 1) * (24 + 24 + 24) + 8 * 2 * columns * 12);
    assert!(20 * counts.held_bytes < whole);
}
