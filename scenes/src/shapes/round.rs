//! Round shapes: bodies of revolution, tubes, superellipsoids, icospheres, fans.

use super::{Shape, v};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Cosine of the angle between two segments of a profile above which their joint shades round.
const CREASE: f64 = 0.75;

/// Turns a profile of (radius, height) about the y axis. The solid lies to the left of the profile:
/// going up at constant radius faces outward. A profile that starts and ends on the axis is a closed
/// solid; with `closed` the last point joins the first.
pub fn lathe(profile: &[DVec2], segments: u32, closed: bool) -> Shape {
    let count = profile.len();
    let edges = if closed { count } else { count - 1 };
    let edge_normal = |e: usize| {
        let d = profile[(e + 1) % count] - profile[e % count];
        DVec2::new(d.y, -d.x).normalize_or_zero()
    };
    let joint = |own: DVec2, other: Option<DVec2>, radius: f64| {
        if radius < 1e-9 {
            return DVec2::new(0.0, if own.y.abs() > 0.5 { own.y.signum() } else { own.y }).normalize_or(own);
        }
        match other {
            Some(other) if own.dot(other) > CREASE => (own + other).normalize(),
            _ => own,
        }
    };
    let mut shape = Shape::default();
    for e in 0..edges {
        let (p, q) = (profile[e], profile[(e + 1) % count]);
        let own = edge_normal(e);
        let before = (e > 0 || closed).then(|| edge_normal((e + count - 1) % count));
        let after = (e + 1 < edges || closed).then(|| edge_normal(e + 1));
        let first = shape.positions.len() as u32;
        for (point, normal) in [(p, joint(own, before, p.x)), (q, joint(own, after, q.x))] {
            for s in 0..segments {
                let (sin, cos) = (TAU * f64::from(s) / f64::from(segments)).sin_cos();
                shape.vertex(
                    v(point.x * cos, point.y, point.x * sin),
                    v(normal.x * cos, normal.y, normal.x * sin),
                );
            }
        }
        for s in 0..segments {
            let next = (s + 1) % segments;
            let (a, b) = (first + s, first + next);
            let (c, d) = (a + segments, b + segments);
            if q.x > 1e-9 {
                shape.triangles.push([a, c, d]);
            }
            if p.x > 1e-9 {
                shape.triangles.push([a, d, b]);
            }
        }
    }
    shape
}

/// A profile with its corners rounded off over at most `radius`, `steps` pieces each; ends stay, and so
/// do corners so blunt that [`lathe`] shades them round anyway.
pub fn rounded(points: &[[f64; 2]], radius: f64, steps: u32, closed: bool) -> Vec<DVec2> {
    let points: Vec<DVec2> = points.iter().copied().map(DVec2::from).collect();
    let count = points.len();
    let mut out = Vec::new();
    for i in 0..count {
        let here = points[i];
        if !closed && (i == 0 || i == count - 1) {
            out.push(here);
            continue;
        }
        let (before, after) = (points[(i + count - 1) % count] - here, points[(i + 1) % count] - here);
        if before.normalize().dot(after.normalize()) < -CREASE {
            out.push(here);
            continue;
        }
        let cut = radius.min(0.45 * before.length()).min(0.45 * after.length());
        let (from, to) = (here + before.normalize() * cut, here + after.normalize() * cut);
        for k in 0..=steps {
            let t = f64::from(k) / f64::from(steps);
            out.push(from.lerp(here, t).lerp(here.lerp(to, t), t));
        }
    }
    out
}

/// A vertical cylinder standing at a point.
pub fn cylinder(bottom: DVec3, radius: f64, height: f64, segments: u32) -> Shape {
    let profile = [[0.0, 0.0], [radius, 0.0], [radius, height], [0.0, height]];
    lathe(&rounded(&profile, 0.004, 1, false), segments, false).moved(bottom)
}

/// A tube along a path, with a radius at each point and flat ends.
pub fn tube(path: &[DVec3], radii: &[f64], sides: u32) -> Shape {
    let mut shape = Shape::default();
    let last = path.len() - 1;
    let tangent = |i: usize| (path[(i + 1).min(last)] - path[i.saturating_sub(1)]).normalize();
    let mut normal = tangent(0).any_orthonormal_vector();
    for (i, (&centre, &radius)) in path.iter().zip(radii).enumerate() {
        let along = tangent(i);
        normal = (normal - along * normal.dot(along)).normalize();
        let across = along.cross(normal);
        for s in 0..sides {
            let (sin, cos) = (TAU * f64::from(s) / f64::from(sides)).sin_cos();
            let outward = normal * cos + across * sin;
            shape.vertex(centre + outward * radius, outward);
        }
    }
    let rings = path.len() as u32;
    for ring in 0..rings - 1 {
        for s in 0..sides {
            let (a, b) = (ring * sides + s, ring * sides + (s + 1) % sides);
            shape.triangles.extend([[a, b, a + sides], [b, b + sides, a + sides]]);
        }
    }
    for (ring, facing) in [(0, -tangent(0)), (rings - 1, tangent(last))] {
        let rim: Vec<u32> =
            (0..sides).map(|s| shape.vertex(shape.positions[(ring * sides + s) as usize], facing)).collect();
        for k in 1..rim.len() - 1 {
            let t = [rim[0], rim[k], rim[k + 1]];
            shape.triangles.push(if ring == 0 { [t[0], t[2], t[1]] } else { t });
        }
    }
    shape
}

/// A straight rod.
pub fn rod(from: DVec3, to: DVec3, radius: f64, sides: u32) -> Shape {
    tube(&[from, to], &[radius, radius], sides)
}

/// A path through points with its corners rounded, for [`tube`].
pub fn bent(points: &[DVec3], radius: f64, steps: u32) -> Vec<DVec3> {
    let last = points.len() - 1;
    let mut out = vec![points[0]];
    for i in 1..last {
        let (before, after) = (points[i - 1] - points[i], points[i + 1] - points[i]);
        let cut = radius.min(0.45 * before.length()).min(0.45 * after.length());
        let (from, to) = (points[i] + before.normalize() * cut, points[i] + after.normalize() * cut);
        for k in 0..=steps {
            let t = f64::from(k) / f64::from(steps);
            out.push(from.lerp(points[i], t).lerp(points[i].lerp(to, t), t));
        }
    }
    out.push(points[last]);
    out
}

/// A superellipsoid about the origin: `roundness` (vertical, horizontal) 1 is an ellipsoid, 0 a box.
pub fn superellipsoid(half: DVec3, roundness: DVec2, around: u32, rows: u32) -> Shape {
    let power = |x: f64, e: f64| if x.abs() < 1e-9 { 0.0 } else { x.signum() * x.abs().powf(e) };
    let mut shape = Shape::default();
    shape.vertex(v(0.0, -half.y, 0.0), DVec3::NEG_Y);
    for row in 1..rows {
        let (sin_v, cos_v) = (PI * (f64::from(row) / f64::from(rows) - 0.5)).sin_cos();
        let (y, r) = (power(sin_v, roundness.x), power(cos_v, roundness.x));
        for s in 0..around {
            let (sin, cos) = (TAU * f64::from(s) / f64::from(around)).sin_cos();
            let side = v(r * power(cos, roundness.y), y, r * power(sin, roundness.y));
            shape.vertex(half * side, DVec3::Y);
        }
    }
    let top = shape.vertex(v(0.0, half.y, 0.0), DVec3::Y);
    let at = |row: u32, s: u32| 1 + (row - 1) * around + s % around;
    for s in 0..around {
        shape.triangles.push([0, at(1, s), at(1, s + 1)]);
        for row in 1..rows - 1 {
            let (a, b, c, d) = (at(row, s), at(row, s + 1), at(row + 1, s), at(row + 1, s + 1));
            shape.triangles.extend([[a, c, d], [a, d, b]]);
        }
        shape.triangles.push([at(rows - 1, s), top, at(rows - 1, s + 1)]);
    }
    shape.smooth()
}

/// A regular fan in a plane: `sides` triangles about a centre, facing `normal`.
pub fn fan(centre: DVec3, normal: DVec3, radius: f64, sides: u32) -> Shape {
    let (x, y) = normal.any_orthonormal_pair();
    let mut shape = Shape::default();
    shape.vertex(centre, normal);
    for s in 0..sides {
        let (sin, cos) = (TAU * f64::from(s) / f64::from(sides)).sin_cos();
        shape.vertex(centre + radius * (x * cos + y * sin), normal);
    }
    for s in 0..sides {
        shape.triangles.push([0, 1 + s, 1 + (s + 1) % sides]);
    }
    if x.cross(y).dot(normal) < 0.0 {
        shape.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    shape
}

/// Area of [`fan`], m².
pub fn fan_area(radius: f64, sides: u32) -> f64 {
    0.5 * f64::from(sides) * radius * radius * (TAU / f64::from(sides)).sin()
}

/// An icosahedron whose faces are each cut in four `cuts` times, with vertices on the unit sphere.
pub fn icosphere(cuts: u32) -> Shape {
    let g = 0.5 * (1.0 + 5f64.sqrt());
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        points.push(v(a, b, 0.0));
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        points.push(v(0.0, a, b));
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        points.push(v(b, 0.0, a));
    }
    points.iter_mut().for_each(|p| *p = p.normalize());
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    // Faces are the triples of vertices that are all neighbours.
    let edge = 1.2;
    for i in 0..12usize {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let near = |a: usize, b: usize| points[a].distance(points[b]) < edge;
                if near(i, j) && near(j, k) && near(i, k) {
                    let outward = (points[j] - points[i]).cross(points[k] - points[i]).dot(points[i]) > 0.0;
                    let t = [i as u32, j as u32, k as u32];
                    triangles.push(if outward { t } else { [t[0], t[2], t[1]] });
                }
            }
        }
    }
    for _ in 0..cuts {
        let mut halves = std::collections::BTreeMap::new();
        let mut half = |a: u32, b: u32, points: &mut Vec<DVec3>| {
            *halves.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) =
                    (half(a, b, &mut points), half(b, c, &mut points), half(c, a, &mut points));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    let uvs = vec![DVec2::ZERO; points.len()];
    Shape { normals: points.clone(), positions: points, uvs, triangles }
}
