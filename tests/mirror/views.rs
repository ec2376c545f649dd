//! What the views of mirrors and glossy surfaces show.

use super::planar::floor_and_mirror;
use glam::Vec3;
use lumenscope_core::{
    glossy::{
        inspect::KernelView,
        inspect_point::{KERNEL_SIZE, KernelPoint},
    },
    math::{
        frame::{mirrored, uniform_direction},
        random::Rng,
    },
    mirror::{MirrorSettings, inspect, reflectors::Reflectors},
    scene::{
        Scene, accel::Ray, brdf::Specular, fresnel, geometry::Geometry, material::Material, mesh::Mesh,
        world::World,
    },
};
use lumenscope_tests::{add, box_room, rectangle};

const GOLD: Vec3 = Vec3::new(0.63, 0.56, 0.37);

#[test]
fn gold_is_golden_at_the_middle_of_its_map_and_white_at_its_rim() {
    let gold = Specular { metal: GOLD, metallic: 1.0, dielectric: 0.04, ..Specular::default() };
    let map = inspect::map(&gold);
    let half = map.width / 2;
    assert!((map.at(half, half) - GOLD).abs().max_element() < 1e-4, "{}", map.at(half, half));
    assert!((map.at(0, half) - Vec3::ONE).abs().max_element() < 1e-3, "grazing reflects all");
    assert_eq!(map.at(0, 0), Vec3::ZERO, "outside of the disc");
    // Fig. 6.23's graph along the middle: blue rises latest and most steeply, red least.
    let [middle, late] = [0.5f32, 0.95].map(|r| fresnel::reflectance_rgb(GOLD, (1.0 - r * r).sqrt()));
    assert!((middle - GOLD).abs().max_element() < 0.06, "flat over the middle: {middle}");
    let rise = late - middle;
    assert!(rise.z > rise.y && rise.y > rise.x, "{rise}");
    // Schlick's approximation is near for a coat. For a metal it is not: a real index has an angle at which
    // one polarisation is not reflected, where the fit falls below the reflectance at normal incidence.
    let worst = |f0: f32| {
        let off = |i: i32| {
            let c = i as f32 / 100.0;
            (fresnel::schlick(f0, c) - fresnel::reflectance(f0, c)).abs()
        };
        (0..=100).map(off).fold(0.0, f32::max)
    };
    println!(
        "Schlick's approximation is off by at most {:.3} for 0.04, {:.3} for 0.56",
        worst(0.04),
        worst(0.56)
    );
    assert!(worst(0.04) < 0.05 && worst(0.56) > 0.2);
}

#[test]
fn the_reflectors_view_names_those_that_need_a_view() {
    let scene = floor_and_mirror();
    let geometry = Geometry::new(&scene);
    let shown = inspect::reflectors(&geometry, MirrorSettings::default(), &scene.camera);
    assert!(shown.notes[0].starts_with("1 flat reflectors") && shown.notes[0].contains("1 mirrored views"));
    // Four edges and the normal: the diagonal belongs to two triangles.
    assert_eq!((shown.lines.len(), shown.labels.len()), (5, 1));
    let shown = inspect::reflectance(&geometry).unwrap();
    assert_eq!((shown.images.len(), shown.curves.len()), (1, 3));
    assert!(inspect::reflectance(&Geometry::new(&lumenscope_tests::cornell())).is_none());
}

fn glossy_floor(roughness: f32) -> Scene {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    add(&mut scene, "floor", floor, Material { roughness, ..Material::default() });
    let wall = rectangle(Vec3::new(-2.0, 0.0, -2.0), Vec3::X * 4.0, Vec3::Y * 3.0);
    add(&mut scene, "wall", wall, Material::default());
    scene
}

fn near(geometry: &Geometry, eye: Vec3, place: Option<Vec3>) -> Option<KernelPoint> {
    KernelPoint::near(geometry, &Reflectors::new(geometry), eye, place)
}

#[test]
fn wider_lobes_need_fewer_samples() {
    let eye = Vec3::new(0.0, 1.0, 1.0);
    let mut bands = Vec::new();
    for roughness in [0.1, 0.2, 0.4] {
        let geometry = Geometry::new(&glossy_floor(roughness));
        let point = near(&geometry, eye, Some(Vec3::new(0.1, 0.5, 0.0))).unwrap();
        assert!(point.position.distance(Vec3::new(0.1, 0.0, 0.0)) < 1e-5 && point.normal == Vec3::Y);
        let support = point.support();
        let image = point.image(support);
        // The same to the left and right of the plane of incidence.
        for y in 1..KERNEL_SIZE {
            for x in 0..KERNEL_SIZE {
                let (a, b) = (image.at(x, y).x, image.at(x, KERNEL_SIZE - y).x);
                // Rounding of a dozen operations, and of slopes up to a few.
                assert!((a - b).abs() < 1e-4, "{x}, {y}: {a} {b}");
            }
        }
        let [(curve, band), (_, across)] = KernelPoint::spectrum(&image, support);
        assert!((curve[0].y - 1.0).abs() < 1e-5 && curve.iter().all(|p| p.y <= 1.0001));
        bands.push(band.max(across));
    }
    println!("cycles a radian: {bands:?}");
    assert!(bands.windows(2).all(|w| w[1] < w[0]), "{bands:?}");
}

#[test]
fn the_kernel_view_lies_on_what_the_lobe_meets() {
    let world = World::new(&glossy_floor(0.2));
    let eye = Vec3::new(0.0, 1.0, 1.0);
    let point = near(&world.geometry, eye, None).unwrap();
    let shown = KernelView::new(&world, point, eye).scene;
    assert_eq!((shown.meshes.len(), shown.images.len(), shown.curves.len()), (2, 1, 3));
    let footprint = &shown.meshes[0];
    assert!(!footprint.triangles.is_empty());
    for t in footprint.triangles.iter().flatten() {
        let p = footprint.positions[*t as usize];
        assert!((p.z + 2.0).abs() < 0.02, "{p} is not on the wall");
    }
    let dull = World::new(&lumenscope_tests::cornell());
    assert!(near(&dull.geometry, Vec3::ONE, None).is_none());
    let glossy = |world: &World, eye: Vec3, towards: Vec3| {
        let hit = world.accel.trace(&Ray::new(eye, towards)).unwrap();
        KernelPoint::on(&world.geometry, &world.geometry.surface(hit.triangle, hit.barycentric, towards), eye)
    };
    assert_eq!(glossy(&world, point.position + point.wo, -point.wo).unwrap().lobe, point.lobe);
    assert!(glossy(&world, eye, Vec3::NEG_Z).is_none(), "the wall is dull");
    assert!(glossy(&world, -eye, Vec3::Y).is_none(), "from below the floor is dark");
}

/// A ball of eight facets and radius 0.2 with the normals of the sphere.
fn facets() -> Mesh {
    let corners = [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z, Vec3::Y, Vec3::NEG_Y];
    let half = |pole: u32, turn: fn([u32; 3]) -> [u32; 3]| (0..4).map(move |i| turn([i, pole, (i + 1) % 4]));
    Mesh {
        positions: corners.map(|c| 0.2 * c).into(),
        normals: corners.into(),
        uvs: vec![Default::default(); 6],
        triangles: half(4, |t| t).chain(half(5, |[a, b, c]| [c, b, a])).collect(),
        ..Mesh::default()
    }
}

#[test]
fn no_kernel_meets_its_own_facet() {
    let mut scene = box_room(0.5, 0.0);
    let metal = Material { roughness: 0.3, metallic: 1.0, ..Material::default() };
    add(&mut scene, "ball", facets(), metal);
    let world = World::new(&scene);
    let (low, high) = world.geometry.bounds();
    let off_walls = |p: Vec3| (p - low).min(high - p).min_element();
    let (mut above, mut below) = (0, 0);
    for i in 0..400 {
        let mut rng = Rng::new(5, i);
        let eye = 0.4 * uniform_direction(rng.next_vec2());
        let towards = (0.2 * uniform_direction(rng.next_vec2()) - eye).normalize();
        let Some(hit) = world.accel.trace(&Ray::new(eye, towards)) else { panic!("the room is closed") };
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, towards);
        let Some(point) = KernelPoint::on(&world.geometry, &surface, eye) else { continue };
        let view = KernelView::new(&world, point, eye);
        // Nothing before the facet's plane is the ball's: all of it is on the room's walls.
        let footprint = &view.scene.meshes[0];
        for t in footprint.triangles.iter().flatten() {
            let p = footprint.positions[*t as usize];
            // Drawn 0.2 % of up to the room's diagonal nearer.
            assert!(off_walls(p) < 4e-3, "{p} is not on a wall");
        }
        let mirrored = mirrored(point.wo, point.normal);
        if mirrored.dot(surface.geometric_normal) > 0.0 {
            above += 1;
            let end = point.position + view.numbers.reach_m * mirrored;
            assert!(off_walls(end).abs() < 1e-4, "{end} is not on a wall");
        } else {
            below += 1;
            assert_eq!(view.numbers.reach_m, (high - low).length());
        }
    }
    println!("{above} mirrored rays leave the ball, {below} go below their facet");
    assert!(above > 50 && below > 5);
}

#[test]
fn a_lobe_is_shown_over_its_peak_at_grazing_angles_too() {
    let world = World::new(&glossy_floor(0.45));
    let (low, high) = world.geometry.bounds();
    let far = (high - low).length();
    for height in [1.0, 0.3, 0.1] {
        let eye = Vec3::new(0.0, height, 1.5);
        let point = near(&world.geometry, eye, Some(Vec3::ZERO)).unwrap();
        let shown = KernelView::new(&world, point, eye).scene;
        let largest = |values: &mut dyn Iterator<Item = f32>| values.fold(0.0, f32::max);
        for mesh in &shown.meshes {
            let peak = largest(&mut mesh.values.iter().map(|v| v.x));
            assert!((peak - 1.0).abs() < 1e-6, "seen from {eye} its peak is {peak}");
        }
        let long = largest(&mut shown.meshes[1].positions.iter().map(|p| p.distance(point.position)));
        assert!((long / (0.08 * far) - 1.0).abs() < 1e-5, "{long} m");
        let curve = shown.curves.iter().find(|c| c.radial).unwrap();
        let peak = largest(&mut curve.points.iter().map(|p| p.length()));
        assert!((peak - 1.0).abs() < 1e-5, "{peak}");
    }
}
