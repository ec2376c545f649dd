//! Images-with-depth after something has moved: those taken of nothing, for a few rays.

use crate::planar::floor_and_mirror;
use glam::{Affine3A, Quat, Vec3};
use lumenscope_core::{
    math::{progress::Progress, random::Rng},
    mirror::{
        MirrorMethod,
        images::{
            ImageWithDepth, MirrorImages, NOTHING, SampleSettings,
            pass::{diffuse, in_use},
        },
    },
    scene::{Scene, Target, import::load, material::Material, world::World},
    superposition::{PassSettings, composite::DirectQuality, pass::Shading, plan::Plan},
    transport::{LightTransportSolution, live::LiveTransport},
};
use lumenscope_tests::{add, cuboid, rectangle, solved};
use std::{path::Path, sync::Arc};

const SETTINGS: SampleSettings = SampleSettings { element_m: 2.0, poses: 5, radius_m: 1.5, resolution: 64 };

/// The floor and its mirror within walls, where lamp and block may be moved.
fn room() -> Scene {
    let mut scene = floor_and_mirror();
    let walls = cuboid(Vec3::new(-0.5, -0.5, -3.0), Vec3::new(6.0, 4.0, 3.0), true);
    add(&mut scene, "walls", walls, Material::default());
    for object in scene.objects.iter_mut().filter(|o| ["lamp", "block"].contains(&&*o.name)) {
        object.movable = true;
    }
    scene
}

fn object(scene: &Scene, name: &str) -> usize {
    scene.objects.iter().position(|o| o.name == name).unwrap()
}

fn anew(world: &World) -> MirrorImages {
    MirrorImages::new(world, &SETTINGS, &Progress::silent()).unwrap()
}

fn followed(images: &MirrorImages, world: &World) -> MirrorImages {
    images.followed(world, 0, &Progress::silent()).unwrap().unwrap()
}

fn images(of: &MirrorImages) -> impl Iterator<Item = &Arc<ImageWithDepth>> {
    of.sets.iter().flat_map(|set| set.elements.iter().flatten())
}

fn shared(a: &MirrorImages, b: &MirrorImages) -> usize {
    images(a).zip(images(b)).filter(|(a, b)| Arc::ptr_eq(a, b)).count()
}

#[test]
fn images_that_follow_what_moves_are_those_taken_of_nothing() {
    let start = room();
    let first = World::new(&start);
    let taken = anew(&first);
    assert!(taken.rays == taken.points() && taken.points() > 50_000);
    let (lamp, block) = (object(&start, "lamp"), object(&start, "block"));
    let (mut scene, mut world, mut before) = (start.clone(), first.clone(), taken.clone());
    let (mut rays, mut kept, mut same) = (0, 0, [0, 0]);
    let places = 24;
    for step in 0..places {
        let mut rng = Rng::new(7, step);
        let mut unit = || rng.next_f32();
        for object in [lamp, block].into_iter().take(1 + step as usize % 2) {
            let turn = Quat::from_euler(glam::EulerRot::XYZ, 6.0 * unit(), 6.0 * unit(), 6.0 * unit());
            // Through the mirror, into the floor and out of the walls, too.
            let at = Vec3::new(-1.0 + 8.0 * unit(), -1.0 + 5.0 * unit(), -3.5 + 7.0 * unit());
            let middle = if object == lamp { Vec3::new(0.1, 1.5, 0.0) } else { Vec3::new(1.2, 0.35, 0.05) };
            let placed = Affine3A::from_rotation_translation(turn, at) * Affine3A::from_translation(-middle);
            scene.place(Target::Object(object), placed);
        }
        world.follow(&scene);
        assert!(!before.hold(&world.geometry));
        let fresh = anew(&world);
        // From where they were taken, and from where they were last.
        for from in [&taken, &before] {
            let now = followed(from, &world);
            assert!(now.sets == fresh.sets, "step {step}: other points than those taken of nothing");
            assert!(now.hold(&world.geometry) && now.rays < now.points());
            rays += now.rays;
            kept += shared(from, &now);
        }
        // A scene that never stood otherwise has its corners rounded otherwise.
        let built = anew(&World::new(&scene));
        for (a, b) in images(&fresh).zip(images(&built)) {
            for i in 0..a.triangle.len() {
                let is_same = a.triangle[i] == b.triangle[i];
                same[usize::from(is_same)] += 1;
                assert!(!is_same || (a.scale[i] - b.scale[i]).abs() < 1e-4 * b.scale[i], "{i}");
            }
        }
        before = fresh;
    }
    let share = rays as f64 / (2 * places * taken.points()) as f64;
    println!(
        "{:.1} % of the rays traced anew; {} of {} images shared; {} of {} points elsewhere in a scene built anew",
        100.0 * share,
        kept,
        2 * places * images(&taken).count() as u64,
        same[0],
        same[0] + same[1]
    );
    // Both are large in this room, and go through half of it at a time.
    assert!(rays > 0 && share < 0.25 && kept > 0, "{share} {kept}");
    // Only rays along an edge may pass it on the other side.
    assert!(same[0] * 1000 < same[1], "{same:?}");
    // Back where they were, all is as it was.
    let mut back = world.clone();
    back.follow(&start);
    assert!(taken.hold(&back.geometry));
}

#[test]
fn a_ray_is_traced_anew_only_if_it_met_what_moved_or_crosses_its_box() {
    let mut scene = room();
    let first = World::new(&scene);
    let taken = anew(&first);
    let block = object(&scene, "block");
    // An upright box: it fills its bounds, so what crosses these meets it.
    scene.objects[block].world_from_object = Affine3A::from_translation(Vec3::new(1.0, 0.3, -1.2));
    let mut world = first.clone();
    world.follow(&scene);
    let now = followed(&taken, &world);
    let of_block = |images: &MirrorImages| -> u64 {
        let range = &first.geometry.object_triangles[block];
        self::images(images).flat_map(|i| &i.triangle).filter(|t| range.contains(t)).count() as u64
    };
    let both = self::images(&taken).zip(self::images(&now)).map(|(a, b)| {
        let range = &first.geometry.object_triangles[block];
        a.triangle.iter().zip(&b.triangle).filter(|(a, b)| range.contains(a) && range.contains(b)).count()
            as u64
    });
    let met = of_block(&taken) + of_block(&now) - both.sum::<u64>();
    println!("{} rays traced anew, {met} met the block before or after", now.rays);
    // A hair more: boxes are grown against rounding, and what they hide at their edges is asked too.
    assert!(now.rays >= met && now.rays * 100 < met * 102, "{} of {met}", now.rays);
}

#[test]
fn colours_read_anew_after_a_lamp_has_moved_are_those_of_images_taken_of_nothing() {
    let mut scene = room();
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let before = solved(scene.clone(), 0.5);
    let mut taken = anew(&before.world);
    taken.recolour(&before.world, &diffuse(&Shading::new(&before, &settings)));
    let lamp = object(&scene, "lamp");
    scene.place(Target::Object(lamp), Affine3A::from_translation(Vec3::new(0.6, 0.3, -0.4)));
    let mut world = (*before.world).clone();
    world.follow(&scene);
    let lit = LightTransportSolution { world: Arc::new(world), ..solved(scene, 0.5) };
    let shading = Shading::new(&lit, &settings);
    let colours = diffuse(&shading);
    let (mut now, mut fresh) = (followed(&taken, &lit.world), anew(&lit.world));
    assert!(now.sets != fresh.sets, "the colours are those of before");
    now.recolour(&lit.world, &colours);
    fresh.recolour(&lit.world, &colours);
    assert!(now.sets == fresh.sets);
}

#[test]
fn what_is_nothing_stays_far_away_when_the_scene_grows() {
    let mut scene = floor_and_mirror();
    let lamp = object(&scene, "lamp");
    scene.objects[lamp].movable = true;
    let mut world = World::new(&scene);
    let taken = anew(&world);
    assert!(images(&taken).any(|i| i.triangle.contains(&NOTHING)), "there are no walls");
    scene.place(Target::Object(lamp), Affine3A::from_translation(Vec3::new(9.0, 5.0, 0.0)));
    world.follow(&scene);
    assert!(followed(&taken, &world).sets == anew(&world).sets);
}

#[test]
fn a_reflector_that_moves_is_taken_anew_alone_or_later_if_it_is_large() {
    let mut scene = room();
    let polished = Material { metallic: 1.0, roughness: 0.0, ..Material::default() };
    let tray = rectangle(Vec3::new(2.0, 0.5, -1.0), Vec3::Z * 0.4, Vec3::X * 0.4);
    let tray = add(&mut scene, "tray", tray, polished);
    scene.objects[tray].movable = true;
    let mut world = World::new(&scene);
    let taken = Arc::new(anew(&world));
    assert_eq!(taken.sets.len(), 2);
    scene.place(Target::Object(tray), Affine3A::from_translation(Vec3::new(0.5, 0.2, 0.3)));
    world.follow(&scene);
    let silent = Progress::silent();
    assert!(taken.followed(&world, 100, &silent).unwrap().is_none(), "more rays than there may be");
    let now = taken.followed(&world, u64::MAX, &silent).unwrap().unwrap();
    assert!(now.sets == anew(&world).sets);
    assert!(now.rays > taken.sets[1].points() && now.rays < taken.points());
    // At once too, since it is small.
    assert!(taken.moved(&world).hold(&world.geometry));
    let fine = SampleSettings { resolution: 512, poses: 3, ..SETTINGS };
    let many = Arc::new(MirrorImages::new(&World::new(&scene), &fine, &silent).unwrap());
    scene.place(Target::Object(tray), Affine3A::from_translation(Vec3::new(0.9, 0.1, 0.3)));
    world.follow(&scene);
    let waiting = many.moved(&world);
    assert!(Arc::ptr_eq(&waiting, &many) && !waiting.hold(&world.geometry));
}

#[test]
fn lamps_that_move_drop_no_image_of_the_house() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/house/house.ron");
    let mut scene = load(&file).unwrap();
    scene.plan.mirrors = Some(MirrorMethod::Images);
    scene.plan.element_spacing_m = Some(0.5);
    scene.plan.gather_rays = Some(16);
    scene.plan.volume = Some(false);
    let silent = Progress::silent();
    let settings = Plan::new(&scene, &World::new(&scene), 0.1, 1).solve;
    let mut live = LiveTransport::solve(Arc::new(scene.clone()), settings, &silent, &mut |_| {}).unwrap();
    let taken = live.current().mirror_images.clone().unwrap();
    for (name, by) in [
        ("Torchiere", Vec3::new(-0.4, 0.0, 0.2)),
        ("Piano lamp", Vec3::new(0.15, 0.0, 0.05)),
        ("Table lamp", Vec3::new(0.1, 0.0, -0.1)),
    ] {
        let lamp = object(&scene, name);
        assert!(scene.emits(Target::Object(lamp)), "{name} is a lamp with a body");
        let placed = Affine3A::from_translation(by) * scene.objects[lamp].world_from_object;
        scene.place(Target::Object(lamp), placed);
        let light = live.follow(Arc::new(scene.clone())).clone();
        let (now, _) = in_use(&light).expect("mirrors are shown from the geometry");
        let (rays, points, images) = (now.rays, now.points(), images(now).count());
        let kept = shared(&taken, now);
        println!(
            "{name}: {rays} of {points} rays, {:.2} %; {kept} of {images} images as they were",
            100.0 * rays as f64 / points as f64
        );
        assert!(rays > 0 && rays * 20 < points && kept > 0, "{rays} of {points}, {kept} images");
    }
    // All three have moved: the same as taken of nothing, while they move and at rest.
    let moving = live.current().clone();
    let fresh = MirrorImages::automatic(&moving.world, &silent).unwrap();
    assert!(in_use(&moving).unwrap().0.sets == fresh.sets);
    while live.refine(&silent).unwrap().is_some() {}
    let rest = live.current().clone();
    let (images, fresh) = (in_use(&rest).unwrap().0, MirrorImages::automatic(&rest.world, &silent).unwrap());
    assert!(images.sets == fresh.sets && images.rays * 20 < images.points());
}
