//! Triangle shapes the scenes are built from, in metres, y up, wound counter-clockwise from outside.
//!
//! Flat faces stay single quadrilaterals and round things are moderately fine: the solvers subdivide
//! large faces themselves, and a finer mesh than the eye needs costs them elements.

pub mod boxes;
pub mod round;

use glam::{DAffine3, DMat3, DVec2, DVec3};

/// Shorthand for a point or direction.
pub fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Indexed triangles with a normal and a texture coordinate for each position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// Positions, m.
    pub positions: Vec<DVec3>,
    /// Unit shading normals.
    pub normals: Vec<DVec3>,
    /// Texture coordinates, v down; all zero means none.
    pub uvs: Vec<DVec2>,
    /// Counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// Adds a vertex without texture coordinates and gives its index.
    pub fn vertex(&mut self, position: DVec3, normal: DVec3) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(DVec2::ZERO);
        self.positions.len() as u32 - 1
    }

    /// Appends another shape.
    pub fn add(&mut self, other: &Shape) {
        let first = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.uvs.extend(&other.uvs);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
    }

    /// The shapes together.
    pub fn join(shapes: impl IntoIterator<Item = Shape>) -> Shape {
        let mut all = Shape::default();
        for shape in shapes {
            all.add(&shape);
        }
        all
    }

    /// Moved by an offset.
    pub fn moved(mut self, offset: DVec3) -> Self {
        self.positions.iter_mut().for_each(|p| *p += offset);
        self
    }

    /// Placed by a rotation and an offset.
    pub fn placed(mut self, rotation: DMat3, offset: DVec3) -> Self {
        let placement = DAffine3::from_mat3_translation(rotation, offset);
        self.positions.iter_mut().for_each(|p| *p = placement.transform_point3(*p));
        self.normals.iter_mut().for_each(|n| *n = rotation * *n);
        self
    }

    /// Turned about the y axis, counter-clockwise from above.
    pub fn turned_y(self, degrees: f64) -> Self {
        self.placed(DMat3::from_rotation_y(degrees.to_radians()), DVec3::ZERO)
    }

    /// Every position replaced, with normals made smooth again over shared vertices.
    pub fn warped(mut self, warp: impl Fn(DVec3) -> DVec3) -> Self {
        self.positions.iter_mut().for_each(|p| *p = warp(*p));
        self.smooth()
    }

    /// Normals as the area-weighted mean over the triangles at each vertex.
    pub fn smooth(mut self) -> Self {
        self.normals.fill(DVec3::ZERO);
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| self.positions[i as usize]);
            let area_normal = (b - a).cross(c - a);
            for &i in t {
                self.normals[i as usize] += area_normal;
            }
        }
        self.normals.iter_mut().for_each(|n| *n = n.normalize_or(DVec3::Y));
        self
    }

    /// Without the vertices that no triangle uses.
    pub fn compact(self) -> Self {
        let mut renumbered = vec![None; self.positions.len()];
        let mut out = Self::default();
        for t in &self.triangles {
            let t = t.map(|i| {
                *renumbered[i as usize].get_or_insert_with(|| {
                    let new = out.vertex(self.positions[i as usize], self.normals[i as usize]);
                    out.uvs[new as usize] = self.uvs[i as usize];
                    new
                })
            });
            out.triangles.push(t);
        }
        out
    }

    /// With vertices merged that are the same to the last bit once rounded to `f32`.
    pub fn welded(self) -> Self {
        let mut known = std::collections::HashMap::new();
        let mut out = Self::default();
        let bits = |v: &[f64]| v.iter().map(|x| (*x as f32).to_bits()).collect::<Vec<_>>();
        let numbers: Vec<u32> = (0..self.positions.len())
            .map(|i| {
                let (p, n, uv) = (self.positions[i], self.normals[i], self.uvs[i]);
                let key = [bits(&p.to_array()), bits(&n.to_array()), bits(&uv.to_array())].concat();
                *known.entry(key).or_insert_with(|| {
                    let new = out.vertex(p, n);
                    out.uvs[new as usize] = uv;
                    new
                })
            })
            .collect();
        out.triangles = self.triangles.iter().map(|t| t.map(|i| numbers[i as usize])).collect();
        out
    }

    /// Turned inside out.
    pub fn inverted(mut self) -> Self {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self.normals.iter_mut().for_each(|n| *n = -*n);
        self
    }
}
