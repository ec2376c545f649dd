//! Packing: all light of a scene's fronts into one image, with padding.
//!
//! Rectangles go on shelves, the highest first. Each gets a rim of `padding` texels that repeats its border, so
//! that bilinear lookup and coarser levels of the image do not bleed from one into the next. Not a
//! skyline or bin tree: charts of one scene are alike in height once sorted, and shelves waste little.
//!
//! A grid of elements is a rectangle, a texel a node. Triangles that are lit at their corners have charts of their
//! own (`atlas_triangles`).

use super::{
    RadiositySolution,
    atlas_triangles::Pair,
    lookup::SideMap,
    surface_map::{Chart, SurfaceMap},
};
use crate::{
    math::{
        image::{LinearImage, bilinear},
        part::Part,
    },
    scene::geometry::Geometry,
};
use glam::{IVec2, UVec2, Vec2, Vec3};

/// Where rectangles lie in one image.
#[derive(Clone, Debug, PartialEq)]
pub struct Atlas {
    /// Texels of the image.
    pub size: UVec2,
    /// First texel of each rectangle, its padding not counted.
    pub places: Vec<UVec2>,
    /// Texels of padding on each side of a rectangle.
    pub padding: u32,
}

impl Atlas {
    /// Packs rectangles of these sizes.
    pub fn pack(sizes: &[UVec2], padding: u32) -> Self {
        let padded = |i: usize| sizes[i] + UVec2::splat(2 * padding);
        let area: u64 = (0..sizes.len()).map(|i| u64::from(padded(i).x) * u64::from(padded(i).y)).sum();
        let widest = (0..sizes.len()).map(|i| padded(i).x).max().unwrap_or(0);
        let width = widest.max((area as f64).sqrt().ceil() as u32).max(1);
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by_key(|&i| (std::cmp::Reverse(sizes[i].y), std::cmp::Reverse(sizes[i].x), i));
        let mut places = vec![UVec2::ZERO; sizes.len()];
        let (mut at, mut shelf) = (UVec2::ZERO, 0);
        for i in order {
            let size = padded(i);
            if at.x + size.x > width {
                at = UVec2::new(0, at.y + shelf);
                shelf = 0;
            }
            places[i] = at + UVec2::splat(padding);
            at.x += size.x;
            shelf = shelf.max(size.y);
        }
        Self { size: UVec2::new(width, (at.y + shelf).max(1)), places, padding }
    }

    /// Fills a rectangle and its padding.
    fn fill(&self, image: &mut LinearImage, rectangle: usize, size: UVec2, value: impl Fn(IVec2) -> Vec3) {
        let (rim, size) = (self.padding as i32, size.as_ivec2());
        for y in -rim..size.y + rim {
            for x in -rim..size.x + rim {
                let texel = (self.places[rectangle].as_ivec2() + IVec2::new(x, y)).as_uvec2();
                image.pixels[(texel.y * image.width + texel.x) as usize] = value(IVec2::new(x, y));
            }
        }
    }
}

/// The irradiance of all fronts in one image, lx, and for each triangle its corners' texture coordinates on it,
/// v down; `None` for triangles without elements: those without an area.
///
/// `geometry` is that of the world that was solved.
pub fn bake(
    geometry: &Geometry,
    solution: &RadiositySolution,
    part: Part,
    padding: u32,
) -> (LinearImage, Vec<Option<[Vec2; 3]>>) {
    let map = &solution.transport().map;
    let light = |element: u32| {
        let element = element as usize;
        match part {
            Part::Direct => solution.direct[element],
            Part::Indirect => solution.indirect[element],
            Part::All => solution.direct[element] + solution.indirect[element],
        }
    };
    let fronts: Vec<SideMap> = map.sides.iter().step_by(2).copied().collect();
    let grid_of = |side: &SideMap| {
        let chart = map.charts.binary_search_by_key(&side.first, |c| c.first_element);
        chart.ok().filter(|_| side.size > 0)
    };
    let mut grids: Vec<usize> = fronts.iter().filter_map(grid_of).collect();
    grids.sort_unstable();
    grids.dedup();
    let pairs = Pair::all(geometry, &fronts, map.spacing_m);
    // A line of nodes twice, so that its triangles have an area.
    let of_grid = |c: &usize| UVec2::new(map.charts[*c].nx.max(2), map.charts[*c].ny.max(2));
    let sizes: Vec<UVec2> =
        grids.iter().map(of_grid).chain(pairs.iter().map(|pair| pair.size(padding))).collect();
    let atlas = Atlas::pack(&sizes, padding);
    let mut image = LinearImage::new(atlas.size.x, atlas.size.y);
    for (rectangle, &number) in grids.iter().enumerate() {
        let chart = &map.charts[number];
        let last = IVec2::new(chart.nx as i32, chart.ny as i32) - 1;
        atlas.fill(&mut image, rectangle, sizes[rectangle], |at| {
            let node = at.clamp(IVec2::ZERO, last).as_uvec2();
            light(chart.first_element + node.y * chart.nx + node.x)
        });
    }
    let on_image = |rectangle: usize, texel: Vec2| {
        (atlas.places[rectangle].as_vec2() + texel + Vec2::splat(0.5)) / atlas.size.as_vec2()
    };
    let mut uvs: Vec<Option<[Vec2; 3]>> = vec![None; fronts.len()];
    for (t, side) in fronts.iter().enumerate() {
        let Some(number) = grid_of(side) else { continue };
        let Ok(rectangle) = grids.binary_search(&number) else { continue };
        let c = side.corners.map(f32::from_bits);
        let across = |i: usize| across_line(map, number, geometry.positions[t][i]);
        let corners = [0, 1, 2].map(|i| Vec2::new(c[2 * i], c[2 * i + 1]) + across(i));
        uvs[t] = Some(corners.map(|texel| on_image(rectangle, texel)));
    }
    for (rectangle, pair) in (grids.len()..).zip(&pairs) {
        let shown = pair.lit(|triangle| {
            let [a, b, c, ..] = fronts[triangle as usize].corners;
            [a, b, c].map(light)
        });
        atlas.fill(&mut image, rectangle, sizes[rectangle], |at| shown.texel(at, padding));
        for (triangle, corners) in pair.corners(padding) {
            uvs[triangle as usize] = Some(corners.map(|texel| on_image(rectangle, texel)));
        }
    }
    (image, uvs)
}

/// Where a point lies across a grid that is a line or one node, from 0 to 1; 0 along axes with several nodes.
fn across_line(map: &SurfaceMap, number: usize, position: Vec3) -> Vec2 {
    let Chart { origin, step_u, step_v, nx, ny, .. } = map.charts[number];
    // The line is in the middle, and a step is the whole width.
    let along = |step: Vec3| {
        let width = step.length_squared().max(f32::MIN_POSITIVE);
        ((position - origin).dot(step) / width + 0.5).clamp(0.0, 1.0)
    };
    Vec2::new(if nx == 1 { along(step_u) } else { 0.0 }, if ny == 1 { along(step_v) } else { 0.0 })
}

/// Irradiance of a lightmap at texture coordinates, bilinear and clamped at its border.
pub fn lookup(image: &LinearImage, uv: Vec2) -> Vec3 {
    let size = Vec2::new(image.width as f32, image.height as f32);
    let p = (uv * size - Vec2::splat(0.5)).clamp(Vec2::ZERO, size - Vec2::ONE);
    bilinear(p, |x, y| image.at((x as u32).min(image.width - 1), (y as u32).min(image.height - 1)))
}
