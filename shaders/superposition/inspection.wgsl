// What a view shows, over the picture: twins of core/src/superposition/overlay.rs.

struct Sphere {
    centre: vec3f,
    radius: f32,
    first_bin: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct LineInfo {
    a: vec3f,
    padding_0: u32,
    b: vec3f,
    padding_1: u32,
    colour: vec3f,
    opacity: f32,
}

struct MeshCorner {
    position: vec3f,
    opacity: f32,
    value: vec3f,
    padding: u32,
}

struct InspectionSettings {
    bins: u32,
    encode: u32,
    natural: u32,
    padding: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> false_colour: FalseColour;
@group(0) @binding(2) var<uniform> settings: InspectionSettings;
@group(0) @binding(3) var<storage, read> spheres: array<Sphere>;
// Colour of each bin, sRGB in bytes.
@group(0) @binding(4) var<storage, read> bin_colours: array<u32>;
@group(0) @binding(5) var<storage, read> lines: array<LineInfo>;
// Three a triangle.
@group(0) @binding(6) var<storage, read> mesh: array<MeshCorner>;

const NEAR: f32 = 1e-3;

fn encoded(linear: vec3f, opacity: f32) -> vec4f {
    if settings.encode != 0u {
        return vec4f(srgb_from_linear(linear), opacity);
    }
    return vec4f(linear, opacity);
}

fn linear_channel(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    return pow((encoded + 0.055) / 1.055, 2.4);
}

// Twin of `FalseColour::colour_of`.
fn coloured(value: vec3f) -> vec3f {
    let range = vec3f(false_colour.low, false_colour.high, f32(false_colour.logarithmic));
    if settings.natural != 0u {
        return vec3f(
            palette_position(range, value.x),
            palette_position(range, value.y),
            palette_position(range, value.z),
        );
    }
    let x = palette_position(range, luminance(value)) * 255.0;
    let i = min(u32(x), 254u);
    return mix(false_colour.palette[i].xyz, false_colour.palette[i + 1u].xyz, x - f32(i));
}

fn square_corner(index: u32) -> vec2f {
    // Two triangles: 0 1 2, 2 1 3.
    var order = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u);
    let c = order[index];
    return vec2f(f32(c & 1u), f32(c >> 1u));
}

struct SphereVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, first) sphere: u32,
}

// A rectangle in the picture around a sphere.
@vertex
fn sphere_rectangle(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> SphereVertex {
    let sphere = spheres[instance];
    let centre = view_position(frame, sphere.centre);
    let low = centre - vec3f(sphere.radius);
    let high = centre + vec3f(sphere.radius);
    let corner = square_corner(index);
    if high.z <= NEAR {
        return SphereVertex(vec4f(2.0, 2.0, 0.5, 1.0), instance);
    }
    var a = vec2f(-1.0);
    var b = vec2f(1.0);
    if low.z > NEAR {
        a = min(low.xy / low.z, low.xy / high.z) / frame.half_size;
        b = max(high.xy / low.z, high.xy / high.z) / frame.half_size;
    }
    return SphereVertex(vec4f(mix(a, b, corner), 0.5, 1.0), instance);
}

struct Fragment {
    @location(0) colour: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn sphere_bins(vertex: SphereVertex) -> Fragment {
    let sphere = spheres[vertex.sphere];
    let direction = pixel_direction(frame, vec2u(vertex.position.xy), vec2f(0.5));
    let to_centre = sphere.centre - frame.eye;
    let along = dot(to_centre, direction);
    let off = to_centre - direction * along;
    let inside = sphere.radius * sphere.radius - dot(off, off);
    let t = along - sqrt(max(inside, 0.0));
    if inside < 0.0 || t <= NEAR {
        discard;
    }
    let normal = normalize((direction * t - to_centre) / sphere.radius);
    let bin = sphere.first_bin + direction_bin(settings.bins, normal);
    var colour = vec4f(0.0, 0.0, 0.0, 1.0);
    if bin < arrayLength(&bin_colours) {
        colour = unpack4x8unorm(bin_colours[bin]);
    }
    if settings.encode == 0u {
        colour = vec4f(linear_channel(colour.x), linear_channel(colour.y), linear_channel(colour.z), 1.0);
    }
    return Fragment(colour, frame.near / (t * dot(direction, frame.forward)));
}

fn biased(clip: vec4f) -> vec4f {
    return vec4f(clip.xy, clip.z / (1.0 - frame.depth_bias), clip.w);
}

struct MeshVertex {
    @builtin(position) position: vec4f,
    @location(0) value: vec3f,
    @location(1) @interpolate(flat, first) opacity: f32,
}

@vertex
fn mesh_vertex(@builtin(vertex_index) index: u32) -> MeshVertex {
    let corner = mesh[index];
    let position = biased(clip_position(frame, view_position(frame, corner.position)));
    return MeshVertex(position, corner.value, corner.opacity);
}

@fragment
fn mesh_colour(vertex: MeshVertex) -> @location(0) vec4f {
    return encoded(coloured(vertex.value), vertex.opacity);
}

struct LineVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, first) colour: vec4f,
}

@vertex
fn line_rectangle(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> LineVertex {
    let line = lines[instance];
    var a = view_position(frame, line.a);
    var b = view_position(frame, line.b);
    if max(a.z, b.z) <= NEAR {
        return LineVertex(vec4f(2.0, 2.0, 0.5, 1.0), vec4f(line.colour, line.opacity));
    }
    if a.z < NEAR {
        a = mix(b, a, (b.z - NEAR) / (b.z - a.z));
    } else if b.z < NEAR {
        b = mix(a, b, (a.z - NEAR) / (a.z - b.z));
    }
    let half_pixels = 0.5 * vec2f(frame.size);
    let pa = a.xy / a.z / frame.half_size * half_pixels;
    let pb = b.xy / b.z / frame.half_size * half_pixels;
    let along = pb - pa;
    let l = length(along);
    var tangent = vec2f(1.0, 0.0);
    if l > 0.0 {
        tangent = along / l;
    }
    let corner = square_corner(index);
    let end = select(a, b, corner.x > 0.5);
    let aside = vec2f(-tangent.y, tangent.x) * ((corner.y - 0.5) * frame.line_width);
    var clip = biased(clip_position(frame, end));
    clip = vec4f(clip.xy + aside / half_pixels * clip.w, clip.zw);
    return LineVertex(clip, vec4f(line.colour, line.opacity));
}

@fragment
fn line_colour(vertex: LineVertex) -> @location(0) vec4f {
    return encoded(vertex.colour.xyz, vertex.colour.w);
}
