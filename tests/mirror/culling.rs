//! Culling leaves out nothing that shows.

use glam::{UVec2, Vec2};
use lumenscope_core::{
    mirror::{
        culling::{Blocks, Portal},
        reflectors::Reflectors,
        views::{Eye, Rectangle, mirrored_views},
    },
    scene::{
        accel::Ray,
        camera::Camera,
        geometry::{Geometry, offset_origin},
        import::load,
        world::World,
    },
    superposition::gbuffer::{first_visible, pixel_direction},
};
use std::{ops::Range, path::Path};

const SIZE: UVec2 = UVec2::new(96, 64);

fn holds(ranges: &[Vec<Range<u32>>; 2], triangle: u32) -> bool {
    ranges.iter().flatten().any(|r| r.contains(&triangle))
}

#[test]
fn what_the_pixels_see_directly_and_in_mirrors_is_always_drawn() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/house/house.ron");
    let scene = load(&file).unwrap();
    let world = World::new(&scene);
    let geometry: &Geometry = &world.geometry;
    let (reflectors, blocks) = (Reflectors::new(geometry), Blocks::new(geometry));
    let margin = Portal::margin(SIZE.to_array());
    let eyes = [scene.camera.eye, scene.camera.eye + glam::Vec3::new(-2.6, 0.1, -0.3)];
    let targets = [scene.camera.target, glam::Vec3::new(-0.1, 1.0, 1.9)];
    let (mut direct, mut mirrored, mut drawn, mut of) = (0, 0, 0, 0);
    for (eye, target) in eyes.into_iter().flat_map(|e| targets.map(|t| (e, t))) {
        let camera = Camera { eye, target, ..scene.camera };
        let lens = Eye::new(&camera, SIZE.x as f32 / SIZE.y as f32);
        let seen = blocks.seen(&Portal::new(&lens, Rectangle::ALL, margin));
        let views = mirrored_views(geometry, &reflectors, lens, 1);
        let of_views: Vec<_> = views.iter().map(|v| blocks.seen(&Portal::of_view(v, margin))).collect();
        for ranges in std::iter::once(&seen).chain(&of_views) {
            for (kind, ranges) in ranges.iter().enumerate() {
                assert!(ranges.windows(2).all(|w| w[0].end < w[1].start), "in order and apart");
                let is_of_kind = |t| usize::from(geometry.material_of(t).double_sided) == kind;
                assert!(ranges.iter().cloned().flatten().all(is_of_kind), "sides");
            }
            drawn += ranges.iter().flatten().map(|r| r.len()).sum::<usize>();
            of += geometry.len();
        }
        for i in 0..SIZE.x * SIZE.y {
            let direction =
                pixel_direction(&camera, SIZE, UVec2::new(i % SIZE.x, i / SIZE.x), Vec2::splat(0.5));
            let Some(hit) = first_visible(&world, eye, direction) else { continue };
            direct += 1;
            assert!(holds(&seen, hit.triangle), "triangle {} of pixel {i}", hit.triangle);
            let Some(view) = views.iter().position(|v| v.reflector == reflectors.of(hit.triangle)) else {
                continue;
            };
            let surface = geometry.surface(hit.triangle, hit.barycentric, direction);
            let along = reflectors.list[views[view].reflector as usize].mirror_direction(direction);
            let origin = offset_origin(surface.position, surface.geometric_normal);
            let Some(hit) = world.accel.trace(&Ray::new(origin, along)) else { continue };
            mirrored += 1;
            assert!(holds(&of_views[view], hit.triangle), "triangle {} mirrored at pixel {i}", hit.triangle);
        }
    }
    println!("{direct} pixels, {mirrored} mirrored; {:.1} % drawn", 100.0 * drawn as f32 / of as f32);
    assert!(mirrored > 5_000 && direct > 20_000, "{direct} {mirrored}");
    assert!(drawn * 10 < of * 8, "{drawn} of {of} triangles are drawn");
}
