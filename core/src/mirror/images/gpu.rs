//! Mirrored views from images-with-depth on the GPU: twin of [`super::reproject()`] with boxes.
//!
//! Images are on the device from when they are first shown; those that a move changes are sent again. Each frame the
//! processor chooses them and what of them may show, a table of runs of 64 points; the device splats these, and leaves
//! the triangle of each pixel's nearest point where the raster pass of a mirrored view would leave it. So everything
//! after is the same as from the geometry.

use super::{
    ImageWithDepth, MirrorImages, Selection,
    pass::in_use,
    visible::{LEAF, Run, Sight},
};
use crate::gpu::{
    device::GpuError,
    pipelines::compute_pipeline,
    scene::SceneTables,
    shaders,
    storage::{Binding, Storage, bind, create, layout},
};
use crate::mirror::{culling::Portal, views::MirroredView};
use crate::transport::LightTransportSolution;
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// `ImageInfo` of `shaders/mirror/splat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct ImageInfo {
    /// Centre of projection, m.
    pub eye: Vec3,
    /// Its first point.
    pub first: u32,
    /// Corner of the element, m.
    pub corner: Vec3,
    /// Width, pixels.
    pub resolution: u32,
    /// First edge, m.
    pub edge_u: Vec3,
    /// Nothing.
    pub padding_0: u32,
    /// Second edge, m.
    pub edge_v: Vec3,
    /// Nothing.
    pub padding_1: u32,
}

/// `ImagePoint` of `shaders/mirror/splat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct ImagePoint {
    /// Distance over that of the element.
    pub scale: f32,
    /// Triangle.
    pub triangle: u32,
}

/// `Run` of `shaders/mirror/splat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct RunInfo {
    /// Image.
    pub image: u32,
    /// First of its points.
    pub first: u32,
    /// How often squares of four were made one.
    pub level: u32,
    /// View, counted from 1.
    pub view: u32,
}

/// Workgroups in a row of a dispatch: `ROW` of the shader.
const ROW: u32 = 32_768;

/// What the passes of mirrors share with those of their images.
pub(crate) struct Shared<'a> {
    /// The frame's uniform.
    pub frame: &'a wgpu::Buffer,
    /// The layers.
    pub layers: &'a wgpu::Buffer,
    /// The mirrored views.
    pub views: &'a wgpu::Buffer,
    /// Lists of pixels.
    pub lists: &'a wgpu::Buffer,
    /// Number of the list of depth 1.
    pub step: &'a wgpu::Buffer,
    /// What is seen in the views.
    pub triangles: &'a wgpu::TextureView,
}

/// Images on the device, and the passes that show them.
pub(crate) struct ImagePasses {
    shown: Option<Arc<MirrorImages>>,
    images: Storage,
    points: Storage,
    runs: Storage,
    nearest: wgpu::Buffer,
    empty: wgpu::BindGroup,
    layout: wgpu::BindGroupLayout,
    distance: wgpu::ComputePipeline,
    number: wgpu::ComputePipeline,
    name: wgpu::ComputePipeline,
}

impl ImagePasses {
    /// Builds the pipelines.
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        use Binding::{Table, Uniform, Written, WrittenTexture};
        let bindings = [
            (0, Uniform),
            (1, WrittenTexture),
            (2, Written),
            (3, Uniform),
            (4, Written),
            (5, Uniform),
            (6, Table),
            (7, Table),
            (8, Table),
            (9, Written),
        ];
        let compute = wgpu::ShaderStages::COMPUTE;
        let (nothing, layout) =
            (layout(device, "nothing", compute, &[]), layout(device, "splat", compute, &bindings));
        let module = shaders::MIRROR_SPLAT.module(device);
        let pipeline = |entry| compute_pipeline(device, &module, entry, &[&nothing, &layout]);
        Self {
            shown: None,
            images: Storage::new(device, "images-with-depth"),
            points: Storage::new(device, "points"),
            runs: Storage::new(device, "runs of points"),
            nearest: create(device, "nearest points", 8),
            empty: bind(device, "nothing", &nothing, &[]),
            distance: pipeline("splat_distance"),
            number: pipeline("splat_number"),
            name: pipeline("name_triangles"),
            layout,
        }
    }

    /// Puts the images of a solution on the device, where they are others than there are.
    fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        images: &Arc<MirrorImages>,
    ) -> Result<(), GpuError> {
        if self.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(shown, images)) {
            return Ok(());
        }
        let list = |of: &MirrorImages| -> Vec<Arc<ImageWithDepth>> {
            of.sets.iter().flat_map(|set| set.elements.iter().flatten().cloned()).collect()
        };
        let (now, before) = (list(images), self.shown.take().map(|shown| list(&shown)));
        let mut first = 0;
        let info = |image: &Arc<ImageWithDepth>| {
            let info = ImageInfo {
                eye: image.eye,
                first,
                corner: image.corner,
                resolution: image.resolution,
                edge_u: image.edge_u,
                edge_v: image.edge_v,
                ..ImageInfo::default()
            };
            first += image.triangle.len() as u32;
            info
        };
        let infos: Vec<ImageInfo> = now.iter().map(info).collect();
        self.images.write(device, queue, &infos)?;
        let points = |image: &ImageWithDepth| -> Vec<ImagePoint> {
            let seen = image.scale.iter().zip(&image.triangle);
            seen.map(|(&scale, &triangle)| ImagePoint { scale, triangle }).collect()
        };
        let resolutions =
            |images: &[Arc<ImageWithDepth>]| images.iter().map(|i| i.resolution).collect::<Vec<_>>();
        match before.filter(|before| resolutions(before) == resolutions(&now)) {
            // What moved is seen by some.
            Some(before) => {
                let others = now
                    .iter()
                    .zip(&before)
                    .zip(&infos)
                    .filter(|((now, before), _)| !Arc::ptr_eq(now, before));
                for ((image, _), info) in others {
                    self.points.patch(queue, info.first as usize, &points(image));
                }
            }
            None => {
                let all: Vec<ImagePoint> = now.iter().flat_map(|image| points(image)).collect();
                self.points.write(device, queue, &all)?;
            }
        }
        self.shown = Some(images.clone());
        Ok(())
    }

    /// Chooses what stands for the views of depth 1 of a frame, and says how many runs of points that is; `None` where
    /// they are to be drawn from the geometry: as the plan has it, or the images do not fit the device.
    pub(crate) fn choose(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        solution: &LightTransportSolution,
        scene: &SceneTables,
        views: &[MirroredView],
        size: [u32; 2],
    ) -> Option<u32> {
        let (images, count) = in_use(solution)?;
        self.upload(device, queue, solution.mirror_images.as_ref()?).ok()?;
        let mut before = Vec::with_capacity(images.sets.len());
        let mut total = 0;
        for set in &images.sets {
            before.push(total);
            total += set.images().count() as u32;
        }
        let margin = Portal::margin(size);
        let of_view = |(number, view): (u32, &MirroredView)| {
            let reflector = &scene.reflectors().list[view.reflector as usize];
            let eye = view.eye.position;
            let Some(set) = images.of(reflector, eye) else { return Vec::new() };
            let of_set = images.sets.iter().position(|s| std::ptr::eq(s, set)).map_or(0, |i| before[i]);
            let sight =
                Sight { eye: &view.eye, portal: &Portal::of_view(view, margin), size: UVec2::from(size) };
            let chosen = Selection::Angle.nearest(set, eye, count);
            let info = |image: usize| {
                let image_number = of_set + image as u32;
                let as_info =
                    move |Run { first, level }| RunInfo { image: image_number, first, level, view: number };
                sight.runs(set.image(image)).into_iter().map(as_info)
            };
            chosen.into_iter().flat_map(info).collect()
        };
        let first: Vec<(u32, &MirroredView)> = (1..).zip(views).take_while(|(_, v)| v.depth == 1).collect();
        let chosen: Vec<Vec<RunInfo>> = first.into_par_iter().map(of_view).collect();
        let mut runs = vec![RunInfo::default()];
        runs.extend(chosen.into_iter().flatten());
        let found = runs.len() as u32 - 1;
        runs[0].image = found;
        self.runs.write(device, queue, &runs).ok()?;
        let bytes = 8 * u64::from(size[0]) * u64::from(size[1]);
        if self.nearest.size() != bytes {
            self.nearest = create(device, "nearest points", bytes);
        }
        Some(found)
    }

    /// Records the passes that show so many runs; `dispatch` is what to dispatch for the list of depth 1.
    pub(crate) fn record(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        shared: &Shared,
        runs: u32,
        dispatch: &wgpu::Buffer,
    ) {
        encoder.clear_buffer(&self.nearest, 0, None);
        let resources = [
            (0, shared.frame.as_entire_binding()),
            (1, wgpu::BindingResource::TextureView(shared.triangles)),
            (2, shared.layers.as_entire_binding()),
            (3, shared.views.as_entire_binding()),
            (4, shared.lists.as_entire_binding()),
            (5, shared.step.as_entire_binding()),
            (6, self.images.buffer().as_entire_binding()),
            (7, self.points.buffer().as_entire_binding()),
            (8, self.runs.buffer().as_entire_binding()),
            (9, self.nearest.as_entire_binding()),
        ];
        let group = bind(device, "splat", &self.layout, &resources);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("mirror images"),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.empty, &[]);
        pass.set_bind_group(1, &group, &[]);
        for pipeline in [&self.distance, &self.number] {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(runs.min(ROW), runs.div_ceil(ROW), 1);
        }
        pass.set_pipeline(&self.name);
        pass.dispatch_workgroups_indirect(dispatch, 0);
    }
}

const _: () = assert!(LEAF == 64, "a workgroup is a run");
