//! Culling leaves out nothing that shows.

use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::random::Rng,
    mirror::{
        culling::{Blocks, Portal},
        reflectors::Reflectors,
        views::{Eye, Rectangle, mirrored_views},
    },
    scene::{
        Scene,
        accel::Ray,
        camera::Camera,
        geometry::{Geometry, offset_origin},
        import::load,
        material::Material,
        mesh::Mesh,
        world::World,
    },
    superposition::gbuffer::{first_visible, pixel_direction},
};
use lumenscope_tests::add;
use std::{ops::Range, path::Path};

const SIZE: UVec2 = UVec2::new(96, 64);
/// Places along a side of a triangle.
const FINE: usize = 100;

fn holds(ranges: &[Vec<Range<u32>>; 2], triangle: u32) -> bool {
    ranges.iter().flatten().any(|r| r.contains(&triangle))
}

#[test]
fn a_view_is_needed_where_a_pixel_shows_the_reflector_and_hardly_anywhere_else() {
    // A triangle: the rectangle around it in the picture shows often where it does not.
    let mirror = Material { metallic: 1.0, roughness: 0.0, double_sided: true, ..Material::default() };
    let triangle = Mesh {
        positions: vec![Vec3::new(-0.9, -0.8, 0.3), Vec3::new(1.1, -0.2, -0.4), Vec3::new(-0.3, 1.0, 0.1)],
        normals: vec![Vec3::ZERO; 3],
        uvs: vec![Vec2::ZERO; 3],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let normal = (triangle.positions[1] - triangle.positions[0])
        .cross(triangle.positions[2] - triangle.positions[0])
        .normalize();
    let mesh = Mesh { normals: vec![normal; 3], ..triangle };
    let of = |double_sided| {
        let mut scene = Scene::default();
        add(&mut scene, "mirror", mesh.clone(), Material { double_sided, ..mirror.clone() });
        World::new(&scene)
    };
    let (both, front) = (of(true), of(false));
    let reflectors = Reflectors::new(&both.geometry);
    let (mut seen, mut out_of_sight, mut spare) = (0, 0, 0);
    for i in 0..1_000 {
        let mut rng = Rng::new(3, i);
        let mut place = |size: f32| size * (2.0 * rng.next_vec2().extend(rng.next_f32()) - 1.0);
        let camera = Camera { eye: place(2.5), target: place(2.5), ..Camera::default() };
        let lens = Eye::new(&camera, SIZE.x as f32 / SIZE.y as f32);
        let shows = (0..SIZE.x * SIZE.y).any(|i| {
            let at = UVec2::new(i % SIZE.x, i / SIZE.x);
            let along = pixel_direction(&camera, SIZE, at, Vec2::splat(0.5));
            both.accel.trace(&Ray::new(camera.eye, along)).is_some()
        });
        // Or a place on it that lies between the pixels' rays.
        let [a, b, c] = both.geometry.positions[0];
        let inside = |place: Vec3| {
            let away = place - lens.position;
            let z = away.dot(lens.forward);
            z > 0.0
                && (Vec2::new(away.dot(lens.right), away.dot(lens.up)).abs().cmple(z * lens.half_size)).all()
        };
        let shares =
            (0..=FINE).flat_map(|i| (0..=FINE - i).map(move |j| [i, j].map(|s| s as f32 / FINE as f32)));
        let lies = shows || shares.into_iter().any(|[u, v]| inside(a + (b - a) * u + (c - a) * v));
        let views = mirrored_views(&both.geometry, &reflectors, lens, 1);
        assert!(!shows || views.len() == 1, "camera {i} sees the mirror and has no view of it");
        (seen, out_of_sight) = (seen + usize::from(shows), out_of_sight + usize::from(!lies));
        spare += usize::from(!lies && !views.is_empty());
        // The back of what has one side reflects nothing.
        let behind = reflectors.list[0].normal.dot(camera.eye) < reflectors.list[0].offset;
        let of_front = mirrored_views(&front.geometry, &Reflectors::new(&front.geometry), lens, 1);
        assert_eq!(of_front.is_empty(), behind || views.is_empty(), "camera {i}");
    }
    println!("{seen} cameras see it, {out_of_sight} do not; {spare} of these have a view");
    // Where only a tip of it reaches in, between the places asked.
    assert!(seen > 200 && out_of_sight > 200 && spare * 100 < out_of_sight, "{spare} of {out_of_sight}");
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
