//! The superposition renderer in wgpu: visibility, shading, composite, inspection.
//!
//! Visibility is rasterised, because that is what every adapter is fast at; shading meets the same
//! triangle by the pixel's ray, so that what is shaded is what the CPU shades. Shadow rays walk the
//! CPU's own trees in a compute shader, not in ray-query hardware: few adapters have it, and the
//! software one has none.

pub use super::frame::FrameSettings;
use super::{
    clock::{Stage, StageClock, mark},
    device::GpuError,
    frame::{Composite, FalseColourTable, Frame},
    inspection::Inspection,
    picture::{ShadePipelines, groups},
    pipelines::{Raster, clearing, render_pipeline},
    scene::SceneTables,
    shaders,
    storage::{Binding, layout, uniform},
    targets::{TRIANGLE_FORMAT, Targets},
};
use crate::{
    inspection::InspectionScene,
    math::false_colour::FalseColour,
    mirror::{
        culling::Portal,
        gpu::MirrorPasses,
        views::{Eye, Rectangle},
    },
    superposition::{composite::DirectQuality, moved::MovedLight},
    transport::LightTransportSolution,
};

/// Draws a solution into textures of its own.
pub struct GpuRenderer {
    pub(super) format: wgpu::TextureFormat,
    scene: SceneTables,
    inspection: Inspection,
    pub(super) targets: Targets,
    frame: wgpu::Buffer,
    composite_settings: wgpu::Buffer,
    false_colour: wgpu::Buffer,
    visibility_layout: wgpu::BindGroupLayout,
    shade_layout: wgpu::BindGroupLayout,
    composite_layout: wgpu::BindGroupLayout,
    visibility_group: wgpu::BindGroup,
    shade_group: wgpu::BindGroup,
    composite_group: wgpu::BindGroup,
    /// Of single-sided triangles, and of double-sided ones.
    visibility: [wgpu::RenderPipeline; 2],
    shade: ShadePipelines,
    composite: wgpu::RenderPipeline,
    composite_plain: wgpu::RenderPipeline,
    /// Passes of what is polished, made when something first is.
    mirror: Option<MirrorPasses>,
    clock: Option<StageClock>,
    accumulated: u32,
}

impl GpuRenderer {
    /// Builds the pipelines; `output_format` is that of [`Self::output`], four bytes a texel.
    ///
    /// # Errors
    /// Where the device binds too few storage buffers.
    pub fn new(device: &wgpu::Device, output_format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        let offered = device.limits().max_storage_buffers_per_shader_stage;
        if offered < super::device::STORAGE_BUFFERS {
            return Err(GpuError::TooSmall {
                adapter: "in use".into(),
                what: "storage buffers a stage",
                offered: offered.into(),
                needed: super::device::STORAGE_BUFFERS.into(),
            });
        }
        use Binding::{Table, Texture, Uniform, Written};
        use wgpu::ShaderStages as Stages;
        let scene = SceneTables::new(device);
        let visibility_layout = layout(device, "visibility", Stages::VERTEX_FRAGMENT, &[(0, Uniform)]);
        let shade_layout =
            layout(device, "shade", Stages::COMPUTE, &[(0, Uniform), (1, Texture), (2, Written)]);
        let composite_layout = layout(
            device,
            "composite",
            Stages::VERTEX_FRAGMENT,
            &[(0, Uniform), (1, Texture), (2, Table), (3, Uniform), (4, Uniform), (5, Table)],
        );
        let frame = uniform::<Frame>(device, "frame");
        let composite_settings = uniform::<Composite>(device, "composite");
        let false_colour = uniform::<FalseColourTable>(device, "false colour");
        let targets = Targets::new(device, output_format, [1, 1], false);
        let [visibility_group, shade_group, composite_group] = groups(
            device,
            [&visibility_layout, &shade_layout, &composite_layout],
            [&frame, &composite_settings, &false_colour],
            &targets,
            scene.triangles(),
        );

        let visibility_module = shaders::VISIBILITY.module(device);
        let visibility = [Some(wgpu::Face::Back), None].map(|cull| {
            let groups = [&scene.raster_layout, &visibility_layout];
            let raster = Raster { cull, ..Raster::NEAREST };
            render_pipeline(
                device,
                &visibility_module,
                ["project", "identify"],
                &groups,
                TRIANGLE_FORMAT,
                raster,
            )
        });
        let shade = ShadePipelines::new(device, [&scene.layout, &shade_layout], scene.needs());
        let module = shaders::COMPOSITE.module(device);
        let composite = |entry| {
            let entries = ["full_screen", entry];
            let raster = Raster { depth: None, ..Raster::NEAREST };
            render_pipeline(device, &module, entries, &[&composite_layout], output_format, raster)
        };
        let (composite_plain, composite) = (composite("composite_plain"), composite("composite"));
        Ok(Self {
            inspection: Inspection::new(device, &frame, output_format),
            shade,
            format: output_format,
            scene,
            targets,
            frame,
            composite_settings,
            false_colour,
            visibility_layout,
            shade_layout,
            composite_layout,
            visibility_group,
            shade_group,
            composite_group,
            visibility,
            composite,
            composite_plain,
            mirror: None,
            clock: None,
            accumulated: 0,
        })
    }

    /// Takes over a solution: everything when the scene is new, only what differs otherwise.
    ///
    /// # Errors
    /// [`GpuError::TooSmall`] where the scene does not fit the device; then nothing is shown.
    pub fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        solution: &LightTransportSolution,
    ) -> Result<(), GpuError> {
        self.upload_lit(device, queue, solution, &MovedLight::new(solution, true))
    }

    /// [`upload`](Self::upload), with the light on moved objects, both its parts, made before.
    ///
    /// # Errors
    /// [`GpuError::TooSmall`] where the scene does not fit the device; then nothing is shown.
    pub fn upload_lit(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        solution: &LightTransportSolution,
        moved: &MovedLight,
    ) -> Result<(), GpuError> {
        self.accumulated = 0;
        if self.scene.upload(device, queue, solution, moved)? {
            self.bind(device, queue);
        }
        let needs = self.scene.needs();
        if needs != self.shade.needs {
            self.shade = ShadePipelines::new(device, [&self.scene.layout, &self.shade_layout], needs);
            self.mirror = None;
        }
        Ok(())
    }

    /// What to draw over the picture, coloured by luminance; `None` clears it.
    ///
    /// # Errors
    /// [`GpuError::TooSmall`] where it does not fit the device.
    pub fn set_inspection(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: Option<&InspectionScene>,
        colour: &FalseColour,
    ) -> Result<(), GpuError> {
        self.inspection.set(device, queue, scene, colour)
    }

    /// Records one frame.
    pub fn render(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        settings: &FrameSettings,
    ) {
        let specular = self.scene.specular();
        let size = Targets::fitting(device, settings.size, specular);
        if size != self.targets.size || specular != self.targets.specular() {
            self.targets = Targets::new(device, self.format, size, specular);
            self.accumulated = 0;
            self.bind(device, queue);
        }
        if !settings.accumulate || settings.frame_index == 0 {
            self.accumulated = 0;
        }
        let settings = FrameSettings { size, ..*settings };
        let frame = Frame::new(&settings, self.scene.counts, self.accumulated);
        self.accumulated += 1;
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        let composite = Composite::new(
            settings.weights,
            &settings.display,
            !self.format.is_srgb(),
            self.targets.layer_count,
        );
        queue.write_buffer(&self.composite_settings, 0, bytemuck::bytes_of(&composite));
        if let Some(colour) = &settings.display.false_colour {
            let table = FalseColourTable::new(colour);
            queue.write_buffer(&self.false_colour, 0, bytemuck::bytes_of(&table));
        }
        if let Some(clock) = &mut self.clock {
            clock.begin(encoder);
        }
        self.record_visibility(encoder, &settings);
        mark(&mut self.clock, encoder, Stage::Visibility);
        self.record_shading(encoder, settings.direct);
        mark(&mut self.clock, encoder, Stage::Shading);
        if !specular {
            self.mirror = None;
        } else {
            let mirror = self.mirror.get_or_insert_with(|| {
                MirrorPasses::new((device, queue), &self.scene, &self.frame, &self.targets)
            });
            let into = (&self.frame, &self.targets);
            mirror.record((device, queue), encoder, &self.scene, into, &settings, &mut self.clock);
        }
        let plain = settings.display.false_colour.is_none() && settings.highlighted.is_none();
        self.record_composite(encoder, plain);
        mark(&mut self.clock, encoder, Stage::Composite);
        if let Some(clock) = &self.clock {
            clock.end(encoder);
        }
        self.inspection.record(encoder, &self.targets);
    }

    /// Whether blocks of triangles that a view cannot show are left out; they are by default.
    pub fn set_culling(&mut self, culling: bool) {
        self.scene.culling = culling;
    }

    /// Takes the time of every stage of the frames to come, where there is a clock.
    pub fn set_clock(&mut self, clock: Option<StageClock>) {
        self.clock = clock;
    }

    /// The clock, with the times of the last submitted frame.
    pub fn clock(&self) -> Option<&StageClock> {
        self.clock.as_ref()
    }

    /// The display-encoded picture of the last frame.
    pub fn output(&self) -> &wgpu::TextureView {
        &self.targets.output_view
    }

    /// Bytes of what rasterising and shading from the elements read of a scene: corners and their order, triangles,
    /// objects, materials, textures, where the elements are and their light. Not the trees for shadow rays.
    pub fn shown_bytes(&self) -> u64 {
        self.scene.shown_bytes()
    }

    /// Width and height of the last frame: what was asked for, or what the device can.
    pub fn size(&self) -> [u32; 2] {
        self.targets.size
    }

    /// Mirrored views that the last frame drew.
    pub fn mirrored_views(&self) -> usize {
        let drawn = self.mirror.as_ref().map_or(0, MirrorPasses::views_drawn);
        if self.scene.specular() { drawn } else { 0 }
    }

    /// Passes that the last frame recorded for what is polished: none where it shows nothing that reflects.
    pub fn mirror_passes(&self) -> usize {
        let recorded = self.mirror.as_ref().map_or(0, MirrorPasses::passes);
        if self.scene.specular() { recorded } else { 0 }
    }

    /// Whether there are passes for what is polished, with all they need.
    pub fn has_mirror_passes(&self) -> bool {
        self.mirror.is_some()
    }

    /// Bytes of the layers and of what mirrored rays need beside them.
    pub fn layer_bytes(&self) -> u64 {
        self.targets.layers.size()
    }

    /// Frames in the running mean.
    pub fn accumulated(&self) -> u32 {
        self.accumulated
    }

    fn bind(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) {
        [self.visibility_group, self.shade_group, self.composite_group] = groups(
            device,
            [&self.visibility_layout, &self.shade_layout, &self.composite_layout],
            [&self.frame, &self.composite_settings, &self.false_colour],
            &self.targets,
            self.scene.triangles(),
        );
        if let Some(mirror) = &mut self.mirror {
            mirror.bind(device, queue, &self.frame, &self.targets);
        }
    }

    fn record_visibility(&self, encoder: &mut wgpu::CommandEncoder, settings: &FrameSettings) {
        let [width, height] = settings.size.map(|n| n as f32);
        let eye = Eye::new(&settings.camera, width / height);
        let portal = Portal::new(&eye, Rectangle::ALL, Portal::margin(settings.size));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("visibility"),
            color_attachments: &[Some(clearing(&self.targets.triangles_view))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth_view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.scene.raster_group, &[]);
        pass.set_bind_group(1, &self.visibility_group, &[]);
        self.scene.draw(&mut pass, self.visibility.each_ref(), &portal, 0);
    }

    fn record_shading(&self, encoder: &mut wgpu::CommandEncoder, direct: DirectQuality) {
        let mut pass = encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("shade"), ..Default::default() });
        pass.set_pipeline(match direct {
            DirectQuality::Elements => &self.shade.elements[usize::from(self.scene.is_general())],
            DirectQuality::PerPixel(_) => &self.shade.per_pixel,
        });
        pass.set_bind_group(0, &self.scene.group, &[]);
        pass.set_bind_group(1, &self.shade_group, &[]);
        let [width, height] = self.targets.size;
        pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
    }

    fn record_composite(&self, encoder: &mut wgpu::CommandEncoder, plain: bool) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("composite"),
            color_attachments: &[Some(clearing(&self.targets.output_view))],
            ..Default::default()
        });
        pass.set_pipeline(if plain { &self.composite_plain } else { &self.composite });
        pass.set_bind_group(0, &self.composite_group, &[]);
        pass.draw(0..3, 0..1);
    }
}
