// The diffuse layers of one frame: twin of `pass::render`.

fn shade(id: vec2u, rays: bool) {
    if any(id >= frame.size) {
        return;
    }
    let pixel = id.y * frame.size.x + id.x;
    let seen = textureLoad(seen_triangles, id, 0).x;
    var terms = Terms();
    if seen != 0u {
        let direction = pixel_direction(frame, id, frame.subpixel);
        let surface = surface_seen(seen - 1u, frame.eye, direction);
        terms = diffuse_terms(surface, stored_light(surface), rays, pixel_scramble(pixel));
        if glass {
            let behind = seen_through(surface, direction, rays, pixel_scramble(pixel), true, false);
            terms.emitted += behind.emitted;
            terms.direct += behind.direct;
            terms.indirect += behind.indirect;
        }
    }
    store(pixel, 0u, terms.emitted);
    store(pixel, 1u, terms.direct);
    store(pixel, 2u, terms.indirect);
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
