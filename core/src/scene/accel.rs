//! Rays against the scene: one tree for what stands still, one a movable object, and one over those.
//!
//! The tree is obvhs's BVH2. Not its faster CWBVH: that one drops hits nearer than 1e-4 world
//! units. Nodes are padded against the rounding of the slab test, and triangles are tested without
//! gaps between them. A moved object costs a new matrix and the small tree over all movable objects,
//! not a new tree of its own.

mod shaft;

pub use shaft::Shaft;

use super::{
    geometry::Geometry,
    watertight::{Shear, slab_ray},
};
use glam::{Affine3A, Vec2, Vec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{
        Bvh2,
        builder::{build_bvh2, build_bvh2_from_tris},
    },
    ray::RayHit,
    triangle::Triangle,
};

/// A ray from `origin` along `direction`, which need not be of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, m.
    pub origin: Vec3,
    /// Direction; parameters t count in its length.
    pub direction: Vec3,
    /// Smallest parameter that counts.
    pub t_min: f32,
    /// Largest parameter that counts.
    pub t_max: f32,
}

impl Ray {
    /// A ray without end.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
    }

    /// The ray between two points, stopping just short of the second.
    pub fn between(from: Vec3, to: Vec3) -> Self {
        Self { origin: from, direction: to - from, t_min: 0.0, t_max: 1.0 - 1e-4 }
    }

    /// A ray that no arithmetic can trace: a zero or non-finite direction or origin, or NaN limits.
    pub fn is_degenerate(&self) -> bool {
        !self.origin.is_finite()
            || !self.direction.is_finite()
            || self.direction == Vec3::ZERO
            || self.t_min.is_nan()
            || self.t_max.is_nan()
    }
}

/// Nearest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Parameter along the ray.
    pub t: f32,
    /// Triangle number in [`Geometry`].
    pub triangle: u32,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec2,
}

/// Trees over a [`Geometry`].
#[derive(Clone)]
pub struct Accel {
    still: Tree,
    movable: Vec<Movable>,
    /// Over the world bounds of `movable`.
    over: Bvh2,
}

#[derive(Clone)]
struct Movable {
    object: u32,
    tree: Tree,
    built_from_world: Affine3A,
    world_from_object_built: Affine3A,
}

#[derive(Clone)]
struct Tree {
    bvh: Bvh2,
    corners: Vec<Triangle>,
    triangle: Vec<u32>,
}

/// One tree as flat tables, for a kernel that traces the same rays.
#[derive(Clone, Copy)]
pub struct TreeView<'a> {
    /// The movable object it holds; `None` for what stands still.
    pub object: Option<u32>,
    /// From world to the placement the tree was built in.
    pub built_from_world: Affine3A,
    /// Placement of the object when the tree was built.
    pub world_from_object_built: Affine3A,
    tree: &'a Tree,
}

/// A node of a [`TreeView`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeView {
    /// Smallest and largest corner of its box.
    pub bounds: [Vec3; 2],
    /// Triangles of a leaf; 0 for an inner node, whose children are `first` and `first + 1`.
    pub count: u32,
    /// First child, or first triangle of a leaf.
    pub first: u32,
}

impl<'a> TreeView<'a> {
    /// Nodes, the root first.
    pub fn nodes(self) -> impl Iterator<Item = NodeView> + 'a {
        self.tree.bvh.nodes.iter().map(|n| NodeView {
            bounds: [n.aabb().min.into(), n.aabb().max.into()],
            count: n.prim_count,
            first: n.first_index,
        })
    }

    /// Numbers and corners of the triangles in the order that leaves count them.
    pub fn triangles(self) -> impl Iterator<Item = (u32, [Vec3; 3])> + 'a {
        let corners = self.tree.corners.iter().map(|t| [t.v0, t.v1, t.v2].map(Vec3::from));
        self.tree.triangle.iter().copied().zip(corners)
    }
}

impl Accel {
    /// The trees as flat tables: first the one of what stands still, then one a movable object.
    pub fn trees(&self) -> impl Iterator<Item = TreeView<'_>> {
        let still = TreeView {
            object: None,
            built_from_world: Affine3A::IDENTITY,
            world_from_object_built: Affine3A::IDENTITY,
            tree: &self.still,
        };
        std::iter::once(still).chain(self.movable.iter().map(|m| TreeView {
            object: Some(m.object),
            built_from_world: m.built_from_world,
            world_from_object_built: m.world_from_object_built,
            tree: &m.tree,
        }))
    }

    /// Builds the trees.
    pub fn new(geometry: &Geometry) -> Self {
        let still =
            (0..geometry.len() as u32).filter(|&t| !geometry.movable[geometry.object[t as usize] as usize]);
        let still = Tree::new(geometry, still);
        let movable = (0..geometry.object_triangles.len())
            .filter(|&object| geometry.movable[object] && !geometry.object_triangles[object].is_empty())
            .map(|object| Movable::new(geometry, object))
            .collect::<Vec<_>>();
        Self { still, over: over(&movable), movable }
    }

    /// The tree of what stands still alone.
    pub fn standing(&self) -> Self {
        Self { still: self.still.clone(), over: over(&[]), movable: Vec::new() }
    }

    /// Adds a tree of its own for an object that [`Geometry::add_object`] has put in.
    pub fn add_object(&mut self, geometry: &Geometry, object: usize) {
        if !geometry.object_triangles[object].is_empty() {
            self.movable.push(Movable::new(geometry, object));
            self.over = over(&self.movable);
        }
    }

    /// Follows an object that [`Geometry::place`] moved.
    ///
    /// # Panics
    /// If the object is not movable.
    pub fn place(&mut self, object: usize, world_from_object: Affine3A) {
        let found = self.movable.iter_mut().find(|m| m.object == object as u32);
        assert!(found.is_some(), "object {object} is not movable");
        if let Some(m) = found {
            m.built_from_world = m.world_from_object_built * world_from_object.inverse();
            self.over = over(&self.movable);
        }
    }

    /// Nearest hit, both sides of every triangle; `None` for a degenerate ray.
    pub fn trace(&self, ray: &Ray) -> Option<Hit> {
        if ray.is_degenerate() {
            return None;
        }
        let mut best = self.still.trace(ray, None);
        let t_max = best.map_or(ray.t_max, |b| b.t);
        let outer = slab_ray(ray.origin, ray.direction, ray.t_min, t_max);
        self.over.ray_traverse(outer, &mut RayHit::none(), |r, i| {
            let m = &self.movable[self.over.primitive_indices[i] as usize];
            match m.tree.trace(&m.local(ray), best) {
                Some(hit) if hit.t < r.tmax => {
                    best = Some(hit);
                    hit.t
                }
                _ => f32::INFINITY,
            }
        });
        best
    }

    /// Whether anything stands in the way of the ray; `false` for a degenerate ray.
    pub fn occluded(&self, ray: &Ray) -> bool {
        if ray.is_degenerate() {
            return false;
        }
        self.still.occluded(ray) || self.occluded_by_movable(ray)
    }

    fn occluded_by_movable(&self, ray: &Ray) -> bool {
        let outer = slab_ray(ray.origin, ray.direction, ray.t_min, ray.t_max);
        !self.over.ray_traverse_miss(outer, |r, i| {
            let m = &self.movable[self.over.primitive_indices[i] as usize];
            if m.tree.occluded(&m.local(ray)) { r.tmin } else { f32::INFINITY }
        })
    }

    /// As [`Self::occluded`], asking first what stood in the way of earlier rays: the same answer, sooner
    /// for rays that end or begin together.
    pub fn occluded_past(&self, ray: &Ray, blockers: &mut Blockers) -> bool {
        if ray.is_degenerate() {
            return false;
        }
        self.still.occluded_past(ray, blockers) || self.occluded_by_movable(ray)
    }

    /// Whether a movable object alone stands in the way of the ray; `false` for a degenerate ray.
    ///
    /// # Panics
    /// If the object is not movable.
    pub fn occluded_by(&self, object: u32, ray: &Ray) -> bool {
        let found = self.movable.iter().find(|m| m.object == object);
        assert!(found.is_some(), "object {object} is not movable");
        !ray.is_degenerate() && found.is_some_and(|m| m.tree.occluded(&m.local(ray)))
    }

    /// Bytes held by the trees.
    pub fn bytes(&self) -> usize {
        let tree = |t: &Tree| {
            std::mem::size_of_val(&t.bvh.nodes[..])
                + std::mem::size_of_val(&t.corners[..])
                + 4 * t.triangle.len()
        };
        tree(&self.still) + self.movable.iter().map(|m| tree(&m.tree)).sum::<usize>()
    }
}

/// Triangles that stood in the way of the last few rays; of one [`Accel`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Blockers {
    /// Numbers in the tree of what stands still, counted from 1.
    recent: [u32; 4],
    next: usize,
}

/// The tree over movable objects where they are.
fn over(movable: &[Movable]) -> Bvh2 {
    let bounds: Vec<Aabb> = movable.iter().map(Movable::bounds).collect();
    let mut bvh = build_bvh2(&bounds, BvhBuildParams::fastest_build(), &mut Default::default());
    pad(&mut bvh);
    bvh
}

impl Movable {
    fn new(geometry: &Geometry, object: usize) -> Self {
        Self {
            object: object as u32,
            tree: Tree::new(geometry, geometry.object_triangles[object].clone()),
            built_from_world: Affine3A::IDENTITY,
            world_from_object_built: geometry.world_from_object[object],
        }
    }

    /// Box around the object in the world.
    fn bounds(&self) -> Aabb {
        let Some(root) = self.tree.bvh.nodes.first() else { return Aabb::empty() };
        let world_from_built = self.built_from_world.inverse();
        let (low, high) = (root.aabb().min, root.aabb().max);
        let corner = |i: usize| {
            let pick = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
            world_from_built.transform_point3a(Vec3A::new(pick(0), pick(1), pick(2)))
        };
        (0..8).map(corner).fold(Aabb::empty(), |mut all, p| *all.extend(p))
    }

    fn local(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.built_from_world.transform_point3(ray.origin),
            direction: self.built_from_world.transform_vector3(ray.direction),
            ..*ray
        }
    }
}

impl Tree {
    fn new(geometry: &Geometry, triangles: impl Iterator<Item = u32>) -> Self {
        let numbers: Vec<u32> =
            triangles.filter(|&t| geometry.positions[t as usize].iter().all(|p| p.is_finite())).collect();
        let corners: Vec<Triangle> = numbers
            .iter()
            .map(|&t| {
                let [v0, v1, v2] = geometry.positions[t as usize].map(Vec3A::from);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let parameters = if corners.len() > 200_000 {
            BvhBuildParams::medium_build()
        } else {
            BvhBuildParams::slow_build()
        };
        let mut bvh = build_bvh2_from_tris(&corners, parameters, &mut Default::default());
        pad(&mut bvh);
        let order = |i: &u32| *i as usize;
        Self {
            corners: bvh.primitive_indices.iter().map(|i| corners[order(i)]).collect(),
            triangle: bvh.primitive_indices.iter().map(|i| numbers[order(i)]).collect(),
            bvh,
        }
    }

    fn trace(&self, ray: &Ray, best: Option<Hit>) -> Option<Hit> {
        let t_max = best.map_or(ray.t_max, |b| b.t);
        let shear = Shear::new(ray.origin, ray.direction);
        let inner = slab_ray(ray.origin, ray.direction, ray.t_min, t_max);
        let mut hit = RayHit::none();
        self.bvh.ray_traverse(inner, &mut hit, |r, i| shear.intersect(&self.corners[i], r.tmin, r.tmax));
        if hit.primitive_id == obvhs::ray::INVALID_ID {
            return best;
        }
        let i = hit.primitive_id as usize;
        let [a, b, c] = [self.corners[i].v0, self.corners[i].v1, self.corners[i].v2].map(Vec3::from);
        Some(Hit { t: hit.t, triangle: self.triangle[i], barycentric: barycentric(ray, [a, b, c]) })
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let shear = Shear::new(ray.origin, ray.direction);
        let inner = slab_ray(ray.origin, ray.direction, ray.t_min, ray.t_max);
        !self.bvh.ray_traverse_miss(inner, |r, i| shear.intersect(&self.corners[i], r.tmin, r.tmax))
    }

    fn occluded_past(&self, ray: &Ray, blockers: &mut Blockers) -> bool {
        let shear = Shear::new(ray.origin, ray.direction);
        let stops = |i: usize| shear.intersect(&self.corners[i], ray.t_min, ray.t_max) < ray.t_max;
        if blockers.recent.iter().any(|&b| b > 0 && stops(b as usize - 1)) {
            return true;
        }
        let inner = slab_ray(ray.origin, ray.direction, ray.t_min, ray.t_max);
        let mut blocker = 0;
        let missed = self.bvh.ray_traverse_miss(inner, |r, i| {
            let t = shear.intersect(&self.corners[i], r.tmin, r.tmax);
            if t < r.tmax {
                blocker = i as u32 + 1;
            }
            t
        });
        if !missed {
            blockers.recent[blockers.next] = blocker;
            blockers.next = (blockers.next + 1) % blockers.recent.len();
        }
        !missed
    }
}

/// Grows every node by four units of rounding of the largest coordinate. A slab's t is the difference
/// of two coordinates times a reciprocal, three roundings, so a ray that starts within the tree's own
/// size of it never misses the box of a triangle that it hits, flat boxes included.
fn pad(bvh: &mut Bvh2) {
    let Some(root) = bvh.nodes.first() else { return };
    let largest = root.aabb().min.abs().max(root.aabb().max.abs()).max_element();
    let size = largest.max(root.aabb().diagonal().max_element());
    let margin = Vec3A::splat(4.0 * f32::EPSILON * size);
    for node in &mut bvh.nodes {
        let aabb = *node.aabb();
        node.set_aabb(Aabb::new(aabb.min - margin, aabb.max + margin));
    }
}

/// Barycentric weights of corners 1 and 2 where a ray's line meets a triangle's plane, clamped to the triangle.
pub fn barycentric(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Vec2 {
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let s = ray.origin - a;
    let u = s.dot(p) * inverse;
    let v = ray.direction.dot(s.cross(e1)) * inverse;
    if !(u + v).is_finite() {
        return Vec2::splat(1.0 / 3.0);
    }
    let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
    let excess = (u + v).max(1.0);
    Vec2::new(u / excess, v / excess)
}
