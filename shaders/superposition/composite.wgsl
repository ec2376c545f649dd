// From layers to display: twin of `composite::display`, with the selection's outline.

struct Composite {
    weights: vec3f,
    // 1 / luminance that becomes display 1.
    exposure: f32,
    // 0 linear, 1 filmic.
    tone: u32,
    false_colour: u32,
    // Whether the shader encodes sRGB; not where the target does.
    encode: u32,
    layer_count: u32,
    specular_weights: vec2f,
    padding_0: u32,
    padding_1: u32,
}

struct ShownTriangle {
    material: u32,
    object: u32,
    reflector: u32,
    environment: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var seen_triangles: texture_2d<u32>;
@group(0) @binding(2) var<storage, read> layers: array<f32>;
@group(0) @binding(3) var<uniform> settings: Composite;
@group(0) @binding(4) var<uniform> false_colour: FalseColour;
@group(0) @binding(5) var<storage, read> shown: array<ShownTriangle>;

const OUTLINE: vec3f = vec3f(1.0, 0.45, 0.05);
const OUTLINE_PIXELS: i32 = 2;

@vertex
fn full_screen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn layer(pixel: u32, index: u32) -> vec3f {
    let first = 3u * (index * frame.size.x * frame.size.y + pixel);
    return vec3f(layers[first], layers[first + 1u], layers[first + 2u]);
}

// By bits: the compiler may assume that floats are finite.
fn is_finite(v: vec3f) -> bool {
    let exponent = bitcast<vec3u>(v) & vec3u(0x7F800000u);
    return all(exponent != vec3u(0x7F800000u));
}

fn tone_curve(exposed: vec3f) -> vec3f {
    if settings.tone == 0u {
        return clamp(exposed, vec3f(0.0), vec3f(1.0));
    }
    let x = min(max(exposed, vec3f(0.0)) * 0.6, vec3f(1e4));
    return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), vec3f(0.0), vec3f(1.0));
}

fn display(radiance: vec3f) -> vec3f {
    if settings.false_colour == 0u {
        return tone_curve(radiance * settings.exposure);
    }
    let range = vec3f(false_colour.low, false_colour.high, f32(false_colour.logarithmic));
    let x = palette_position(range, luminance(radiance)) * 255.0;
    let i = min(u32(x), 254u);
    return mix(false_colour.palette[i].xyz, false_colour.palette[i + 1u].xyz, x - f32(i));
}

fn is_highlighted(p: vec2i) -> bool {
    let seen = textureLoad(seen_triangles, clamp(p, vec2i(0), vec2i(frame.size) - 1), 0).x;
    return seen != 0u && shown[seen - 1u].object == frame.highlighted;
}

fn weighted(pixel: u32) -> vec3f {
    var radiance = layer(pixel, 0u) * settings.weights.x
        + layer(pixel, 1u) * settings.weights.y
        + layer(pixel, 2u) * settings.weights.z;
    if settings.layer_count > 3u {
        radiance += layer(pixel, 3u) * settings.specular_weights.x + layer(pixel, 4u) * settings.specular_weights.y;
    }
    return radiance;
}

fn encoded(colour: vec3f) -> vec4f {
    if settings.encode != 0u {
        return vec4f(srgb_from_linear(colour), 1.0);
    }
    return vec4f(colour, 1.0);
}

const NOT_FINITE: vec3f = vec3f(1.0, 0.0, 1.0);

// Without false colour and without an outline: what most frames are.
@fragment
fn composite_plain(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let p = vec2u(position.xy);
    let radiance = weighted(p.y * frame.size.x + p.x);
    return encoded(select(NOT_FINITE, tone_curve(radiance * settings.exposure), is_finite(radiance)));
}

@fragment
fn composite(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let p = vec2u(position.xy);
    let pixel = p.y * frame.size.x + p.x;
    let radiance = weighted(pixel);
    var colour = NOT_FINITE;
    if is_finite(radiance) {
        colour = display(radiance);
    }
    if frame.highlighted != 0xFFFFFFFFu && !is_highlighted(vec2i(p)) {
        var beside = false;
        for (var y = -OUTLINE_PIXELS; y <= OUTLINE_PIXELS; y++) {
            for (var x = -OUTLINE_PIXELS; x <= OUTLINE_PIXELS; x++) {
                beside = beside || is_highlighted(vec2i(p) + vec2i(x, y));
            }
        }
        if beside {
            colour = OUTLINE;
        }
    }
    return encoded(colour);
}
