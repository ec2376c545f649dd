// Clear glass: twin of core/src/scene/glass.rs.

const MOST_FACES: u32 = 16u;

// What lies behind a surface: where a ray goes on, and the share of its radiance that is seen before it.
struct Passed {
    origin: vec3f,
    direction: vec3f,
    share: vec3f,
}

fn is_glass(triangle: u32) -> bool {
    return materials[triangles[triangle].material].passes > 0.0;
}

// Twin of `glass::refracted`; zero beyond the critical angle.
fn refracted(direction: vec3f, normal: vec3f, ratio: f32) -> vec3f {
    let cosine = -dot(direction, normal);
    let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    if squared <= 0.0 {
        return vec3f(0.0);
    }
    return normalize(ratio * direction + (ratio * cosine - sqrt(squared)) * normal);
}

fn reflected_inside(surface: Surface, direction: vec3f) -> Passed {
    var along = direction - 2.0 * dot(direction, surface.normal) * surface.normal;
    if dot(along, surface.geometric_normal) <= 0.0 {
        along = direction - 2.0 * dot(direction, surface.geometric_normal) * surface.geometric_normal;
    }
    return Passed(offset_origin(surface.position, surface.geometric_normal), along, vec3f(1.0));
}

// Twin of `Glass::pass_or_reflect`.
fn pass_or_reflect(surface: Surface, direction: vec3f) -> Passed {
    let material = materials[triangles[surface.triangle].material];
    let tint = material.passes * textured(material.reflectance, material.reflectance_texture, surface.uv);
    let side = side_met(material, surface.back);
    let origin = offset_origin(surface.position, -surface.geometric_normal);
    var normal = surface.normal;
    if dot(normal, direction) >= 0.0 {
        normal = surface.geometric_normal;
    }
    if side == PANE {
        let reflected = boundary_reflectance(side, material.dielectric, -dot(direction, normal));
        return Passed(origin, direction, tint * (1.0 - reflected));
    }
    let index = effective_index(material.dielectric);
    let ratio = select(1.0 / index, index, side == INSIDE);
    var behind = refracted(direction, normal, ratio);
    if all(behind == vec3f(0.0)) {
        return reflected_inside(surface, direction);
    }
    if dot(behind, surface.geometric_normal) >= 0.0 {
        normal = surface.geometric_normal;
        behind = refracted(direction, normal, ratio);
        if all(behind == vec3f(0.0)) {
            return reflected_inside(surface, direction);
        }
    }
    let reflected = boundary_reflectance(side, material.dielectric, -dot(direction, normal));
    return Passed(origin, behind, tint * ((1.0 - reflected) * ratio * ratio));
}

// Twin of `World::transmittance`.
fn transmittance(tree_count: u32, origin: vec3f, direction: vec3f, t_max: f32) -> vec3f {
    if !glass {
        return vec3f(select(1.0, 0.0, occluded(tree_count, origin, direction, t_max)));
    }
    var share = vec3f(1.0);
    var t_min = 0.0;
    let along = normalize(direction);
    for (var face = 0u; face < MOST_FACES; face++) {
        let hit = nearest(tree_count, origin, direction, t_min, t_max);
        if hit.triangle == NONE {
            return share;
        }
        let surface = surface_seen(hit.triangle, origin, direction);
        let material = materials[triangles[hit.triangle].material];
        if material.passes <= 0.0 || side_met(material, surface.back) != PANE {
            break;
        }
        share *= pass_or_reflect(surface, along).share;
        t_min = hit.t * (1.0 + 1e-5) + 1e-30;
    }
    return vec3f(0.0);
}
