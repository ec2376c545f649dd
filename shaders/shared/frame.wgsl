// One frame's camera and counters; the Rust side is `Frame` in core/src/gpu/frame.rs.

struct Frame {
    eye: vec3f,
    frame: u32,
    forward: vec3f,
    samples: u32,
    right: vec3f,
    emitter_count: u32,
    up: vec3f,
    tree_count: u32,
    // Slopes of the picture's right and upper edge.
    half_size: vec2f,
    size: vec2u,
    subpixel: vec2f,
    seed: u32,
    // Frames already in the running mean.
    accumulated: u32,
    near: f32,
    highlighted: u32,
    line_width: f32,
    depth_bias: f32,
}

// Unit direction through `subpixel` of a pixel: twin of `Camera::ray_direction`.
fn pixel_direction(frame: Frame, pixel: vec2u, subpixel: vec2f) -> vec3f {
    let uv = (vec2f(pixel) + subpixel) / vec2f(frame.size);
    return normalize(
        frame.forward
        + frame.right * ((2.0 * uv.x - 1.0) * frame.half_size.x)
        + frame.up * ((1.0 - 2.0 * uv.y) * frame.half_size.y));
}

// (right, up, forward) coordinates from the eye, m.
fn view_position(frame: Frame, position: vec3f) -> vec3f {
    let p = position - frame.eye;
    return vec3f(dot(p, frame.right), dot(p, frame.up), dot(p, frame.forward));
}

// Clip coordinates of view coordinates; depth is near / distance, so that floats spread evenly.
fn clip_position(frame: Frame, view: vec3f) -> vec4f {
    return vec4f(view.xy / frame.half_size, frame.near, view.z);
}
