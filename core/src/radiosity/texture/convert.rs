//! From a quadtree's leaves to texels (Bastos §5.5.1, 5.5.2).
//!
//! *Zero-order* textures have 2^height texels a side (Eq. 5.6), one for each leaf of a full tree; *first-order*
//! ones have one more and hold the mean of the leaves that meet at each vertex. A leaf above the deepest
//! level touches fewer texels than it covers: the gaps are filled afterwards. Programs 5.7 and 5.10 are the
//! cases of 5.12 and its first-order sister in which every leaf is at the deepest level.
//!
//! Errors of the printed programs: 5.12 asks `level == height` for a leaf, by which its span would always
//! be 1 and the recursion run past the leaves; it must ask for no children, as 5.14 does. 5.11 runs to nu and
//! nv, which in a first-order texture leaves out the last row and column.
//!
//! A triangle of level `height` takes the half u + v < 2^height of a zero-order texture with its upright
//! cells, and with its inverted ones the other half, turned by 180°: every texel is one leaf's. Its
//! first-order texture takes the half u + v ≤ 2^height; what lies beyond continues the plane of the cells at
//! the diagonal, so that bilinear display is linear on each of its triangles.

use super::{Cell, Quadtree, RadiosityTexture, Shape, triangle};
use crate::math::image::LinearImage;
use glam::{UVec2, Vec3};

/// A square texture with gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaps {
    /// Texels a side.
    pub side: u32,
    /// Row-major texels.
    pub texels: Vec<Option<Vec3>>,
}

/// Accumulator and counter of a first-order conversion (Bastos Fig. 5.9), row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexSums {
    /// Texels a side.
    pub side: u32,
    /// Sum of the radiosities of the leaves that share a vertex, lx.
    pub accumulator: Vec<Vec3>,
    /// Number of leaves that share it: four inside a full tree of quadrilaterals, six of triangles.
    pub counter: Vec<u32>,
}

/// Texels of a cell in the lattice of a zero-order texture: its own, then those it only covers.
fn texels(cell: &Cell, shape: Shape, height: u32) -> Vec<UVec2> {
    let (span, last) = (cell.span(height), (1u32 << height) - 1);
    let low = UVec2::new(cell.u, cell.v) * span;
    let square = || (0..span).flat_map(move |b| (0..span).map(move |a| UVec2::new(a, b)));
    if shape == Shape::Quadrilateral {
        return square().map(|p| low + p).collect();
    }
    let inside = |p: UVec2| if cell.inverted { low + UVec2::splat(span - 1) - p } else { low + p };
    let place = |p: UVec2, inverted: bool| if inverted { UVec2::splat(last) - p } else { p };
    let alike = square().filter(|p| p.x + p.y < span).map(|p| place(inside(p), cell.inverted));
    let turned = square().filter(|p| p.x + p.y + 1 < span).map(|p| place(inside(p), !cell.inverted));
    alike.chain(turned).collect()
}

/// One texel a leaf, the rest open (Bastos Programs 5.7 and 5.12).
///
/// # Panics
/// If there is not one radiosity a leaf.
pub fn zero_order(tree: &Quadtree, radiosity: &[Vec3]) -> Gaps {
    each_texel(tree, radiosity, 1)
}

/// The radiosity of every leaf above the deepest level in all its texels (Program 5.14).
///
/// # Panics
/// If there is not one radiosity a leaf, or the texture is another tree's.
pub fn fill_zero_order(tree: &Quadtree, radiosity: &[Vec3], texture: &Gaps) -> RadiosityTexture {
    let covered = each_texel(tree, radiosity, usize::MAX);
    assert_eq!(covered.side, texture.side, "the texture of another tree");
    let pixels = texture.texels.iter().zip(&covered.texels).map(|(t, c)| t.or(*c).unwrap_or(Vec3::ZERO));
    let image = LinearImage { width: texture.side, height: texture.side, pixels: pixels.collect() };
    RadiosityTexture::at_centres(image)
}

fn each_texel(tree: &Quadtree, radiosity: &[Vec3], most: usize) -> Gaps {
    let leaves = tree.leaves();
    assert_eq!(leaves.len(), radiosity.len(), "one radiosity a leaf");
    let (shape, height) = (tree.shape(), tree.height());
    let side = 1u32 << height;
    let mut gaps = Gaps { side, texels: vec![None; (side * side) as usize] };
    for (leaf, value) in leaves.iter().zip(radiosity) {
        for p in texels(leaf, shape, height).into_iter().take(most) {
            gaps.texels[(p.y * side + p.x) as usize] = Some(*value);
        }
    }
    gaps
}

/// Sums and counts at the corners of the leaves (Program 5.10; of any tree).
///
/// # Panics
/// If there is not one radiosity a leaf.
pub fn first_order(tree: &Quadtree, radiosity: &[Vec3]) -> VertexSums {
    let leaves = tree.leaves();
    assert_eq!(leaves.len(), radiosity.len(), "one radiosity a leaf");
    let height = tree.height();
    let side = (1u32 << height) + 1;
    let count = (side * side) as usize;
    let mut sums = VertexSums { side, accumulator: vec![Vec3::ZERO; count], counter: vec![0; count] };
    for (leaf, value) in leaves.iter().zip(radiosity) {
        for p in leaf.corners(tree.shape(), height) {
            let i = (p.y * side + p.x) as usize;
            sums.accumulator[i] += *value;
            sums.counter[i] += 1;
        }
    }
    sums
}

impl VertexSums {
    /// Mean radiosity at every vertex (Program 5.11), open where no leaf has one.
    pub fn average(&self) -> Gaps {
        let mean = |(sum, count): (&Vec3, &u32)| (*count > 0).then(|| *sum / *count as f32);
        Gaps { side: self.side, texels: self.accumulator.iter().zip(&self.counter).map(mean).collect() }
    }
}

/// Fills the texels inside leaves and on their edges from their corners, bilinearly or, in a triangle,
/// linearly; the finest leaves first, so that an edge with T-vertices follows its finer side.
///
/// # Panics
/// If the texture is another tree's, or a corner of a leaf is open.
pub fn fill_first_order(tree: &Quadtree, texture: &Gaps) -> RadiosityTexture {
    let (shape, height) = (tree.shape(), tree.height());
    let side = (1u32 << height) + 1;
    assert_eq!(texture.side, side, "the texture of another tree");
    let mut open = texture.texels.clone();
    let mut leaves = tree.leaves();
    leaves.sort_by_key(|leaf| std::cmp::Reverse(leaf.level));
    for leaf in leaves {
        let span = leaf.span(height);
        let corners: Vec<Vec3> = leaf
            .corners(shape, height)
            .map(|p| texture.texels[(p.y * side + p.x) as usize].expect("a radiosity at every corner"))
            .collect();
        for b in 0..=span {
            for a in 0..=if shape == Shape::Triangle { span - b } else { span } {
                let (s, t) = (a as f32 / span as f32, b as f32 / span as f32);
                let (p, value) = match (shape, leaf.inverted) {
                    (Shape::Quadrilateral, _) => (
                        UVec2::new(leaf.u * span + a, leaf.v * span + b),
                        corners[0].lerp(corners[1], s).lerp(corners[3].lerp(corners[2], s), t),
                    ),
                    (Shape::Triangle, inverted) => (
                        if inverted {
                            UVec2::new((leaf.u + 1) * span - a, (leaf.v + 1) * span - b)
                        } else {
                            UVec2::new(leaf.u * span + a, leaf.v * span + b)
                        },
                        corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t,
                    ),
                };
                open[(p.y * side + p.x) as usize].get_or_insert(value);
            }
        }
    }
    let mut pixels: Vec<Vec3> = open.into_iter().map(Option::unwrap_or_default).collect();
    if shape == Shape::Triangle {
        triangle::continue_beyond_diagonal(&mut pixels, side as usize, false);
    }
    RadiosityTexture::at_vertices(LinearImage { width: side, height: side, pixels })
}
