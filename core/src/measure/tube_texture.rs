//! The side of a cylinder in a scene as one texture with parameters u, around, and v, along (Bastos 1999, §5.5.4).
//!
//! As a ball's patches (`ball_texture`), its one patch takes samples of the light that the solver keeps at corners of
//! triangles, by a quadtree that grows a posteriori; the texture goes round
//! ([`tube`](crate::radiosity::texture::tube)). A tube open at its ends has one outside and one inside.
//!
//! Limits: what is round to within 2 % of its radius all the way, with smooth normals, in one object; caps are other
//! surfaces. v runs against the axis that points most upwards.

use super::{
    ball_texture::{ROUND, own_surface},
    grid_texture::{GridTexture, Smooth},
};
use crate::{
    math::{colour::luminance, part::Part},
    radiosity::{
        RadiositySolution, reconstruct,
        texture::{
            Quadtree, Shape,
            adapt::{Subdivision, sample_adaptively},
            convert::Gaps,
            tube::{TubeSurface, first_order_texture},
        },
    },
    scene::{accel::Ray, direct::Receiver, geometry::Surface, world::World},
};
use glam::{DMat3, DVec3, Vec2, Vec3};
use std::f32::consts::TAU;

/// Triangles of which something is round and not a prism.
const LEAST_TRIANGLES: usize = 32;
/// Level that every leaf has at least, and that none goes beyond.
const LEVELS: [u32; 2] = [2, 6];
/// Points around and along at which a tube is judged.
const POINTS: [u32; 2] = [48, 24];
/// How far a normal may be from square to the axis: its cosine.
const SQUARE: f32 = 0.05;
/// Share of the points around and along that must be of it.
const WHOLE: f32 = 0.75;
/// Share of the length that samples at an end lie inside it.
const INSET: f32 = 1e-3;

/// The smooth function of a tube, and the tree and samples that it goes through.
#[derive(Clone, Debug)]
pub(super) struct TubePatch {
    pub smooth: TubeSurface,
    pub tree: Quadtree,
    pub samples: Gaps,
}

/// The side of a cylinder, seen from outside or from inside.
struct Tube {
    object: u32,
    /// On the axis, at the end where v = 1.
    foot: Vec3,
    /// Unit axis, and two directions square to it: u = 0, and u = 1/4 as seen from outside.
    axes: [Vec3; 3],
    length: f32,
    radius: f32,
    inside: bool,
}

impl Tube {
    fn new(solution: &RadiositySolution, world: &World, element: u32) -> Option<Self> {
        let geometry = &world.geometry;
        let own = solution.elements().get(element as usize)?;
        let is_curved = |t: &u32| {
            let normal = geometry.area_normal(*t).normalize_or_zero();
            let lit = solution.sides().get(2 * *t as usize).is_some_and(|side| side.size == 0);
            lit && geometry.normals[*t as usize].iter().any(|n| n.dot(normal) < 0.9999)
        };
        let triangles: Vec<u32> =
            geometry.object_triangles.get(own.object as usize)?.clone().filter(is_curved).collect();
        if triangles.len() < LEAST_TRIANGLES {
            return None;
        }
        let normals = || triangles.iter().map(|&t| geometry.area_normal(t).normalize_or_zero());
        let first = normals().next()?;
        let across = normals().map(|n| first.cross(n)).max_by(|a, b| a.length().total_cmp(&b.length()))?;
        let axis = across.try_normalize()?;
        let axis = if axis.dot(Vec3::new(1e-3, 1.0, 1e-2)) < 0.0 { -axis } else { axis };
        if normals().any(|n| n.dot(axis).abs() > SQUARE) {
            return None;
        }
        let start = axis.any_orthonormal_vector();
        let axes = [axis, start, axis.cross(start)];
        let corners = || triangles.iter().flat_map(|&t| geometry.positions[t as usize]);
        let base = corners().next()?;
        let flat = |p: Vec3| axes.map(|a| (p - base).dot(a));
        let (centre, radius) = circle(corners().map(|p| {
            let [_, x, y] = flat(p);
            [x, y]
        }))?;
        let away = |p: Vec3| {
            let [_, x, y] = flat(p);
            Vec2::new(x, y).distance(centre)
        };
        let off = |p: Vec3| (away(p) - radius).abs() > ROUND * radius;
        // Small caps keep their light at corners too, and are another surface.
        if corners().any(off) || off(own.position) || own.normal.dot(axis).abs() > SQUARE {
            return None;
        }
        let (low, high) = corners().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), p| {
            let along = flat(p)[0];
            (low.min(along), high.max(along))
        });
        let foot = base + axis * low + axes[1] * centre.x + axes[2] * centre.y;
        let outwards = (own.position - foot).reject_from(axis);
        let tube = Self {
            object: own.object,
            foot,
            axes,
            length: high - low,
            radius,
            inside: own.normal.dot(outwards) < 0.0,
        };
        (tube.length > 0.0 && tube.length.is_finite()).then_some(tube)
    }

    /// Its surface at a point of the texture, also where another thing stands against it, and whether none does.
    fn surface(&self, world: &World, uv: Vec2) -> Option<(Surface, bool)> {
        let around = TAU * uv.x.rem_euclid(1.0) * if self.inside { -1.0 } else { 1.0 };
        let out = self.axes[1] * around.cos() + self.axes[2] * around.sin();
        let along = self.foot + self.axes[0] * self.length * (1.0 - uv.y).clamp(INSET, 1.0 - INSET);
        // Facets' middles lie nearer to the axis than their corners.
        let (height, towards) = if self.inside { (1.0 - 3.0 * ROUND, out) } else { (1.0 + ROUND, -out) };
        let ray = Ray::new(along + out * height * self.radius, towards);
        own_surface(world, self.object, &ray, 4.0 * ROUND * self.radius)
    }
}

/// The circle through points of a plane: the least squares of x² + y² + Dx + Ey + F.
fn circle(points: impl Iterator<Item = [f32; 2]>) -> Option<(Vec2, f32)> {
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for [x, y] in points {
        let row = DVec3::new(x.into(), y.into(), 1.0);
        matrix += DMat3::from_cols(row * row.x, row * row.y, row);
        right -= row * (row.x * row.x + row.y * row.y);
    }
    let found = matrix.inverse() * right;
    let centre = -0.5 * found.truncate();
    let radius = (centre.length_squared() - found.z).sqrt();
    (radius.is_finite() && radius > 0.0 && matrix.determinant() != 0.0)
        .then(|| (centre.as_vec2(), radius as f32))
}

/// A point at which a tube is judged, on its texture.
fn point(i: u32) -> Vec2 {
    let at = Vec2::new((i % POINTS[0]) as f32, (i / POINTS[0]) as f32) + Vec2::splat(0.5);
    at / Vec2::new(POINTS[0] as f32, POINTS[1] as f32)
}

impl GridTexture {
    /// The side of a cylinder that an element belongs to, if it is one.
    pub(super) fn of_tube(solution: &RadiositySolution, world: &World, element: u32) -> Option<Self> {
        let tube = Tube::new(solution, world, element)?;
        let around = TAU * tube.radius;
        let known_at = |uv: Vec2| {
            let (s, _) = tube.surface(world, uv)?;
            Some(solution.irradiance(s.triangle, s.barycentric, s.back, Part::All))
        };
        let count = POINTS[0] * POINTS[1];
        let known: Vec<(Vec2, Vec3)> =
            (0..count).map(point).filter_map(|at| Some((at, known_at(at)?))).collect();
        if (known.len() as f32) < WHOLE * count as f32 {
            return None;
        }
        let mean = known.iter().map(|k| luminance(k.1)).sum::<f32>() / known.len() as f32;
        let light = |uv: Vec2| {
            let away = |at: Vec2| {
                let u = (at.x - uv.x).abs();
                Vec2::new(u.min(1.0 - u) * around, (at.y - uv.y) * tube.length).length()
            };
            let nearest = || known.iter().min_by(|a, b| away(a.0).total_cmp(&away(b.0)));
            known_at(uv).unwrap_or_else(|| nearest().map_or(Vec3::ZERO, |k| k.1))
        };
        // Corners within half a spacing share an element.
        let wanted = around.max(tube.length) / (0.5 * solution.transport().map.spacing_m);
        let most_level = wanted.clamp(1.0, 1024.0).ceil() as u32;
        let tolerance = solution.settings().subdivision.map_or(reconstruct::TOLERANCE, |s| s.tolerance);
        let subdivision = Subdivision {
            least_level: LEVELS[0],
            most_level: most_level.next_power_of_two().ilog2().clamp(LEVELS[0], LEVELS[1]),
            tolerance: tolerance * mean,
            restricted: false,
        };
        let (tree, samples) = sample_adaptively(Shape::Quadrilateral, &subdivision, light);
        let stored = first_order_texture(&tree, &samples);
        let receiver = |i: u32| {
            let (surface, open) = tube.surface(world, point(i))?;
            open.then(|| Receiver::of(&surface))
        };
        let receivers = (0..count).map(receiver).collect();
        Some(Self {
            chart: u32::MAX,
            object: tube.object,
            nodes: [stored.image.width, stored.image.height],
            size_m: Vec2::new(around, tube.length),
            points: POINTS,
            stored,
            open: Vec::new(),
            smooth: Smooth::Tube(Box::new(TubePatch {
                smooth: TubeSurface::new(&tree, &samples),
                tree,
                samples,
            })),
            receivers,
        })
    }
}
