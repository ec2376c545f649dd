//! Dynamic objects: what has moved since the solve is lit from the volume, in levels of detail.
//!
//! Idea (Greger 1996, §5.1): an object in motion asks the volume at its vertices and interpolates between
//! them; while it moves, a coarser set of points will do. Here the points are *nodes*: every vertex once,
//! however many triangles share it, and on a triangle that is large against the volume's cells a lattice
//! of further nodes, for a table top has four vertices and light varies between them. Between two nodes
//! nothing is missed that the volume, itself linear inside a cell, could tell.
//!
//! What an object hides from itself it precomputes (§5.1.3, §6.1.3): each node has the share V of its
//! cosine-weighted hemisphere that the object leaves open, and its indirect light is taken as V E_volume.
//! Limits: the hidden part of the hemisphere counts as black, although it sends back some of what falls on
//! it (a lit bowl brightens itself), and as average in what it would have shown.

use super::{IrradianceVolume, moments::Order};
use crate::{
    math::{
        frame::{cosine_direction, frame_from_normal, mirrored},
        part::Part,
        random::{hash2, r2_point},
    },
    scene::{
        Scene,
        accel::Ray,
        geometry::{Geometry, offset_origin},
        mesh::Mesh,
        world::World,
    },
};
use glam::{IVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Steps along the edge of a triangle's lattice at most.
const MOST_STEPS: u32 = 24;
/// Nodes of an object's lattices at most: beyond, the lattices are coarser.
const MOST_NODES: usize = 60_000;
/// Rays an object's self-occlusion takes, about, and the bounds of those of one node.
const OCCLUSION_RAYS: usize = 600_000;
const NODE_RAYS: [u32; 2] = [48, 512];
/// Nodes at most that are asked one by one what they hide.
const MOST_OCCLUDED: usize = 12_000;
/// Clusters of the coarse level along the diagonal of the object.
const CLUSTERS: f32 = 18.0;

/// How finely a dynamic object asks the volume.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum Detail {
    /// At a few of the vertices; the others blend their neighbours. For objects of many vertices in motion.
    Coarse,
    /// At every vertex; triangles blend their corners.
    Vertices,
    /// At every node, so that large triangles show what happens inside them.
    #[default]
    Fine,
}

/// How objects that may be moved shine: by a moment of the volume, seen from somewhere (Greger 1996, §4.4 and
/// Fig. 4.18).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gloss {
    /// Order of the moment; 1 is diffuse.
    pub order: Order,
    /// Where the eye is, m.
    pub eye: Vec3,
}

impl Gloss {
    /// The direction a surface asks the volume about: its normal at order 1, else the view vector mirrored at
    /// it.
    pub fn towards(&self, position: Vec3, normal: Vec3) -> Vec3 {
        if self.order == Order::IRRADIANCE {
            return normal;
        }
        mirrored((self.eye - position).normalize_or(normal), normal)
    }
}

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
    asked: Vec<u32>,
    /// Of each vertex, entries in `asked` and their weights, which sum to 1.
    blends: Vec<[(u32, f32); 4]>,
}

/// Entries of a lattice of `steps` steps an edge.
pub fn lattice_len(steps: u32) -> u32 {
    (steps + 1) * (steps + 2) / 2
}

/// Number of lattice entry (i, j), i + j ≤ m.
fn entry(steps: u32, i: u32, j: u32) -> u32 {
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

    /// One node a vertex of the object's meshes; `nodes` holds those of the corners for now.
    fn add_vertices(&mut self, meshes: &[&Mesh]) {
        const CORNERS: [Vec2; 3] = [Vec2::ZERO, Vec2::X, Vec2::Y];
        for mesh in meshes {
            let mut of_vertex = vec![u32::MAX; mesh.positions.len()];
            for corners in &mesh.triangles {
                let triangle = self.nodes.len() as u32 / 3;
                for (corner, vertex) in corners.iter().enumerate() {
                    let node = &mut of_vertex[*vertex as usize];
                    if *node == u32::MAX {
                        *node = self.places.len() as u32;
                        self.places.push((triangle, CORNERS[corner]));
                    }
                    self.nodes.push(*node);
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

    /// Precomputes what the object hides from itself: V = ∫ visible cos θ dω / π at every node, or, in an
    /// object of very many, at those of the coarse level.
    ///
    /// # Panics
    /// If the object is not movable in `world`.
    pub fn occlude(&mut self, world: &World, object: usize, seed: u64) {
        let geometry = &world.geometry;
        let first = geometry.object_triangles[object].start;
        let [least, most] = NODE_RAYS;
        let each = |node: usize, rays: u32| {
            let (triangle, _) = self.places[node];
            let (position, normal) = self.place(geometry, first, node);
            let front = geometry.area_normal(first + triangle).normalize_or(Vec3::Y);
            let scramble = hash2(node as u32, seed as u32);
            let two_sided = geometry.material_of(first + triangle).double_sided;
            [1.0f32, -1.0].map(|side| {
                if side < 0.0 && !two_sided {
                    return 1.0;
                }
                // Nodes lie on edges and corners: a little inwards, off the triangles that meet there, and
                // up by so little more that it stays on this side of all but the narrowest grooves.
                let inward = 1e-3 * (self.middle(geometry, first, triangle) - position);
                let start = position + inward + front * (side * 0.02 * inward.length());
                let origin = offset_origin(start, front * side);
                let frame = frame_from_normal(normal * side);
                let open = (0..rays).filter(|&ray| {
                    let direction = frame * cosine_direction(r2_point(ray, scramble));
                    // Below the plane of its own triangle, a smooth normal sees no object but the surface.
                    direction.dot(front) * side <= 0.0
                        || !world.accel.occluded_by(object as u32, &Ray::new(origin, direction))
                });
                open.count() as f32 / rays as f32
            })
        };
        let rays = |nodes: usize| ((OCCLUSION_RAYS / nodes.max(1)) as u32).clamp(least, most);
        let count = self.places.len();
        if count <= MOST_OCCLUDED {
            self.open = (0..count).into_par_iter().map(|node| each(node, rays(count))).collect();
            return;
        }
        // Too many to ask each: those of the coarse level, blended as their light is.
        let count = self.asked.len();
        let asked: Vec<[f32; 2]> = self.asked.par_iter().map(|&v| each(v as usize, rays(count))).collect();
        let blend = |b: &[(u32, f32); 4]| -> [f32; 2] {
            std::array::from_fn(|side| b.iter().map(|&(entry, w)| asked[entry as usize][side] * w).sum())
        };
        let mut open: Vec<[f32; 2]> = self.blends.iter().map(blend).collect();
        for &(triangle, Vec2 { x: u, y: v }) in &self.places[self.vertices..] {
            let [a, b, c]: [[f32; 2]; 3] = std::array::from_fn(|i| open[self.corner(triangle, i) as usize]);
            open.push(std::array::from_fn(|s| a[s] * (1.0 - u - v) + b[s] * u + c[s] * v));
        }
        self.open = open;
    }

    fn middle(&self, geometry: &Geometry, first: u32, triangle: u32) -> Vec3 {
        let [a, b, c] = geometry.positions[(first + triangle) as usize];
        (a + b + c) / 3.0
    }

    /// Position and unit normal of a node where the object stands now.
    fn place(&self, geometry: &Geometry, first: u32, node: usize) -> (Vec3, Vec3) {
        let (triangle, Vec2 { x: u, y: v }) = self.places[node];
        let t = (first + triangle) as usize;
        let mix = |[a, b, c]: [Vec3; 3]| a * (1.0 - u - v) + b * u + c * v;
        (mix(geometry.positions[t]), mix(geometry.normals[t]).normalize_or(Vec3::Y))
    }

    /// Queries that a level asks of the volume, for one part and side.
    pub fn queries(&self, detail: Detail) -> usize {
        match detail {
            Detail::Coarse => self.asked.len(),
            Detail::Vertices => self.vertices,
            Detail::Fine => self.places.len(),
        }
    }

    /// The finest level that asks at most `budget` times.
    pub fn within(&self, budget: usize) -> Detail {
        [Detail::Fine, Detail::Vertices]
            .into_iter()
            .find(|d| self.queries(*d) <= budget)
            .unwrap_or(Detail::Coarse)
    }

    /// Irradiance of every node on its front (`side` 1) or back (−1), lx per channel; the indirect part
    /// is weakened by what the object hides from itself.
    pub fn irradiance(
        &self,
        volume: &IrradianceVolume,
        geometry: &Geometry,
        object: usize,
        part: Part,
        side: f32,
        detail: Detail,
    ) -> Vec<Vec3> {
        let ask = |position, normal| volume.irradiance(position, normal, part);
        let mut light = self.asked(geometry, object, side, detail, ask);
        if part == Part::Indirect {
            let back = usize::from(side < 0.0);
            light.iter_mut().zip(&self.open).for_each(|(e, open)| *e *= open[back]);
        }
        light
    }

    /// Moment of every node towards where it shines, lx per channel, as [`Self::irradiance`]; black where the
    /// volume does not hold the order. What the object hides from itself is not left out.
    #[expect(clippy::too_many_arguments, reason = "as irradiance, and how it shines")]
    pub fn moments(
        &self,
        volume: &IrradianceVolume,
        geometry: &Geometry,
        object: usize,
        part: Part,
        side: f32,
        detail: Detail,
        gloss: &Gloss,
    ) -> Vec<Vec3> {
        self.asked(geometry, object, side, detail, |position, normal| {
            let towards = gloss.towards(position, normal);
            volume.moment(position, towards, gloss.order, part).unwrap_or_default()
        })
    }

    /// What every node is answered, (position, normal) on one side, by a level of detail.
    fn asked(
        &self,
        geometry: &Geometry,
        object: usize,
        side: f32,
        detail: Detail,
        query: impl Fn(Vec3, Vec3) -> Vec3 + Sync,
    ) -> Vec<Vec3> {
        let first = geometry.object_triangles[object].start;
        let ask = |node: usize| {
            let (position, normal) = self.place(geometry, first, node);
            query(position, normal * side)
        };
        let all = |nodes: usize| -> Vec<Vec3> { (0..nodes).into_par_iter().map(ask).collect() };
        let mut light = match detail {
            Detail::Fine => all(self.places.len()),
            Detail::Vertices => all(self.vertices),
            Detail::Coarse => {
                let asked: Vec<Vec3> = self.asked.par_iter().map(|&v| ask(v as usize)).collect();
                let blend = |b: &[(u32, f32); 4]| {
                    b.iter().fold(Vec3::ZERO, |sum, &(entry, weight)| sum + asked[entry as usize] * weight)
                };
                self.blends.par_iter().map(blend).collect()
            }
        };
        for &(triangle, Vec2 { x: u, y: v }) in &self.places[light.len()..] {
            let [a, b, c] = std::array::from_fn(|i| light[self.corner(triangle, i) as usize]);
            light.push(a * (1.0 - u - v) + b * u + c * v);
        }
        light
    }

    /// Vertex at a corner of a triangle.
    fn corner(&self, triangle: u32, corner: usize) -> u32 {
        self.nodes[3 * triangle as usize + corner]
    }

    /// Share of the hemisphere over a point of a triangle that the object leaves open.
    pub fn open_at(&self, triangle: u32, barycentric: Vec2, back: bool) -> f32 {
        let (first, steps) = self.lattices[triangle as usize];
        let (entries, weights) = lattice_blend(steps, barycentric);
        let of = |entry: u32| self.open[self.nodes[(first + entry) as usize] as usize][usize::from(back)];
        (0..3).map(|i| of(entries[i]) * weights[i]).sum()
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
