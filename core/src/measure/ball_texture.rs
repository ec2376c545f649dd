//! A ball of a scene as one latitude–longitude texture of six patches (Bastos 1999, §5.5.4), stage by stage.
//!
//! The solver keeps the light of what is curved at corners of triangles. Its patches take samples of that, at the
//! vertices of a lattice about as fine as the elements lie; from there on all is [`sphere`]: what is stored is the
//! latitude–longitude texture of those samples, stage 2 the smooth function through the six patches.
//!
//! Limits: what is a ball to within 2 % of its radius, seen from outside, in one object; what another thing hides
//! against the ball is closed from around it. Rows near the poles count in errors as much as the others.

use super::grid_texture::{GridTexture, Smooth};
use crate::{
    math::{image::LinearImage, part::Part},
    radiosity::{
        RadiositySolution,
        texture::{
            Border, Quadtree, RadiosityTexture, Shape,
            convert::Gaps,
            sphere::{SphereSurface, direction, direction_at},
        },
    },
    scene::{accel::Ray, direct::Receiver, geometry::Surface, world::World},
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// How far corners may be from the sphere, as a share of its radius.
const ROUND: f32 = 0.02;
/// Triangles of which something is round and not a block.
const LEAST_TRIANGLES: usize = 64;
/// Cells of a patch along an edge.
const CELLS: [u32; 2] = [4, 32];
/// Points along and across at which a ball is judged.
const POINTS: [u32; 2] = [48, 24];

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
        (is_round && radius.is_finite()).then_some(Self { object, middle, radius })
    }

    /// Its surface in a direction from the middle; `None` where another thing stands against it.
    fn surface(&self, world: &World, towards: Vec3) -> Option<Surface> {
        let from = self.middle + towards * (1.0 + ROUND) * self.radius;
        let hit = world.accel.trace(&Ray::new(from, -towards))?;
        let own = world.geometry.object[hit.triangle as usize] == self.object;
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, -towards);
        // A facet's middle lies deeper than its corners.
        (own && hit.t < 4.0 * ROUND * self.radius && world.geometry.is_lit(&surface)).then_some(surface)
    }
}

impl GridTexture {
    /// The ball that an element belongs to, if it is one.
    pub(super) fn of_ball(solution: &RadiositySolution, world: &World, element: u32) -> Option<Self> {
        let ball = Ball::new(world, solution.elements().get(element as usize)?.object)?;
        let length = TAU * ball.radius;
        // Corners within half a spacing share an element.
        let wanted = 0.25 * length / (0.5 * solution.transport().map.spacing_m);
        let cells = (wanted as u32).next_power_of_two().clamp(CELLS[0], CELLS[1]);
        let light = |towards: Vec3| {
            let s = ball.surface(world, towards)?;
            Some(solution.irradiance(s.triangle, s.barycentric, s.back, Part::All))
        };
        let patches: [(Quadtree, Gaps); 6] = std::array::from_fn(|face| {
            let (tree, side) = (Quadtree::full(Shape::Quadrilateral, cells.ilog2()), cells + 1);
            let place = |i: u32| Vec2::new((i % side) as f32, (i / side) as f32) / cells as f32;
            let texels = (0..side * side).into_par_iter().map(|i| light(direction(face, place(i)))).collect();
            (tree, Gaps { side, texels })
        });
        if patches.iter().all(|(_, gaps)| gaps.texels.iter().all(Option::is_none)) {
            return None;
        }
        let smooth = SphereSurface::new(&patches);
        // Where something stands against the ball, as the smooth function closes it.
        let nodes = [4 * cells, 2 * cells + 1];
        let step = Vec2::new(1.0 / nodes[0] as f32, 1.0 / (nodes[1] - 1) as f32);
        let at = |x: u32, y: u32| direction_at(Vec2::new(x as f32, y as f32) * step);
        let image = LinearImage::from_fn(nodes[0], nodes[1], |x, y| {
            // A pole is one point, whatever its longitude.
            let towards = at(if y == 0 || y + 1 == nodes[1] { 0 } else { x }, y);
            light(towards).unwrap_or_else(|| smooth.at(towards))
        });
        let receiver = |i: u32| {
            let at = Vec2::new((i % POINTS[0]) as f32, (i / POINTS[0]) as f32) + Vec2::splat(0.5);
            let at = at / Vec2::new(POINTS[0] as f32, POINTS[1] as f32);
            Some(Receiver::of(&ball.surface(world, direction_at(at))?))
        };
        Some(Self {
            chart: u32::MAX,
            object: ball.object,
            nodes,
            size_m: Vec2::new(length, 0.5 * length),
            points: POINTS,
            stored: RadiosityTexture { image, first: Vec2::ZERO, step, border: Border::Sphere },
            open: vec![false; (nodes[0] * nodes[1]) as usize],
            smooth: Smooth::Ball(Box::new(smooth)),
            receivers: (0..POINTS[0] * POINTS[1]).map(receiver).collect(),
        })
    }

    /// Whether it is a ball's, by latitude and longitude.
    pub fn is_ball(&self) -> bool {
        matches!(self.smooth, Smooth::Ball(_))
    }
}
