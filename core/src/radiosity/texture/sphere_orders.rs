//! Six patches of a sphere put into one latitude–longitude texture by the thesis's conversions (Bastos §5.5.4).
//!
//! Each patch, its tree full or not, becomes texels by [`convert`](super::convert); the latitude–longitude texture
//! looks them up. Patches of first order are joined first: where trees of different depth meet, both sides of the
//! edge take the values of the finer leaf, which include its samples, and there is no gap.

use super::{
    Quadtree, RadiosityTexture,
    convert::{Gaps, fill_first_order, fill_zero_order, zero_order},
    display::Filter,
    sphere::{by_longitude, face_of, meeting},
};
use crate::math::image::LinearImage;
use glam::{Vec2, Vec3};

/// A sphere by the conversion of first order: bilinear on every leaf.
#[derive(Clone, Debug)]
pub struct FirstOrder {
    cells: u32,
    faces: Vec<RadiosityTexture>,
}

impl FirstOrder {
    /// Of samples at the corners of each patch's leaves.
    ///
    /// # Panics
    /// If a corner of a leaf is open.
    pub fn new(patches: &[(Quadtree, Gaps); 6]) -> Self {
        let cells = 1u32 << patches.iter().map(|p| p.0.height()).max().unwrap_or(0);
        let side = cells + 1;
        let spread = |(tree, samples): &(Quadtree, Gaps)| {
            let own = fill_first_order(tree, samples);
            let at = |x: u32, y: u32| Vec2::new(x as f32, y as f32) / cells as f32;
            LinearImage::from_fn(side, side, |x, y| own.sample(at(x, y), Filter::Bilinear))
        };
        let mut faces: Vec<LinearImage> = patches.iter().map(spread).collect();
        let levels: Vec<Vec<u32>> = patches.iter().map(|(tree, _)| finest(tree, cells)).collect();
        for vertices in meeting(side) {
            let level = vertices.iter().map(|&(face, i)| levels[face][i]).max().unwrap_or(0);
            let known = vertices.iter().filter(|&&(face, i)| levels[face][i] == level);
            let known: Vec<Vec3> = known.map(|&(face, i)| faces[face].pixels[i]).collect();
            let mean = known.iter().sum::<Vec3>() / known.len() as f32;
            vertices.into_iter().for_each(|(face, i)| faces[face].pixels[i] = mean);
        }
        Self { cells, faces: faces.into_iter().map(RadiosityTexture::at_vertices).collect() }
    }

    /// Value at a point of a face.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn at_face(&self, face: usize, uv: Vec2) -> Vec3 {
        self.faces[face].sample(uv, Filter::Bilinear)
    }

    /// The latitude–longitude texture, four times as wide as the deepest patch has cells.
    pub fn texture(&self) -> RadiosityTexture {
        by_longitude(self.cells, |towards| {
            let (face, uv) = face_of(towards);
            self.at_face(face, uv)
        })
    }
}

/// The latitude–longitude texture of the conversion of zero order, of one value a leaf of each patch.
///
/// # Panics
/// If there is not one value a leaf.
pub fn zero_order_texture(patches: &[(Quadtree, Vec<Vec3>); 6]) -> RadiosityTexture {
    let cells = 1u32 << patches.iter().map(|p| p.0.height()).max().unwrap_or(0);
    let faces =
        patches.each_ref().map(|(tree, values)| fill_zero_order(tree, values, &zero_order(tree, values)));
    by_longitude(cells, |towards| {
        let (face, uv) = face_of(towards);
        faces[face].sample(uv, Filter::Nearest)
    })
}

/// Level of the deepest leaf at each vertex of a lattice of so many cells.
fn finest(tree: &Quadtree, cells: u32) -> Vec<u32> {
    let side = cells + 1;
    let mut levels = vec![0; (side * side) as usize];
    for leaf in tree.leaves() {
        let span = leaf.span(cells.ilog2());
        for y in leaf.v * span..=(leaf.v + 1) * span {
            for x in leaf.u * span..=(leaf.u + 1) * span {
                let level = &mut levels[(y * side + x) as usize];
                *level = leaf.level.max(*level);
            }
        }
    }
    levels
}
