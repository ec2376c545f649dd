//! How much a polished surface reflects, by angle: the Fresnel equation fitted to the reflectance at
//! normal incidence (Cook and Torrance 1981; Bastos 1999, §6.7.1).
//!
//! The normal reflectance of a material is usually known, its index of refraction is not. So an
//! effective index is taken from it per channel, and the equation for unpolarised light gives the rest:
//! towards grazing every channel goes to 1, which is what shifts the colour of gold and copper.
//!
//! Bastos's Eq. 6.9 divides the reflectance by π (N·L)(N·V) before it modulates a mirror image. That is
//! the factor of a scattering BRDF: it grows without bound at grazing angles. The modulation of a mirror
//! image is F itself, at most 1; so it is here. His half vector (Eq. 6.11) has to be normalised.

use glam::Vec3;

/// Largest normal reflectance that has an effective index: beyond it a surface is an ideal mirror.
const LARGEST_FITTED: f32 = 0.9999;

/// Effective index of refraction of a normal reflectance in [0, 1): n = (1 + √F₀) / (1 − √F₀).
///
/// Bastos 1999, Eq. 6.14.
pub fn effective_index(normal_reflectance: f32) -> f32 {
    let root = normal_reflectance.clamp(0.0, LARGEST_FITTED).sqrt();
    (1.0 + root) / (1.0 - root)
}

/// Normal reflectance of an index of refraction: F₀ = ((n − 1) / (n + 1))². Bastos 1999, Eq. 6.13.
pub fn normal_reflectance(index: f32) -> f32 {
    ((index - 1.0) / (index + 1.0)).powi(2)
}

/// Reflectance of unpolarised light at an angle of incidence with this cosine, in [0, 1].
///
/// F = ½ (g − c)² / (g + c)² (1 + (c (g + c) − 1)² / (c (g − c) + 1)²), c = cos θ, g² = n² + c² − 1
/// (Bastos 1999, Eq. 6.10–6.12). Has a twin in `shaders/shared/reflection.wgsl`.
pub fn reflectance(normal_reflectance: f32, cos_theta: f32) -> f32 {
    if normal_reflectance <= 0.0 {
        return 0.0;
    }
    if normal_reflectance > LARGEST_FITTED {
        return 1.0;
    }
    let n = effective_index(normal_reflectance);
    let c = cos_theta.clamp(0.0, 1.0);
    let g = (n * n + c * c - 1.0).max(0.0).sqrt();
    let ratio = (g - c) / (g + c);
    let turned = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    (0.5 * ratio * ratio * (1.0 + turned * turned)).min(1.0)
}

/// [`reflectance`] of each channel.
pub fn reflectance_rgb(normal_reflectance: Vec3, cos_theta: f32) -> Vec3 {
    normal_reflectance.map(|f0| reflectance(f0, cos_theta))
}

/// Schlick's approximation, F₀ + (1 − F₀)(1 − cos θ)⁵ (Schlick 1994): to compare with. For a coat it is at
/// most 0.04 off. Of a metal it makes something else: the real index fitted to one has an angle at which
/// p-polarised light is not reflected, and there [`reflectance`] falls below F₀ before it rises to 1. A metal's
/// true index is complex, and its reflectance between the two.
pub fn schlick(normal_reflectance: f32, cos_theta: f32) -> f32 {
    normal_reflectance + (1.0 - normal_reflectance) * (1.0 - cos_theta.clamp(0.0, 1.0)).powi(5)
}

/// Share of uniform light that is reflected: 2 ∫ F(θ) cos θ sin θ dθ.
///
/// Walsh's closed form (Walsh 1926; Duntley 1942, Eq. 33), in `f64`, as its terms cancel near n = 1.
pub fn hemispherical(normal_reflectance: f32) -> f32 {
    if normal_reflectance > LARGEST_FITTED {
        return 1.0;
    }
    let n = f64::from(effective_index(normal_reflectance));
    if n < 1.001 {
        return 0.0;
    }
    let (n2, n4) = (n * n, n * n * n * n);
    let value = 0.5
        + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln();
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_gives_back_what_was_fitted_and_grazing_gives_one() {
        for f0 in [0.001, 0.04, 0.37, 0.56, 0.63, 0.95, 0.999] {
            assert!((reflectance(f0, 1.0) - f0).abs() < 1e-4, "{f0}: {}", reflectance(f0, 1.0));
            assert!((reflectance(f0, 0.0) - 1.0).abs() < 1e-6);
            assert!((normal_reflectance(effective_index(f0)) - f0).abs() < 1e-5);
        }
        assert_eq!(reflectance(0.0, 0.0), 0.0);
        assert_eq!(reflectance(1.0, 0.5), 1.0);
    }

    #[test]
    fn no_p_polarised_light_is_reflected_at_brewsters_angle() {
        // There half of the s-polarised reflectance is left: ½ ((n² − 1) / (n² + 1))².
        for n in [1.33f32, 1.5, 2.4] {
            let cos = 1.0 / (1.0 + n * n).sqrt();
            let wanted = 0.5 * ((n * n - 1.0) / (n * n + 1.0)).powi(2);
            assert!((reflectance(normal_reflectance(n), cos) - wanted).abs() < 1e-5);
        }
    }

    #[test]
    fn walshs_closed_form_is_the_integral() {
        for f0 in [0.02f32, 0.04, 0.1, 0.5, 0.9, 0.99] {
            let steps = 20_000;
            let sum: f64 = (0..steps)
                .map(|i| {
                    // cos² θ uniform: 2 cos θ sin θ dθ = d(cos² θ).
                    let c = ((f64::from(i) + 0.5) / f64::from(steps)).sqrt();
                    f64::from(reflectance(f0, c as f32))
                })
                .sum();
            let wanted = sum / f64::from(steps);
            assert!((f64::from(hemispherical(f0)) - wanted).abs() < 2e-4, "{f0}: {wanted}");
        }
        assert_eq!(hemispherical(0.0), 0.0);
    }
}
