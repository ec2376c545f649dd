//! A sphere as six patches, put into one latitude–longitude texture (Bastos §5.5.4).
//!
//! The patches are the faces of a cube, projected so that equal steps are equal angles: direction
//! n + tan(π s/4) e_u + tan(π t/4) e_v for s, t in [−1, 1]. Each has a quadtree of its own. What makes one
//! surface of them is shared along and across their edges: a vertex on an edge that either side has sampled
//! is a sample of both, so that different depths meet without a gap, and derivatives at an edge are taken
//! between a vertex on one side and the value as far away on the other.
//!
//! The texture is four times as wide and twice as high as the deepest patch, plus a row: its rows are
//! vertices, the first and the last are the poles, y = 1 and y = −1, each of one value. Longitude runs from −z
//! over +x. The thesis has texel centres and repeats the last rows for padding; here what lies over a pole is
//! the other side of the sphere, [`Border::Sphere`], so nothing pinches there.

use super::{Border, Quadtree, RadiosityTexture, Shape, convert::Gaps, hermite::HermiteSurface};
use crate::math::image::LinearImage;
use glam::{UVec2, Vec2, Vec3};
use std::{
    collections::BTreeMap,
    f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU},
};

/// Normal and axes of the six faces.
const FACES: [[Vec3; 3]; 6] = [
    [Vec3::X, Vec3::NEG_Z, Vec3::Y],
    [Vec3::NEG_X, Vec3::Z, Vec3::Y],
    [Vec3::Y, Vec3::X, Vec3::NEG_Z],
    [Vec3::NEG_Y, Vec3::X, Vec3::Z],
    [Vec3::Z, Vec3::X, Vec3::Y],
    [Vec3::NEG_Z, Vec3::NEG_X, Vec3::Y],
];

/// Unit direction of a point of a face, which may lie a little beyond it.
///
/// # Panics
/// If there is no such face.
pub fn direction(face: usize, uv: Vec2) -> Vec3 {
    let [n, u, v] = FACES[face];
    let [s, t] = (2.0 * uv - Vec2::ONE).to_array().map(|x| (FRAC_PI_4 * x).tan());
    (n + u * s + v * t).normalize()
}

/// Face that a direction meets, and where.
pub fn face_of(direction: Vec3) -> (usize, Vec2) {
    let towards = |face: usize| direction.dot(FACES[face][0]);
    let best = (1..FACES.len()).fold(0, |best, face| if towards(face) > towards(best) { face } else { best });
    let [n, u, v] = FACES[best];
    let along = |axis: Vec3| 0.5 + 0.5 * (direction.dot(axis) / direction.dot(n)).atan() / FRAC_PI_4;
    (best, Vec2::new(along(u), along(v)))
}

/// Unit direction of a point of the latitude–longitude texture.
pub fn direction_at(uv: Vec2) -> Vec3 {
    let (longitude, latitude) = (TAU * uv.x, FRAC_PI_2 - PI * uv.y);
    let ring = latitude.cos();
    Vec3::new(longitude.sin() * ring, latitude.sin(), -longitude.cos() * ring)
}

/// Point of the latitude–longitude texture that shows a direction.
pub fn place_of(direction: Vec3) -> Vec2 {
    let d = direction.normalize_or(Vec3::Y);
    Vec2::new((d.x.atan2(-d.z) / TAU).rem_euclid(1.0), 0.5 - d.y.clamp(-1.0, 1.0).asin() / PI)
}

/// One smooth function over a sphere.
#[derive(Clone, Debug)]
pub struct SphereSurface {
    cells: u32,
    /// Surface of each face over its lattice and one vertex more on each side.
    faces: Vec<HermiteSurface>,
}

impl SphereSurface {
    /// The function through the samples of six patches; see the module's text.
    ///
    /// # Panics
    /// If the trees are not of quadrilaterals or the samples not theirs.
    pub fn new(patches: &[(Quadtree, Gaps); 6]) -> Self {
        let height = patches.iter().map(|p| p.0.height()).max().unwrap_or(0).max(1);
        let cells = 1u32 << height;
        let mut samples: Vec<Gaps> = patches.iter().map(|(tree, own)| spread(tree, own, height)).collect();
        share_edges(&mut samples);
        for own in &mut samples {
            let smooth = HermiteSurface::new(Shape::Quadrilateral, own).resampled(own.side);
            own.texels = smooth.image.pixels.into_iter().map(Some).collect();
        }
        share_edges(&mut samples);
        let alone: Vec<HermiteSurface> =
            samples.iter().map(|own| HermiteSurface::new(Shape::Quadrilateral, own)).collect();
        Self { cells, faces: (0..6).map(|face| joined(&alone, face, cells)).collect() }
    }

    /// Value in a direction.
    pub fn at(&self, direction: Vec3) -> Vec3 {
        let (face, uv) = face_of(direction);
        self.at_face(face, uv)
    }

    /// Value at a point of a face.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn at_face(&self, face: usize, uv: Vec2) -> Vec3 {
        let cells = self.cells as f32;
        self.faces[face].at((uv * cells + Vec2::ONE) / (cells + 2.0))
    }

    /// The latitude–longitude texture, four times as wide as the deepest patch has cells.
    pub fn texture(&self) -> RadiosityTexture {
        self.sampled(self.cells)
    }

    /// The latitude–longitude texture, four times as wide as `cells`.
    pub fn sampled(&self, cells: u32) -> RadiosityTexture {
        by_longitude(cells, |towards| self.at(towards))
    }
}

/// The latitude–longitude texture of a function of direction, four times as wide as `cells`; the poles have one
/// value each.
pub(super) fn by_longitude(cells: u32, at: impl Fn(Vec3) -> Vec3 + Sync) -> RadiosityTexture {
    let (w, h) = (4 * cells, 2 * cells + 1);
    let step = Vec2::new(1.0 / w as f32, 1.0 / (h - 1) as f32);
    let image = LinearImage::from_fn(w, h, |x, y| match y {
        0 => at(Vec3::Y),
        y if y + 1 == h => at(Vec3::NEG_Y),
        y => at(direction_at(Vec2::new(x as f32, y as f32) * step)),
    });
    RadiosityTexture { image, first: Vec2::ZERO, step, border: Border::Sphere }
}

/// Samples on the lattice of a level at or below a tree's.
fn spread(tree: &Quadtree, samples: &Gaps, height: u32) -> Gaps {
    assert!(tree.shape() == Shape::Quadrilateral, "a patch of triangles");
    let span = 1u32 << (height - tree.height());
    let side = (1u32 << height) + 1;
    let mut texels = vec![None; (side * side) as usize];
    for (sample, i) in samples.texels.iter().zip(0..) {
        let p = UVec2::new(i % samples.side, i / samples.side) * span;
        texels[(p.y * side + p.x) as usize] = *sample;
    }
    Gaps { side, texels }
}

/// The vertices of lattices of `side` vertices a side that lie on borders of faces, by place: face and number of all
/// that meet at each.
pub(super) fn meeting(side: u32) -> impl Iterator<Item = Vec<(usize, usize)>> {
    let mut meeting: BTreeMap<[i32; 3], Vec<(usize, usize)>> = BTreeMap::new();
    let cells = side as i32 - 1;
    for (face, axes) in FACES.iter().enumerate() {
        let [n, u, v] = axes.map(|axis| axis.as_ivec3());
        for i in 0..side * side {
            let (x, y) = ((i % side) as i32, (i / side) as i32);
            if x.min(y) == 0 || x.max(y) == cells {
                let on_cube = n * cells + u * (2 * x - cells) + v * (2 * y - cells);
                meeting.entry(on_cube.to_array()).or_default().push((face, i as usize));
            }
        }
    }
    meeting.into_values()
}

/// Gives what one face knows at a vertex on its border to the others that meet there; where several know,
/// their mean.
fn share_edges(faces: &mut [Gaps]) {
    for vertices in meeting(faces[0].side) {
        let known: Vec<Vec3> = vertices.iter().filter_map(|&(face, i)| faces[face].texels[i]).collect();
        if !known.is_empty() {
            let mean = known.iter().sum::<Vec3>() / known.len() as f32;
            for (face, i) in vertices {
                faces[face].texels[i] = Some(mean);
            }
        }
    }
}

/// A face's lattice with one vertex more on each side, taken from its neighbours.
fn joined(alone: &[HermiteSurface], face: usize, cells: u32) -> HermiteSurface {
    let side = cells as usize + 3;
    let values: Vec<Vec3> = (0..side * side)
        .map(|i| {
            let uv = (Vec2::new((i % side) as f32, (i / side) as f32) - Vec2::ONE) / cells as f32;
            if uv.min_element() < 0.0 || uv.max_element() > 1.0 {
                let (other, there) = face_of(direction(face, uv));
                alone[other].at(there)
            } else {
                alone[face].at(uv)
            }
        })
        .collect();
    HermiteSurface::through(&values, side)
}
