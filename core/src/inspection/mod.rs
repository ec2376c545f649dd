//! What a view shows: pure data in scene units, drawn by the viewport, the CPU overlay and the tests alike.

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
}

/// A line in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Ends, m.
    pub ends: [Vec3; 2],
    /// Display colour, linear RGB in [0, 1].
    pub colour: Vec3,
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
    /// Range found in the data.
    pub range: [f32; 2],
}
