//! The terms of the picture: still, moved, shining, with guests, as a running mean.

use super::{mirrored::mirrored, *};
use lumenscope_core::{
    irradiance_volume::{
        dynamic_object::{DynamicObject, Gloss},
        moments::Order,
    },
    math::part::Part,
    radiosity::{
        lookup::Lookup,
        surface_map::{BURIED, Element},
    },
    superposition::{PassSettings, accumulator::Accumulator, render},
    transport::guests::Visitor,
};
use lumenscope_tests::{add, cornell, diffuse, rectangle, with_moved_block};

/// The same light with the short block moved.
fn moved(solution: &LightTransportSolution) -> LightTransportSolution {
    let (moved, block) = with_moved_block(solution, Vec3::new(-0.1, 0.3, 0.2));
    // Lattices on its sides, so that more than corners is compared.
    let mut known = DynamicObject::new(&moved.scene, &moved.world.geometry, block as usize, Some(0.17));
    known.occlude(&moved.world, block as usize, 1);
    LightTransportSolution { dynamic_objects: Arc::new([(block, known)].into()), ..moved }
}

#[test]
fn every_layer_agrees_where_nothing_moved_and_where_an_object_did() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let still = solved(cornell());
    let moved = moved(&still);
    let order = Order::Finite(10);
    let volume = moved.volume.as_ref().unwrap().with_moments(&[order], &moved.world, &*moved.radiosity);
    let shining = LightTransportSolution { volume: Some(Arc::new(volume)), ..moved.clone() }
        .with_gloss(Some(Gloss { order, eye: moved.scene.camera.eye }));
    assert!(shining.gloss.is_some() && moved.with_gloss(shining.gloss).gloss.is_none());
    // The last round comes back to the first solution: only placements are sent.
    let rounds = [("still", &still), ("moved", &moved), ("shining", &shining), ("still again", &still)];
    for (what, solution) in rounds {
        gpu.upload(solution);
        for direct in [DirectQuality::Elements, DirectQuality::PerPixel(4)] {
            let camera = solution.scene.camera;
            gpu.frame(&frame_settings(camera, direct));
            let settings = PassSettings { direct, seed: 1, ..PassSettings::default() };
            let (buffer, layers) = render(solution, &camera, SIZE[0], SIZE[1], &settings);
            compare(&format!("{what}, {direct:?}"), (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
        }
    }
}

#[test]
fn a_lamp_almost_below_the_horizon_lights_alike() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    // Of a panel 10 m high no more than 30 cm stand over the plate's horizon: one point seldom falls there.
    let mut scene = Scene::default();
    let panel = rectangle(Vec3::new(-5.0, -9.7, -2.0), Vec3::X * 10.0, Vec3::Y * 10.0);
    add(&mut scene, "panel", panel, diffuse("panel", Vec3::ZERO, Vec3::splat(1000.0)));
    let plate = rectangle(Vec3::new(-0.2, 0.0, -0.2), 0.4 * Vec3::Z, 0.4 * Vec3::X);
    add(&mut scene, "plate", plate, diffuse("plate", Vec3::splat(0.5), Vec3::ZERO));
    let camera = Camera { eye: Vec3::new(0.1, 0.4, 0.3), target: Vec3::ZERO, ..Camera::default() };
    let solution = lumenscope_tests::solved(scene, 0.5);
    gpu.upload(&solution);
    let direct = DirectQuality::PerPixel(1);
    gpu.frame(&frame_settings(camera, direct));
    let settings = PassSettings { direct, seed: 1, ..PassSettings::default() };
    let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &settings);
    compare_layers("grazing", &[Layer::Direct], (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
    let lit =
        layers.get(Layer::Direct).pixels.iter().zip(&buffer.triangle).filter(|(_, t)| **t >= 2 && **t < 4);
    assert!(lit.clone().count() > 1000 && lit.into_iter().all(|(l, _)| l.x > 0.0));
}

/// The same light whose pictures look it up bicubically.
fn bicubic(solution: &LightTransportSolution) -> LightTransportSolution {
    let mut scene = (*solution.scene).clone();
    scene.plan.lookup = Some(Lookup::Mitchell);
    LightTransportSolution { scene: Arc::new(scene), ..solution.clone() }
}

#[test]
fn light_looked_up_bicubically_agrees() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let bilinear = solved(cornell());
    // A hair off the axis, as where mirrors are compared.
    let mut camera = bilinear.scene.camera;
    camera.eye += Vec3::new(0.017, 0.011, 0.0);
    let still = bicubic(&bilinear);
    let buried = |e: &Element| e.flags & BURIED != 0;
    assert!(still.radiosity.elements().iter().any(buried), "no node is under a block: nothing to tell apart");
    for (what, solution) in
        [("still", &still), ("moved", &moved(&still)), ("polished", &bicubic(&mirrored()))]
    {
        gpu.upload(solution);
        for direct in [DirectQuality::Elements, DirectQuality::PerPixel(4)] {
            gpu.frame(&frame_settings(camera, direct));
            let settings = PassSettings { direct, seed: 1, ..PassSettings::default() };
            let (buffer, layers) = render(solution, &camera, SIZE[0], SIZE[1], &settings);
            // Few pixels of what is polished have diffuse light; the test of mirrors says more.
            let which: &[Layer] = if what == "polished" {
                &[Layer::Indirect, Layer::Mirror]
            } else {
                &[Layer::Direct, Layer::Indirect]
            };
            compare_layers(what, which, (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
        }
    }
    // It is another picture than the bilinear one, and that one comes back.
    let indirect = |gpu: &mut Gpu, solution: &LightTransportSolution| {
        gpu.upload(solution);
        gpu.frame(&frame_settings(camera, DirectQuality::Elements));
        gpu.layers().get(Layer::Indirect).clone()
    };
    let [before, curved, after] = [&bilinear, &still, &bilinear].map(|s| indirect(&mut gpu, s));
    assert_eq!(before, after);
    let differing = before.pixels.iter().zip(&curved.pixels).filter(|(a, b)| a != b).count();
    let lit = before.pixels.iter().filter(|p| **p != Vec3::ZERO).count();
    assert!(2 * differing > lit, "{differing} of {lit} pixels differ");
}

#[test]
fn guests_lit_by_volumes_of_their_own_agree() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    let (volume, mesh) = (solution.volume.clone().unwrap(), solution.scene.meshes[5].clone());
    let material = solution.scene.materials[5].clone();
    let copy = |x: f32, part| Visitor {
        parts: vec![(mesh.clone(), material.clone())],
        world_from_object: Affine3A::from_translation(Vec3::new(x, 1.3, 0.2))
            * Affine3A::from_rotation_y(0.4),
        volume: volume.clone(),
        part,
        known: None,
    };
    let dressed = solution.with_guests(&[copy(-0.5, Part::All), copy(0.5, Part::Indirect)]);
    let camera = solution.scene.camera;
    for direct in [DirectQuality::Elements, DirectQuality::PerPixel(2)] {
        // Into a scene without them and out again: nothing of the one stays in the other.
        for solution in [&dressed, &solution, &dressed] {
            gpu.upload(solution);
            gpu.frame(&frame_settings(camera, direct));
            let settings = PassSettings { direct, ..PassSettings::default() };
            let (buffer, layers) = render(solution, &camera, SIZE[0], SIZE[1], &settings);
            compare("with guests", (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
        }
    }
}

#[test]
fn a_room_is_looked_into_through_its_backs() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    gpu.upload(&solution);
    let camera = Camera { eye: Vec3::new(2.5, 0.3, -4.0), target: Vec3::Y, ..solution.scene.camera };
    gpu.frame(&frame_settings(camera, DirectQuality::Elements));
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &settings);
    compare("from outside", (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
}

#[test]
fn the_running_mean_is_the_accumulators() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    gpu.upload(&solution);
    let camera = solution.scene.camera;
    let mut mean = Accumulator::new();
    let frames = 6;
    let mut differing = vec![false; (SIZE[0] * SIZE[1]) as usize];
    for frame in 0..frames {
        let direct = DirectQuality::PerPixel(1);
        let settings =
            FrameSettings { frame_index: frame, accumulate: true, ..frame_settings(camera, direct) };
        gpu.frame(&settings);
        let settings = PassSettings { direct, frame, jitter: true, ..PassSettings::default() };
        let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &settings);
        for (d, (a, b)) in differing.iter_mut().zip(gpu.triangles().iter().zip(&buffer.triangle)) {
            *d |= a != b;
        }
        mean.add(&layers);
    }
    assert_eq!(gpu.renderer.accumulated(), frames);
    let (gpu, cpu) = (gpu.layers(), mean.mean());
    for layer in [Layer::Emitted, Layer::Direct, Layer::Indirect] {
        let level = cpu.get(layer).mean().element_sum() / 3.0;
        let mut errors: Vec<f32> = gpu
            .get(layer)
            .pixels
            .iter()
            .zip(&cpu.get(layer).pixels)
            .zip(&differing)
            .filter(|(_, differing)| !**differing)
            .map(|((a, b), _)| (*a - *b).abs().max_element() / level)
            .collect();
        errors.sort_by(f32::total_cmp);
        // 1e-3 on average as above; nine in ten pixels to the rounding of six sums and f32 factors.
        let average = errors.iter().sum::<f32>() / errors.len() as f32;
        assert!(average < 1e-3, "{}: mean {average}", layer.name());
        assert!(errors[errors.len() * 9 / 10] < 1e-4, "{}: {}", layer.name(), errors[errors.len() * 9 / 10]);
    }
}
