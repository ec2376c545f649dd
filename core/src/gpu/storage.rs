//! Buffers that grow with what is put into them.

use super::device::GpuError;
use bytemuck::Pod;

/// Smallest buffer, so that an empty table can be bound.
const SMALLEST: u64 = 256;

/// A storage buffer as large as what was last put into it, or larger.
pub(crate) struct Storage {
    label: &'static str,
    buffer: wgpu::Buffer,
}

impl Storage {
    /// An empty buffer.
    pub(crate) fn new(device: &wgpu::Device, label: &'static str) -> Self {
        Self { label, buffer: create(device, label, SMALLEST) }
    }

    /// Puts a table into it; says whether the buffer is a new one and must be bound anew.
    ///
    /// # Errors
    /// [`GpuError::TooSmall`] where the device binds no buffer as large.
    pub(crate) fn write<T: Pod>(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        table: &[T],
    ) -> Result<bool, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(table);
        let needed = bytes.len() as u64;
        let offered = device.limits().max_storage_buffer_binding_size;
        if needed > offered {
            return Err(GpuError::TooSmall {
                adapter: "in use".into(),
                what: "bytes in one storage buffer",
                offered,
                needed,
            });
        }
        let grow = needed > self.buffer.size();
        if grow {
            self.buffer = create(device, self.label, needed.next_multiple_of(256).min(offered));
        }
        queue.write_buffer(&self.buffer, 0, bytes);
        Ok(grow)
    }

    /// Overwrites a part of the table, from an element on.
    pub(crate) fn patch<T: Pod>(&self, queue: &wgpu::Queue, first: usize, part: &[T]) {
        queue.write_buffer(&self.buffer, (first * size_of::<T>()) as u64, bytemuck::cast_slice(part));
    }

    /// The buffer.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}

/// A storage buffer of so many bytes.
pub(crate) fn create(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A uniform buffer of one structure.
pub(crate) fn uniform<T: Pod>(device: &wgpu::Device, label: &str) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size_of::<T>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// What a binding holds.
#[derive(Clone, Copy)]
pub(crate) enum Binding {
    /// A uniform structure.
    Uniform,
    /// A table that is read.
    Table,
    /// A table that is written.
    Written,
    /// An unsigned integer texture.
    Texture,
    /// A texture of triangle numbers that is written.
    WrittenTexture,
}

/// A layout of bindings, numbered as given.
pub(crate) fn layout(
    device: &wgpu::Device,
    label: &str,
    stages: wgpu::ShaderStages,
    bindings: &[(u32, Binding)],
) -> wgpu::BindGroupLayout {
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let entries: Vec<_> = bindings
        .iter()
        .map(|&(binding, kind)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: stages,
            ty: match kind {
                Binding::Uniform => buffer(wgpu::BufferBindingType::Uniform),
                Binding::Table => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
                Binding::Written => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
                Binding::Texture => wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Uint,
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                Binding::WrittenTexture => wgpu::BindingType::StorageTexture {
                    access: wgpu::StorageTextureAccess::WriteOnly,
                    format: super::targets::TRIANGLE_FORMAT,
                    view_dimension: wgpu::TextureViewDimension::D2,
                },
            },
            count: None,
        })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Binds resources, numbered as given.
pub(crate) fn bind(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
