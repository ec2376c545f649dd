//! Model files written for the tests of import.

use super::*;
use std::f64::consts::FRAC_1_SQRT_2;

pub const CUBE_OBJ: &str = "mtllib cube.mtl\no cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    usemtl red\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nusemtl lamp\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";

pub const CUBE_MTL: &str = "newmtl red\nKd 0.6 0.1 0.1\nnewmtl lamp\nKd 0 0 0\nKe 100 200 300\n";

pub fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

pub fn png(pixels: &[[u8; 3]]) -> Vec<u8> {
    let mut picture = image::RgbImage::new(pixels.len() as u32, 1);
    pixels.iter().enumerate().for_each(|(i, p)| picture.put_pixel(i as u32, 0, image::Rgb(*p)));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The buffer of one quad: positions, texture coordinates, indices; 48 + 32 + 12 bytes.
pub fn quad_bytes() -> Vec<u8> {
    let positions: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
    let uvs: [f32; 8] = [0., 1., 1., 1., 1., 0., 0., 0.];
    let mut bytes: Vec<u8> = positions.iter().chain(&uvs).flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

/// A file with one quad, used by two nodes in a hierarchy, a lit material, lamps and a camera.
pub fn quad_gltf() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_texture_transform"],
        "scene": 0,
        "scenes": [{"nodes": [0, 3, 4, 5, 6]}],
        "nodes": [
            {"name": "parent", "translation": [10, 0, 0], "scale": [2, 2, 2], "children": [1, 2]},
            {"name": "plain", "mesh": 0, "extras": {"movable": true}},
            {"name": "mirrored", "mesh": 0, "scale": [-1, 1, 1]},
            {"name": "bulb", "translation": [0, 3, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"name": "spot", "rotation": [-FRAC_1_SQRT_2, 0, 0, FRAC_1_SQRT_2],
                "extensions": {"KHR_lights_punctual": {"light": 1}}},
            {"name": "sun", "extensions": {"KHR_lights_punctual": {"light": 2}}},
            {"name": "view", "translation": [0, 1, 5], "camera": 0}
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "point", "color": [1, 0.5, 0.25], "intensity": 40},
            {"type": "spot", "intensity": 100, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5}},
            {"type": "directional", "intensity": 1000}
        ]}},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{
            "name": "paper",
            "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.75, 1], "metallicFactor": 0, "roughnessFactor": 0.5,
                "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}}},
            "emissiveFactor": [1, 0.5, 0],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 200}}
        }],
        "textures": [{"source": 0}],
        "images": [{"uri": "two%20tones.png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12}
        ],
        "buffers": [{"byteLength": 92, "uri": "quad.bin"}]
    })
}

pub fn write_quad(folder: &Path, gltf: &Value) -> PathBuf {
    write(folder, "two tones.png", png(&[[255, 255, 255], [128, 128, 128]]));
    write(folder, "quad.bin", quad_bytes());
    write(folder, "quad.gltf", gltf.to_string())
}
