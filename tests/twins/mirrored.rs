//! Mirrored views, and what is glossy in them.

use super::*;
use lumenscope_core::superposition::{PassSettings, accumulator::Accumulator, render};
use lumenscope_core::{
    glossy::GlossyMethod,
    gpu::{Stage, StageClock},
    math::progress::Progress,
    mirror::{MirrorMethod, images::MirrorImages},
    scene::{brdf::LobeShape, material::Material, world::World},
};
use lumenscope_tests::cornell;

/// A box with mirrors left and right, a polished floor, a chrome block and a bent piece of metal.
pub fn mirrored() -> LightTransportSolution {
    let mut scene = cornell();
    for material in &mut scene.materials {
        match material.name.as_str() {
            "red" | "green" => (material.metallic, material.roughness) = (0.9, 0.0),
            "white" => material.roughness = 0.03,
            "tall" => (material.metallic, material.roughness) = (1.0, 0.2),
            "short" => (material.metallic, material.roughness) = (1.0, 0.0),
            _ => {}
        }
    }
    let short = scene.objects.iter().find(|o| o.name == "short block").unwrap().parts[0].mesh;
    let mut bent = (*scene.meshes[short]).clone();
    bent.normals.iter_mut().for_each(|n| *n = (*n + Vec3::new(0.2, 0.3, 0.1)).normalize());
    scene.meshes[short] = Arc::new(bent);
    scene.plan.mirror_depth = Some(3);
    // Nothing bright with a sharp edge: a pixel there that one side sees otherwise would spread over a kernel.
    let panel = scene.materials.iter_mut().find(|m| m.name == "panel").unwrap();
    (panel.reflectance, panel.emission) = (Vec3::splat(0.7), Vec3::ZERO);
    add_point_lamp(&mut scene, Vec3::new(0.2, 1.0, 0.7), Vec3::new(30.0, 28.0, 24.0));
    lumenscope_tests::solved(scene, 0.2)
}

#[test]
fn mirrors_show_what_the_specification_shows_in_them() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = mirrored();
    // A hair off the axis: on it the room's edges run exactly through pixel centres, and which side of an edge such
    // a pixel sees, or whether the view behind a mirror has anything there, is decided by rounding.
    let mut front = solution.scene.camera;
    front.eye += Vec3::new(0.017, 0.011, 0.0);
    let aside =
        Camera { eye: Vec3::new(0.6, 1.3, 0.8), target: Vec3::new(-0.8, 0.4, -0.5), ..Camera::default() };
    for (name, camera) in [("front", front), ("aside", aside)] {
        gpu.upload(&solution);
        for direct in [DirectQuality::Elements, DirectQuality::PerPixel(8)] {
            gpu.frame(&frame_settings(camera, direct));
            let settings = PassSettings { direct, ..PassSettings::default() };
            let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &settings);
            println!("{name}: {} mirrored views", gpu.renderer.mirrored_views());
            // Where most is metal there is little direct light to err on; it has its own test.
            let which: &[Layer] = match direct {
                DirectQuality::Elements => &Layer::ALL[1..],
                DirectQuality::PerPixel(_) => &[Layer::Mirror, Layer::Glossy],
            };
            compare_layers(name, which, (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
        }
    }
    assert!(gpu.renderer.mirrored_views() > 4);
    // The mean of jittered frames, as the window shows it.
    let mut mean = Accumulator::new();
    for frame_index in 0..4 {
        let direct = DirectQuality::Elements;
        gpu.frame(&FrameSettings { frame_index, accumulate: true, ..frame_settings(aside, direct) });
        let settings = PassSettings { direct, frame: frame_index, jitter: true, ..PassSettings::default() };
        mean.add(&render(&solution, &aside, SIZE[0], SIZE[1], &settings).1);
    }
    let (found, wanted) = (gpu.layers(), mean.mean());
    let [a, b] = [&found, &wanted].map(|l| l.get(Layer::Mirror).mean());
    assert!((a - b).abs().max_element() < 2e-3 * b.max_element(), "{a} for {b}");
    // Something dull is uploaded: no view, and the layers are black.
    gpu.upload(&solved(cornell()));
    gpu.frame(&frame_settings(aside, DirectQuality::Elements));
    assert_eq!((gpu.renderer.mirrored_views(), gpu.layers().get(Layer::Mirror).mean()), (0, Vec3::ZERO));
}

#[test]
fn one_kernel_a_reflector_is_the_specifications() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let camera =
        Camera { eye: Vec3::new(0.617, 1.311, 0.8), target: Vec3::new(-0.8, 0.4, -0.5), ..Camera::default() };
    let (ggx, phong) = (LobeShape::Ggx, LobeShape::Phong);
    for (shape, roughness) in [(ggx, 0.1), (ggx, 0.25), (ggx, 0.45), (phong, 0.1), (phong, 0.45)] {
        // Kernels of a few pixels, and of some dozens on coarser levels: the floor's, the walls' and the block's.
        let solution = edited(&mirrored(), shape, roughness, GlossyMethod::Invariant);
        gpu.upload(&solution);
        gpu.frame(&frame_settings(camera, DirectQuality::Elements));
        let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
        let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &settings);
        let name = format!("{shape:?}, roughness {roughness}");
        compare_layers(&name, &[Layer::Glossy], (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
        // It is no other method's picture.
        let mut other = (*solution.scene).clone();
        other.plan.glossy = Some(GlossyMethod::Variant);
        let other = LightTransportSolution { scene: Arc::new(other), ..solution };
        let variant = render(&other, &camera, SIZE[0], SIZE[1], &settings).1;
        let (a, b) = (layers.get(Layer::Glossy), variant.get(Layer::Glossy));
        let apart: f32 = a.pixels.iter().zip(&b.pixels).map(|(a, b)| (*a - *b).abs().max_element()).sum();
        assert!(apart / a.pixels.len() as f32 > 2e-3 * b.mean().max_element());
    }
}

/// A solution with every glossy material's lobe and the method replaced, as the plan and the materials panel do.
fn edited(
    solution: &LightTransportSolution,
    shape: LobeShape,
    roughness: f32,
    method: GlossyMethod,
) -> LightTransportSolution {
    let mut scene = (*solution.scene).clone();
    scene.plan.glossy = Some(method);
    for material in scene.materials.iter_mut().filter(|m| m.is_glossy()) {
        (material.roughness, material.lobe_shape) = (roughness, shape);
    }
    let world = Arc::new(World::new(&scene));
    LightTransportSolution { scene: Arc::new(scene), world, ..solution.clone() }
}

#[test]
fn lobes_follow_a_material_and_every_method_is_its_specification_within_the_glossy_rectangle() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = mirrored();
    // Close to a part of the floor, so that what is glossy fills a corner of the picture.
    let camera =
        Camera { eye: Vec3::new(0.617, 1.311, 0.8), target: Vec3::new(-0.8, 0.9, -0.5), ..Camera::default() };
    gpu.upload(&edited(&solution, LobeShape::Ggx, 0.1, GlossyMethod::Variant));
    for (shape, roughness) in
        [(LobeShape::Ggx, 0.3), (LobeShape::Phong, 0.3), (LobeShape::Phong, 0.05), (LobeShape::Ggx, 0.45)]
    {
        for method in
            [GlossyMethod::Variant, GlossyMethod::VariantHalf, GlossyMethod::Invariant, GlossyMethod::Sharp]
        {
            // Nothing but a material's value changed: the same structure on the device, other lobes.
            let solution = edited(&solution, shape, roughness, method);
            gpu.upload(&solution);
            gpu.frame(&frame_settings(camera, DirectQuality::Elements));
            let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
            let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &settings);
            let name = format!("{shape:?}, roughness {roughness}, {}", method.name());
            compare_layers(&name, &[Layer::Glossy], (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
        }
    }
}

#[test]
fn culling_changes_no_pixel() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = mirrored();
    gpu.upload(&solution);
    for (eye, target) in [
        (Vec3::new(0.6, 1.3, 0.8), Vec3::new(-0.8, 0.4, -0.5)),
        (Vec3::new(-0.2, 0.9, 0.5), Vec3::new(0.9, 0.2, -0.6)),
    ] {
        let settings = frame_settings(Camera { eye, target, ..Camera::default() }, DirectQuality::Elements);
        let mut frame = |culling| {
            gpu.renderer.set_culling(culling);
            gpu.frame(&settings);
            (gpu.triangles(), gpu.layers())
        };
        let (culled, whole) = (frame(true), frame(false));
        assert!(culled.0 == whole.0, "other triangles are seen");
        assert!(culled.1 == whole.1, "the layers differ");
    }
}

#[test]
fn mirrors_from_images_with_depth_are_the_specifications() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = mirrored();
    let images = MirrorImages::automatic(&solution.world, &Progress::silent()).unwrap();
    let mut scene = (*solution.scene).clone();
    scene.plan.mirrors = Some(MirrorMethod::Images);
    let scene = Arc::new(scene);
    let by_images =
        LightTransportSolution { scene, mirror_images: Some(Arc::new(images)), ..solution.clone() };
    let camera =
        Camera { eye: Vec3::new(0.617, 1.311, 0.8), target: Vec3::new(-0.8, 0.4, -0.5), ..Camera::default() };
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    gpu.upload(&by_images);
    gpu.frame(&frame_settings(camera, DirectQuality::Elements));
    let (buffer, layers) = render(&by_images, &camera, SIZE[0], SIZE[1], &settings);
    let which = [Layer::Mirror, Layer::Glossy];
    compare_layers("images", &which, (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
    // They are no geometry's.
    let exact = render(&solution, &camera, SIZE[0], SIZE[1], &settings).1;
    let (a, b) = (layers.get(Layer::Mirror), exact.get(Layer::Mirror));
    let other = |(a, b): &(&Vec3, &Vec3)| (**a - **b).abs().max_element() > 0.01 * b.max_element();
    assert!(a.pixels.iter().zip(&b.pixels).filter(other).count() > 50);
    // Without lamps: nothing but light is uploaded anew, and nothing of the old is left.
    let mut dark = (*by_images.scene).clone();
    dark.lamps.iter_mut().for_each(|l| l.dimmer = 0.0);
    let dark = lumenscope_tests::solved(dark, 0.2);
    let dark = LightTransportSolution { mirror_images: by_images.mirror_images.clone(), ..dark };
    gpu.upload(&dark);
    gpu.frame(&frame_settings(camera, DirectQuality::Elements));
    assert_eq!(gpu.layers().get(Layer::Mirror).mean(), Vec3::ZERO);
}

#[test]
fn images_that_follow_what_moves_are_sent_where_they_changed() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let mut scene = (*mirrored().scene).clone();
    // What moves is dull: the light of moved things that shine is another matter.
    let short = scene.materials.iter_mut().find(|m| m.name == "short").unwrap();
    (short.metallic, short.roughness) = (0.0, 1.0);
    scene.plan.mirrors = Some(MirrorMethod::Images);
    let solution = lumenscope_tests::solved(scene, 0.2);
    let images = Arc::new(MirrorImages::automatic(&solution.world, &Progress::silent()).unwrap());
    let mut scene = (*solution.scene).clone();
    scene.plan.mirrors = Some(MirrorMethod::Images);
    let first =
        LightTransportSolution { scene: Arc::new(scene), mirror_images: Some(images.clone()), ..solution };
    let camera =
        Camera { eye: Vec3::new(0.617, 1.311, 0.8), target: Vec3::new(-0.8, 0.4, -0.5), ..Camera::default() };
    let settings = frame_settings(camera, DirectQuality::Elements);
    gpu.upload(&first);
    gpu.frame(&settings);
    let before = gpu.layers();
    let (moved, _) = lumenscope_tests::with_moved_block(&first, Vec3::new(-0.55, 0.0, 0.1));
    let followed = images.moved(&moved.world);
    assert!(followed.hold(&moved.world.geometry) && followed.rays < followed.points());
    let moved = LightTransportSolution { mirror_images: Some(followed), ..moved };
    gpu.upload(&moved);
    gpu.frame(&settings);
    let layers = gpu.layers();
    let pass = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let (buffer, wanted) = render(&moved, &camera, SIZE[0], SIZE[1], &pass);
    let which = [Layer::Mirror, Layer::Glossy];
    compare_layers("images followed", &which, (&gpu.triangles(), &layers), (&buffer, &wanted));
    let (old, new) = (before.get(Layer::Mirror), layers.get(Layer::Mirror));
    let changed = old.pixels.iter().zip(&new.pixels).filter(|(a, b)| a != b).count();
    assert!(changed > 50, "{changed} pixels of mirrors show the move");
    // A device that never had other images shows the same.
    let mut other = Gpu::new(self::context().unwrap());
    other.upload(&moved);
    other.frame(&settings);
    assert!(other.layers() == layers);
}

/// The box of Cornell's kind with a mirror on its left, in front of it a ball of chrome where it is asked for.
fn left_mirror(ball: bool, change: impl FnOnce(&mut Scene)) -> LightTransportSolution {
    let mut scene = cornell();
    let red = scene.materials.iter_mut().find(|m| m.name == "red").unwrap();
    (red.metallic, red.roughness, red.double_sided) = (1.0, 0.0, false);
    if ball {
        let chrome = Material { metallic: 1.0, roughness: 0.0, ..Material::default() };
        let mesh = lumenscope_tests::ball(Vec3::new(-0.6, 0.8, 0.4), 0.2, [16, 24]);
        lumenscope_tests::add(&mut scene, "ball", mesh, chrome);
    }
    change(&mut scene);
    lumenscope_tests::solved(scene, 0.3)
}

#[test]
fn reflectors_out_of_sight_or_facing_away_record_nothing() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let camera = |eye: [f32; 3], target: [f32; 3]| Camera {
        eye: Vec3::from(eye),
        target: Vec3::from(target),
        ..Camera::default()
    };
    let sees = camera([0.6, 1.3, 0.8], [-0.8, 0.4, -0.5]);
    let turned = camera([-0.3, 1.0, 0.1], [0.9, 0.7, -0.2]);
    let behind = camera([-1.9, 1.1, 0.2], [0.5, 0.8, -0.1]);
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    // Passes and layers, the latter held to the specification.
    let frame = |gpu: &mut Gpu, solution: &LightTransportSolution, camera: Camera| {
        gpu.frame(&frame_settings(camera, DirectQuality::Elements));
        let (buffer, layers) = render(solution, &camera, SIZE[0], SIZE[1], &settings);
        let found = gpu.layers();
        let which = [Layer::Mirror, Layer::Glossy];
        compare_layers("in sight or not", &which, (&gpu.triangles(), &found), (&buffer, &layers));
        (gpu.renderer.mirror_passes(), found)
    };
    let solution = left_mirror(false, |_| ());
    gpu.upload(&solution);
    let first = frame(&mut gpu, &solution, sees);
    assert!(first.0 >= 4 && first.1.get(Layer::Mirror).mean() != Vec3::ZERO, "{} passes", first.0);
    for camera in [turned, behind, turned] {
        let (passes, layers) = frame(&mut gpu, &solution, camera);
        assert_eq!((passes, layers.get(Layer::Mirror).mean()), (0, Vec3::ZERO));
    }
    assert!(frame(&mut gpu, &solution, sees) == first, "what was left out is there again");
    assert_eq!(frame(&mut gpu, &solution, turned).0, 0);

    // Without views there is what reflects as if dull, where it is in sight.
    let flat = left_mirror(false, |scene| scene.plan.mirror_depth = Some(0));
    gpu.upload(&flat);
    assert_eq!([sees, turned, behind].map(|camera| frame(&mut gpu, &flat, camera).0), [2, 0, 0]);
    // A ball has no view, and one in the mirror costs no pass of its own.
    let bent = left_mirror(true, |_| ());
    gpu.upload(&bent);
    let ball_alone = camera([-0.6, 0.9, -0.4], [-0.6, 0.8, 0.4]);
    let passes = [sees, turned, ball_alone].map(|camera| frame(&mut gpu, &bent, camera).0);
    assert_eq!(passes[1], 0);
    assert!(passes[0] >= first.0 && passes[2] > 0, "{passes:?}");
    // Images-with-depth are not chosen for what is out of sight.
    let solution = left_mirror(false, |scene| scene.plan.mirrors = Some(MirrorMethod::Images));
    let images = MirrorImages::automatic(&solution.world, &Progress::silent()).unwrap();
    let by_images = LightTransportSolution { mirror_images: Some(Arc::new(images)), ..solution };
    gpu.upload(&by_images);
    let passes = [sees, turned, behind].map(|camera| frame(&mut gpu, &by_images, camera).0);
    assert!(passes[0] > 0 && passes[1..] == [0, 0], "{passes:?}");
}

#[test]
fn a_scene_without_reflectors_has_no_pass_and_no_buffer_of_mirrors() {
    if context().is_none() {
        return;
    }
    let mut gpu = Gpu::new(GpuContext::headless_with(StageClock::FEATURES).unwrap());
    gpu.renderer.set_clock(StageClock::new(&gpu.context.device, &gpu.context.queue));
    let mut of = |solution: &LightTransportSolution| {
        gpu.upload(solution);
        gpu.frame(&frame_settings(solution.scene.camera, DirectQuality::Elements));
        let stages = gpu.renderer.clock().map(|clock| clock.stages().to_vec());
        (stages, gpu.renderer.has_mirror_passes(), gpu.renderer.layer_bytes())
    };
    let dull = solved(cornell());
    let plain = of(&dull);
    assert!(!plain.1 && plain.2 == 4 * 9 * u64::from(SIZE[0] * SIZE[1]));
    if let Some(stages) = &plain.0 {
        assert_eq!(stages[..], [Stage::Visibility, Stage::Shading, Stage::Composite]);
    }
    let polished = of(&mirrored());
    assert!(polished.1 && polished.2 > plain.2 && polished.0 != plain.0);
    // Dull again: what was made for it is gone.
    assert_eq!(of(&dull), plain);
}
