//! From the device back to memory. It waits: for tests, exports and picking, not for every frame.

use super::device::GpuError;

/// Copies a buffer's first `size` bytes.
pub(super) fn buffer(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Buffer,
    size: u64,
) -> Result<Vec<u8>, GpuError> {
    let staging = staging(device, size);
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, Some(size));
    queue.submit([encoder.finish()]);
    mapped(device, &staging)
}

/// Copies a texture of four bytes a texel, row after row.
pub(super) fn texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Texture,
) -> Result<Vec<[u8; 4]>, GpuError> {
    let size = source.size();
    let row = (size.width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(device, u64::from(row) * u64::from(size.height));
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        source.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
        },
        size,
    );
    queue.submit([encoder.finish()]);
    let bytes = mapped(device, &staging)?;
    Ok(bytes
        .chunks_exact(row as usize)
        .flat_map(|r| r[..size.width as usize * 4].chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]))
        .collect())
}

fn staging(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: size.max(4),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn mapped(device: &wgpu::Device, staging: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let (sender, receiver) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver only goes when the poll failed, and that is reported below.
        let _ = sender.send(result);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| GpuError::Readback(e.to_string()))?;
    receiver
        .recv()
        .map_err(|e| GpuError::Readback(e.to_string()))?
        .map_err(|e| GpuError::Readback(e.to_string()))?;
    let view = staging.get_mapped_range(..).map_err(|e| GpuError::Readback(e.to_string()))?;
    Ok(view.to_vec())
}
