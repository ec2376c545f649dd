// The GGX lobe: twin of `Lobe` in core/src/scene/brdf.rs.

fn ggx(normal: vec3f, h: vec3f, alpha: f32) -> f32 {
    let c = dot(normal, h);
    if c <= 0.0 {
        return 0.0;
    }
    let a2 = alpha * alpha;
    let s = cross(normal, h);
    let d = c * c * a2 + dot(s, s);
    return a2 / (PI * d * d);
}

fn smith(c: f32, alpha: f32) -> f32 {
    let tan2 = max(1.0 - c * c, 0.0) / (c * c);
    return 0.5 * (sqrt(1.0 + alpha * alpha * tan2) - 1.0);
}

// Twin of `Lobe::value` of GGX.
fn ggx_value(normal: vec3f, wi: vec3f, wo: vec3f, alpha: f32) -> f32 {
    let ci = dot(normal, wi);
    let co = dot(normal, wo);
    if ci <= 0.0 || co <= 0.0 {
        return 0.0;
    }
    let h = normalize(wi + wo);
    return ggx(normal, h, alpha) / ((1.0 + smith(ci, alpha) + smith(co, alpha)) * 4.0 * ci * co);
}

// Twin of `Lobe::density` of GGX.
fn ggx_density(normal: vec3f, wi: vec3f, wo: vec3f, alpha: f32) -> f32 {
    let co = dot(normal, wo);
    if co <= 0.0 || dot(normal, wi) <= 0.0 {
        return 0.0;
    }
    return ggx(normal, normalize(wi + wo), alpha) / ((1.0 + smith(co, alpha)) * 4.0 * co);
}

// Twin of `frame::frame_from_normal`.
fn frame_from_normal(n: vec3f) -> mat3x3f {
    let side = select(1.0, -1.0, (bitcast<u32>(n.z) & 0x80000000u) != 0u);
    let a = -1.0 / (side + n.z);
    let b = n.x * n.y * a;
    return mat3x3f(
        vec3f(1.0 + side * n.x * n.x * a, side * b, -side * n.x),
        vec3f(b, side + n.y * n.y * a, -n.y),
        n);
}

// Twin of `Lobe::sample` of GGX; below the surface where that is `None`.
fn ggx_sample(normal: vec3f, wo: vec3f, alpha: f32, u: vec2f) -> vec3f {
    let axes = frame_from_normal(normal);
    let local = transpose(axes) * wo;
    let stretched = normalize(vec3f(alpha * local.xy, local.z));
    let across = normalize_or(vec3f(-stretched.y, stretched.x, 0.0), frame_from_normal(stretched)[0]);
    let up = cross(stretched, across);
    let r = sqrt(u.x);
    let phi = 2.0 * PI * u.y;
    let s = 0.5 * (1.0 + stretched.z);
    let x = r * cos(phi);
    let y = (1.0 - s) * sqrt(max(1.0 - x * x, 0.0)) + s * r * sin(phi);
    let z = sqrt(max(1.0 - x * x - y * y, 0.0));
    let visible = across * x + up * y + stretched * z;
    let h = axes * normalize(vec3f(alpha * visible.xy, max(visible.z, 1e-6)));
    return 2.0 * dot(wo, h) * h - wo;
}
