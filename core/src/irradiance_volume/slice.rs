//! A plane through a volume, or through the difference of two, in false colour.
//!
//! A point of the plane has no normal of its own, so what is shown is either the irradiance of a surface
//! that faces one direction, or the mean over all directions: ¼ ∫ L dω, the mean spherical illuminance.

use super::{
    IrradianceVolume,
    difference::{Comparison, Difference},
    inspect::VolumeView,
};
use crate::{
    inspection::{ColouredMesh, Curve, InspectionScene, Label, Legend},
    math::{colour::luminance, part::Part},
};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

/// Vertices along the longer edge of a slice.
const VERTICES: f32 = 120.0;

/// Mean irradiance over all directions at every sample of a volume, to be interpolated.
pub struct MeanIrradiance<'a> {
    volume: &'a IrradianceVolume,
    means: Vec<Vec3>,
}

impl<'a> MeanIrradiance<'a> {
    /// Averages the bins, which have equal solid angles.
    pub fn new(volume: &'a IrradianceVolume, part: Part) -> Self {
        let count = volume.bins().len() as f64;
        let mean = |s: usize| {
            let sum =
                volume.sample_irradiance(s, part).into_iter().fold(DVec3::ZERO, |sum, e| sum + e.as_dvec3());
            (sum / count).as_vec3()
        };
        Self { volume, means: (0..volume.samples().len()).into_par_iter().map(mean).collect() }
    }

    /// At a point, trilinear between samples, lx per channel.
    pub fn at(&self, position: Vec3) -> Vec3 {
        let at = self.volume.weights(position);
        (0..8).fold(Vec3::ZERO, |sum, i| sum + self.means[at.ids[i] as usize] * at.weights[i])
    }
}

/// A slice through a volume: mean irradiance over all directions. Where the view names no plane, it lies
/// half-way up.
pub fn volume_slice(volume: &IrradianceVolume, view: &VolumeView) -> InspectionScene {
    slice_over(volume, volume, view)
}

/// As [`volume_slice`], of another volume over the same plane.
pub fn slice_over(plane: &IrradianceVolume, volume: &IrradianceVolume, view: &VolumeView) -> InspectionScene {
    let field = MeanIrradiance::new(volume, view.part);
    let mesh = mesh(plane, view, |p| field.at(p));
    let low = mesh.values.iter().fold(f32::INFINITY, |low, v| low.min(luminance(*v)));
    let high = bulk(&mesh.values);
    InspectionScene {
        labels: numbers(&mesh),
        meshes: vec![mesh],
        legend: Some(Legend {
            quantity: "irradiance, mean over directions".into(),
            unit: "lx".into(),
            range: if low <= high { [low, high] } else { [0.0, high] },
            names: &[],
        }),
        ..InspectionScene::default()
    }
}

/// A slice through A − B: mean irradiance over all directions, signed.
pub fn difference_slice(difference: &Difference, view: &VolumeView) -> InspectionScene {
    let Difference { a, b, part } = *difference;
    let (fa, fb) = (MeanIrradiance::new(a, part), MeanIrradiance::new(b, part));
    let mesh = mesh(a, view, |p| fa.at(p) - fb.at(p));
    let most = bulk(&mesh.values);
    let compared = compared(difference);
    InspectionScene {
        labels: numbers(&mesh),
        meshes: vec![mesh],
        legend: Some(signed_legend("difference of mean irradiance", most)),
        curves: vec![histogram(&compared)],
        notes: notes(&compared),
        ..InspectionScene::default()
    }
}

/// How often each size of |A − B| / max(B, 5 % of its mean) occurs over samples and bins.
pub fn difference_histogram(difference: &Difference) -> Curve {
    histogram(&compared(difference))
}

/// Size that 95 of 100 values stay below, by luminance: what lies next to a lamp would leave no colours for
/// the rest, and is shown as the palette's end.
pub(super) fn bulk(values: &[Vec3]) -> f32 {
    let mut sizes: Vec<f32> = values.iter().map(|v| luminance(*v).abs()).collect();
    let place = (sizes.len() * 95 / 100).min(sizes.len().max(1) - 1);
    if sizes.is_empty() {
        return 0.0;
    }
    *sizes.select_nth_unstable_by(place, f32::total_cmp).1
}

/// Legend of a signed quantity, lx: as far below zero as above.
pub(super) fn signed_legend(quantity: &str, most: f32) -> Legend {
    Legend { quantity: quantity.into(), unit: "lx".into(), range: [-most, most], names: &[] }
}

/// The difference in words.
pub(super) fn notes(compared: &Comparison) -> Vec<String> {
    let s = &compared.statistics;
    let at = s.largest_at_m;
    vec![
        format!("A {:.4} lx, B {:.4} lx in the mean over samples and directions", s.mean_a_lx, s.mean_b_lx),
        format!(
            "A − B: mean {:+.4} lx, mean size {:.4} lx, rms {:.4} lx",
            s.mean_lx, s.mean_absolute_lx, s.rms_lx
        ),
        format!("largest {:+.4} lx at ({:.2}, {:.2}, {:.2}) m", s.largest_lx, at.x, at.y, at.z),
        format!(
            "relative to B: median {:.2} %, 95th percentile {:.2} %",
            100.0 * s.median_relative,
            100.0 * s.percentile_95_relative
        ),
    ]
}

/// Steps of the histogram, and how wide each is.
const STEPS: (usize, f32) = (25, 0.02);

/// A difference in numbers, as its views show them.
pub(super) fn compared(difference: &Difference) -> Comparison {
    difference.compare(STEPS.0, STEPS.1)
}

/// How often each size of |A − B| / max(B, 5 % of its mean) occurs over samples and bins, as steps of 2 %.
pub(super) fn histogram(compared: &Comparison) -> Curve {
    let counts = &compared.counts;
    let total = counts.iter().sum::<u32>().max(1) as f32;
    let points = counts
        .iter()
        .enumerate()
        .map(|(i, count)| Vec2::new(100.0 * STEPS.1 * (i as f32 + 0.5), 100.0 * *count as f32 / total))
        .collect();
    Curve {
        name: "how far A is from B".into(),
        axes: ["|A − B| / B (%)".into(), "samples and directions (%)".into()],
        points,
        radial: false,
    }
}

/// Numbers on a slice along its longer edge.
const NUMBERS: usize = 9;

/// Values at some of a slice's vertices, in lx by luminance.
fn numbers(mesh: &ColouredMesh) -> Vec<Label> {
    // Rows of vertices follow each other: the second triangle's first corner is the next vertex.
    let columns = mesh.triangles.first().map_or(1, |t| t[2] as usize - 1);
    let rows = mesh.positions.len() / columns.max(1);
    let every = (columns.max(rows) / NUMBERS).max(1);
    let mut labels = Vec::new();
    for y in (every / 2..rows).step_by(every) {
        for x in (every / 2..columns).step_by(every) {
            let value = luminance(mesh.values[y * columns + x]);
            let decimals = usize::from(value.abs() < 10.0);
            labels.push(Label {
                position: mesh.positions[y * columns + x],
                text: format!("{value:.decimals$}"),
                strong: false,
            });
        }
    }
    labels
}

/// A plane across the volume's grid with a value at each vertex.
fn mesh(volume: &IrradianceVolume, view: &VolumeView, value: impl Fn(Vec3) -> Vec3 + Sync) -> ColouredMesh {
    let (low, high) = volume.grid().bounds();
    let (axis, at) =
        view.slice.map_or((1, 0.5 * (low.y + high.y)), |(axis, at)| (usize::from(axis.min(2)), at));
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let step = (high - low)[u].max((high - low)[v]) / VERTICES;
    let count = |edge: f32| ((edge / step).ceil() as u32).clamp(1, VERTICES as u32);
    let (nu, nv) = (count((high - low)[u]), count((high - low)[v]));
    let positions: Vec<Vec3> = (0..(nu + 1) * (nv + 1))
        .map(|i| {
            let (x, y) = (i % (nu + 1), i / (nu + 1));
            let mut p = low;
            p[u] += (high - low)[u] * x as f32 / nu as f32;
            p[v] += (high - low)[v] * y as f32 / nv as f32;
            p[axis] = at;
            p
        })
        .collect();
    let triangles = (0..nu * nv).flat_map(|i| {
        let first = i / nu * (nu + 1) + i % nu;
        let [a, b, c, d] = [first, first + 1, first + nu + 2, first + nu + 1];
        [[a, b, c], [a, c, d]]
    });
    ColouredMesh {
        values: positions.par_iter().map(|p| value(*p)).collect(),
        triangles: triangles.collect(),
        positions,
        ..ColouredMesh::default()
    }
}
