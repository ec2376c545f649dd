//! glTF 2.0 and GLB: node hierarchy, meshes shared between nodes, lamps and the first camera.

use super::{
    SceneError, accessor,
    gltf_material::{self, UvSource},
    model::{self, Model},
};
use crate::scene::{
    Object, Part,
    camera::Camera,
    lamp::{Lamp, LampKind},
};
use ::gltf::{
    Document, Node, Primitive, Semantic, accessor::Dimensions, khr_lights_punctual::Kind, mesh::Mode,
};
use glam::{Affine3A, Mat4, Vec2, Vec3};
use std::{collections::HashMap, path::Path, sync::Arc};

/// Extensions whose meaning is taken over, or whose lack is noted where they are used.
const KNOWN_EXTENSIONS: [&str; 7] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_texture_transform",
];

/// Reads a glTF or GLB file.
///
/// # Errors
/// If the file, a buffer it names or its structure is broken.
pub fn read(path: &Path) -> Result<Model, SceneError> {
    let bytes = super::read_bytes(path)?;
    let malformed = |cause: String| SceneError::malformed(path, cause);
    let (document, blob) = parse(&bytes).map_err(malformed)?;
    let buffers = read_buffers(path, &document, blob).map_err(malformed)?;
    let mut reader = Reader {
        document: &document,
        buffers: &buffers,
        model: Model::default(),
        parts: HashMap::new(),
        uv_sources: Vec::new(),
    };
    reader.note_what_is_ignored();
    let materials = gltf_material::read(path, &document, &buffers, &mut reader.model);
    reader.uv_sources = materials;
    reader.read_nodes().map_err(malformed)?;
    Ok(reader.model)
}

/// Parses and validates. Positions are looked up first: gltf-json 1.4.1 panics while it validates a
/// primitive whose positions name no accessor.
fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), String> {
    let parsed = ::gltf::Gltf::from_slice_without_validation(bytes).map_err(|e| describe(&e))?;
    let json = parsed.document.into_json();
    let positions = ::gltf::json::validation::Checked::Valid(Semantic::Positions);
    let primitives = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for index in primitives.filter_map(|primitive| primitive.attributes.get(&positions)) {
        if index.value() >= json.accessors.len() {
            return Err(format!("invalid glTF: accessor {} is missing", index.value()));
        }
    }
    let document = Document::from_json(json).map_err(|e| describe(&e))?;
    Ok((document, parsed.blob))
}

/// The bytes a URI names: a data URI, or a file beside `path`.
///
/// # Errors
/// With the cause in words.
pub fn uri_bytes(path: &Path, uri: &str) -> Result<Vec<u8>, String> {
    if uri.starts_with("data:") {
        let source = ::gltf::buffer::Source::Uri(uri);
        return ::gltf::buffer::Data::from_source(source, None).map(|d| d.0).map_err(|e| e.to_string());
    }
    if uri.contains("://") {
        return Err(format!("\"{uri}\" is not a file"));
    }
    let file = path.parent().unwrap_or(Path::new("")).join(percent_decoded(uri));
    std::fs::read(&file).map_err(|e| format!("{} cannot be read: {e}", file.display()))
}

fn percent_decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let hex = |at: usize| bytes.get(at).and_then(|&b| char::from(b).to_digit(16));
        match (bytes[i], hex(i + 1), hex(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((16 * high + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

fn describe(error: &::gltf::Error) -> String {
    match error {
        ::gltf::Error::Validation(list) => match list.first() {
            Some((at, cause)) => format!("invalid glTF: {at}: {cause} ({} findings)", list.len()),
            None => "invalid glTF".into(),
        },
        other => format!("invalid glTF: {other}"),
    }
}

fn read_buffers(path: &Path, document: &Document, mut blob: Option<Vec<u8>>) -> Result<Vec<Vec<u8>>, String> {
    document
        .buffers()
        .map(|buffer| {
            let bytes = match buffer.source() {
                ::gltf::buffer::Source::Bin => blob.take().ok_or("the binary part is missing".to_string())?,
                ::gltf::buffer::Source::Uri(uri) => uri_bytes(path, uri)?,
            };
            if bytes.len() < buffer.length() {
                let index = buffer.index();
                return Err(format!("buffer {index} has {} of {} bytes", bytes.len(), buffer.length()));
            }
            Ok(bytes)
        })
        .collect()
}

struct Reader<'a> {
    document: &'a Document,
    buffers: &'a [Vec<u8>],
    model: Model,
    /// Parts of each glTF mesh already read.
    parts: HashMap<usize, Vec<Part>>,
    /// Where each material's texture coordinates come from, the default material last.
    uv_sources: Vec<UvSource>,
}

impl Reader<'_> {
    fn note_what_is_ignored(&mut self) {
        let notes = &mut self.model.notes;
        for extension in self.document.extensions_used() {
            if !KNOWN_EXTENSIONS.contains(&extension) {
                notes.add("extensions not read", extension);
            }
        }
        if let Some(animation) = self.document.animations().next() {
            notes.add("animations are not played", animation.name().unwrap_or("unnamed"));
        }
    }

    fn read_nodes(&mut self) -> Result<(), String> {
        let document = self.document;
        let mut waiting: Vec<(Node, Affine3A)> =
            match document.default_scene().or_else(|| document.scenes().next()) {
                Some(scene) => scene.nodes().map(|n| (n, Affine3A::IDENTITY)).collect(),
                None => {
                    let children: Vec<usize> =
                        document.nodes().flat_map(|n| n.children().map(|c| c.index())).collect();
                    let is_root = |n: &Node| !children.contains(&n.index());
                    document.nodes().filter(is_root).map(|n| (n, Affine3A::IDENTITY)).collect()
                }
            };
        if document.scenes().len() > 1 {
            self.model.notes.add("only the file's default scene is read", "");
        }
        waiting.reverse();
        let mut visited = vec![false; document.nodes().len()];
        while let Some((node, world_from_parent)) = waiting.pop() {
            if std::mem::replace(&mut visited[node.index()], true) {
                return Err(format!("node {} has two parents", node.index()));
            }
            let local = Mat4::from_cols_array_2d(&node.transform().matrix());
            let world_from_node = world_from_parent * Affine3A::from_mat4(local);
            self.read_node(&node, world_from_node)?;
            let children: Vec<_> = node.children().map(|c| (c, world_from_node)).collect();
            waiting.extend(children.into_iter().rev());
        }
        Ok(())
    }

    fn read_node(&mut self, node: &Node, world_from_node: Affine3A) -> Result<(), String> {
        let name = |own: Option<&str>| match node.name().or(own) {
            Some(name) if !name.is_empty() => name.to_string(),
            _ => format!("node {}", node.index()),
        };
        if node.skin().is_some() {
            self.model.notes.add("skins are ignored", &name(None));
        }
        if let Some(mesh) = node.mesh() {
            let name = name(mesh.name());
            let parts = match self.parts.get(&mesh.index()) {
                Some(parts) => parts.clone(),
                None => {
                    let mut parts = Vec::new();
                    for primitive in mesh.primitives() {
                        parts.extend(self.read_primitive(&primitive, &name)?);
                    }
                    self.parts.insert(mesh.index(), parts.clone());
                    parts
                }
            };
            if !parts.is_empty() {
                self.model.objects.push(Object {
                    name,
                    parts,
                    world_from_object: world_from_node,
                    movable: is_movable(node),
                    dimmer: 1.0,
                });
            }
        }
        if let Some(light) = node.light() {
            let colour = Vec3::from(light.color()) * light.intensity();
            let kind = match light.kind() {
                Kind::Point => LampKind::Point { intensity: colour },
                Kind::Directional => LampKind::Directional { illuminance: colour },
                Kind::Spot { inner_cone_angle, outer_cone_angle } => LampKind::Spot {
                    intensity: colour,
                    inner_angle: inner_cone_angle,
                    outer_angle: outer_cone_angle,
                },
            };
            let name = name(light.name());
            if light.range().is_some() {
                self.model
                    .notes
                    .add("the range of lamps is ignored; light falls off as physics has it", &name);
            }
            let direction = world_from_node.transform_vector3(Vec3::NEG_Z);
            let position = world_from_node.translation.into();
            let world_from_lamp = model::lamp_placement(position, direction);
            self.model.lamps.push(Lamp { name, kind, world_from_lamp, dimmer: 1.0 });
        }
        if self.model.camera.is_none()
            && let Some(camera) = node.camera()
        {
            let json = self.document.as_json().cameras.get(camera.index());
            match json.and_then(|c| c.perspective.as_ref()) {
                Some(perspective) => {
                    let forward = world_from_node.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Z);
                    let eye = world_from_node.translation.into();
                    self.model.camera = Some(Camera {
                        eye,
                        target: eye + forward,
                        up: world_from_node.transform_vector3(Vec3::Y).normalize_or(Vec3::Y),
                        vertical_fov: perspective.yfov,
                    });
                }
                None => self.model.notes.add("orthographic cameras are not read", &name(camera.name())),
            }
        }
        Ok(())
    }

    fn read_primitive(&mut self, primitive: &Primitive, owner: &str) -> Result<Option<Part>, String> {
        let notes = &mut self.model.notes;
        if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            notes.add("points and lines are not drawn", owner);
            return Ok(None);
        }
        if primitive.morph_targets().len() > 0 {
            notes.add("morph targets are ignored", owner);
        }
        if primitive.get(&Semantic::Colors(0)).is_some() {
            notes.add("vertex colours are ignored", owner);
        }
        let material = primitive.material().index().unwrap_or(self.uv_sources.len() - 1);
        let source = self.uv_sources[material];
        let vectors = |semantic: Semantic| -> Result<Option<Vec<Vec3>>, String> {
            let Some(accessor) = primitive.get(&semantic) else { return Ok(None) };
            let numbers = accessor::numbers(&accessor, Dimensions::Vec3, self.buffers)?;
            Ok(Some(numbers.chunks(3).map(|c| Vec3::new(c[0] as f32, c[1] as f32, c[2] as f32)).collect()))
        };
        let Some(positions) = vectors(Semantic::Positions)? else {
            notes.add("meshes without positions are left out", owner);
            return Ok(None);
        };
        let count = positions.len();
        let same_length = |what: &str, found: usize| match found == count {
            true => Ok(()),
            false => Err(format!("\"{owner}\" has {count} positions and {found} {what}")),
        };
        let normals = vectors(Semantic::Normals)?;
        if let Some(normals) = &normals {
            same_length("normals", normals.len())?;
        }
        let coordinates = |set: u32| -> Result<Option<Vec<Vec2>>, String> {
            let Some(accessor) = primitive.get(&Semantic::TexCoords(set)) else { return Ok(None) };
            let numbers = accessor::numbers(&accessor, Dimensions::Vec2, self.buffers)?;
            same_length("texture coordinates", numbers.len() / 2)?;
            Ok(Some(numbers.chunks(2).map(|c| Vec2::new(c[0] as f32, c[1] as f32)).collect()))
        };
        let mut uvs = coordinates(source.set)?;
        if uvs.is_none() && source.textured {
            notes.add("a textured surface has no texture coordinates", owner);
        }
        uvs.iter_mut().flatten().for_each(|uv| *uv = source.transform.transform_point2(*uv));
        let indices: Vec<u32> = match primitive.indices() {
            Some(accessor) => accessor::numbers(&accessor, Dimensions::Scalar, self.buffers)?
                .into_iter()
                .map(|v| v as u32)
                .collect(),
            None => (0..count as u32).collect(),
        };
        if let Some(&index) = indices.iter().find(|&&i| i as usize >= count) {
            return Err(format!("\"{owner}\" has index {index} and {count} vertices"));
        }
        let mesh =
            model::mesh(positions, normals, [uvs, coordinates(1)?], triangles(primitive.mode(), &indices));
        self.model.meshes.push(Arc::new(mesh));
        Ok(Some(Part { mesh: self.model.meshes.len() - 1, material }))
    }
}

fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        Mode::TriangleFan => {
            indices[1.min(indices.len())..].windows(2).map(|w| [indices[0], w[0], w[1]]).collect()
        }
        _ => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
    }
}

fn is_movable(node: &Node) -> bool {
    let extras = node.extras().as_ref().map(|raw| raw.get());
    extras
        .and_then(|text| serde_json::from_str::<serde_json::Value>(text).ok())
        .and_then(|value| value.get("movable").and_then(serde_json::Value::as_bool))
        .unwrap_or(false)
}
