//! A wall of cinder blocks as triangles, made strip by strip and never held whole.
//!
//! Blocks of 390 mm × 190 mm in running bond with 10 mm of recessed mortar; their faces are rough and
//! pitted. A height field: every vertex is the wall's plane moved along its normal by a function of its
//! place alone, so that strips meet exactly and the same wall comes out however it is cut.

use glam::{DVec2, DVec3, Vec3};

/// Block with its share of mortar, m.
const BLOCK: DVec2 = DVec2::new(0.4, 0.2);
/// Width of the mortar, m.
const MORTAR: f64 = 0.01;
/// How far the mortar lies behind the blocks, m.
const RECESS: f64 = 0.006;
/// Roughness of a face, m.
const ROUGHNESS: f64 = 0.002;
/// Depth of a pit, m.
const PIT: f64 = 0.0035;

/// A wall over a rectangle, its front towards `edge_u × edge_v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Corner, m.
    pub corner: DVec3,
    /// First edge, m: along the courses.
    pub edge_u: DVec3,
    /// Second edge, m: up.
    pub edge_v: DVec3,
    /// Quadrilaterals along the first edge.
    pub columns: u32,
    /// Quadrilaterals along the second edge.
    pub rows: u32,
}

/// Some rows of a wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strip {
    /// Positions, m.
    pub positions: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Triangles, counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl Wall {
    /// A wall of at least `polygons` triangles, near squares of two.
    pub fn new(corner: DVec3, edge_u: DVec3, edge_v: DVec3, polygons: u32) -> Self {
        let (u, v) = (edge_u.length(), edge_v.length());
        let edge = (u * v / (0.5 * f64::from(polygons.max(2)))).sqrt();
        let [columns, rows] = [u, v].map(|d| (d / edge).ceil().max(1.0) as u32);
        Self { corner, edge_u, edge_v, columns, rows }
    }

    /// Number of triangles.
    pub fn polygons(&self) -> u32 {
        2 * self.columns * self.rows
    }

    /// The wall from its foot to its top, `rows` rows of quadrilaterals a strip.
    ///
    /// # Panics
    /// If `rows` is 0.
    pub fn strips(&self, rows: u32) -> impl Iterator<Item = Strip> + '_ {
        assert!(rows > 0, "a strip has at least one row");
        (0..self.rows).step_by(rows as usize).map(move |first| self.strip(first, rows.min(self.rows - first)))
    }

    fn strip(&self, first: u32, rows: u32) -> Strip {
        let mut strip = Strip::default();
        for row in first..=first + rows {
            for column in 0..=self.columns {
                let at = DVec2::new(
                    f64::from(column) / f64::from(self.columns) * self.edge_u.length(),
                    f64::from(row) / f64::from(self.rows) * self.edge_v.length(),
                );
                let (position, normal) = self.vertex(at);
                strip.positions.push(position.as_vec3());
                strip.normals.push(normal.as_vec3());
            }
        }
        let width = self.columns + 1;
        for row in 0..rows {
            for column in 0..self.columns {
                let a = row * width + column;
                strip.triangles.extend([[a, a + 1, a + width + 1], [a, a + width + 1, a + width]]);
            }
        }
        strip
    }

    /// Position and unit normal at a place on the wall, m along its edges.
    fn vertex(&self, at: DVec2) -> (DVec3, DVec3) {
        const STEP: f64 = 1e-3;
        let [u, v] = [self.edge_u, self.edge_v].map(DVec3::normalize);
        let out = u.cross(v);
        let slope = |step: DVec2| (height(at + step) - height(at - step)) / (2.0 * STEP);
        let normal = out - u * slope(DVec2::X * STEP) - v * slope(DVec2::Y * STEP);
        (self.corner + u * at.x + v * at.y + out * height(at), normal.normalize())
    }
}

/// Height of the wall over its plane, m.
pub fn height(at: DVec2) -> f64 {
    let course = (at.y / BLOCK.y).floor();
    let shift = if course.rem_euclid(2.0) == 1.0 { 0.5 * BLOCK.x } else { 0.0 };
    let x = at.x + shift;
    let inside = DVec2::new(x.rem_euclid(BLOCK.x), at.y.rem_euclid(BLOCK.y));
    // Distance from the nearest joint's middle.
    let joint = inside.min(BLOCK - inside).min_element();
    let face = ((joint - 0.5 * MORTAR) / 0.005).clamp(0.0, 1.0);
    let face = face * face * (3.0 - 2.0 * face);
    // No two blocks stand out alike.
    let proud = 0.0015 * (noise(DVec2::new((x / BLOCK.x).floor(), course) + 0.5, 1) - 0.5);
    let rough = ROUGHNESS * (noise(at * 60.0, 2) + 0.5 * noise(at * 140.0, 3) - 0.75);
    let pit = PIT * ((noise(at * 45.0, 4) - 0.72) * 6.0).clamp(0.0, 1.0);
    let mortar = -RECESS + 0.4 * ROUGHNESS * noise(at * 90.0, 5);
    mortar + face * (proud + rough - pit - mortar)
}

/// Smooth noise in [0, 1] with about one bump a unit.
fn noise(at: DVec2, seed: u32) -> f64 {
    let cell = at.floor();
    let f = at - cell;
    let f = f * f * (DVec2::splat(3.0) - 2.0 * f);
    let corner = |dx: f64, dy: f64| value((cell.x + dx) as i32, (cell.y + dy) as i32, seed);
    let (low, high) = (
        corner(0.0, 0.0) * (1.0 - f.x) + corner(1.0, 0.0) * f.x,
        corner(0.0, 1.0) * (1.0 - f.x) + corner(1.0, 1.0) * f.x,
    );
    low * (1.0 - f.y) + high * f.y
}

/// A well-mixed number in [0, 1) of a cell.
fn value(x: i32, y: i32, seed: u32) -> f64 {
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77) ^ (seed << 20);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    f64::from((h ^ (h >> 15)) >> 8) / 16_777_216.0
}
