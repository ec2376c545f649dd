//! The area an element stands for: how large it is, what it reflects, and points spread over it.

use super::{
    lookup::{SideMap, blend},
    rims::Fills,
    surface_map::{Element, FOOTPRINT, SurfaceMap, UNSOLVED},
};
use crate::scene::{direct::Receiver, geometry::Geometry};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// A share of a triangle's area, m², that an element stands for, around a point.
struct Share {
    /// Element, counted from the first of its part.
    element: u32,
    area: f32,
    /// Index into the points of its part.
    point: u32,
}

/// What elements of one grid, or those at vertices, stand for.
#[derive(Default)]
struct Weighed {
    areas: Vec<f32>,
    reflectances: Vec<Vec3>,
    footprints: Vec<[Receiver; FOOTPRINT]>,
}

impl SurfaceMap {
    /// Areas, mean reflectances and footprints, by points spread over every triangle, on quadtrees as densely as
    /// their finest leaves ask. What lies `between` corners of leaves counts to them.
    pub(super) fn weigh(&mut self, geometry: &Geometry, between: &Fills) {
        let lent = between.numbers(self.elements.len());
        let lenders = |element: u32| between.get(lent[element as usize] as usize).map(|(_, corners)| corners);
        // One part a grid and the last for vertices; each has elements and sides of triangles of its own.
        let charts = self.charts.len();
        let mut parts: Vec<Vec<u32>> = vec![Vec::new(); charts + 1];
        for (number, side) in self.sides.iter().enumerate().filter(|(_, side)| **side != SideMap::NONE) {
            let chart =
                if side.size == 0 { charts } else { self.elements[side.first as usize].chart as usize };
            parts[chart].push(number as u32);
        }
        let first = |part: usize| match self.charts.get(part) {
            Some(chart) => chart.first_element as usize,
            None => self.elements.len() - self.vertices(),
        };
        let weighed: Vec<Weighed> = (0..parts.len())
            .into_par_iter()
            .map(|part| {
                let end = if part < charts { first(part + 1) } else { self.elements.len() };
                self.weigh_part(geometry, first(part)..end, &parts[part], lenders)
            })
            .collect();
        let mut solved = 0..;
        self.footprint_of.clear();
        self.footprint_of.extend(self.elements.iter().map(|e| match e.flags & UNSOLVED {
            0 => solved.next().unwrap_or(u32::MAX),
            _ => u32::MAX,
        }));
        self.footprints.clear();
        let mut element = 0;
        for part in weighed {
            for (area, reflectance) in part.areas.into_iter().zip(part.reflectances) {
                (self.elements[element].area, self.elements[element].reflectance) = (area, reflectance);
                element += 1;
            }
            self.footprints.extend(part.footprints);
        }
    }

    /// Elements at vertices, which come last.
    fn vertices(&self) -> usize {
        let grids = self.charts.last().map_or(0, |c| (c.first_element + c.nx * c.ny) as usize);
        self.elements.len() - grids
    }

    fn weigh_part<'a>(
        &self,
        geometry: &Geometry,
        elements: Range<usize>,
        sides: &[u32],
        lenders: impl Fn(u32) -> Option<&'a [(u32, f32)]>,
    ) -> Weighed {
        let mut points: Vec<(u32, Vec2)> = Vec::new();
        let mut shares: Vec<Share> = Vec::new();
        let mut given: Vec<(u32, f32)> = Vec::new();
        let mut weighted = vec![Vec3::ZERO; elements.len()];
        let mut counts = vec![0u32; elements.len() + 1];
        let leaf = self.finest_leaf(elements.start);
        for &number in sides {
            let (t, side) = (number / 2, &self.sides[number as usize]);
            let material = geometry.material_of(t);
            let textured = material.reflectance_texture.is_some();
            let taps = if textured { 4.0 } else { 3.0 };
            let barycentric = triangle_points(edges_in_leaves(side, leaf), taps);
            let area = 0.5 * geometry.area_normal(t).length() / barycentric.len() as f32;
            for barycentric in barycentric {
                let uv = if textured { geometry.surface(t, barycentric, Vec3::ZERO).uv } else { Vec2::ZERO };
                let reflectance = material.diffuse_at(uv, &geometry.textures);
                let blend = blend(side, barycentric);
                let mut give = |element: u32, weight: f32| match given.iter_mut().find(|g| g.0 == element) {
                    Some(known) => known.1 += weight,
                    None => given.push((element, weight)),
                };
                for (&element, &weight) in
                    blend.elements.iter().zip(&blend.weights).filter(|(_, w)| **w > 0.0)
                {
                    match lenders(element) {
                        None => give(element, weight),
                        Some(corners) => corners.iter().for_each(|(c, w)| give(*c, weight * w)),
                    }
                }
                for (element, weight) in given.drain(..) {
                    let element = element - elements.start as u32;
                    weighted[element as usize] += reflectance * (area * weight);
                    counts[element as usize + 1] += 1;
                    shares.push(Share { element, area: area * weight, point: points.len() as u32 });
                }
                points.push((number, barycentric));
            }
        }
        // A counting sort by element; points keep the order of their triangles.
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let mut places = counts.clone();
        let mut sorted = vec![(0.0f32, 0u32); shares.len()];
        for Share { element, area, point } in shares {
            let place = &mut places[element as usize];
            sorted[*place as usize] = (area, point);
            *place += 1;
        }
        let mut found = Weighed::default();
        for ((range, weighted), element) in counts.windows(2).zip(weighted).zip(&self.elements[elements]) {
            let of_one = &sorted[range[0] as usize..range[1] as usize];
            let area: f32 = of_one.iter().map(|(area, _)| area).sum();
            found.areas.push(area);
            found.reflectances.push(match area > 0.0 {
                true => weighted / area,
                // Between the points of a very long triangle.
                false if element.flags & UNSOLVED == 0 => reflectance_at(geometry, sides, element.position),
                false => Vec3::ZERO,
            });
            if element.flags & UNSOLVED == 0 {
                found.footprints.push(footprint(element, of_one, |point| {
                    let (side, barycentric) = points[point as usize];
                    let towards = geometry.area_normal(side / 2) * if side % 2 == 1 { 1.0 } else { -1.0 };
                    Receiver::of(&geometry.surface(side / 2, barycentric, towards))
                }));
            }
        }
        found
    }

    /// Grid steps along u and v of the finest leaf on the grid of an element.
    fn finest_leaf(&self, element: usize) -> Vec2 {
        let chart = self.elements.get(element).map_or(u32::MAX, |e| e.chart);
        let Some(Some(tree)) = self.trees.get(chart as usize) else { return Vec2::ONE };
        let level = tree.leaves.iter().map(|leaf| leaf.level).max().unwrap_or(0);
        Vec2::from(tree.span(level).map(|steps| steps as f32))
    }

    /// The points that stand for an element's area; none where it is not solved.
    pub fn footprint(&self, element: usize) -> &[Receiver] {
        self.footprints.get(self.footprint_of[element] as usize).map_or(&[], |points| &points[..])
    }
}

/// Diffuse reflectance at a place on one of some triangles in a plane.
fn reflectance_at(geometry: &Geometry, sides: &[u32], place: Vec3) -> Vec3 {
    let inside = |side: &u32| {
        let [a, b, c] = geometry.positions[*side as usize / 2];
        let normal = geometry.area_normal(side / 2);
        let weight = |p: Vec3, q: Vec3| (p - place).cross(q - place).dot(normal) / normal.length_squared();
        let weights = Vec3::new(weight(b, c), weight(c, a), weight(a, b));
        (weights.min_element(), side / 2, Vec2::new(weights.y, weights.z))
    };
    let nearest = sides.iter().map(inside).max_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map_or(Vec3::ZERO, |(_, t, barycentric)| {
        let uv = geometry.surface(t, barycentric, Vec3::ZERO).uv;
        geometry.material_of(t).diffuse_at(uv, &geometry.textures)
    })
}

/// Points of equal shares of an element's area, drawn from those it has shares of; its own place where it has none.
fn footprint(
    element: &Element,
    shares: &[(f32, u32)],
    receiver: impl Fn(u32) -> Receiver,
) -> [Receiver; FOOTPRINT] {
    let mut found = [element.receiver(); FOOTPRINT];
    let step = shares.iter().map(|(share, _)| share).sum::<f32>() / FOOTPRINT as f32;
    let (mut passed, mut k) = (0.0, 0);
    for &(share, point) in shares {
        passed += share;
        while k < FOOTPRINT && passed >= (k as f32 + 0.5) * step {
            found[k] = receiver(point);
            k += 1;
        }
    }
    found
}

/// Points that stand for equal shares of a triangle's area, `taps` along an edge a step of its grid.
pub(super) fn points_of(side: &SideMap, taps: f32) -> Vec<Vec2> {
    triangle_points(edges_in_leaves(side, Vec2::ONE), taps)
}

/// Edges of a triangle opposite to corners 0, 1 and 2, in sides of leaves, which are given in grid steps; 1 for
/// vertex elements.
fn edges_in_leaves(side: &SideMap, leaf: Vec2) -> [f32; 3] {
    if side.size == 0 {
        return [1.0; 3];
    }
    let corner =
        |i: usize| Vec2::new(f32::from_bits(side.corners[2 * i]), f32::from_bits(side.corners[2 * i + 1]));
    [(1, 2), (2, 0), (0, 1)].map(|(i, k)| ((corner(i) - corner(k)) / leaf).abs().max_element())
}

/// Points that stand for equal shares of a triangle's area, as barycentric weights of corners 1 and 2;
/// `taps` wanted a step along the edges opposite to corners 0, 1 and 2, so many steps long; on triangles of hundreds
/// of steps half as many.
///
/// The centroids of the n² equal triangles it splits into; for a sliver, the middles of cells of a square
/// mapped onto it with equal areas, many along it and few across.
fn triangle_points(edges: [f32; 3], taps: f32) -> Vec<Vec2> {
    const SLIVER: f32 = 4.0;
    /// Taps an edge from which on fewer a step will do, and how many.
    const MANY: f32 = 512.0;
    const LEAST: f32 = 1.5;
    let count = |edge: f32| (taps * edge).min(MANY.max(LEAST * edge)).ceil().max(2.0) as u32;
    let [a, b, c] = edges;
    let (shortest, longest) = (a.min(b).min(c), a.max(b).max(c));
    let n = count(longest);
    if longest > SLIVER * shortest && n > 2 {
        let across = count(shortest);
        let apex = [a, b, c].iter().position(|e| *e == shortest).unwrap_or(0);
        let point = |x: u32, y: u32| {
            let root = ((x as f32 + 0.5) / n as f32).sqrt();
            let next = root * (y as f32 + 0.5) / across as f32;
            let mut weights = [0.0; 3];
            weights[apex] = 1.0 - root;
            weights[(apex + 1) % 3] = root - next;
            weights[(apex + 2) % 3] = next;
            Vec2::new(weights[1], weights[2])
        };
        return (0..n).flat_map(|x| (0..across).map(move |y| point(x, y))).collect();
    }
    let step = 1.0 / n as f32;
    (0..n)
        .flat_map(|y| {
            (0..n - y).flat_map(move |x| {
                let corner = Vec2::new(x as f32, y as f32) * step;
                let upright = Some(corner + Vec2::splat(step / 3.0));
                let inverted = (x + y + 1 < n).then(|| corner + Vec2::splat(step * 2.0 / 3.0));
                upright.into_iter().chain(inverted)
            })
        })
        .collect()
}
