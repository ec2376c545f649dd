// One kernel for each reflector: twin of core/src/glossy/invariant.rs.

const WIDEST: u32 = 7u;
const MEASURED: u32 = 4u;
const MOST_RADIUS: f32 = 0.5;
const THREADS: u32 = 256u;

// The Rust sides are in core/src/glossy/gpu.rs.
struct MeasuredReflector {
    normal: vec3f,
    height: f32,
    rectangle: vec4u,
    reflector: u32,
    lobe: u32,
    padding_0: u32,
    padding_1: u32,
}

struct MeasuredReflectors {
    list: array<MeasuredReflector, 64>,
    count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct KernelInfo {
    level: u32,
    radius: u32,
    // 0 where no pixel of those that are measured shows the reflector.
    known: u32,
    padding: u32,
    weights: array<f32, 225>,
}

@group(1) @binding(7) var<uniform> measured: MeasuredReflectors;
@group(1) @binding(8) var<storage, read_write> kernels: array<KernelInfo>;
// Texels of the pyramid, convolved: those on the level of their reflector's kernel.
@group(1) @binding(9) var<storage, read_write> convolved: array<vec4f>;

// Σ of points from the eye and of shares; count.
var<workgroup> points: array<vec4f, THREADS>;
var<workgroup> counts: array<f32, THREADS>;

// Slot of a reflector; NONE where it has none.
fn slot_of(reflector: u32) -> u32 {
    for (var slot = 0u; slot < measured.count; slot++) {
        if measured.list[slot].reflector == reflector {
            return slot;
        }
    }
    return NONE;
}

// Twin of `Lens::place`.
fn lens_place(from_eye: vec3f) -> vec2f {
    let slope = vec2f(dot(from_eye, frame.right), dot(from_eye, frame.up)) / dot(from_eye, frame.forward);
    let uv = slope / frame.half_size;
    return 0.5 * (1.0 + vec2f(uv.x, -uv.y)) * vec2f(frame.size);
}

// Twin of `Measure` and of `Kernel::new`: a workgroup for each reflector.
@compute @workgroup_size(256)
fn measure(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let own = measured.list[group.x];
    let low = (own.rectangle.xy + vec2u(MEASURED - 1u)) / MEASURED;
    let high = (own.rectangle.xy + own.rectangle.zw + vec2u(MEASURED - 1u)) / MEASURED;
    let across = high.x - low.x;
    var point_sum = vec4f(0.0);
    var found = 0.0;
    for (var i = thread; i < across * (high.y - low.y); i += THREADS) {
        let at = MEASURED * (low + vec2u(i % across, i / across));
        let texel = texel_at(0u, i32(at.x), i32(at.y));
        if texel.reflector == own.reflector {
            // Where the pixel's ray meets the plane.
            let direction = pixel_direction(frame, at, frame.subpixel);
            let distance = own.height / dot(own.normal, direction);
            // d / (|P| + d), d the distance behind the mirror.
            let share = max(1.0 - distance * texel.nearness, 0.0);
            point_sum += vec4f(direction * distance, share);
            found += 1.0;
        }
    }
    points[thread] = point_sum;
    counts[thread] = found;
    workgroupBarrier();
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        if thread < half {
            points[thread] += points[thread + half];
            counts[thread] += counts[thread + half];
        }
        workgroupBarrier();
    }
    let count = counts[0];
    if count == 0.0 {
        if thread == 0u {
            kernels[group.x].known = 0u;
        }
        return;
    }
    let point = GlossyPoint(points[0].xyz / count, own.normal, lobes.alpha[own.lobe].x);
    let eye_distance = length(point.from_eye);
    let nearness = (1.0 - points[0].w / count) / eye_distance;
    let support = lobe_at(own.lobe, -dot(point.from_eye, point.normal) / eye_distance).w;
    let pixel_angle = 2.0 * frame.half_size.y / f32(frame.size.y);
    let reach = (1.0 - min(eye_distance * nearness, 1.0)) * support / pixel_angle;
    let most = max(MOST_RADIUS * f32(max(frame.size.x, frame.size.y)), 1.0);
    let wanted = u32(clamp(ceil(reach), 1.0, most));
    var level = 0u;
    while level + 1u < step.level_count && ((wanted + (1u << level) - 1u) >> level) > WIDEST {
        level++;
    }
    let radius = min((wanted + (1u << level) - 1u) >> level, WIDEST);
    if thread == 0u {
        kernels[group.x].level = level;
        kernels[group.x].radius = radius;
        kernels[group.x].known = 1u;
    }
    let edge = 2u * radius + 1u;
    if thread < edge * edge {
        let scale = f32(1u << level);
        let offset = vec2f(f32(thread % edge), f32(thread / edge)) - f32(radius);
        let direction = lens_direction(lens_place(point.from_eye) + offset * scale);
        kernels[group.x].weights[thread] = tap_weight(point, direction, nearness, pixel_angle * scale);
    }
}

// Twin of `Kernel::at_texel`, for the texels of one level.
@compute @workgroup_size(8, 8)
fn convolve(@builtin(global_invocation_id) id: vec3u) {
    let here = info.levels[step.level];
    if is_beyond(here, id.xy) {
        return;
    }
    let at = texel_of(here, id.xy);
    let own = texel_at(step.level, i32(at.x), i32(at.y));
    let slot = slot_of(own.reflector);
    if slot == NONE || kernels[slot].known == 0u || kernels[slot].level != step.level {
        return;
    }
    let r = i32(kernels[slot].radius);
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var dy = -r; dy <= r; dy++) {
        for (var dx = -r; dx <= r; dx++) {
            let texel = texel_at(step.level, i32(at.x) + dx, i32(at.y) + dy);
            if texel.reflector == own.reflector {
                let weight = kernels[slot].weights[u32((dy + r) * (2 * r + 1) + dx + r)] * texel.coverage;
                sum += texel.radiance * weight;
                weights += weight;
            }
        }
    }
    var radiance = own.radiance;
    if weights > 0.0 && weights < 3e38 {
        radiance = sum / weights;
    }
    convolved[texel_place(here, at.x, at.y)] = vec4f(radiance, 0.0);
}

// Twin of `Kernel::at_pixel`.
fn convolved_at(slot: u32, reflector: u32, pixel: vec2u, own: vec3f) -> vec3f {
    let level = kernels[slot].level;
    let here = info.levels[level];
    let at = (vec2f(pixel) + 0.5) / f32(1u << level) - 0.5;
    let low = floor(at);
    let f = at - low;
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let d = vec2i(i32(i & 1u), i32(i >> 1u));
        let texel = vec2i(low) + d;
        if texel_at(level, texel.x, texel.y).reflector == reflector {
            let w = select(1.0 - f, f, d == vec2i(1));
            sum += convolved[texel_place(here, u32(texel.x), u32(texel.y))].xyz * (w.x * w.y);
            weights += w.x * w.y;
        }
    }
    if weights > 0.0 {
        return sum / weights;
    }
    return own;
}

@compute @workgroup_size(8, 8)
fn scatter_invariant(@builtin(global_invocation_id) id: vec3u) {
    let pixel = own_pixel(id.xy);
    if !pixel.known {
        return;
    }
    let at = pixel.at;
    let own = texel_at(0u, i32(at.x), i32(at.y)).radiance;
    let slot = slot_of(pixel.reflector);
    if slot == NONE || kernels[slot].known == 0u {
        put(pixel, own);
    } else {
        put(pixel, convolved_at(slot, pixel.reflector, at, own));
    }
}
