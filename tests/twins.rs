//! The shaders against the CPU functions that specify them.

use bytemuck::offset_of;
use glam::{Affine3A, Vec3};
use lumenscope_core::{
    glossy::gpu as glossy_gpu,
    gpu::{FrameSettings, GpuContext, GpuRenderer, frame, inspection as gpu_inspection, shaders, tables},
    inspection::{ColouredMesh, InspectionScene, Line, SphereGlyph},
    irradiance_volume::{
        dynamic_object::{DynamicObject, Gloss},
        moments::Order,
    },
    math::{
        false_colour::{FalseColour, Palette},
        image::LinearImage,
        part::Part,
        sphere_map::DirectionBins,
    },
    mirror::gpu as mirror_gpu,
    radiosity::lookup::SideMap,
    scene::{Scene, camera::Camera, lamp::LampKind},
    superposition::{
        PassSettings,
        accumulator::Accumulator,
        composite::{self, DirectQuality, Display, ToneCurve},
        gbuffer::GBuffer,
        layers::{Layer, Layers},
        overlay, render,
    },
    transport::{LightTransportSolution, guests::Visitor},
};
use lumenscope_tests::{add_point_lamp, cornell, with_moved_block};
use std::sync::Arc;

const SIZE: [u32; 2] = [160, 100];

/// A device, or `None` with a word about it; a panic where the environment asks for one.
fn context() -> Option<GpuContext> {
    match GpuContext::headless() {
        Ok(context) => {
            println!("adapter: {}", context.adapter);
            Some(context)
        }
        Err(error) => {
            assert!(std::env::var_os("LUMENSCOPE_REQUIRE_GPU").is_none_or(|v| v != "1"), "{error}");
            println!("skipped: no adapter ({error})");
            None
        }
    }
}

/// The Cornell box with every kind of lamp and a texture, solved coarsely.
fn solved(mut scene: Scene) -> LightTransportSolution {
    add_point_lamp(&mut scene, Vec3::new(0.6, 1.5, 0.6), Vec3::new(3.0, 4.0, 5.0));
    let spot = add_point_lamp(&mut scene, Vec3::new(-0.6, 1.7, 0.7), Vec3::ZERO);
    scene.lamps[spot].kind =
        LampKind::Spot { intensity: Vec3::new(9.0, 8.0, 6.0), inner_angle: 0.2, outer_angle: 0.5 };
    scene.lamps[spot].world_from_lamp *= Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let sun = add_point_lamp(&mut scene, Vec3::ZERO, Vec3::ZERO);
    scene.lamps[sun].kind = LampKind::Directional { illuminance: Vec3::splat(5.0) };
    scene.lamps[sun].world_from_lamp = Affine3A::from_rotation_y(0.5) * Affine3A::from_rotation_x(-0.3);
    let mut texture = LinearImage::new(4, 3);
    for (i, texel) in texture.pixels.iter_mut().enumerate() {
        *texel = Vec3::new(0.25 + 0.0625 * i as f32, 0.5, 1.0 - 0.0625 * i as f32);
    }
    scene.textures.push(Arc::new(texture));
    for object in &scene.objects {
        let material = &mut scene.materials[object.parts[0].material];
        match object.name.as_str() {
            "shell" => material.reflectance_texture = Some(0),
            "tall block" => material.double_sided = true,
            _ => {}
        }
    }
    lumenscope_tests::solved(scene, 0.2)
}

/// The same light with the short block moved.
fn moved(solution: &LightTransportSolution) -> LightTransportSolution {
    let (moved, block) = with_moved_block(solution, Vec3::new(-0.1, 0.3, 0.2));
    // Lattices on its sides, so that more than corners is compared.
    let mut known = DynamicObject::new(&moved.scene, &moved.world.geometry, block as usize, Some(0.17));
    known.occlude(&moved.world, block as usize, 1);
    LightTransportSolution { dynamic_objects: Arc::new([(block, known)].into()), ..moved }
}

struct Gpu {
    context: GpuContext,
    renderer: GpuRenderer,
}

impl Gpu {
    fn new(context: GpuContext) -> Self {
        let renderer = GpuRenderer::new(&context.device, wgpu::TextureFormat::Rgba8Unorm).unwrap();
        Self { context, renderer }
    }

    fn upload(&mut self, solution: &LightTransportSolution) {
        self.renderer.upload(&self.context.device, &self.context.queue, solution).unwrap();
    }

    fn frame(&mut self, settings: &FrameSettings) {
        let mut encoder = self.context.device.create_command_encoder(&Default::default());
        self.renderer.render(&self.context.device, &self.context.queue, &mut encoder, settings);
        self.context.queue.submit([encoder.finish()]);
    }

    fn layers(&self) -> Layers {
        self.renderer.read_layers(&self.context.device, &self.context.queue).unwrap()
    }

    fn triangles(&self) -> Vec<u32> {
        self.renderer.read_triangle_ids(&self.context.device, &self.context.queue).unwrap()
    }

    fn output(&self) -> Vec<[u8; 4]> {
        self.renderer.read_output(&self.context.device, &self.context.queue).unwrap()
    }
}

fn frame_settings(camera: Camera, direct: DirectQuality) -> FrameSettings {
    FrameSettings { camera, size: SIZE, direct, ..FrameSettings::default() }
}

/// Holds every layer to its specification where both see the same triangle.
///
/// The bounds: 1e-3 of the layer's mean on average, from f32 sums against f64 and from shadow rays
/// that pass an edge on the other side; a single such ray of `rays` moves one pixel by its share of
/// that emitter, so the worst pixel is stated, not bounded, and at most 0.5 % may be off by 1 %.
fn compare(what: &str, gpu: (&[u32], &Layers), cpu: (&GBuffer, &Layers)) {
    compare_layers(what, &Layer::ALL, gpu, cpu);
}

/// [`compare`] for some of the layers.
fn compare_layers(what: &str, which: &[Layer], gpu: (&[u32], &Layers), cpu: (&GBuffer, &Layers)) {
    let same: Vec<usize> = (0..gpu.0.len()).filter(|&i| gpu.0[i] == cpu.0.triangle[i]).collect();
    let different = 1.0 - same.len() as f64 / gpu.0.len() as f64;
    assert!(different <= 0.01, "{what}: {:.2} % of the pixels see another triangle", 100.0 * different);
    for &layer in which {
        let (a, b) = (&gpu.1.get(layer).pixels, &cpu.1.get(layer).pixels);
        let mean = cpu.1.get(layer).mean().element_sum() / 3.0;
        if matches!(layer, Layer::Mirror | Layer::Glossy) && mean == 0.0 {
            assert_eq!(gpu.1.get(layer).mean(), Vec3::ZERO);
            continue;
        }
        assert!(mean > 0.0, "{what}: {} is black, nothing is compared", layer.name());
        let errors: Vec<f32> = same.iter().map(|&i| (a[i] - b[i]).abs().max_element() / mean).collect();
        assert!(errors.iter().all(|e| e.is_finite()), "{what}: {} is not finite", layer.name());
        // In a mirror too a pixel on an edge may see another triangle; those are counted below, not averaged.
        let on_an_edge = |e: &&f32| **e > 0.01 && matches!(layer, Layer::Mirror | Layer::Glossy);
        let average = errors.iter().filter(|e| !on_an_edge(e)).sum::<f32>() / errors.len() as f32;
        let worst = errors.iter().copied().fold(0.0, f32::max);
        let off = errors.iter().filter(|e| **e > 0.01).count() as f32 / errors.len() as f32;
        println!(
            "{what}: {}: mean {average:.1e}, worst {worst:.1e}, off by 1 % {:.3} %, other triangle {:.2} %",
            layer.name(),
            100.0 * off,
            100.0 * different
        );
        assert!(average <= 1e-3, "{what}: {} differs by {average} on average", layer.name());
        assert!(off <= 5e-3, "{what}: {} differs by over 1 % at {} of the pixels", layer.name(), off);
    }
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
    for direct in [DirectQuality::Elements, DirectQuality::PerPixel(8)] {
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

#[test]
fn the_display_is_the_same_within_one_step() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    gpu.upload(&solution);
    let heat = |logarithmic| FalseColour { palette: Palette::Inferno, low: 0.5, high: 60.0, logarithmic };
    for display in [
        Display { ev100: 4.0, ..Display::default() },
        Display { ev100: 3.0, tone: ToneCurve::Linear, false_colour: None },
        Display { false_colour: Some(heat(false)), ..Display::default() },
        Display { false_colour: Some(heat(true)), ..Display::default() },
    ] {
        let weights = [1.0, 0.5, 2.0, 1.0, 1.0];
        let settings = FrameSettings {
            display,
            weights,
            ..frame_settings(solution.scene.camera, DirectQuality::Elements)
        };
        gpu.frame(&settings);
        let wanted = composite::display(&gpu.layers().sum(weights), &display);
        // One step of 255 for the rounding of pow, log and the sums in f32.
        let worst = gpu
            .output()
            .iter()
            .zip(&wanted)
            .flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)))
            .max();
        assert!(worst <= Some(1), "{display:?}: {worst:?} steps");
    }
}

#[test]
fn an_outline_surrounds_the_selected_object_alone() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    gpu.upload(&solution);
    let plain = frame_settings(solution.scene.camera, DirectQuality::Elements);
    gpu.frame(&plain);
    let before = gpu.output();
    let block = solution.scene.objects.iter().position(|o| o.name == "short block").unwrap() as u32;
    gpu.frame(&FrameSettings { highlighted: Some(block), ..plain });
    let after = gpu.output();
    let on_block: Vec<bool> = gpu
        .triangles()
        .iter()
        .map(|&t| t != u32::MAX && solution.world.geometry.object[t as usize] == block)
        .collect();
    let changed = before.iter().zip(&after).filter(|(a, b)| a != b).count();
    assert!(changed > 50, "{changed} pixels outlined");
    assert!(changed < on_block.len() / 10, "{changed} pixels outlined");
    assert!((0..after.len()).all(|i| !on_block[i] || before[i] == after[i]), "the object itself changed");
}

#[test]
fn inspection_scenes_are_drawn_as_the_overlay_says() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    gpu.upload(&solution);
    let bins = DirectionBins::new(5);
    let glyph = |centre, first_bin| SphereGlyph { centre, radius: 0.12, first_bin, sample: 0 };
    let scene = InspectionScene {
        spheres: vec![
            glyph(Vec3::new(-0.5, 1.5, 0.3), 0),
            glyph(Vec3::new(0.7, 0.3, -0.6), bins.len() as u32),
            glyph(Vec3::new(0.1, 1.2, 0.5), 0),
        ],
        sphere_bins: (0..2 * bins.len()).map(|i| Vec3::splat((i % 17) as f32)).collect(),
        bins: Some(bins),
        meshes: vec![ColouredMesh {
            positions: vec![
                Vec3::new(-0.9, 0.02, 0.9),
                Vec3::new(0.0, 0.02, 0.9),
                Vec3::new(-0.9, 0.9, -0.9),
            ],
            values: vec![Vec3::ZERO, Vec3::splat(8.0), Vec3::splat(16.0)],
            triangles: vec![[0, 1, 2]],
        }],
        lines: vec![Line {
            ends: [Vec3::new(-0.9, 0.1, 0.9), Vec3::new(0.9, 1.9, -0.9)],
            colour: Vec3::new(1.0, 0.2, 0.1),
        }],
        ..InspectionScene::default()
    };
    let colour = FalseColour { palette: Palette::Viridis, low: 0.0, high: 16.0, logarithmic: false };
    let camera = solution.scene.camera;
    let (device, queue) = (&gpu.context.device, &gpu.context.queue);
    gpu.renderer.set_inspection(device, queue, Some(&scene), &colour).unwrap();
    let settings = frame_settings(camera, DirectQuality::Elements);
    gpu.frame(&settings);
    let pass = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &pass);
    let plain = composite::display(&layers.total(), &settings.display);
    let mut wanted = plain.clone();
    overlay::draw(&mut wanted, &buffer, &camera, &scene, &colour);
    let drawn = plain.iter().zip(&wanted).filter(|(a, b)| a != b).count();
    assert!(drawn > 500, "only {drawn} pixels of overlay");
    let off = gpu
        .output()
        .iter()
        .zip(&wanted)
        .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2))
        .count();
    // Edges of lines, triangles and bins fall on the other side of a pixel's centre now and then.
    println!("overlay: {off} of {} pixels differ, {drawn} are drawn", wanted.len());
    assert!(off * 100 <= wanted.len(), "{off} pixels differ");
    gpu.renderer.set_inspection(&gpu.context.device, &gpu.context.queue, None, &colour).unwrap();
    gpu.frame(&settings);
    let left = gpu.output().iter().zip(&plain).filter(|(a, b)| a[0].abs_diff(b[0]) > 2).count();
    assert!(left * 100 <= plain.len(), "{left} pixels of overlay are left");
}

/// One structure of a program: its name, size and the offsets of its members.
fn layout_of(program: &shaders::Program, name: &str) -> (u32, Vec<u32>) {
    let module = naga::front::wgsl::parse_str(&program.source()).unwrap();
    for (_, ty) in module.types.iter() {
        if let (Some(found), naga::TypeInner::Struct { members, span }) = (&ty.name, &ty.inner)
            && found == name
        {
            return (*span, members.iter().map(|m| m.offset).collect());
        }
    }
    panic!("{} has no structure {name}", program.name);
}

#[test]
fn every_program_is_valid_wgsl() {
    // Needed to unpack halves, which WGSL has without any extension.
    let half = naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    for program in shaders::ALL {
        let source = program.source();
        let module = naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|e| panic!("{}: {}", program.name, e.emit_to_string(&source)));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), half)
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}: {}", program.name, e.emit_to_string(&source)));
    }
}

/// A box with mirrors left and right, a polished floor, a chrome block and a bent piece of metal.
fn mirrored() -> LightTransportSolution {
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
    // From the front the top of the block is seen at so flat an angle that one pixel on its edge, which sees past
    // it on one side, fills the kernels of all others: there the layer is not compared.
    let aside =
        Camera { eye: Vec3::new(0.6, 1.3, 0.8), target: Vec3::new(-0.8, 0.4, -0.5), ..Camera::default() };
    for (name, solution, camera) in [("front", &solution, solution.scene.camera), ("aside", &solution, aside)]
    {
        gpu.upload(solution);
        for direct in [DirectQuality::Elements, DirectQuality::PerPixel(8)] {
            gpu.frame(&frame_settings(camera, direct));
            let settings = PassSettings { direct, ..PassSettings::default() };
            let (buffer, layers) = render(solution, &camera, SIZE[0], SIZE[1], &settings);
            println!("{name}: {} mirrored views", gpu.renderer.mirrored_views());
            // Where most is metal there is little direct light to err on; it has its own test.
            let which: &[Layer] = match direct {
                DirectQuality::Elements => &Layer::ALL[1..],
                DirectQuality::PerPixel(_) => &[Layer::Mirror, Layer::Glossy],
            };
            // From the front, kernels are left out.
            let which = if name == "front" { &which[..which.len() - 1] } else { which };
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

macro_rules! same_layout {
    ($program:expr, $name:literal, $ty:ty, $($field:ident),+) => {{
        let value: $ty = bytemuck::Zeroable::zeroed();
        let offsets: Vec<u32> = vec![$(offset_of!(value, $ty, $field) as u32),+];
        let (size, wanted) = layout_of(&$program, $name);
        assert_eq!(size as usize, size_of::<$ty>(), "size of {}", $name);
        // Arrays stand for several members of the shader.
        assert!(offsets.iter().all(|o| wanted.contains(o)), "{}: {offsets:?}, shader {wanted:?}", $name);
        assert!(offsets.windows(2).all(|w| w[0] < w[1]), "{} is named out of order", $name);
    }};
}

#[test]
fn structures_have_the_same_layout_on_both_sides() {
    use shaders::{COMPOSITE, GLOSSY, INSPECTION, MIRROR_FOLLOW, SHADE};
    same_layout!(
        SHADE,
        "Frame",
        frame::Frame,
        eye,
        frame,
        forward,
        samples,
        right,
        emitter_count,
        up,
        tree_count,
        half_size,
        size,
        subpixel,
        seed,
        accumulated,
        near,
        highlighted,
        line_width,
        depth_bias
    );
    same_layout!(
        MIRROR_FOLLOW,
        "MirroredView",
        mirror_gpu::ViewInfo,
        eye,
        reflector,
        right,
        parent,
        up,
        depth,
        forward,
        padding,
        clip_normal,
        clip_offset
    );
    same_layout!(GLOSSY, "Texel", glossy_gpu::TexelInfo, radiance, nearness, coverage, reflector, padding);
    same_layout!(GLOSSY, "LevelInfo", glossy_gpu::LevelInfo, first, width, height, padding);
    same_layout!(GLOSSY, "LobeTables", glossy_gpu::LobeTables, alpha, entries, count, padding);
    same_layout!(MIRROR_FOLLOW, "MirroredViews", mirror_gpu::ViewTable, count, near, padding, list);
    same_layout!(SHADE, "Corner", tables::Corner, position, u, normal, v);
    same_layout!(SHADE, "TriangleInfo", tables::TriangleInfo, material, object, reflector);
    same_layout!(SHADE, "ObjectInfo", tables::ObjectInfo, dimmer, moved_first, first_triangle, stored_direct);
    same_layout!(
        SHADE,
        "MaterialInfo",
        tables::MaterialInfo,
        reflectance,
        reflectance_texture,
        emission,
        emission_texture,
        double_sided,
        diffuse_share,
        metallic,
        dielectric,
        alpha,
        padding
    );
    same_layout!(SHADE, "TextureInfo", tables::TextureInfo, first, width, height, padding);
    same_layout!(SHADE, "Node", tables::Node, low, count, high, first);
    same_layout!(SHADE, "TreeTriangle", tables::TreeTriangle, a, padding_0, b, padding_1, c, padding_2);
    same_layout!(SHADE, "Tree", tables::Tree, rows, root, node_count, padding);
    same_layout!(
        SHADE,
        "EmitterInfo",
        tables::EmitterInfo,
        colour,
        kind,
        position,
        cos_inner,
        axis,
        cos_outer,
        first,
        count,
        flags,
        area
    );
    same_layout!(SHADE, "EmitterTriangle", tables::EmitterTriangle, triangle, cumulative_area);
    same_layout!(SHADE, "SideMap", SideMap, first, size, corners);
    same_layout!(SHADE, "ElementLight", tables::ElementLight, direct, padding_0, indirect, padding_1);
    same_layout!(
        COMPOSITE,
        "Composite",
        frame::Composite,
        weights,
        exposure,
        tone,
        false_colour,
        encode,
        layer_count,
        specular_weights,
        padding
    );
    same_layout!(COMPOSITE, "FalseColour", frame::FalseColourTable, low, high, logarithmic, padding, palette);
    same_layout!(COMPOSITE, "ShownTriangle", tables::TriangleInfo, material, object, reflector);
    same_layout!(INSPECTION, "Sphere", gpu_inspection::Sphere, centre, radius, first_bin, padding);
    same_layout!(
        INSPECTION,
        "LineInfo",
        gpu_inspection::LineInfo,
        a,
        padding_0,
        b,
        padding_1,
        colour,
        padding_2
    );
    same_layout!(INSPECTION, "InspectionSettings", gpu_inspection::InspectionSettings, bins, encode, padding);
}

/// A tree of `levels` inner nodes in a chain, each with a leaf beside the next.
fn chain(levels: u32) -> Vec<tables::Node> {
    let node = |first, count| tables::Node { first, count, ..bytemuck::Zeroable::zeroed() };
    let inner = (0..levels).flat_map(|i| [node(2 * i + 1, 0), node(0, 1)]);
    let mut nodes: Vec<_> = inner.collect();
    nodes.push(node(0, 1));
    // Children stand side by side: the inner one is the second of each pair but the last.
    for i in 1..nodes.len() - 1 {
        if i % 2 == 1 {
            nodes.swap(i, i + 1);
        }
    }
    for (i, node) in nodes.iter_mut().enumerate().filter(|(_, n)| n.count == 0) {
        node.first = i as u32 + 1;
    }
    nodes
}

#[test]
fn a_tree_too_deep_for_the_shaders_is_refused_with_a_reason() {
    let source = shaders::SHADE.source();
    assert!(
        source.contains(&format!("const STACK: u32 = {}u;", tables::MOST_LEVELS)),
        "one stack, two sides"
    );
    for levels in [0, 1, 5, tables::MOST_LEVELS, tables::MOST_LEVELS + 6] {
        assert_eq!(tables::levels(&chain(levels), 0), levels);
    }
    assert!(tables::check_levels(&chain(tables::MOST_LEVELS), 0).is_ok());
    let error = tables::check_levels(&chain(tables::MOST_LEVELS + 6), 0).unwrap_err();
    assert!(error.to_string().contains("70") && error.to_string().contains("64"), "{error}");
}
