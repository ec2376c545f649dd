//! Flat mirrors: against the path tracer, against closed forms, and what they cost.

use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::part::Part,
    measure::significance::z_test,
    mirror::{
        reflectors::Reflectors,
        views::{Eye, MirroredView, mirrored_views},
    },
    reference::{Estimate, radiance::radiance},
    scene::{
        Scene, accel::Ray, camera::Camera, fresnel, geometry::Geometry, material::Material, world::World,
    },
    superposition::{
        PassSettings,
        composite::DirectQuality,
        gbuffer::{NO_TRIANGLE, pixel_direction},
        layers::Layer,
        plan::{Component, Plan},
        render,
    },
};
use lumenscope_tests::{add, cornell, cuboid, diffuse, rectangle, solved};
use std::f32::consts::FRAC_1_PI;

const SIZE: UVec2 = UVec2::new(48, 36);

fn mirror(normal_reflectance: Vec3) -> Material {
    Material { reflectance: normal_reflectance, metallic: 1.0, roughness: 0.0, ..Material::default() }
}

/// A floor at a right angle to a golden mirror, a dark block on it, and a lamp beside the mirror that shines
/// away from it: the floor's image is in its own plane, so light arrives everywhere straight from the lamp.
pub fn floor_and_mirror() -> Scene {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(0.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    add(&mut scene, "floor", floor, diffuse("floor", Vec3::new(0.6, 0.5, 0.4), Vec3::ZERO));
    let wall = rectangle(Vec3::new(0.0, 0.0, -2.0), Vec3::Y * 3.0, Vec3::Z * 4.0);
    add(&mut scene, "mirror", wall, mirror(Vec3::new(0.63, 0.56, 0.37)));
    let lamp = rectangle(Vec3::new(0.1, 1.2, -0.4), Vec3::Y * 0.6, Vec3::Z * 0.8);
    add(&mut scene, "lamp", lamp, diffuse("lamp", Vec3::ZERO, Vec3::new(100.0, 90.0, 70.0)));
    let block = cuboid(Vec3::new(1.0, 0.001, -0.3), Vec3::new(1.4, 0.7, 0.4), false);
    add(&mut scene, "block", block, diffuse("black", Vec3::ZERO, Vec3::ZERO));
    scene.camera =
        Camera { eye: Vec3::new(3.0, 1.4, 1.8), target: Vec3::new(0.0, 0.5, 0.0), ..Camera::default() };
    scene
}

fn views(scene: &Scene, camera: &Camera, depth: u32) -> Vec<MirroredView> {
    let geometry = Geometry::new(scene);
    mirrored_views(&geometry, &Reflectors::new(&geometry), Eye::new(camera, 4.0 / 3.0), depth)
}

#[test]
fn a_mirror_shows_what_the_path_tracer_sees_in_it() {
    let scene = floor_and_mirror();
    let camera = scene.camera;
    let solution = solved(scene, 0.5);
    let settings = PassSettings { direct: DirectQuality::PerPixel(256), ..PassSettings::default() };
    let (buffer, layers) = render(&solution, &camera, SIZE.x, SIZE.y, &settings);
    let picture = layers.total();
    let (mut found, mut wanted) = (Vec::new(), Vec::new());
    let mut mirrored = 0;
    for (i, value) in picture.pixels.iter().enumerate().filter(|(i, _)| i % 2 == 0) {
        if buffer.triangle[i] == NO_TRIANGLE {
            continue;
        }
        let pixel = UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
        let ray = Ray::new(camera.eye, pixel_direction(&camera, SIZE, pixel, Vec2::splat(0.5)));
        wanted.push(radiance(&solution.world, &ray, 320, i as u64));
        found.push(Estimate { mean: *value, ..Estimate::default() });
        mirrored += usize::from(layers.get(Layer::Mirror).pixels[i].x > 0.0);
    }
    let test = z_test(&found, &wanted, 0.01).unwrap();
    println!("{mirrored} of {} pixels in the mirror: {test:?}", found.len());
    assert!(mirrored > 60 && test.passes(), "{test:?}");
}

/// Two mirrors that face each other and glow, and a camera between them that looks at one.
fn two_mirrors() -> Scene {
    let mut scene = Scene::default();
    let glowing = |e: f32| Material { emission: Vec3::splat(e), ..mirror(Vec3::new(0.8, 0.5, 0.3)) };
    let (y, z) = (Vec3::Y * 8.0, Vec3::Z * 8.0);
    add(&mut scene, "left", rectangle(Vec3::new(-1.0, -4.0, -4.0), y, z), glowing(3.0));
    add(&mut scene, "right", rectangle(Vec3::new(1.0, -4.0, -4.0), z, y), glowing(5.0));
    scene.camera = Camera {
        eye: Vec3::ZERO,
        target: Vec3::new(-1.0, 0.1, 0.05),
        vertical_fov: 0.4,
        ..Camera::default()
    };
    scene
}

#[test]
fn two_facing_mirrors_are_the_series_of_their_attenuations() {
    let mut scene = two_mirrors();
    let depth = 5;
    scene.plan.mirror_depth = Some(depth);
    let camera = scene.camera;
    assert_eq!(views(&scene, &camera, depth).len(), depth as usize, "one view a mirror in a mirror");
    let solution = solved(scene, 1.0);
    let (_, layers) = render(&solution, &camera, SIZE.x, SIZE.y, &PassSettings::default());
    for (i, value) in layers.get(Layer::Mirror).pixels.iter().enumerate() {
        let pixel = UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
        let direction = pixel_direction(&camera, SIZE, pixel, Vec2::splat(0.5));
        let f = fresnel::reflectance_rgb(Vec3::new(0.8, 0.5, 0.3), direction.x.abs());
        // Seen is the left one; its image shows the right one, 5, that one's the left, 3, and so on.
        let series: Vec3 = (1..=depth).map(|k| f.powf(k as f32) * if k % 2 == 1 { 5.0 } else { 3.0 }).sum();
        // The last one reflects as if dull: F E / π, E what radiosity stored where the chain ends.
        let across = direction / direction.x.abs();
        let end = across * (1.0 + 2.0 * depth as f32);
        let end = Vec3::new(if depth % 2 == 1 { 1.0 } else { -1.0 }, end.y, end.z);
        let hit =
            solution.world.accel.trace(&Ray::new(end * Vec3::new(0.9, 1.0, 1.0), Vec3::X * end.x)).unwrap();
        let e = solution.radiosity.irradiance(hit.triangle, hit.barycentric, false, Part::All);
        let wanted = series + f.powf(depth as f32 + 1.0) * e * FRAC_1_PI;
        assert!((*value - wanted).abs().max_element() < 1e-3 * wanted.x, "pixel {i}: {value} for {wanted}");
    }
}

#[test]
fn what_cannot_be_seen_needs_no_view() {
    let scene = floor_and_mirror();
    assert_eq!(views(&scene, &scene.camera, 2).len(), 1);
    assert_eq!(views(&scene, &scene.camera, 0).len(), 0, "depth 0 shows none");
    let away = Camera { target: Vec3::new(6.0, 1.4, 1.8), ..scene.camera };
    assert_eq!(views(&scene, &away, 2).len(), 0, "out of the picture");
    let behind = Camera { eye: Vec3::new(-1.0, 1.0, 0.0), target: Vec3::new(1.0, 1.0, 0.0), ..scene.camera };
    assert_eq!(views(&scene, &behind, 2).len(), 0, "its back does not reflect");
    let mut turned = scene.clone();
    turned.materials[1].double_sided = true;
    assert_eq!(views(&turned, &behind, 2).len(), 1, "now it does");
    assert_eq!(views(&cornell(), &cornell().camera, 2).len(), 0, "no mirrors");
    // In a corner of two mirrors each is seen in the other; the view cannot see itself.
    let mut corner = floor_and_mirror();
    corner.materials[0] = mirror(Vec3::splat(0.9));
    assert_eq!(views(&corner, &corner.camera, 1).len(), 2);
    assert_eq!(views(&corner, &corner.camera, 2).len(), 4);
}

#[test]
fn a_scene_without_mirrors_has_no_mirror_pass_and_the_plan_says_so() {
    let line = |scene: &Scene| {
        let plan = Plan::new(scene, &World::new(scene), 0.04, 1);
        plan.lines.into_iter().find(|l| l.component == Component::Mirror).unwrap()
    };
    let none = line(&cornell());
    assert!(!none.used && none.reason.contains("nothing is polished"), "{none:?}");
    let one = line(&floor_and_mirror());
    assert!(one.used && one.reason.contains("1 flat reflector"), "{one:?}");
    let mut over = floor_and_mirror();
    over.plan.mirror_depth = Some(0);
    assert!(!line(&over).used && line(&over).overridden);
}

#[test]
fn coplanar_triangles_are_one_reflector_and_curved_ones_none() {
    let mut scene = Scene::default();
    let tiles = lumenscope_tests::merged(
        &(0..5)
            .map(|i| rectangle(Vec3::new(i as f32 * 0.37, 0.1, 0.0), Vec3::Z, Vec3::X * 0.37))
            .collect::<Vec<_>>(),
    );
    add(&mut scene, "tiles", tiles, mirror(Vec3::splat(0.9)));
    add(&mut scene, "cube", cuboid(Vec3::splat(-2.0), Vec3::splat(-1.0), false), mirror(Vec3::splat(0.9)));
    let mut bent = rectangle(Vec3::new(5.0, 0.0, 0.0), Vec3::Z, Vec3::X);
    bent.normals[0] = Vec3::new(0.3, 1.0, 0.0).normalize();
    add(&mut scene, "bent", bent, mirror(Vec3::splat(0.9)));
    let found = Reflectors::new(&Geometry::new(&scene));
    assert_eq!((found.list.len(), found.curved), (7, 2));
    assert_eq!(found.list[0].triangles.len(), 10);
    assert!((found.list[0].area - 5.0 * 0.37).abs() < 1e-5);
    assert!((found.list[0].offset - 0.1).abs() < 1e-6 && found.list[0].normal == Vec3::Y);
    let x = Vec3::new(0.3, 2.0, -1.0);
    assert!(found.list[0].mirror_point(x).distance(Vec3::new(0.3, -1.8, -1.0)) < 1e-6);
}
