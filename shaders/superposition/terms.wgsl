// Radiance of a surface by term, and the layers it goes into: twin of `pass::Shading`.

struct Terms {
    emitted: vec3f,
    direct: vec3f,
    indirect: vec3f,
    // Of what is seen through solids of glass, and reflected by what is behind any.
    bent: vec3f,
}

// Scramble of this frame's shadow rays at a pixel.
fn pixel_scramble(pixel: u32) -> u32 {
    return hash2(pixel, hash2(frame.frame, frame.seed));
}

// By the specular lobe: from the map of what is curved, or as if it were as wide as the hemisphere, of the light
// stored at a surface.
fn wide_reflection(surface: Surface, stored: StoredLight, wo: vec3f) -> vec3f {
    let specular = specular_at(surface);
    if specular.alpha < 0.0 || specular.side == INSIDE {
        return vec3f(0.0);
    }
    let number = triangles[surface.triangle].environment;
    if general && number != NONE {
        let cosine = dot(surface.normal, wo);
        let mirrored = 2.0 * cosine * surface.normal - wo;
        return reflectance_of_uniform_light(specular, cosine) * environment_radiance(number, surface.position, mirrored);
    }
    let share = reflectance_of_uniform_light(specular, dot(wo, surface.normal));
    return share * (1.0 / PI) * (stored.direct + stored.indirect);
}

// All but the lobe; direct light by shadow rays or from the elements.
fn diffuse_terms(surface: Surface, stored: StoredLight, rays: bool, scramble: u32) -> Terms {
    let own = own_light(surface);
    var terms = Terms(own.emission, vec3f(0.0), vec3f(0.0), vec3f(0.0));
    let brdf = own.reflectance * (1.0 / PI);
    terms.indirect = brdf * stored.indirect;
    terms.direct = brdf * stored.direct;
    if rays && any(brdf != vec3f(0.0)) && objects[triangles[surface.triangle].object].stored_direct == 0u {
        let origin = offset_origin(surface.position, surface.geometric_normal);
        terms.direct = brdf * total_irradiance(frame, Receiver(surface.position, surface.normal, origin), scramble);
    }
    return terms;
}

// What is seen through a surface of glass along a direction, straight through panes and otherwise, as far as it is
// wanted: twin of `World::seen_through` and the loop over it in `Shading::terms`.
fn seen_through(start: Surface, along: vec3f, rays: bool, scramble: u32, straight: bool, otherwise: bool) -> Terms {
    var terms = Terms();
    var surface = start;
    var direction = along;
    var share = vec3f(1.0);
    var bent = false;
    for (var face = 0u; face < MOST_FACES; face++) {
        let material = materials[triangles[surface.triangle].material];
        bent = bent || side_met(material, surface.back) != PANE;
        if !is_glass(surface.triangle) || (bent && !otherwise) {
            break;
        }
        let passed = pass_or_reflect(surface, direction);
        let hit = nearest(frame.tree_count, passed.origin, passed.direction, 0.0, FAR);
        if hit.triangle == NONE {
            break;
        }
        direction = passed.direction;
        share *= passed.share;
        surface = surface_seen(hit.triangle, passed.origin, direction);
        let stored = stored_light(surface);
        if otherwise {
            terms.bent += share * wide_reflection(surface, stored, -direction);
        }
        if (bent && otherwise) || (!bent && straight) {
            let seen = diffuse_terms(surface, stored, rays, hash2(scramble, face + 1u));
            if bent {
                terms.bent += share * (seen.emitted + seen.direct + seen.indirect);
            } else {
                terms.emitted += share * seen.emitted;
                terms.direct += share * seen.direct;
                terms.indirect += share * seen.indirect;
            }
        }
    }
    return terms;
}
