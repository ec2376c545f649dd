//! Convolution on the GPU, by a kernel a pixel or one a reflector: twin of [`super::variant`] and of
//! [`super::invariant`].
//!
//! The pyramid is built in compute passes, a level each, and read in one. It stands between the passes that
//! follow mirrored rays and the one that puts them into the layers ([`crate::mirror::gpu`]).

use super::{
    GlossyMethod,
    invariant::WIDEST,
    lobes::ANGLES,
    pass::{Lobes, MOST_LOBES, key},
    pyramid::{MOST_LEVELS, level_size},
};
use crate::{
    gpu::{
        pipelines::compute_pipeline,
        scene::SceneTables,
        shaders,
        storage::{Binding, bind, create, layout, uniform},
        targets::Targets,
    },
    mirror::{
        MOST_VIEWS,
        views::{Eye, MirroredView},
    },
};
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

/// `Texel` of `shaders/glossy/pyramid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct TexelInfo {
    /// Mean radiance that arrives, cd/m².
    pub radiance: glam::Vec3,
    /// 1 over the distance from the eye, 1/m.
    pub nearness: f32,
    /// Share of its pixels that show the reflector.
    pub coverage: f32,
    /// The reflector.
    pub reflector: u32,
    /// Nothing.
    pub padding: [u32; 2],
}

/// `LevelInfo` of `shaders/glossy/pyramid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct LevelInfo {
    /// Its first texel.
    pub first: u32,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Its first column and row in the level of the whole picture.
    pub column: u32,
    /// See `column`.
    pub row: u32,
    /// Nothing.
    pub padding: [u32; 3],
}

/// `LobeTables` of `shaders/glossy/lobes.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LobeTables {
    /// [`crate::scene::brdf::Lobe::parameters`] of each lobe in x and y.
    pub parameters: [Vec4; MOST_LOBES],
    /// Albedo, cosine for the coat, cosine for the metal, support: by lobe, then by cos θ.
    pub entries: [Vec4; MOST_LOBES * ANGLES],
    /// Lobes there are.
    pub count: u32,
    /// Nothing.
    pub padding: [u32; 3],
}

impl LobeTables {
    /// The tables of some lobes.
    pub fn new(lobes: &Lobes) -> Self {
        let mut tables = Self { count: lobes.len().min(MOST_LOBES) as u32, ..Self::zeroed() };
        for (i, lobe) in lobes.values().take(MOST_LOBES).enumerate() {
            let [alpha, exponent] = lobe.lobe.parameters();
            tables.parameters[i] = Vec4::new(alpha, exponent, 0.0, 0.0);
            for (k, e) in lobe.entries.iter().enumerate() {
                tables.entries[i * ANGLES + k] =
                    Vec4::new(e.albedo, e.coat_cosine, e.metal_cosine, e.support);
            }
        }
        tables
    }
}

/// Weights of a kernel, at most.
const MOST_WEIGHTS: usize = ((2 * WIDEST + 1) * (2 * WIDEST + 1)) as usize;

/// `MeasuredReflector` of `shaders/glossy/invariant.wgsl`: a glossy reflector that is seen.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct MeasuredReflector {
    /// Its normal on the side seen.
    pub normal: glam::Vec3,
    /// Height of its plane above the eye along that, m.
    pub height: f32,
    /// The pixels around it: first column and row, width and height.
    pub rectangle: [u32; 4],
    /// Its number.
    pub reflector: u32,
    /// That of its lobe.
    pub lobe: u32,
    /// Nothing.
    pub padding: [u32; 2],
}

impl MeasuredReflector {
    /// What a view of depth 1 shows, within its pixels; `None` where its lobe is not among those that are told apart.
    pub(crate) fn new(
        scene: &SceneTables,
        view: &MirroredView,
        eye: &Eye,
        rectangle: [u32; 4],
    ) -> Option<Self> {
        let material = scene.reflectors().list[view.reflector as usize].material;
        let own = key(scene.solution()?.world.geometry.materials[material as usize].lobe()?);
        let lobe = scene.lobes().keys().take(MOST_LOBES).position(|key| *key == own)?;
        Some(Self {
            normal: view.clip_normal,
            height: view.clip_offset - view.clip_normal.dot(eye.position),
            rectangle,
            reflector: view.reflector,
            lobe: lobe as u32,
            padding: [0; 2],
        })
    }
}

/// `MeasuredReflectors` of `shaders/glossy/invariant.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct MeasuredReflectors {
    /// The reflectors.
    pub list: [MeasuredReflector; MOST_VIEWS],
    /// How many there are.
    pub count: u32,
    /// Nothing.
    pub padding: [u32; 3],
}

/// `KernelInfo` of `shaders/glossy/invariant.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct KernelInfo {
    /// Level of the pyramid that its peak is summed on.
    pub level: u32,
    /// Radius of the peak: offsets go from −radius to radius.
    pub radius: u32,
    /// That of the rest on the next level; 0 where the peak is all.
    pub rest_radius: u32,
    /// Whether there is a kernel.
    pub known: u32,
    /// Weights of the peak, row-major, and of the rest.
    pub weights: [[f32; MOST_WEIGHTS]; 2],
}

/// Passes of the glossy layer.
pub(crate) struct GlossyPasses {
    lobes: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    unfold: wgpu::ComputePipeline,
    halve: wgpu::ComputePipeline,
    scatter: wgpu::ComputePipeline,
    measure: wgpu::ComputePipeline,
    convolve: wgpu::ComputePipeline,
    scatter_invariant: wgpu::ComputePipeline,
    scatter_nodes: wgpu::ComputePipeline,
    scatter_half: wgpu::ComputePipeline,
    measured: wgpu::Buffer,
    kernels: wgpu::Buffer,
    sized: Sized,
}

/// What depends on the size of the picture.
struct Sized {
    size: [u32; 2],
    info: wgpu::Buffer,
    /// One a level: they differ in the level that is written.
    groups: Vec<wgpu::BindGroup>,
}

impl GlossyPasses {
    /// Builds the pipelines.
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &SceneTables,
        frame: &wgpu::Buffer,
        targets: &Targets,
    ) -> Self {
        use Binding::{Texture, Uniform, Written};
        let layout = layout(
            device,
            "glossy",
            wgpu::ShaderStages::COMPUTE,
            &[
                (0, Uniform),
                (1, Texture),
                (2, Written),
                (3, Uniform),
                (4, Written),
                (5, Uniform),
                (6, Uniform),
                (7, Uniform),
                (8, Written),
                (9, Written),
            ],
        );
        let module = shaders::GLOSSY.module(device);
        let compute = |entry| compute_pipeline(device, &module, entry, &[&scene.surface_layout, &layout]);
        let lobes = uniform::<LobeTables>(device, "lobes");
        let measured = uniform::<MeasuredReflectors>(device, "measured reflectors");
        let kernels = create(device, "kernels", (MOST_VIEWS * size_of::<KernelInfo>()) as u64);
        let sized = Sized::new(device, queue, &layout, [frame, &lobes, &measured, &kernels], targets);
        Self {
            unfold: compute("unfold"),
            halve: compute("halve"),
            scatter: compute("scatter"),
            measure: compute("measure"),
            convolve: compute("convolve"),
            scatter_invariant: compute("scatter_invariant"),
            scatter_nodes: compute("scatter_nodes"),
            scatter_half: compute("scatter_half"),
            lobes,
            layout,
            measured,
            kernels,
            sized,
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
        let tables = [frame, &self.lobes, &self.measured, &self.kernels];
        self.sized = Sized::new(device, queue, &self.layout, tables, targets);
    }

    /// Records the passes of one frame whose picture shows some glossy reflectors within a rectangle: its first column
    /// and row, width and height.
    pub(crate) fn record(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneTables,
        method: GlossyMethod,
        reflectors: &[MeasuredReflector],
        rectangle: [u32; 4],
    ) {
        let levels = levels(self.sized.size, rectangle);
        let mut table = [LevelInfo::default(); MOST_LEVELS];
        table[..levels.len()].copy_from_slice(&levels);
        queue.write_buffer(&self.sized.info, 0, bytemuck::cast_slice(&table));
        queue.write_buffer(&self.lobes, 0, bytemuck::bytes_of(&LobeTables::new(scene.lobes())));
        let mut run = |pipeline: &wgpu::ComputePipeline, level: usize, [x, y]: [u32; 2]| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("glossy"),
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &scene.surface_group, &[]);
            pass.set_bind_group(1, &self.sized.groups[level], &[]);
            pass.dispatch_workgroups(x, y, 1);
        };
        let blocks = |size: &LevelInfo| [size.width.div_ceil(8), size.height.div_ceil(8)];
        run(&self.unfold, 0, blocks(&levels[0]));
        for (level, size) in levels.iter().enumerate().skip(1) {
            run(&self.halve, level, blocks(size));
        }
        if method == GlossyMethod::VariantHalf && levels.len() > 1 {
            run(&self.scatter_nodes, 0, blocks(&levels[1]));
            run(&self.scatter_half, 0, blocks(&levels[0]));
            return;
        }
        if method != GlossyMethod::Invariant {
            run(&self.scatter, 0, blocks(&levels[0]));
            return;
        }
        let mut measured = MeasuredReflectors::zeroed();
        for (entry, reflector) in measured.list.iter_mut().zip(reflectors) {
            *entry = *reflector;
            measured.count += 1;
        }
        queue.write_buffer(&self.measured, 0, bytemuck::bytes_of(&measured));
        run(&self.measure, 0, [measured.count, 1]);
        // What is on coarse levels is read on the next finer ones.
        for (level, size) in levels.iter().enumerate().rev() {
            run(&self.convolve, level, blocks(size));
        }
        run(&self.scatter_invariant, 0, blocks(&levels[0]));
    }
}

/// The levels of a picture, as far as they have to do with the pixels of a rectangle: texels lie where those of the
/// whole picture lie.
fn levels(size: [u32; 2], [x, y, width, height]: [u32; 4]) -> Vec<LevelInfo> {
    let mut levels: Vec<LevelInfo> = Vec::new();
    let mut first = 0;
    for level in 0..MOST_LEVELS {
        let (column, row) = (x >> level, y >> level);
        let [right, below] = [x + width, y + height].map(|end| (end.max(1) - 1) >> level);
        let (width, height) = (right + 1 - column.min(right), below + 1 - row.min(below));
        levels.push(LevelInfo { first, width, height, column, row, padding: [0; 3] });
        first += width * height;
        if level_size(size, level).iter().all(|n| *n <= 1) {
            break;
        }
    }
    levels
}

impl Sized {
    fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layout: &wgpu::BindGroupLayout,
        [frame, lobes, measured, kernels]: [&wgpu::Buffer; 4],
        targets: &Targets,
    ) -> Self {
        let levels = levels(targets.size, [0, 0, targets.size[0], targets.size[1]]);
        let count: u32 = levels.iter().map(|l| l.width * l.height).sum();
        let of_texels = |label, size: usize| create(device, label, u64::from(count) * size as u64);
        let texels = of_texels("mirror image pyramid", size_of::<TexelInfo>());
        let convolved = of_texels("convolved pyramid", size_of::<Vec4>());
        let info = uniform::<[LevelInfo; MOST_LEVELS]>(device, "pyramid levels");
        let groups = (0..levels.len())
            .map(|level| {
                let step = uniform::<[u32; 4]>(device, "pyramid step");
                let words = [level as u32, levels.len() as u32, 0, 0];
                queue.write_buffer(&step, 0, bytemuck::cast_slice(&words));
                let seen = wgpu::BindingResource::TextureView(&targets.triangles_view);
                let resources = [
                    (0, frame.as_entire_binding()),
                    (1, seen),
                    (2, targets.layers.as_entire_binding()),
                    (3, lobes.as_entire_binding()),
                    (4, texels.as_entire_binding()),
                    (5, info.as_entire_binding()),
                    (6, step.as_entire_binding()),
                    (7, measured.as_entire_binding()),
                    (8, kernels.as_entire_binding()),
                    (9, convolved.as_entire_binding()),
                ];
                bind(device, "glossy", layout, &resources)
            })
            .collect();
        Self { size: targets.size, info, groups }
    }
}
