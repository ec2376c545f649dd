//! Pictures whose mirrors are shown from images-with-depth.

use crate::planar::floor_and_mirror;
use glam::{UVec2, Vec3};
use lumenscope_core::{
    math::progress::Progress,
    mirror::{MirrorMethod, images::MirrorImages},
    scene::{Scene, world::World},
    superposition::{PassSettings, composite::DirectQuality, layers::Layer, plan::Plan, render},
    transport::{LightTransportSolution, live::LiveTransport},
};
use lumenscope_tests::solved;
use std::sync::Arc;

const SIZE: UVec2 = UVec2::new(120, 90);

/// A solution whose mirrors are shown from images, and the same from the geometry.
fn by_images(scene: Scene) -> (LightTransportSolution, LightTransportSolution) {
    let exact = solved(scene, 0.3);
    let mut scene = (*exact.scene).clone();
    scene.plan.mirrors = Some(MirrorMethod::Images);
    let images = MirrorImages::automatic(&exact.world, &Progress::silent()).unwrap();
    let shown = LightTransportSolution {
        scene: Arc::new(scene),
        mirror_images: Some(Arc::new(images)),
        ..exact.clone()
    };
    (shown, exact)
}

fn mirror_layer(solution: &LightTransportSolution) -> Vec<Vec3> {
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let layers = render(solution, &solution.scene.camera, SIZE.x, SIZE.y, &settings).1;
    layers.get(Layer::Mirror).pixels.clone()
}

#[test]
fn a_picture_from_images_is_that_from_the_geometry_where_they_have_seen_the_same() {
    let (shown, exact) = by_images(floor_and_mirror());
    let (a, b) = (mirror_layer(&shown), mirror_layer(&exact));
    let mirrored: Vec<usize> = (0..b.len()).filter(|&i| b[i] != Vec3::ZERO).collect();
    // To rounding: the light is read where the pixel's ray meets the point's triangle.
    let is_same = |&&i: &&usize| (a[i] - b[i]).abs().max_element() < 1e-3 * b[i].max_element();
    let same = mirrored.iter().filter(is_same).count() as f32 / mirrored.len() as f32;
    println!("{:.2} % of {} pixels are the same", 100.0 * same, mirrored.len());
    assert!(mirrored.len() > 1_000 && same > 0.9, "{same}");
    assert!(same < 1.0, "it is no other method");
}

#[test]
fn images_outlive_a_lamp_that_changes_and_follow_what_moves() {
    let mut scene = floor_and_mirror();
    scene.plan.mirrors = Some(MirrorMethod::Images);
    let [lamp, block] = ["lamp", "block"].map(|n| scene.objects.iter().position(|o| o.name == n).unwrap());
    scene.objects[lamp].movable = true;
    scene.objects[block].movable = true;
    scene.plan.element_spacing_m = Some(0.3);
    scene.plan.volume = Some(false);
    let settings = Plan::new(&scene, &World::new(&scene), 0.1, 1).solve;
    let silent = Progress::silent();
    let mut live = LiveTransport::solve(Arc::new(scene.clone()), settings, &silent, &mut |_| {}).unwrap();
    let first = live.current().clone();
    let taken = first.mirror_images.clone().unwrap();
    scene.objects[lamp].dimmer = 0.5;
    let dimmed = live.follow(Arc::new(scene.clone())).clone();
    assert!(Arc::ptr_eq(&taken, dimmed.mirror_images.as_ref().unwrap()));
    let (bright, dim) = (mirror_layer(&first), mirror_layer(&dimmed));
    let ratio = dim.iter().sum::<Vec3>() / bright.iter().sum::<Vec3>();
    // Shadow rays while something changes are coarser: most of the light is not in a penumbra.
    assert!((ratio - 0.5).abs().max_element() < 0.02, "half of the light is {ratio} in the mirror");
    // Lamp and block move: the mirror shows what images taken of nothing would, while they move and at rest.
    scene.objects[block].world_from_object.translation.z += 0.4;
    scene.objects[lamp].world_from_object.translation += glam::Vec3A::new(0.3, 0.2, -0.3);
    let moved = live.follow(Arc::new(scene.clone())).clone();
    let as_taken_anew = |solution: &LightTransportSolution| {
        let images = solution.mirror_images.as_ref().unwrap();
        assert!(images.hold(&solution.world.geometry) && 2 * images.rays < images.points());
        let fresh = MirrorImages::automatic(&solution.world, &silent).unwrap();
        let fresh = LightTransportSolution { mirror_images: Some(Arc::new(fresh)), ..solution.clone() };
        mirror_layer(solution) == mirror_layer(&fresh)
    };
    assert!(as_taken_anew(&moved), "while they move");
    let mut plain = (*moved.scene).clone();
    plain.plan.mirrors = None;
    let geometry = LightTransportSolution { scene: Arc::new(plain), ..moved.clone() };
    assert!(mirror_layer(&moved) != mirror_layer(&geometry), "it is no other method");
    while live.refine(&silent).unwrap().is_some() {}
    assert!(as_taken_anew(live.current()), "at rest");
}
