//! What a view shows: pure data in scene units, drawn by the viewport, the CPU overlay and the tests alike.

pub mod colours;

use crate::math::{image::LinearImage, sphere_map::DirectionBins};
use glam::{Vec2, Vec3};

/// Everything one view puts into the scene or beside it.
#[derive(Clone, Debug, Default)]
pub struct InspectionScene {
    /// Spheres coloured by direction.
    pub spheres: Vec<SphereGlyph>,
    /// The bins that `spheres` index.
    pub sphere_bins: Vec<Vec3>,
    /// Their layout; `None` when there are no spheres.
    pub bins: Option<DirectionBins>,
    /// Coloured triangles.
    pub meshes: Vec<ColouredMesh>,
    /// Lines in the scene.
    pub lines: Vec<Line>,
    /// Lines whose colour stands for a value.
    pub value_lines: Vec<ValueLine>,
    /// Words in the scene, drawn by whoever has a font.
    pub labels: Vec<Label>,
    /// Images beside the scene.
    pub images: Vec<NamedImage>,
    /// Curves beside the scene.
    pub curves: Vec<Curve>,
    /// What the colours mean.
    pub legend: Option<Legend>,
    /// Facts to print, with units.
    pub notes: Vec<String>,
}

impl InspectionScene {
    /// Whether nothing of it stands in the scene; images, curves and words may.
    pub fn is_beside_the_scene(&self) -> bool {
        self.spheres.is_empty()
            && self.meshes.is_empty()
            && self.lines.is_empty()
            && self.value_lines.is_empty()
            && self.labels.is_empty()
    }
}

/// A sphere whose colour in each direction is a bin's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereGlyph {
    /// Centre, m.
    pub centre: Vec3,
    /// Radius, m.
    pub radius: f32,
    /// First of its bins in [`InspectionScene::sphere_bins`].
    pub first_bin: u32,
    /// What a click on it selects: the sample's number, or `u32::MAX`.
    pub sample: u32,
}

/// Triangles with a value at each vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColouredMesh {
    /// Vertex positions, m.
    pub positions: Vec<Vec3>,
    /// Value at each vertex, in the legend's unit.
    pub values: Vec<Vec3>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Share of the picture behind that shows through, 0 for none; as the display has it.
    pub transparency: f32,
}

/// A line in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Ends, m.
    pub ends: [Vec3; 2],
    /// Display colour, linear RGB in [0, 1].
    pub colour: Vec3,
}

/// A line in the scene whose colour stands for a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueLine {
    /// Ends, m.
    pub ends: [Vec3; 2],
    /// Value, in the legend's unit.
    pub value: f32,
    /// Share of the picture behind that shows through, 0 for none; as the display has it.
    pub transparency: f32,
}

/// A word in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Where its middle is, m.
    pub position: Vec3,
    /// The word.
    pub text: String,
    /// Whether it stands on a ground of its own, to be read over anything.
    pub strong: bool,
}

/// An image beside the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedImage {
    /// Title.
    pub name: String,
    /// Values in the legend's unit.
    pub image: LinearImage,
}

/// A curve beside the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Title.
    pub name: String,
    /// Axis labels with units.
    pub axes: [String; 2],
    /// Points; for a radial plot positions in its plane.
    pub points: Vec<Vec2>,
    /// Whether both axes have one scale.
    pub radial: bool,
}

/// What the colours of a view mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Quantity, in full: "irradiance".
    pub quantity: String,
    /// Unit: "lx".
    pub unit: String,
    /// Range of the colours; beyond it the first and the last go on.
    pub range: [f32; 2],
    /// What the whole numbers from 0 on stand for, where values are kinds and not amounts.
    pub names: &'static [&'static str],
}

/// Range of colours for values: from the least to the largest or, where a few are far above the rest as
/// on and about a lamp, to the 98th percentile.
///
/// One lamp would otherwise leave a whole room in the first colour. Zeros when there is no finite value.
pub fn robust_range(values: impl Iterator<Item = f32>) -> [f32; 2] {
    const FAR_ABOVE: f32 = 3.0;
    let mut values: Vec<f32> = values.filter(|v| v.is_finite()).collect();
    let Some(last) = values.len().checked_sub(1) else { return [0.0; 2] };
    let high = *values.select_nth_unstable_by(last * 98 / 100, f32::total_cmp).1;
    let (low, most) = values.iter().fold((high, high), |(low, most), &v| (low.min(v), most.max(v)));
    [low, if high > low && most > FAR_ABOVE * high { high } else { most }]
}

/// Range from the 2nd to the 98th percentile: for values whose few extremes are of no interest. Zeros when there
/// is no finite value.
pub fn bulk_range(values: impl Iterator<Item = f32>) -> [f32; 2] {
    let mut values: Vec<f32> = values.filter(|v| v.is_finite()).collect();
    values.sort_by(f32::total_cmp);
    let Some(last) = values.len().checked_sub(1) else { return [0.0; 2] };
    [values[last * 2 / 100], values[last * 98 / 100]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_lamp_does_not_set_the_colours_of_a_room() {
        let room = (0..1000).map(|i| i as f32 * 0.1);
        assert_eq!(robust_range(room.clone()), [0.0, 99.9]);
        let [low, high] = robust_range(room.chain([50_000.0, f32::NAN]));
        assert!(low == 0.0 && (97.0..100.0).contains(&high), "{low} to {high}");
        assert_eq!(robust_range([3.0, 3.0].into_iter()), [3.0, 3.0]);
        assert_eq!(robust_range(std::iter::empty()), [0.0, 0.0]);
    }
}
