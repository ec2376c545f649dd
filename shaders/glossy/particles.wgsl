// Particles of light on glossy surfaces, and straight light in their lobes: twins of core/src/glossy/particles/splat.rs
// and straight.rs.

// As `SplatMap::table` lays it out.
@group(1) @binding(3) var<storage, read> particles: array<vec4u>;

const LOBE_SCRAMBLE: u32 = 0x51ED270Bu;
const LEAST_SAMPLES: u32 = 4u;
const SAME_SIDE: f32 = 0.5;

// Twin of `splat::gaussian`.
fn gaussian(u_squared: f32) -> f32 {
    return 2.0 * exp(-2.0 * u_squared) / (PI * (1.0 - 0.13533528));
}

fn own_lobe(specular: Specular) -> Lobe {
    return Lobe(specular.alpha, specular.exponent);
}

// Value of a specular lobe, 1/sr: twin of the second of `Brdf::value`.
fn specular_value(specular: Specular, normal: vec3f, wi: vec3f, wo: vec3f) -> vec3f {
    if dot(normal, wi) <= 0.0 || dot(normal, wo) <= 0.0 {
        return vec3f(0.0);
    }
    let h = normalize(wi + wo);
    return specular_reflectance(specular, dot(wo, h)) * lobe_value(own_lobe(specular), normal, wi, wo);
}

// First of a surface's particles whose cell has at least this number.
fn first_in(first: u32, count: u32, key: u32) -> u32 {
    var low = 0u;
    var high = count;
    while low < high {
        let middle = (low + high) / 2u;
        if particles[first + 4u * middle].w < key {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// Twin of the second of `SplatMap::radiance`.
fn by_particles(surface: Surface, specular: Specular, eye: vec3f) -> vec3f {
    let info = triangles[surface.triangle];
    var place = 0u;
    for (var i = 0u; i < particles[0].x; i++) {
        let head = particles[1u + 3u * i];
        if head.x == info.object && head.y == info.material {
            place = 1u + 3u * i;
        }
    }
    if place == 0u {
        return vec3f(0.0);
    }
    let head = particles[place];
    let corner = bitcast<vec4f>(particles[place + 1u]);
    let cells = vec3i(particles[place + 2u].xyz);
    let radius = bitcast<f32>(particles[place + 2u].w);
    let middle = vec3i(floor((surface.position - corner.xyz) / corner.w)) + 1;
    var sum = vec3f(0.0);
    if any(middle < vec3i(0)) || any(middle > cells) {
        return sum;
    }
    let low = max(middle - 1, vec3i(0));
    let high = min(middle + 1, cells - 1);
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            let row = u32(z * cells.y + y) * u32(cells.x);
            let last = row + u32(high.x);
            for (var i = first_in(head.z, head.w, row + u32(low.x)); i < head.w; i++) {
                let at = head.z + 4u * i;
                let found = particles[at];
                if found.w > last {
                    break;
                }
                let position = bitcast<vec3f>(found.xyz);
                let away = surface.position - position;
                let u_squared = dot(away, away) / (radius * radius);
                let normal = bitcast<vec4f>(particles[at + 1u]);
                if u_squared < 1.0 && dot(surface.normal, normal.xyz) > SAME_SIDE {
                    let wi = bitcast<vec4f>(particles[at + 2u]);
                    let power = bitcast<vec4f>(particles[at + 3u]);
                    let wo = normalize_or(eye - position, normal.xyz);
                    var there = specular;
                    there.metal = vec3f(normal.w, wi.w, power.w);
                    let weight = gaussian(u_squared) / (radius * radius);
                    sum += specular_value(there, normal.xyz, wi.xyz, wo) * power.xyz * weight;
                }
            }
        }
    }
    return sum;
}

// Twin of `straight::density_of_places`.
fn density_of_places(met: Surface, wi: vec3f, distance: f32) -> f32 {
    let info = triangles[met.triangle];
    let cosine = abs(dot(met.geometric_normal, wi));
    for (var i = 0u; i < frame.emitter_count; i++) {
        let emitter = emitters[i];
        if emitter.kind > DIRECTIONAL && emitter.count > 0u && cosine > 0.0 {
            let own = triangles[emitter_triangles[emitter.first].triangle];
            if own.object == info.object && own.material == info.material {
                return distance * distance / (emitter.area * cosine);
            }
        }
    }
    return 0.0;
}

// Radiance of a lobe by one sample of an emitter, before it is divided by their number: twin of the first sum of
// `straight::straight_light`.
fn by_emitter(emitter: EmitterInfo, surface: Surface, specular: Specular, wo: vec3f, random: vec2f) -> vec3f {
    let origin = offset_origin(surface.position, surface.geometric_normal);
    var wi = -emitter.axis;
    var light = emitter.emission;
    var share = 1.0;
    var way = wi;
    var t_max = FAR;
    if emitter.kind == POINT || emitter.kind == SPOT {
        let to_lamp = emitter.position - surface.position;
        wi = normalize_or(to_lamp, vec3f(0.0));
        light = emitter.emission / dot(to_lamp, to_lamp);
        if emitter.kind == SPOT {
            light *= spot_falloff(emitter, -wi);
        }
        way = emitter.position - origin;
        t_max = 1.0 - 1e-4;
    }
    if emitter.kind > DIRECTIONAL {
        let point = emitter_point(emitter, random);
        let to_light = point.position - surface.position;
        let d2 = dot(to_light, to_light);
        wi = normalize_or(to_light, vec3f(0.0));
        let facing = -dot(point.normal, wi);
        let cosine_light = select(facing, abs(facing), (emitter.flags & DOUBLE_SIDED) != 0u);
        if !(d2 > 0.0 && cosine_light > 0.0) {
            return vec3f(0.0);
        }
        let density = d2 / (emitter.area * cosine_light);
        light = point.radiance / density;
        share = density / (density + lobe_density(own_lobe(specular), surface.normal, wi, wo));
        way = offset_origin(point.position, point.normal * sign(facing)) - origin;
        t_max = 1.0 - 1e-4;
    }
    let arriving = specular_value(specular, surface.normal, wi, wo) * (dot(surface.normal, wi) * share) * light;
    if dot(surface.geometric_normal, wi) <= 0.0 || !any(arriving > vec3f(0.0))
        || occluded(frame.tree_count, origin, way, t_max) {
        return vec3f(0.0);
    }
    return arriving;
}

// Twin of `straight::straight_light`.
fn straight_light(surface: Surface, specular: Specular, wo: vec3f, samples: u32, scramble: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < frame.emitter_count; i++) {
        let emitter = emitters[i];
        if all(emitter.emission == vec3f(0.0)) {
            continue;
        }
        let count = select(1u, samples, emitter.kind > DIRECTIONAL);
        for (var j = 0u; j < count; j++) {
            sum += by_emitter(emitter, surface, specular, wo, r2_point(j, scramble)) / f32(count);
        }
    }
    let origin = offset_origin(surface.position, surface.geometric_normal);
    for (var j = 0u; j < samples; j++) {
        let wi = lobe_sample(own_lobe(specular), surface.normal, wo, r2_point(j, hash(scramble ^ LOBE_SCRAMBLE)));
        if dot(surface.normal, wi) <= 0.0 || dot(surface.geometric_normal, wi) <= 0.0 {
            continue;
        }
        let met = nearest(frame.tree_count, origin, wi, 0.0, FAR);
        if met.triangle == NONE {
            continue;
        }
        let seen = surface_seen(met.triangle, origin, wi);
        let radiance = emission_at(seen);
        if any(radiance > vec3f(0.0)) {
            let density = lobe_density(own_lobe(specular), surface.normal, wi, wo) + density_of_places(seen, wi, met.t);
            let value = specular_value(specular, surface.normal, wi, wo) * dot(surface.normal, wi);
            sum += value * radiance / (density * f32(samples));
        }
    }
    return sum;
}

// What glossy surfaces send to the eye: twin of `pass::glossy_layer`. What is not glossy has been seen to.
@compute @workgroup_size(8, 8)
fn splat_particles(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= frame.size) {
        return;
    }
    let seen = textureLoad(seen_triangles, id.xy, 0).x;
    if seen == 0u || !(materials[triangles[seen - 1u].material].alpha > 0.0) {
        return;
    }
    let pixel = id.y * frame.size.x + id.x;
    let direction = pixel_direction(frame, id.xy, frame.subpixel);
    let surface = surface_seen(seen - 1u, frame.eye, direction);
    let specular = specular_at(surface);
    var value = vec3f(0.0);
    if specular.alpha > 0.0 {
        let wo = normalize_or(frame.eye - surface.position, surface.normal);
        let samples = select(frame.samples, LEAST_SAMPLES, frame.samples == 0u);
        value = by_particles(surface, specular, frame.eye)
            + straight_light(surface, specular, wo, samples, pixel_scramble(pixel));
    }
    store(pixel, 3u, vec3f(0.0));
    store(pixel, 4u, value);
}
