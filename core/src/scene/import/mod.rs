//! Scenes from files: RON scenes, glTF, GLB and OBJ models.
//!
//! A model file is read into a `model::Model`, checked and cleaned there (`sanity`), and only then
//! joined to a [`Scene`]; so every format passes the same checks. What a file asks for and this
//! program lacks becomes one warning line a kind, never a silent loss. Broken data is an error that
//! names the file and the cause in one line; nothing here panics on any bytes.
//!
//! Limits: geometry is triangles, materials are metal–roughness ones; skins, animations, morph targets, alpha,
//! points and lines are named in a warning and left out. The `gltf` crate parses and validates the
//! JSON only: its own accessor readers and image import panic on out-of-range views, so the binary
//! data is read by `accessor` with every range checked.

mod accessor;
mod gltf;
mod gltf_material;
mod model;
mod obj;
mod picture;
mod ron;
mod sanity;
mod weld;

use super::{
    Scene,
    camera::Camera,
    check,
    lamp::{Lamp, LampKind},
    material::Material,
};
use glam::{Affine3A, Vec3};
use model::Model;
use std::{collections::HashMap, ops::Range, path::Path};

/// Largest coordinate taken, m.
pub const LARGEST_COORDINATE: f32 = 1e6;

/// Largest diffuse reflectance kept; above it interreflection would not settle.
pub const LARGEST_REFLECTANCE: f32 = 0.999;

/// Illuminance that the lamp placed in a scene without emitters gives at the scene's centre, lx.
pub const ADDED_ILLUMINANCE: f32 = 500.0;

/// Why a file is no scene. Every message names the file and fits on one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {cause}")]
    Unreadable {
        /// File.
        file: String,
        /// What the system says.
        cause: String,
    },
    /// The file's extension is none of those known.
    #[error("{file}: unknown kind of file: .ron, .gltf, .glb and .obj are known")]
    UnknownFormat {
        /// File.
        file: String,
    },
    /// The file breaks its format.
    #[error("{file}: {cause}")]
    Malformed {
        /// File.
        file: String,
        /// What is wrong with it.
        cause: String,
    },
    /// A position that is not a number or too large.
    #[error("{file}: object \"{object}\" has a coordinate of {value} m; finite ones up to 1e6 m are taken")]
    Coordinate {
        /// File.
        file: String,
        /// Object.
        object: String,
        /// Offending coordinate, m.
        value: f32,
    },
    /// A lamp, material, camera or plane with a value that has no meaning.
    #[error("{file}: {owner}: {quantity} is {value}")]
    Value {
        /// File.
        file: String,
        /// What has the value.
        owner: String,
        /// Quantity, with its unit.
        quantity: String,
        /// The value.
        value: String,
    },
    /// Nothing to light.
    #[error("{file}: contains no triangles")]
    Empty {
        /// File.
        file: String,
    },
}

impl SceneError {
    /// An error of the file's format; line breaks in the cause become spaces.
    fn malformed(path: &Path, cause: impl std::fmt::Display) -> Self {
        Self::Malformed { file: path.display().to_string(), cause: one_line(cause) }
    }

    fn value(path: &Path, owner: impl Into<String>, quantity: &str, value: impl std::fmt::Debug) -> Self {
        Self::Value {
            file: path.display().to_string(),
            owner: owner.into(),
            quantity: quantity.into(),
            value: one_line(format!("{value:?}")),
        }
    }
}

/// Loads a scene from a `.ron`, `.gltf`, `.glb` or `.obj` file, told apart by extension.
///
/// A model file opened alone has a camera that frames everything unless it brings one, and a point
/// lamp above it if nothing in it emits; [`Scene::warnings`] says so.
///
/// # Errors
/// If the file or a model it names cannot be read, is malformed, holds a coordinate or quantity that
/// is not a sensible number, or contains no triangles.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let mut scene = if extension(path) == "ron" { ron::load(path)? } else { load_model(path)? };
    darken(&mut scene);
    Ok(scene)
}

fn load_model(path: &Path) -> Result<Scene, SceneError> {
    let model = read_model(path)?;
    let mut scene = Scene { name: stem(path), ..Scene::default() };
    let camera = model.camera;
    model.append_to(&mut scene, Affine3A::IDENTITY, false, "");
    scene.camera = camera.unwrap_or_else(|| framing_camera(&scene));
    if !emits(&scene) {
        add_lamp(&mut scene);
    }
    Ok(scene)
}

/// Adds a model's objects and lamps to a scene and returns the indices of the new objects, all
/// movable. The model's camera is left out; its warnings join the scene's.
///
/// # Errors
/// As [`load`]; the scene is then as it was. A `.ron` scene cannot be added.
pub fn add_model(scene: &mut Scene, path: &Path) -> Result<Range<usize>, SceneError> {
    let model = read_model(path)?;
    let added = model.append_to(scene, Affine3A::IDENTITY, true, &format!("{}: ", file_name(path)));
    darken(scene);
    Ok(added)
}

/// Takes the light off the sides that no light can reach, the insides of solids and the outsides of rooms,
/// where materials are double-sided because the file does not say otherwise: so the inside of a solid is
/// known as such, and no element is spent on it.
fn darken(scene: &mut Scene) {
    let double = |scene: &Scene, object: usize| {
        scene.objects[object].parts.iter().any(|p| scene.materials[p.material].double_sided)
    };
    if !(0..scene.objects.len()).any(|o| double(scene, o)) {
        return;
    }
    let dark = check::with_dark_sides(scene, &super::geometry::Geometry::new(scene));
    let mut single_sided: HashMap<usize, usize> = HashMap::new();
    for object in dark.into_iter().filter(|&o| double(scene, o)).collect::<Vec<_>>() {
        let materials = &mut scene.materials;
        for part in &mut scene.objects[object].parts {
            // Light gets into what is of glass.
            if materials[part.material].is_glass() {
                continue;
            }
            part.material = *single_sided.entry(part.material).or_insert_with(|| {
                materials.push(Material { double_sided: false, ..materials[part.material].clone() });
                materials.len() - 1
            });
        }
    }
}

fn read_model(path: &Path) -> Result<Model, SceneError> {
    let mut model = match extension(path).as_str() {
        "gltf" | "glb" => gltf::read(path)?,
        "obj" => obj::read(path)?,
        "ron" => return Err(SceneError::malformed(path, "a .ron scene cannot be used as a model")),
        _ => return Err(SceneError::UnknownFormat { file: path.display().to_string() }),
    };
    sanity::clean(path, &mut model)?;
    Ok(model)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, SceneError> {
    std::fs::read(path)
        .map_err(|cause| SceneError::Unreadable { file: path.display().to_string(), cause: one_line(cause) })
}

fn emits(scene: &Scene) -> bool {
    !scene.lamps.is_empty()
        || scene
            .objects
            .iter()
            .flat_map(|o| &o.parts)
            .any(|p| scene.materials[p.material].emission != Vec3::ZERO)
}

fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    super::geometry::Geometry::new(scene).bounds()
}

/// A camera that sees all of the scene from above and to the side.
fn framing_camera(scene: &Scene) -> Camera {
    let (low, high) = bounds(scene);
    let target = 0.5 * (low + high);
    let radius = (0.5 * (high - low).length()).max(1e-3);
    let vertical_fov = Camera::default().vertical_fov;
    let distance = 1.05 * radius / (0.5 * vertical_fov).sin();
    let eye = target + Vec3::new(0.55, 0.45, 0.8).normalize() * distance;
    Camera { eye, target, up: Vec3::Y, vertical_fov }
}

/// Places a point lamp above a scene in which nothing emits.
fn add_lamp(scene: &mut Scene) {
    let (low, high) = bounds(scene);
    let centre = 0.5 * (low + high);
    let distance = (high - low).length().max(1e-3);
    let intensity = Vec3::splat(ADDED_ILLUMINANCE * distance * distance);
    scene.lamps.push(Lamp {
        name: "added lamp".into(),
        kind: LampKind::Point { intensity },
        world_from_lamp: Affine3A::from_translation(centre + Vec3::Y * distance),
        dimmer: 1.0,
    });
    scene.warnings.push("no lamps: nothing is lit; a lamp was placed above".into());
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

fn one_line(text: impl std::fmt::Display) -> String {
    text.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
