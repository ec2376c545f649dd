//! Wavefront OBJ with MTL materials. Every `o` or `g` is an object; surfaces are double-sided. Meshes without
//! normals get smooth ones with creases ([`weld`](super::weld)).
//!
//! `Kd` and `map_Kd` are reflectance, `Ke` and `map_Ke` emitted radiance in cd/m². The file's unit is
//! taken to be the metre.

use super::{
    SceneError,
    model::{self, Model},
    picture,
    weld::welded,
};
use crate::scene::{Object, Part, material::Material};
use glam::{Affine3A, Vec2, Vec3};
use std::{cell::RefCell, collections::HashMap, path::Path, sync::Arc};

/// Reads an OBJ file, its material libraries and their pictures.
///
/// # Errors
/// If the file is broken. Missing libraries and pictures are noted.
pub fn read(path: &Path) -> Result<Model, SceneError> {
    let bytes = super::read_bytes(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let options =
        tobj::LoadOptions { triangulate: true, single_index: true, ignore_points: true, ignore_lines: true };
    let mut model = Model::default();
    let (failures, broken_colours) = (RefCell::new(Vec::new()), RefCell::new(Vec::new()));
    let load_materials = |library: &Path| {
        let file = folder.join(library.to_string_lossy().replace('\\', "/"));
        let result = match std::fs::read(&file) {
            Ok(bytes) => {
                let (text, complete) = without_broken_colours(&String::from_utf8_lossy(&bytes));
                if !complete {
                    broken_colours.borrow_mut().push(library.display().to_string());
                }
                tobj::load_mtl_buf(&mut text.as_bytes())
            }
            Err(_) => Err(tobj::LoadError::OpenFileFailed),
        };
        if let Err(cause) = &result {
            failures.borrow_mut().push(format!("{} ({cause})", library.display()));
        }
        // A library that fails leaves the others usable.
        result.or_else(|_| Ok((Vec::new(), Default::default())))
    };
    let text = String::from_utf8_lossy(&bytes);
    let (models, materials) = tobj::load_obj_buf(&mut text.as_bytes(), &options, load_materials)
        .map_err(|cause| SceneError::malformed(path, format!("invalid OBJ: {cause}")))?;
    for failure in failures.into_inner() {
        model.notes.add("material libraries that cannot be read; their surfaces are grey", &failure);
    }
    for library in broken_colours.into_inner() {
        model.notes.add("colours of materials that are not three numbers are ignored", &library);
    }
    let mut textures = HashMap::new();
    for material in &materials.unwrap_or_default() {
        let material = read_material(folder, material, &mut textures, &mut model);
        model.materials.push(material);
    }
    let grey = model.materials.len();
    model.materials.push(Material { double_sided: true, ..Material::default() });
    for part in models {
        add_part(path, part, grey, &mut model)?;
    }
    Ok(model)
}

/// A material library without the colours that are not three numbers, and whether it had none: tobj
/// 4.0.5 panics on a colour of fewer.
fn without_broken_colours(library: &str) -> (String, bool) {
    let is_sound = |line: &&str| {
        let mut words = line.split_whitespace();
        let is_colour = words.next().is_some_and(|key| ["Ka", "Kd", "Ks", "Ke"].contains(&key));
        !is_colour || words.take(3).filter(|w| w.parse::<f32>().is_ok()).count() == 3
    };
    let kept: Vec<&str> = library.lines().filter(is_sound).collect();
    (kept.join("\n"), kept.len() == library.lines().count())
}

fn add_part(path: &Path, part: tobj::Model, grey: usize, model: &mut Model) -> Result<(), SceneError> {
    let tobj::Model { mesh, name } = part;
    let name = if name.is_empty() || name == "unnamed_object" { super::stem(path) } else { name };
    let vectors = |list: &[f32]| list.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
    let positions = vectors(&mesh.positions);
    let count = positions.len();
    if let Some(index) = mesh.indices.iter().find(|&&i| i as usize >= count) {
        let cause = format!("invalid OBJ: \"{name}\" has index {index} and {count} vertices");
        return Err(SceneError::malformed(path, cause));
    }
    let normals = vectors(&mesh.normals);
    let uvs: Vec<Vec2> = mesh.texcoords.chunks_exact(2).map(|c| Vec2::new(c[0], 1.0 - c[1])).collect();
    let triangles: Vec<[u32; 3]> = mesh.indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    if triangles.is_empty() {
        return Ok(());
    }
    if mesh.material_id.is_none() {
        model.notes.add("surfaces without a known material are grey", &name);
    }
    let uvs = if uvs.len() == count { uvs } else { Vec::new() };
    model.meshes.push(Arc::new(if normals.len() == count {
        model::mesh(positions, Some(normals), [(!uvs.is_empty()).then_some(uvs), None], triangles)
    } else {
        welded(&positions, &uvs, &triangles)
    }));
    let part = Part {
        mesh: model.meshes.len() - 1,
        material: mesh.material_id.filter(|&i| i < grey).unwrap_or(grey),
    };
    match model.objects.last_mut().filter(|o| o.name == name) {
        Some(object) => object.parts.push(part),
        None => model.objects.push(Object {
            name,
            parts: vec![part],
            world_from_object: Affine3A::IDENTITY,
            movable: false,
            dimmer: 1.0,
        }),
    }
    Ok(())
}

fn read_material(
    folder: &Path,
    material: &tobj::Material,
    textures: &mut HashMap<String, Option<usize>>,
    model: &mut Model,
) -> Material {
    let name = &material.name;
    if material.dissolve.is_some_and(|d| d < 1.0) || material.dissolve_texture.is_some() {
        model.notes.add("transparency is shown opaque", name);
    }
    if material.normal_texture.is_some() {
        model.notes.add("normal maps are ignored", name);
    }
    let parameter = |key: &str| {
        material.unknown_param.iter().find(|(k, _)| k.eq_ignore_ascii_case(key)).map(|(_, v)| v.clone())
    };
    // The extension for physically based materials; what is no number is none.
    let share = |key: &str| parameter(key)?.trim().parse::<f32>().ok().map(|v| v.clamp(0.0, 1.0));
    let plain = Material::default();
    let (roughness, metallic) =
        (share("Pr").unwrap_or(plain.roughness), share("Pm").unwrap_or(plain.metallic));
    let mut texture =
        |file: Option<String>| file.and_then(|f| read_texture(folder, &f, name, textures, model));
    let reflectance_texture = texture(material.diffuse_texture.clone());
    let emission_texture = texture(parameter("map_Ke"));
    Material {
        name: name.clone(),
        reflectance: material.diffuse.map_or(Vec3::splat(0.5), Vec3::from),
        reflectance_texture,
        emission: material.emissive.map_or(Vec3::ZERO, Vec3::from),
        emission_texture,
        double_sided: true,
        roughness,
        metallic,
        ..plain
    }
}

fn read_texture(
    folder: &Path,
    statement: &str,
    owner: &str,
    textures: &mut HashMap<String, Option<usize>>,
    model: &mut Model,
) -> Option<usize> {
    let mut file = statement.trim();
    if file.starts_with('-') {
        model.notes.add("options of texture maps are ignored", owner);
        file = file.split_whitespace().last().unwrap_or_default();
    }
    let file = file.replace('\\', "/");
    if let Some(&known) = textures.get(&file) {
        return known;
    }
    let full = folder.join(&file);
    let read = std::fs::read(&full).map_err(|e| e.to_string()).and_then(|bytes| picture::decode(&bytes));
    let index = match read {
        Ok(texture) => {
            model.textures.push(Arc::new(texture));
            Some(model.textures.len() - 1)
        }
        Err(cause) => {
            let cause = super::one_line(format!("{file}: {cause}"));
            model.notes.add(&format!("a texture is missing and shown white ({cause})"), owner);
            None
        }
    };
    textures.insert(file, index);
    index
}
