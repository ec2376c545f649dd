//! Lightmaps baked elsewhere: held against our light, and what is wrong with them pointed out.
//!
//! A lightmap is an image of irradiance in lx over a set of texture coordinates. Every texel whose middle a
//! triangle covers is compared with the irradiance of our solution there, direct light evaluated at the
//! point. Besides the errors that names what bakers look for: charts that overlap, triangles stretched or far
//! from the others' density, edges across which the light jumps, texels that are dark where there is light
//! and bright where there is none.
//!
//! Limits: fronts only; a texel whose middle no triangle covers is padding and not judged.

use super::{
    RadiositySolution,
    atlas::lookup,
    shared_edges::{SharedEdge, shared_edges},
    texels::Coverage,
};
use crate::{
    math::{
        colour::luminance,
        image::LinearImage,
        progress::{Cancelled, Progress},
    },
    scene::world::World,
};
use glam::{Vec2, Vec3};

/// Share of the mean irradiance that counts as dark.
const DARK_SHARE: f32 = 0.02;
/// Share of the mean irradiance by which a texel in the dark is lit from elsewhere.
const LEAK_SHARE: f32 = 0.2;
/// Ratio of the singular values of a triangle's map above which it is stretched.
const STRETCH: f32 = 4.0;
/// Jump across an edge, relative to the light there, that is a seam.
const SEAM: f32 = 0.1;

/// Why a lightmap is not looked at.
#[derive(Debug, thiserror::Error)]
pub enum LightmapError {
    /// Coordinates of textures that repeat.
    #[error(
        "the texture coordinates cover the map {times:.0} times over: they are for textures that repeat, not for a \
         lightmap"
    )]
    Repeating {
        /// Area of all triangles on the map over the map's.
        times: f32,
    },
    /// No middle of a texel lies in a triangle.
    #[error("the texture coordinates of the scene cover no texel")]
    Uncovered,
    /// It was asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// One texel that a triangle covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedTexel {
    /// Column and row.
    pub at: [u32; 2],
    /// Triangle that covers it.
    pub triangle: u32,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec2,
    /// Where it lies, m.
    pub position: Vec3,
    /// The lightmap's irradiance, lx; 0 where that is not a finite number.
    pub found: Vec3,
    /// Ours, lx.
    pub ours: Vec3,
}

/// An edge across which the light jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// Its ends, m.
    pub ends: [Vec3; 2],
    /// The triangles that share it.
    pub triangles: [u32; 2],
}

/// What was found about a lightmap.
#[derive(Clone, Debug, Default)]
pub struct LightmapReport {
    /// Columns and rows of the lightmap.
    pub size: [u32; 2],
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
    /// Edges across which a flat or smooth surface goes on and the lightmap jumps by more than 10 %.
    pub seams: Vec<Seam>,
    /// Indices into `texels`: infinite or not a number in the lightmap.
    pub not_finite: Vec<usize>,
    /// Indices into `texels`: black in the lightmap, light in ours.
    pub dark: Vec<usize>,
    /// Indices into `texels`: dark in ours, lit in the lightmap.
    pub leaks: Vec<usize>,
    /// What the path tracer finds at each of `texels`, lx; empty where it was not asked.
    pub traced: Vec<Vec3>,
}

impl LightmapReport {
    /// Mean of our light over the covered texels, lx by luminance.
    pub fn mean_lx(&self) -> f32 {
        let sum: f64 = self.texels.iter().map(|t| f64::from(luminance(t.ours))).sum();
        (sum / self.texels.len().max(1) as f64) as f32
    }

    /// Range of colours for the difference to our light, lx: the mean of our light either way.
    pub fn difference_range(&self) -> [f32; 2] {
        let mean = self.mean_lx().max(f32::MIN_POSITIVE);
        [-mean, mean]
    }
}

/// Compares a lightmap with our light; `uvs` are each triangle's corners on it, v down.
///
/// # Errors
/// As [`Coverage::new`] and [`Coverage::light`].
pub fn judge(
    world: &World,
    solution: &RadiositySolution,
    image: &LinearImage,
    uvs: &[Option<[Vec2; 3]>],
    progress: &Progress,
) -> Result<LightmapReport, LightmapError> {
    progress.begin("our light on a lightmap");
    let size = [image.width, image.height];
    let coverage = Coverage::new(world, uvs, size)?;
    let light = coverage.light(world, solution, progress)?;
    let texels = coverage.texels.iter().zip(light).map(|(texel, (position, ours))| {
        let found = image.at(texel.at[0], texel.at[1]);
        let (triangle, barycentric) = (texel.triangle, texel.barycentric);
        JudgedTexel { at: texel.at, triangle, barycentric, position, found, ours }
    });
    let mut report = LightmapReport {
        size,
        texels: texels.collect(),
        unmapped: coverage.unmapped,
        overlapping: coverage.overlapping,
        seams: seams(world, image, uvs),
        ..LightmapReport::default()
    };
    let mut sorted: Vec<f32> = coverage.scales.iter().map(|(_, s)| density(*s)).collect();
    sorted.sort_by(f32::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    for (triangle, scales @ [least, most]) in coverage.scales {
        if most > STRETCH * least {
            report.stretched.push(triangle);
        }
        if !(0.5 * median..=2.0 * median).contains(&density(scales)) {
            report.uneven.push(triangle);
        }
    }
    let mean = report.mean_lx();
    for (i, texel) in report.texels.iter_mut().enumerate() {
        if !texel.found.is_finite() {
            texel.found = Vec3::ZERO;
            report.not_finite.push(i);
            continue;
        }
        let (found, ours) = (luminance(texel.found), luminance(texel.ours));
        if ours > LEAK_SHARE * mean && found < DARK_SHARE * ours {
            report.dark.push(i);
        }
        if ours < DARK_SHARE * mean && found > LEAK_SHARE * mean {
            report.leaks.push(i);
        }
    }
    Ok(report)
}

/// Texels a metre by area.
fn density([least, most]: [f32; 2]) -> f32 {
    (least * most).sqrt()
}

/// Edges across which a smooth surface goes on and whose light differs, by what each side's coordinates give.
fn seams(world: &World, image: &LinearImage, uvs: &[Option<[Vec2; 3]>]) -> Vec<Seam> {
    let seam = |edge: SharedEdge| {
        let ends = |side: usize| {
            let corners = uvs[edge.triangles[side] as usize]?;
            Some(edge.corners[side].map(|c| corners[c]))
        };
        let (one, other) = (ends(0)?, ends(1)?);
        let jump = |share: f32| {
            let [a, b] = [one, other].map(|e| luminance(lookup(image, e[0].lerp(e[1], share))));
            (a - b).abs() > SEAM * a.max(b)
        };
        [0.25, 0.5, 0.75].into_iter().any(jump).then_some(Seam { ends: edge.ends, triangles: edge.triangles })
    };
    shared_edges(&world.geometry).into_iter().filter_map(seam).collect()
}
