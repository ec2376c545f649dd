// Specular lobes and the Fresnel equation: twins of core/src/scene/brdf.rs and fresnel.rs.

struct Specular {
    metal: vec3f,
    metallic: f32,
    dielectric: f32,
    // 0 for an ideal mirror, negative for none.
    alpha: f32,
}

// Twin of `fresnel::reflectance`.
fn fresnel(normal_reflectance: f32, cos_theta: f32) -> f32 {
    if normal_reflectance <= 0.0 {
        return 0.0;
    }
    if normal_reflectance > 0.9999 {
        return 1.0;
    }
    let root = sqrt(normal_reflectance);
    let n = (1.0 + root) / (1.0 - root);
    let c = clamp(cos_theta, 0.0, 1.0);
    let g = sqrt(max(n * n + c * c - 1.0, 0.0));
    let ratio = (g - c) / (g + c);
    let turned = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return min(0.5 * ratio * ratio * (1.0 + turned * turned), 1.0);
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
    let coat = fresnel(specular.dielectric, coat_cosine);
    return specular.metallic * metal + vec3f((1.0 - specular.metallic) * coat);
}

fn is_lit(surface: Surface) -> bool {
    return !surface.back || materials[triangles[surface.triangle].material].double_sided != 0u;
}

// The specular lobe of the side seen.
fn specular_at(surface: Surface) -> Specular {
    let material = materials[triangles[surface.triangle].material];
    if material.alpha < 0.0 || !is_lit(surface) {
        return Specular(vec3f(0.0), 0.0, 0.0, -1.0);
    }
    let base = textured(material.reflectance, material.reflectance_texture, surface.uv);
    return Specular(base, material.metallic, material.dielectric, material.alpha);
}
