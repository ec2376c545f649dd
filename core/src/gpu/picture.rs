//! What the renderer's passes over the picture are made of.

use super::{
    pipelines::compute_variant,
    shaders::{self, Needs},
    storage::bind,
    targets::Targets,
};

/// Pipelines that shade.
pub(super) struct ShadePipelines {
    pub(super) needs: Needs,
    pub(super) per_pixel: wgpu::ComputePipeline,
    /// For scenes as [`SceneTables::is_general`] says: not, and so.
    pub(super) elements: [wgpu::ComputePipeline; 2],
}

impl ShadePipelines {
    pub(super) fn new(device: &wgpu::Device, groups: [&wgpu::BindGroupLayout; 2], needs: Needs) -> Self {
        let module = shaders::SHADE.module(device);
        let variant = |entry, general| {
            compute_variant(device, &module, entry, &groups, &shaders::constants(general, needs))
        };
        Self {
            needs,
            per_pixel: variant("shade_per_pixel", true),
            elements: [false, true].map(|general| variant("shade_elements", general)),
        }
    }
}

/// What the picture's passes are bound to: visibility, shading, composite.
pub(super) fn groups(
    device: &wgpu::Device,
    [visibility, shade, composite]: [&wgpu::BindGroupLayout; 3],
    [frame, settings, false_colour]: [&wgpu::Buffer; 3],
    targets: &Targets,
    triangles: &wgpu::Buffer,
) -> [wgpu::BindGroup; 3] {
    let frame = frame.as_entire_binding();
    let seen = wgpu::BindingResource::TextureView(&targets.triangles_view);
    let layers = targets.layers.as_entire_binding();
    let seen_and_layers = [(0, frame.clone()), (1, seen), (2, layers)];
    let mut all = seen_and_layers.to_vec();
    all.extend([
        (3, settings.as_entire_binding()),
        (4, false_colour.as_entire_binding()),
        (5, triangles.as_entire_binding()),
    ]);
    [
        bind(device, "visibility", visibility, &[(0, frame)]),
        bind(device, "shade", shade, &seen_and_layers),
        bind(device, "composite", composite, &all),
    ]
}
