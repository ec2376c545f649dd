// Direction bins: twins of core/src/math/sphere_map.rs.

fn square_from_disc(d: vec2f) -> vec2f {
    let r = length(d);
    if r == 0.0 {
        return vec2f(0.5);
    }
    let quarter = 0.78539816339745;
    var p: vec2f;
    if abs(d.x) > abs(d.y) {
        let a = select(r, -r, d.x < 0.0);
        p = vec2f(a, a * atan(d.y / d.x) / quarter);
    } else {
        let b = select(r, -r, d.y < 0.0);
        p = vec2f(b * atan(d.x / d.y) / quarter, b);
    }
    return clamp(0.5 * p + vec2f(0.5), vec2f(0.0), vec2f(1.0));
}

// Twin of `DirectionBins::bin` for `n` rows a hemisphere.
fn direction_bin(n: u32, direction: vec3f) -> u32 {
    let r2 = 1.0 - abs(direction.y);
    let disc = direction.xz / sqrt(max(2.0 - r2, 1e-30));
    let square = square_from_disc(disc);
    let cell = min(vec2u(square * f32(n)), vec2u(n - 1u));
    return cell.y * n + cell.x + select(0u, n * n, direction.y < 0.0);
}
