//! The library of lobes by cos θ: how far each reaches, how much it reflects, where Fresnel is taken.

use crate::{
    math::random::r2_point,
    scene::{
        brdf::{Lobe, Specular},
        fresnel,
    },
};
use glam::Vec3;

/// Angles of a lobe that are tabulated, from cos θ = 0 to 1.
pub const ANGLES: usize = 32;

/// Share of a lobe's light that lies within its support.
const WITHIN: f32 = 0.95;

/// Normal reflectance of the coat that its cosine is fitted to.
const FITTED_COAT: f32 = 0.04;

/// Directions drawn for each angle.
const DRAWN: u32 = 512;

/// A lobe seen at one angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LobeEntry {
    /// Share of uniform light that it keeps: E = ∫ f cos θᵢ dω with F = 1, at most 1.
    pub albedo: f32,
    /// Cosine at which the Fresnel equation gives a coat's mean over the lobe.
    pub coat_cosine: f32,
    /// Cosine that stands for the mean over a metal's lobe: that of the mean angle between view and half vector.
    /// Not fitted as the coat's: a metal's reflectance does not grow with the angle everywhere.
    pub metal_cosine: f32,
    /// Tangent of the angle from the mirrored direction within which 95 % of its light comes: tan β of
    /// Bastos 1999, Eq. 7.7.
    pub support: f32,
}

impl LobeEntry {
    /// A lobe seen at an angle with this cosine; the same bytes on every run.
    pub fn new(lobe: Lobe, cos_theta: f32) -> Self {
        let wo = Vec3::new((1.0 - cos_theta * cos_theta).max(0.0).sqrt(), 0.0, cos_theta);
        let mirrored = Vec3::new(-wo.x, 0.0, wo.z);
        let (mut albedo, mut coat, mut angle) = (0.0f64, 0.0f64, 0.0f64);
        let mut slopes: Vec<(f32, f32)> = Vec::new();
        for i in 0..DRAWN {
            let Some(wi) = lobe.sample(Vec3::Z, wo, r2_point(i, 17)) else { continue };
            let density = lobe.density(Vec3::Z, wi, wo);
            let weight = lobe.value(Vec3::Z, wi, wo) * wi.z / density;
            if !weight.is_finite() {
                continue;
            }
            albedo += f64::from(weight);
            let cos_h = wo.dot((wi + wo).normalize());
            coat += f64::from(weight * fresnel::reflectance(FITTED_COAT, cos_h));
            angle += f64::from(weight * cos_h.clamp(-1.0, 1.0).acos());
            let c = wi.dot(mirrored);
            slopes.push((if c > 0.05 { (1.0 - c * c).max(0.0).sqrt() / c } else { 20.0 }, weight));
        }
        slopes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut left = WITHIN * albedo as f32;
        let reached = slopes.iter().find(|(_, w)| {
            left -= w;
            left <= 0.0
        });
        let (coat_cosine, metal_cosine) = if albedo > 0.0 {
            (cosine_of(FITTED_COAT, (coat / albedo) as f32), (angle / albedo).cos() as f32)
        } else {
            (cos_theta, cos_theta)
        };
        Self {
            albedo: ((albedo / f64::from(DRAWN)) as f32).min(1.0),
            coat_cosine,
            metal_cosine,
            support: reached.map_or(0.0, |s| s.0),
        }
    }
}

/// A lobe at every angle.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeTable {
    /// The lobe.
    pub lobe: Lobe,
    /// By cos θ, [`ANGLES`] of them.
    pub entries: Vec<LobeEntry>,
}

impl LobeTable {
    /// Tabulates a lobe; the same bytes on every run.
    pub fn new(lobe: Lobe) -> Self {
        let entries =
            (0..ANGLES).map(|i| LobeEntry::new(lobe, (i as f32 / (ANGLES - 1) as f32).max(0.01))).collect();
        Self { lobe, entries }
    }

    /// Between the entries around a cosine. Has a twin in `shaders/glossy/convolve.wgsl`.
    pub fn at(&self, cos_theta: f32) -> LobeEntry {
        let x = cos_theta.clamp(0.0, 1.0) * (ANGLES - 1) as f32;
        let i = (x as usize).min(ANGLES - 2);
        let (a, b, f) = (self.entries[i], self.entries[i + 1], x - i as f32);
        let mix = |a: f32, b: f32| a + (b - a) * f;
        LobeEntry {
            albedo: mix(a.albedo, b.albedo),
            coat_cosine: mix(a.coat_cosine, b.coat_cosine),
            metal_cosine: mix(a.metal_cosine, b.metal_cosine),
            support: mix(a.support, b.support),
        }
    }

    /// Share of uniform light that a material with this lobe reflects, per channel: E(θ) F(θ̄). What modulates
    /// the convolved image, as F alone does a mirror's.
    pub fn modulation(&self, specular: &Specular, cos_theta: f32) -> Vec3 {
        let entry = self.at(cos_theta);
        entry.albedo * specular.reflectance_at(entry.metal_cosine, entry.coat_cosine)
    }
}

/// The cosine at which a normal reflectance gives a reflectance.
fn cosine_of(normal_reflectance: f32, reflectance: f32) -> f32 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        // It falls towards normal incidence.
        if fresnel::reflectance(normal_reflectance, middle) > reflectance {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
