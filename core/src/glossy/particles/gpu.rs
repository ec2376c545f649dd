//! Particles on the GPU: twin of [`super::pass`].
//!
//! The sorted particles lie in one table, and a pixel looks its neighbours up as on the processor. Not drawn as quads
//! and blended: the blending of floats is no part of what every adapter offers, and its order would change the sum.

use crate::gpu::{
    pipelines::compute_variant,
    scene::SceneTables,
    shaders,
    storage::{Binding, bind, layout},
    targets::Targets,
};

/// The pass that sums particles.
pub(crate) struct ParticlePass {
    layout: wgpu::BindGroupLayout,
    splat: wgpu::ComputePipeline,
}

impl ParticlePass {
    /// Builds the pipeline.
    pub(crate) fn new(device: &wgpu::Device, scene: &SceneTables) -> Self {
        use Binding::{Table, Texture, Uniform, Written};
        let bindings = [(0, Uniform), (1, Texture), (2, Written), (3, Table)];
        let layout = layout(device, "particles", wgpu::ShaderStages::COMPUTE, &bindings);
        let module = shaders::PARTICLES.module(device);
        let constants = shaders::constants(true, scene.needs());
        let groups = [&scene.layout, &layout];
        let splat = compute_variant(device, &module, "splat_particles", &groups, &constants);
        Self { layout, splat }
    }

    /// Records the layer of one frame.
    pub(crate) fn record(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneTables,
        (frame, targets): (&wgpu::Buffer, &Targets),
    ) {
        let resources = [
            (0, frame.as_entire_binding()),
            (1, wgpu::BindingResource::TextureView(&targets.triangles_view)),
            (2, targets.layers.as_entire_binding()),
            (3, scene.particles.buffer().as_entire_binding()),
        ];
        let group = bind(device, "particles", &self.layout, &resources);
        let label = wgpu::ComputePassDescriptor { label: Some("particles"), ..Default::default() };
        let mut pass = encoder.begin_compute_pass(&label);
        pass.set_pipeline(&self.splat);
        pass.set_bind_group(0, &scene.group, &[]);
        pass.set_bind_group(1, &group, &[]);
        let [width, height] = targets.size;
        pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
    }
}
