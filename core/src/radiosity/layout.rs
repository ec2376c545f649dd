//! What is laid out, and how densely: flat regions, curved rests, lamp bodies, the spacing.

use super::charts::{Region, regions};
use crate::scene::geometry::Geometry;
use glam::Vec3;

/// Elements across the bounding diagonal where no spacing is given and the number of nodes allows it.
const ACROSS: f32 = 100.0;

/// Elements that a spacing chosen from the scene aims to stay below.
const WANTED_ELEMENTS: usize = 50_000;

pub(super) fn finite_diagonal(geometry: &Geometry) -> f32 {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for p in geometry.positions.iter().flatten().filter(|p| p.is_finite()) {
        (low, high) = (low.min(*p), high.max(*p));
    }
    let diagonal = (high - low).length();
    if diagonal.is_finite() && diagonal > 0.0 { diagonal } else { 1.0 }
}

/// Which objects are small and emit: their own light falls on them from close by, a strong second
/// source where it is reflected, so their elements are finer.
pub(super) fn lamp_bodies(geometry: &Geometry, spacing: f32) -> Vec<bool> {
    const MOST_AREA_SPACINGS: f32 = 100.0;
    let body = |range: &std::ops::Range<u32>| {
        let area: f32 = range.clone().map(|t| 0.5 * geometry.area_normal(t).length()).sum();
        area < MOST_AREA_SPACINGS * spacing * spacing
            && range.clone().any(|t| geometry.material_of(t).emission != Vec3::ZERO)
    };
    geometry.object_triangles.iter().map(body).collect()
}

pub(super) fn grid_nodes(geometry: &Geometry, flat: &[Region], spacing: f32) -> usize {
    flat.iter()
        .map(|r| {
            let sides = if geometry.material_of(r.triangles[0]).double_sided { 2 } else { 1 };
            let [nx, ny] = r.nodes(spacing).map(|n| n as usize);
            if nx * ny == 1 { 0 } else { nx * ny * sides }
        })
        .fold(0, usize::saturating_add)
}

/// What [`super::surface_map::SurfaceMap::new`] will lay out, known before it is laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementLayout {
    /// Distance between grid nodes, m.
    pub spacing_m: f32,
    /// Distance that a hundredth of the bounding diagonal would be, m.
    pub hundredth_m: f32,
    /// Grid nodes on flat faces.
    pub grid_nodes: usize,
    /// Triangles lit at their corners, at most one element for each corner and fewer where corners
    /// are shared.
    pub curved_triangles: usize,
}

impl ElementLayout {
    /// The layout of a scene for a spacing, or for the one chosen from the scene.
    pub fn new(geometry: &Geometry, spacing_m: Option<f32>) -> Self {
        let (flat, curved) = faces(geometry);
        let diagonal = finite_diagonal(geometry);
        let spacing_m = spacing_m.unwrap_or_else(|| chosen_spacing(geometry, &flat, diagonal));
        let single = |r: &&Region| r.nodes(spacing_m) == [1, 1];
        let small: usize = flat.iter().filter(single).map(|r| r.triangles.len()).sum();
        Self {
            spacing_m,
            hundredth_m: diagonal / ACROSS,
            grid_nodes: grid_nodes(geometry, &flat, spacing_m),
            curved_triangles: curved.len() + small,
        }
    }
}

/// Flat regions of every object and material, and the triangles of curved meshes; without triangles
/// that have no area or are not finite.
pub(super) fn faces(geometry: &Geometry) -> (Vec<Region>, Vec<u32>) {
    let finite = |t: &u32| {
        geometry.positions[*t as usize].iter().all(|p| p.is_finite())
            && geometry.area_normal(*t).length_squared() > 0.0
    };
    let weld = finite_diagonal(geometry) * 1e-6;
    let (mut flat, mut curved) = (Vec::new(), Vec::new());
    for range in &geometry.object_triangles {
        let mut of_object: Vec<u32> = range.clone().filter(finite).collect();
        of_object.sort_by_key(|&t| geometry.material[t as usize]);
        for same in
            of_object.chunk_by(|&a, &b| geometry.material[a as usize] == geometry.material[b as usize])
        {
            let (r, c) = regions(geometry, same, weld);
            flat.extend(r);
            curved.extend(c);
        }
    }
    (flat, curved)
}

pub(super) fn chosen_spacing(geometry: &Geometry, flat: &[Region], diagonal: f32) -> f32 {
    let mut spacing = diagonal / ACROSS;
    while grid_nodes(geometry, flat, spacing) > WANTED_ELEMENTS && spacing < diagonal {
        spacing *= 1.1;
    }
    spacing
}
