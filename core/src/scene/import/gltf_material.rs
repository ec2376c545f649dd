//! glTF materials and their textures.

use super::{accessor, gltf::uri_bytes, model::Model, picture};
use crate::{
    math::image::LinearImage,
    scene::{
        brdf::LobeShape,
        material::{DIFFUSE_ROUGHNESS, MIRROR_ROUGHNESS, Material, Texture},
    },
};
use ::gltf::{
    Document,
    material::AlphaMode,
    texture::{Info, WrappingMode},
};
use glam::{Affine2, Vec2, Vec3};
use std::{collections::HashMap, path::Path, sync::Arc};

/// Which texture coordinates a material's surfaces use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvSource {
    /// Set in the mesh.
    pub set: u32,
    /// KHR_texture_transform, applied to the mesh's coordinates.
    pub transform: Affine2,
    /// Whether the material has a texture.
    pub textured: bool,
}

/// Reads all materials, the default one last, and the textures they use; returns their coordinates.
/// A texture that cannot be read is noted and white.
pub fn read(path: &Path, document: &Document, buffers: &[Vec<u8>], model: &mut Model) -> Vec<UvSource> {
    let mut reader = Reader { path, document, buffers, textures: HashMap::new() };
    let mut sources = Vec::new();
    for material in document.materials() {
        let (material, source) = reader.material(&material, model);
        model.materials.push(material);
        sources.push(source);
    }
    model.materials.push(Material {
        name: "default".into(),
        reflectance: Vec3::splat(super::LARGEST_REFLECTANCE),
        ..Material::default()
    });
    sources.push(UvSource { set: 0, transform: Affine2::IDENTITY, textured: false });
    sources
}

struct Reader<'a> {
    path: &'a Path,
    document: &'a Document,
    buffers: &'a [Vec<u8>],
    /// Texture of each image read; `None` where that failed.
    textures: HashMap<usize, Option<usize>>,
}

impl Reader<'_> {
    fn material(&mut self, material: &::gltf::Material, model: &mut Model) -> (Material, UvSource) {
        let name = match (material.name(), material.index()) {
            (Some(name), _) if !name.is_empty() => name.to_string(),
            (_, index) => format!("material {}", index.unwrap_or(0)),
        };
        let pbr = material.pbr_metallic_roughness();
        let notes = &mut model.notes;
        if material.unlit() {
            notes.add("unlit materials are lit", &name);
        }
        let transmission = material.transmission();
        if transmission.as_ref().is_some_and(|t| t.transmission_texture().is_some()) {
            notes.add("transmission maps are ignored, their factors are not", &name);
        }
        let transmission = transmission.map_or(0.0, |t| t.transmission_factor());
        if transmission > 0.0 && pbr.roughness_factor() >= MIRROR_ROUGHNESS {
            notes.add("rough glass is shown clear", &name);
        }
        if material.alpha_mode() != AlphaMode::Opaque {
            notes.add("transparency is shown opaque", &name);
        }
        if pbr.metallic_factor() > 0.0 && pbr.roughness_factor() >= DIFFUSE_ROUGHNESS {
            notes.add("rough metal is shown as diffuse reflection", &name);
        }
        if pbr.metallic_roughness_texture().is_some() {
            notes.add("metallic-roughness maps are ignored, their factors are not", &name);
        }
        if material.normal_texture().is_some() {
            notes.add("normal maps are ignored", &name);
        }
        if material.occlusion_texture().is_some() {
            notes.add("occlusion maps are ignored; light is computed", &name);
        }
        let (base, emissive) = (pbr.base_color_texture(), material.emissive_texture());
        let source = base.as_ref().or(emissive.as_ref()).map(uv_source);
        if let (Some(source), Some(emissive)) = (source, emissive.as_ref())
            && source != uv_source(emissive)
        {
            notes.add("the emissive texture follows the base colour's texture coordinates", &name);
        }
        let factor = pbr.base_color_factor();
        let strength = material.emissive_strength().unwrap_or(1.0);
        let material = Material {
            reflectance: Vec3::new(factor[0], factor[1], factor[2]),
            reflectance_texture: base.and_then(|info| self.texture(&info, &name, model)),
            emission: Vec3::from(material.emissive_factor()) * strength,
            emission_texture: emissive.and_then(|info| self.texture(&info, &name, model)),
            roughness: pbr.roughness_factor(),
            lobe_shape: LobeShape::Ggx,
            metallic: pbr.metallic_factor(),
            // 0 stands for a coat that reflects all, as older files wanted it.
            ior: material.ior().filter(|n| *n >= 1.0).unwrap_or(1.5),
            transmission,
            solid: material.volume().is_some_and(|v| v.thickness_factor() > 0.0),
            double_sided: material.double_sided(),
            name,
        };
        let plain = UvSource { set: 0, transform: Affine2::IDENTITY, textured: false };
        (material, source.unwrap_or(plain))
    }

    fn texture(&mut self, info: &Info, owner: &str, model: &mut Model) -> Option<usize> {
        let texture = info.texture();
        let sampler = texture.sampler();
        if [sampler.wrap_s(), sampler.wrap_t()] != [WrappingMode::Repeat; 2] {
            model.notes.add("clamped and mirrored textures repeat", owner);
        }
        let image = texture.source().index();
        if let Some(&known) = self.textures.get(&image) {
            return known;
        }
        let read = match self.image(image) {
            Ok(texture) => {
                model.textures.push(Arc::new(texture));
                Some(model.textures.len() - 1)
            }
            Err(cause) => {
                let cause = super::one_line(cause);
                model.notes.add(&format!("a texture is missing and shown white ({cause})"), owner);
                None
            }
        };
        self.textures.insert(image, read);
        read
    }

    fn image(&self, index: usize) -> Result<Texture, String> {
        let json = self.document.as_json().images.get(index).ok_or("no such image")?;
        let decoded: LinearImage = if let Some(view) = &json.buffer_view {
            let view = self.document.views().nth(view.value()).ok_or("no such buffer view")?;
            picture::decode(accessor::view_bytes(&view, self.buffers)?)
        } else if let Some(uri) = &json.uri {
            picture::decode(&uri_bytes(self.path, uri)?)
        } else {
            return Err(format!("image {index} names no data"));
        }
        .map_err(|cause| format!("image {index}: {cause}"))?;
        Ok(decoded)
    }
}

fn uv_source(info: &Info) -> UvSource {
    let Some(transform) = info.texture_transform() else {
        return UvSource { set: info.tex_coord(), transform: Affine2::IDENTITY, textured: true };
    };
    // glTF turns counter-clockwise in a space with v down: the negative angle of a v-up matrix.
    let (scale, angle) = (Vec2::from(transform.scale()), -transform.rotation());
    UvSource {
        set: transform.tex_coord().unwrap_or(info.tex_coord()),
        transform: Affine2::from_scale_angle_translation(scale, angle, Vec2::from(transform.offset())),
        textured: true,
    }
}
