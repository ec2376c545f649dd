// One kernel for each reflector: twin of core/src/glossy/invariant.rs.

const WIDEST: u32 = 4u;
const PEAK: u32 = 2u;
const SHARPENED: f32 = 0.125;
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
    // Of the peak.
    level: u32,
    radius: u32,
    // Of the rest, on the next level; 0 where the peak is all.
    rest_radius: u32,
    // 0 where no pixel of those that are measured shows the reflector.
    known: u32,
    // Of the peak and of the rest.
    weights: array<array<f32, 81>, 2>,
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

const OF_PEAK: u32 = 0u;
const OF_REST: u32 = 1u;
const OF_ALL: u32 = 2u;

// Which weights: on what level, how far, and what part of the kernel.
struct WeightTable {
    level: u32,
    radius: u32,
    part: u32,
}

// Twin of `peak_share`.
fn peak_share(distance: f32) -> f32 {
    let x = distance / f32(PEAK + 1u);
    let share = max(1.0 - x * x, 0.0);
    return share * share;
}

fn weight_at(table: WeightTable, point: GlossyPoint, nearness: f32, offset: vec2f) -> f32 {
    let scale = f32(1u << table.level);
    let angle = 2.0 * frame.half_size.y / f32(frame.size.y) * scale;
    let place = lens_place(point.from_eye) + offset * scale;
    let weight = tap_weight(point, lens_direction(place), nearness, angle);
    switch table.part {
        case OF_PEAK: {
            return weight * peak_share(length(offset));
        }
        case OF_REST: {
            return weight * 4.0 * (1.0 - peak_share(2.0 * length(offset)));
        }
        default: {
            return weight;
        }
    }
}

// Twin of `Kernel::of_part`, for one offset.
fn sharpened(table: WeightTable, point: GlossyPoint, nearness: f32, offset: vec2f) -> f32 {
    let own = weight_at(table, point, nearness, offset);
    if table.level == 0u {
        return own;
    }
    var around = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let along = select(-1.0, 1.0, i % 2u == 0u);
        around += weight_at(table, point, nearness, offset + select(vec2f(0.0, along), vec2f(along, 0.0), i < 2u));
    }
    return max(own - SHARPENED * (around - 4.0 * own), 0.0);
}

// A thread's weight of a table.
fn fill(slot: u32, part: u32, thread: u32, table: WeightTable, point: GlossyPoint, nearness: f32) {
    let edge = 2u * table.radius + 1u;
    if thread < edge * edge {
        let offset = vec2f(f32(thread % edge), f32(thread / edge)) - f32(table.radius);
        kernels[slot].weights[part][thread] = sharpened(table, point, nearness, offset);
    }
}

// Twin of `Measure` and of `SplitKernel::new`: a workgroup for each reflector.
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
    let point = GlossyPoint(points[0].xyz / count, own.normal, lobe_numbered(own.lobe));
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
    let is_split = level > 0u;
    if thread == 0u {
        kernels[group.x].level = max(level, 1u) - 1u;
        kernels[group.x].radius = select(radius, PEAK, is_split);
        kernels[group.x].rest_radius = select(0u, radius, is_split);
        kernels[group.x].known = 1u;
    }
    if is_split {
        fill(group.x, 0u, thread, WeightTable(level - 1u, PEAK, OF_PEAK), point, nearness);
        fill(group.x, 1u, thread, WeightTable(level, radius, OF_REST), point, nearness);
    } else {
        fill(group.x, 0u, thread, WeightTable(0u, radius, OF_ALL), point, nearness);
    }
}

// Twin of `Kernel::sum`.
fn kernel_sum(slot: u32, part: u32, r: i32, reflector: u32, at: vec2i) -> vec4f {
    var sum = vec4f(0.0);
    for (var dy = -r; dy <= r; dy++) {
        for (var dx = -r; dx <= r; dx++) {
            let texel = texel_at(step.level, at.x + dx, at.y + dy);
            if texel.reflector == reflector {
                let place = u32((dy + r) * (2 * r + 1) + dx + r);
                sum += vec4f(texel.radiance, 1.0) * (kernels[slot].weights[part][place] * texel.coverage);
            }
        }
    }
    return sum;
}

// Twin of `between`, and whether any of the texels shows the reflector.
struct Between {
    value: vec4f,
    known: bool,
}

fn between(level: u32, reflector: u32, place: vec2u, steps: u32) -> Between {
    let here = info.levels[level];
    let at = (vec2f(place) + 0.5) / f32(1u << steps) - 0.5;
    let low = floor(at);
    let f = at - low;
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let d = vec2i(i32(i & 1u), i32(i >> 1u));
        let texel = vec2i(low) + d;
        if texel_at(level, texel.x, texel.y).reflector == reflector {
            let w = select(1.0 - f, f, d == vec2i(1));
            sum += convolved[texel_place(here, u32(texel.x), u32(texel.y))] * (w.x * w.y);
            weights += w.x * w.y;
        }
    }
    return Between(select(vec4f(0.0), sum / weights, weights > 0.0), weights > 0.0);
}

// Twin of `convolve`, for the texels of one level: sums of the rest, and what is convolved on the peak's.
@compute @workgroup_size(8, 8)
fn convolve(@builtin(global_invocation_id) id: vec3u) {
    let here = info.levels[step.level];
    if is_beyond(here, id.xy) {
        return;
    }
    let at = texel_of(here, id.xy);
    let own = texel_at(step.level, i32(at.x), i32(at.y));
    let slot = slot_of(own.reflector);
    if slot == NONE || kernels[slot].known == 0u {
        return;
    }
    let place = texel_place(here, at.x, at.y);
    let rest_radius = kernels[slot].rest_radius;
    if kernels[slot].level + 1u == step.level && rest_radius > 0u {
        convolved[place] = kernel_sum(slot, 1u, i32(rest_radius), own.reflector, vec2i(at));
    }
    if kernels[slot].level == step.level {
        var sum = kernel_sum(slot, 0u, i32(kernels[slot].radius), own.reflector, vec2i(at));
        if rest_radius > 0u {
            sum += between(step.level + 1u, own.reflector, at, 1u).value;
        }
        let is_sound = sum.w > 0.0 && sum.w < 3e38;
        convolved[place] = vec4f(select(own.radiance, sum.xyz / sum.w, is_sound), 1.0);
    }
}

// Twin of `SplitKernel::at_pixel`.
fn convolved_at(slot: u32, reflector: u32, pixel: vec2u, own: vec3f) -> vec3f {
    let level = kernels[slot].level;
    let found = between(level, reflector, pixel, level);
    return select(own, found.value.xyz, found.known);
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
