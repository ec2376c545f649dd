// Curved reflectors by environment maps: twin of core/src/glossy/environment.rs.

// For each map its middle and first texel, and its size; then the texels of all, radiance and distance.
@group(0) @binding(14) var<storage, read> environments: array<vec4f>;

// Twin of `Environment::texel_at`.
fn environment_texel(first: u32, size: vec2u, direction: vec3f) -> vec4f {
    let longitude = atan2(direction.x, -direction.z) / (2.0 * PI) + 0.5;
    let latitude = acos(clamp(direction.y, -1.0, 1.0)) / PI;
    let x = longitude * f32(size.x) - 0.5;
    let y = clamp(latitude * f32(size.y) - 0.5, 0.0, f32(size.y - 1u));
    let column = floor(x);
    let row = min(u32(floor(y)), size.y - 2u);
    let left = u32(i32(column) + i32(size.x)) % size.x;
    let right = (left + 1u) % size.x;
    let top = first + row * size.x;
    let bottom = top + size.x;
    return mix(
        mix(environments[top + left], environments[top + right], x - column),
        mix(environments[bottom + left], environments[bottom + right], x - column),
        y - f32(row));
}

// Twin of `Environment::radiance`.
fn environment_radiance(number: u32, position: vec3f, direction: vec3f) -> vec3f {
    let head = environments[2u * number];
    let first = u32(head.w);
    let size = vec2u(environments[2u * number + 1u].xy);
    let origin = position - head.xyz;
    var along = direction;
    for (var i = 0; i < 2; i++) {
        let distance = environment_texel(first, size, along).w;
        let b = dot(origin, direction);
        let inside = b * b - dot(origin, origin) + distance * distance;
        if inside > 0.0 {
            along = normalize_or(origin + direction * (sqrt(inside) - b), direction);
        }
    }
    return environment_texel(first, size, along).xyz;
}
