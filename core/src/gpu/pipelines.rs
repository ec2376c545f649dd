//! Pipelines from a module and an entry point.

use super::targets::DEPTH_FORMAT;

fn pipeline_layout(device: &wgpu::Device, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|g| Some(*g)).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

/// A pipeline of one entry point.
pub(crate) fn compute_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    entry: &str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::ComputePipeline {
    compute_variant(device, module, entry, groups, &[])
}

/// A pipeline of one entry point with some of its overridable constants set.
pub(crate) fn compute_variant(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    entry: &str,
    groups: &[&wgpu::BindGroupLayout],
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: Some(&pipeline_layout(device, groups)),
        module,
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    })
}

/// How triangles are drawn.
pub(crate) struct Raster {
    /// Test against the depth there is, which is written.
    pub depth: Option<wgpu::CompareFunction>,
    /// Faces left out.
    pub cull: Option<wgpu::Face>,
    /// Whether colours are written.
    pub colour: bool,
    /// Whether they are mixed with what is there by their alpha.
    pub blend: bool,
}

impl Raster {
    /// The nearest of all faces; depth is largest at the eye.
    pub const NEAREST: Self =
        Self { depth: Some(wgpu::CompareFunction::Greater), cull: None, colour: true, blend: false };
}

/// A pipeline that draws triangles without vertex buffers.
pub(crate) fn render_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    groups: &[&wgpu::BindGroupLayout],
    format: wgpu::TextureFormat,
    raster: Raster,
) -> wgpu::RenderPipeline {
    let blend = raster.blend.then_some(wgpu::BlendState::ALPHA_BLENDING);
    let writes = if raster.colour { wgpu::ColorWrites::ALL } else { wgpu::ColorWrites::empty() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: Some(&pipeline_layout(device, groups)),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState { cull_mode: raster.cull, ..Default::default() },
        depth_stencil: raster.depth.map(|compare| wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState { format, blend, write_mask: writes })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A colour target that begins with nothing in it.
pub(crate) fn clearing(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            store: wgpu::StoreOp::Store,
        },
    }
}
