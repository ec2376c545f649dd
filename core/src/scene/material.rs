//! Surface materials: what they reflect and what they emit.

use super::{
    brdf::{Brdf, Lobe, LobeShape, Specular},
    fresnel,
    glass::{Glass, Side},
};
use crate::math::image::LinearImage;
use glam::{Vec2, Vec3};

/// A linear texture; reflectance or a factor on emission.
pub type Texture = LinearImage;

/// Roughness below which a specular lobe is an ideal mirror: its blur would be half a degree.
pub const MIRROR_ROUGHNESS: f32 = 0.05;

/// Roughness from which on a specular lobe counts as diffuse: half of it lies more than 14° off the
/// mirrored direction, and there is little in it that the eye would call a reflection.
pub const DIFFUSE_ROUGHNESS: f32 = 0.5;

/// A surface's material: glTF's metallic–roughness model, see [`Brdf`]. A rough one is Lambertian, with
/// [`Self::reflectance`] whatever its metallic factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from the file.
    pub name: String,
    /// Base colour per channel, in [0, 1): diffuse reflectance ρ of what is no metal, normal reflectance of metal.
    pub reflectance: Vec3,
    /// Texture multiplied into `reflectance`: index into [`super::Scene::textures`].
    pub reflectance_texture: Option<usize>,
    /// Emitted radiance, cd/m² (nit) per channel, uniform over directions.
    pub emission: Vec3,
    /// Texture multiplied into `emission`.
    pub emission_texture: Option<usize>,
    /// glTF roughness, the square root of GGX α.
    pub roughness: f32,
    /// What lobe it has where it is glossy.
    pub lobe_shape: LobeShape,
    /// glTF metallic factor.
    pub metallic: f32,
    /// Index of refraction of the coat of what is no metal (KHR_materials_ior).
    pub ior: f32,
    /// Share of what its coat does not reflect that goes on through it (KHR_materials_transmission).
    pub transmission: f32,
    /// Whether it bounds a solid that bends light, and is not a thin pane (KHR_materials_volume).
    pub solid: bool,
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
            lobe_shape: LobeShape::Ggx,
            metallic: 0.0,
            ior: 1.5,
            transmission: 0.0,
            solid: false,
            double_sided: false,
        }
    }
}

impl Material {
    /// Whether it is so smooth a metal that rays of the irradiance volume are reflected by it as by a
    /// mirror, with `reflectance` for the share that is left: metallic over ½, roughness under 0.05.
    pub fn is_mirror(&self) -> bool {
        self.metallic > 0.5 && self.roughness < MIRROR_ROUGHNESS
    }

    /// Share of what it does not reflect that goes on through it, beside its colour: t (1 − m).
    pub fn passes(&self) -> f32 {
        (self.transmission * (1.0 - self.metallic)).clamp(0.0, 1.0)
    }

    /// Whether light passes through it.
    pub fn is_glass(&self) -> bool {
        self.passes() > 0.0
    }

    /// Whether it has a specular lobe.
    pub fn is_specular(&self) -> bool {
        self.is_glass() || self.roughness < DIFFUSE_ROUGHNESS && (self.metallic > 0.0 || self.ior != 1.0)
    }

    /// Width α of its specular lobe, if it has one: the square of the roughness, 0 for an ideal mirror and for glass.
    pub fn alpha(&self) -> Option<f32> {
        let sharp = self.is_glass() || self.roughness < MIRROR_ROUGHNESS;
        let alpha = if sharp { 0.0 } else { self.roughness * self.roughness };
        self.is_specular().then_some(alpha)
    }

    /// Its specular lobe, if it has one that is no ideal mirror's.
    pub fn lobe(&self) -> Option<Lobe> {
        self.alpha().filter(|alpha| *alpha > 0.0).map(|alpha| Lobe::new(self.lobe_shape, alpha))
    }

    /// Normal reflectance of the coat of what is no metal.
    pub fn coat_reflectance(&self) -> f32 {
        fresnel::normal_reflectance(self.ior)
    }

    /// Share of the base colour that is Lambertian reflectance: 1 without a specular lobe, else what is no
    /// metal, lies beneath a coat and lets nothing pass, (1 − m)(1 − F̄)(1 − t).
    pub fn diffuse_share(&self) -> f32 {
        if !self.is_specular() {
            return 1.0;
        }
        let kept = 1.0 - self.transmission.clamp(0.0, 1.0);
        (1.0 - self.metallic.clamp(0.0, 1.0)) * (1.0 - fresnel::hemispherical(self.coat_reflectance())) * kept
    }

    /// What its front does to light at texture coordinates.
    pub fn brdf_at(&self, uv: Vec2, textures: &[std::sync::Arc<Texture>]) -> Brdf {
        self.brdf_of(self.reflectance_at(uv, textures))
    }

    /// Whether it has a specular lobe that is no ideal mirror's.
    pub fn is_glossy(&self) -> bool {
        self.lobe().is_some()
    }

    /// What its front does to light where its base colour is this.
    pub fn brdf_of(&self, base: Vec3) -> Brdf {
        let side = if self.is_glass() && !self.solid { Side::Pane } else { Side::Outside };
        let specular = self.alpha().map(|alpha| Specular {
            metal: base,
            metallic: self.metallic.clamp(0.0, 1.0),
            dielectric: self.coat_reflectance(),
            side,
            alpha,
            shape: self.lobe_shape,
        });
        let glass = self.is_glass().then(|| Glass {
            tint: base * self.passes(),
            dielectric: self.coat_reflectance(),
            side,
        });
        Brdf { diffuse: base * self.diffuse_share(), specular, glass }
    }

    /// Lambertian reflectance at texture coordinates.
    pub fn diffuse_at(&self, uv: Vec2, textures: &[std::sync::Arc<Texture>]) -> Vec3 {
        self.reflectance_at(uv, textures) * self.diffuse_share()
    }

    /// Base colour at texture coordinates.
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
