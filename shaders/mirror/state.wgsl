// Three planes of a pixel's state.

fn state_vector(pixel: u32, plane: u32) -> vec3f {
    let size = frame.size;
    return vec3f(
        layers[state_of(size, pixel, plane)],
        layers[state_of(size, pixel, plane + 1u)],
        layers[state_of(size, pixel, plane + 2u)]);
}

fn set_state_vector(pixel: u32, plane: u32, value: vec3f) {
    for (var i = 0u; i < 3u; i++) {
        layers[state_of(frame.size, pixel, plane + i)] = value[i];
    }
}
