//! Flat mirrors: against the path tracer, against closed forms, and what they cost.

use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::part::Part,
    measure::significance::{ZTest, z_test},
    mirror::{
        reflectors::Reflectors,
        views::{Eye, MirroredView, mirrored_views},
    },
    reference::{Estimate, radiance::radiance},
    scene::{
        Scene, accel::Ray, camera::Camera, fresnel, geometry::Geometry, material::Material, mesh::Mesh,
        world::World,
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

/// Pixels that show a mirror, and the difference of a picture to the path tracer's.
fn against_paths(scene: Scene) -> (usize, ZTest) {
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
    (mirrored, test)
}

#[test]
fn a_mirror_shows_what_the_path_tracer_sees_in_it() {
    let (mirrored, test) = against_paths(floor_and_mirror());
    assert!(mirrored > 60 && test.passes(), "{test:?}");
}

/// A floor before a corner of two mirrors of gold and copper, a block of two dark halves on it, and a lamp above the
/// corner that shines away from both: what they show lies in the floor's own plane, or is dark.
fn corner() -> Scene {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::ZERO, Vec3::Z * 4.0, Vec3::X * 4.0);
    add(&mut scene, "floor", floor, diffuse("floor", Vec3::new(0.6, 0.5, 0.4), Vec3::ZERO));
    let (x, y, z) = (Vec3::X * 1.2, Vec3::Y * 1.2, Vec3::Z * 1.2);
    add(&mut scene, "left", rectangle(Vec3::ZERO, y, z), mirror(Vec3::new(0.63, 0.56, 0.37)));
    add(&mut scene, "right", rectangle(Vec3::ZERO, x, y), mirror(Vec3::new(0.89, 0.59, 0.5)));
    let lamp = rectangle(Vec3::new(0.95, 1.3, 0.35), Vec3::Y * 0.4, Vec3::new(-0.6, 0.0, 0.6));
    add(&mut scene, "lamp", lamp, diffuse("lamp", Vec3::ZERO, Vec3::new(100.0, 90.0, 70.0)));
    let block = cuboid(Vec3::new(1.3, 0.001, 0.7), Vec3::new(1.6, 0.5, 0.9), false);
    add(&mut scene, "block", block, diffuse("black", Vec3::ZERO, Vec3::ZERO));
    let (eye, target) = (Vec3::new(2.6, 1.2, 2.2), Vec3::new(0.2, 0.25, 0.3));
    scene.camera = Camera { eye, target, vertical_fov: 0.4, ..Camera::default() };
    scene
}

#[test]
fn in_a_corner_of_two_mirrors_each_shows_the_other_as_the_path_tracer_does() {
    let of = |depth| {
        let mut scene = corner();
        scene.plan.mirror_depth = Some(depth);
        against_paths(scene)
    };
    let (mirrored, test) = of(2);
    assert!(mirrored > 100 && test.passes(), "{test:?}");
    let (scene, world) = (corner(), World::new(&corner()));
    let met = |ray: &Ray| {
        let hit = world.accel.trace(ray)?;
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, ray.direction);
        world.geometry.brdf(&surface).specular.map(|_| surface)
    };
    let shows_both = |i: &u32| {
        let pixel = UVec2::new(i % SIZE.x, i / SIZE.x);
        let ray = Ray::new(scene.camera.eye, pixel_direction(&scene.camera, SIZE, pixel, Vec2::splat(0.5)));
        let second = met(&ray).and_then(|first| met(&first.mirrored(ray.direction)));
        second.is_some() && radiance(&world, &ray, 16, 1).mean.x > 0.0
    };
    let both = (0..SIZE.x * SIZE.y).filter(shows_both).count();
    assert!(both > 100, "{both} pixels show something by both mirrors");
    // At a right angle no ray meets more than two; one is too few, and the test tells.
    assert!(!of(1).1.passes());
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

/// A net of `n` × `n` cells over the square from −1 to 1, at the heights and with the normals of a surface.
fn net(n: u32, surface: impl Fn(Vec2) -> (f32, Vec3)) -> Mesh {
    let mut mesh = Mesh::default();
    for (y, x) in (0..=n).flat_map(|y| (0..=n).map(move |x| (y, x))) {
        let at = 2.0 * Vec2::new(x as f32, y as f32) / n as f32 - 1.0;
        let (height, normal) = surface(at);
        mesh.positions.push(Vec3::new(at.x, height, at.y));
        mesh.normals.push(normal);
        mesh.uvs.push(at);
    }
    let corner = |x, y| y * (n + 1) + x;
    for (y, x) in (0..n).flat_map(|y| (0..n).map(move |x| (y, x))) {
        let [a, b, c, d] = [corner(x, y), corner(x, y + 1), corner(x + 1, y + 1), corner(x + 1, y)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

fn reflectors_of(mesh: Mesh) -> (usize, Reflectors) {
    let mut scene = Scene::default();
    let triangles = mesh.triangles.len();
    add(&mut scene, "net", mesh, mirror(Vec3::splat(0.9)));
    (triangles, Reflectors::new(&Geometry::new(&scene)))
}

#[test]
fn a_bowl_of_facets_as_good_as_flat_is_curved() {
    // A cap of a ball of radius 2: its facets turn by 0.01 from one to the next, their corners by half of it.
    for n in [100, 300] {
        let (triangles, found) = reflectors_of(net(n, |at| {
            let height = (4.0 - at.length_squared()).sqrt();
            (height, Vec3::new(at.x, height, at.y) / 2.0)
        }));
        assert_eq!((found.list.len(), found.curved), (0, triangles), "{n} cells across");
    }
}

#[test]
fn a_plate_keeps_its_flat_middle_where_its_rim_is_rounded() {
    // Beyond half of the way out it turns down, ever more; the edge's corners have the middle's normal.
    let rim = |at: Vec2| (at.x.abs().max(at.y.abs()) - 0.5).max(0.0);
    let (triangles, found) = reflectors_of(net(40, |at| {
        let out = if at.x.abs() > at.y.abs() { Vec3::X * at.x.signum() } else { Vec3::Z * at.y.signum() };
        let slope = 2.0 * rim(at);
        (-rim(at).powi(2), (Vec3::Y + out * slope).normalize())
    }));
    assert_eq!(found.list.len(), 1, "one flat middle");
    assert_eq!(found.list[0].triangles.len(), triangles / 4);
    assert!((found.list[0].area - 1.0).abs() < 1e-5 && found.curved == triangles * 3 / 4);
}

#[test]
fn a_flat_plate_with_coarse_normals_is_one_mirror() {
    // Normals of eight bits: off by up to 1/127, all alike.
    let normal = Vec3::new(1.0, 126.0, 0.0).normalize();
    let (triangles, found) = reflectors_of(net(30, |_| (0.0, normal)));
    assert_eq!((found.list.len(), found.curved), (1, 0));
    assert_eq!(found.list[0].triangles.len(), triangles);
}

#[test]
fn from_behind_a_double_sided_mirror_shows_what_the_path_tracer_sees_in_it() {
    let mut scene = floor_and_mirror();
    scene.materials[1].double_sided = true;
    // The same room again behind the mirror, in other colours; no light leaks past the mirror's edge into it.
    let floor = rectangle(Vec3::new(-4.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    add(&mut scene, "back floor", floor, diffuse("back floor", Vec3::new(0.3, 0.6, 0.5), Vec3::ZERO));
    let lamp = rectangle(Vec3::new(-0.1, 1.2, -0.4), Vec3::Z * 0.8, Vec3::Y * 0.6);
    add(&mut scene, "back lamp", lamp, diffuse("back lamp", Vec3::ZERO, Vec3::new(60.0, 80.0, 100.0)));
    scene.camera.eye.x = -scene.camera.eye.x;
    let (mirrored, test) = against_paths(scene);
    assert!(mirrored > 60 && test.passes(), "{test:?}");
}
