// The variant kernel at every second pixel of every second row, and between them: twin of `GlossyFrame::nodes` and
// `GlossyFrame::between` in core/src/glossy/pass.rs.

const SMALL_RADIUS: f32 = 4.0;
const ALIKE: f32 = 0.1;

// Node (x, y) is the pixel (2x, 2y); nodes are kept where the texels of level 1 are.
@compute @workgroup_size(8, 8)
fn scatter_nodes(@builtin(global_invocation_id) id: vec3u) {
    let here = info.levels[1];
    if is_beyond(here, id.xy) {
        return;
    }
    let node = texel_of(here, id.xy);
    let pixel = glossy_pixel(2u * node);
    var out = vec4f(0.0);
    if pixel.known {
        let radius = reach_of(pixel);
        if radius >= SMALL_RADIUS {
            out = vec4f(gathered(pixel, radius), 1.0);
        }
    }
    convolved[texel_place(here, node.x, node.y)] = out;
}

// Weight of the node before a pixel's place, or of the one after it, along both axes.
fn node_weight(at: vec2u, after: vec2u) -> f32 {
    let odd = at % vec2u(2u);
    let w = select(select(vec2f(0.0), vec2f(1.0), after == vec2u(0u)), vec2f(0.5), odd == vec2u(1u));
    return w.x * w.y;
}

@compute @workgroup_size(8, 8)
fn scatter_half(@builtin(global_invocation_id) id: vec3u) {
    let pixel = own_pixel(id.xy);
    if !pixel.known {
        return;
    }
    let at = pixel.at;
    let radius = reach_of(pixel);
    let here = info.levels[1];
    var sum = vec3f(0.0);
    var weights = 0.0;
    if radius >= SMALL_RADIUS {
        let own = texel_at(0u, i32(at.x), i32(at.y));
        for (var i = 0u; i < 4u; i++) {
            let after = vec2u(i & 1u, i >> 1u);
            let node = at / 2u + after;
            let weight = node_weight(at, after);
            let texel = texel_at(0u, i32(2u * node.x), i32(2u * node.y));
            let apart = abs(texel.nearness - own.nearness);
            if weight > 0.0 && level_holds(here, i32(node.x), i32(node.y)) && texel.reflector == own.reflector
                && apart <= ALIKE * max(own.nearness, texel.nearness) {
                let found = convolved[texel_place(here, node.x, node.y)];
                sum += found.xyz * (weight * found.w);
                weights += weight * found.w;
            }
        }
    }
    if weights > 0.0 {
        put(pixel, sum / weights);
    } else {
        put(pixel, gathered(pixel, radius));
    }
}
