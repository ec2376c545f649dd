//! The checks every model passes before it joins a scene.

use super::{LARGEST_COORDINATE, LARGEST_REFLECTANCE, SceneError, model::Model};
use crate::scene::{
    camera::Camera,
    lamp::{Lamp, LampKind},
    material::Texture,
    mesh::Mesh,
};
use glam::{Affine3A, DVec3, Vec2, Vec3};
use std::{collections::HashMap, f32::consts::FRAC_PI_2, path::Path, sync::Arc};

/// Smallest ratio of a triangle's doubled area to its longest edge squared; below it `f32` knows no normal.
const NEEDLE: f64 = 1e-10;

/// Refuses what has no meaning, mends what has one, and notes what it mended.
///
/// # Errors
/// If a coordinate or quantity is not a sensible number, or nothing is left.
pub fn clean(path: &Path, model: &mut Model) -> Result<(), SceneError> {
    for object in &model.objects {
        let world = object.world_from_object;
        for part in &object.parts {
            let positions = model.meshes[part.mesh].positions.iter();
            check_coordinates(path, &object.name, &world, positions)?;
        }
    }
    drop_flat_objects(model);
    let mut dropped = 0;
    for mesh in &mut model.meshes {
        if let Some((mended, count)) = mend(mesh) {
            dropped += count;
            *mesh = Arc::new(mended);
        }
    }
    if dropped > 0 {
        model.notes.add(&format!("{dropped} triangles of no area were dropped"), "");
    }
    turn_mirrored(model);
    clean_materials(path, model)?;
    for lamp in &model.lamps {
        check_lamp(path, lamp)?;
    }
    if let Some(camera) = &model.camera {
        check_camera(path, camera)?;
    }
    for object in &mut model.objects {
        object.parts.retain(|p| !model.meshes[p.mesh].triangles.is_empty());
    }
    model.objects.retain(|o| !o.parts.is_empty());
    if model.objects.is_empty() {
        return Err(SceneError::Empty { file: path.display().to_string() });
    }
    Ok(())
}

/// Refuses positions that are not finite or too far out once placed.
///
/// # Errors
/// Naming the object and the coordinate.
pub fn check_coordinates<'a>(
    path: &Path,
    object: &str,
    world_from_object: &Affine3A,
    mut positions: impl Iterator<Item = &'a Vec3>,
) -> Result<(), SceneError> {
    let bad = |v: f32| !v.is_finite() || v.abs() > LARGEST_COORDINATE;
    let found = positions.find_map(|&p| {
        let placed = world_from_object.transform_point3(p);
        p.to_array().into_iter().find(|v| !v.is_finite()).or(placed.to_array().into_iter().find(|&v| bad(v)))
    });
    match found {
        None => Ok(()),
        Some(value) => {
            Err(SceneError::Coordinate { file: path.display().to_string(), object: object.into(), value })
        }
    }
}

/// Leaves out objects whose placement has no volume: nothing could turn or move them back.
fn drop_flat_objects(model: &mut Model) {
    let notes = &mut model.notes;
    model.objects.retain(|object| {
        let determinant = object.world_from_object.matrix3.determinant();
        let keep = determinant.is_finite() && determinant.abs() > 1e-24;
        if !keep {
            notes.add("objects scaled to nothing are left out", &object.name);
        }
        keep
    });
}

/// A copy of the mesh without triangles of no area and with finite normals and texture coordinates,
/// and how many triangles went; nothing if the mesh is sound.
fn mend(mesh: &Mesh) -> Option<(Mesh, usize)> {
    let has_area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        let edges = [b - a, c - a, c - b];
        let longest = edges.iter().map(|e: &DVec3| e.length_squared()).fold(0.0, f64::max);
        longest > 0.0 && edges[0].cross(edges[1]).length() > NEEDLE * longest
    };
    let flawed_normal = |n: &Vec3| !n.is_finite() || n.length_squared() < 0.5;
    let count = mesh.triangles.iter().filter(|t| !has_area(t)).count();
    let mut uvs = mesh.uvs.iter().chain(&mesh.lightmap_uvs);
    if count == 0 && !mesh.normals.iter().any(flawed_normal) && uvs.all(|uv| uv.is_finite()) {
        return None;
    }
    let mut mended = mesh.clone();
    mended.triangles.retain(has_area);
    let uvs = mended.uvs.iter_mut().chain(&mut mended.lightmap_uvs);
    uvs.filter(|uv| !uv.is_finite()).for_each(|uv| *uv = Vec2::ZERO);
    for t in &mended.triangles {
        for &i in t {
            if flawed_normal(&mended.normals[i as usize]) {
                let [a, b, c] = t.map(|i| mended.positions[i as usize].as_dvec3());
                mended.normals[i as usize] = (b - a).cross(c - a).normalize().as_vec3();
            }
        }
    }
    mended.normals.iter_mut().filter(|n| flawed_normal(n)).for_each(|n| *n = Vec3::Y);
    Some((mended, count))
}

/// Turns the winding of the meshes of mirrored objects, so that their front stays in front.
fn turn_mirrored(model: &mut Model) {
    let mut turned = HashMap::new();
    for object in &mut model.objects {
        if object.world_from_object.matrix3.determinant() >= 0.0 {
            continue;
        }
        for part in &mut object.parts {
            part.mesh = *turned.entry(part.mesh).or_insert_with(|| {
                let mut mesh = (*model.meshes[part.mesh]).clone();
                mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
                model.meshes.push(Arc::new(mesh));
                model.meshes.len() - 1
            });
        }
    }
}

fn clean_materials(path: &Path, model: &mut Model) -> Result<(), SceneError> {
    let largest = |texture: Option<usize>, textures: &[Arc<Texture>]| match texture {
        Some(i) => textures[i].pixels.iter().fold(Vec3::ZERO, |m, p| m.max(*p)),
        None => Vec3::ONE,
    };
    for material in &mut model.materials {
        let owner = || format!("material \"{}\"", material.name);
        if !material.reflectance.is_finite() {
            return Err(SceneError::value(path, owner(), "reflectance", material.reflectance));
        }
        if !material.emission.is_finite() {
            return Err(SceneError::value(path, owner(), "emission in cd/m²", material.emission));
        }
        let shares = [material.roughness, material.metallic, material.transmission];
        let known = shares.iter().all(|s| (0.0..=1.0).contains(s)) && material.ior >= 1.0;
        if !(known && material.ior.is_finite()) {
            model
                .notes
                .add("roughness, metallic, transmission or index of refraction out of range", &material.name);
            let within = |s: f32, otherwise: f32| if s.is_nan() { otherwise } else { s.clamp(0.0, 1.0) };
            material.roughness = within(material.roughness, 1.0);
            material.metallic = within(material.metallic, 0.0);
            material.transmission = within(material.transmission, 0.0);
            material.ior = if material.ior.is_finite() { material.ior.max(1.0) } else { 1.5 };
        }
        // Glass is met from either side.
        material.double_sided |= material.is_glass();
        if material.reflectance.min_element() < 0.0 || material.emission.min_element() < 0.0 {
            model.notes.add("negative reflectance or emission is taken as zero", &material.name);
            material.reflectance = material.reflectance.max(Vec3::ZERO);
            material.emission = material.emission.max(Vec3::ZERO);
        }
        let peak = material.reflectance * largest(material.reflectance_texture, &model.textures);
        if peak.max_element() > LARGEST_REFLECTANCE {
            let what = format!("reflectance is lowered to {LARGEST_REFLECTANCE}");
            model.notes.add(&what, &material.name);
            let limited = peak.min(Vec3::splat(LARGEST_REFLECTANCE));
            let factor = |value: f32, peak: f32, limited: f32| {
                if peak > limited { value * limited / peak } else { value }
            };
            let r = material.reflectance;
            material.reflectance = Vec3::new(
                factor(r.x, peak.x, limited.x),
                factor(r.y, peak.y, limited.y),
                factor(r.z, peak.z, limited.z),
            );
        }
    }
    Ok(())
}

/// Refuses lamps whose values have no meaning.
///
/// # Errors
/// Naming the lamp and the quantity.
pub fn check_lamp(path: &Path, lamp: &Lamp) -> Result<(), SceneError> {
    let owner = || format!("lamp \"{}\"", lamp.name);
    let bad = |v: Vec3| !v.is_finite() || v.min_element() < 0.0;
    let (quantity, value) = match lamp.kind {
        LampKind::Point { intensity } | LampKind::Spot { intensity, .. } => ("intensity in cd", intensity),
        LampKind::Directional { illuminance } => ("illuminance in lx", illuminance),
    };
    if bad(value) {
        return Err(SceneError::value(path, owner(), quantity, value));
    }
    let position = lamp.position();
    if !position.is_finite() || position.abs().max_element() > LARGEST_COORDINATE {
        return Err(SceneError::value(path, owner(), "position in m", position));
    }
    if !lamp.world_from_lamp.is_finite() {
        return Err(SceneError::value(path, owner(), "direction", lamp.axis()));
    }
    if let LampKind::Spot { inner_angle, outer_angle, .. } = lamp.kind {
        let sensible = 0.0 <= inner_angle && inner_angle <= outer_angle && outer_angle <= FRAC_PI_2 + 1e-5;
        if !sensible || outer_angle == 0.0 {
            let angles = (inner_angle.to_degrees(), outer_angle.to_degrees());
            return Err(SceneError::value(path, owner(), "inner and outer half angle in degrees", angles));
        }
    }
    Ok(())
}

/// Refuses cameras that see nothing.
///
/// # Errors
/// Naming the quantity.
pub fn check_camera(path: &Path, camera: &Camera) -> Result<(), SceneError> {
    let fov = camera.vertical_fov;
    if !fov.is_finite() || fov <= 0.0 || fov >= std::f32::consts::PI {
        return Err(SceneError::value(path, "camera", "vertical field of view in rad", fov));
    }
    for (quantity, v) in [("eye", camera.eye), ("target", camera.target), ("up", camera.up)] {
        if !v.is_finite() || v.abs().max_element() > LARGEST_COORDINATE {
            return Err(SceneError::value(path, "camera", quantity, v));
        }
    }
    if camera.eye == camera.target {
        return Err(SceneError::value(path, "camera", "target", "its eye"));
    }
    Ok(())
}
