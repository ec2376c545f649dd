// False colour and the display's encoding: twins of core/src/math/false_colour.rs and colour.rs.

struct FalseColour {
    low: f32,
    high: f32,
    logarithmic: u32,
    padding: u32,
    // 256 linear RGB entries.
    palette: array<vec4f, 256>,
}

fn luminance(rgb: vec3f) -> f32 {
    return dot(rgb, vec3f(0.2126, 0.7152, 0.0722));
}

fn srgb_channel(linear: f32) -> f32 {
    let v = clamp(linear, 0.0, 1.0);
    if v <= 0.0031308 {
        return 12.92 * v;
    }
    return 1.055 * pow(v, 1.0 / 2.4) - 0.055;
}

fn srgb_from_linear(rgb: vec3f) -> vec3f {
    return vec3f(srgb_channel(rgb.x), srgb_channel(rgb.y), srgb_channel(rgb.z));
}

// Twin of `FalseColour::position`.
fn palette_position(range: vec3f, value: f32) -> f32 {
    var t = (value - range.x) / max(range.y - range.x, 1.1754944e-38);
    if range.z != 0.0 {
        let low = max(max(range.x, range.y * 1e-6), 1.1754944e-38);
        t = log(max(value, low) / low) / max(log(range.y / low), 1e-6);
    }
    return clamp(t, 0.0, 1.0);
}
