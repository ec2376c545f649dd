// What a ray meets: twins of `Accel::occluded` and `Accel::trace`.

struct Node {
    low: vec3f,
    // Triangles of a leaf; 0 for an inner node.
    count: u32,
    high: vec3f,
    // First child or first triangle, counted over all trees.
    first: u32,
}

struct TreeTriangle {
    a: vec3f,
    // Its number in the scene.
    number: u32,
    b: vec3f,
    padding_0: u32,
    c: vec3f,
    padding_1: u32,
}

struct Tree {
    // Rows of the placement the tree was built in, from world.
    row_x: vec4f,
    row_y: vec4f,
    row_z: vec4f,
    root: u32,
    node_count: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(6) var<storage, read> nodes: array<Node>;
@group(0) @binding(7) var<storage, read> tree_triangles: array<TreeTriangle>;
@group(0) @binding(8) var<storage, read> trees: array<Tree>;

const STACK: u32 = 64u;
const MISSED: f32 = 3.4e38;

// Where a ray meets a triangle, NONE for none.
struct Hit {
    t: f32,
    triangle: u32,
}

// A reciprocal that is finite for any component: twin of `watertight::slab_ray`.
fn slab_reciprocal(d: f32) -> f32 {
    let largest = 1e30;
    if abs(d) * largest < 1.0 {
        return select(largest, -largest, d < 0.0);
    }
    return 1.0 / d;
}

fn meets_box(node: Node, origin: vec3f, inverse: vec3f, t_max: f32) -> bool {
    let t1 = (node.low - origin) * inverse;
    let t2 = (node.high - origin) * inverse;
    let near = min(t1, t2);
    let far = max(t1, t2);
    let enter = max(max(near.x, near.y), near.z);
    let leave = min(min(far.x, far.y), far.z);
    return leave >= enter && leave >= 0.0 && enter < t_max;
}

// What a ray's test against any triangle needs: twin of `watertight::Shear`.
struct Shear {
    // The axis along which the ray is longest.
    z: u32,
    shear: vec3f,
}

// The ray's longest axis last, the others in cyclic order.
fn permute(p: vec3f, z: u32) -> vec3f {
    if z == 0u {
        return p.yzx;
    }
    if z == 1u {
        return p.zxy;
    }
    return p;
}

fn shear_of(direction: vec3f) -> Shear {
    let size = abs(direction);
    var z = 0u;
    if size.y > size.x {
        z = 1u;
    }
    if size.z > max(size.x, size.y) {
        z = 2u;
    }
    let d = permute(direction, z);
    return Shear(z, vec3f(d.x / d.z, d.y / d.z, 1.0 / d.z));
}

// Twin of `Shear::intersect`, without its repeat in f64 on the edges: those rays hit either triangle.
fn distance_to_triangle(i: u32, origin: vec3f, shear: Shear) -> f32 {
    let corner = tree_triangles[i];
    let a = permute(corner.a - origin, shear.z);
    let b = permute(corner.b - origin, shear.z);
    let c = permute(corner.c - origin, shear.z);
    let pa = a.xy - shear.shear.xy * a.z;
    let pb = b.xy - shear.shear.xy * b.z;
    let pc = c.xy - shear.shear.xy * c.z;
    let u = pc.x * pb.y - pc.y * pb.x;
    let v = pa.x * pc.y - pa.y * pc.x;
    let w = pb.x * pa.y - pb.y * pa.x;
    if min(min(u, v), w) < 0.0 && max(max(u, v), w) > 0.0 {
        return MISSED;
    }
    let determinant = u + v + w;
    if determinant == 0.0 {
        return MISSED;
    }
    return (u * a.z + v * b.z + w * c.z) * shear.shear.z / determinant;
}

// The nearest triangle of a tree from `t_min` on and before `best`; any where that is enough.
fn meet_tree(tree: Tree, world_origin: vec3f, world_direction: vec3f, t_min: f32, any: bool, best: Hit) -> Hit {
    let o = vec4f(world_origin, 1.0);
    let origin = vec3f(dot(tree.row_x, o), dot(tree.row_y, o), dot(tree.row_z, o));
    let direction = vec3f(
        dot(tree.row_x.xyz, world_direction),
        dot(tree.row_y.xyz, world_direction),
        dot(tree.row_z.xyz, world_direction));
    let inverse = vec3f(slab_reciprocal(direction.x), slab_reciprocal(direction.y), slab_reciprocal(direction.z));
    let shear = shear_of(direction);
    var found = best;
    var stack: array<u32, STACK>;
    var depth = 0u;
    var current = tree.root;
    loop {
        let node = nodes[current];
        var descend = false;
        if meets_box(node, origin, inverse, found.t) {
            if node.count > 0u {
                for (var i = node.first; i < node.first + node.count; i++) {
                    let t = distance_to_triangle(i, origin, shear);
                    if t >= t_min && t < found.t {
                        found = Hit(t, tree_triangles[i].number);
                        if any {
                            return found;
                        }
                    }
                }
            } else {
                descend = true;
            }
        }
        if descend && depth < STACK {
            stack[depth] = node.first + 1u;
            depth += 1u;
            current = node.first;
        } else {
            if depth == 0u {
                break;
            }
            depth -= 1u;
            current = stack[depth];
        }
    }
    return found;
}

fn occluded(tree_count: u32, origin: vec3f, direction: vec3f, t_max: f32) -> bool {
    for (var i = 0u; i < tree_count; i++) {
        if trees[i].node_count > 0u {
            if meet_tree(trees[i], origin, direction, 0.0, true, Hit(t_max, NONE)).triangle != NONE {
                return true;
            }
        }
    }
    return false;
}

fn nearest(tree_count: u32, origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> Hit {
    var found = Hit(t_max, NONE);
    for (var i = 0u; i < tree_count; i++) {
        if trees[i].node_count > 0u {
            found = meet_tree(trees[i], origin, direction, t_min, false, found);
        }
    }
    return found;
}
