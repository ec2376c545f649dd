//! Surface materials: what they reflect and what they emit.

use crate::math::image::LinearImage;
use glam::{Vec2, Vec3};

/// A linear texture; reflectance or a factor on emission.
pub type Texture = LinearImage;

/// A surface's material. Reflection is Lambertian, ρ/π; the room `mirror` and `glossy` read the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from the file.
    pub name: String,
    /// Diffuse reflectance ρ per channel, in [0, 1).
    pub reflectance: Vec3,
    /// Texture multiplied into `reflectance`: index into [`super::Scene::textures`].
    pub reflectance_texture: Option<usize>,
    /// Emitted radiance, cd/m² (nit) per channel, uniform over directions.
    pub emission: Vec3,
    /// Texture multiplied into `emission`.
    pub emission_texture: Option<usize>,
    /// glTF roughness, the square root of GGX α.
    pub roughness: f32,
    /// glTF metallic factor.
    pub metallic: f32,
    /// Whether the back reflects and emits as the front does; a single-sided back is black.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "grey".into(),
            reflectance: Vec3::splat(0.5),
            reflectance_texture: None,
            emission: Vec3::ZERO,
            emission_texture: None,
            roughness: 1.0,
            metallic: 0.0,
            double_sided: false,
        }
    }
}

impl Material {
    /// Whether it is so smooth a metal that rays of the irradiance volume are reflected by it as by a
    /// mirror, with `reflectance` for the share that is left: metallic over ½, roughness under 0.05.
    pub fn is_mirror(&self) -> bool {
        self.metallic > 0.5 && self.roughness < 0.05
    }

    /// Diffuse reflectance at texture coordinates.
    pub fn reflectance_at(&self, uv: Vec2, textures: &[std::sync::Arc<Texture>]) -> Vec3 {
        match self.reflectance_texture {
            Some(i) => self.reflectance * textures[i].sample_repeat(uv),
            None => self.reflectance,
        }
    }

    /// Emitted radiance at texture coordinates, cd/m², before the object's dimmer.
    pub fn emission_at(&self, uv: Vec2, textures: &[std::sync::Arc<Texture>]) -> Vec3 {
        match self.emission_texture {
            Some(i) => self.emission * textures[i].sample_repeat(uv),
            None => self.emission,
        }
    }
}
