//! Whether a triangle reaches into a box: the separating axis test.

use glam::Vec3;

/// Whether a triangle and the box with centre `centre` and half edges `half` share a point.
///
/// Thirteen candidate axes: three of the box, the triangle's normal, nine edge products
/// (Akenine-Möller 2001). Touching counts as sharing.
pub fn triangle_meets_box(triangle: [Vec3; 3], centre: Vec3, half: Vec3) -> bool {
    let v = triangle.map(|p| p - centre);
    let separates = |axis: Vec3| {
        let p = v.map(|q| q.dot(axis));
        let reach = half.dot(axis.abs());
        p[0].min(p[1]).min(p[2]) > reach || p[0].max(p[1]).max(p[2]) < -reach
    };
    let edges = [v[1] - v[0], v[2] - v[1], v[0] - v[2]];
    !(Vec3::AXES.into_iter().any(separates)
        || separates(edges[0].cross(edges[1]))
        || edges.iter().any(|e| Vec3::AXES.into_iter().any(|a| separates(a.cross(*e)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_whose_bounds_meet_the_box_may_still_miss_it() {
        let half = Vec3::splat(1.0);
        let plane = |d: f32| [Vec3::new(d, 0.0, 0.0), Vec3::new(0.0, d, 0.0), Vec3::new(0.0, 0.0, d)];
        assert!(triangle_meets_box(plane(2.9), Vec3::ZERO, half));
        assert!(!triangle_meets_box(plane(3.1), Vec3::ZERO, half));
        let large = plane(2.0).map(|p| p * 100.0 - Vec3::splat(66.0));
        assert!(triangle_meets_box(large, Vec3::ZERO, half));
        // An edge passing a box edge diagonally: only an edge product separates them.
        let beside = [Vec3::new(2.2, 0.0, 5.0), Vec3::new(0.0, 2.2, 5.0), Vec3::new(1.1, 1.1, -5.0)];
        assert!(!triangle_meets_box(beside, Vec3::ZERO, half));
    }
}
