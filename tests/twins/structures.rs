//! Structures have the same layout in Rust and in WGSL, and constants the same value.

use bytemuck::offset_of;
use lumenscope_core::{
    glossy::gpu as glossy_gpu,
    gpu::{frame, inspection as gpu_inspection, shaders, tables},
    mirror::{images::gpu as images_gpu, view_table},
    radiosity::lookup::SideMap,
};

/// One structure of a program: its name, size and the offsets of its members.
fn layout_of(program: &shaders::Program, name: &str) -> (u32, Vec<u32>) {
    let module = naga::front::wgsl::parse_str(&program.source()).unwrap();
    for (_, ty) in module.types.iter() {
        if let (Some(found), naga::TypeInner::Struct { members, span }) = (&ty.name, &ty.inner)
            && found == name
        {
            return (*span, members.iter().map(|m| m.offset).collect());
        }
    }
    panic!("{} has no structure {name}", program.name);
}

macro_rules! same_layout {
    ($program:expr, $name:literal, $ty:ty, $($field:ident),+) => {{
        let value: $ty = bytemuck::Zeroable::zeroed();
        let offsets: Vec<u32> = vec![$(offset_of!(value, $ty, $field) as u32),+];
        let (size, wanted) = layout_of(&$program, $name);
        assert_eq!(size as usize, size_of::<$ty>(), "size of {}", $name);
        // Arrays stand for several members of the shader.
        assert!(offsets.iter().all(|o| wanted.contains(o)), "{}: {offsets:?}, shader {wanted:?}", $name);
        assert!(offsets.windows(2).all(|w| w[0] < w[1]), "{} is named out of order", $name);
    }};
}

#[test]
fn structures_have_the_same_layout_on_both_sides() {
    use shaders::{COMPOSITE, GLOSSY, INSPECTION, MIRROR_FOLLOW, MIRROR_SPLAT, SHADE};
    same_layout!(
        SHADE,
        "Frame",
        frame::Frame,
        eye,
        frame,
        forward,
        samples,
        right,
        emitter_count,
        up,
        tree_count,
        half_size,
        size,
        subpixel,
        seed,
        accumulated,
        near,
        highlighted,
        line_width,
        depth_bias
    );
    same_layout!(
        MIRROR_SPLAT,
        "ImageInfo",
        images_gpu::ImageInfo,
        eye,
        first,
        corner,
        resolution,
        edge_u,
        padding_0,
        edge_v,
        padding_1
    );
    same_layout!(MIRROR_SPLAT, "ImagePoint", images_gpu::ImagePoint, scale, triangle);
    same_layout!(MIRROR_SPLAT, "Run", images_gpu::RunInfo, image, first, level, view);
    same_layout!(
        MIRROR_FOLLOW,
        "MirroredView",
        view_table::ViewInfo,
        eye,
        reflector,
        right,
        parent,
        up,
        depth,
        forward,
        padding,
        clip_normal,
        clip_offset
    );
    same_layout!(GLOSSY, "Texel", glossy_gpu::TexelInfo, radiance, nearness, coverage, reflector, padding);
    same_layout!(GLOSSY, "LevelInfo", glossy_gpu::LevelInfo, first, width, height, column, row, padding);
    same_layout!(GLOSSY, "LobeTables", glossy_gpu::LobeTables, parameters, entries, count, padding);
    same_layout!(
        GLOSSY,
        "MeasuredReflector",
        glossy_gpu::MeasuredReflector,
        normal,
        height,
        rectangle,
        reflector,
        lobe,
        padding
    );
    same_layout!(GLOSSY, "MeasuredReflectors", glossy_gpu::MeasuredReflectors, list, count, padding);
    same_layout!(GLOSSY, "KernelInfo", glossy_gpu::KernelInfo, level, radius, rest_radius, known, weights);
    same_layout!(
        MIRROR_FOLLOW,
        "MirroredViews",
        view_table::ViewTable,
        count,
        near,
        by_particles,
        padding,
        list
    );
    same_layout!(SHADE, "Corner", tables::Corner, position, u, normal, v);
    same_layout!(SHADE, "TriangleInfo", tables::TriangleInfo, material, object, reflector, environment);
    same_layout!(SHADE, "ObjectInfo", tables::ObjectInfo, dimmer, moved_first, first_triangle, stored_direct);
    same_layout!(
        SHADE,
        "MaterialInfo",
        tables::MaterialInfo,
        reflectance,
        reflectance_texture,
        emission,
        emission_texture,
        double_sided,
        diffuse_share,
        metallic,
        dielectric,
        alpha,
        passes,
        solid,
        exponent
    );
    same_layout!(SHADE, "TextureInfo", tables::TextureInfo, first, width, height, padding);
    same_layout!(SHADE, "Node", tables::Node, low, count, high, first);
    same_layout!(SHADE, "TreeTriangle", tables::TreeTriangle, a, number, b, padding_0, c, padding_1);
    same_layout!(SHADE, "Tree", tables::Tree, rows, root, node_count, padding);
    same_layout!(
        SHADE,
        "EmitterInfo",
        tables::EmitterInfo,
        emission,
        kind,
        position,
        cos_inner,
        axis,
        cos_outer,
        first,
        count,
        flags,
        area
    );
    same_layout!(SHADE, "EmitterTriangle", tables::EmitterTriangle, triangle, cumulative_area);
    same_layout!(SHADE, "SideMap", SideMap, first, size, corners);
    same_layout!(SHADE, "ElementLight", tables::ElementLight, direct, buried, indirect, padding);
    same_layout!(
        COMPOSITE,
        "Composite",
        frame::Composite,
        weights,
        exposure,
        tone,
        false_colour,
        encode,
        layer_count,
        specular_weights,
        padding
    );
    same_layout!(COMPOSITE, "FalseColour", frame::FalseColourTable, low, high, logarithmic, padding, palette);
    same_layout!(COMPOSITE, "ShownTriangle", tables::TriangleInfo, material, object, reflector, environment);
    same_layout!(INSPECTION, "Sphere", gpu_inspection::Sphere, centre, radius, first_bin, padding);
    same_layout!(
        INSPECTION,
        "LineInfo",
        gpu_inspection::LineInfo,
        a,
        padding_0,
        b,
        padding_1,
        colour,
        opacity
    );
    same_layout!(INSPECTION, "MeshCorner", gpu_inspection::MeshCorner, position, opacity, value, padding);
    same_layout!(
        INSPECTION,
        "InspectionSettings",
        gpu_inspection::InspectionSettings,
        bins,
        encode,
        natural,
        padding
    );
}

/// A constant of a program.
fn constant_of(program: &shaders::Program, name: &str) -> f64 {
    let module = naga::front::wgsl::parse_str(&program.source()).unwrap();
    let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).unwrap();
    match module.global_expressions[constant.init] {
        naga::Expression::Literal(naga::Literal::U32(value)) => value.into(),
        naga::Expression::Literal(naga::Literal::F32(value)) => value.into(),
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn constants_have_the_same_value_on_both_sides() {
    use lumenscope_core::{
        glossy::{invariant, lobes, particles, variant},
        mirror::images::visible,
        scene::{direct, glass},
    };
    use shaders::{GLOSSY, MIRROR_SPLAT, PARTICLES, SHADE};
    for (program, name, value) in [
        (SHADE, "NONE", f64::from(tables::NONE)),
        (SHADE, "ANALYTIC_TRIANGLES", direct::ANALYTIC_TRIANGLES as f64),
        (SHADE, "SEARCH", direct::SEARCH.into()),
        (SHADE, "LARGEST_SIZE", direct::LARGEST_SIZE.into()),
        (SHADE, "MOST_FACES", glass::MOST_FACES as f64),
        (GLOSSY, "WIDEST", invariant::WIDEST.into()),
        (GLOSSY, "PEAK", invariant::PEAK.into()),
        (GLOSSY, "MEASURED", invariant::MEASURED.into()),
        (GLOSSY, "MOST_RADIUS", invariant::MOST_RADIUS.into()),
        (GLOSSY, "ANGLES", lobes::ANGLES as f64),
        (GLOSSY, "REACH_LEVEL", variant::REACH_LEVEL as f64),
        (PARTICLES, "LEAST_SAMPLES", particles::pass::LEAST_SAMPLES.into()),
        (MIRROR_SPLAT, "LEAF", visible::LEAF.into()),
    ] {
        assert_eq!(constant_of(&program, name), value, "{name} of {}", program.name);
    }
}
