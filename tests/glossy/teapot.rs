//! The glossy layer against the path tracer, on the scene that ships.

use glam::Vec3;
use lumenscope_core::{
    glossy::GlossyMethod,
    math::{image::LinearImage, progress::Progress},
    measure::image::rel_mse,
    reference::picture::ReferencePicture,
    scene::{brdf::LobeShape, import, world::World},
    superposition::{
        PassSettings,
        composite::DirectQuality,
        layers::{Layer, Layers},
        plan::Plan,
        render,
    },
    transport::{LightTransportSolution, live::LiveTransport},
};
use lumenscope_tests::{add, cuboid, diffuse};
use std::{path::Path, sync::Arc};

const SIZE: [u32; 2] = [96, 54];

fn teapot(shape: LobeShape, roughness: f32) -> LightTransportSolution {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/glossy/teapot.ron");
    let mut scene = import::load(&path).unwrap();
    scene
        .materials
        .iter_mut()
        .filter(|m| m.is_specular())
        .for_each(|m| (m.roughness, m.lobe_shape) = (roughness, shape));
    if shape == LobeShape::Phong {
        // Round lobes reach past the wall to all sides, which the mirror image does not show: no darkness there.
        let room = cuboid(Vec3::new(-2.0, -0.5, -0.6), Vec3::splat(2.0), true);
        add(&mut scene, "room", room, diffuse("room", Vec3::splat(0.3), Vec3::splat(10.0)));
    }
    let plan = Plan::new(&scene, &World::new(&scene), 0.1, 1);
    let live = LiveTransport::solve(Arc::new(scene), plan.solve, &Progress::silent(), &mut |_| {}).unwrap();
    live.current().clone()
}

fn by(solution: &LightTransportSolution, method: GlossyMethod) -> Layers {
    let mut scene = (*solution.scene).clone();
    scene.plan.glossy = Some(method);
    let solution = LightTransportSolution { scene: Arc::new(scene), ..solution.clone() };
    let settings = PassSettings { direct: DirectQuality::PerPixel(16), ..PassSettings::default() };
    render(&solution, &solution.scene.camera, SIZE[0], SIZE[1], &settings).1
}

#[test]
fn a_kernel_for_every_pixel_is_at_least_twice_as_near_as_one_for_all() {
    for (shape, roughness) in
        [(LobeShape::Ggx, 0.2), (LobeShape::Ggx, 0.4), (LobeShape::Phong, 0.2), (LobeShape::Phong, 0.4)]
    {
        let solution = teapot(shape, roughness);
        let mut reference =
            ReferencePicture::new(solution.world.clone(), solution.scene.camera, SIZE[0], SIZE[1], 3);
        reference.add_samples(128, &Progress::silent()).unwrap();
        let [.., wanted] = reference.layers();
        let [variant, invariant, sharp] =
            [GlossyMethod::Variant, GlossyMethod::Invariant, GlossyMethod::Sharp]
                .map(|m| by(&solution, m).get(Layer::Glossy).clone());
        let [v, i, s] = [&variant, &invariant, &sharp].map(|p: &LinearImage| rel_mse(p, &wanted).unwrap());
        println!("{shape:?}, roughness {roughness}: variant {v:.4}, invariant {i:.4}, sharp {s:.4}");
        assert!(v < 0.5 * i && v < 0.6 * s, "{shape:?}, roughness {roughness}: {v} {i} {s}");
    }
}

#[test]
fn the_layers_of_a_glossy_scene_sum_to_its_picture() {
    let layers = by(&teapot(LobeShape::Ggx, 0.2), GlossyMethod::Variant);
    let picture = layers.total();
    for (pixel, value) in picture.pixels.iter().enumerate() {
        let sum: Vec3 = Layer::ALL.iter().map(|l| layers.get(*l).pixels[pixel]).sum();
        assert!((sum - *value).abs().max_element() <= 1e-5 * value.max_element().max(1e-3));
        assert!(value.is_finite() && value.min_element() >= 0.0);
    }
    assert!(layers.get(Layer::Glossy).mean().x > 0.1);
}
