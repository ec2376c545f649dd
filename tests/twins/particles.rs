//! Glossy light as particles.

use super::*;
use crate::mirrored::mirrored;
use lumenscope_core::{
    glossy::{GlossyMethod, particles::light::ParticleLight},
    math::progress::Progress,
    scene::{brdf::LobeShape, world::World},
    superposition::{PassSettings, accumulator::Accumulator, render},
};

/// The mirrored box, its glossy things wider, under a panel that shines; the layer `glossy` by particles.
fn by_particles(count: u32, shape: LobeShape) -> LightTransportSolution {
    let solution = mirrored();
    let mut scene = (*solution.scene).clone();
    scene.plan.glossy = Some(GlossyMethod::Particles);
    for material in &mut scene.materials {
        if material.is_glossy() {
            (material.roughness, material.lobe_shape) = (0.35, shape);
        }
        if material.name == "panel" {
            material.emission = Vec3::new(40.0, 35.0, 30.0);
        }
    }
    let world = Arc::new(World::new(&scene));
    let light = ParticleLight::new(&world, count, 1, &Progress::silent()).unwrap();
    LightTransportSolution { scene: Arc::new(scene), world, particles: Some(Arc::new(light)), ..solution }
}

fn camera() -> Camera {
    Camera { eye: Vec3::new(0.617, 1.311, 0.8), target: Vec3::new(-0.8, 0.4, -0.5), ..Camera::default() }
}

#[test]
fn particles_and_straight_light_are_the_specifications() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = by_particles(30_000, LobeShape::Ggx);
    let phong = by_particles(30_000, LobeShape::Phong);
    let elements = DirectQuality::Elements;
    for (solution, direct) in
        [(&phong, elements), (&solution, elements), (&solution, DirectQuality::PerPixel(8))]
    {
        gpu.upload(solution);
        gpu.frame(&frame_settings(camera(), direct));
        let settings = PassSettings { direct, ..PassSettings::default() };
        let (buffer, layers) = render(solution, &camera(), SIZE[0], SIZE[1], &settings);
        let which = [Layer::Mirror, Layer::Glossy];
        compare_layers("particles", &which, (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
    }
    // The running mean of jittered frames.
    let mut mean = Accumulator::new();
    let direct = DirectQuality::Elements;
    for frame_index in 0..3 {
        gpu.frame(&FrameSettings { frame_index, accumulate: true, ..frame_settings(camera(), direct) });
        let settings = PassSettings { direct, frame: frame_index, jitter: true, ..PassSettings::default() };
        mean.add(&render(&solution, &camera(), SIZE[0], SIZE[1], &settings).1);
    }
    let [a, b] = [&gpu.layers(), &mean.mean()].map(|l| l.get(Layer::Glossy).mean());
    assert!((a - b).abs().max_element() < 2e-3 * b.max_element(), "{a} for {b}");
}

#[test]
fn particles_follow_a_dimmed_lamp_and_give_way_to_another_method() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = by_particles(3_000, LobeShape::Ggx);
    gpu.upload(&solution);
    let mut layer = |solution: &LightTransportSolution| {
        gpu.upload(solution);
        gpu.frame(&frame_settings(camera(), DirectQuality::Elements));
        (gpu.layers().get(Layer::Glossy).clone(), gpu.renderer.mirrored_views())
    };
    let (bright, views_of_mirrors) = layer(&solution);
    let mut scene = (*solution.scene).clone();
    scene.lamps.iter_mut().for_each(|l| l.dimmer = 0.0);
    scene.objects.iter_mut().for_each(|o| o.dimmer = 0.0);
    let mut world = (*solution.world).clone();
    world.follow(&scene);
    let particles = Some(Arc::new(solution.particles.as_ref().unwrap().followed(&world, 3_000)));
    let dark = LightTransportSolution {
        scene: Arc::new(scene),
        world: Arc::new(world),
        particles,
        ..solution.clone()
    };
    assert!(bright.mean().max_element() > 0.0);
    assert_eq!(layer(&dark).0.mean(), Vec3::ZERO);
    // No particles yet: what is mirrored, unblurred, on both processors.
    let without = LightTransportSolution { particles: None, ..solution.clone() };
    let (shown, views) = layer(&without);
    // What particles make needs no mirrored view.
    assert!(0 < views_of_mirrors && views_of_mirrors < views, "{views_of_mirrors} of {views}");
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let wanted = render(&without, &camera(), SIZE[0], SIZE[1], &settings).1;
    let [a, b] = [&shown, wanted.get(Layer::Glossy)].map(|l| l.mean());
    assert!((a - b).abs().max_element() < 2e-3 * b.max_element(), "{a} for {b}");
    assert!(layer(&solution).0 == bright && shown != bright);
}
