//! Triangle meshes in object space.

use glam::{Vec2, Vec3};

/// Indexed triangles; `normals` and `uvs` have one entry a position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, m.
    pub positions: Vec<Vec3>,
    /// Unit shading normals.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v down as in glTF; zero where the file has none.
    pub uvs: Vec<Vec2>,
    /// The set that lightmaps use, one entry a position; empty where the file has no second set and `uvs` serves.
    pub lightmap_uvs: Vec<Vec2>,
    /// Counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A planar quadrilateral with corners in counter-clockwise order from the front.
    pub fn quad(corners: [Vec3; 4]) -> Self {
        let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalize_or_zero();
        Self {
            positions: corners.to_vec(),
            normals: vec![normal; 4],
            uvs: vec![Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0), Vec2::new(0.0, 0.0)],
            lightmap_uvs: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// Corners of one triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }
}
