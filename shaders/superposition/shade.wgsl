// The layers of one frame: twin of `pass::render`.

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var seen_triangles: texture_2d<u32>;
// Three floats a pixel, layer after layer.
@group(1) @binding(2) var<storage, read_write> layers: array<f32>;

fn store(pixel: u32, layer: u32, radiance: vec3f) {
    let first = 3u * (layer * frame.size.x * frame.size.y + pixel);
    for (var i = 0u; i < 3u; i++) {
        var value = radiance[i];
        if frame.accumulated > 0u {
            let mean = layers[first + i];
            value = mean + (value - mean) / f32(frame.accumulated + 1u);
        }
        layers[first + i] = value;
    }
}

fn shade(id: vec2u, rays: bool) {
    if any(id >= frame.size) {
        return;
    }
    let pixel = id.y * frame.size.x + id.x;
    let seen = textureLoad(seen_triangles, id, 0).x;
    var emitted = vec3f(0.0);
    var direct = vec3f(0.0);
    var indirect = vec3f(0.0);
    if seen != 0u {
        let direction = pixel_direction(frame, id, frame.subpixel);
        let surface = surface_seen(seen - 1u, frame.eye, direction);
        emitted = emission_at(surface);
        let reflectance = reflectance_at(surface);
        if any(reflectance != vec3f(0.0)) {
            let brdf = reflectance * (1.0 / PI);
            let stored = stored_light(surface);
            indirect = brdf * stored.indirect;
            if rays && objects[triangles[surface.triangle].object].stored_direct == 0u {
                let scramble = hash2(pixel, hash2(frame.frame, frame.seed));
                let origin = offset_origin(surface.position, surface.geometric_normal);
                direct = brdf * total_irradiance(frame, Receiver(surface.position, surface.normal, origin), scramble);
            } else {
                direct = brdf * stored.direct;
            }
        }
    }
    store(pixel, 0u, emitted);
    store(pixel, 1u, direct);
    store(pixel, 2u, indirect);
}

// Direct light by shadow rays at every pixel.
@compute @workgroup_size(8, 8)
fn shade_per_pixel(@builtin(global_invocation_id) id: vec3u) {
    shade(id.xy, true);
}

// Direct light from the elements: no ray is traced.
@compute @workgroup_size(8, 8)
fn shade_elements(@builtin(global_invocation_id) id: vec3u) {
    shade(id.xy, false);
}
