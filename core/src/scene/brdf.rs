//! Reflection at a point: a Lambertian part and at most one specular lobe, evaluated and sampled.
//!
//! The lobe is GGX microfacets with Smith's height-correlated shadowing, as glTF's metallic–roughness
//! model asks for, Phong's where a scene asks for that, or none but the direction itself on an ideal mirror. What a dielectric coat reflects
//! is taken from the Lambertian part beneath by its hemispherical mean, not by angle: then that part
//! stays Lambertian, which radiosity is built on, and energy holds for uniform light; seen at a grazing
//! angle, a bright coated surface may return up to its diffuse reflectance too much.

use super::{
    fresnel,
    glass::{Glass, Side},
};
use crate::math::frame::{cosine_direction, frame_from_normal, mirrored};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// What a point of a surface does to light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Brdf {
    /// Lambertian reflectance ρ per channel.
    pub diffuse: Vec3,
    /// The specular lobe.
    pub specular: Option<Specular>,
    /// What passes through.
    pub glass: Option<Glass>,
}

/// A specular lobe: a mix by area of polished metal and a clear coat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Specular {
    /// Normal reflectance of the metal per channel.
    pub metal: Vec3,
    /// Share of metal.
    pub metallic: f32,
    /// Normal reflectance of the coat.
    pub dielectric: f32,
    /// From where the coat is met.
    pub side: Side,
    /// Width α of its lobe, GGX's; 0 is an ideal mirror.
    pub alpha: f32,
    /// What lobe that is.
    pub shape: LobeShape,
}

impl Specular {
    /// Reflectance F per channel at an angle of incidence with this cosine, in [0, 1]: what modulates a
    /// mirror image. Has a twin in `shaders/shared/reflection.wgsl`.
    pub fn reflectance(&self, cos_theta: f32) -> Vec3 {
        self.reflectance_at(cos_theta, cos_theta)
    }

    /// [`Self::reflectance`] with an angle for the metal and one for the coat.
    pub fn reflectance_at(&self, metal_cosine: f32, coat_cosine: f32) -> Vec3 {
        let coat = self.side.reflectance(self.dielectric, coat_cosine);
        self.metallic * fresnel::reflectance_rgb(self.metal, metal_cosine)
            + Vec3::splat((1.0 - self.metallic) * coat)
    }

    /// Its lobe by itself; of no meaning for an ideal mirror.
    pub fn lobe(&self) -> Lobe {
        Lobe::new(self.shape, self.alpha)
    }

    /// Share of uniform light that it reflects along a direction with this cosine, where lobes are not tabulated:
    /// F(θ), of Phong's lobe F(θ) cos θ. That is E(θ) of a lobe that the horizon does not cut: ∫ f cos θᵢ dω with the mean
    /// of its directions, (n + 1)/(n + 2) of the mirrored one. What GGX loses to its own shadowing is left out. Has a
    /// twin in `shaders/shared/reflection.wgsl`.
    pub fn of_uniform_light(&self, cos_theta: f32) -> Vec3 {
        let kept = if self.shape == LobeShape::Phong && !self.is_mirror() { cos_theta } else { 1.0 };
        kept * self.reflectance(cos_theta)
    }

    /// Whether it is an ideal mirror: all light goes into one direction.
    pub fn is_mirror(&self) -> bool {
        self.alpha == 0.0
    }
}

/// A direction drawn, and what arrives from it counts times the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered {
    /// Direction towards where light comes from.
    pub wi: Vec3,
    /// f cos θ / density of the Lambertian part, per channel.
    pub diffuse: Vec3,
    /// The same of the specular lobe.
    pub specular: Vec3,
    /// Density per solid angle; infinite for the one direction of an ideal mirror.
    pub density: f32,
}

impl Brdf {
    /// Whether nothing is reflected and nothing passes.
    pub fn is_black(&self) -> bool {
        self.diffuse == Vec3::ZERO && self.specular.is_none() && self.glass.is_none()
    }

    /// The same of a solid's boundary met from within.
    pub(super) fn met_from_inside(self) -> Self {
        let within = |side| if side == Side::Outside { Side::Inside } else { side };
        let Some(glass) = self.glass else { return self };
        let specular = self.specular.map(|s| Specular { side: within(s.side), ..s });
        Self { specular, glass: Some(Glass { side: within(glass.side), ..glass }), ..self }
    }

    /// Value f of the Lambertian part and of the specular lobe, 1/sr per channel; that of an ideal mirror,
    /// which no two directions meet by chance, is zero.
    ///
    /// GGX: f = D(h) G(wi, wo) F(wo·h) / (4 cos θᵢ cos θₒ) (Walter et al. 2007, Eq. 20).
    pub fn value(&self, normal: Vec3, wi: Vec3, wo: Vec3) -> [Vec3; 2] {
        let (ci, co) = (normal.dot(wi), normal.dot(wo));
        if ci <= 0.0 || co <= 0.0 {
            return [Vec3::ZERO; 2];
        }
        let lobe = self.specular.filter(|s| !s.is_mirror()).map_or(Vec3::ZERO, |s| {
            let h = (wi + wo).normalize_or_zero();
            s.reflectance(wo.dot(h)) * s.lobe().value(normal, wi, wo)
        });
        [self.diffuse * FRAC_1_PI, lobe]
    }

    /// Share of [`Self::sample`]'s directions that the specular lobe draws, seen along `wo`.
    fn specular_share(&self, cos_o: f32) -> f32 {
        let Some(specular) = self.specular else { return 0.0 };
        let lobe = specular.reflectance(cos_o).max_element();
        lobe / (lobe + self.diffuse.max_element()).max(f32::MIN_POSITIVE)
    }

    /// Density per solid angle with which [`Self::sample`] draws a direction; without an ideal mirror's own.
    pub fn density(&self, normal: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        let (ci, co) = (normal.dot(wi), normal.dot(wo));
        if ci <= 0.0 || co <= 0.0 {
            return 0.0;
        }
        let share = self.specular_share(co);
        let lobe = self.specular.filter(|s| !s.is_mirror());
        let lobe = lobe.map_or(0.0, |s| s.lobe().density(normal, wi, wo));
        share * lobe + (1.0 - share) * ci * FRAC_1_PI
    }

    /// Draws a direction: `pick` in [0, 1) chooses the part, `u` in [0, 1)² the direction. `None` below the
    /// surface.
    pub fn sample(&self, normal: Vec3, wo: Vec3, pick: f32, u: Vec2) -> Option<Scattered> {
        let co = normal.dot(wo);
        if co <= 0.0 {
            return None;
        }
        let share = self.specular_share(co);
        let by_lobe = self.specular.filter(|_| pick < share);
        if let Some(mirror) = by_lobe.filter(Specular::is_mirror) {
            return Some(Scattered {
                wi: mirrored(wo, normal),
                diffuse: Vec3::ZERO,
                specular: mirror.reflectance(co) / share,
                density: f32::INFINITY,
            });
        }
        let wi = match by_lobe {
            Some(s) => s.lobe().sample(normal, wo, u)?,
            None => frame_from_normal(normal) * cosine_direction(u),
        };
        let density = self.density(normal, wi, wo);
        let scale = normal.dot(wi) / density;
        let [diffuse, specular] = self.value(normal, wi, wo);
        (density > 0.0 && scale.is_finite()).then(|| Scattered {
            wi,
            diffuse: diffuse * scale,
            specular: specular * scale,
            density,
        })
    }
}

/// What lobe a glossy surface has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LobeShape {
    /// [`Lobe::Ggx`].
    #[default]
    Ggx,
    /// [`Lobe::Phong`].
    Phong,
}

/// A lobe by itself, as of a surface that absorbs nothing: F = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// Microfacets with the distribution of Trowbridge and Reitz (Walter et al. 2007).
    Ggx {
        /// Width α in (0, 1], the square of glTF's roughness.
        alpha: f32,
    },
    /// Phong's cosine about the mirrored direction, normalised and reciprocal (Lafortune and Willems 1994).
    Phong {
        /// Exponent n.
        exponent: f32,
    },
}

impl Lobe {
    /// A lobe of a width α, GGX's. Phong's is as wide with the exponent n = (1/α² − 1) / 2: a quarter of that of half
    /// vectors, 2/α² − 2 (Walter et al. 2007, §5.2), since directions turn twice as far.
    pub fn new(shape: LobeShape, alpha: f32) -> Self {
        match shape {
            LobeShape::Ggx => Self::Ggx { alpha },
            LobeShape::Phong => Self::Phong { exponent: 0.5 * (1.0 / (alpha * alpha) - 1.0) },
        }
    }

    /// Its shape.
    pub fn shape(self) -> LobeShape {
        match self {
            Self::Ggx { .. } => LobeShape::Ggx,
            Self::Phong { .. } => LobeShape::Phong,
        }
    }

    /// Name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ggx { .. } => "GGX",
            Self::Phong { .. } => "Phong",
        }
    }

    /// Width α.
    pub fn alpha(self) -> f32 {
        match self {
            Self::Ggx { alpha } => alpha,
            Self::Phong { exponent } => 1.0 / (2.0 * exponent + 1.0).sqrt(),
        }
    }

    /// Width α of GGX, exponent of Phong's; the other is 0. As shaders tell lobes apart.
    pub fn parameters(self) -> [f32; 2] {
        match self {
            Self::Ggx { alpha } => [alpha, 0.0],
            Self::Phong { exponent } => [0.0, exponent],
        }
    }

    /// Value f, 1/sr; zero below the surface.
    pub fn value(self, normal: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        let (ci, co) = (normal.dot(wi), normal.dot(wo));
        if ci <= 0.0 || co <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Ggx { alpha } => {
                let h = (wi + wo).normalize_or_zero();
                let g = 1.0 / (1.0 + smith(ci, alpha) + smith(co, alpha));
                ggx(normal, h, alpha) * g / (4.0 * ci * co)
            }
            Self::Phong { exponent } => {
                (exponent + 2.0) / TAU * cosine_power(mirrored(wo, normal), wi, exponent)
            }
        }
    }

    /// Density per solid angle of [`Self::sample`].
    pub fn density(self, normal: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        let co = normal.dot(wo);
        if co <= 0.0 || normal.dot(wi) <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Ggx { alpha } => {
                let h = (wi + wo).normalize_or_zero();
                ggx(normal, h, alpha) / ((1.0 + smith(co, alpha)) * 4.0 * co)
            }
            Self::Phong { exponent } => {
                (exponent + 1.0) / TAU * cosine_power(mirrored(wo, normal), wi, exponent)
            }
        }
    }

    /// Draws a direction from `u` in [0, 1)²; `None` where it lies below the surface.
    ///
    /// GGX by the distribution of visible normals (Heitz 2018).
    pub fn sample(self, normal: Vec3, wo: Vec3, u: Vec2) -> Option<Vec3> {
        let frame = frame_from_normal(normal);
        let wi = match self {
            Self::Ggx { alpha } => {
                let local = frame.transpose() * wo;
                let stretched = Vec3::new(alpha * local.x, alpha * local.y, local.z).normalize();
                let around = frame_from_normal(stretched);
                let (r, phi) = (u.x.sqrt(), TAU * u.y);
                let (sin, cos) = phi.sin_cos();
                let s = 0.5 * (1.0 + stretched.z);
                // The second axis has to lie in the plane of the normal, which the branchless frame's does not.
                let across = Vec3::Z.cross(stretched).normalize_or(around.x_axis);
                let up = stretched.cross(across);
                let x = r * cos;
                let y = (1.0 - s) * (1.0 - x * x).max(0.0).sqrt() + s * r * sin;
                let z = (1.0 - x * x - y * y).max(0.0).sqrt();
                let h = across * x + up * y + stretched * z;
                let h = frame * Vec3::new(alpha * h.x, alpha * h.y, h.z.max(1e-6)).normalize();
                2.0 * wo.dot(h) * h - wo
            }
            Self::Phong { exponent } => {
                // ln of the cosine; 1 − cos² of a narrow lobe would be rounding.
                let ln = u.x.max(f32::MIN_POSITIVE).ln() / (exponent + 1.0);
                let (c, s) = (ln.exp(), (-(2.0 * ln).exp_m1()).max(0.0).sqrt());
                let (sin, cos) = (TAU * u.y).sin_cos();
                frame_from_normal(mirrored(wo, normal)) * Vec3::new(s * cos, s * sin, c)
            }
        };
        (normal.dot(wi) > 0.0).then_some(wi)
    }
}

/// GGX distribution of normals, 1/sr: α² / (π (cos² α² + sin²)²), the sine taken by itself: 1 − cos² of a
/// narrow lobe would be rounding in single precision.
fn ggx(normal: Vec3, h: Vec3, alpha: f32) -> f32 {
    let cos = normal.dot(h);
    if cos <= 0.0 {
        return 0.0;
    }
    let a2 = alpha * alpha;
    let d = cos * cos * a2 + normal.cross(h).length_squared();
    a2 / (PI * d * d)
}

/// cosⁿ of the angle between two directions, 0 beyond a right one; narrow lobes by the sine, as in [`ggx`].
fn cosine_power(a: Vec3, b: Vec3, exponent: f32) -> f32 {
    let cos = a.dot(b);
    if cos <= 0.0 {
        return 0.0;
    }
    let sin2 = a.cross(b).length_squared();
    let ln = if sin2 < 0.5 { 0.5 * (-sin2).ln_1p() } else { cos.ln() };
    (exponent * ln).exp()
}

/// Smith's Λ of GGX: (√(1 + α² tan² θ) − 1) / 2.
fn smith(cos: f32, alpha: f32) -> f32 {
    let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}
