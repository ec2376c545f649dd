//! Flat-faced shapes: quadrilaterals, cuboids, bevelled boxes.

use super::{Shape, v};
use glam::{DVec2, DVec3};

/// A quadrilateral, corners counter-clockwise from the front; texture `repeat` times along each side.
/// The texture stands upright when the first edge runs along the bottom.
pub fn quad(corners: [DVec3; 4], repeat: DVec2) -> Shape {
    let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalize();
    let mut shape = Shape::default();
    for (corner, uv) in corners.into_iter().zip([(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)]) {
        shape.vertex(corner, normal);
        if let Some(last) = shape.uvs.last_mut() {
            *last = DVec2::from(uv) * repeat;
        }
    }
    shape.triangles = vec![[0, 1, 2], [0, 2, 3]];
    shape
}

/// A quadrilateral without texture coordinates.
pub fn plain(corners: [DVec3; 4]) -> Shape {
    quad(corners, DVec2::ZERO)
}

/// Lays shapes made of quadrilaterals out on a lightmap: each face keeps its proportions, all one scale, in rows
/// of `width` metres with `gap` metres between them.
pub fn lay_out(shapes: &mut [&mut Shape], width: f64, gap: f64) {
    let (mut at, mut row) = (DVec2::splat(gap), 0.0f64);
    for shape in shapes.iter_mut() {
        for (corners, uvs) in shape.positions.chunks(4).zip(shape.uvs.chunks_mut(4)) {
            let size = DVec2::new(corners[0].distance(corners[1]), corners[0].distance(corners[3]));
            if at.x + size.x + gap > width {
                (at, row) = (DVec2::new(gap, at.y + row + gap), 0.0);
            }
            for (uv, share) in uvs.iter_mut().zip([DVec2::Y, DVec2::ONE, DVec2::X, DVec2::ZERO]) {
                *uv = at + share * size;
            }
            at.x += size.x + gap;
            row = row.max(size.y);
        }
    }
    let scale = 1.0 / width.max(at.y + row + gap);
    shapes.iter_mut().flat_map(|s| &mut s.uvs).for_each(|uv| *uv *= scale);
}

/// The six faces of a cuboid, flat shaded.
pub fn cuboid(low: DVec3, high: DVec3) -> Shape {
    hexahedron([
        v(low.x, low.y, high.z),
        v(high.x, low.y, high.z),
        v(high.x, low.y, low.z),
        v(low.x, low.y, low.z),
        v(low.x, high.y, high.z),
        v(high.x, high.y, high.z),
        v(high.x, high.y, low.z),
        v(low.x, high.y, low.z),
    ])
}

/// A solid of six quadrilaterals: four corners of the bottom, counter-clockwise from above, then the
/// four of the top above them.
pub fn hexahedron(c: [DVec3; 8]) -> Shape {
    Shape::join(
        [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
            .map(|f| plain(f.map(|i| c[i]))),
    )
}

/// A cuboid with bevelled edges that shade round: 44 triangles on 24 vertices.
///
/// Each corner has three vertices, one a face, with the normals of the faces; the bevels interpolate
/// between them.
pub fn bevelled(low: DVec3, high: DVec3, bevel: f64) -> Shape {
    let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
    let bevel = bevel.min(0.45 * half.min_element());
    let mut shape = Shape::default();
    // Vertex 3c + a: corner c (bits x, y, z), on the face across axis a.
    for corner in 0..8usize {
        let sign = DVec3::from([0, 1, 2].map(|a| if corner >> a & 1 == 1 { 1.0 } else { -1.0 }));
        for axis in 0..3 {
            let mut inset = DVec3::splat(bevel);
            inset[axis] = 0.0;
            let mut normal = DVec3::ZERO;
            normal[axis] = sign[axis];
            shape.vertex(centre + sign * (half - inset), normal);
        }
    }
    let index = |corner: usize, axis: usize| (3 * corner + axis) as u32;
    let mut polygon = |ids: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|k| shape.positions[ids[k] as usize]);
        let outward = ids.iter().map(|&i| shape.positions[i as usize] - centre).sum::<DVec3>();
        let turn = (b - a).cross(c - a).dot(outward) < 0.0;
        for k in 1..ids.len() - 1 {
            let t = [ids[0], ids[k], ids[k + 1]];
            shape.triangles.push(if turn { [t[0], t[2], t[1]] } else { t });
        }
    };
    for axis in 0..3 {
        let (i, j) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        for side in [0, 1 << axis] {
            polygon(&[side, side | i, side | i | j, side | j].map(|c| index(c, axis)));
        }
        // The four edges along this axis lie between the faces across the two others.
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        for corner in [0, i, j, i | j] {
            let other = corner | (1 << axis);
            polygon(&[index(corner, p), index(other, p), index(other, q), index(corner, q)]);
        }
    }
    for corner in 0..8 {
        polygon(&[index(corner, 0), index(corner, 1), index(corner, 2)]);
    }
    shape
}

/// A box from the middle of its bottom face and its size, bevelled unless `bevel` is zero.
pub fn block(bottom: DVec3, size: DVec3, bevel: f64) -> Shape {
    let half = v(0.5 * size.x, 0.0, 0.5 * size.z);
    let (low, high) = (bottom - half, bottom + half + v(0.0, size.y, 0.0));
    if bevel > 0.0 { bevelled(low, high, bevel) } else { cuboid(low, high) }
}
