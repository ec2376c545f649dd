// Direct light at a point: twins of core/src/scene/direct.rs, in f32.

struct EmitterInfo {
    // Intensity, illuminance or radiance, dimmer applied.
    emission: vec3f,
    kind: u32,
    position: vec3f,
    cos_inner: f32,
    axis: vec3f,
    cos_outer: f32,
    first: u32,
    count: u32,
    flags: u32,
    area: f32,
}

struct EmitterTriangle {
    triangle: u32,
    cumulative_area: f32,
}

@group(0) @binding(9) var<storage, read> emitters: array<EmitterInfo>;
@group(0) @binding(10) var<storage, read> emitter_triangles: array<EmitterTriangle>;

const POINT: u32 = 0u;
const SPOT: u32 = 1u;
const DIRECTIONAL: u32 = 2u;
const DOUBLE_SIDED: u32 = 1u;
const TEXTURED: u32 = 2u;
const ANALYTIC_TRIANGLES: u32 = 16u;
const SEARCH: u32 = 16u;
const LARGEST_SIZE: f32 = 0.08;
const FAR: f32 = 3.0e38;

struct Receiver {
    position: vec3f,
    normal: vec3f,
    origin: vec3f,
}

// Angle of (x, y) from the x axis for y ≥ 0, to 2e-7: WGSL promises nothing useful of atan2.
fn angle(y: f32, x: f32) -> f32 {
    let half_tangent = y / (sqrt(x * x + y * y) + abs(x));
    let large = half_tangent > 0.41421356;
    let t = select(half_tangent, (half_tangent - 1.0) / (half_tangent + 1.0), large);
    let z = t * t;
    // Cephes, atanf.
    let series = (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1) * z * t + t;
    let twice = 2.0 * (series + select(0.0, 0.78539816, large));
    return select(twice, PI - twice, x < 0.0);
}

struct Polygon {
    // From the receiver.
    corners: array<vec3f, 4>,
    count: u32,
}

// Twin of `direct::above_horizon`.
fn above_horizon(position: vec3f, n: vec3f, triangle: array<vec3f, 3>) -> Polygon {
    var relative = array<vec3f, 3>(triangle[0] - position, triangle[1] - position, triangle[2] - position);
    var clipped = Polygon();
    for (var i = 0u; i < 3u; i++) {
        let k = (i + 1u) % 3u;
        let here = dot(relative[i], n);
        let there = dot(relative[k], n);
        if here >= 0.0 {
            clipped.corners[clipped.count] = relative[i];
            clipped.count += 1u;
        }
        if (here < 0.0) != (there < 0.0) && clipped.count < 4u {
            clipped.corners[clipped.count] = mix(relative[i], relative[k], here / (here - there));
            clipped.count += 1u;
        }
    }
    return clipped;
}

// Twin of `direct::polygon_irradiance`; crosses with the edge rather than the far corner, which
// keeps in f32 what the specification keeps by f64.
fn polygon_irradiance(n: vec3f, polygon: Polygon) -> f32 {
    var clipped = polygon.corners;
    let count = polygon.count;
    var sum = 0.0;
    for (var i = 0u; i < count; i++) {
        let p = clipped[i];
        let q = clipped[(i + 1u) % count];
        let normal = cross(p, q - p);
        let sine = length(normal);
        if sine > 1e-30 {
            sum += angle(sine, dot(p, q)) * dot(normal, n) / sine;
        }
    }
    return abs(0.5 * sum);
}

// Twin of `direct::distant_irradiance`; negative where that is `None`.
fn distant_irradiance(position: vec3f, n: vec3f, triangle: array<vec3f, 3>, area_normal: vec3f) -> f32 {
    let a = triangle[0] - position;
    let b = triangle[1] - position;
    let c = triangle[2] - position;
    let centre = a + b + c;
    let size = max(max(dot(b - a, b - a), dot(c - b, c - b)), dot(a - c, a - c));
    let lowest = min(min(dot(a, n), dot(b, n)), dot(c, n));
    if size > LARGEST_SIZE * LARGEST_SIZE * dot(centre, centre) / 9.0 || lowest < 0.0 {
        return -1.0;
    }
    var middles = array<vec3f, 3>(0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
    var sum = 0.0;
    for (var i = 0u; i < 3u; i++) {
        let q = middles[i];
        let squared = dot(q, q);
        sum += dot(q, n) * abs(dot(q, area_normal)) / (squared * squared);
    }
    return sum / 6.0;
}

struct FacingTriangle {
    // Counter-clockwise from the receiver.
    corners: array<vec3f, 3>,
    area_normal: vec3f,
    shines: bool,
}

// Twin of `direct::facing_triangles`: one of them.
fn facing_triangle(emitter: EmitterInfo, i: u32, receiver: Receiver) -> FacingTriangle {
    let t = 3u * emitter_triangles[emitter.first + i].triangle;
    let a = corners[t].position;
    let b = corners[t + 1u].position;
    let c = corners[t + 2u].position;
    let area_normal = cross(b - a, c - a);
    let faces = dot(area_normal, receiver.position - a) > 0.0;
    let in_turn = array<vec3f, 3>(a, select(c, b, faces), select(b, c, faces));
    let shines = faces || (emitter.flags & DOUBLE_SIDED) != 0u;
    return FacingTriangle(in_turn, select(-area_normal, area_normal, faces), shines);
}

fn area_factor(emitter: EmitterInfo, receiver: Receiver) -> f32 {
    var factor = 0.0;
    for (var i = 0u; i < emitter.count; i++) {
        let triangle = facing_triangle(emitter, i, receiver);
        if !triangle.shines {
            continue;
        }
        let distant = distant_irradiance(receiver.position, receiver.normal, triangle.corners, triangle.area_normal);
        if distant >= 0.0 {
            factor += distant;
        } else {
            let clipped = above_horizon(receiver.position, receiver.normal, triangle.corners);
            factor += polygon_irradiance(receiver.normal, clipped);
        }
    }
    return factor;
}

struct AreaSample {
    weight: f32,
    radiance: vec3f,
    // Share of it that arrives.
    seen: vec3f,
}

struct EmitterPoint {
    position: vec3f,
    normal: vec3f,
    radiance: vec3f,
}

// Twin of `AreaEmitter::point`.
fn emitter_point(emitter: EmitterInfo, random: vec2f) -> EmitterPoint {
    let wanted = random.x * emitter.area;
    var low = 0u;
    var high = emitter.count;
    while low < high {
        let middle = (low + high) / 2u;
        if emitter_triangles[emitter.first + middle].cumulative_area <= wanted {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    let i = min(low, emitter.count - 1u);
    let chosen = emitter_triangles[emitter.first + i];
    var before = 0.0;
    if i > 0u {
        before = emitter_triangles[emitter.first + i - 1u].cumulative_area;
    }
    let root = sqrt(clamp((wanted - before) / (chosen.cumulative_area - before), 0.0, 1.0));
    let u = root * (1.0 - random.y);
    let v = root * random.y;
    let w = 1.0 - u - v;
    let a = corners[3u * chosen.triangle];
    let b = corners[3u * chosen.triangle + 1u];
    let c = corners[3u * chosen.triangle + 2u];
    let position = a.position * w + b.position * u + c.position * v;
    let normal = normalize_or(cross(b.position - a.position, c.position - a.position), vec3f(0.0, 1.0, 0.0));
    var radiance = emitter.emission;
    if (emitter.flags & TEXTURED) != 0u {
        let uv = vec2f(a.u, a.v) * w + vec2f(b.u, b.v) * u + vec2f(c.u, c.v) * v;
        radiance *= sample_repeat(materials[triangles[chosen.triangle].material].emission_texture, uv);
    }
    return EmitterPoint(position, normal, radiance);
}

fn area_sample(tree_count: u32, emitter: EmitterInfo, receiver: Receiver, j: u32, scramble: u32) -> AreaSample {
    let point = emitter_point(emitter, r2_point(j, scramble));
    let to_light = point.position - receiver.position;
    let d2 = dot(to_light, to_light);
    let wi = to_light / sqrt(d2);
    let cosine = dot(receiver.normal, wi);
    let facing = -dot(point.normal, wi);
    let cosine_light = select(facing, abs(facing), (emitter.flags & DOUBLE_SIDED) != 0u);
    if !(d2 > 0.0) || cosine <= 0.0 || cosine_light <= 0.0 {
        return AreaSample(0.0, vec3f(0.0), vec3f(0.0));
    }
    let end = offset_origin(point.position, point.normal * sign(facing));
    let seen = transmittance(tree_count, receiver.origin, end - receiver.origin, 1.0 - 1e-4);
    return AreaSample(cosine * cosine_light / d2, point.radiance, seen);
}

fn spot_falloff(emitter: EmitterInfo, from_lamp: vec3f) -> f32 {
    let span = max(emitter.cos_inner - emitter.cos_outer, 1e-3);
    let t = clamp((dot(emitter.axis, from_lamp) - emitter.cos_outer) / span, 0.0, 1.0);
    return t * t;
}

fn emitter_irradiance(tree_count: u32, index: u32, receiver: Receiver, samples: u32, scramble: u32) -> vec3f {
    let emitter = emitters[index];
    if all(emitter.emission == vec3f(0.0)) {
        return vec3f(0.0);
    }
    if emitter.kind == DIRECTIONAL {
        let wi = -emitter.axis;
        let e = emitter.emission * max(dot(receiver.normal, wi), 0.0);
        if all(e == vec3f(0.0)) {
            return vec3f(0.0);
        }
        return e * transmittance(tree_count, receiver.origin, wi, FAR);
    }
    if emitter.kind == POINT || emitter.kind == SPOT {
        let to_lamp = emitter.position - receiver.position;
        let d2 = dot(to_lamp, to_lamp);
        let wi = to_lamp / sqrt(d2);
        let cosine = dot(receiver.normal, wi);
        if !(d2 > 0.0) || cosine <= 0.0 {
            return vec3f(0.0);
        }
        var e = emitter.emission * (cosine / d2);
        if emitter.kind == SPOT {
            e *= spot_falloff(emitter, -wi);
        }
        if all(e == vec3f(0.0)) {
            return vec3f(0.0);
        }
        return e * transmittance(tree_count, receiver.origin, emitter.position - receiver.origin, 1.0 - 1e-4);
    }
    let analytic = (emitter.flags & TEXTURED) == 0u && emitter.count <= ANALYTIC_TRIANGLES;
    var factor = 0.0;
    if analytic {
        factor = area_factor(emitter, receiver);
        if factor == 0.0 {
            return vec3f(0.0);
        }
    }
    let rays = max(samples, 1u);
    var total = 0.0;
    var visible = vec3f(0.0);
    var sum = vec3f(0.0);
    // Twin of `direct::of_area`.
    let most = select(rays, SEARCH * rays, analytic);
    for (var j = 0u; j < most && (j < rays || total == 0.0); j++) {
        let drawn = area_sample(tree_count, emitter, receiver, j, scramble);
        total += drawn.weight;
        visible += drawn.seen * drawn.weight;
        sum += drawn.radiance * drawn.seen * drawn.weight;
    }
    if analytic {
        for (var i = 0u; i < select(emitter.count, 0u, total > 0.0); i++) {
            let triangle = facing_triangle(emitter, i, receiver);
            var clipped = above_horizon(receiver.position, receiver.normal, triangle.corners);
            let weight = select(0.0, polygon_irradiance(receiver.normal, clipped), triangle.shines);
            if weight > 0.0 {
                // Corners beyond the number are zero.
                let sum = clipped.corners[0] + clipped.corners[1] + clipped.corners[2] + clipped.corners[3];
                let middle = receiver.position + sum / f32(clipped.count);
                let end = offset_origin(middle, normalize(triangle.area_normal));
                visible += weight * transmittance(tree_count, receiver.origin, end - receiver.origin, 1.0 - 1e-4);
                total += weight;
            }
        }
        if total > 0.0 {
            return emitter.emission * visible * (factor / total);
        }
        return vec3f(0.0);
    }
    return sum * (emitter.area / f32(rays));
}

// Twin of `direct::total_irradiance`.
fn total_irradiance(frame: Frame, receiver: Receiver, scramble: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < frame.emitter_count; i++) {
        sum += emitter_irradiance(frame.tree_count, i, receiver, frame.samples, scramble);
    }
    return sum;
}
