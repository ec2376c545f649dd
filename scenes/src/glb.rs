//! Writes binary glTF 2.0: meshes shared by nodes, embedded PNG textures, emission in cd/m².
//!
//! Small on purpose: positions, normals, texture coordinates and indices, and the extensions the scenes need
//! (KHR_materials_emissive_strength, and _transmission and _volume for glass). Keys stand in alphabetical order in every object, so
//! that the bytes do not depend on how `serde_json` keeps its maps.

use crate::shapes::Shape;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// A material, in linear Rec. 709; diffuse unless polished.
#[derive(Clone, Debug)]
pub struct Material {
    /// Name shown.
    pub name: &'static str,
    /// Reflectance per channel.
    pub reflectance: [f64; 3],
    /// Picture multiplied into the reflectance: index into `Model::pictures`.
    pub picture: Option<usize>,
    /// Emitted radiance, cd/m² per channel.
    pub radiance: [f64; 3],
    /// Picture multiplied into the radiance.
    pub radiance_picture: Option<usize>,
    /// Whether the back is lit too.
    pub double_sided: bool,
    /// Metallic factor and roughness; rough and no metal by default.
    pub polish: [f64; 2],
    /// Whether it is glass, and if so whether it bounds a solid or is a pane.
    pub glass: Option<bool>,
}

impl Material {
    /// A surface that reflects and does not emit.
    pub fn new(name: &'static str, reflectance: [f64; 3]) -> Self {
        Self {
            name,
            reflectance,
            picture: None,
            radiance: [0.0; 3],
            radiance_picture: None,
            double_sided: false,
            polish: [0.0, 1.0],
            glass: None,
        }
    }

    /// The same as a metal or under a coat, of a roughness.
    pub fn polished(self, metallic: f64, roughness: f64) -> Self {
        Self { polish: [metallic, roughness], ..self }
    }

    /// The same as glass: the boundary of a solid, or a pane.
    pub fn glass(self, solid: bool) -> Self {
        Self { glass: Some(solid), ..self.polished(0.0, 0.0) }
    }

    /// The same, emitting `radiance` cd/m².
    pub fn emitting(self, radiance: [f64; 3]) -> Self {
        Self { radiance, ..self }
    }
}

/// Shapes by material: one mesh of the file.
#[derive(Clone, Debug, Default)]
pub struct Parts(pub BTreeMap<usize, Shape>);

impl Parts {
    /// Adds a shape made of a material.
    pub fn add(&mut self, material: usize, shape: Shape) {
        self.0.entry(material).or_default().add(&shape);
    }

    /// One shape of one material.
    pub fn of(material: usize, shape: Shape) -> Self {
        Self(BTreeMap::from([(material, shape)]))
    }
}

/// A mesh placed in the scene.
#[derive(Clone, Debug)]
struct Node {
    name: String,
    mesh: usize,
    translation: [f64; 3],
    rotate_y_deg: f64,
}

/// A model to be written.
#[derive(Clone, Debug, Default)]
pub struct Model {
    materials: Vec<Material>,
    pictures: Vec<Vec<u8>>,
    meshes: Vec<Parts>,
    nodes: Vec<Node>,
}

impl Model {
    /// Adds a material and gives its index.
    pub fn material(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds a PNG and gives its index.
    pub fn picture(&mut self, png: Vec<u8>) -> usize {
        self.pictures.push(png);
        self.pictures.len() - 1
    }

    /// Adds a mesh to be shared and gives its index.
    pub fn mesh(&mut self, parts: Parts) -> usize {
        self.meshes.push(parts);
        self.meshes.len() - 1
    }

    /// Places a mesh at a point, turned about the y axis, counter-clockwise from above.
    pub fn place(&mut self, name: impl Into<String>, mesh: usize, translation: [f64; 3], rotate_y_deg: f64) {
        self.nodes.push(Node { name: name.into(), mesh, translation, rotate_y_deg });
    }

    /// Adds a mesh that stands where it was modelled.
    pub fn stand(&mut self, name: impl Into<String>, parts: Parts) {
        let mesh = self.mesh(parts);
        self.place(name, mesh, [0.0; 3], 0.0);
    }

    /// The same with equal vertices merged, and without materials and pictures that nothing is made of.
    pub fn tidied(mut self) -> Self {
        let renumber = |used: &BTreeSet<usize>| -> BTreeMap<usize, usize> {
            used.iter().enumerate().map(|(new, &old)| (old, new)).collect()
        };
        let used: BTreeSet<usize> = self.meshes.iter().flat_map(|m| m.0.keys().copied()).collect();
        let numbers = renumber(&used);
        self.materials = used.iter().map(|&i| self.materials[i].clone()).collect();
        for parts in &mut self.meshes {
            let old = std::mem::take(&mut parts.0);
            parts.0 = old.into_iter().map(|(m, shape)| (numbers[&m], shape.welded())).collect();
        }
        let shown = |m: &Material| [m.picture, m.radiance_picture];
        let used: BTreeSet<usize> = self.materials.iter().flat_map(shown).flatten().collect();
        let numbers = renumber(&used);
        self.pictures = used.iter().map(|&i| std::mem::take(&mut self.pictures[i])).collect();
        for material in &mut self.materials {
            for picture in [&mut material.picture, &mut material.radiance_picture] {
                *picture = picture.map(|i| numbers[&i]);
            }
        }
        self
    }

    fn extensions(&self) -> Vec<&'static str> {
        let any = |of: fn(&Material) -> bool| self.materials.iter().any(of);
        let used = [
            (true, "KHR_materials_emissive_strength"),
            (any(|m| m.glass.is_some()), "KHR_materials_transmission"),
            (any(|m| m.glass == Some(true)), "KHR_materials_volume"),
        ];
        used.into_iter().filter(|u| u.0).map(|u| u.1).collect()
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> Vec<u8> {
        let mut chunk = Chunk::default();
        let meshes: Vec<Value> = self.meshes.iter().map(|parts| mesh(parts, &mut chunk)).collect();
        let images: Vec<Value> = self
            .pictures
            .iter()
            .map(|png| json!({ "bufferView": chunk.view(png, None), "mimeType": "image/png" }))
            .collect();
        let textures: Vec<Value> = (0..images.len()).map(|i| json!({ "sampler": 0, "source": i })).collect();
        let nodes: Vec<Value> = self.nodes.iter().map(node).collect();
        let mut root = json!({
            "accessors": chunk.accessors,
            "asset": { "generator": "lumenscope-scenes", "version": "2.0" },
            "bufferViews": chunk.views,
            "buffers": [{ "byteLength": chunk.bytes.len() }],
            "extensionsUsed": self.extensions(),
        });
        if !images.is_empty() {
            root["images"] = images.into();
        }
        root["materials"] = self.materials.iter().map(material).collect();
        root["meshes"] = meshes.into();
        root["nodes"] = nodes.into();
        if !textures.is_empty() {
            root["samplers"] =
                json!([{ "magFilter": 9729, "minFilter": 9729, "wrapS": 10497, "wrapT": 10497 }]);
        }
        root["scene"] = json!(0);
        root["scenes"] = json!([{ "nodes": (0..self.nodes.len()).collect::<Vec<_>>() }]);
        if !textures.is_empty() {
            root["textures"] = textures.into();
        }
        assemble(root.to_string().into_bytes(), chunk.bytes)
    }
}

/// The binary chunk as it grows; equal contents are stored once.
#[derive(Default)]
struct Chunk {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    known: BTreeMap<Vec<u8>, usize>,
}

impl Chunk {
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        if let Some(&known) = self.known.get(bytes) {
            return known;
        }
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteLength": bytes.len(), "byteOffset": self.bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.views.push(view);
        self.bytes.extend_from_slice(bytes);
        self.known.insert(bytes.to_vec(), self.views.len() - 1);
        self.views.len() - 1
    }

    fn vectors<const N: usize>(&mut self, values: &[[f32; N]], bounds: bool) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(34962));
        let kind = if N == 2 { "VEC2" } else { "VEC3" };
        let mut accessor = json!({ "bufferView": view, "componentType": 5126, "count": values.len() });
        if bounds {
            let fold = |f: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
                (0..N).map(|i| values.iter().map(|v| v[i]).fold(start, f)).collect()
            };
            accessor["max"] = json!(fold(f32::max, f32::NEG_INFINITY));
            accessor["min"] = json!(fold(f32::min, f32::INFINITY));
        }
        accessor["type"] = kind.into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn indices(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        let flat = triangles.iter().flatten();
        let (bytes, kind): (Vec<u8>, u32) = if vertices < 65_535 {
            (flat.flat_map(|&i| (i as u16).to_le_bytes()).collect(), 5123)
        } else {
            (flat.flat_map(|&i| i.to_le_bytes()).collect(), 5125)
        };
        let view = self.view(&bytes, Some(34963));
        self.accessors.push(json!({
            "bufferView": view, "componentType": kind, "count": triangles.len() * 3, "type": "SCALAR"
        }));
        self.accessors.len() - 1
    }
}

fn mesh(parts: &Parts, chunk: &mut Chunk) -> Value {
    let primitives: Vec<Value> = parts
        .0
        .iter()
        .map(|(material, shape)| {
            let narrow3 = |v: &glam::DVec3| v.to_array().map(|x| x as f32);
            let normals = chunk.vectors(&shape.normals.iter().map(narrow3).collect::<Vec<_>>(), false);
            let positions = chunk.vectors(&shape.positions.iter().map(narrow3).collect::<Vec<_>>(), true);
            let mut attributes = json!({ "NORMAL": normals, "POSITION": positions });
            if shape.uvs.iter().any(|uv| *uv != glam::DVec2::ZERO) {
                let uvs: Vec<_> = shape.uvs.iter().map(|uv| uv.to_array().map(|x| x as f32)).collect();
                attributes["TEXCOORD_0"] = chunk.vectors(&uvs, false).into();
            }
            let indices = chunk.indices(&shape.triangles, shape.positions.len());
            json!({ "attributes": attributes, "indices": indices, "material": material })
        })
        .collect();
    json!({ "primitives": primitives })
}

fn node(node: &Node) -> Value {
    let mut value = json!({ "mesh": node.mesh, "name": node.name });
    if node.rotate_y_deg != 0.0 {
        let half = 0.5 * node.rotate_y_deg.to_radians();
        value["rotation"] = json!([0.0, half.sin() as f32, 0.0, half.cos() as f32]);
    }
    if node.translation != [0.0; 3] {
        value["translation"] = json!(node.translation);
    }
    value
}

fn material(material: &Material) -> Value {
    let [r, g, b] = material.reflectance;
    let mut value = json!({});
    if material.double_sided {
        value["doubleSided"] = json!(true);
    }
    let strength = material.radiance.into_iter().fold(0.0, f64::max);
    if strength > 0.0 {
        value["emissiveFactor"] = json!(material.radiance.map(|x| x / strength));
        if let Some(picture) = material.radiance_picture {
            value["emissiveTexture"] = json!({ "index": picture });
        }
        value["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
    }
    if let Some(solid) = material.glass {
        value["extensions"] = json!({ "KHR_materials_transmission": { "transmissionFactor": 1.0 } });
        if solid {
            value["extensions"]["KHR_materials_volume"] = json!({ "thicknessFactor": 1.0 });
        }
    }
    value["name"] = material.name.into();
    let mut pbr = json!({ "baseColorFactor": [r, g, b, 1.0] });
    if let Some(picture) = material.picture {
        pbr["baseColorTexture"] = json!({ "index": picture });
    }
    let [metallic, roughness] = material.polish;
    pbr["metallicFactor"] = json!(metallic);
    if roughness < 1.0 {
        pbr["roughnessFactor"] = json!(roughness);
    }
    value["pbrMetallicRoughness"] = pbr;
    value
}

fn assemble(mut json: Vec<u8>, mut binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let total = 12 + 8 + json.len() + 8 + binary.len();
    let mut bytes = Vec::with_capacity(total);
    bytes.extend_from_slice(b"glTF");
    for word in [2, total as u32, json.len() as u32] {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    bytes.extend_from_slice(b"JSON");
    bytes.extend_from_slice(&json);
    bytes.extend_from_slice(&(binary.len() as u32).to_le_bytes());
    bytes.extend_from_slice(b"BIN\0");
    bytes.extend_from_slice(&binary);
    bytes
}
