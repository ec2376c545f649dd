//! Mirrored views on the GPU: twin of [`super::pass`].
//!
//! All views of one depth share a raster pass and its depth buffer: a pixel follows one chain of mirrors,
//! so their masks never overlap. Each view is a mask written to the depth, then the blocks that its portal
//! shows, within the rectangle that its reflector covers.
//! Pipelines and textures are made when a scene first has something polished, and not before.

use super::{
    MirrorSettings,
    culling::Portal,
    images::gpu::{ImagePasses, Shared},
    pass::views_of,
    view_table::{ViewInfo, ViewTable},
    views::{Eye, MirroredView, NEAR, Rectangle},
    work::{List, RUN, Work},
};
use crate::glossy::{
    GlossyMethod,
    gpu::{GlossyPasses, MeasuredReflector},
    particles::gpu::ParticlePass,
};
use crate::gpu::{
    clock::{Stage, StageClock, mark},
    frame::FrameSettings,
    pipelines::{Raster, clearing, compute_variant, render_pipeline},
    scene::SceneTables,
    shaders,
    storage::{Binding, bind, layout, uniform},
    targets::{DEPTH_FORMAT, TRIANGLE_FORMAT, Targets, texture},
};
use crate::superposition::composite::DirectQuality;
use bytemuck::Zeroable;

/// Passes of the mirrored views.
pub struct MirrorPasses {
    views: wgpu::Buffer,
    raster_layout: wgpu::BindGroupLayout,
    follow_layout: wgpu::BindGroupLayout,
    mask: wgpu::RenderPipeline,
    visibility: wgpu::RenderPipeline,
    begin: wgpu::ComputePipeline,
    follow_per_pixel: wgpu::ComputePipeline,
    reflect: wgpu::ComputePipeline,
    /// For scenes as [`SceneTables::is_general`] says: not, and so.
    follow_elements: [wgpu::ComputePipeline; 2],
    reflect_wide: [wgpu::ComputePipeline; 2],
    canvas: Canvas,
    /// Passes of what is glossy, made when something first is.
    glossy: Option<GlossyPasses>,
    /// The pass that sums particles, made when what is glossy first is made of them.
    particles: Option<ParticlePass>,
    /// Passes of images-with-depth, made when mirrors are first shown from them.
    images: Option<ImagePasses>,
    views_drawn: usize,
    passes: usize,
    /// Whether the layers of what is specular are known to be black.
    black: bool,
}

/// What depends on the size of the picture.
struct Canvas {
    triangles: wgpu::TextureView,
    depth: wgpu::TextureView,
    raster_group: wgpu::BindGroup,
    work: Work,
    /// With the picture's own triangles.
    picture_group: wgpu::BindGroup,
    /// With those of the mirrored views, a list each.
    mirrored_groups: [wgpu::BindGroup; 4],
}

impl MirrorPasses {
    /// Builds the pipelines.
    pub(crate) fn new(
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        scene: &SceneTables,
        frame: &wgpu::Buffer,
        targets: &Targets,
    ) -> Self {
        use Binding::{Table, Texture, Uniform, Written};
        use wgpu::ShaderStages as Stages;
        let views = uniform::<ViewTable>(device, "mirrored views");
        let raster_layout = layout(
            device,
            "mirrored visibility",
            Stages::VERTEX_FRAGMENT,
            &[(0, Uniform), (2, Table), (3, Uniform)],
        );
        let follow_layout = layout(
            device,
            "mirror",
            Stages::COMPUTE,
            &[(0, Uniform), (1, Texture), (2, Written), (3, Uniform), (4, Written), (5, Uniform)],
        );
        let drawing = shaders::MIRROR_VISIBILITY.module(device);
        let draw = |entries, raster| {
            let groups = [&scene.raster_layout, &raster_layout];
            render_pipeline(device, &drawing, entries, &groups, TRIANGLE_FORMAT, raster)
        };
        let mask = Raster { depth: Some(wgpu::CompareFunction::Always), colour: false, ..Raster::NEAREST };
        let mask = draw(["cover", "mask"], mask);
        let visibility = draw(["project", "identify"], Raster::NEAREST);
        let module = shaders::MIRROR_FOLLOW.module(device);
        let variant = |entry, general| {
            let groups = [&scene.layout, &follow_layout];
            compute_variant(device, &module, entry, &groups, &shaders::constants(general, scene.needs()))
        };
        let compute = |entry| variant(entry, true);
        let begin = compute("begin");
        let reflect = compute("reflect_into_layers");
        let follow_per_pixel = compute("follow_per_pixel");
        let [follow_elements, reflect_wide] = ["follow_elements", "reflect_as_if_dull"]
            .map(|entry| [false, true].map(|general| variant(entry, general)));
        let canvas = Canvas::new((device, queue), [&raster_layout, &follow_layout], [frame, &views], targets);
        Self {
            views,
            raster_layout,
            follow_layout,
            mask,
            visibility,
            begin,
            follow_per_pixel,
            follow_elements,
            reflect,
            reflect_wide,
            canvas,
            glossy: None,
            particles: None,
            images: None,
            views_drawn: 0,
            passes: 0,
            black: false,
        }
    }

    /// Follows targets of another size.
    pub(crate) fn bind(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        frame: &wgpu::Buffer,
        targets: &Targets,
    ) {
        let layouts = [&self.raster_layout, &self.follow_layout];
        self.canvas = Canvas::new((device, queue), layouts, [frame, &self.views], targets);
        self.black = false;
        if let Some(glossy) = &mut self.glossy {
            glossy.bind(device, queue, frame, targets);
        }
    }

    /// Views of the last frame: a draw of the scene each.
    pub fn views_drawn(&self) -> usize {
        self.views_drawn
    }

    /// Passes that the last frame recorded, what is convolved counted as one.
    pub fn passes(&self) -> usize {
        self.passes
    }

    /// Records the passes of one frame, after those of the picture; none where it shows nothing that reflects.
    pub(crate) fn record(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneTables,
        (frame, targets): (&wgpu::Buffer, &Targets),
        settings: &FrameSettings,
        clock: &mut Option<StageClock>,
    ) {
        let Some(solution) = scene.solution() else { return };
        let [width, height] = targets.size;
        let eye = Eye::new(&settings.camera, width as f32 / height as f32);
        let plan = MirrorSettings::of(&solution.scene.plan);
        let views = views_of(solution, scene.reflectors(), eye);
        (self.views_drawn, self.passes) = (views.len(), 0);
        let (reflected, dull) = (!views.is_empty(), scene.shows_without_view(&views, &eye, targets.size));
        if !reflected && !dull {
            if !std::mem::replace(&mut self.black, true) {
                let layers = targets.specular_layers();
                encoder.clear_buffer(&targets.layers, layers.start, Some(layers.end - layers.start));
            }
            return;
        }
        self.black = false;
        let runs = plan.images.filter(|_| reflected).and_then(|_| {
            let images = self.images.get_or_insert_with(|| ImagePasses::new(device));
            images.choose((device, queue), solution, scene, &views, targets.size)
        });
        let near = NEAR * scene.reflectors().scene_size;
        let by_particles = solution.particle_light().is_some();
        let mut table = ViewTable {
            count: views.len() as u32,
            near,
            by_particles: by_particles.into(),
            ..ViewTable::zeroed()
        };
        for (entry, view) in table.list.iter_mut().zip(&views) {
            *entry = ViewInfo::new(view);
        }
        queue.write_buffer(&self.views, 0, bytemuck::bytes_of(&table));
        self.canvas.work.clear(encoder);
        let [width, height] = targets.size;
        let (across, down) = (width.div_ceil(RUN * 8), height.div_ceil(8));
        let groups = [&scene.group, &self.canvas.picture_group];
        compute(encoder, &self.begin, groups, |pass| pass.dispatch_workgroups(across, down, 1));
        self.passes += 1;
        mark(clock, encoder, Stage::MirroredShading);
        let follow = match settings.direct {
            DirectQuality::PerPixel(_) => &self.follow_per_pixel,
            DirectQuality::Elements => &self.follow_elements[usize::from(scene.is_general())],
        };
        for depth in 1..=views.last().map_or(0, |v| v.depth) {
            match runs {
                Some(runs) if depth == 1 => self.record_images(device, encoder, (frame, targets), runs),
                _ => self.record_depth(encoder, scene, targets.size, &views, depth),
            }
            mark(clock, encoder, Stage::MirroredVisibility);
            let list = List::Depth(depth);
            self.canvas.work.clear_list(encoder, List::Depth(depth + 1));
            let group = &self.canvas.mirrored_groups[list.number() as usize];
            self.work_off(encoder, follow, [&scene.group, group], list);
            self.passes += 2;
            mark(clock, encoder, Stage::MirroredShading);
        }
        let method = solution.glossy_of_image();
        if !scene.lobes().is_empty() && !views.is_empty() && method != GlossyMethod::Sharp {
            let glossy =
                self.glossy.get_or_insert_with(|| GlossyPasses::new(device, queue, scene, frame, targets));
            let measured = |v: &MirroredView| {
                let own = pixels(v.rectangle, targets.size);
                Some((MeasuredReflector::new(scene, v, &eye, own)?, v.rectangle))
            };
            let seen: Vec<_> = views.iter().take_while(|v| v.depth == 1).filter_map(measured).collect();
            let (reflectors, rectangles): (Vec<_>, Vec<_>) = seen.into_iter().unzip();
            if let Some(rectangle) = rectangles.into_iter().reduce(Rectangle::around) {
                let rectangle = pixels(rectangle, targets.size);
                glossy.record(queue, encoder, scene, method, &reflectors, rectangle);
                self.passes += 1;
            }
            mark(clock, encoder, Stage::Convolution);
        } else if scene.lobes().is_empty() || method == GlossyMethod::Sharp {
            self.glossy = None;
        }
        if reflected {
            self.work_off(encoder, &self.reflect, groups, List::Depth(1));
            self.passes += 1;
        }
        // What no image-with-depth has seen has no view either.
        if dull || runs.is_some() {
            let reflect_wide = &self.reflect_wide[usize::from(scene.is_general())];
            self.work_off(encoder, reflect_wide, groups, List::WithoutView);
            self.passes += 1;
        }
        mark(clock, encoder, Stage::Modulation);
        if by_particles {
            let pass = self.particles.get_or_insert_with(|| ParticlePass::new(device, scene));
            pass.record(device, encoder, scene, (frame, targets));
            self.passes += 1;
            mark(clock, encoder, Stage::Convolution);
        } else {
            self.particles = None;
        }
    }

    /// Shows the views of depth 1 from images-with-depth.
    fn record_images(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        (frame, targets): (&wgpu::Buffer, &Targets),
        runs: u32,
    ) {
        let Some(images) = &self.images else { return };
        let Canvas { work, triangles, .. } = &self.canvas;
        let dispatch = work.dispatch(encoder, List::Depth(1));
        let shared = Shared {
            frame,
            layers: &targets.layers,
            views: &self.views,
            lists: &work.lists,
            step: &work.steps[List::Depth(1).number() as usize],
            triangles,
        };
        images.record(device, encoder, &shared, runs, dispatch);
    }

    /// Draws every view of one depth.
    fn record_depth(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneTables,
        size: [u32; 2],
        views: &[MirroredView],
        depth: u32,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mirrored views"),
            color_attachments: &[Some(clearing(&self.canvas.triangles))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.canvas.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &scene.raster_group, &[]);
        pass.set_bind_group(1, &self.canvas.raster_group, &[]);
        for (i, view) in views.iter().enumerate().filter(|(_, v)| v.depth == depth) {
            let [x, y, width, height] = pixels(view.rectangle, size);
            pass.set_scissor_rect(x, y, width, height);
            pass.set_pipeline(&self.mask);
            pass.draw(0..3, i as u32..i as u32 + 1);
            let portal = Portal::of_view(view, Portal::margin(size));
            scene.draw(&mut pass, [&self.visibility; 2], &portal, i as u32);
        }
    }

    /// Runs a pipeline over the pixels of a list.
    fn work_off(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::ComputePipeline,
        groups: [&wgpu::BindGroup; 2],
        list: List,
    ) {
        let dispatch = self.canvas.work.dispatch(encoder, list);
        compute(encoder, pipeline, groups, |pass| pass.dispatch_workgroups_indirect(dispatch, 0));
    }
}

fn compute(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::ComputePipeline,
    groups: [&wgpu::BindGroup; 2],
    dispatch: impl FnOnce(&mut wgpu::ComputePass),
) {
    let mut pass = encoder
        .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("mirror"), ..Default::default() });
    pass.set_pipeline(pipeline);
    for (i, group) in groups.into_iter().enumerate() {
        pass.set_bind_group(i as u32, group, &[]);
    }
    dispatch(&mut pass);
}

/// First column and row, width and height of the pixels that a rectangle touches.
fn pixels(rectangle: Rectangle, [width, height]: [u32; 2]) -> [u32; 4] {
    let along = |low: f32, high: f32, size: u32| {
        let at = |v: f32| (0.5 * (v + 1.0) * size as f32).clamp(0.0, size as f32);
        // A pixel more on either side: jittered frames look through other places of their pixels.
        let first = (at(low).floor() as u32).saturating_sub(1);
        let last = (at(high).ceil() as u32 + 1).min(size);
        (first, last.saturating_sub(first))
    };
    let (x, w) = along(rectangle.low.x, rectangle.high.x, width);
    let (y, h) = along(-rectangle.high.y, -rectangle.low.y, height);
    [x, y, w, h]
}

impl Canvas {
    fn new(
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        [raster, follow]: [&wgpu::BindGroupLayout; 2],
        [frame, views]: [&wgpu::Buffer; 2],
        targets: &Targets,
    ) -> Self {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
        let seen = texture(device, "mirrored triangles", targets.size, TRIANGLE_FORMAT, usage);
        let depth =
            texture(device, "mirrored depth", targets.size, DEPTH_FORMAT, wgpu::TextureUsages::empty());
        let [triangles, depth] = [seen, depth].map(|t| t.create_view(&Default::default()));
        let (frame, views) = (frame.as_entire_binding(), views.as_entire_binding());
        let layers = targets.layers.as_entire_binding();
        let work = Work::new(device, queue, targets.size);
        let group = |seen: &wgpu::TextureView, step: &wgpu::Buffer| {
            let seen = wgpu::BindingResource::TextureView(seen);
            let resources = [
                (0, frame.clone()),
                (1, seen),
                (2, layers.clone()),
                (3, views.clone()),
                (4, work.lists.as_entire_binding()),
                (5, step.as_entire_binding()),
            ];
            bind(device, "mirror", follow, &resources)
        };
        let picture_group = group(&targets.triangles_view, &work.steps[0]);
        let mirrored_groups = work.steps.each_ref().map(|step| group(&triangles, step));
        let resources = [(0, frame.clone()), (2, layers.clone()), (3, views.clone())];
        let raster_group = bind(device, "mirrored visibility", raster, &resources);
        Self { triangles, depth, raster_group, work, picture_group, mirrored_groups }
    }
}
