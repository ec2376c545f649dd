//! Charts: flat regions of one object and material, each with a rectangular grid of nodes.
//!
//! Coplanar triangles that share an edge are one chart, so that the subdivision of a wall into
//! triangles leaves no trace in its light. The grid spans the chart's smallest bounding rectangle;
//! nodes sit on its border, a little inset so that they are not in the neighbouring wall, and the
//! value between them is bilinear. Not one quadtree a polygon: a grid is a texture, needs no
//! T-vertex repair, and its nodes at the border carry the darkening of corners.

use crate::scene::geometry::Geometry;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Nodes along a side that are not told from more.
const MOST_NODES: f32 = 1e6;

/// A flat region: its triangles and the rectangle around it.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// Triangle numbers, ascending by discovery.
    pub triangles: Vec<u32>,
    /// Front normal.
    pub normal: Vec3,
    /// Corner of the rectangle, m.
    pub origin: Vec3,
    /// Unit axes of the rectangle, u × v = normal.
    pub axes: [Vec3; 2],
    /// Sides of the rectangle, m.
    pub extent: Vec2,
}

/// Splits triangles of one object and material into flat regions and the curved rest.
///
/// `weld` is the distance below which corners are one, m.
pub(super) fn regions(geometry: &Geometry, triangles: &[u32], weld: f32) -> (Vec<Region>, Vec<u32>) {
    let normals: Vec<Vec3> =
        triangles.iter().map(|&t| geometry.area_normal(t).normalize_or(Vec3::ZERO)).collect();
    let flat: Vec<bool> = triangles
        .iter()
        .zip(&normals)
        .map(|(&t, n)| geometry.normals[t as usize].iter().all(|corner| corner.dot(*n) > 0.9999))
        .collect();
    let neighbours = EdgeMap::new(geometry, triangles, weld);
    let mut taken = vec![false; triangles.len()];
    let (mut regions, mut curved) = (Vec::new(), Vec::new());
    for seed in 0..triangles.len() {
        if !flat[seed] {
            curved.push(triangles[seed]);
            continue;
        }
        if taken[seed] {
            continue;
        }
        taken[seed] = true;
        let normal = normals[seed];
        let base = geometry.positions[triangles[seed] as usize][0];
        let mut members = vec![seed];
        let mut next = 0;
        while next < members.len() {
            let current = members[next];
            next += 1;
            for &other in neighbours.of(current) {
                let coplanar = || {
                    normals[other].dot(normal) > 0.9999
                        && geometry.positions[triangles[other] as usize]
                            .iter()
                            .all(|p| (*p - base).dot(normal).abs() < 10.0 * weld)
                };
                if !taken[other] && flat[other] && coplanar() {
                    taken[other] = true;
                    members.push(other);
                }
            }
        }
        let members: Vec<u32> = members.into_iter().map(|i| triangles[i]).collect();
        regions.push(bounding_rectangle(geometry, members, normal));
    }
    (regions, curved)
}

/// One triangle as a region of its own.
pub(super) fn alone(geometry: &Geometry, triangle: u32) -> Region {
    let normal = geometry.area_normal(triangle).normalize_or(Vec3::Y);
    bounding_rectangle(geometry, vec![triangle], normal)
}

/// Triangles that share an edge with each triangle.
struct EdgeMap {
    first: Vec<usize>,
    list: Vec<usize>,
}

impl EdgeMap {
    fn new(geometry: &Geometry, triangles: &[u32], weld: f32) -> Self {
        let key = |p: Vec3| (p / weld).round().to_array().map(|x| x as i64);
        let mut by_edge: HashMap<[[i64; 3]; 2], Vec<usize>> = HashMap::new();
        let edges: Vec<[[[i64; 3]; 2]; 3]> = triangles
            .iter()
            .map(|&t| {
                let k = geometry.positions[t as usize].map(key);
                [[k[0], k[1]], [k[1], k[2]], [k[2], k[0]]].map(|[a, b]| if a < b { [a, b] } else { [b, a] })
            })
            .collect();
        for (i, edges) in edges.iter().enumerate() {
            for edge in edges {
                by_edge.entry(*edge).or_default().push(i);
            }
        }
        let (mut first, mut list) = (vec![0], Vec::new());
        for (i, edges) in edges.iter().enumerate() {
            for edge in edges {
                list.extend(by_edge.get(edge).into_iter().flatten().copied().filter(|&j| j != i));
            }
            first.push(list.len());
        }
        Self { first, list }
    }

    fn of(&self, triangle: usize) -> &[usize] {
        &self.list[self.first[triangle]..self.first[triangle + 1]]
    }
}

/// The smallest rectangle around flat triangles that is parallel to one of their longer edges.
fn bounding_rectangle(geometry: &Geometry, triangles: Vec<u32>, normal: Vec3) -> Region {
    const CANDIDATES: usize = 32;
    let corners = || triangles.iter().flat_map(|&t| geometry.positions[t as usize]);
    let mut edges: Vec<Vec3> = triangles
        .iter()
        .flat_map(|&t| {
            let [a, b, c] = geometry.positions[t as usize];
            [b - a, c - b, a - c]
        })
        .collect();
    edges.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
    edges.truncate(CANDIDATES);
    let mut best: Option<(f32, Region)> = None;
    for edge in edges {
        let u = (edge - normal * normal.dot(edge)).normalize_or(Vec3::ZERO);
        let v = normal.cross(u);
        let base = geometry.positions[triangles[0] as usize][0];
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for p in corners() {
            let q = Vec2::new((p - base).dot(u), (p - base).dot(v));
            (low, high) = (low.min(q), high.max(q));
        }
        let extent = high - low;
        let area = extent.x * extent.y;
        if u != Vec3::ZERO && best.as_ref().is_none_or(|(smallest, _)| area < *smallest * 0.999) {
            let origin = base + u * low.x + v * low.y;
            best = Some((area, Region { triangles: Vec::new(), normal, origin, axes: [u, v], extent }));
        }
    }
    let (u, v) = normal.any_orthonormal_pair();
    let mut region = best.map_or(
        Region { triangles: Vec::new(), normal, origin: Vec3::ZERO, axes: [u, v], extent: Vec2::ZERO },
        |(_, region)| region,
    );
    region.triangles = triangles;
    region
}

impl Region {
    /// Nodes along u and v at a spacing, at most `MOST_NODES` + 1, which no surface may have; 1 where the rectangle is
    /// narrower than half of it.
    pub fn nodes(&self, spacing: f32) -> [u32; 2] {
        self.extent.to_array().map(|side| {
            if side < 0.5 * spacing {
                1
            } else {
                ((side / spacing).round().clamp(1.0, MOST_NODES) as u32) + 1
            }
        })
    }

    /// Coordinates in the rectangle, m.
    pub fn plane_coordinates(&self, p: Vec3) -> Vec2 {
        let d = p - self.origin;
        Vec2::new(d.dot(self.axes[0]), d.dot(self.axes[1]))
    }

    /// Point of the plane.
    pub fn point(&self, q: Vec2) -> Vec3 {
        self.origin + self.axes[0] * q.x + self.axes[1] * q.y
    }

    /// Nearest point of the region to `q`, `inset` inside its triangle where it had to move, and the distance.
    pub fn nearest_inside(&self, corners: &[[Vec2; 3]], q: Vec2, inset: f32) -> (Vec2, f32) {
        let mut best = (q, f32::INFINITY);
        for triangle in corners {
            let (p, distance) = nearest_in_triangle(triangle, q);
            if distance == 0.0 {
                return (q, 0.0);
            }
            if distance < best.1 {
                let centroid = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
                let inwards = centroid - p;
                let step = inset.min(0.5 * inwards.length());
                best = (p + inwards.normalize_or_zero() * step, distance);
            }
        }
        best
    }
}

fn nearest_in_triangle(&[a, b, c]: &[Vec2; 3], q: Vec2) -> (Vec2, f32) {
    let sides = [(a, b), (b, c), (c, a)];
    let orientation = (b - a).perp_dot(c - a).signum();
    if sides.iter().all(|(s, e)| (*e - *s).perp_dot(q - *s) * orientation >= 0.0) {
        return (q, 0.0);
    }
    let mut best = (a, f32::INFINITY);
    for (s, e) in sides {
        let d = e - s;
        let t = ((q - s).dot(d) / d.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        let p = s + d * t;
        let distance = p.distance(q);
        if distance < best.1 {
            best = (p, distance);
        }
    }
    best
}
