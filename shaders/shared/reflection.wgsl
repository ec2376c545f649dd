// Specular lobes and the Fresnel equation: twins of core/src/scene/brdf.rs and fresnel.rs.

struct Specular {
    metal: vec3f,
    metallic: f32,
    dielectric: f32,
    // 0 for an ideal mirror, negative for none.
    alpha: f32,
    side: u32,
    // Of Phong's lobe, 0 of GGX.
    exponent: f32,
}

// From where a coat or the boundary of glass is met: twin of `glass::Side`.
const OUTSIDE: u32 = 0u;
const INSIDE: u32 = 1u;
const PANE: u32 = 2u;

fn side_met(material: MaterialInfo, back: bool) -> u32 {
    if material.passes <= 0.0 {
        return OUTSIDE;
    }
    return select(PANE, select(OUTSIDE, INSIDE, back), material.solid != 0u);
}

// Twin of `fresnel::effective_index`.
fn effective_index(normal_reflectance: f32) -> f32 {
    let root = sqrt(clamp(normal_reflectance, 0.0, 0.9999));
    return (1.0 + root) / (1.0 - root);
}

// Twin of `fresnel::reflectance`.
fn fresnel(normal_reflectance: f32, cos_theta: f32) -> f32 {
    if normal_reflectance <= 0.0 {
        return 0.0;
    }
    if normal_reflectance > 0.9999 {
        return 1.0;
    }
    let n = effective_index(normal_reflectance);
    let c = clamp(cos_theta, 0.0, 1.0);
    let g = sqrt(max(n * n + c * c - 1.0, 0.0));
    let ratio = (g - c) / (g + c);
    let turned = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return min(0.5 * ratio * ratio * (1.0 + turned * turned), 1.0);
}

// Twin of `Side::reflectance`.
fn boundary_reflectance(side: u32, normal_reflectance: f32, cos_theta: f32) -> f32 {
    if side == INSIDE {
        let c = clamp(cos_theta, 0.0, 1.0);
        let n = effective_index(normal_reflectance);
        let outside = 1.0 - n * n * (1.0 - c * c);
        if outside <= 0.0 {
            return 1.0;
        }
        return fresnel(normal_reflectance, sqrt(outside));
    }
    let once = fresnel(normal_reflectance, cos_theta);
    return select(once, 2.0 * once / (1.0 + once), side == PANE);
}

// Twin of `Specular::reflectance`.
fn specular_reflectance(specular: Specular, cos_theta: f32) -> vec3f {
    return specular_reflectance_at(specular, cos_theta, cos_theta);
}

// Twin of `Specular::reflectance_at`.
fn specular_reflectance_at(specular: Specular, metal_cosine: f32, coat_cosine: f32) -> vec3f {
    let metal = vec3f(
        fresnel(specular.metal.x, metal_cosine),
        fresnel(specular.metal.y, metal_cosine),
        fresnel(specular.metal.z, metal_cosine));
    let coat = boundary_reflectance(specular.side, specular.dielectric, coat_cosine);
    return specular.metallic * metal + vec3f((1.0 - specular.metallic) * coat);
}

// Twin of `Specular::of_uniform_light`.
fn reflectance_of_uniform_light(specular: Specular, cos_theta: f32) -> vec3f {
    return select(1.0, cos_theta, specular.exponent > 0.0) * specular_reflectance(specular, cos_theta);
}

fn is_lit(surface: Surface) -> bool {
    return !surface.back || materials[triangles[surface.triangle].material].double_sided != 0u;
}

// The specular lobe of the side seen.
fn specular_at(surface: Surface) -> Specular {
    let material = materials[triangles[surface.triangle].material];
    if material.alpha < 0.0 || !is_lit(surface) {
        return Specular(vec3f(0.0), 0.0, 0.0, -1.0, OUTSIDE, 0.0);
    }
    let base = textured(material.reflectance, material.reflectance_texture, surface.uv);
    let side = side_met(material, surface.back);
    return Specular(base, material.metallic, material.dielectric, material.alpha, side, material.exponent);
}
