//! Dynamic objects: what has moved since the solve is lit from the volume, in levels of detail.
//!
//! Idea (Greger 1996, §5.1): an object in motion asks the volume at its vertices and interpolates between
//! them; while it moves, a coarser set of points will do. Here the points are *nodes*: every vertex once,
//! however many triangles share it, and on a triangle that is large against the volume's cells a lattice
//! of further nodes, for a table top has four vertices and light varies between them. Between two nodes
//! nothing is missed that the volume, itself linear inside a cell, could tell.
//! What an object hides from itself it precomputes: [`self_occlusion`](super::self_occlusion).

pub use super::detail::{Detail, Gloss};

use super::IrradianceVolume;
use crate::{
    math::part::Part,
    scene::{Scene, geometry::Geometry, mesh::Mesh},
};
use glam::{IVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Steps along the edge of a triangle's lattice at most.
const MOST_STEPS: u32 = 24;
/// Nodes of an object's lattices at most: beyond, the lattices are coarser.
const MOST_NODES: usize = 60_000;
/// Clusters of the coarse level along the diagonal of the object.
const CLUSTERS: f32 = 18.0;

/// What an object needs to be lit from the volume, wherever it stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DynamicObject {
    /// Lattice of each triangle: its first entry in `nodes`, and its steps an edge.
    pub lattices: Vec<(u32, u32)>,
    /// Node at each entry of each lattice; entry (i, j) is number j (m + 1) − j (j − 1) / 2 + i.
    pub nodes: Vec<u32>,
    /// Where each node lies: triangle within the object and barycentric weights of corners 1 and 2. The
    /// first [`Self::vertices`] of them are the vertices.
    pub places: Vec<(u32, Vec2)>,
    /// Number of vertices among the nodes.
    pub vertices: usize,
    /// Share of the cosine-weighted hemisphere over each node that the object leaves open, on its front
    /// and on its back: V in [0, 1].
    pub open: Vec<[f32; 2]>,
    /// Vertices that the coarse level asks.
    pub(super) asked: Vec<u32>,
    /// Of each vertex, entries in `asked` and their weights, which sum to 1.
    pub(super) blends: Vec<[(u32, f32); 4]>,
}

/// Entries of a lattice of `steps` steps an edge.
pub fn lattice_len(steps: u32) -> u32 {
    (steps + 1) * (steps + 2) / 2
}

/// Number of lattice entry (i, j), i + j ≤ m.
pub(super) fn entry(steps: u32, i: u32, j: u32) -> u32 {
    j * (steps + 1) - j * j.wrapping_sub(1) / 2 + i
}

/// The three entries around a point of a triangle and their weights, which sum to 1. Has a twin in
/// `shaders/shared/elements.wgsl`.
pub fn lattice_blend(steps: u32, barycentric: Vec2) -> ([u32; 3], [f32; 3]) {
    let p = barycentric.clamp(Vec2::ZERO, Vec2::ONE) * steps as f32;
    let i = (p.x as u32).min(steps - 1);
    let j = (p.y as u32).min(steps - 1 - i);
    let f = p - Vec2::new(i as f32, j as f32);
    let (right, up) = (entry(steps, i + 1, j), entry(steps, i, j + 1));
    if f.x + f.y <= 1.0 || i + j + 2 > steps {
        ([entry(steps, i, j), right, up], [1.0 - f.x - f.y, f.x, f.y])
    } else {
        ([entry(steps, i + 1, j + 1), up, right], [f.x + f.y - 1.0, 1.0 - f.x, 1.0 - f.y])
    }
}

impl DynamicObject {
    /// Nodes of an object, open to everything; lattices have steps of at most `spacing_m`, and one step
    /// where that is `None`.
    pub fn new(scene: &Scene, geometry: &Geometry, object: usize, spacing_m: Option<f32>) -> Self {
        let meshes: Vec<&Mesh> = scene.objects[object].parts.iter().map(|p| &*scene.meshes[p.mesh]).collect();
        Self::of_meshes(&meshes, geometry, object, spacing_m)
    }

    /// As [`Self::new`], of an object that is none of a scene's.
    ///
    /// # Panics
    /// If the object has other triangles than the meshes.
    pub fn of_meshes(meshes: &[&Mesh], geometry: &Geometry, object: usize, spacing_m: Option<f32>) -> Self {
        let mut made = Self::default();
        made.add_vertices(meshes);
        assert_eq!(3 * geometry.object_triangles[object].len(), made.nodes.len(), "other meshes");
        let range = geometry.object_triangles[object].clone();
        let longest = |t: u32| {
            let [a, b, c] = geometry.positions[t as usize];
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        };
        let mut spacing = spacing_m.unwrap_or(f32::INFINITY).max(1e-6);
        let steps = |t: u32, spacing: f32| ((longest(t) / spacing).ceil() as u32).clamp(1, MOST_STEPS);
        let extra =
            |spacing| -> usize { range.clone().map(|t| lattice_len(steps(t, spacing)) as usize - 3).sum() };
        while extra(spacing) > MOST_NODES {
            spacing *= 1.25;
        }
        for (local, triangle) in range.enumerate() {
            made.add_lattice(local, steps(triangle, spacing));
        }
        made.open = vec![[1.0; 2]; made.places.len()];
        made.link(geometry, object);
        made
    }

    /// One node a vertex of the object's meshes, those apart in texture alone counted once; `nodes` holds those
    /// of the corners for now.
    fn add_vertices(&mut self, meshes: &[&Mesh]) {
        const CORNERS: [Vec2; 3] = [Vec2::ZERO, Vec2::X, Vec2::Y];
        for mesh in meshes {
            let mut of_vertex: HashMap<[[u32; 3]; 2], u32> = HashMap::new();
            for corners in &mesh.triangles {
                let triangle = self.nodes.len() as u32 / 3;
                for (corner, vertex) in corners.iter().enumerate() {
                    let (p, n) = (mesh.positions[*vertex as usize], mesh.normals[*vertex as usize]);
                    let node = *of_vertex
                        .entry([p, n].map(|v| (v + Vec3::ZERO).to_array().map(f32::to_bits)))
                        .or_insert_with(|| {
                            self.places.push((triangle, CORNERS[corner]));
                            self.places.len() as u32 - 1
                        });
                    self.nodes.push(node);
                }
            }
        }
        self.vertices = self.places.len();
        self.lattices = Vec::with_capacity(self.nodes.len() / 3);
    }

    /// Appends a triangle's lattice; its corners are vertices, the rest are nodes of its own.
    fn add_lattice(&mut self, triangle: usize, steps: u32) {
        // The corners found first are replaced by whole lattices, behind them in the list.
        let corners: [u32; 3] = std::array::from_fn(|i| self.nodes[3 * triangle + i]);
        if steps == 1 {
            self.lattices.push((3 * triangle as u32, 1));
            return;
        }
        self.lattices.push((self.nodes.len() as u32, steps));
        for j in 0..=steps {
            for i in 0..=steps - j {
                let node = match (i, j) {
                    (0, 0) => corners[0],
                    (i, 0) if i == steps => corners[1],
                    (0, j) if j == steps => corners[2],
                    _ => {
                        let at = Vec2::new(i as f32, j as f32) / steps as f32;
                        self.places.push((triangle as u32, at));
                        self.places.len() as u32 - 1
                    }
                };
                self.nodes.push(node);
            }
        }
    }

    /// Chooses the vertices that the coarse level asks, and how the others blend them: the nearest ones
    /// that face the same way, by 1 / d².
    fn link(&mut self, geometry: &Geometry, object: usize) {
        let first = geometry.object_triangles[object].start;
        let points: Vec<(Vec3, Vec3)> = (0..self.vertices).map(|v| self.place(geometry, first, v)).collect();
        let (low, high) =
            points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), (p, _)| (l.min(*p), h.max(*p)));
        let edge = ((high - low).length() / CLUSTERS).max(1e-9);
        let cell = |p: Vec3| ((p - low) / edge).floor().as_ivec3();
        let mut chosen: BTreeMap<([i32; 3], u8), u32> = BTreeMap::new();
        let mut around: HashMap<IVec3, Vec<u32>> = HashMap::new();
        for (v, (p, n)) in points.iter().enumerate() {
            let facing = (0..3).fold(0, |bits, axis| bits | u8::from(n[axis] > 0.0) << axis);
            chosen.entry((cell(*p).to_array(), facing)).or_insert_with(|| {
                let entry = self.asked.len() as u32;
                self.asked.push(v as u32);
                around.entry(cell(*p)).or_default().push(entry);
                entry
            });
        }
        let asked = &self.asked;
        self.blends = points
            .par_iter()
            .map(|(p, n)| {
                let mut near: Vec<(u32, f32)> = Vec::new();
                for k in 0..27 {
                    let beside = cell(*p) + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
                    for &entry in around.get(&beside).into_iter().flatten() {
                        let (q, m) = points[asked[entry as usize] as usize];
                        let facing = n.dot(m).max(0.0).powi(4);
                        let weight = facing / (p.distance_squared(q) + 1e-4 * edge * edge);
                        near.push((entry, weight.max(f32::MIN_POSITIVE)));
                    }
                }
                near.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
                let total: f32 = near.iter().take(4).map(|n| n.1).sum();
                std::array::from_fn(|i| near.get(i).map_or((0, 0.0), |n| (n.0, n.1 / total)))
            })
            .collect();
    }

    /// Position and unit normal of a node where the object stands now.
    pub(super) fn place(&self, geometry: &Geometry, first: u32, node: usize) -> (Vec3, Vec3) {
        let (triangle, Vec2 { x: u, y: v }) = self.places[node];
        let t = (first + triangle) as usize;
        let mix = |[a, b, c]: [Vec3; 3]| a * (1.0 - u - v) + b * u + c * v;
        (mix(geometry.positions[t]), mix(geometry.normals[t]).normalize_or(Vec3::Y))
    }

    /// Queries that a level asks of the volume, for one side; each finds both parts of the light.
    pub fn queries(&self, detail: Detail) -> usize {
        match detail {
            Detail::Coarse => self.asked.len(),
            Detail::Vertices => self.vertices,
            Detail::Fine | Detail::Pixels => self.places.len(),
        }
    }

    /// The finest level that asks at most `budget` times.
    pub fn within(&self, budget: usize) -> Detail {
        [Detail::Fine, Detail::Vertices]
            .into_iter()
            .find(|d| self.queries(*d) <= budget)
            .unwrap_or(Detail::Coarse)
    }

    /// Direct and indirect irradiance of every node on its front (`side` 1) or back (−1), lx per channel; the
    /// indirect part is weakened by what the object hides from itself. Black the parts that are not `wanted`.
    pub fn irradiance(
        &self,
        volume: &IrradianceVolume,
        geometry: &Geometry,
        object: usize,
        wanted: [bool; 2],
        side: f32,
        detail: Detail,
    ) -> Vec<[Vec3; 2]> {
        let mut light = self.asked(geometry, object, side, detail, |queries| {
            let of = |part| {
                let mut found = vec![Vec3::ZERO; queries.len()];
                volume.irradiance_many(queries, part, &mut found);
                found.into_iter()
            };
            match wanted {
                [true, true] => volume.irradiance_parts_many(queries),
                [true, false] => of(Part::Direct).map(|e| [e, Vec3::ZERO]).collect(),
                [false, true] => of(Part::Indirect).map(|e| [Vec3::ZERO, e]).collect(),
                [false, false] => vec![[Vec3::ZERO; 2]; queries.len()],
            }
        });
        let back = usize::from(side < 0.0);
        light.iter_mut().zip(&self.open).for_each(|(e, open)| e[1] *= open[back]);
        light
    }

    /// Moments of every node towards where it shines, lx per channel, as [`Self::irradiance`]; black where the
    /// volume does not hold the order. What the object hides from itself is not left out.
    #[expect(clippy::too_many_arguments, reason = "as irradiance, and how it shines")]
    pub fn moments(
        &self,
        volume: &IrradianceVolume,
        geometry: &Geometry,
        object: usize,
        wanted: [bool; 2],
        side: f32,
        detail: Detail,
        gloss: &Gloss,
    ) -> Vec<[Vec3; 2]> {
        let answer = |&(position, normal): &(Vec3, Vec3)| {
            let (towards, order) = (gloss.towards(position, normal), gloss.order);
            let of = |part| volume.moment(position, towards, order, part).unwrap_or_default();
            match wanted {
                [true, true] => volume.moment_parts(position, towards, order).unwrap_or_default(),
                [true, false] => [of(Part::Direct), Vec3::ZERO],
                [false, true] => [Vec3::ZERO, of(Part::Indirect)],
                [false, false] => [Vec3::ZERO; 2],
            }
        };
        self.asked(geometry, object, side, detail, |queries| queries.par_iter().map(answer).collect())
    }

    /// What every node is answered by a level of detail; `answer` gets (position, normal) on one side.
    fn asked(
        &self,
        geometry: &Geometry,
        object: usize,
        side: f32,
        detail: Detail,
        answer: impl Fn(&[(Vec3, Vec3)]) -> Vec<[Vec3; 2]>,
    ) -> Vec<[Vec3; 2]> {
        // Of direct and indirect light alike.
        fn mixed<const N: usize>(light: [([Vec3; 2], f32); N]) -> [Vec3; 2] {
            [0, 1].map(|part| light.iter().fold(Vec3::ZERO, |sum, (of, weight)| sum + of[part] * *weight))
        }
        let first = geometry.object_triangles[object].start;
        let query = |node: usize| {
            let (position, normal) = self.place(geometry, first, node);
            (position, normal * side)
        };
        let all = |nodes: usize| answer(&(0..nodes).into_par_iter().map(query).collect::<Vec<_>>());
        let mut light = match detail {
            Detail::Fine | Detail::Pixels => all(self.places.len()),
            Detail::Vertices => all(self.vertices),
            Detail::Coarse => {
                let asked = answer(&self.asked.par_iter().map(|&v| query(v as usize)).collect::<Vec<_>>());
                let blend =
                    |b: &[(u32, f32); 4]| mixed(b.map(|(entry, weight)| (asked[entry as usize], weight)));
                self.blends.par_iter().map(blend).collect()
            }
        };
        for &(triangle, Vec2 { x: u, y: v }) in &self.places[light.len()..] {
            let [a, b, c] = std::array::from_fn(|i| light[self.corner(triangle, i) as usize]);
            light.push(mixed([(a, 1.0 - u - v), (b, u), (c, v)]));
        }
        light
    }

    /// Vertex at a corner of a triangle.
    pub(super) fn corner(&self, triangle: u32, corner: usize) -> u32 {
        self.nodes[3 * triangle as usize + corner]
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.lattices[..])
            + size_of_val(&self.nodes[..])
            + size_of_val(&self.places[..])
            + size_of_val(&self.open[..])
            + size_of_val(&self.asked[..])
            + size_of_val(&self.blends[..])
    }
}
