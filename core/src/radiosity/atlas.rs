//! Packing: the textures of all grids into one image, with padding.
//!
//! Rectangles go on shelves, the highest first. Each gets a rim of `padding` texels that repeats its border, so
//! that bilinear lookup and coarser levels of the image do not bleed from one into the next. Not a
//! skyline or bin tree: charts of one scene are alike in height once sorted, and shelves waste little.

use super::{RadiositySolution, lookup::SideMap};
use crate::math::{
    image::{LinearImage, bilinear},
    part::Part,
};
use glam::{UVec2, Vec2, Vec3};

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
}

/// The irradiance of every grid in one image, lx, and for each triangle its corners' texture coordinates on it,
/// v down; `None` for triangles lit at their corners, which have no texture. Fronts only.
pub fn bake(solution: &RadiositySolution, part: Part, padding: u32) -> (LinearImage, Vec<Option<[Vec2; 3]>>) {
    let map = &solution.transport().map;
    let sizes: Vec<UVec2> = map.charts.iter().map(|c| UVec2::new(c.nx, c.ny)).collect();
    let atlas = Atlas::pack(&sizes, padding);
    let mut image = LinearImage::new(atlas.size.x, atlas.size.y);
    let light = |element: usize| match part {
        Part::Direct => solution.direct[element],
        Part::Indirect => solution.indirect[element],
        Part::All => solution.direct[element] + solution.indirect[element],
    };
    for (chart, place) in map.charts.iter().zip(&atlas.places) {
        for y in 0..chart.ny + 2 * padding {
            for x in 0..chart.nx + 2 * padding {
                let inside = |v: u32, n: u32| v.saturating_sub(padding).min(n - 1);
                let node = inside(y, chart.ny) * chart.nx + inside(x, chart.nx);
                let texel = *place + UVec2::new(x, y) - UVec2::splat(padding);
                image.pixels[(texel.y * image.width + texel.x) as usize] =
                    light((chart.first_element + node) as usize);
            }
        }
    }
    let chart_of = |first: u32| map.charts.binary_search_by_key(&first, |c| c.first_element).ok();
    let uvs = map.sides.iter().step_by(2).map(|side| {
        if *side == SideMap::NONE || side.size == 0 {
            return None;
        }
        let place = atlas.places[chart_of(side.first)?].as_vec2() + Vec2::splat(0.5);
        let c = side.corners.map(f32::from_bits);
        Some([0, 2, 4].map(|i| (place + Vec2::new(c[i], c[i + 1])) / atlas.size.as_vec2()))
    });
    (image, uvs.collect::<Vec<_>>())
}

/// Irradiance of a lightmap at texture coordinates, bilinear and clamped at its border.
pub fn lookup(image: &LinearImage, uv: Vec2) -> Vec3 {
    let size = Vec2::new(image.width as f32, image.height as f32);
    let p = (uv * size - Vec2::splat(0.5)).clamp(Vec2::ZERO, size - Vec2::ONE);
    bilinear(p, |x, y| image.at((x as u32).min(image.width - 1), (y as u32).min(image.height - 1)))
}
