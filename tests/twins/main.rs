//! The shaders against the CPU functions that specify them.

mod display;
mod glass;
mod layers;
mod mirrored;
mod particles;
mod programs;
mod structures;

use glam::{Affine3A, Vec3};
use lumenscope_core::{
    gpu::{FrameSettings, GpuContext, GpuRenderer},
    math::image::LinearImage,
    scene::{Scene, camera::Camera, lamp::LampKind},
    superposition::{
        composite::DirectQuality,
        gbuffer::GBuffer,
        layers::{Layer, Layers},
    },
    transport::LightTransportSolution,
};
use lumenscope_tests::add_point_lamp;
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

/// A device with a renderer on it.
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
        let average = errors.iter().sum::<f32>() / errors.len() as f32;
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
