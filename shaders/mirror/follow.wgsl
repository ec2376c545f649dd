// What arrives along the mirrored direction at each pixel: twin of `mirror::pass`.

@group(1) @binding(3) var<uniform> views: MirroredViews;

fn state_of_pixel(pixel: u32) -> u32 {
    return state_of(frame.size, pixel);
}

// The view, counted from 1, in which a surface shows what it mirrors; 0 for none.
fn view_through(surface: Surface, seen_in: u32) -> u32 {
    let reflector = triangles[surface.triangle].reflector;
    if reflector == NONE || !is_lit(surface) {
        return 0u;
    }
    for (var i = 0u; i < views.count; i++) {
        if views.list[i].parent == seen_in && views.list[i].reflector == reflector {
            return i + 1u;
        }
    }
    return 0u;
}

fn add_radiance(state: u32, radiance: vec3f) {
    for (var i = 0u; i < 3u; i++) {
        layers[state + i] += layers[state + 3u + i] * radiance[i];
    }
}

// Every pixel before its ray has met a mirror.
@compute @workgroup_size(8, 8)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= frame.size) {
        return;
    }
    let pixel = id.y * frame.size.x + id.x;
    let seen = textureLoad(seen_triangles, id.xy, 0).x;
    var view = 0u;
    if seen != 0u {
        view = view_through(surface_seen(seen - 1u, frame.eye, pixel_direction(frame, id.xy, frame.subpixel)), 0u);
    }
    let state = state_of_pixel(pixel);
    for (var i = 0u; i < 3u; i++) {
        layers[state + i] = 0.0;
        layers[state + 3u + i] = 1.0;
    }
    layers[state + 6u] = select(NOT_MIRRORED, FAR, view != 0u);
    layers[state + 7u] = f32(view);
}

fn follow(id: vec2u, rays: bool) {
    if any(id >= frame.size) {
        return;
    }
    let pixel = id.y * frame.size.x + id.x;
    let state = state_of_pixel(pixel);
    let number = u32(layers[state + 7u]);
    if number == 0u {
        return;
    }
    let view = views.list[number - 1u];
    let seen = textureLoad(seen_triangles, id, 0).x;
    if seen == 0u {
        layers[state + 7u] = 0.0;
        return;
    }
    let uv = (vec2f(id) + frame.subpixel) / vec2f(frame.size);
    let direction = normalize(
        view.forward
        + view.right * ((2.0 * uv.x - 1.0) * frame.half_size.x)
        + view.up * ((1.0 - 2.0 * uv.y) * frame.half_size.y));
    let surface = surface_seen(seen - 1u, view.eye, direction);
    if view.depth == 1u {
        // From where the ray crosses the reflector's plane.
        let height = dot(view.clip_normal, surface.position) - view.clip_offset;
        layers[state + 6u] = height / max(dot(view.clip_normal, direction), 1e-6);
    }
    let next = view_through(surface, number);
    let terms = diffuse_terms(surface, rays, hash2(pixel_scramble(pixel), view.depth));
    add_radiance(state, terms.emitted + terms.direct + terms.indirect);
    if next == 0u {
        add_radiance(state, wide_reflection(surface, -direction));
    } else {
        let reflectance = specular_reflectance(specular_at(surface), -dot(direction, surface.geometric_normal));
        for (var i = 0u; i < 3u; i++) {
            layers[state + 3u + i] *= reflectance[i];
        }
    }
    layers[state + 7u] = f32(next);
}

@compute @workgroup_size(8, 8)
fn follow_per_pixel(@builtin(global_invocation_id) id: vec3u) {
    follow(id.xy, true);
}

@compute @workgroup_size(8, 8)
fn follow_elements(@builtin(global_invocation_id) id: vec3u) {
    follow(id.xy, false);
}

// What arrived, reflected into the layers mirror and glossy.
@compute @workgroup_size(8, 8)
fn reflect_into_layers(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= frame.size) {
        return;
    }
    let pixel = id.y * frame.size.x + id.x;
    let seen = textureLoad(seen_triangles, id.xy, 0).x;
    var mirror = vec3f(0.0);
    var glossy = vec3f(0.0);
    if seen != 0u {
        let direction = pixel_direction(frame, id.xy, frame.subpixel);
        let surface = surface_seen(seen - 1u, frame.eye, direction);
        let specular = specular_at(surface);
        if specular.alpha >= 0.0 {
            let state = state_of_pixel(pixel);
            var value: vec3f;
            if layers[state + 6u] == NOT_MIRRORED {
                value = wide_reflection(surface, -direction);
            } else {
                let arriving = vec3f(layers[state], layers[state + 1u], layers[state + 2u]);
                if layers[state + 7u] < 0.0 {
                    // Convolved, with the reflectance of its lobe.
                    value = vec3f(layers[state + 3u], layers[state + 4u], layers[state + 5u]) * arriving;
                } else {
                    value = specular_reflectance(specular, -dot(direction, surface.geometric_normal)) * arriving;
                }
            }
            if specular.alpha == 0.0 {
                mirror = value;
            } else {
                glossy = value;
            }
        }
    }
    store(pixel, 3u, mirror);
    store(pixel, 4u, glossy);
}
