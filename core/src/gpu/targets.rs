//! What a frame is drawn into: triangle numbers, depth, layers, output.

/// Format of the triangle numbers: number + 1, 0 where there is nothing.
pub(crate) const TRIANGLE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Format of depth, which is near / distance: larger is nearer.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Floats a pixel: three layers of three, or five and the state of a mirrored ray, which `shaders/mirror/views.wgsl`
/// names.
const PLAIN_FLOATS: u64 = 9;
const SPECULAR_FLOATS: u64 = 15 + 8;

/// Textures and buffers of one size.
pub(crate) struct Targets {
    /// Width and height in pixels.
    pub(crate) size: [u32; 2],
    /// Layers: three, or five where something is specular.
    pub(crate) layer_count: u32,
    /// Triangle numbers.
    pub(crate) triangles: wgpu::Texture,
    /// View of them.
    pub(crate) triangles_view: wgpu::TextureView,
    /// View of the depth.
    pub(crate) depth_view: wgpu::TextureView,
    /// Display picture.
    pub(crate) output: wgpu::Texture,
    /// View of it.
    pub(crate) output_view: wgpu::TextureView,
    /// Layers, one after the other, three floats a pixel.
    pub(crate) layers: wgpu::Buffer,
}

impl Targets {
    /// Targets of a size.
    pub(crate) fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        specular: bool,
    ) -> Self {
        use wgpu::TextureUsages as Usage;
        let texture = |label, format, usage| texture(device, label, size, format, usage);
        let triangles = texture("triangles", TRIANGLE_FORMAT, Usage::TEXTURE_BINDING | Usage::COPY_SRC);
        let depth = texture("depth", DEPTH_FORMAT, Usage::empty());
        let output = texture("output", format, Usage::TEXTURE_BINDING | Usage::COPY_SRC);
        let view = |t: &wgpu::Texture| t.create_view(&Default::default());
        Self {
            size,
            layer_count: if specular { 5 } else { 3 },
            triangles_view: view(&triangles),
            depth_view: view(&depth),
            output_view: view(&output),
            triangles,
            output,
            layers: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("layers"),
                size: pixel_bytes(specular) * pixels(size),
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        }
    }

    /// The wanted size, made to fit the device: at least 1×1, and small enough for the layers' buffer.
    pub(crate) fn fitting(device: &wgpu::Device, wanted: [u32; 2], specular: bool) -> [u32; 2] {
        let limits = device.limits();
        let [mut width, mut height] = wanted.map(|n| n.clamp(1, limits.max_texture_dimension_2d));
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        while pixel_bytes(specular) * pixels([width, height]) > most {
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
        }
        [width, height]
    }

    /// Bytes of the layers.
    pub(crate) fn layer_bytes(&self) -> u64 {
        12 * u64::from(self.layer_count) * pixels(self.size)
    }

    /// Bytes of the two layers of what is specular, after those of what is diffuse.
    pub(crate) fn specular_layers(&self) -> std::ops::Range<u64> {
        36 * pixels(self.size)..self.layer_bytes()
    }

    /// Whether they have room for what is specular.
    pub(crate) fn specular(&self) -> bool {
        self.layer_count > 3
    }
}

/// A texture to draw into.
pub(crate) fn texture(
    device: &wgpu::Device,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

fn pixel_bytes(specular: bool) -> u64 {
    4 * if specular { SPECULAR_FLOATS } else { PLAIN_FLOATS }
}

fn pixels([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}
