//! The superposition renderer in wgpu: visibility, shading, composite, inspection.

use super::device::GpuError;
use crate::{
    inspection::InspectionScene,
    math::false_colour::FalseColour,
    scene::camera::Camera,
    superposition::{
        composite::{DirectQuality, Display},
        layers::Layers,
    },
    transport::LightTransportSolution,
};

/// What one frame shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSettings {
    /// From where.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Weight of each layer, in the order of [`crate::superposition::layers::Layer::ALL`].
    pub weights: [f32; 3],
    /// From radiance to display.
    pub display: Display,
    /// How direct light is evaluated.
    pub direct: DirectQuality,
    /// Number of the frame: frames differ in their shadow rays. 0 starts over when accumulating.
    pub frame_index: u32,
    /// Whether this frame joins the running mean of those before it, with jittered pixels; otherwise
    /// it replaces them. Start with `frame_index` 0 after any change of camera, size or solution.
    pub accumulate: bool,
    /// Object to outline.
    pub highlighted: Option<u32>,
    /// Seed of every random number.
    pub seed: u64,
}

impl Default for FrameSettings {
    fn default() -> Self {
        Self {
            camera: Camera::default(),
            size: [640, 360],
            weights: [1.0; 3],
            display: Display::default(),
            direct: DirectQuality::PerPixel(4),
            frame_index: 0,
            accumulate: false,
            highlighted: None,
            seed: 1,
        }
    }
}

/// Draws a solution into textures of its own.
pub struct GpuRenderer {
    output: wgpu::TextureView,
}

impl GpuRenderer {
    /// Builds the pipelines; `output_format` is that of [`Self::output`].
    ///
    /// # Errors
    /// Where the device's limits are too small.
    pub fn new(device: &wgpu::Device, output_format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        let output = device
            .create_texture(&wgpu::TextureDescriptor {
                label: Some("output"),
                size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: output_format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
            .create_view(&Default::default());
        Ok(Self { output })
    }

    /// Takes over a solution: everything when the scene is new, only what differs otherwise.
    pub fn upload(
        &mut self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
        _solution: &LightTransportSolution,
    ) {
    }

    /// What to draw over the picture, coloured by luminance; `None` clears it.
    pub fn set_inspection(
        &mut self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
        _scene: Option<&InspectionScene>,
        _colour: &FalseColour,
    ) {
    }

    /// Records one frame.
    pub fn render(
        &mut self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
        _encoder: &mut wgpu::CommandEncoder,
        _frame: &FrameSettings,
    ) {
    }

    /// The display-encoded picture of the last frame.
    pub fn output(&self) -> &wgpu::TextureView {
        &self.output
    }

    /// The layers of the last submitted frame, cd/m².
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read_layers(&self, _device: &wgpu::Device, _queue: &wgpu::Queue) -> Result<Layers, GpuError> {
        Ok(Layers::new(0, 0))
    }

    /// The display picture of the last submitted frame, row-major, sRGB.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read_output(
        &self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
    ) -> Result<Vec<[u8; 4]>, GpuError> {
        Ok(Vec::new())
    }

    /// Triangle of each pixel of the last submitted frame, [`crate::superposition::gbuffer::NO_TRIANGLE`] for none.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read_triangle_ids(
        &self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
    ) -> Result<Vec<u32>, GpuError> {
        Ok(Vec::new())
    }
}
