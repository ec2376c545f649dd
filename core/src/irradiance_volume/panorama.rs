//! Pictures of everything around a point, and volumes made from them.
//!
//! A panorama is a latitude–longitude picture: column i of w looks towards longitude φ = 2π (i + ½) / w − π,
//! counted from −z to the right (+x), row j of h towards the angle θ = π (j + ½) / h from +y. Taken at some
//! nodes, photographed or rendered, they hold all the radiance that a volume needs (Greger 1996, §5.3).
//!
//! Between nodes radiance is blended bin by bin, with weights 1/d² that make it exact at a node (Shepard
//! 1968). Not by reprojection: pictures carry no depth, so what is near does not shift as it should, and
//! the farther the nodes lie apart, the more shadows cross-fade where they should move.
//!
//! Pictures do not say which light comes straight from an emitter: the whole of it is in the indirect part
//! of such a volume, and its direct part is black.

use super::{
    IrradianceVolume, Sample, VolumeError, VolumeSettings,
    given::Radiance,
    grid::BilevelGrid,
    trust::{Repair, SampleState},
};
use crate::math::{image::LinearImage, progress::Progress, sphere_map::DirectionBins};
use glam::{DVec3, UVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::{
    f32::consts::{PI, TAU},
    sync::Arc,
};

/// Direction through a place of a panorama, (0, 0) the top left and (1, 1) the bottom right corner.
pub fn direction(place: Vec2) -> Vec3 {
    let (sin, cos) = (PI * place.y).sin_cos();
    let (east, north) = (TAU * place.x - PI).sin_cos();
    Vec3::new(sin * east, cos, -sin * north)
}

/// Place of a unit direction; the inverse of [`direction`].
pub fn place(direction: Vec3) -> Vec2 {
    let longitude = direction.x.atan2(-direction.z);
    Vec2::new(longitude / TAU + 0.5, direction.y.clamp(-1.0, 1.0).acos() / PI)
}

/// The same surroundings with −z in the middle where +z was, as OpenEXR has it, and the other way round; in
/// an odd number of columns each new one is the mean of the two that it lies between.
pub fn half_turned(image: &LinearImage) -> LinearImage {
    let (width, half) = (image.width.max(1), image.width / 2);
    LinearImage::from_fn(image.width, image.height, |x, y| {
        let after = image.at((x + half + image.width % 2) % width, y);
        if image.width.is_multiple_of(2) { after } else { 0.5 * (image.at((x + half) % width, y) + after) }
    })
}

/// Renders a panorama `height` pixels high and twice as wide: `radiance` gives the light that arrives along
/// a direction, cd/m², and is asked `rays`² times a pixel.
pub fn render(height: u32, rays: u32, radiance: impl Fn(Vec3) -> Vec3 + Sync) -> LinearImage {
    let (height, rays) = (height.max(1), rays.max(1));
    let size = Vec2::new(2.0 * height as f32, height as f32);
    LinearImage::from_fn(2 * height, height, |x, y| {
        let mut sum = Vec3::ZERO;
        for i in 0..rays * rays {
            let inner = Vec2::new((i % rays) as f32 + 0.5, (i / rays) as f32 + 0.5) / rays as f32;
            sum += radiance(direction((Vec2::new(x as f32, y as f32) + inner) / size));
        }
        sum / (rays * rays) as f32
    })
}

/// Mean radiance of a panorama over each bin, cd/m²: every pixel counts with the solid angle it covers,
/// Δφ (cos θ₁ − cos θ₂), so that flux is kept however small a lamp is.
pub fn bins_of(image: &LinearImage, bins: DirectionBins) -> Vec<Vec3> {
    let (width, height) = (image.width.max(1), image.height.max(1));
    // Pixels are cut until eight pieces make the edge of a bin, 2/n of half a turn.
    let cut = (8 * bins.n()).div_ceil(height).clamp(1, 16);
    let (columns, rows) = (width * cut, height * cut);
    let mut sums = vec![(DVec3::ZERO, 0.0f64); bins.len()];
    for row in 0..rows {
        let edge = |r: u32| (std::f64::consts::PI * f64::from(r) / f64::from(rows)).cos();
        let weight = edge(row) - edge(row + 1);
        for column in 0..columns {
            let at = Vec2::new((column as f32 + 0.5) / columns as f32, (row as f32 + 0.5) / rows as f32);
            let sum = &mut sums[bins.bin(direction(at))];
            sum.0 += image.at(column / cut, row / cut).as_dvec3() * weight;
            sum.1 += weight;
        }
    }
    sums.iter()
        .enumerate()
        .map(|(bin, (sum, weight))| {
            if *weight > 0.0 {
                return (sum / *weight).as_vec3();
            }
            let at = place(bins.centre(bin)) * Vec2::new(width as f32, height as f32);
            image.at((at.x as u32).min(width - 1), (at.y as u32).min(height - 1))
        })
        .collect()
}

/// A panorama and where it was taken.
#[derive(Clone, Debug, PartialEq)]
pub struct PanoramaNode {
    /// Position of the camera, m.
    pub position: Vec3,
    /// Latitude–longitude picture, cd/m².
    pub image: LinearImage,
}

/// How far the grid reaches to each side of nodes that lie in one plane or at one point, m.
const FLAT_REACH_M: f32 = 0.5;

impl IrradianceVolume {
    /// A volume from panoramas: one level of samples over the box around the nodes, as many an axis as
    /// `settings` says, or, where it says nothing, as many as the nodes have different coordinates; so nodes
    /// on an even lattice are the samples.
    ///
    /// # Errors
    /// [`VolumeError::Setting`] for settings out of range, no nodes, or a node without a picture or with a
    /// position that is not finite; [`VolumeError::Cancelled`].
    pub fn from_panoramas(
        nodes: &[PanoramaNode],
        settings: &VolumeSettings,
        progress: &Progress,
    ) -> Result<Self, VolumeError> {
        settings.check()?;
        let unusable = |n: &PanoramaNode| !n.position.is_finite() || n.image.pixels.is_empty();
        if nodes.is_empty() || nodes.iter().any(unusable) {
            let value = format!("{} nodes", nodes.len());
            return Err(VolumeError::Setting {
                name: "panoramas",
                value,
                range: "one or more, each with a picture and a finite position",
            });
        }
        progress.begin("volume from panoramas");
        let bins = DirectionBins::new(settings.bins_n);
        let seen: Vec<Vec<Vec3>> = nodes.par_iter().map(|n| bins_of(&n.image, bins)).collect();
        progress.report(0.5)?;
        let (low, high) = nodes.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), n| {
            (low.min(n.position), high.max(n.position))
        });
        let flat = (high - low).cmple(Vec3::splat(1e-4));
        let reach = Vec3::select(flat, Vec3::splat(FLAT_REACH_M), Vec3::ZERO);
        let samples = settings.samples.map_or_else(|| lattice(nodes), UVec3::from);
        let cells = (samples - UVec3::ONE).element_product() as usize;
        let grid =
            BilevelGrid::new(low - reach, high + reach, samples, settings.second_level, &vec![false; cells]);
        let at: Vec<Sample> = grid
            .places()
            .iter()
            .map(|p| Sample {
                position: p.position,
                level: p.level,
                back_face_fraction: 0.0,
                valid: true,
                state: SampleState::Free,
            })
            .collect();
        let reflected = at.par_iter().map(|s| blended(nodes, &seen, s.position, bins)).collect();
        let radiance = Radiance { reflected, emitted: Vec::new() };
        progress.report(1.0)?;
        // Without a scene there is nothing to guard queries by, nothing to move samples out of, and no pockets.
        let (samples, repair) = (Some(samples.into()), Repair::Mask);
        let settings =
            VolumeSettings { samples, repair, guard: false, pocket_samples: 0, ..settings.clone() };
        Ok(Self::given(settings, Arc::new(grid), Arc::new(at), Vec::new(), &radiance))
    }
}

/// Different coordinates an axis, at least 2 and at most 200.
fn lattice(nodes: &[PanoramaNode]) -> UVec3 {
    let count = |axis: usize| {
        let mut all: Vec<f32> = nodes.iter().map(|n| n.position[axis]).collect();
        all.sort_by(f32::total_cmp);
        all.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
        (all.len() as u32).clamp(2, 200)
    };
    UVec3::new(count(0), count(1), count(2))
}

/// Radiance of every bin between nodes, weighted by 1/d²; that of a node where there is one.
fn blended(nodes: &[PanoramaNode], seen: &[Vec<Vec3>], position: Vec3, bins: DirectionBins) -> Vec<Vec3> {
    const AT_A_NODE_M2: f32 = 1e-6;
    let d2: Vec<f32> = nodes.iter().map(|n| n.position.distance_squared(position)).collect();
    if let Some(here) = d2.iter().position(|d| *d < AT_A_NODE_M2) {
        return seen[here].clone();
    }
    let total: f32 = d2.iter().map(|d| 1.0 / d).sum();
    let mut sum = vec![Vec3::ZERO; bins.len()];
    for (seen, d2) in seen.iter().zip(&d2) {
        let weight = 1.0 / (d2 * total);
        sum.iter_mut().zip(seen).for_each(|(s, l)| *s += *l * weight);
    }
    sum
}
