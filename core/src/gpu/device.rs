//! A device without a window, and what any device must offer.

/// Storage buffers that the passes of mirrors bind in one stage.
pub const STORAGE_BUFFERS: u32 = 17;

/// What can go wrong on the way to a device.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter at all, not even a software one.
    #[error("no graphics adapter: {0}")]
    NoAdapter(String),
    /// The adapter refused a device.
    #[error("adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// Its words.
        reason: String,
    },
    /// The adapter offers less than the renderer needs.
    #[error("adapter {adapter} offers {offered} {what}, the renderer needs {needed}")]
    TooSmall {
        /// Name of the adapter.
        adapter: String,
        /// What there is too little of.
        what: &'static str,
        /// What it offers.
        offered: u64,
        /// What is needed.
        needed: u64,
    },
    /// A tree of the scene has more levels than a ray's stack in the shaders holds.
    #[error(
        "a tree over the scene's triangles is {levels} levels deep, the shaders follow {most}; \
         triangles of very different sizes in one object make such trees"
    )]
    TooDeep {
        /// Levels of inner nodes.
        levels: u32,
        /// Levels the shaders follow.
        most: u32,
    },
    /// A picture could not be read back.
    #[error("reading back from the graphics device failed: {0}")]
    Readback(String),
}

/// A device without a window.
pub struct GpuContext {
    /// Name and driver of the adapter, for the log and the report.
    pub adapter: String,
    /// Whether a processor stands in for a graphics card.
    pub emulated: bool,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
}

impl GpuContext {
    /// Opens the best adapter there is, a software one included.
    ///
    /// # Errors
    /// Where there is none, or it offers too little.
    pub fn headless() -> Result<Self, GpuError> {
        Self::headless_with(wgpu::Features::empty())
    }

    /// The same with those of some more features that the adapter has.
    ///
    /// # Errors
    /// Where there is none, or it offers too little.
    pub fn headless_with(wanted: wgpu::Features) -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        }))
        .map_err(|e| GpuError::NoAdapter(e.to_string()))?;
        let info = adapter.get_info();
        let name = format!("{} ({:?}, {})", info.name, info.backend, info.driver_info);
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("lumenscope"),
            required_features: required_features() | (wanted & adapter.features()),
            required_limits: required_limits(&adapter)?,
            ..Default::default()
        }))
        .map_err(|e| GpuError::NoDevice { adapter: name.clone(), reason: e.to_string() })?;
        Ok(Self { adapter: name, emulated: info.device_type == wgpu::DeviceType::Cpu, device, queue })
    }
}

/// Features the renderer needs: none beyond WebGPU's own.
pub fn required_features() -> wgpu::Features {
    wgpu::Features::empty()
}

/// Limits to ask of an adapter: WebGPU's defaults, more storage buffers a stage, and buffers as
/// large as it offers, so that large scenes fit where they can.
///
/// # Errors
/// [`GpuError::TooSmall`] where it binds too few storage buffers.
pub fn required_limits(adapter: &wgpu::Adapter) -> Result<wgpu::Limits, GpuError> {
    let offered = adapter.limits();
    if offered.max_storage_buffers_per_shader_stage < STORAGE_BUFFERS {
        return Err(GpuError::TooSmall {
            adapter: adapter.get_info().name,
            what: "storage buffers a stage",
            offered: offered.max_storage_buffers_per_shader_stage.into(),
            needed: STORAGE_BUFFERS.into(),
        });
    }
    Ok(wgpu::Limits {
        max_storage_buffers_per_shader_stage: STORAGE_BUFFERS,
        max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
        max_buffer_size: offered.max_buffer_size,
        max_texture_dimension_2d: offered.max_texture_dimension_2d,
        ..wgpu::Limits::default().or_worse_values_from(&offered)
    })
}
