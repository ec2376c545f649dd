//! Which texels of a lightmap the triangles of a scene cover, and how they are mapped onto it.
//!
//! A texel belongs to the triangle that holds its middle. Coordinates whose triangles cover the map many times
//! over were made for textures that repeat; they are refused, since no texel of theirs stands for one place.

use super::{RadiositySolution, lightmap::LightmapError};
use crate::{
    math::{
        image::LinearImage,
        part::Part,
        progress::{Cancelled, Progress},
    },
    scene::world::World,
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Times that triangles may cover the map.
const MOST_OFTEN: f32 = 8.0;
/// Shadow rays of a texel's light.
const SHADOW_RAYS: u32 = 16;
/// Texels between two looks at whether to go on.
const CHUNK: usize = 4096;

/// A texel and the place it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// Column and row.
    pub at: [u32; 2],
    /// Triangle that covers its middle.
    pub triangle: u32,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec2,
}

/// What the triangles of a scene cover of a lightmap.
#[derive(Clone, Debug, Default)]
pub struct Coverage {
    /// Columns and rows of the map.
    pub size: [u32; 2],
    /// Covered texels, by row and column.
    pub texels: Vec<Texel>,
    /// Triangles whose coordinates are no triangle or leave the unit square.
    pub unmapped: Vec<u32>,
    /// Texels that more than one triangle covers.
    pub overlapping: Vec<[u32; 2]>,
    /// Least and most texels a metre of each triangle that is mapped: singular values of its map.
    pub scales: Vec<(u32, [f32; 2])>,
}

impl Coverage {
    /// Covers a map of `size` texels; `uvs` are each triangle's corners on it, v down.
    ///
    /// # Errors
    /// Where the triangles cover the map more than eight times over, or none of it.
    ///
    /// # Panics
    /// If there is not one entry a triangle.
    pub fn new(world: &World, uvs: &[Option<[Vec2; 3]>], size: [u32; 2]) -> Result<Self, LightmapError> {
        assert_eq!(uvs.len(), world.geometry.len(), "texture coordinates of every triangle");
        let [width, height] = size;
        let size = Vec2::new(width as f32, height as f32);
        let outside = |p: &Vec2| p.is_nan() || p.min_element() < -0.5 || (*p - size).max_element() > 0.5;
        let mut coverage = Self { size: [width, height], ..Self::default() };
        let mut mapped = Vec::new();
        for (t, uvs) in uvs.iter().enumerate().filter_map(|(t, uvs)| Some((t as u32, (*uvs)?))) {
            let corners = uvs.map(|uv| uv * size);
            let area = 0.5 * (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs();
            if corners.iter().any(outside) || area == 0.0 {
                coverage.unmapped.push(t);
            } else {
                mapped.push((t, corners, area));
            }
        }
        let times = mapped.iter().map(|m| f64::from(m.2)).sum::<f64>() as f32 / (size.x * size.y);
        if times > MOST_OFTEN {
            return Err(LightmapError::Repeating { times });
        }
        let mut owners: Vec<Option<(u32, Vec2, bool)>> = vec![None; (width * height) as usize];
        for (t, corners, _) in mapped {
            coverage.scales.push((t, scales(world.geometry.positions[t as usize], corners)));
            for (at, barycentric, inside) in covered(corners) {
                if at[0] >= width || at[1] >= height {
                    continue;
                }
                let new = (t, barycentric, inside);
                let owner = owners[(at[1] * width + at[0]) as usize].get_or_insert(new);
                if owner.0 != t {
                    if owner.2 && inside {
                        coverage.overlapping.push(at);
                    }
                    *owner = if inside { new } else { *owner };
                }
            }
        }
        coverage.overlapping.sort_unstable();
        coverage.overlapping.dedup();
        coverage.texels = owners
            .iter()
            .zip(0u32..)
            .filter_map(|(owner, i)| {
                let (triangle, barycentric, _) = (*owner)?;
                Some(Texel { at: [i % width, i / width], triangle, barycentric })
            })
            .collect();
        if coverage.texels.is_empty() { Err(LightmapError::Uncovered) } else { Ok(coverage) }
    }

    /// Irradiance of the fronts at every texel in lx, direct light evaluated at the place itself, and where it is.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn light(
        &self,
        world: &World,
        solution: &RadiositySolution,
        progress: &Progress,
    ) -> Result<Vec<(Vec3, Vec3)>, Cancelled> {
        let mut light = Vec::with_capacity(self.texels.len());
        for (chunk, first) in self.texels.chunks(CHUNK).zip((0..).step_by(CHUNK)) {
            progress.report(first as f32 / self.texels.len() as f32)?;
            light.par_extend(chunk.par_iter().enumerate().map(|(i, texel)| {
                let front = -world.geometry.area_normal(texel.triangle);
                let surface = world.geometry.surface(texel.triangle, texel.barycentric, front);
                let scramble = (first + i) as u32;
                let light =
                    solution.irradiance_exact_direct(world, &surface, Part::All, SHADOW_RAYS, scramble);
                (surface.position, light)
            }));
        }
        Ok(light)
    }
}

/// Our irradiance as a lightmap over what is covered of it, lx: fronts only, direct light evaluated at the middle
/// of each texel, and around each chart `padding` texels that repeat their neighbours' mean.
///
/// # Errors
/// [`Cancelled`].
pub fn bake(
    world: &World,
    solution: &RadiositySolution,
    coverage: &Coverage,
    padding: u32,
    progress: &Progress,
) -> Result<LinearImage, Cancelled> {
    progress.begin("baking a lightmap");
    let [width, height] = coverage.size;
    let mut known: Vec<Option<Vec3>> = vec![None; (width * height) as usize];
    for (texel, (_, light)) in coverage.texels.iter().zip(coverage.light(world, solution, progress)?) {
        known[(texel.at[1] * width + texel.at[0]) as usize] = Some(light);
    }
    dilate(&mut known, [width, height], padding);
    Ok(LinearImage { width, height, pixels: known.into_iter().map(Option::unwrap_or_default).collect() })
}

/// Gives unknown texels the mean of their known neighbours, `rings` times.
pub fn dilate(texels: &mut [Option<Vec3>], [width, height]: [u32; 2], rings: u32) {
    for _ in 0..rings {
        let before = texels.to_vec();
        texels.par_iter_mut().enumerate().filter(|(_, t)| t.is_none()).for_each(|(i, texel)| {
            let (x, y) = (i as u32 % width, i as u32 / width);
            let near = (y.saturating_sub(1)..=(y + 1).min(height - 1))
                .flat_map(|y| (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |x| y * width + x))
                .filter_map(|j| before[j as usize]);
            let (sum, count) = near.fold((Vec3::ZERO, 0.0), |(sum, count), e| (sum + e, count + 1.0));
            *texel = (count > 0.0).then(|| sum / count);
        });
    }
}

/// Least and most texels a metre of a triangle's map: the singular values of its Jacobian.
fn scales([a, b, c]: [Vec3; 3], texels: [Vec2; 3]) -> [f32; 2] {
    let u = (b - a).normalize_or_zero();
    let v = (b - a).cross(c - a).cross(b - a).normalize_or_zero();
    let (x1, x2, y2) = ((b - a).dot(u), (c - a).dot(u), (c - a).dot(v));
    if x1 <= 0.0 || y2 <= 0.0 {
        return [0.0; 2];
    }
    let along_u = (texels[1] - texels[0]) / x1;
    let along_v = (texels[2] - texels[0] - along_u * x2) / y2;
    let (sum, product) =
        (along_u.length_squared() + along_v.length_squared(), along_u.perp_dot(along_v).abs());
    let root = (sum * sum - 4.0 * product * product).max(0.0).sqrt();
    let most = (0.5 * (sum + root)).sqrt();
    [if most > 0.0 { product / most } else { 0.0 }, most]
}

/// Texels whose middles lie in a triangle, with barycentric weights of corners 1 and 2, and whether they do so
/// by more than rounding: a middle on an edge is of both triangles that share it, which is no overlap.
fn covered([a, b, c]: [Vec2; 3]) -> Vec<([u32; 2], Vec2, bool)> {
    const ROUNDING: f32 = 1e-5;
    let (low, high) = (a.min(b).min(c).max(Vec2::ZERO), a.max(b).max(c));
    let area = (b - a).perp_dot(c - a);
    let mut found = Vec::new();
    for y in low.y as u32..=high.y.max(0.0) as u32 {
        for x in low.x as u32..=high.x.max(0.0) as u32 {
            let p = Vec2::new(x as f32, y as f32) + Vec2::splat(0.5) - a;
            let (u, v) = (p.perp_dot(c - a) / area, (b - a).perp_dot(p) / area);
            let depth = u.min(v).min(1.0 - u - v);
            if depth > -ROUNDING {
                found.push(([x, y], Vec2::new(u, v), depth > ROUNDING));
            }
        }
    }
    found
}
