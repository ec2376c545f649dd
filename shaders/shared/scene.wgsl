// The scene's tables; the Rust sides are in core/src/gpu/tables.rs.

const NONE: u32 = 0xFFFFFFFFu;
const PI: f32 = 3.14159265358979;

// Whether something has been moved, a material has two pictures, or a curved reflector a map. Pipelines for
// scenes without leave out what only those need, since processors that stand in for a graphics card take every branch.
override general: bool = true;
// Whether light passes through anything.
override glass: bool = true;

struct Corner {
    position: vec3f,
    u: f32,
    normal: vec3f,
    v: f32,
}

struct TriangleInfo {
    material: u32,
    object: u32,
    // Flat reflector it is part of, or NONE.
    reflector: u32,
    // Environment map of a curved reflector, or NONE.
    environment: u32,
}

struct ObjectInfo {
    dimmer: f32,
    // Record of its first triangle in `moved_light`, or NONE.
    moved_first: u32,
    first_triangle: u32,
    // 1 where direct light is always the stored one.
    stored_direct: u32,
}

struct MaterialInfo {
    reflectance: vec3f,
    reflectance_texture: u32,
    emission: vec3f,
    emission_texture: u32,
    double_sided: u32,
    diffuse_share: f32,
    metallic: f32,
    dielectric: f32,
    // Of the specular lobe; 0 for an ideal mirror, negative for none.
    alpha: f32,
    // Share of what is not reflected that goes on through it, beside its colour.
    passes: f32,
    // Whether it bounds a solid, and is not a pane.
    solid: u32,
    // Of Phong's lobe, 0 of GGX.
    exponent: f32,
}

struct TextureInfo {
    first: u32,
    width: u32,
    height: u32,
    padding: u32,
}

@group(0) @binding(0) var<storage, read> corners: array<Corner>;
@group(0) @binding(1) var<storage, read> triangles: array<TriangleInfo>;
@group(0) @binding(2) var<storage, read> materials: array<MaterialInfo>;
@group(0) @binding(3) var<storage, read> objects: array<ObjectInfo>;
@group(0) @binding(4) var<storage, read> textures: array<TextureInfo>;
// Four halves a texel.
@group(0) @binding(5) var<storage, read> texels: array<vec2u>;

struct Surface {
    position: vec3f,
    geometric_normal: vec3f,
    normal: vec3f,
    uv: vec2f,
    barycentric: vec2f,
    triangle: u32,
    back: bool,
}

// Twin of `accel::barycentric`.
fn barycentric(origin: vec3f, direction: vec3f, a: vec3f, b: vec3f, c: vec3f) -> vec2f {
    let e1 = b - a;
    let e2 = c - a;
    let p = cross(direction, e2);
    let determinant = dot(e1, p);
    if determinant == 0.0 {
        return vec2f(1.0 / 3.0);
    }
    let inverse = 1.0 / determinant;
    let s = origin - a;
    let u = clamp(dot(s, p) * inverse, 0.0, 1.0);
    let v = clamp(dot(direction, cross(s, e1)) * inverse, 0.0, 1.0);
    let excess = max(u + v, 1.0);
    return vec2f(u, v) / excess;
}

fn normalize_or(v: vec3f, fallback: vec3f) -> vec3f {
    let l = length(v);
    if l > 0.0 {
        return v / l;
    }
    return fallback;
}

// Twin of `Geometry::surface`, at the point of the triangle that a ray sees.
fn surface_seen(triangle: u32, origin: vec3f, direction: vec3f) -> Surface {
    let a = corners[3u * triangle];
    let b = corners[3u * triangle + 1u];
    let c = corners[3u * triangle + 2u];
    let weights = barycentric(origin, direction, a.position, b.position, c.position);
    let w = 1.0 - weights.x - weights.y;
    let front = normalize_or(cross(b.position - a.position, c.position - a.position), vec3f(0.0, 1.0, 0.0));
    let back = dot(front, direction) > 0.0;
    let side = select(1.0, -1.0, back);
    let shading = normalize_or(a.normal * w + b.normal * weights.x + c.normal * weights.y, front);
    return Surface(
        a.position * w + b.position * weights.x + c.position * weights.y,
        front * side,
        shading * side,
        vec2f(a.u, a.v) * w + vec2f(b.u, b.v) * weights.x + vec2f(c.u, c.v) * weights.y,
        weights,
        triangle,
        back,
    );
}

// A place at most one beyond either end of `size`, brought round: division would cost more than the rest.
fn wrapped(i: i32, size: u32) -> u32 {
    let n = i32(size);
    return u32(select(select(i, i - n, i >= n), i + n, i < 0));
}

fn texel(info: TextureInfo, x: i32, y: i32) -> vec3f {
    let column = wrapped(x, info.width);
    let row = wrapped(y, info.height);
    let packed = texels[info.first + row * info.width + column];
    return vec3f(unpack2x16float(packed.x), unpack2x16float(packed.y).x);
}

// Twin of `LinearImage::sample_repeat`.
fn sample_repeat(texture: u32, uv: vec2f) -> vec3f {
    let info = textures[texture];
    let p = (uv - floor(uv)) * vec2f(f32(info.width), f32(info.height)) - vec2f(0.5);
    let base = floor(p);
    let f = p - base;
    let x = i32(base.x);
    let y = i32(base.y);
    let top = mix(texel(info, x, y), texel(info, x + 1, y), f.x);
    let bottom = mix(texel(info, x, y + 1), texel(info, x + 1, y + 1), f.x);
    return mix(top, bottom, f.y);
}

fn textured(value: vec3f, texture: u32, uv: vec2f) -> vec3f {
    if texture == NONE {
        return value;
    }
    return value * sample_repeat(texture, uv);
}

// Twin of `Geometry::reflectance`.
fn reflectance_at(surface: Surface) -> vec3f {
    let material = materials[triangles[surface.triangle].material];
    if surface.back && material.double_sided == 0u {
        return vec3f(0.0);
    }
    return textured(material.reflectance * material.diffuse_share, material.reflectance_texture, surface.uv);
}

// Twin of `Geometry::emission`.
fn emission_at(surface: Surface) -> vec3f {
    let info = triangles[surface.triangle];
    let material = materials[info.material];
    if all(material.emission == vec3f(0.0)) || (surface.back && material.double_sided == 0u) {
        return vec3f(0.0);
    }
    return textured(material.emission, material.emission_texture, surface.uv) * objects[info.object].dimmer;
}

struct Own {
    reflectance: vec3f,
    emission: vec3f,
}

// Reflectance and emission, with one look-up where a material has one picture at most.
fn own_light(surface: Surface) -> Own {
    if general {
        return Own(reflectance_at(surface), emission_at(surface));
    }
    let info = triangles[surface.triangle];
    let material = materials[info.material];
    let lit = select(1.0, 0.0, surface.back && material.double_sided == 0u);
    let picture = min(material.reflectance_texture, material.emission_texture);
    let texel = textured(vec3f(1.0), picture, surface.uv);
    let coloured = select(vec3f(1.0), texel, material.reflectance_texture != NONE);
    let glowing = select(vec3f(1.0), texel, material.emission_texture != NONE);
    return Own(
        material.reflectance * material.diffuse_share * coloured * lit,
        material.emission * glowing * (lit * objects[info.object].dimmer));
}

// Twin of `geometry::offset_origin`.
fn offset_axis(p: f32, n: f32) -> f32 {
    if abs(p) < 1.0 / 32.0 {
        return p + (1.0 / 65536.0) * n;
    }
    let step = i32(256.0 * n);
    return bitcast<f32>(bitcast<i32>(p) + select(step, -step, p < 0.0));
}

fn offset_origin(position: vec3f, normal: vec3f) -> vec3f {
    return vec3f(
        offset_axis(position.x, normal.x),
        offset_axis(position.y, normal.y),
        offset_axis(position.z, normal.z));
}
