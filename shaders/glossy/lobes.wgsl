// The library of lobes by cos θ: twin of core/src/glossy/lobes.rs.

const ANGLES: u32 = 32u;

struct LobeTables {
    // Twin of `Lobe::parameters`, of each lobe in x and y.
    parameters: array<vec4f, 16>,
    // Albedo, cosine for the coat, cosine for the metal, support.
    entries: array<vec4f, 512>,
    count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}
