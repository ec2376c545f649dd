// Which triangle each pixel sees by way of a mirror, under the mask of the reflector and beyond its plane.

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(2) var<storage, read> layers: array<f32>;
@group(1) @binding(3) var<uniform> views: MirroredViews;

struct Mirrored {
    @builtin(position) position: vec4f,
    @location(0) height: f32,
    @location(1) @interpolate(flat, first) triangle: u32,
    // Whether the triangle is part of the view's own reflector.
    @location(2) @interpolate(flat, first) own: u32,
}

struct Mask {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, first) view: u32,
}

// A triangle over the whole picture.
@vertex
fn cover(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> Mask {
    return Mask(vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0), number);
}

// Depth that lets a view's triangles through where its reflector shows, and nothing anywhere else.
@fragment
fn mask(seen: Mask) -> @builtin(frag_depth) f32 {
    let id = vec2u(seen.position.xy);
    let wanted = u32(layers[state_of(frame.size, id.y * frame.size.x + id.x, VIEW)]);
    return select(1.0, 0.0, wanted == seen.view + 1u);
}

@vertex
fn project(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> Mirrored {
    let view = views.list[number];
    let position = corners[index].position;
    let away = position - view.eye;
    let seen = vec3f(dot(away, view.right), dot(away, view.up), dot(away, view.forward));
    var clip = clip_position(frame, seen);
    let shift = vec2f(1.0 - 2.0 * frame.subpixel.x, 2.0 * frame.subpixel.y - 1.0) / vec2f(frame.size);
    clip = vec4f(clip.xy + shift * clip.w, clip.zw);
    let own = triangles[index / 3u].reflector == view.reflector;
    return Mirrored(clip, dot(view.clip_normal, position) - view.clip_offset, index / 3u, u32(own));
}

@fragment
fn identify(seen: Mirrored) -> @location(0) u32 {
    if seen.height <= views.near || seen.own != 0u {
        discard;
    }
    return seen.triangle + 1u;
}
