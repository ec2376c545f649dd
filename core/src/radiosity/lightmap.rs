//! Lightmaps baked elsewhere: held against our light, and what is wrong with them pointed out.
//!
//! A lightmap is an image of irradiance in lx over a set of texture coordinates. Every texel whose middle a
//! triangle covers is compared with the irradiance of our solution there, direct light evaluated at the
//! point. Besides the errors that names what bakers look for: charts that overlap, triangles stretched or far
//! from the others' density, edges across which the light jumps, texels that are dark where there is light
//! and bright where there is none.
//!
//! Limits: fronts only; a texel whose middle no triangle covers is padding and not judged.

use super::{RadiositySolution, atlas::lookup};
use crate::{
    math::{colour::luminance, image::LinearImage, part::Part},
    scene::world::World,
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Shadow rays of the light a texel is held to.
const SHADOW_RAYS: u32 = 16;
/// Share of the mean irradiance that counts as dark.
const DARK_SHARE: f32 = 0.02;
/// Share of the mean irradiance by which a texel in the dark is lit from elsewhere.
const LEAK_SHARE: f32 = 0.2;
/// Ratio of the singular values of a triangle's map above which it is stretched.
const STRETCH: f32 = 4.0;
/// Jump across an edge, relative to the light there, that is a seam.
const SEAM: f32 = 0.1;

/// One texel that a triangle covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedTexel {
    /// Column and row.
    pub at: [u32; 2],
    /// Triangle that covers it.
    pub triangle: u32,
    /// Where it lies, m.
    pub position: Vec3,
    /// The lightmap's irradiance, lx.
    pub found: Vec3,
    /// Ours, lx.
    pub ours: Vec3,
}

/// What was found about a lightmap.
#[derive(Clone, Debug, Default)]
pub struct LightmapReport {
    /// Covered texels, by row and column.
    pub texels: Vec<JudgedTexel>,
    /// Triangles whose coordinates are no triangle or leave the unit square.
    pub unmapped: Vec<u32>,
    /// Texels that more than one triangle covers.
    pub overlapping: Vec<[u32; 2]>,
    /// Triangles mapped with a ratio of more than 4 between the directions.
    pub stretched: Vec<u32>,
    /// Triangles with less than half or more than twice the median of texels a metre.
    pub uneven: Vec<u32>,
    /// Edges between coplanar triangles across which the lightmap jumps by more than 10 %: their ends, m.
    pub seams: Vec<[Vec3; 2]>,
    /// Indices into `texels`: black in the lightmap, light in ours.
    pub dark: Vec<usize>,
    /// Indices into `texels`: dark in ours, lit in the lightmap.
    pub leaks: Vec<usize>,
}

/// Compares a lightmap with our light; `uvs` are each triangle's corners on it, v down.
///
/// # Panics
/// If there is not one entry a triangle.
pub fn judge(
    world: &World,
    solution: &RadiositySolution,
    image: &LinearImage,
    uvs: &[Option<[Vec2; 3]>],
) -> LightmapReport {
    assert_eq!(uvs.len(), world.geometry.len(), "texture coordinates of every triangle");
    let mut report = LightmapReport::default();
    let size = Vec2::new(image.width as f32, image.height as f32);
    let mut owner: BTreeMap<[u32; 2], (u32, Vec2, bool)> = BTreeMap::new();
    let mut densities = Vec::new();
    for (t, uvs) in uvs.iter().enumerate() {
        let Some(uvs) = uvs else { continue };
        let corners = uvs.map(|uv| uv * size);
        let outside = |p: &Vec2| p.is_nan() || p.min_element() < -0.5 || (*p - size).max_element() > 0.5;
        let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
        if corners.iter().any(outside) || area == 0.0 || !area.is_finite() {
            report.unmapped.push(t as u32);
            continue;
        }
        let [least, most] = scales(world.geometry.positions[t], corners);
        if most > STRETCH * least {
            report.stretched.push(t as u32);
        }
        densities.push((t as u32, (least * most).sqrt()));
        for (at, barycentric, inside) in covered(corners) {
            if at[0] >= image.width || at[1] >= image.height {
                continue;
            }
            let new = (t as u32, barycentric, inside);
            let known = owner.entry(at).or_insert(new);
            if known.0 != new.0 {
                if known.2 && inside {
                    report.overlapping.push(at);
                }
                *known = if inside { new } else { *known };
            }
        }
    }
    report.overlapping.sort_unstable();
    report.overlapping.dedup();
    let mut sorted: Vec<f32> = densities.iter().map(|d| d.1).collect();
    sorted.sort_by(f32::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    report.uneven =
        densities.iter().filter(|(_, d)| *d < 0.5 * median || *d > 2.0 * median).map(|(t, _)| *t).collect();
    report.texels = owner
        .into_iter()
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|(at, (triangle, barycentric, _))| {
            let front = -world.geometry.area_normal(triangle);
            let surface = world.geometry.surface(triangle, barycentric, front);
            let scramble = at[1] * image.width + at[0];
            let ours = solution.irradiance_exact_direct(world, &surface, Part::All, SHADOW_RAYS, scramble);
            JudgedTexel { at, triangle, position: surface.position, found: image.at(at[0], at[1]), ours }
        })
        .collect();
    let mean =
        report.texels.iter().map(|t| luminance(t.ours)).sum::<f32>() / report.texels.len().max(1) as f32;
    for (i, texel) in report.texels.iter().enumerate() {
        let (found, ours) = (luminance(texel.found), luminance(texel.ours));
        if ours > LEAK_SHARE * mean && (found.is_nan() || found < DARK_SHARE * ours) {
            report.dark.push(i);
        }
        if ours < DARK_SHARE * mean && found > LEAK_SHARE * mean {
            report.leaks.push(i);
        }
    }
    report.seams = seams(world, image, uvs);
    report
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

/// Edges that two coplanar triangles share and whose light differs, by what each side's coordinates give.
fn seams(world: &World, image: &LinearImage, uvs: &[Option<[Vec2; 3]>]) -> Vec<[Vec3; 2]> {
    type Key = [[i64; 3]; 2];
    let (low, high) = world.geometry.bounds();
    let weld = (high - low).length().max(f32::MIN_POSITIVE) * 1e-6;
    let key = |p: Vec3| (p / weld).round().to_array().map(|x| x as i64);
    let mut edges: BTreeMap<Key, Vec<(u32, [Vec2; 2])>> = BTreeMap::new();
    for (t, uvs) in uvs.iter().enumerate() {
        let Some(uvs) = uvs else { continue };
        let positions = world.geometry.positions[t];
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (key(positions[i]), key(positions[j]));
            let (k, ends) = if a < b { ([a, b], [uvs[i], uvs[j]]) } else { ([b, a], [uvs[j], uvs[i]]) };
            edges.entry(k).or_default().push((t as u32, ends));
        }
    }
    let mut found = Vec::new();
    for (key, sides) in edges {
        let [(s, one), (t, other)] = sides[..] else { continue };
        let [m, n] = [s, t].map(|t| world.geometry.area_normal(t).normalize_or_zero());
        if m.dot(n) < 0.999 {
            continue;
        }
        let jump = |share: f32| {
            let [a, b] = [one, other].map(|e| luminance(lookup(image, e[0].lerp(e[1], share))));
            (a - b).abs() > SEAM * a.max(b)
        };
        if [0.25, 0.5, 0.75].into_iter().any(jump) {
            found.push(key.map(|p| Vec3::from(p.map(|x| x as f32 * weld))));
        }
    }
    found
}
