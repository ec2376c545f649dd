// Mirrored views of one frame; the Rust sides are in core/src/mirror/gpu.rs.

struct MirroredView {
    eye: vec3f,
    reflector: u32,
    right: vec3f,
    // Number of the view it is seen in, counted from 1; 0 is the picture.
    parent: u32,
    up: vec3f,
    depth: u32,
    forward: vec3f,
    padding: u32,
    // What has dot(clip_normal, x) > clip_offset is shown.
    clip_normal: vec3f,
    clip_offset: f32,
}

struct MirroredViews {
    count: u32,
    // Nothing nearer to a reflector than this is seen in it, m.
    near: f32,
    // Whether what is glossy is made of particles, and needs no view.
    by_particles: u32,
    padding: u32,
    list: array<MirroredView, 64>,
}

// State of a pixel's mirrored ray behind the layers, a plane of the picture for each float: radiance; throughput; 1 over
// the distance from the eye to what is mirrored, along the unfolded ray, 1/m; view it goes on into.
const LAYERS: u32 = 5u;
const RADIANCE: u32 = 0u;
const THROUGHPUT: u32 = 3u;
const NEARNESS: u32 = 6u;
const VIEW: u32 = 7u;
// Nearness of a pixel that shows no mirror.
const NOT_MIRRORED: f32 = -1.0;
// View of a pixel whose layer glossy holds what it reflects already.
const CONVOLVED: f32 = -1.0;

fn state_of(size: vec2u, pixel: u32, plane: u32) -> u32 {
    return (3u * LAYERS + plane) * size.x * size.y + pixel;
}
