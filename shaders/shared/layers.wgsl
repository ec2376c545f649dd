// What a pass over the picture sees and writes.

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var seen_triangles: texture_2d<u32>;
// Three floats a pixel, layer after layer; then the state of mirrored rays.
@group(1) @binding(2) var<storage, read_write> layers: array<f32>;

fn store(pixel: u32, layer: u32, radiance: vec3f) {
    let first = 3u * (layer * frame.size.x * frame.size.y + pixel);
    for (var i = 0u; i < 3u; i++) {
        var value = radiance[i];
        if frame.accumulated > 0u {
            let mean = layers[first + i];
            value = mean + (value - mean) / f32(frame.accumulated + 1u);
        }
        layers[first + i] = value;
    }
}
