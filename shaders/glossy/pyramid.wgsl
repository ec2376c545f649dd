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
    padding: u32,
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

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var seen_triangles: texture_2d<u32>;
@group(1) @binding(2) var<storage, read_write> layers: array<f32>;
@group(1) @binding(3) var<uniform> lobes: LobeTables;
@group(1) @binding(4) var<storage, read_write> pyramid: array<Texel>;
@group(1) @binding(5) var<uniform> info: PyramidInfo;
@group(1) @binding(6) var<uniform> step: Step;

fn no_texel() -> Texel {
    return Texel(vec3f(0.0), 0.0, 0.0, NONE, 0u, 0u);
}

fn texel_at(level: u32, x: i32, y: i32) -> Texel {
    let here = info.levels[level];
    if x < 0 || y < 0 || x >= i32(here.width) || y >= i32(here.height) {
        return no_texel();
    }
    return pyramid[here.first + u32(y) * here.width + u32(x)];
}

// What each pixel mirrors, unfolded.
@compute @workgroup_size(8, 8)
fn unfold(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= frame.size) {
        return;
    }
    let pixel = id.y * frame.size.x + id.x;
    let seen = textureLoad(seen_triangles, id.xy, 0).x;
    let state = state_of(frame.size, pixel);
    var texel = no_texel();
    if seen != 0u && layers[state + 6u] != NOT_MIRRORED {
        let surface = surface_seen(seen - 1u, frame.eye, pixel_direction(frame, id.xy, frame.subpixel));
        let distance = layers[state + 6u];
        texel.radiance = vec3f(layers[state], layers[state + 1u], layers[state + 2u]);
        if distance < 1e30 {
            texel.nearness = 1.0 / (length(surface.position - frame.eye) + distance);
        }
        texel.coverage = 1.0;
        texel.reflector = triangles[surface.triangle].reflector;
    }
    pyramid[pixel] = texel;
}

// Twin of `Texel::merged`, for one texel of a level.
@compute @workgroup_size(8, 8)
fn halve(@builtin(global_invocation_id) id: vec3u) {
    let here = info.levels[step.level];
    if id.x >= here.width || id.y >= here.height {
        return;
    }
    let x = 2 * i32(id.x);
    let y = 2 * i32(id.y);
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
    pyramid[here.first + id.y * here.width + id.x] = merged;
}
