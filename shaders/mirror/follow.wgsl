// What arrives along the mirrored direction at each pixel: twin of `mirror::pass`.

@group(1) @binding(3) var<uniform> views: MirroredViews;

// The view, counted from 1, in which a surface shows what it mirrors; 0 for none. Only reflectors that face
// the eye have one, so the side that is seen reflects.
fn view_through(triangle: u32, seen_in: u32) -> u32 {
    let reflector = triangles[triangle].reflector;
    var found = 0u;
    for (var i = 0u; i < views.count; i++) {
        if views.list[i].parent == seen_in && views.list[i].reflector == reflector {
            found = i + 1u;
        }
    }
    return select(found, 0u, reflector == NONE);
}

// Whether a pixel's glossy layer is made of particles, elsewhere.
fn is_by_particles(id: vec2u) -> bool {
    let triangle = max(textureLoad(seen_triangles, id, 0).x, 1u) - 1u;
    return views.by_particles != 0u && materials[triangles[triangle].material].alpha > 0.0;
}

// The view of a pixel that reflects, counted from 1; 0 where it has none, and NONE where it does not reflect.
fn first_view(id: vec2u) -> u32 {
    let seen = textureLoad(seen_triangles, id, 0).x;
    let triangle = max(seen, 1u) - 1u;
    let reflects = seen != 0u && id.x < frame.size.x && materials[triangles[triangle].material].alpha >= 0.0
        && !is_by_particles(id);
    return select(NONE, view_through(triangle, 0u), reflects);
}

// Every pixel before its ray has met a mirror, a run of a row at a time.
@compute @workgroup_size(8, 8)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if id.y >= frame.size.y || id.x * RUN >= frame.size.x {
        return;
    }
    var counts = vec2u(0u);
    for (var i = 0u; i < RUN; i++) {
        let x = id.x * RUN + i;
        let view = first_view(vec2u(x, id.y));
        counts += vec2u(select(0u, 1u, view != NONE && view != 0u), select(0u, 1u, view == 0u));
        if x < frame.size.x {
            let pixel = id.y * frame.size.x + x;
            let mirrored = view != NONE && view != 0u;
            layers[state_of(frame.size, pixel, NEARNESS)] = select(NOT_MIRRORED, 0.0, mirrored);
            layers[state_of(frame.size, pixel, VIEW)] = select(0.0, f32(view), mirrored);
            let elsewhere = is_by_particles(vec2u(x, id.y)) && textureLoad(seen_triangles, vec2u(x, id.y), 0).x != 0u;
            if view == NONE && !elsewhere {
                store(pixel, 3u, vec3f(0.0));
                store(pixel, 4u, vec3f(0.0));
            }
        }
    }
    var next = vec2u(0u);
    if counts.x > 0u {
        next.x = add_work(WITH_VIEW, counts.x);
    }
    if counts.y > 0u {
        next.y = add_work(WITHOUT_VIEW, counts.y);
    }
    if counts.x + counts.y > 0u {
        for (var i = 0u; i < RUN; i++) {
            let pixel = id.y * frame.size.x + id.x * RUN + i;
            let view = first_view(vec2u(id.x * RUN + i, id.y));
            if view == 0u {
                set_work(frame.size, WITHOUT_VIEW, next.y, pixel);
                next.y += 1u;
            } else if view != NONE {
                set_work(frame.size, WITH_VIEW, next.x, pixel);
                next.x += 1u;
            }
        }
    }
}

fn follow(pixel: u32, rays: bool) {
    let number = u32(layers[state_of(frame.size, pixel, VIEW)]);
    if number == 0u {
        // No image-with-depth has seen what is mirrored there.
        return;
    }
    let view = views.list[number - 1u];
    var radiance = vec3f(0.0);
    var throughput = vec3f(1.0);
    if view.depth > 1u {
        radiance = state_vector(pixel, RADIANCE);
        throughput = state_vector(pixel, THROUGHPUT);
    }
    let id = vec2u(pixel % frame.size.x, pixel / frame.size.x);
    let seen = textureLoad(seen_triangles, id, 0).x;
    var next = 0u;
    if seen != 0u {
        let uv = (vec2f(id) + frame.subpixel) / vec2f(frame.size);
        let direction = normalize(
            view.forward
            + view.right * ((2.0 * uv.x - 1.0) * frame.half_size.x)
            + view.up * ((1.0 - 2.0 * uv.y) * frame.half_size.y));
        let surface = surface_seen(seen - 1u, view.eye, direction);
        if view.depth == 1u {
            // The mirrored eye is as far from it as the eye is along the unfolded ray.
            layers[state_of(frame.size, pixel, NEARNESS)] = 1.0 / length(surface.position - view.eye);
        }
        let stored = stored_light(surface);
        let scramble = hash2(pixel_scramble(pixel), view.depth);
        let terms = diffuse_terms(surface, stored, rays, scramble);
        radiance += throughput * (terms.emitted + terms.direct + terms.indirect);
        if glass {
            let behind = seen_through(surface, direction, rays, scramble, true, true);
            radiance += throughput * (behind.emitted + behind.direct + behind.indirect + behind.bent);
        }
        next = view_through(seen - 1u, number);
        if next == 0u {
            radiance += throughput * wide_reflection(surface, stored, -direction);
        } else {
            throughput *= specular_reflectance(specular_at(surface), -dot(direction, surface.geometric_normal));
            let list = 1u + (view.depth + 1u) % 2u;
            set_work(frame.size, list, add_work(list, 1u), pixel);
        }
    }
    set_state_vector(pixel, RADIANCE, radiance);
    if next != 0u {
        set_state_vector(pixel, THROUGHPUT, throughput);
    }
    layers[state_of(frame.size, pixel, VIEW)] = f32(next);
}

// Direct light by shadow rays.
@compute @workgroup_size(WORK_GROUP)
fn follow_per_pixel(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let count = atomicLoad(&work[step.list * HEAD + 3u]);
    for (var i = id.x; i < count; i += groups.x * WORK_GROUP) {
        follow(atomicLoad(&work[work_place(frame.size, step.list, i)]), true);
    }
}

// Direct light from the elements.
@compute @workgroup_size(WORK_GROUP)
fn follow_elements(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let count = atomicLoad(&work[step.list * HEAD + 3u]);
    for (var i = id.x; i < count; i += groups.x * WORK_GROUP) {
        follow(atomicLoad(&work[work_place(frame.size, step.list, i)]), false);
    }
}

fn reflect_pixel(pixel: u32, mirrored: bool) {
    let id = vec2u(pixel % frame.size.x, pixel / frame.size.x);
    let direction = pixel_direction(frame, id, frame.subpixel);
    let surface = surface_seen(textureLoad(seen_triangles, id, 0).x - 1u, frame.eye, direction);
    let specular = specular_at(surface);
    var value: vec3f;
    if !mirrored {
        value = wide_reflection(surface, stored_light(surface), -direction);
    } else {
        let arriving = state_vector(pixel, RADIANCE);
        value = reflectance_of_uniform_light(specular, -dot(direction, surface.geometric_normal)) * arriving;
    }
    value = select(vec3f(0.0), value, specular.alpha >= 0.0);
    var bent = vec3f(0.0);
    if glass {
        bent = seen_through(surface, direction, frame.samples > 0u, pixel_scramble(pixel), false, true).bent;
    }
    store(pixel, 3u, bent + select(vec3f(0.0), value, specular.alpha == 0.0));
    store(pixel, 4u, select(value, vec3f(0.0), specular.alpha == 0.0));
}

// What arrived, reflected into the layers mirror and glossy; `begin` has seen to what reflects nothing.
@compute @workgroup_size(WORK_GROUP)
fn reflect_into_layers(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let count = atomicLoad(&work[WITH_VIEW * HEAD + 3u]);
    for (var i = id.x; i < count; i += groups.x * WORK_GROUP) {
        let pixel = atomicLoad(&work[work_place(frame.size, WITH_VIEW, i)]);
        // What no image-with-depth has seen is among those without a view.
        if layers[state_of(frame.size, pixel, NEARNESS)] == NOT_MIRRORED {
            continue;
        }
        // What is convolved has put itself into the layer glossy.
        if layers[state_of(frame.size, pixel, VIEW)] == CONVOLVED {
            store(pixel, 3u, vec3f(0.0));
        } else {
            reflect_pixel(pixel, true);
        }
    }
}

// The same of what has no view.
@compute @workgroup_size(WORK_GROUP)
fn reflect_as_if_dull(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let count = atomicLoad(&work[WITHOUT_VIEW * HEAD + 3u]);
    for (var i = id.x; i < count; i += groups.x * WORK_GROUP) {
        reflect_pixel(atomicLoad(&work[work_place(frame.size, WITHOUT_VIEW, i)]), false);
    }
}
