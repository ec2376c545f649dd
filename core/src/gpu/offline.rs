//! Pictures from the GPU without a window.

use super::{
    device::{GpuContext, GpuError},
    renderer::{FrameSettings, GpuRenderer},
};
use crate::{
    scene::camera::Camera,
    superposition::{composite::DirectQuality, layers::Layers},
    transport::LightTransportSolution,
};

/// The mean of `frames` frames, and the adapter's name.
///
/// # Errors
/// When no adapter answers, or it offers too little, or it only emulates a GPU and `even_emulated` is false.
pub fn render(
    solution: &LightTransportSolution,
    camera: &Camera,
    size: [u32; 2],
    frames: u32,
    seed: u64,
    even_emulated: bool,
) -> Result<(Layers, String), GpuError> {
    let context = GpuContext::headless()?;
    if context.emulated && !even_emulated {
        return Err(GpuError::NoAdapter(format!("{} is emulated", context.adapter)));
    }
    let (device, queue) = (&context.device, &context.queue);
    let mut renderer = GpuRenderer::new(device, wgpu::TextureFormat::Rgba8Unorm)?;
    renderer.upload(device, queue, solution)?;
    for frame_index in 0..frames.max(1) {
        let frame = FrameSettings {
            camera: *camera,
            size,
            direct: DirectQuality::PerPixel(2),
            frame_index,
            accumulate: frames > 1,
            seed,
            ..FrameSettings::default()
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        renderer.render(device, queue, &mut encoder, &frame);
        queue.submit([encoder.finish()]);
    }
    Ok((renderer.read_layers(device, queue)?, context.adapter))
}
