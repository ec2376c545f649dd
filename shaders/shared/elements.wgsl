// Irradiance stored on surfaces: twins of core/src/radiosity/lookup.rs and superposition/moved.rs.

// Whether grids are looked up by Mitchell and Netravali's filter.
override mitchell: bool = false;

struct SideMap {
    first: u32,
    size: u32,
    corners: array<u32, 6>,
}

struct ElementLight {
    direct: vec3f,
    buried: u32,
    indirect: vec3f,
    padding: u32,
}

struct StoredLight {
    direct: vec3f,
    indirect: vec3f,
}

@group(0) @binding(11) var<storage, read> sides: array<SideMap>;
@group(0) @binding(12) var<storage, read> element_light: array<ElementLight>;
// A record a triangle (first entry, steps), then four an entry: front direct, indirect, back direct, indirect.
@group(0) @binding(13) var<storage, read> moved_light: array<vec4f>;

fn add_element(sum: ptr<function, StoredLight>, element: u32, weight: f32) {
    if weight != 0.0 {
        (*sum).direct += element_light[element].direct * weight;
        (*sum).indirect += element_light[element].indirect * weight;
    }
}

fn mitchell_kernel(x: f32) -> f32 {
    if x < 1.0 {
        return ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0;
    }
    return select(0.0, (((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0) / 6.0, x < 2.0);
}

fn mitchell_weights(at: f32) -> vec4f {
    return vec4f(
        mitchell_kernel(1.0 + at), mitchell_kernel(at), mitchell_kernel(1.0 - at), mitchell_kernel(2.0 - at));
}

// Twin of `lookup::mitchell`.
fn mitchell_sum(first: u32, size: vec2u, low: vec2u, high: vec2u, at: vec2f) -> StoredLight {
    let columns = vec4u(max(low.x, 1u) - 1u, low.x, high.x, min(high.x + 1u, size.x - 1u));
    let rows = vec4u(max(low.y, 1u) - 1u, low.y, high.y, min(high.y + 1u, size.y - 1u));
    let across = mitchell_weights(at.x);
    let down = mitchell_weights(at.y);
    var sum = StoredLight(vec3f(0.0), vec3f(0.0));
    for (var j = 0u; j < 4u; j++) {
        for (var i = 0u; i < 4u; i++) {
            var node = first + rows[j] * size.x + columns[i];
            if element_light[node].buried != 0u {
                node = first + rows[clamp(j, 1u, 2u)] * size.x + columns[clamp(i, 1u, 2u)];
            }
            add_element(&sum, node, across[i] * down[j]);
        }
    }
    return StoredLight(max(sum.direct, vec3f(0.0)), max(sum.indirect, vec3f(0.0)));
}

// Twin of `lookup::blend` and `ElementBlend::sum`: four elements and their weights for a grid's cell, three
// for a triangle's corners. One sum serves both, since processors that stand in for a graphics card take
// every branch.
fn stored_on_elements(surface: Surface) -> StoredLight {
    var sum = StoredLight(vec3f(0.0), vec3f(0.0));
    let index = 2u * surface.triangle + select(0u, 1u, surface.back);
    if index >= arrayLength(&sides) {
        return sum;
    }
    let side = sides[index];
    if side.first == NONE {
        return sum;
    }
    let u = surface.barycentric.x;
    let v = surface.barycentric.y;
    let w = 1.0 - u - v;
    let nx = side.size & 0xFFFFu;
    let ny = side.size >> 16u;
    let a = vec2f(bitcast<f32>(side.corners[0]), bitcast<f32>(side.corners[1]));
    let b = vec2f(bitcast<f32>(side.corners[2]), bitcast<f32>(side.corners[3]));
    let c = vec2f(bitcast<f32>(side.corners[4]), bitcast<f32>(side.corners[5]));
    let p = clamp(a * w + b * u + c * v, vec2f(0.0), vec2f(f32(max(nx, 1u) - 1u), f32(max(ny, 1u) - 1u)));
    let x0 = min(u32(p.x), max(nx, 2u) - 2u);
    let y0 = min(u32(p.y), max(ny, 2u) - 2u);
    let x1 = min(x0 + 1u, max(nx, 1u) - 1u);
    let y1 = min(y0 + 1u, max(ny, 1u) - 1u);
    let f = p - vec2f(f32(x0), f32(y0));
    if mitchell && side.size != 0u {
        return mitchell_sum(side.first, vec2u(nx, ny), vec2u(x0, y0), vec2u(x1, y1), f);
    }
    let row0 = side.first + y0 * nx;
    let row1 = side.first + y1 * nx;
    var elements = vec4u(row0 + x0, row0 + x1, row1 + x0, row1 + x1);
    var weights = vec4f((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    if side.size == 0u {
        elements = vec4u(side.corners[0], side.corners[1], side.corners[2], side.corners[2]);
        weights = vec4f(w, u, v, 0.0);
    }
    for (var i = 0u; i < 4u; i++) {
        add_element(&sum, elements[i], weights[i]);
    }
    return sum;
}

fn lattice_entry(steps: u32, i: u32, j: u32) -> u32 {
    return j * (steps + 1u) - (j * j - j) / 2u + i;
}

fn add_entry(sum: ptr<function, StoredLight>, first: u32, entry: u32, weight: f32) {
    (*sum).direct += moved_light[first + 4u * entry].xyz * weight;
    (*sum).indirect += moved_light[first + 4u * entry + 1u].xyz * weight;
}

// Twin of `dynamic_object::lattice_blend` and `MovedLight::irradiance`.
fn stored_on_moved(record: vec4f, surface: Surface) -> StoredLight {
    let first = u32(record.x) + select(0u, 2u, surface.back);
    let steps = u32(record.y);
    let p = clamp(surface.barycentric, vec2f(0.0), vec2f(1.0)) * f32(steps);
    let i = min(u32(p.x), steps - 1u);
    let j = min(u32(p.y), steps - 1u - i);
    let f = p - vec2f(f32(i), f32(j));
    let right = lattice_entry(steps, i + 1u, j);
    let up = lattice_entry(steps, i, j + 1u);
    var sum = StoredLight(vec3f(0.0), vec3f(0.0));
    if f.x + f.y <= 1.0 || i + j + 2u > steps {
        add_entry(&sum, first, lattice_entry(steps, i, j), 1.0 - f.x - f.y);
        add_entry(&sum, first, right, f.x);
        add_entry(&sum, first, up, f.y);
    } else {
        add_entry(&sum, first, lattice_entry(steps, i + 1u, j + 1u), f.x + f.y - 1.0);
        add_entry(&sum, first, up, 1.0 - f.x);
        add_entry(&sum, first, right, 1.0 - f.y);
    }
    return sum;
}

// Irradiance from the elements, or from the volume's values at the nodes of a moved object.
fn stored_light(surface: Surface) -> StoredLight {
    let object = objects[triangles[surface.triangle].object];
    if !general || object.moved_first == NONE {
        return stored_on_elements(surface);
    }
    return stored_on_moved(moved_light[object.moved_first + surface.triangle - object.first_triangle], surface);
}
