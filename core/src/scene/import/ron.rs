//! RON scenes: `scene::file` joined with the models it names.

use super::{SceneError, model, picture, sanity};
use crate::scene::{
    MeasuringPlane, Object, Part, Scene,
    brdf::LobeShape,
    file::{AreaLampEntry, LampEntry, ModelEntry, PlanOverrides, SceneFile},
    lamp::{Lamp, LampKind},
    material::Material,
    mesh::Mesh,
};
use glam::{Affine3A, Quat, Vec3};
use std::{path::Path, sync::Arc};

/// Loads a RON scene and everything it names.
///
/// # Errors
/// If the file or a model is missing or broken; a missing picture is a warning.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let bytes = super::read_bytes(path)?;
    let options =
        ::ron::Options::default().with_default_extension(::ron::extensions::Extensions::IMPLICIT_SOME);
    let file: SceneFile = options
        .from_bytes(&bytes)
        .map_err(|cause| SceneError::malformed(path, format!("invalid RON: {cause}")))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut scene = Scene { name: super::stem(path), ..Scene::default() };
    let mut model_camera = None;
    for entry in &file.models {
        let camera = add_entry(path, folder, entry, &mut scene)?;
        model_camera = model_camera.or(camera);
    }
    for entry in &file.lamps {
        let lamp = lamp(path, entry)?;
        sanity::check_lamp(path, &lamp)?;
        scene.lamps.push(lamp);
    }
    for entry in &file.area_lamps {
        add_area_lamp(path, folder, entry, &mut scene)?;
    }
    if scene.objects.is_empty() {
        return Err(SceneError::Empty { file: path.display().to_string() });
    }
    for pattern in &file.movable {
        let named = scene.objects.iter_mut().filter(|o| matches(pattern, &o.name));
        if named.map(|o| o.movable = true).count() == 0 {
            scene.warnings.push(format!("movable: no object is named \"{pattern}\""));
        }
    }
    for pattern in &file.phong {
        let named = scene.materials.iter_mut().filter(|m| matches(pattern, &m.name));
        if named.map(|m| m.lobe_shape = LobeShape::Phong).count() == 0 {
            scene.warnings.push(format!("phong: no material is named \"{pattern}\""));
        }
    }
    file.planes.iter().try_for_each(|plane| check_plane(path, plane))?;
    check_plan(path, &file.plan)?;
    if let Some(camera) = &file.camera {
        sanity::check_camera(path, camera)?;
    }
    scene.planes = file.planes;
    scene.plan = file.plan;
    for name in scene.plan.volume_ignored.iter().flatten() {
        let objects = scene.objects.iter().map(|o| &o.name);
        let mut names =
            objects.chain(scene.lamps.iter().map(|l| &l.name)).chain(scene.materials.iter().map(|m| &m.name));
        if names.all(|other| other != name) {
            scene.warnings.push(format!("volume_ignored: no object, lamp or material is named \"{name}\""));
        }
    }
    scene.camera = file.camera.or(model_camera).unwrap_or_else(|| super::framing_camera(&scene));
    if !super::emits(&scene) {
        scene.warnings.push("no lamps: nothing is lit".into());
    }
    Ok(scene)
}

fn add_entry(
    path: &Path,
    folder: &Path,
    entry: &ModelEntry,
    scene: &mut Scene,
) -> Result<Option<crate::scene::camera::Camera>, SceneError> {
    let owner = || format!("model \"{}\"", entry.file);
    if !entry.scale.is_finite() || entry.scale <= 0.0 {
        return Err(SceneError::value(path, owner(), "scale", entry.scale));
    }
    if !entry.translate.is_finite() || !entry.rotate_y_deg.is_finite() {
        return Err(SceneError::value(path, owner(), "placement", (entry.translate, entry.rotate_y_deg)));
    }
    let file = folder.join(&entry.file);
    let mut model = super::read_model(&file)?;
    let placement = Affine3A::from_scale_rotation_translation(
        Vec3::splat(entry.scale),
        Quat::from_rotation_y(entry.rotate_y_deg.to_radians()),
        entry.translate,
    );
    if super::extension(&file) == "obj"
        && let Some(name) = &entry.name
    {
        let several = model.objects.len() > 1;
        for object in &mut model.objects {
            object.name = if several { format!("{name} {}", object.name) } else { name.clone() };
        }
    }
    for object in &model.objects {
        let world = placement * object.world_from_object;
        for part in &object.parts {
            let positions = model.meshes[part.mesh].positions.iter();
            sanity::check_coordinates(&file, &object.name, &world, positions)?;
        }
    }
    let camera = model.camera.map(|camera| crate::scene::camera::Camera {
        eye: placement.transform_point3(camera.eye),
        target: placement.transform_point3(camera.target),
        up: placement.transform_vector3(camera.up).normalize_or(Vec3::Y),
        ..camera
    });
    model.append_to(scene, placement, entry.movable, &format!("{}: ", entry.file));
    Ok(camera)
}

fn lamp(path: &Path, entry: &LampEntry) -> Result<Lamp, SceneError> {
    let no_direction = |name: &str, direction: Vec3| {
        SceneError::value(path, format!("lamp \"{name}\""), "direction", direction)
    };
    let usable = |direction: Vec3| direction.is_finite() && direction.length_squared() > 0.0;
    Ok(match entry {
        LampEntry::Point { name, at, intensity } => Lamp {
            name: name.clone(),
            kind: LampKind::Point { intensity: *intensity },
            world_from_lamp: model::lamp_placement(*at, Vec3::NEG_Y),
            dimmer: 1.0,
        },
        LampEntry::Spot { name, at, towards, intensity, inner_deg, outer_deg } => {
            let direction = *towards - *at;
            if !usable(direction) {
                return Err(no_direction(name, direction));
            }
            Lamp {
                name: name.clone(),
                kind: LampKind::Spot {
                    intensity: *intensity,
                    inner_angle: inner_deg.to_radians(),
                    outer_angle: outer_deg.to_radians(),
                },
                world_from_lamp: model::lamp_placement(*at, direction),
                dimmer: 1.0,
            }
        }
        LampEntry::Directional { name, direction, illuminance } => {
            if !usable(*direction) {
                return Err(no_direction(name, *direction));
            }
            Lamp {
                name: name.clone(),
                kind: LampKind::Directional { illuminance: *illuminance },
                world_from_lamp: model::lamp_placement(Vec3::ZERO, *direction),
                dimmer: 1.0,
            }
        }
    })
}

fn add_area_lamp(
    path: &Path,
    folder: &Path,
    entry: &AreaLampEntry,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let owner = || format!("area lamp \"{}\"", entry.name);
    if !entry.radiance.is_finite() || entry.radiance.min_element() < 0.0 {
        return Err(SceneError::value(path, owner(), "radiance in cd/m²", entry.radiance));
    }
    let (u, v) = (entry.edge_u, entry.edge_v);
    let corners = [Vec3::ZERO, u, u + v, v].map(|edge| entry.corner + edge);
    sanity::check_coordinates(path, &entry.name, &Affine3A::IDENTITY, corners.iter())?;
    if u.cross(v).normalize_or_zero() == Vec3::ZERO {
        return Err(SceneError::value(path, owner(), "area in m²", 0.0));
    }
    if entry.radiance == Vec3::ZERO {
        scene.warnings.push(format!("area lamp of no light: {}", entry.name));
    }
    let mut emission_texture = None;
    if let Some(file) = &entry.texture {
        let read =
            std::fs::read(folder.join(file)).map_err(|e| e.to_string()).and_then(|b| picture::decode(&b));
        match read {
            Ok(texture) => {
                scene.textures.push(Arc::new(texture));
                emission_texture = Some(scene.textures.len() - 1);
            }
            Err(cause) => {
                let cause = super::one_line(format!("{file}: {cause}"));
                let name = &entry.name;
                scene.warnings.push(format!("a texture is missing and shown white ({cause}): {name}"));
            }
        }
    }
    let half = 0.5 * (u + v);
    scene.meshes.push(Arc::new(Mesh::quad([-half, u - half, half, v - half])));
    scene.materials.push(Material {
        name: entry.name.clone(),
        reflectance: Vec3::ZERO,
        emission: entry.radiance,
        emission_texture,
        double_sided: entry.double_sided,
        ..Material::default()
    });
    scene.objects.push(Object {
        name: entry.name.clone(),
        parts: vec![Part { mesh: scene.meshes.len() - 1, material: scene.materials.len() - 1 }],
        world_from_object: Affine3A::from_translation(entry.corner + half),
        movable: true,
        dimmer: 1.0,
    });
    Ok(())
}

/// Whether a name is a pattern's; `*` at its end stands for any rest.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.strip_suffix('*') {
        Some(start) => name.starts_with(start),
        None => name == pattern,
    }
}

fn check_plane(path: &Path, plane: &MeasuringPlane) -> Result<(), SceneError> {
    let owner = || format!("plane \"{}\"", plane.name);
    if !plane.corner.is_finite() || plane.corner.abs().max_element() > super::LARGEST_COORDINATE {
        return Err(SceneError::value(path, owner(), "corner in m", plane.corner));
    }
    if plane.edge_u.cross(plane.edge_v).normalize_or_zero() == Vec3::ZERO {
        return Err(SceneError::value(path, owner(), "edges in m", (plane.edge_u, plane.edge_v)));
    }
    Ok(())
}

fn check_plan(path: &Path, plan: &PlanOverrides) -> Result<(), SceneError> {
    match plan.problem() {
        Some((name, value)) => Err(SceneError::value(path, "plan", name, format_args!("{value}"))),
        None => Ok(()),
    }
}
