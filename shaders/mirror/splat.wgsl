// Mirrored views of depth 1 from images-with-depth, as the triangles that their points lie on: twin of
// `images::reproject` with boxes.
//
// Points are splatted by a compute pass, not rasterised as quads: nothing is shaded here, and setting up two triangles
// for a few pixels would cost more than visiting these. The nearest point of a pixel is found first, then the first
// point in the table that is as near, so that the order of invocations does not matter.

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var mirrored_triangles: texture_storage_2d<r32uint, write>;
@group(1) @binding(2) var<storage, read_write> layers: array<f32>;
@group(1) @binding(3) var<uniform> views: MirroredViews;

// The Rust sides are in core/src/mirror/images/gpu.rs.
struct ImageInfo {
    eye: vec3f,
    // Its first point in the table.
    first: u32,
    corner: vec3f,
    resolution: u32,
    edge_u: vec3f,
    padding_0: u32,
    edge_v: vec3f,
    padding_1: u32,
}

struct ImagePoint {
    // Distance over that of the element along the same ray.
    scale: f32,
    triangle: u32,
}

struct Run {
    image: u32,
    first: u32,
    level: u32,
    // Number of the view, counted from 1.
    view: u32,
}

@group(1) @binding(6) var<storage, read> images: array<ImageInfo>;
@group(1) @binding(7) var<storage, read> points: array<ImagePoint>;
// The first one's image is the number of those that follow.
@group(1) @binding(8) var<storage, read> runs: array<Run>;
// Of each pixel the nearest point: bits of 1 / distance, then its number from the end.
@group(1) @binding(9) var<storage, read_write> nearest: array<atomic<u32>>;

const LEAF: u32 = 64u;
const WIDEST: f32 = 24.0;
// Workgroups in a row of a dispatch.
const ROW: u32 = 32768u;

fn compact(value: u32) -> u32 {
    var v = value & 0x55555555u;
    v = (v | (v >> 1u)) & 0x33333333u;
    v = (v | (v >> 2u)) & 0x0F0F0F0Fu;
    v = (v | (v >> 4u)) & 0x00FF00FFu;
    return (v | (v >> 8u)) & 0xFFFFu;
}

// Twin of `sample::place`.
fn place(pixel: u32) -> vec2u {
    return vec2u(compact(pixel), compact(pixel >> 1u));
}

struct Footprint {
    middle: vec2f,
    half: vec2f,
    z: f32,
}

// Twin of `ImageWithDepth::point` and `reproject::footprint`; z is 0 for what is behind the eye.
fn footprint(run: Run, index: u32) -> Footprint {
    let image = images[run.image];
    let view = views.list[run.view - 1u];
    let scale = points[image.first + index].scale;
    let at = (vec2f(place(index)) + 0.5) / f32(image.resolution);
    let out = image.corner + image.edge_u * at.x + image.edge_v * at.y - image.eye;
    let away = image.eye + out * scale - view.eye;
    let z = dot(away, view.forward);
    if z <= 1e-4 {
        return Footprint(vec2f(0.0), vec2f(0.0), 0.0);
    }
    let size = vec2f(frame.size);
    let pixels = 0.5 * size / (frame.half_size * z);
    let on_lens = vec2f(dot(away, view.right), -dot(away, view.up));
    let middle = 0.5 * size + on_lens * pixels;
    let widened = scale * f32(1u << run.level) / f32(image.resolution);
    let side_u = image.edge_u * widened;
    let side_v = image.edge_v * widened;
    let u = abs(vec2f(dot(side_u, view.right), -dot(side_u, view.up)) - on_lens * (dot(side_u, view.forward) / z));
    let v = abs(vec2f(dot(side_v, view.right), -dot(side_v, view.up)) - on_lens * (dot(side_v, view.forward) / z));
    let half = min(0.5 * (u * pixels + v * pixels), vec2f(WIDEST));
    return Footprint(middle + 0.5 - frame.subpixel, half, z);
}

fn splat(group: vec3u, lane: u32, second: bool) {
    let number = group.x + ROW * group.y;
    if number >= runs[0].image {
        return;
    }
    let run = runs[number + 1u];
    let index = run.first + (lane << (2u * run.level));
    let seen = footprint(run, index);
    if seen.z == 0.0 {
        return;
    }
    let size = vec2f(frame.size);
    let own = floor(seen.middle);
    // Kept within what integers hold.
    let low = vec2i(clamp(min(ceil(seen.middle - seen.half - 0.5), own), vec2f(0.0), size));
    let high = vec2i(clamp(max(floor(seen.middle + seen.half - 0.5), own), vec2f(-1.0), size - 1.0));
    let near = bitcast<u32>(1.0 / seen.z);
    let code = 0xFFFFFFFFu - (images[run.image].first + index);
    for (var y = low.y; y <= high.y; y++) {
        for (var x = low.x; x <= high.x; x++) {
            let pixel = u32(y) * frame.size.x + u32(x);
            if u32(layers[state_of(frame.size, pixel, VIEW)]) != run.view {
                continue;
            }
            if second {
                if atomicLoad(&nearest[2u * pixel]) == near {
                    atomicMax(&nearest[2u * pixel + 1u], code);
                }
            } else if atomicLoad(&nearest[2u * pixel]) < near {
                atomicMax(&nearest[2u * pixel], near);
            }
        }
    }
}

@compute @workgroup_size(64)
fn splat_distance(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    splat(group, lane, false);
}

@compute @workgroup_size(64)
fn splat_number(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    splat(group, lane, true);
}

// The triangle of each pixel's nearest point; a pixel that none covers reflects as if dull.
@compute @workgroup_size(WORK_GROUP)
fn name_triangles(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let count = atomicLoad(&work[step.list * HEAD + 3u]);
    for (var i = id.x; i < count; i += groups.x * WORK_GROUP) {
        let pixel = atomicLoad(&work[work_place(frame.size, step.list, i)]);
        let code = atomicLoad(&nearest[2u * pixel + 1u]);
        if code == 0u {
            layers[state_of(frame.size, pixel, NEARNESS)] = NOT_MIRRORED;
            layers[state_of(frame.size, pixel, VIEW)] = 0.0;
            set_work(frame.size, WITHOUT_VIEW, add_work(WITHOUT_VIEW, 1u), pixel);
        } else {
            // Nothing, the largest number, becomes 0.
            let triangle = points[0xFFFFFFFFu - code].triangle + 1u;
            let at = vec2u(pixel % frame.size.x, pixel / frame.size.x);
            textureStore(mirrored_triangles, at, vec4u(triangle, 0u, 0u, 0u));
        }
    }
}
