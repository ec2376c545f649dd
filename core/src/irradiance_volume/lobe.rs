//! The radial plot as a solid: in every direction, the value as the distance from the middle.
//!
//! The 2-D radial plots (Greger 1996, Fig. 4.5 and 4.8) are its sections. By bin, each bin is a pyramid
//! with its apex in the middle, so that nothing is hidden by what is not there; smooth, one closed skin.

use super::probe::{Probe, Quantity};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Legend, Line},
    math::{colour::luminance, part::Part, sphere_map::DirectionBins, sphere_values::SphereValues},
};
use glam::{Mat3, Vec2, Vec3};

/// Cells along a side of a hemisphere's square in the smooth skin.
const SKIN: u32 = 40;

/// Colours of the axes drawn with a lobe: x, y, z.
pub const AXIS_COLOURS: [Vec3; 3] =
    [Vec3::new(0.81, 0.09, 0.1), Vec3::new(0.18, 0.51, 0.07), Vec3::new(0.07, 0.27, 0.87)];

/// The lobe of values by direction: a point for direction ω lies at ω · `measure`(value), and carries
/// the value itself.
pub fn lobe(sphere: &SphereValues<'_>, smooth: bool, measure: impl Fn(Vec3) -> f32) -> ColouredMesh {
    let reach = |v: Vec3| {
        let r = measure(v);
        if r.is_finite() { r.max(0.0) } else { 0.0 }
    };
    let mut mesh = ColouredMesh::default();
    if smooth {
        let skin = DirectionBins::new(SKIN);
        for lower in [false, true] {
            let first = mesh.positions.len() as u32;
            for row in 0..=SKIN {
                for column in 0..=SKIN {
                    let direction = corner(skin, [column, row], lower);
                    let value = sphere.smooth(direction);
                    mesh.positions.push(direction * reach(value));
                    mesh.values.push(value);
                }
            }
            let side = SKIN + 1;
            for row in 0..SKIN {
                for column in 0..SKIN {
                    let at = first + row * side + column;
                    quad(&mut mesh, [at, at + 1, at + side + 1, at + side], lower);
                }
            }
        }
        return mesh;
    }
    let n = sphere.bins.n();
    for (bin, &value) in sphere.values.iter().enumerate() {
        let (cell, lower) = (bin as u32 % (n * n), bin as u32 >= n * n);
        let (column, row) = (cell % n, cell / n);
        let first = mesh.positions.len() as u32;
        let corners = [[column, row], [column + 1, row], [column + 1, row + 1], [column, row + 1]];
        mesh.positions.push(Vec3::ZERO);
        mesh.positions.extend(corners.map(|c| corner(sphere.bins, c, lower) * reach(value)));
        mesh.values.extend([value; 5]);
        quad(&mut mesh, [1, 2, 3, 4].map(|i| first + i), lower);
        for i in 0..4 {
            let (a, b) = (first + 1 + i, first + 1 + (i + 1) % 4);
            // The sides look away from the pyramid's middle.
            mesh.triangles.push(if lower { [first, a, b] } else { [first, b, a] });
        }
    }
    mesh
}

/// Direction of a corner of a cell; corner (0, 0) is that of bin 0.
fn corner(bins: DirectionBins, [column, row]: [u32; 2], lower: bool) -> Vec3 {
    let n = bins.n();
    // A corner is the far end of the cell before it, or the near end of its own.
    let (x, y) = (column.min(n - 1), row.min(n - 1));
    let inside = Vec2::new((column - x) as f32, (row - y) as f32);
    let side = (n * n) as usize;
    bins.direction((y * n + x) as usize + if lower { side } else { 0 }, inside)
}

/// Two triangles, counter-clockwise from outside.
fn quad(mesh: &mut ColouredMesh, [a, b, c, d]: [u32; 4], lower: bool) {
    // On the upper hemisphere u and v turn clockwise seen from above: x to the right, z towards the viewer.
    let triangles = if lower { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
    mesh.triangles.extend(triangles);
}

/// A probe's lobe standing in the scene, scaled so that its largest value reaches `reach_m`, with the axes.
pub fn lobe_scene(probe: &Probe, quantity: Quantity, part: Part, reach_m: f32) -> InspectionScene {
    let values = probe.values(quantity, part);
    let sphere = SphereValues { bins: probe.bins, values: &values };
    let mut mesh = lobe(&sphere, true, luminance);
    let largest = values.iter().map(|v| luminance(*v)).fold(0.0f32, f32::max);
    let scale = if largest > 0.0 { reach_m / largest } else { 0.0 };
    for p in &mut mesh.positions {
        *p = probe.position + *p * scale;
    }
    let axes = Vec3::AXES.into_iter().zip(AXIS_COLOURS);
    let unit = quantity.unit();
    InspectionScene {
        lines: axes
            .map(|(axis, colour)| Line {
                ends: [probe.position, probe.position + axis * 1.15 * reach_m],
                colour,
            })
            .collect(),
        meshes: vec![mesh],
        legend: Some(Legend {
            quantity: quantity.name().into(),
            unit: unit.into(),
            range: [0.0, largest],
            names: &[],
        }),
        notes: vec![format!(
            "the lobe's farthest point is {largest:.4} {unit}, {reach_m:.2} m from the probe"
        )],
        ..InspectionScene::default()
    }
}

/// The lobe with its axes as it is seen from outside, orthographic, `reach` at the rim; shaded by the
/// tilt of its faces, as a picture without a light source. Columns of `world_from_view`: right, up and
/// towards the viewer. Pixels are sRGB, transparent beside the lobe.
pub fn picture(
    mesh: &ColouredMesh,
    world_from_view: Mat3,
    size: usize,
    reach: f32,
    colour: impl Fn(Vec3) -> [u8; 3],
) -> Vec<[u8; 4]> {
    let mut canvas =
        Canvas { size, depth: vec![f32::NEG_INFINITY; size * size], pixels: vec![[0; 4]; size * size] };
    let view_from_world = world_from_view.transpose();
    let half = 0.5 * size as f32;
    let scale = if reach > 0.0 { half / (1.2 * reach) } else { 0.0 };
    // Pixels, and depth towards the viewer in pixels.
    let place = |p: Vec3| {
        let v = view_from_world * p * scale;
        Vec3::new(half + v.x, half - v.y, v.z)
    };
    for triangle in &mesh.triangles {
        let corners = triangle.map(|i| place(mesh.positions[i as usize]));
        let value = triangle.iter().map(|&i| mesh.values[i as usize]).sum::<Vec3>() / 3.0;
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        // As from a broad light over the viewer's left shoulder; faces seen from behind are as bright.
        let towards = Vec3::new(-0.35, -0.45, 0.82);
        let shade = 0.45 + 0.55 * normal.dot(towards).abs();
        let [r, g, b] = colour(value).map(|c| (f32::from(c) * shade) as u8);
        canvas.triangle(corners, [r, g, b, 255]);
    }
    for (axis, axis_colour) in Vec3::AXES.into_iter().zip(AXIS_COLOURS) {
        let [r, g, b] = crate::math::colour::srgb8(axis_colour);
        canvas.line([Vec3::ZERO, axis * reach * 1.15].map(place), [r, g, b, 255]);
    }
    canvas.pixels
}

struct Canvas {
    size: usize,
    depth: Vec<f32>,
    pixels: Vec<[u8; 4]>,
}

impl Canvas {
    fn put(&mut self, x: usize, y: usize, depth: f32, colour: [u8; 4]) {
        let i = y * self.size + x;
        if depth > self.depth[i] {
            self.depth[i] = depth;
            self.pixels[i] = colour;
        }
    }

    fn triangle(&mut self, [a, b, c]: [Vec3; 3], colour: [u8; 4]) {
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let limit = self.size as f32 - 1.0;
        let low = a.min(b).min(c).truncate().floor().clamp(Vec2::ZERO, Vec2::splat(limit));
        let high = a.max(b).max(c).truncate().ceil().clamp(Vec2::ZERO, Vec2::splat(limit));
        for y in low.y as usize..=high.y as usize {
            for x in low.x as usize..=high.x as usize {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let weight = |from: Vec3, to: Vec3| {
                    (to.truncate() - from.truncate()).perp_dot(p - from.truncate()) / area
                };
                let (wa, wb) = (weight(b, c), weight(c, a));
                let wc = 1.0 - wa - wb;
                if wa.min(wb).min(wc) >= -1e-4 {
                    self.put(x, y, a.z * wa + b.z * wb + c.z * wc, colour);
                }
            }
        }
    }

    fn line(&mut self, [from, to]: [Vec3; 2], colour: [u8; 4]) {
        let steps = (2.0 * (to - from).truncate().length()).ceil().max(1.0) as usize;
        for i in 0..=steps {
            let p = from.lerp(to, i as f32 / steps as f32);
            let inside = |v: f32| v >= 0.0 && v < self.size as f32;
            if inside(p.x) && inside(p.y) {
                self.put(p.x as usize, p.y as usize, p.z + 0.5, colour);
            }
        }
    }
}
