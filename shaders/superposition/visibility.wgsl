// Which triangle each pixel sees: twin of `gbuffer::first_visible`, by rasterisation.

@group(1) @binding(0) var<uniform> frame: Frame;

struct Seen {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, first) triangle: u32,
}

@vertex
fn project(@builtin(vertex_index) index: u32) -> Seen {
    let view = view_position(frame, corners[index].position);
    var clip = clip_position(frame, view);
    // The pixel's centre shows what the ray through `subpixel` meets.
    let shift = vec2f(1.0 - 2.0 * frame.subpixel.x, 2.0 * frame.subpixel.y - 1.0) / vec2f(frame.size);
    clip = vec4f(clip.xy + shift * clip.w, clip.zw);
    return Seen(clip, index / 3u);
}

@fragment
fn identify(seen: Seen) -> @location(0) u32 {
    return seen.triangle + 1u;
}
