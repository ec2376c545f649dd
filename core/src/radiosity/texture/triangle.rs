//! The triangle (0, 0), (1, 0), (0, 1) in textures that are square.

use glam::{UVec2, Vec2, Vec3};

/// Gives the vertices with u + v > 1 of a lattice of `side`² values what continues those inside, diagonal by
/// diagonal: f(i, j) = f(i−1, j) + f(i, j−1) − f(i−1, j−1) + D.
///
/// D is the mixed second difference of the nearest cells inside with `curved`, which continues quadratics
/// exactly; 0 without, which continues planes, so that bilinear lookup is linear in each triangle.
///
/// # Panics
/// If there are not `side`² values.
pub fn continue_beyond_diagonal(values: &mut [Vec3], side: usize, curved: bool) {
    assert_eq!(values.len(), side * side, "one value a vertex");
    for sum in side..2 * side - 1 {
        for i in sum + 1 - side..side {
            let j = sum - i;
            let at = |i: usize, j: usize| values[j * side + i];
            let mixed = |i: usize, j: usize| at(i + 1, j + 1) - at(i, j + 1) - at(i + 1, j) + at(i, j);
            let (left, below) = ((i > 1).then(|| mixed(i - 2, j - 1)), (j > 1).then(|| mixed(i - 1, j - 2)));
            let d = match (left, below) {
                _ if !curved => Vec3::ZERO,
                (Some(a), Some(b)) => 0.5 * (a + b),
                (a, b) => a.or(b).unwrap_or(Vec3::ZERO),
            };
            values[j * side + i] = at(i - 1, j) + at(i, j - 1) - at(i - 1, j - 1) + d;
        }
    }
}

/// The texel of a zero-order texture of `side` texels a side that covers point (u, v) of the triangle.
pub fn zero_order_texel(side: u32, at: Vec2) -> UVec2 {
    let n = side as f32;
    let cell = (at * n).floor().clamp(Vec2::ZERO, Vec2::splat(n - 1.0));
    let within = at * n - cell;
    let cell = cell.as_uvec2();
    let inverted = within.element_sum() > 1.0 && cell.element_sum() + 2 <= side;
    if inverted { UVec2::splat(side - 1) - cell } else { cell }
}
