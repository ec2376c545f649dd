//! What may stand between a point and a box: found once, then asked by all rays from the one into the other.
//!
//! Shaft culling (Haines and Wallace 1991) with one end a point: the places p + t d with t in [0, 1] and d between
//! p and the box. A node's box meets them where one t suits all three axes, which is exact. Most shafts to a
//! lamp hold nothing or a few triangles, so a ray costs these and no walk through the tree.

use super::{Accel, Blockers, Ray, Shear, Tree};
use glam::{BVec3A, Vec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::Bvh2};

/// Standing triangles listed at most: beyond that rays are asked of the tree.
const MOST: usize = 32;

/// What may stand in the way of rays from a point into a box; of one [`Accel`].
#[derive(Clone, Debug, Default)]
pub struct Shaft {
    /// Numbers in the tree of what stands still, the one that stood in the way last first.
    standing: Vec<u32>,
    /// There are more of them than are listed.
    crowded: bool,
    /// A movable object may stand in the way.
    movable: bool,
    blockers: Blockers,
    stack: Vec<u32>,
}

/// The places between a point and a box.
struct Places {
    apex: Vec3A,
    /// Reciprocals of the smallest and largest differences to the apex.
    inverse: [Vec3A; 2],
    /// Where the smallest is not negative, and the largest positive.
    forward: [BVec3A; 2],
}

impl Places {
    fn new(apex: Vec3, low: Vec3, high: Vec3) -> Self {
        const TINY: f32 = 1e-30;
        // A few units of rounding, as in places that were interpolated.
        let margin = 4.0 * f32::EPSILON * apex.abs().max(low.abs()).max(high.abs());
        let ends = [low - margin - apex, high + margin - apex].map(Vec3A::from);
        let forward = [ends[0].cmpge(Vec3A::ZERO), ends[1].cmpgt(Vec3A::ZERO)];
        let inverse = [0, 1].map(|i| {
            let tiny = Vec3A::select(forward[i], Vec3A::splat(TINY), Vec3A::splat(-TINY));
            Vec3A::select(ends[i].abs().cmpge(Vec3A::splat(TINY)), ends[i], tiny).recip()
        });
        Self { apex: apex.into(), inverse, forward }
    }

    /// Whether they meet a box; true too where it is missed by rounding.
    #[inline(always)]
    fn meet(&self, bounds: &Aabb) -> bool {
        let Self { apex, inverse, forward } = self;
        let below = (bounds.max - *apex) * inverse[0];
        let above = (bounds.min - *apex) * inverse[1];
        let from =
            Vec3A::select(forward[0], Vec3A::ZERO, below).max(Vec3A::select(forward[1], above, Vec3A::ZERO));
        let to =
            Vec3A::select(forward[0], below, Vec3A::ONE).min(Vec3A::select(forward[1], Vec3A::ONE, above));
        from.max_element() <= to.min_element().min(1.0) + 1e-6
    }

    /// Leaves of a tree that they meet, by first triangle and number; `found` says whether to go on.
    fn leaves(&self, bvh: &Bvh2, stack: &mut Vec<u32>, mut found: impl FnMut(u32, u32) -> bool) {
        stack.clear();
        if bvh.nodes.first().is_some_and(|root| self.meet(root.aabb())) {
            stack.push(0);
        }
        while let Some(at) = stack.pop() {
            let node = &bvh.nodes[at as usize];
            if node.prim_count > 0 {
                if !found(node.first_index, node.prim_count) {
                    return;
                }
                continue;
            }
            for child in [node.first_index, node.first_index + 1] {
                if self.meet(bvh.nodes[child as usize].aabb()) {
                    stack.push(child);
                }
            }
        }
    }
}

impl Shaft {
    /// Of which nothing is known: rays are asked of the tree, which is cheaper where there are few.
    pub fn unknown(&mut self) {
        self.crowded = true;
    }
}

impl Accel {
    /// Finds what may stand between a point and any place in a box.
    pub fn look(&self, from: Vec3, [low, high]: [Vec3; 2], shaft: &mut Shaft) {
        let places = Places::new(from, low, high);
        shaft.standing.clear();
        (shaft.crowded, shaft.movable) = (false, false);
        let Shaft { standing, crowded, movable, stack, .. } = shaft;
        places.leaves(&self.still.bvh, stack, |first, count| {
            let meets = |&i: &u32| places.meet(&bounds(&self.still, i));
            standing.extend((first..first + count).filter(meets));
            *crowded = standing.len() > MOST;
            !*crowded
        });
        places.leaves(&self.over, stack, |_, _| {
            *movable = true;
            false
        });
    }

    /// As [`Self::occluded`] for a ray from the point to a place in the box that was looked at.
    pub fn occluded_in(&self, ray: &Ray, shaft: &mut Shaft) -> bool {
        if shaft.crowded {
            return self.occluded_past(ray, &mut shaft.blockers);
        }
        if ray.is_degenerate() {
            return false;
        }
        if !shaft.standing.is_empty() {
            let shear = Shear::new(ray.origin, ray.direction);
            let stops =
                |&i: &u32| shear.intersect(&self.still.corners[i as usize], ray.t_min, ray.t_max) < ray.t_max;
            if let Some(found) = shaft.standing.iter().position(stops) {
                shaft.standing.swap(0, found);
                return true;
            }
        }
        shaft.movable && self.occluded_by_movable(ray)
    }
}

fn bounds(tree: &Tree, triangle: u32) -> Aabb {
    let t = &tree.corners[triangle as usize];
    Aabb::new(t.v0.min(t.v1).min(t.v2), t.v0.max(t.v1).max(t.v2))
}
