//! The scene as flat tables: the Rust sides of the structures in `shaders/shared/`.

use super::device::GpuError;
pub use super::emitters::{EmitterInfo, EmitterTriangle, emitters};
use crate::{
    glossy::environment::Environments,
    math::image::LinearImage,
    mirror::reflectors::Reflectors,
    radiosity::{RadiositySolution, surface_map::BURIED},
    scene::{
        accel::{Accel, TreeView},
        geometry::Geometry,
    },
    superposition::moved::MovedLight,
};
use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};
use std::ops::Range;

/// Index of nothing.
pub const NONE: u32 = u32::MAX;

/// `Corner` of `shaders/shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct Corner {
    /// Position, m.
    pub position: Vec3,
    /// First texture coordinate.
    pub u: f32,
    /// Shading normal.
    pub normal: Vec3,
    /// Second texture coordinate.
    pub v: f32,
}

/// `TriangleInfo` of `shaders/shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct TriangleInfo {
    /// Material.
    pub material: u32,
    /// Object.
    pub object: u32,
    /// Flat reflector it is part of, or [`NONE`].
    pub reflector: u32,
    /// Environment map of a curved reflector, or [`NONE`].
    pub environment: u32,
}

/// `ObjectInfo` of `shaders/shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct ObjectInfo {
    /// Factor on emission.
    pub dimmer: f32,
    /// Record of its first triangle in the moved light, or [`NONE`].
    pub moved_first: u32,
    /// First triangle.
    pub first_triangle: u32,
    /// 1 where direct light is always the stored one.
    pub stored_direct: u32,
}

/// `MaterialInfo` of `shaders/shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct MaterialInfo {
    /// Base colour.
    pub reflectance: Vec3,
    /// Its texture, or [`NONE`].
    pub reflectance_texture: u32,
    /// Emitted radiance, cd/m².
    pub emission: Vec3,
    /// Its texture, or [`NONE`].
    pub emission_texture: u32,
    /// Whether the back is lit.
    pub double_sided: u32,
    /// Share of the base colour that is Lambertian reflectance.
    pub diffuse_share: f32,
    /// Share of metal.
    pub metallic: f32,
    /// Normal reflectance of the coat of what is no metal.
    pub dielectric: f32,
    /// Width α of the specular lobe, 0 for an ideal mirror, negative for none.
    pub alpha: f32,
    /// Share of what is not reflected that goes on through it, beside its colour.
    pub passes: f32,
    /// Whether it bounds a solid, and is not a pane.
    pub solid: u32,
    /// Exponent of Phong's lobe, 0 of GGX.
    pub exponent: f32,
}

/// `TextureInfo` of `shaders/shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct TextureInfo {
    /// First texel.
    pub first: u32,
    /// Width, texels.
    pub width: u32,
    /// Height, texels.
    pub height: u32,
    /// Nothing.
    pub padding: u32,
}

/// `Node` of `shaders/shared/rays.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct Node {
    /// Smallest corner.
    pub low: Vec3,
    /// Triangles of a leaf, 0 for an inner node.
    pub count: u32,
    /// Largest corner.
    pub high: Vec3,
    /// First child or triangle, over all trees.
    pub first: u32,
}

/// `TreeTriangle` of `shaders/shared/rays.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct TreeTriangle {
    /// Corner 0.
    pub a: Vec3,
    /// Its number in the scene.
    pub number: u32,
    /// Corner 1.
    pub b: Vec3,
    /// Nothing.
    pub padding_0: u32,
    /// Corner 2.
    pub c: Vec3,
    /// Nothing.
    pub padding_1: u32,
}

/// `Tree` of `shaders/shared/rays.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct Tree {
    /// Rows of the placement it was built in, from world.
    pub rows: [Vec4; 3],
    /// Root.
    pub root: u32,
    /// Nodes.
    pub node_count: u32,
    /// Nothing.
    pub padding: [u32; 2],
}

/// `ElementLight` of `shaders/shared/elements.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct ElementLight {
    /// Direct irradiance, lx.
    pub direct: Vec3,
    /// 1 where the element is [`BURIED`].
    pub buried: u32,
    /// Indirect irradiance, lx.
    pub indirect: Vec3,
    /// Nothing.
    pub padding: u32,
}

/// Corners of a range of triangles, three each.
pub fn corners(geometry: &Geometry, range: Range<u32>) -> Vec<Corner> {
    range
        .flat_map(|t| {
            let t = t as usize;
            (0..3).map(move |i| Corner {
                position: geometry.positions[t][i],
                u: geometry.uvs[t][i].x,
                normal: geometry.normals[t][i],
                v: geometry.uvs[t][i].y,
            })
        })
        .collect()
}

/// Material, object and reflector of each triangle.
pub fn triangles(
    geometry: &Geometry,
    reflectors: &Reflectors,
    environments: &Environments,
) -> Vec<TriangleInfo> {
    geometry
        .material
        .iter()
        .zip(&geometry.object)
        .enumerate()
        .map(|(t, (&material, &object))| TriangleInfo {
            material,
            object,
            reflector: reflectors.of(t as u32),
            environment: environments.number(t as u32).unwrap_or(NONE),
        })
        .collect()
}

/// The environment maps: for each its middle and first texel, and its size; then the texels of all.
pub fn environments(environments: &Environments) -> Vec<Vec4> {
    let list = &environments.list;
    let mut first = 2 * list.len();
    let mut table = Vec::new();
    for map in list {
        // Whole numbers of so few texels are exact.
        table.push(map.centre.extend(first as f32));
        table.push(Vec4::new(map.size[0] as f32, map.size[1] as f32, 0.0, 0.0));
        first += map.texels.len();
    }
    table.extend(list.iter().flat_map(|map| &map.texels));
    table
}

/// The materials.
pub fn materials(geometry: &Geometry) -> Vec<MaterialInfo> {
    let index = |texture: Option<usize>| texture.map_or(NONE, |i| i as u32);
    geometry
        .materials
        .iter()
        .map(|m| MaterialInfo {
            reflectance: m.reflectance,
            reflectance_texture: index(m.reflectance_texture),
            emission: m.emission,
            emission_texture: index(m.emission_texture),
            double_sided: m.double_sided.into(),
            diffuse_share: m.diffuse_share(),
            metallic: m.metallic.clamp(0.0, 1.0),
            dielectric: m.coat_reflectance(),
            alpha: m.alpha().unwrap_or(-1.0),
            passes: m.passes(),
            solid: m.solid.into(),
            exponent: m.lobe().map_or(0.0, |lobe| lobe.parameters()[1]),
        })
        .collect()
}

/// The objects.
pub fn objects(geometry: &Geometry, moved: &MovedLight) -> Vec<ObjectInfo> {
    (0..geometry.object_triangles.len())
        .map(|i| ObjectInfo {
            dimmer: geometry.dimmer[i],
            moved_first: moved.first.get(&(i as u32)).copied().unwrap_or(NONE),
            first_triangle: geometry.object_triangles[i].start,
            stored_direct: moved.stored_direct.contains(&(i as u32)).into(),
        })
        .collect()
}

/// Light of the moved objects: a record a triangle (place of its first entry, steps of its lattice), then
/// four values an entry: front direct and indirect, back direct and indirect.
pub fn moved_light(moved: &MovedLight) -> Vec<Vec4> {
    let records = moved.lattices.len() as u32;
    // Whole numbers as floats, exact below 2²⁴: bits of an integer may be flushed as a denormal.
    let record =
        |&(first, steps): &(u32, u32)| Vec4::new((records + 4 * first) as f32, steps as f32, 0.0, 0.0);
    let entries = moved.entries.iter().flatten().flatten().map(|e| e.extend(0.0));
    moved.lattices.iter().map(record).chain(entries).collect()
}

/// Textures and all their texels, four halves each.
pub fn textures<'a>(images: impl Iterator<Item = &'a LinearImage>) -> (Vec<TextureInfo>, Vec<[u16; 4]>) {
    let (mut infos, mut texels) = (Vec::new(), Vec::new());
    for image in images {
        infos.push(TextureInfo {
            first: texels.len() as u32,
            width: image.width,
            height: image.height,
            padding: 0,
        });
        texels.extend(image.pixels.iter().map(|p| [half(p.x), half(p.y), half(p.z), 0]));
    }
    (infos, texels)
}

/// Bits of the half nearest to a value; beyond its range the largest, NaN becomes 0.
pub fn half(value: f32) -> u16 {
    let sign = ((value.to_bits() >> 16) & 0x8000) as u16;
    let magnitude = value.abs().min(65_504.0);
    if value.is_nan() {
        return 0;
    }
    if magnitude < 6.103_515_6e-5 {
        // Below the smallest normal half, in steps of 2⁻²⁴.
        return sign | (magnitude * 16_777_216.0).round_ties_even() as u16;
    }
    let bits = magnitude.to_bits();
    let rounded = bits + 0x0FFF + ((bits >> 13) & 1);
    sign | ((rounded >> 13) - (112 << 10)) as u16
}

/// All nodes and triangles of all trees, one after the other.
pub fn tree_nodes(accel: &Accel) -> (Vec<Node>, Vec<TreeTriangle>) {
    let (mut nodes, mut triangles) = (Vec::new(), Vec::new());
    for tree in accel.trees() {
        let (node_base, triangle_base) = (nodes.len() as u32, triangles.len() as u32);
        nodes.extend(tree.nodes().map(|n| Node {
            low: n.bounds[0],
            count: n.count,
            high: n.bounds[1],
            first: n.first + if n.count > 0 { triangle_base } else { node_base },
        }));
        triangles.extend(tree.triangles().map(|(number, [a, b, c])| TreeTriangle {
            a,
            number,
            b,
            c,
            ..Default::default()
        }));
    }
    (nodes, triangles)
}

/// Levels of inner nodes that a ray's stack in `shaders/shared/rays.wgsl` holds, its `STACK`.
pub const MOST_LEVELS: u32 = 64;

/// Inner nodes on the longest way from a root to a leaf; the stack holds one sibling for each.
pub fn levels(nodes: &[Node], root: u32) -> u32 {
    let (mut deepest, mut open) = (0, vec![(root, 0)]);
    while let Some((at, depth)) = open.pop() {
        let Some(node) = nodes.get(at as usize) else { continue };
        if node.count > 0 {
            deepest = deepest.max(depth);
        } else {
            open.extend([(node.first, depth + 1), (node.first + 1, depth + 1)]);
        }
    }
    deepest
}

/// Whether the shaders can follow a tree.
///
/// # Errors
/// [`GpuError::TooDeep`]: a ray would lose its way in it and miss what it should hit.
pub fn check_levels(nodes: &[Node], root: u32) -> Result<(), GpuError> {
    let levels = levels(nodes, root);
    if levels > MOST_LEVELS { Err(GpuError::TooDeep { levels, most: MOST_LEVELS }) } else { Ok(()) }
}

/// Placements of all trees, in the order of [`tree_nodes`].
pub fn trees(accel: &Accel) -> Vec<Tree> {
    let mut root = 0;
    let entry = |tree: TreeView<'_>| {
        let node_count = tree.nodes().count() as u32;
        let m = tree.built_from_world;
        let rows = std::array::from_fn(|i| m.matrix3.row(i).extend(m.translation[i]));
        let entry = Tree { rows, root, node_count, padding: [0; 2] };
        root += node_count;
        entry
    };
    accel.trees().map(entry).collect()
}

/// Light of the elements.
pub fn element_light(radiosity: &RadiositySolution) -> Vec<ElementLight> {
    let light = radiosity.direct.iter().zip(&radiosity.indirect);
    let flags = radiosity.elements().iter().map(|e| e.flags);
    light
        .zip(flags)
        .map(|((&direct, &indirect), flags)| {
            let buried = u32::from(flags & BURIED != 0);
            ElementLight { direct, indirect, buried, padding: 0 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn halves_round_to_the_nearest() {
        for (value, bits) in [(0.0, 0), (1.0, 0x3C00), (-2.0, 0xC000), (65_504.0, 0x7BFF), (1e9, 0x7BFF)] {
            assert_eq!(half(value), bits, "{value}");
        }
        assert_eq!(half(0.1), 0x2E66);
        assert_eq!(half(5.960_464_5e-8), 1);
    }
}
