//! What the last frame drew, read back.

use super::{device::GpuError, readback, renderer::GpuRenderer};
use crate::{
    math::image::LinearImage,
    superposition::{gbuffer::NO_TRIANGLE, layers::Layers},
};
use glam::Vec3;

impl GpuRenderer {
    /// The layers of the last submitted frame, cd/m².
    ///
    /// # Errors
    /// [`GpuError::Readback`] if the device is lost.
    pub fn read_layers(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Layers, GpuError> {
        let bytes = readback::buffer(device, queue, &self.targets.layers, self.targets.layer_bytes())?;
        let values: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
        let [width, height] = self.targets.size;
        let pixels = (width * height) as usize;
        Ok(Layers {
            images: std::array::from_fn(|i| LinearImage {
                width,
                height,
                pixels: if i < self.targets.layer_count as usize {
                    values[3 * pixels * i..][..3 * pixels].chunks_exact(3).map(Vec3::from_slice).collect()
                } else {
                    vec![Vec3::ZERO; pixels]
                },
            }),
        })
    }

    /// The display picture of the last submitted frame, row-major, sRGB.
    ///
    /// # Errors
    /// [`GpuError::Readback`] if the device is lost.
    pub fn read_output(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<[u8; 4]>, GpuError> {
        use wgpu::TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb};
        let pixels = readback::texture(device, queue, &self.targets.output)?;
        Ok(match self.format {
            Bgra8Unorm | Bgra8UnormSrgb => pixels.into_iter().map(|[b, g, r, a]| [r, g, b, a]).collect(),
            _ => pixels,
        })
    }

    /// Triangle of each pixel of the last submitted frame, [`NO_TRIANGLE`] for none.
    ///
    /// # Errors
    /// [`GpuError::Readback`] if the device is lost.
    pub fn read_triangle_ids(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<Vec<u32>, GpuError> {
        let pixels = readback::texture(device, queue, &self.targets.triangles)?;
        // 0, nothing, wraps around to NO_TRIANGLE.
        const { assert!(0u32.wrapping_sub(1) == NO_TRIANGLE) };
        Ok(pixels.into_iter().map(|p| u32::from_le_bytes(p).wrapping_sub(1)).collect())
    }
}
