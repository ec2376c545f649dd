//! A flat region that is a triangle as one texture, stage by stage (Bastos §5.5: "quadrilaterals and triangles").
//!
//! Its grid spans the rectangle around it; here the triangle itself is the half u + v ≤ 1 of a square, with a quadtree of
//! triangles that grows a posteriori over what the grid holds, down to the spacing of its nodes. What is stored is the
//! texture of first order of its samples; stage 2 is the smooth function through them.
//!
//! The corner across the longest edge is u = v = 0; the texture is seen from before the surface.

use super::grid_texture::{GridTexture, POINTS, Smooth};
use crate::{
    math::{colour::luminance, part::Part},
    radiosity::{
        RadiositySolution,
        lookup::SideMap,
        reconstruct,
        surface_map::Chart,
        texture::{
            Quadtree, Shape,
            adapt::{Subdivision, sample_adaptively},
            convert::{Gaps, fill_first_order},
            hermite::HermiteSurface,
        },
    },
    scene::{direct::Receiver, world::World},
};
use glam::{Vec2, Vec3};

/// Triangles of a region above which it is not asked whether they make one.
const MOST_TRIANGLES: usize = 256;
/// How far areas may be apart, as a share.
const ALIKE: f32 = 1e-3;
/// Level that no leaf goes beyond.
const MOST_LEVEL: u32 = 8;

/// A smooth function over one patch, and the tree and samples that it goes through.
#[derive(Clone, Debug)]
pub(super) struct TrianglePatch {
    pub smooth: HermiteSurface,
    pub tree: Quadtree,
    pub samples: Gaps,
}

/// A region that is a triangle.
struct Region {
    triangles: Vec<u32>,
    back: bool,
    /// The corner u = v = 0 and the edges along u and v, m.
    corner: Vec3,
    edges: [Vec3; 2],
    normal: Vec3,
}

impl Region {
    fn new(solution: &RadiositySolution, world: &World, chart: &Chart) -> Option<Self> {
        let is_its =
            |(i, side): (usize, &SideMap)| (side.first == chart.first_element && side.size > 0).then_some(i);
        let sides: Vec<usize> =
            solution.sides().iter().enumerate().filter_map(is_its).take(MOST_TRIANGLES + 1).collect();
        if sides.is_empty() || sides.len() > MOST_TRIANGLES {
            return None;
        }
        let geometry = &world.geometry;
        let triangles: Vec<u32> = sides.iter().map(|i| (i / 2) as u32).collect();
        let corners: Vec<Vec3> = triangles.iter().flat_map(|&t| geometry.positions[t as usize]).collect();
        let farthest = |away: &dyn Fn(Vec3) -> f32| {
            corners.iter().copied().max_by(|a, b| away(*a).total_cmp(&away(*b))).unwrap_or_default()
        };
        // Each is a corner of the outline of what they make.
        let a = farthest(&|p| p.distance(corners[0]));
        let b = farthest(&|p| p.distance(a));
        let c = farthest(&|p| (p - a).cross(b - a).length());
        let area = 0.5 * (b - a).cross(c - a).length();
        let own: f32 = triangles.iter().map(|&t| 0.5 * geometry.area_normal(t).length()).sum();
        if !((own - area).abs() <= ALIKE * area && area > 0.0) {
            return None;
        }
        let back = sides[0] % 2 == 1;
        let normal = geometry.area_normal(triangles[0]).normalize_or_zero() * if back { -1.0 } else { 1.0 };
        let outline = [a, b, c];
        let longest = |i: &usize| outline[(i + 1) % 3].distance(outline[(i + 2) % 3]);
        let right_angle = (0..3).max_by(|i, j| longest(i).total_cmp(&longest(j))).unwrap_or(0);
        let corner = outline[right_angle];
        let mut edges = [1, 2].map(|next| outline[(right_angle + next) % 3] - corner);
        // u to the right and v down: the normal is towards who looks.
        if edges[0].cross(edges[1]).dot(normal) > 0.0 {
            edges.reverse();
        }
        Some(Self { triangles, back, corner, edges, normal })
    }

    fn point(&self, uv: Vec2) -> Vec3 {
        self.corner + self.edges[0] * uv.x + self.edges[1] * uv.y
    }

    /// Light of the triangle of the region that holds a point, or is nearest to it, lx.
    fn light(&self, solution: &RadiositySolution, world: &World, uv: Vec2) -> Vec3 {
        let p = self.point(uv);
        let within = |t: u32| {
            let [a, b, c] = world.geometry.positions[t as usize];
            let n = (b - a).cross(c - a);
            let share = |edge: Vec3| edge.dot(n) / n.length_squared().max(f32::MIN_POSITIVE);
            let at = Vec2::new(share((p - a).cross(c - a)), share((b - a).cross(p - a)));
            (t, at, at.min_element().min(1.0 - at.element_sum()))
        };
        let found = self.triangles.iter().map(|&t| within(t)).max_by(|a, b| a.2.total_cmp(&b.2));
        found.map_or(Vec3::ZERO, |(t, at, _)| solution.irradiance(t, at, self.back, Part::All))
    }
}

impl GridTexture {
    /// The triangle that a chart is, if it is one.
    pub(super) fn of_triangle(solution: &RadiositySolution, world: &World, chart: u32) -> Option<Self> {
        let map = &solution.transport().map;
        let grid = map.charts.get(chart as usize)?;
        let region = Region::new(solution, world, grid)?;
        let size_m = Vec2::new(region.edges[0].length(), region.edges[1].length());
        let step = grid.step_u.length().min(grid.step_v.length()).max(f32::MIN_POSITIVE);
        let cells = (size_m.max_element() / step).ceil().max(1.0) as u32;
        let most_level = cells.checked_next_power_of_two()?.ilog2().min(MOST_LEVEL);
        let light = |uv: Vec2| region.light(solution, world, uv);
        let mean =
            luminance(light(Vec2::splat(1.0 / 3.0)) + light(Vec2::X) + light(Vec2::Y) + light(Vec2::ZERO))
                / 4.0;
        let tolerance = solution.settings().subdivision.map_or(reconstruct::TOLERANCE, |s| s.tolerance);
        let subdivision = Subdivision {
            least_level: most_level.min(2),
            most_level,
            tolerance: tolerance * mean,
            restricted: false,
        };
        let (tree, samples) = sample_adaptively(Shape::Triangle, &subdivision, light);
        let stored = fill_first_order(&tree, &samples);
        let nodes = [samples.side; 2];
        let points = [(2 * (samples.side - 1)).clamp(POINTS[0], POINTS[1]); 2];
        let receiver = |i: u32| {
            let at = (Vec2::new((i % points[0]) as f32, (i / points[0]) as f32) + Vec2::splat(0.5))
                / points[0] as f32;
            (at.element_sum() < 1.0).then(|| Receiver::new(region.point(at), region.normal))
        };
        let smooth = HermiteSurface::new(Shape::Triangle, &samples);
        Some(Self {
            chart,
            object: map.elements[grid.first_element as usize].object,
            nodes,
            size_m,
            points,
            stored,
            open: Vec::new(),
            smooth: Smooth::Triangle(Box::new(TrianglePatch { smooth, tree, samples })),
            receivers: (0..points[0] * points[1]).map(receiver).collect(),
        })
    }
}
