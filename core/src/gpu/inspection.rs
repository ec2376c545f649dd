//! What a view shows, over the picture: spheres, meshes, lines. Twin of [`crate::superposition::overlay`].

use super::{
    device::GpuError,
    frame::FalseColourTable,
    pipelines::{Raster, render_pipeline},
    shaders,
    storage::{Binding, Storage, bind, layout, uniform},
    targets::Targets,
};
use crate::{
    inspection::{ColouredMesh, InspectionScene},
    math::{
        colour::srgb8,
        false_colour::{FalseColour, Palette},
    },
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayon::prelude::*;

/// `Sphere` of `shaders/superposition/inspection.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Sphere {
    /// Centre, m.
    pub centre: Vec3,
    /// Radius, m.
    pub radius: f32,
    /// First of its bins.
    pub first_bin: u32,
    /// Nothing.
    pub padding: [u32; 3],
}

/// `LineInfo` of `shaders/superposition/inspection.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LineInfo {
    /// One end, m.
    pub a: Vec3,
    /// Nothing.
    pub padding_0: u32,
    /// The other, m.
    pub b: Vec3,
    /// Nothing.
    pub padding_1: u32,
    /// Linear display colour.
    pub colour: Vec3,
    /// Share of it in the picture.
    pub opacity: f32,
}

/// `MeshCorner` of `shaders/superposition/inspection.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct MeshCorner {
    /// Place, m.
    pub position: Vec3,
    /// Share of its colour in the picture.
    pub opacity: f32,
    /// Value.
    pub value: Vec3,
    /// Nothing.
    pub padding: u32,
}

/// `InspectionSettings` of `shaders/superposition/inspection.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct InspectionSettings {
    /// Rows of bins a hemisphere.
    pub bins: u32,
    /// Whether the shader encodes sRGB.
    pub encode: u32,
    /// Whether every channel is scaled by itself.
    pub natural: u32,
    /// Nothing.
    pub padding: u32,
}

/// Buffers and pipelines of the inspection passes.
pub(super) struct Inspection {
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    frame: wgpu::Buffer,
    false_colour: wgpu::Buffer,
    settings: wgpu::Buffer,
    /// Spheres, colours of bins, lines, mesh corners.
    storage: [Storage; 4],
    spheres: wgpu::RenderPipeline,
    meshes: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    /// Spheres, mesh vertices, lines.
    counts: [u32; 3],
    encode: bool,
}

impl Inspection {
    /// Nothing to show.
    pub(super) fn new(device: &wgpu::Device, frame: &wgpu::Buffer, format: wgpu::TextureFormat) -> Self {
        use Binding::{Table, Uniform};
        let layout = layout(
            device,
            "inspection",
            wgpu::ShaderStages::VERTEX_FRAGMENT,
            &[(0, Uniform), (1, Uniform), (2, Uniform), (3, Table), (4, Table), (5, Table), (6, Table)],
        );
        let module = shaders::INSPECTION.module(device);
        let pipeline = |entries| {
            let raster = Raster { blend: true, ..Raster::NEAREST };
            render_pipeline(device, &module, entries, &[&layout], format, raster)
        };
        let false_colour = uniform::<FalseColourTable>(device, "inspection colour");
        let settings = uniform::<InspectionSettings>(device, "inspection settings");
        let storage = ["spheres", "bins", "lines", "mesh"].map(|label| Storage::new(device, label));
        Self {
            spheres: pipeline(["sphere_rectangle", "sphere_bins"]),
            meshes: pipeline(["mesh_vertex", "mesh_colour"]),
            lines: pipeline(["line_rectangle", "line_colour"]),
            group: group(device, &layout, [frame, &false_colour, &settings], &storage),
            layout,
            frame: frame.clone(),
            false_colour,
            settings,
            storage,
            counts: [0; 3],
            encode: !format.is_srgb(),
        }
    }

    /// Takes over what to show.
    pub(super) fn set(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: Option<&InspectionScene>,
        colour: &FalseColour,
    ) -> Result<(), GpuError> {
        self.counts = [0; 3];
        let Some(scene) = scene else { return Ok(()) };
        let spheres: Vec<Sphere> = scene
            .spheres
            .iter()
            .filter(|_| scene.bins.is_some())
            .map(|s| Sphere { centre: s.centre, radius: s.radius, first_bin: s.first_bin, padding: [0; 3] })
            .collect();
        let encoded = |v: &Vec3| {
            let [r, g, b] = srgb8(colour.colour_of(*v));
            u32::from_le_bytes([r, g, b, 255])
        };
        let bins: Vec<u32> = scene.sphere_bins.par_iter().map(encoded).collect();
        let line = |[a, b]: [Vec3; 2], colour, opacity| LineInfo {
            a,
            b,
            colour,
            opacity,
            padding_0: 0,
            padding_1: 0,
        };
        let plain = scene.lines.iter().map(|l| line(l.ends, l.colour, 1.0));
        let valued =
            scene.value_lines.iter().map(|l| line(l.ends, colour.colour(l.value), 1.0 - l.transparency));
        let lines: Vec<LineInfo> = plain.chain(valued).collect();
        let corners = |m: &ColouredMesh| {
            let corner = |i: &u32| MeshCorner {
                position: m.positions[*i as usize],
                opacity: 1.0 - m.transparency,
                value: m.values[*i as usize],
                padding: 0,
            };
            m.triangles.iter().flatten().map(corner).collect::<Vec<_>>()
        };
        let mesh: Vec<MeshCorner> = scene.meshes.iter().flat_map(corners).collect();
        let mut renewed = self.storage[0].write(device, queue, &spheres)?;
        renewed |= self.storage[1].write(device, queue, &bins)?;
        renewed |= self.storage[2].write(device, queue, &lines)?;
        renewed |= self.storage[3].write(device, queue, &mesh)?;
        if renewed {
            let uniforms = [&self.frame, &self.false_colour, &self.settings];
            self.group = group(device, &self.layout, uniforms, &self.storage);
        }
        let settings = InspectionSettings {
            bins: scene.bins.map_or(1, |b| b.n()),
            encode: self.encode.into(),
            natural: (colour.palette == Palette::Natural).into(),
            padding: 0,
        };
        queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
        queue.write_buffer(&self.false_colour, 0, bytemuck::bytes_of(&FalseColourTable::new(colour)));
        self.counts = [spheres.len() as u32, mesh.len() as u32, lines.len() as u32];
        Ok(())
    }

    /// Draws it over the output, behind what is nearer.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets) {
        if self.counts == [0; 3] {
            return;
        }
        let keep = wgpu::StoreOp::Store;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("inspection"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &targets.output_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: keep },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth_view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.group, &[]);
        let [spheres, vertices, lines] = self.counts;
        pass.set_pipeline(&self.spheres);
        pass.draw(0..6, 0..spheres);
        pass.set_pipeline(&self.meshes);
        pass.draw(0..vertices, 0..1);
        pass.set_pipeline(&self.lines);
        pass.draw(0..6, 0..lines);
    }
}

fn group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    uniforms: [&wgpu::Buffer; 3],
    storage: &[Storage; 4],
) -> wgpu::BindGroup {
    let buffers = uniforms.into_iter().chain(storage.iter().map(Storage::buffer));
    let resources: Vec<_> = buffers.enumerate().map(|(i, b)| (i as u32, b.as_entire_binding())).collect();
    bind(device, "inspection", layout, &resources)
}
