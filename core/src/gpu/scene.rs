//! A solution in storage buffers, and what to send when it changes.
//!
//! Every new solution shares what did not change with the one before it; sharing is what is
//! compared. A dragged object costs its own corners, a dragged lamp the light of the elements.

use super::{
    device::GpuError,
    indices::shared_corners,
    shaders::Needs,
    storage::{Binding, Storage, bind, layout},
    tables,
};
use crate::{
    glossy::{
        environment::MapOwner,
        pass::{Lobes, lobes},
    },
    mirror::{
        culling::{Blocks, Portal},
        in_sight::{Bent, without_view},
        reflectors::Reflectors,
        views::{Eye, MirroredView, Rectangle},
    },
    radiosity::lookup::SideMap,
    scene::{geometry::Geometry, material::Material},
    superposition::moved::MovedLight,
    transport::LightTransportSolution,
};
use std::sync::Arc;

const LABELS: [&str; 15] = [
    "corners",
    "triangles",
    "materials",
    "objects",
    "textures",
    "texels",
    "nodes",
    "tree triangles",
    "trees",
    "emitters",
    "emitter triangles",
    "sides",
    "element light",
    "moved light",
    "environments",
];

/// Names of the buffers: their binding numbers in group 0.
#[derive(Clone, Copy)]
enum Table {
    Corners,
    Triangles,
    Materials,
    Objects,
    Textures,
    Texels,
    Nodes,
    TreeTriangles,
    Trees,
    Emitters,
    EmitterTriangles,
    Sides,
    ElementLight,
    MovedLight,
    Environments,
}

/// Tables that `shaders/shared/scene.wgsl` names: corners to texels.
const SURFACE_TABLES: usize = 6;

/// A solution on the device.
pub(crate) struct SceneTables {
    storage: [Storage; 15],
    last: Option<LightTransportSolution>,
    reflectors: Reflectors,
    bent: Bent,
    lobes: Lobes,
    blocks: Blocks,
    indices: wgpu::Buffer,
    /// Particles on glossy surfaces, as [`SplatMap::table`](crate::glossy::particles::splat::SplatMap::table) has them.
    pub(crate) particles: Storage,
    general: bool,
    /// Whether what a view cannot show is left out.
    pub(crate) culling: bool,
    /// Layout of all tables, for shading.
    pub(crate) layout: wgpu::BindGroupLayout,
    /// Layout of corners, triangles and materials, for rasterising.
    pub(crate) raster_layout: wgpu::BindGroupLayout,
    /// Layout of what a surface and its material need, for compute passes.
    pub(crate) surface_layout: wgpu::BindGroupLayout,
    /// All tables.
    pub(crate) group: wgpu::BindGroup,
    /// Corners, triangles and materials.
    pub(crate) raster_group: wgpu::BindGroup,
    /// What a surface and its material need.
    pub(crate) surface_group: wgpu::BindGroup,
    /// Numbers of emitters and trees.
    pub(crate) counts: [u32; 2],
}

impl SceneTables {
    /// No scene.
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let storage: [Storage; 15] = std::array::from_fn(|i| Storage::new(device, LABELS[i]));
        let all: Vec<_> = (0..15).map(|i| (i, Binding::Table)).collect();
        let layout_all = layout(device, "scene", wgpu::ShaderStages::COMPUTE, &all);
        let raster_layout = layout(device, "raster", wgpu::ShaderStages::VERTEX_FRAGMENT, &all[..3]);
        let surface_layout = layout(device, "surfaces", wgpu::ShaderStages::COMPUTE, &all[..SURFACE_TABLES]);
        let surface_group = self::group(device, &surface_layout, &storage[..SURFACE_TABLES]);
        let group = group(device, &layout_all, &storage);
        let raster_group = self::group(device, &raster_layout, &storage[..3]);
        Self {
            storage,
            last: None,
            surface_layout,
            surface_group,
            lobes: Lobes::default(),
            reflectors: Reflectors::default(),
            bent: Bent::default(),
            blocks: Blocks::default(),
            indices: index_buffer(device, &[]),
            particles: Storage::new(device, "particles"),
            general: true,
            culling: true,
            layout: layout_all,
            raster_layout,
            group,
            raster_group,
            counts: [0; 2],
        }
    }

    /// Draws the triangles that may show in a view, the single-sided and the double-sided ones by pipelines of
    /// their own.
    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass,
        pipelines: [&wgpu::RenderPipeline; 2],
        portal: &Portal,
        instance: u32,
    ) {
        let open = Portal::OPEN;
        let seen = self.blocks.seen(if self.culling { portal } else { &open });
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (pipeline, ranges) in pipelines.into_iter().zip(seen).filter(|(_, r)| !r.is_empty()) {
            pass.set_pipeline(pipeline);
            for triangles in ranges {
                pass.draw_indexed(3 * triangles.start..3 * triangles.end, 0, instance..instance + 1);
            }
        }
    }

    /// Whether anything stands elsewhere than where its light was solved, a material has two pictures, or a
    /// curved reflector a map.
    pub(crate) fn is_general(&self) -> bool {
        self.general
    }

    /// Bytes of the tables that are shown, without those that rays are traced with.
    pub(crate) fn shown_bytes(&self) -> u64 {
        let shown = [Table::Sides, Table::ElementLight, Table::MovedLight, Table::Environments];
        let tables = (0..SURFACE_TABLES).chain(shown.map(|t| t as usize));
        self.indices.size() + tables.map(|t| self.storage[t].buffer().size()).sum::<u64>()
    }

    /// The solution on the device.
    pub(crate) fn solution(&self) -> Option<&LightTransportSolution> {
        self.last.as_ref()
    }

    /// What it needs of the programs that shade.
    pub(crate) fn needs(&self) -> Needs {
        let needs = |s: &LightTransportSolution| Needs { lookup: s.lookup(), glass: s.world.glass };
        self.last.as_ref().map_or(Needs::default(), needs)
    }

    /// Its flat reflectors.
    pub(crate) fn reflectors(&self) -> &Reflectors {
        &self.reflectors
    }

    /// Whether a picture may show something polished that none of its views stands for.
    pub(crate) fn shows_without_view(&self, views: &[MirroredView], eye: &Eye, size: [u32; 2]) -> bool {
        let portal = Portal::new(eye, Rectangle::ALL, Portal::margin(size));
        self.last.as_ref().is_some_and(|solution| {
            let scene = (&solution.world.geometry, &self.reflectors, &self.bent);
            without_view(scene, views, (eye.position, &portal))
        })
    }

    /// Lobes of the glossy ones.
    pub(crate) fn lobes(&self) -> &Lobes {
        &self.lobes
    }

    /// Whether anything has a specular lobe.
    pub(crate) fn specular(&self) -> bool {
        self.last.as_ref().is_some_and(|s| s.world.geometry.is_specular())
    }

    /// Material and object of each triangle.
    pub(crate) fn triangles(&self) -> &wgpu::Buffer {
        self.storage[Table::Triangles as usize].buffer()
    }

    /// Takes over a solution and the light on its moved objects, both its parts; says whether buffers were
    /// made anew.
    ///
    /// # Errors
    /// [`GpuError::TooSmall`] where a table does not fit the device, [`GpuError::TooDeep`] where the shaders
    /// cannot follow a tree; then nothing is shown.
    pub(crate) fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        solution: &LightTransportSolution,
        moved: &MovedLight,
    ) -> Result<bool, GpuError> {
        let last = self.last.take();
        let known = last.as_ref().filter(|last| same_structure(last, solution));
        let (world, radiosity, environments) = (&solution.world, &solution.radiosity, &solution.environments);
        let geometry = &world.geometry;
        let mut renewed = false;
        let reflectors = Reflectors::new(geometry);
        let mut write = Writer { storage: &mut self.storage, device, queue, renewed: &mut renewed };
        match known {
            Some(last) => {
                // Materials may have become polished or dull.
                if reflectors != self.reflectors || mapped(last) != mapped(solution) {
                    write.table(Table::Triangles, &tables::triangles(geometry, &reflectors, environments))?;
                }
                for (object, range) in geometry.object_triangles.iter().enumerate() {
                    if geometry.world_from_object[object] != last.world.geometry.world_from_object[object] {
                        self.blocks.moved(geometry, object);
                        let corners = tables::corners(geometry, range.clone());
                        write.storage[Table::Corners as usize].patch(
                            queue,
                            3 * range.start as usize,
                            &corners,
                        );
                    }
                }
            }
            None => {
                self.blocks = Blocks::new(geometry);
                self.indices = index_buffer(device, &shared_corners(geometry));
                write.table(Table::Corners, &tables::corners(geometry, 0..geometry.len() as u32))?;
                write.table(Table::Triangles, &tables::triangles(geometry, &reflectors, environments))?;
                let (infos, texels) = tables::textures(geometry.textures.iter().map(|t| &**t));
                write.table(Table::Textures, &infos)?;
                write.table(Table::Texels, &texels)?;
                let (nodes, triangles) = tables::tree_nodes(&world.accel);
                for tree in tables::trees(&world.accel).iter().filter(|t| t.node_count > 0) {
                    tables::check_levels(&nodes, tree.root)?;
                }
                write.table(Table::Nodes, &nodes)?;
                write.table(Table::TreeTriangles, &triangles)?;
            }
        }
        let trees = tables::trees(&world.accel);
        write.table(Table::Trees, &trees)?;
        write.table(Table::Materials, &tables::materials(geometry))?;
        let (emitters, emitter_triangles) = tables::emitters(&world.emitters);
        write.table(Table::Emitters, &emitters)?;
        write.table(Table::EmitterTriangles, &emitter_triangles)?;
        write.table(Table::Objects, &tables::objects(geometry, moved))?;
        write.table(Table::MovedLight, &tables::moved_light(moved))?;
        let two_pictures = |m: &Material| m.reflectance_texture.is_some() && m.emission_texture.is_some();
        self.general = !moved.first.is_empty()
            || !solution.environments.list.is_empty()
            || geometry.materials.iter().any(two_pictures);
        if known.is_none_or(|last| last.radiosity.sides().as_ptr() != radiosity.sides().as_ptr()) {
            // Guests have no elements; before the first solution nothing has.
            let mut sides = radiosity.sides().to_vec();
            sides.resize(2 * geometry.len(), SideMap::NONE);
            write.table(Table::Sides, &sides)?;
        }
        if known.is_none_or(|last| !Arc::ptr_eq(&last.radiosity, radiosity)) {
            write.table(Table::ElementLight, &tables::element_light(radiosity))?;
        }
        if known.is_none_or(|last| !Arc::ptr_eq(&last.environments, environments)) {
            write.table(Table::Environments, &tables::environments(environments))?;
        }
        if let Some(light) = solution.particle_light()
            && !known.and_then(|last| last.particle_light()).is_some_and(|last| Arc::ptr_eq(last, light))
        {
            self.particles.write(device, queue, &light.map.table())?;
        }
        self.counts = [emitters.len() as u32, trees.len() as u32];
        if renewed {
            self.group = group(device, &self.layout, &self.storage);
            self.raster_group = group(device, &self.raster_layout, &self.storage[..3]);
            self.surface_group = group(device, &self.surface_layout, &self.storage[..SURFACE_TABLES]);
        }
        self.lobes = lobes(world, &reflectors, &self.lobes);
        self.bent = Bent::new(geometry, &reflectors);
        self.reflectors = reflectors;
        // Held so that what its pointers name cannot be freed and reused.
        self.last = Some(solution.clone());
        Ok(renewed)
    }
}

fn index_buffer(device: &wgpu::Device, indices: &[u32]) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(indices);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("shared corners"),
        size: (bytes.len() as u64).max(4),
        usage: wgpu::BufferUsages::INDEX,
        mapped_at_creation: true,
    });
    if !bytes.is_empty()
        && let Ok(mut mapped) = buffer.get_mapped_range_mut(..)
    {
        mapped.copy_from_slice(bytes);
    }
    buffer.unmap();
    buffer
}

struct Writer<'a> {
    storage: &'a mut [Storage; 15],
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
    renewed: &'a mut bool,
}

impl Writer<'_> {
    fn table<T: bytemuck::Pod>(&mut self, table: Table, values: &[T]) -> Result<(), GpuError> {
        *self.renewed |= self.storage[table as usize].write(self.device, self.queue, values)?;
        Ok(())
    }
}

fn group(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, storage: &[Storage]) -> wgpu::BindGroup {
    let resources: Vec<_> =
        storage.iter().enumerate().map(|(i, s)| (i as u32, s.buffer().as_entire_binding())).collect();
    bind(device, "scene", layout, &resources)
}

/// What has environment maps.
fn mapped(solution: &LightTransportSolution) -> Vec<MapOwner> {
    solution.environments.list.iter().map(|e| e.of).collect()
}

/// Whether two solutions differ only in placements of movable objects, materials' values and light.
fn same_structure(a: &LightTransportSolution, b: &LightTransportSolution) -> bool {
    if Arc::ptr_eq(&a.world, &b.world) {
        return true;
    }
    let (g, h): (&Geometry, &Geometry) = (&a.world.geometry, &b.world.geometry);
    let meshes = a.scene.meshes.len() == b.scene.meshes.len()
        && a.scene.meshes.iter().zip(&b.scene.meshes).all(|(a, b)| Arc::ptr_eq(a, b))
        && a.scene.objects.len() == b.scene.objects.len()
        && a.scene.objects.iter().zip(&b.scene.objects).all(|(a, b)| a.parts == b.parts);
    let textures = g.textures.len() == h.textures.len()
        && g.textures.iter().zip(&h.textures).all(|(a, b)| Arc::ptr_eq(a, b));
    let still = g.movable == h.movable
        && (0..g.movable.len()).all(|i| g.movable[i] || g.world_from_object[i] == h.world_from_object[i]);
    let built = a.world.accel.trees().map(|t| t.world_from_object_built).eq(b
        .world
        .accel
        .trees()
        .map(|t| t.world_from_object_built));
    let guests = a.guests.len() == b.guests.len()
        && a.guests.iter().zip(b.guests.iter()).all(|(a, b)| {
            a.object == b.object
                && a.meshes.len() == b.meshes.len()
                && a.meshes.iter().zip(&b.meshes).all(|(a, b)| Arc::ptr_eq(a, b))
        });
    meshes && textures && still && built && guests && g.len() == h.len()
}
