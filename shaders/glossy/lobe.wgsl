// A lobe by itself: twin of `Lobe` in core/src/scene/brdf.rs.

struct Lobe {
    // Width α.
    alpha: f32,
    // Of Phong's lobe, 0 of GGX.
    exponent: f32,
}

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

fn ggx_value(normal: vec3f, wi: vec3f, wo: vec3f, alpha: f32) -> f32 {
    let ci = dot(normal, wi);
    let co = dot(normal, wo);
    if ci <= 0.0 || co <= 0.0 {
        return 0.0;
    }
    let h = normalize(wi + wo);
    return ggx(normal, h, alpha) / ((1.0 + smith(ci, alpha) + smith(co, alpha)) * 4.0 * ci * co);
}

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

// Twin of `cosine_power`: the logarithm of the cosine by its series, ½ ln(1 − s²), where the built-in one is rounding.
fn cosine_power(a: vec3f, b: vec3f, exponent: f32) -> f32 {
    let c = dot(a, b);
    if c <= 0.0 {
        return 0.0;
    }
    let s = cross(a, b);
    let s2 = dot(s, s);
    let series = -s2 * (0.5 + s2 * (0.25 + s2 * (1.0 / 6.0 + s2 * 0.125)));
    return exp(exponent * select(log(c), series, s2 < 0.05));
}

fn phong_value(normal: vec3f, wi: vec3f, wo: vec3f, exponent: f32) -> f32 {
    if dot(normal, wi) <= 0.0 || dot(normal, wo) <= 0.0 {
        return 0.0;
    }
    return (exponent + 2.0) / (2.0 * PI) * cosine_power(reflect(-wo, normal), wi, exponent);
}

fn phong_sample(normal: vec3f, wo: vec3f, exponent: f32, u: vec2f) -> vec3f {
    // ln of the cosine; 1 − cos² of a narrow lobe would be rounding.
    let ln = log(max(u.x, 1.2e-38)) / (exponent + 1.0);
    let c = exp(ln);
    let series = -2.0 * ln * (1.0 + ln * (1.0 + 2.0 / 3.0 * ln));
    let s = sqrt(max(select(1.0 - c * c, series, ln > -0.01), 0.0));
    let phi = 2.0 * PI * u.y;
    return frame_from_normal(reflect(-wo, normal)) * vec3f(s * cos(phi), s * sin(phi), c);
}

// Twin of `Lobe::value`.
fn lobe_value(lobe: Lobe, normal: vec3f, wi: vec3f, wo: vec3f) -> f32 {
    if lobe.exponent > 0.0 {
        return phong_value(normal, wi, wo, lobe.exponent);
    }
    return ggx_value(normal, wi, wo, lobe.alpha);
}

// Twin of `Lobe::density`.
fn lobe_density(lobe: Lobe, normal: vec3f, wi: vec3f, wo: vec3f) -> f32 {
    if lobe.exponent > 0.0 {
        return (lobe.exponent + 1.0) / (lobe.exponent + 2.0) * phong_value(normal, wi, wo, lobe.exponent);
    }
    return ggx_density(normal, wi, wo, lobe.alpha);
}

// Twin of `Lobe::sample`; below the surface where that is `None`.
fn lobe_sample(lobe: Lobe, normal: vec3f, wo: vec3f, u: vec2f) -> vec3f {
    if lobe.exponent > 0.0 {
        return phong_sample(normal, wo, lobe.exponent, u);
    }
    return ggx_sample(normal, wo, lobe.alpha, u);
}
