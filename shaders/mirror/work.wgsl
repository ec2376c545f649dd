// Lists of pixels that a pass has work for; the Rust side is core/src/mirror/work.rs.
//
// Four lists: pixels that show a reflector with a view, which are followed at depth 1; in turn, those to
// follow at even and at odd depths; and pixels that reflect and have no view. Each has a head of four words:
// workgroups to dispatch (x, 1, 1) and its length. The order in a list is as it happens; every pixel is
// written by itself alone, so that pictures do not depend on it.

@group(1) @binding(4) var<storage, read_write> work: array<atomic<u32>>;

struct Step {
    // The list that is worked off.
    list: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(5) var<uniform> step: Step;

const WORK_GROUP: u32 = 64u;
const HEAD: u32 = 4u;
const LISTS: u32 = 4u;
const WITH_VIEW: u32 = 0u;
const WITHOUT_VIEW: u32 = 3u;
const MOST_GROUPS: u32 = 65535u;
// Pixels of a row that one invocation sorts into lists.
const RUN: u32 = 8u;

fn work_place(size: vec2u, list: u32, index: u32) -> u32 {
    return LISTS * HEAD + list * size.x * size.y + index;
}

// Makes room for some pixels at the end of a list, and gives the first's index.
fn add_work(list: u32, count: u32) -> u32 {
    let index = atomicAdd(&work[list * HEAD + 3u], count);
    let before = min((index + WORK_GROUP - 1u) / WORK_GROUP, MOST_GROUPS);
    let after = min((index + count + WORK_GROUP - 1u) / WORK_GROUP, MOST_GROUPS);
    if after > before {
        atomicAdd(&work[list * HEAD], after - before);
    }
    return index;
}

fn set_work(size: vec2u, list: u32, index: u32, pixel: u32) {
    atomicStore(&work[work_place(size, list, index)], pixel);
}
