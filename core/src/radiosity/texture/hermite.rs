//! Stage 1: one smooth function through the samples of any quadtree (Bastos §5.5.3.1).
//!
//! Level by level from the root: every vertex of a level's lattice has its own sample, or the value that the
//! level above gives there. Between the vertices of a level lies a bicubic Hermite patch whose derivatives
//! are differences of that lattice: central inside, one-sided at the border, where the second
//! difference counts only as far as the next one bears it out: beside an undersampled spot it would throw the
//! border cells far off. The last level is
//! the function: it passes through every sample, and because neighbours share the value and derivatives of
//! each vertex it is C¹ inside, across edges and at T-vertices, however unbalanced the tree is.
//! Quadratics come back exactly from full trees of two levels or more.
//!
//! Light is not negative. Derivatives are shortened so that the patches' Bernstein coefficients,
//! f ± f_u/3 ± f_v/3 ± f_uv/9 about each vertex, are not either; a patch lies in their convex hull. The
//! limit is a matter of one vertex, so C¹ and the samples stay. The thesis leaves overshoot to a wider
//! number format.
//!
//! Not quasi-interpolating B-splines: they are smoother, but do not keep the samples. Limit: beside a step
//! the function still overshoots upwards.

use super::{RadiosityTexture, Shape, convert::Gaps, triangle::continue_beyond_diagonal};
use crate::math::image::LinearImage;
use glam::{Vec2, Vec3};

/// A C¹ function over the unit square.
#[derive(Clone, Debug)]
pub struct HermiteSurface {
    side: usize,
    vertices: Vec<Vertex>,
}

/// Value and derivatives at a vertex, by cell.
#[derive(Clone, Copy, Debug, Default)]
struct Vertex {
    value: Vec3,
    u: Vec3,
    v: Vec3,
    uv: Vec3,
}

impl HermiteSurface {
    /// The function through `samples` at the corners of the leaves of a tree over `shape`, as
    /// [`super::convert::VertexSums::average`] gives them.
    ///
    /// # Panics
    /// If the samples are no lattice of a tree's level or a corner of the root is open.
    pub fn new(shape: Shape, samples: &Gaps) -> Self {
        let height = (samples.side - 1).ilog2();
        assert_eq!(samples.side, (1 << height) + 1, "not the samples of a tree");
        let triangle = shape == Shape::Triangle;
        let mut above: Option<Self> = None;
        for level in 0..=height {
            let (cells, span) = (1usize << level, 1usize << (height - level));
            let side = cells + 1;
            let mut values = vec![Vec3::ZERO; side * side];
            for j in 0..side {
                for i in 0..if triangle { side - j } else { side } {
                    let sample = samples.texels[j * span * samples.side as usize + i * span];
                    values[j * side + i] = match (sample, &above) {
                        (Some(sample), _) => sample,
                        (None, Some(above)) => above.in_cells(Vec2::new(i as f32, j as f32) * 0.5),
                        (None, None) => panic!("no sample at corner ({i}, {j}) of the root"),
                    };
                }
            }
            if triangle {
                continue_beyond_diagonal(&mut values, side, true);
                for v in &mut values {
                    *v = v.max(Vec3::ZERO);
                }
            }
            above = Some(Self::through(&values, side));
        }
        above.unwrap_or(Self { side: 0, vertices: Vec::new() })
    }

    /// The function through a lattice of `side`² values over the unit square.
    ///
    /// # Panics
    /// If there are fewer than 2 × 2 or not `side`² values.
    pub fn through(values: &[Vec3], side: usize) -> Self {
        assert!(side > 1 && values.len() == side * side, "{} values, {side} a side", values.len());
        let along_u = differences(values, side, 1);
        let along_v = differences(values, side, side);
        let mixed = differences(&along_u, side, side);
        let vertices = (0..values.len())
            .map(|i| Vertex { value: values[i], u: along_u[i], v: along_v[i], uv: mixed[i] }.limited());
        Self { side, vertices: vertices.collect() }
    }

    /// Value at a point of the unit square; outside, of the nearest point in it.
    pub fn at(&self, uv: Vec2) -> Vec3 {
        self.in_cells(uv * (self.side - 1) as f32)
    }

    /// The function sampled at `side`² points, the outermost on the border.
    ///
    /// # Panics
    /// If `side` is less than 2.
    pub fn resampled(&self, side: u32) -> RadiosityTexture {
        assert!(side > 1, "{side} points a side");
        let scale = (self.side - 1) as f32 / (side - 1) as f32;
        let image =
            LinearImage::from_fn(side, side, |x, y| self.in_cells(Vec2::new(x as f32, y as f32) * scale));
        RadiosityTexture::at_vertices(image)
    }

    fn in_cells(&self, p: Vec2) -> Vec3 {
        let last = (self.side - 2) as f32;
        let p = p.clamp(Vec2::ZERO, Vec2::splat(last + 1.0));
        let cell = p.floor().min(Vec2::splat(last));
        let (a, b) = (basis(p.x - cell.x), basis(p.y - cell.y));
        let (i, j) = (cell.x as usize, cell.y as usize);
        let mut sum = Vec3::ZERO;
        for (dj, b) in b.iter().enumerate() {
            for (di, a) in a.iter().enumerate() {
                let vertex = &self.vertices[(j + dj) * self.side + i + di];
                sum += (vertex.value * a[0] + vertex.u * a[1]) * b[0]
                    + (vertex.v * a[0] + vertex.uv * a[1]) * b[1];
            }
        }
        sum
    }
}

/// Weights of value and derivative at both ends of a cell.
fn basis(t: f32) -> [[f32; 2]; 2] {
    let s = 1.0 - t;
    [[s * s * (1.0 + 2.0 * t), s * s * t], [t * t * (1.0 + 2.0 * s), -t * t * s]]
}

/// Derivatives by cell along the direction in which neighbours are `stride` apart.
fn differences(values: &[Vec3], side: usize, stride: usize) -> Vec<Vec3> {
    (0..values.len())
        .map(|i| {
            let place = i / stride % side;
            if place == 0 {
                end_slope(side, |k| values[i + k * stride])
            } else if place == side - 1 {
                -end_slope(side, |k| values[i - k * stride])
            } else {
                0.5 * (values[i + stride] - values[i - stride])
            }
        })
        .collect()
}

/// Derivative at the first of `count` values: the first difference less half the smaller of the two second
/// differences there; without the second term where they disagree in sign or there is one only.
fn end_slope(count: usize, value: impl Fn(usize) -> Vec3) -> Vec3 {
    let step = value(1) - value(0);
    if count < 4 {
        return step;
    }
    let near = value(2) - 2.0 * value(1) + value(0);
    let next = value(3) - 2.0 * value(2) + value(1);
    let agreed = |c: usize| {
        if near[c] * next[c] > 0.0 { near[c].signum() * near[c].abs().min(next[c].abs()) } else { 0.0 }
    };
    step - 0.5 * Vec3::new(agreed(0), agreed(1), agreed(2))
}

impl Vertex {
    /// Derivatives shortened until no Bernstein coefficient about the vertex is negative.
    fn limited(mut self) -> Self {
        for c in 0..3 {
            let most = 3.0 * self.value[c].max(0.0);
            let slope = self.u[c].abs() + self.v[c].abs();
            if slope > most {
                self.u[c] *= most / slope;
                self.v[c] *= most / slope;
            }
            let low = 3.0 * (most - (self.u[c] + self.v[c]).abs());
            let high = 3.0 * (most - (self.u[c] - self.v[c]).abs());
            self.uv[c] = self.uv[c].clamp(-low.max(0.0), high.max(0.0));
        }
        self
    }
}
