// Spatially variant convolution of the mirror image: twin of core/src/glossy/variant.rs and kernel.rs.

const REACH_LEVEL: u32 = 4u;

// Twin of `LobeTable::at`.
fn lobe_at(lobe: u32, cos_theta: f32) -> vec4f {
    let x = clamp(cos_theta, 0.0, 1.0) * f32(ANGLES - 1u);
    let i = min(u32(x), ANGLES - 2u);
    return mix(lobes.entries[lobe * ANGLES + i], lobes.entries[lobe * ANGLES + i + 1u], x - f32(i));
}

// Number of a lobe; NONE of a mirror, and of one too many.
fn lobe_number(lobe: Lobe) -> u32 {
    let parameters = vec2f(select(lobe.alpha, 0.0, lobe.exponent > 0.0), lobe.exponent);
    for (var number = 0u; number < lobes.count; number++) {
        if lobe.alpha > 0.0 && all(lobes.parameters[number].xy == parameters) {
            return number;
        }
    }
    return NONE;
}

fn lobe_numbered(number: u32) -> Lobe {
    return Lobe(lobes.parameters[number].x, lobes.parameters[number].y);
}

// Twin of `GlossyPoint`.
struct GlossyPoint {
    from_eye: vec3f,
    normal: vec3f,
    lobe: Lobe,
}

// Twin of `GlossyPoint::weight`.
fn tap_weight(point: GlossyPoint, direction: vec3f, nearness: f32, texel_angle: f32) -> f32 {
    let u = direction - point.from_eye * nearness;
    let least = 0.5 * texel_angle;
    let squared = dot(u, u);
    var towards = direction;
    if squared > 1e-4 * least * least {
        towards = u / sqrt(squared);
    }
    let wi = towards - 2.0 * dot(point.normal, towards) * point.normal;
    let ci = dot(wi, point.normal);
    if ci <= 0.0 {
        return 0.0;
    }
    return lobe_value(point.lobe, point.normal, wi, -normalize(point.from_eye)) * ci / max(squared, least * least);
}

// Unit direction through a place in the picture, in pixels.
fn lens_direction(at: vec2f) -> vec3f {
    let uv = at / vec2f(frame.size);
    return normalize(
        frame.forward
        + frame.right * ((2.0 * uv.x - 1.0) * frame.half_size.x)
        + frame.up * ((1.0 - 2.0 * uv.y) * frame.half_size.y));
}

// Twin of `reach`.
fn reach(point: GlossyPoint, pixel: vec2i, reflector: u32, support: f32) -> f32 {
    let pixel_angle = 2.0 * frame.half_size.y / f32(frame.size.y);
    let last = step.level_count - 1u;
    let own = texel_at(0u, pixel.x, pixel.y);
    let reach_level = min(REACH_LEVEL, last);
    let place = (vec2f(pixel) + 0.5) / f32(1u << reach_level) - 0.5;
    let corner = floor(place);
    let f = place - corner;
    var around = vec2f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let d = vec2i(i32(i & 1u), i32(i >> 1u));
        let texel = texel_at(reach_level, i32(corner.x) + d.x, i32(corner.y) + d.y);
        if texel.reflector == reflector {
            let w = select(1.0 - f, f, d == vec2i(1));
            around += vec2f(texel.nearness, 1.0) * (w.x * w.y * texel.coverage);
        }
    }
    var nearness = own.nearness;
    if around.y > 0.0 {
        nearness = min(nearness, around.x / around.y);
    }
    let share = 1.0 - min(length(point.from_eye) * nearness, 1.0);
    return share * support / pixel_angle;
}

// Twin of `gather`, whose radius is that of `reach`.
fn gather(point: GlossyPoint, pixel: vec2i, reflector: u32, radius: f32) -> vec3f {
    let pixel_angle = 2.0 * frame.half_size.y / f32(frame.size.y);
    let last = step.level_count - 1u;
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var level = 0u; level <= last; level++) {
        let scale = f32(1u << level);
        let low = vec2i(2 * (pixel.x >> (level + 1u)) - 4, 2 * (pixel.y >> (level + 1u)) - 4);
        let middle = vec2i((pixel.x >> level) - 2, (pixel.y >> level) - 2);
        for (var y = low.y; y < low.y + 10; y++) {
            for (var x = low.x; x < low.x + 10; x++) {
                let read = x >= middle.x && x < middle.x + 5 && y >= middle.y && y < middle.y + 5;
                if level > 0u && read {
                    continue;
                }
                let texel = texel_at(level, x, y);
                if texel.coverage <= 0.0 || texel.reflector != reflector {
                    continue;
                }
                let at = (vec2f(f32(x), f32(y)) + vec2f(0.5)) * scale + frame.subpixel - vec2f(0.5);
                let area = scale * scale * texel.coverage;
                let weight = area * tap_weight(point, lens_direction(at), texel.nearness, pixel_angle * scale);
                sum += texel.radiance * weight;
                weights += weight;
            }
        }
        if 4.0 * scale >= radius {
            break;
        }
    }
    if weights > 0.0 && weights < 3e38 {
        return sum / weights;
    }
    return texel_at(0u, pixel.x, pixel.y).radiance;
}

// A pixel that shows a flat glossy reflector.
struct GlossyPixel {
    known: bool,
    at: vec2u,
    index: u32,
    reflector: u32,
    point: GlossyPoint,
    // Twin of `LobeTable::modulation`.
    share: vec3f,
    support: f32,
}

fn glossy_pixel(id: vec2u) -> GlossyPixel {
    var out: GlossyPixel;
    if any(id >= frame.size) {
        return out;
    }
    out.at = id;
    out.index = id.y * frame.size.x + id.x;
    let seen = textureLoad(seen_triangles, id, 0).x;
    if seen == 0u || layers[state_of(frame.size, out.index, NEARNESS)] == NOT_MIRRORED {
        return out;
    }
    let surface = surface_seen(seen - 1u, frame.eye, pixel_direction(frame, id, frame.subpixel));
    let specular = specular_at(surface);
    let own = Lobe(specular.alpha, specular.exponent);
    let lobe = lobe_number(own);
    if lobe == NONE {
        return out;
    }
    out.known = true;
    out.reflector = triangles[surface.triangle].reflector;
    out.point = GlossyPoint(surface.position - frame.eye, surface.geometric_normal, own);
    let entry = lobe_at(lobe, -dot(out.point.from_eye, out.point.normal) / length(out.point.from_eye));
    out.share = entry.x * specular_reflectance_at(specular, entry.z, entry.y);
    out.support = entry.w;
    return out;
}

// The pixel of an invocation over the finest level.
fn own_pixel(id: vec2u) -> GlossyPixel {
    if is_beyond(info.levels[0], id) {
        return GlossyPixel();
    }
    return glossy_pixel(texel_of(info.levels[0], id));
}

// What a pixel reflects of what arrives within its lobe.
fn put(pixel: GlossyPixel, radiance: vec3f) {
    store(pixel.index, 4u, pixel.share * radiance);
    layers[state_of(frame.size, pixel.index, VIEW)] = CONVOLVED;
}

fn reach_of(pixel: GlossyPixel) -> f32 {
    return reach(pixel.point, vec2i(pixel.at), pixel.reflector, pixel.support);
}

fn gathered(pixel: GlossyPixel, radius: f32) -> vec3f {
    return gather(pixel.point, vec2i(pixel.at), pixel.reflector, radius);
}

@compute @workgroup_size(8, 8)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    let pixel = own_pixel(id.xy);
    if pixel.known {
        put(pixel, gathered(pixel, reach_of(pixel)));
    }
}
