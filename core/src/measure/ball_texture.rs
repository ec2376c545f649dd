//! A ball of a scene as one latitude–longitude texture of six patches (Bastos 1999, §5.5.4), stage by stage.
//!
//! The solver keeps the light of what is curved at corners of triangles. Each of the six patches has a quadtree that
//! grows a posteriori where that light bends ([`adapt`](crate::radiosity::texture::adapt)), down to about the spacing
//! of the elements. What is stored is the latitude–longitude texture of the patches by the conversion of first order
//! ([`sphere_orders`](crate::radiosity::texture::sphere_orders)), stage 2 the smooth function through them.
//!
//! Limits: what is a ball to within 2 % of its radius, seen from outside, in one object; points where another thing
//! stands against it are not judged, and where it has a hole the nearest sample stands. Rows near the poles count in
//! errors as much as the others.

use super::grid_texture::{GridTexture, Smooth};
use crate::{
    math::{colour::luminance, part::Part},
    radiosity::{
        RadiositySolution, reconstruct,
        texture::{
            Quadtree, Shape,
            adapt::{Subdivision, sample_adaptively},
            convert::Gaps,
            sphere::{SphereSurface, direction, direction_at},
            sphere_orders::FirstOrder,
        },
    },
    scene::{accel::Ray, direct::Receiver, geometry::Surface, world::World},
};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// How far corners may be from what is round, as a share of its radius; facets three times as far.
pub(super) const ROUND: f32 = 0.02;
/// Triangles of which something is round and not a block.
const LEAST_TRIANGLES: usize = 64;
/// Level that every leaf of a patch has at least, and that none goes beyond.
const LEVELS: [u32; 2] = [2, 5];
/// Things that may stand between a surface and what looks at it from close by.
const MOST_BETWEEN: u32 = 8;
/// Points along and across at which a ball is judged.
const POINTS: [u32; 2] = [48, 24];

/// The smooth function of a ball and the patches that it goes through.
#[derive(Clone, Debug)]
pub(super) struct BallPatches {
    pub smooth: SphereSurface,
    pub patches: [(Quadtree, Gaps); 6],
}

/// A round object.
struct Ball {
    object: u32,
    middle: Vec3,
    radius: f32,
}

impl Ball {
    fn new(world: &World, object: u32) -> Option<Self> {
        let geometry = &world.geometry;
        let triangles: Vec<u32> = geometry.object_triangles.get(object as usize)?.clone().collect();
        if triangles.len() < LEAST_TRIANGLES {
            return None;
        }
        let (middle, radius) = geometry.sphere_around(&triangles);
        let round = |p: &Vec3| p.distance(middle) > (1.0 - ROUND) * radius;
        let is_round = triangles.iter().flat_map(|&t| &geometry.positions[t as usize]).all(round);
        let facet = |t: &u32| {
            let away = geometry.positions[*t as usize][0] - middle;
            let normal = geometry.area_normal(*t);
            normal.dot(away).abs() >= (1.0 - 3.0 * ROUND) * radius * normal.length()
        };
        (is_round && triangles.iter().all(facet) && radius.is_finite()).then_some(Self {
            object,
            middle,
            radius,
        })
    }

    /// Its surface in a direction from the middle, also where another thing stands against it, and whether none does.
    fn surface(&self, world: &World, towards: Vec3) -> Option<(Surface, bool)> {
        // A facet's middle lies deeper than its corners.
        let ray = Ray::new(self.middle + towards * (1.0 + ROUND) * self.radius, -towards);
        own_surface(world, self.object, &ray, 4.0 * ROUND * self.radius)
    }
}

/// The first lit surface of an object along a ray of unit direction, no farther than `reach`, and whether nothing
/// stands before it.
pub(super) fn own_surface(world: &World, object: u32, ray: &Ray, reach: f32) -> Option<(Surface, bool)> {
    let mut at = 0.0;
    for between in 0..MOST_BETWEEN {
        let hit = world.accel.trace(&Ray::new(ray.origin + ray.direction * at, ray.direction))?;
        at += hit.t;
        if at > reach {
            return None;
        }
        if world.geometry.object[hit.triangle as usize] == object {
            let surface = world.geometry.surface(hit.triangle, hit.barycentric, ray.direction);
            return world.geometry.is_lit(&surface).then_some((surface, between == 0));
        }
        at += 1e-3 * reach;
    }
    None
}

/// A point at which a ball is judged, on its texture.
fn point(i: u32) -> Vec2 {
    let at = Vec2::new((i % POINTS[0]) as f32, (i / POINTS[0]) as f32) + Vec2::splat(0.5);
    at / Vec2::new(POINTS[0] as f32, POINTS[1] as f32)
}

impl GridTexture {
    /// The ball that an element belongs to, if it is one.
    pub(super) fn of_ball(solution: &RadiositySolution, world: &World, element: u32) -> Option<Self> {
        let ball = Ball::new(world, solution.elements().get(element as usize)?.object)?;
        let length = TAU * ball.radius;
        // Corners within half a spacing share an element.
        let wanted = 0.25 * length / (0.5 * solution.transport().map.spacing_m);
        let most_level = (wanted as u32).max(1).next_power_of_two().ilog2().clamp(LEVELS[0], LEVELS[1]);
        let known_at = |towards: Vec3| {
            let (s, _) = ball.surface(world, towards)?;
            Some(solution.irradiance(s.triangle, s.barycentric, s.back, Part::All))
        };
        let around = (0..POINTS[0] * POINTS[1]).map(|i| direction_at(point(i)));
        let known: Vec<(Vec3, Vec3)> = around.filter_map(|d| Some((d, known_at(d)?))).collect();
        let mean = known.iter().map(|k| luminance(k.1)).sum::<f32>() / known.len().max(1) as f32;
        let nearest = known.first()?.1;
        let light = |towards: Vec3| {
            let near = || known.iter().max_by(|a, b| a.0.dot(towards).total_cmp(&b.0.dot(towards)));
            known_at(towards).unwrap_or_else(|| near().map_or(nearest, |k| k.1))
        };
        let tolerance = solution.settings().subdivision.map_or(reconstruct::TOLERANCE, |s| s.tolerance);
        let subdivision = Subdivision {
            least_level: LEVELS[0],
            most_level,
            tolerance: tolerance * mean,
            restricted: false,
        };
        let patches: [(Quadtree, Gaps); 6] = std::array::from_fn(|face| {
            sample_adaptively(Shape::Quadrilateral, &subdivision, |uv| light(direction(face, uv)))
        });
        let stored = FirstOrder::new(&patches).texture();
        let nodes = [stored.image.width, stored.image.height];
        let receiver = |i: u32| {
            let (surface, open) = ball.surface(world, direction_at(point(i)))?;
            open.then(|| Receiver::of(&surface))
        };
        Some(Self {
            chart: u32::MAX,
            object: ball.object,
            nodes,
            size_m: Vec2::new(length, 0.5 * length),
            points: POINTS,
            stored,
            open: Vec::new(),
            smooth: Smooth::Ball(Box::new(BallPatches { smooth: SphereSurface::new(&patches), patches })),
            receivers: (0..POINTS[0] * POINTS[1]).map(receiver).collect(),
        })
    }
}
