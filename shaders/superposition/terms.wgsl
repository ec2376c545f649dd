// Radiance of a surface by term, and the layers it goes into: twin of `pass::Shading`.

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var seen_triangles: texture_2d<u32>;
// Three floats a pixel, layer after layer; then the state of mirrored rays.
@group(1) @binding(2) var<storage, read_write> layers: array<f32>;

struct Terms {
    emitted: vec3f,
    direct: vec3f,
    indirect: vec3f,
}

fn store(pixel: u32, layer: u32, radiance: vec3f) {
    let first = 3u * (layer * frame.size.x * frame.size.y + pixel);
    for (var i = 0u; i < 3u; i++) {
        var value = radiance[i];
        if frame.accumulated > 0u {
            let mean = layers[first + i];
            value = mean + (value - mean) / f32(frame.accumulated + 1u);
        }
        layers[first + i] = value;
    }
}

// Scramble of this frame's shadow rays at a pixel.
fn pixel_scramble(pixel: u32) -> u32 {
    return hash2(pixel, hash2(frame.frame, frame.seed));
}

// By the specular lobe: from the map of what is curved, or as if it were as wide as the hemisphere, of the light
// stored at a surface.
fn wide_reflection(surface: Surface, stored: StoredLight, wo: vec3f) -> vec3f {
    let specular = specular_at(surface);
    if specular.alpha < 0.0 {
        return vec3f(0.0);
    }
    let number = triangles[surface.triangle].environment;
    if general && number != NONE {
        let cosine = dot(surface.normal, wo);
        let mirrored = 2.0 * cosine * surface.normal - wo;
        return specular_reflectance(specular, cosine) * environment_radiance(number, surface.position, mirrored);
    }
    return specular_reflectance(specular, dot(wo, surface.normal)) * (1.0 / PI) * (stored.direct + stored.indirect);
}

// All but the lobe; direct light by shadow rays or from the elements.
fn diffuse_terms(surface: Surface, stored: StoredLight, rays: bool, scramble: u32) -> Terms {
    let own = own_light(surface);
    var terms = Terms(own.emission, vec3f(0.0), vec3f(0.0));
    let brdf = own.reflectance * (1.0 / PI);
    terms.indirect = brdf * stored.indirect;
    terms.direct = brdf * stored.direct;
    if rays && any(brdf != vec3f(0.0)) && objects[triangles[surface.triangle].object].stored_direct == 0u {
        let origin = offset_origin(surface.position, surface.geometric_normal);
        terms.direct = brdf * total_irradiance(frame, Receiver(surface.position, surface.normal, origin), scramble);
    }
    return terms;
}
