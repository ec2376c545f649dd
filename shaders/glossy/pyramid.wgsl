// The mirror image at halves of its resolution: twin of core/src/glossy/pyramid.rs.

struct Texel {
    radiance: vec3f,
    // 1 over the distance from the eye along the unfolded ray, 1/m.
    nearness: f32,
    coverage: f32,
    reflector: u32,
    padding_0: u32,
    padding_1: u32,
}

// A level's place among the texels; the Rust side is `LevelInfo` in core/src/glossy/gpu.rs.
struct LevelInfo {
    first: u32,
    width: u32,
    height: u32,
    // Its first column and row in the level of the whole picture.
    column: u32,
    row: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct PyramidInfo {
    levels: array<LevelInfo, 12>,
}

// The level that `halve` writes.
struct Step {
    level: u32,
    level_count: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(3) var<uniform> lobes: LobeTables;
@group(1) @binding(4) var<storage, read_write> pyramid: array<Texel>;
@group(1) @binding(5) var<uniform> info: PyramidInfo;
@group(1) @binding(6) var<uniform> step: Step;

fn no_texel() -> Texel {
    return Texel(vec3f(0.0), 0.0, 0.0, NONE, 0u, 0u);
}

// Whether a level holds a texel of the whole picture's.
fn level_holds(here: LevelInfo, x: i32, y: i32) -> bool {
    let column = x - i32(here.column);
    let row = y - i32(here.row);
    return column >= 0 && row >= 0 && column < i32(here.width) && row < i32(here.height);
}

fn texel_place(here: LevelInfo, x: u32, y: u32) -> u32 {
    return here.first + (y - here.row) * here.width + x - here.column;
}

fn texel_at(level: u32, x: i32, y: i32) -> Texel {
    let here = info.levels[level];
    if !level_holds(here, x, y) {
        return no_texel();
    }
    return pyramid[texel_place(here, u32(x), u32(y))];
}

// Texel of the whole picture that an invocation is for; the rest of its block lies beyond the rectangle.
fn texel_of(here: LevelInfo, id: vec2u) -> vec2u {
    return id + vec2u(here.column, here.row);
}

fn is_beyond(here: LevelInfo, id: vec2u) -> bool {
    return id.x >= here.width || id.y >= here.height;
}

// What each pixel mirrors, unfolded.
@compute @workgroup_size(8, 8)
fn unfold(@builtin(global_invocation_id) id: vec3u) {
    let here = info.levels[0];
    if is_beyond(here, id.xy) {
        return;
    }
    let at = texel_of(here, id.xy);
    let seen = textureLoad(seen_triangles, at, 0).x;
    let pixel = at.y * frame.size.x + at.x;
    let nearness = layers[state_of(frame.size, pixel, NEARNESS)];
    var texel = no_texel();
    if seen != 0u && nearness != NOT_MIRRORED {
        let info = triangles[seen - 1u];
        let material = materials[info.material];
        if lobe_number(Lobe(material.alpha, material.exponent)) != NONE {
            texel = Texel(state_vector(pixel, RADIANCE), nearness, 1.0, info.reflector, 0u, 0u);
        }
    }
    pyramid[texel_place(here, at.x, at.y)] = texel;
}

// Twin of `Texel::merged`, for one texel of a level.
@compute @workgroup_size(8, 8)
fn halve(@builtin(global_invocation_id) id: vec3u) {
    let here = info.levels[step.level];
    if is_beyond(here, id.xy) {
        return;
    }
    let at = texel_of(here, id.xy);
    let x = 2 * i32(at.x);
    let y = 2 * i32(at.y);
    let fine = step.level - 1u;
    var four = array<Texel, 4>(
        texel_at(fine, x, y),
        texel_at(fine, x + 1, y),
        texel_at(fine, x, y + 1),
        texel_at(fine, x + 1, y + 1));
    var sum = 0.0;
    var reflector = NONE;
    for (var i = 0u; i < 4u; i++) {
        var covered = 0.0;
        for (var k = 0u; k < 4u; k++) {
            covered += select(0.0, four[k].coverage, four[k].reflector == four[i].reflector);
        }
        if four[i].reflector != NONE && covered > sum {
            sum = covered;
            reflector = four[i].reflector;
        }
    }
    var merged = no_texel();
    if sum > 0.0 {
        for (var i = 0u; i < 4u; i++) {
            if four[i].reflector == reflector {
                merged.radiance += four[i].radiance * (four[i].coverage / sum);
                merged.nearness += four[i].nearness * (four[i].coverage / sum);
            }
        }
        merged.coverage = 0.25 * sum;
        merged.reflector = reflector;
    }
    pyramid[texel_place(here, at.x, at.y)] = merged;
}
