// Random numbers from (seed, item): twins of core/src/math/random.rs.

fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn hash2(a: u32, b: u32) -> u32 {
    return hash(a ^ hash(b));
}

fn unit_f32(word: u32) -> f32 {
    return f32(word >> 8u) * (1.0 / 16777216.0);
}

fn r2_point(index: u32, scramble: u32) -> vec2f {
    let x = hash(scramble) + index * 0xC13FA9A9u;
    let y = hash(scramble ^ 0x9E3779B9u) + index * 0x91E10DA5u;
    return vec2f(unit_f32(x), unit_f32(y));
}
