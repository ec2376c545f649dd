//! The surface map: every side of every triangle to the elements that carry its light.
//!
//! Flat regions get a grid (`charts`); curved meshes, and flat bits much smaller than the
//! spacing, get *vertex elements*: corners of one object and material that lie within half a
//! spacing and face the same way share one. So the number of elements follows the area of a scene,
//! not its number of triangles. Not a lightmap atlas: nothing here needs unique texture coordinates.
//!
//! The bodies of lamps get elements four times finer, also where they are curved: their own light
//! falls on them from close by, and what a bright rim reflects matters in the whole room.
//!
//! Limits: a curved triangle much larger than the spacing is only sampled at its corners; a grid
//! cell that a thin wall crosses mixes the light of both sides.

pub use super::layout::ElementLayout;
use super::{
    RadiosityError,
    charts::{Region, alone},
    layout::{chosen_spacing, faces, finite_diagonal, grid_nodes, lamp_bodies},
    lookup::{ElementBlend, SideMap, blend},
    rims::Fills,
    subdivide::{ChartTree, root_and_nodes},
};
use crate::scene::{direct::Receiver, geometry::Geometry};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Node outside its region, or at the rim of what stands on it: not solved, filled from its neighbours.
pub const UNSOLVED: u32 = 1;
/// Node between corners of leaves: not solved, interpolated from them.
pub const INTERPOLATED: u32 = 2;
/// Node outside its region.
pub const OUTSIDE: u32 = 4;

/// Node that sees nothing but what lies upon it: its darkness is that of a place nobody sees.
pub const BURIED: u32 = 8;

/// One element.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Element {
    /// Where its light is gathered, m.
    pub position: Vec3,
    /// Area it stands for, m².
    pub area: f32,
    /// Unit normal that cosines refer to.
    pub normal: Vec3,
    /// [`UNSOLVED`], [`INTERPOLATED`], [`OUTSIDE`], [`BURIED`] or none of them.
    pub flags: u32,
    /// Normal of the plane that rays leave.
    pub geometric_normal: Vec3,
    /// Index into [`SurfaceMap::charts`], or `u32::MAX` for a vertex element.
    pub chart: u32,
    /// Mean diffuse reflectance over its area.
    pub reflectance: Vec3,
    /// Object it belongs to.
    pub object: u32,
}

impl Element {
    /// Its own place as a receiver.
    pub fn receiver(&self) -> Receiver {
        Receiver { position: self.position, normal: self.normal, geometric_normal: self.geometric_normal }
    }

    /// Whether it has light of its own or between that of others on its region.
    pub fn is_shown(&self) -> bool {
        self.flags & UNSOLVED == 0 || self.flags & INTERPOLATED != 0
    }
}

/// A grid of elements on one side of a flat region.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Chart {
    /// Position of node (0, 0), m.
    pub origin: Vec3,
    /// First element; node (x, y) is `first_element + y · nx + x`.
    pub first_element: u32,
    /// From a node to the next along u, m.
    pub step_u: Vec3,
    /// Nodes along u.
    pub nx: u32,
    /// From a node to the next along v, m.
    pub step_v: Vec3,
    /// Nodes along v.
    pub ny: u32,
}

/// Every side of every triangle, mapped to elements.
#[derive(Clone, Debug, Default)]
pub struct SurfaceMap {
    /// Record `2 · triangle + back`.
    pub sides: Vec<SideMap>,
    /// The elements.
    pub elements: Vec<Element>,
    /// The grids.
    pub charts: Vec<Chart>,
    /// The quadtrees of each grid; `None` where every node is solved.
    pub trees: Vec<Option<ChartTree>>,
    /// Level of the coarsest leaf that each element is a corner of; 0 without quadtrees.
    pub levels: Vec<u8>,
    /// Points spread over the area that a solved element stands for.
    pub footprints: Vec<[Receiver; FOOTPRINT]>,
    /// Which of them are each element's; `u32::MAX` where it is not solved.
    pub footprint_of: Vec<u32>,
    /// Spacing it was built with, m.
    pub spacing_m: f32,
}

/// Points that stand for an element's area.
pub const FOOTPRINT: usize = 8;

/// Spacing on the bodies of lamps, as a share of the spacing elsewhere.
const LAMP_FINENESS: f32 = 0.25;

/// Elements above which a scene is refused.
const MOST_ELEMENTS: usize = 4_000_000;

/// Nodes along a grid at most: [`SideMap::size`] has 16 bits for them.
const MOST_ALONG: u32 = 0xFFFF;

impl SurfaceMap {
    /// Lays out the elements of a scene, `spacing_m` apart; without one the spacing is chosen: a
    /// hundredth of the bounding diagonal, larger where that gives more than 50,000 nodes.
    ///
    /// # Errors
    /// [`RadiosityError::BadSpacing`], [`RadiosityError::TooManyElements`], [`RadiosityError::TooLong`].
    pub fn new(geometry: &Geometry, spacing_m: Option<f32>) -> Result<Self, RadiosityError> {
        Self::subdivided(geometry, spacing_m, 0)
    }

    /// The same with quadtrees on flat regions whose roots may be split `levels` times; only their corners are
    /// to be solved as yet. None with 0 levels.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn subdivided(
        geometry: &Geometry,
        spacing_m: Option<f32>,
        levels: u8,
    ) -> Result<Self, RadiosityError> {
        let (flat, meshes) = faces(geometry);
        let spacing = match spacing_m {
            Some(spacing) if spacing > 0.0 && spacing.is_finite() => spacing,
            Some(spacing_m) => return Err(RadiosityError::BadSpacing { spacing_m }),
            None => chosen_spacing(geometry, &flat, finite_diagonal(geometry)),
        };
        let wanted = grid_nodes(geometry, &flat, spacing).saturating_mul(1 << (2 * levels));
        if wanted > MOST_ELEMENTS {
            return Err(RadiosityError::TooManyElements {
                elements: wanted,
                most: MOST_ELEMENTS,
                spacing_m: spacing,
            });
        }
        let mut map =
            Self { sides: vec![SideMap::NONE; 2 * geometry.len()], spacing_m: spacing, ..Self::default() };
        let fine = lamp_bodies(geometry, spacing);
        let mut curved = Vec::with_capacity(meshes.len());
        for t in meshes {
            let region = fine[geometry.object[t as usize] as usize].then(|| alone(geometry, t));
            match region.filter(|r| r.extent.max_element() > LAMP_FINENESS * spacing) {
                Some(region) => {
                    map.add_grid(geometry, &region, region.nodes(LAMP_FINENESS * spacing), None)?;
                }
                None => curved.push(t),
            }
        }
        for region in &flat {
            let on_lamp = fine[geometry.object[region.triangles[0] as usize] as usize];
            let [nx, ny] = region.nodes(if on_lamp { LAMP_FINENESS * spacing } else { spacing });
            if [nx, ny] == [1, 1] {
                curved.extend(&region.triangles);
            } else if levels > 0 && !on_lamp {
                let [u, v] = [nx, ny].map(|n| root_and_nodes(n, levels));
                map.add_grid(geometry, region, [u.1, v.1], Some([u.0, v.0]))?;
            } else {
                map.add_grid(geometry, region, [nx, ny], None)?;
            }
        }
        map.add_vertices(geometry, &curved);
        map.mark_nodes();
        map.weigh(geometry, &Fills::default());
        Ok(map)
    }

    /// Elements and weights at a point of a triangle's side; all weights zero where there are none.
    pub fn blend(&self, triangle: u32, barycentric: Vec2, back: bool) -> ElementBlend {
        match self.sides.get(2 * triangle as usize + usize::from(back)) {
            Some(side) => blend(side, barycentric),
            None => ElementBlend::default(),
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.sides[..])
            + size_of_val(&self.elements[..])
            + size_of_val(&self.charts[..])
            + size_of_val(&self.footprints[..])
            + size_of_val(&self.footprint_of[..])
            + size_of_val(&self.levels[..])
            + self.trees.iter().flatten().map(ChartTree::bytes).sum::<usize>()
    }

    fn add_grid(
        &mut self,
        geometry: &Geometry,
        region: &Region,
        [nx, ny]: [u32; 2],
        root: Option<[u32; 2]>,
    ) -> Result<(), RadiosityError> {
        let (elements, spacing_m) = (nx as usize * ny as usize, self.spacing_m);
        if nx.max(ny) > MOST_ALONG {
            return Err(RadiosityError::TooLong { nodes: nx.max(ny), most: MOST_ALONG, spacing_m });
        }
        if elements > MOST_ELEMENTS {
            return Err(RadiosityError::TooManyElements { elements, most: MOST_ELEMENTS, spacing_m });
        }
        let first_triangle = region.triangles[0];
        let object = geometry.object[first_triangle as usize];
        let corners: Vec<[Vec2; 3]> = region
            .triangles
            .iter()
            .map(|&t| geometry.positions[t as usize].map(|p| region.plane_coordinates(p)))
            .collect();
        let cells = Vec2::new(nx.max(2) as f32 - 1.0, ny.max(2) as f32 - 1.0);
        let step = region.extent / cells;
        let single = [nx == 1, ny == 1];
        let inset = (0.2 * self.spacing_m).min(0.2 * region.extent.min_element());
        let place = |x: u32, y: u32| {
            let q = Vec2::new(x as f32, y as f32) * step;
            let middle = 0.5 * region.extent;
            Vec2::new(if single[0] { middle.x } else { q.x }, if single[1] { middle.y } else { q.y })
        };
        let mut nodes = Vec::with_capacity(elements);
        for y in 0..ny {
            for x in 0..nx {
                let border = Vec2::splat(inset).min(0.5 * region.extent);
                let wanted = place(x, y).clamp(border, region.extent - border);
                let (inside, distance) = region.nearest_inside(&corners, wanted, inset);
                let flags =
                    if distance > 1.01 * step.length() + 2.0 * inset { UNSOLVED | OUTSIDE } else { 0 };
                nodes.push((region.point(inside), flags));
            }
        }
        let sides = if geometry.material_of(first_triangle).double_sided { 2 } else { 1 };
        for back in 0..sides {
            let normal = if back == 0 { region.normal } else { -region.normal };
            let (chart, first) = (self.charts.len() as u32, self.elements.len() as u32);
            self.trees.push(root.map(|root| ChartTree::new(root, [nx, ny])));
            self.charts.push(Chart {
                origin: region.point(place(0, 0)),
                first_element: first,
                step_u: region.axes[0] * step.x,
                nx,
                step_v: region.axes[1] * step.y,
                ny,
            });
            self.elements.extend(nodes.iter().map(|&(position, flags)| Element {
                position,
                normal,
                geometric_normal: normal,
                flags,
                chart,
                object,
                ..Element::default()
            }));
            for (&t, corners) in region.triangles.iter().zip(&corners) {
                let grid = corners.map(|q| {
                    let g = q / step;
                    Vec2::new(if single[0] { 0.0 } else { g.x }, if single[1] { 0.0 } else { g.y })
                });
                self.sides[2 * t as usize + back] = SideMap::grid(first, nx, ny, grid);
            }
        }
        Ok(())
    }

    /// One element for the corners of an object and material that share a cell of half a spacing
    /// and an octant-sized bucket of normals.
    fn add_vertices(&mut self, geometry: &Geometry, triangles: &[u32]) {
        type Key = (u32, u32, bool, [i64; 3], [i32; 2]);
        let mut found: HashMap<Key, u32> = HashMap::new();
        let cell = 0.5 * self.spacing_m;
        let first = self.elements.len();
        for &t in triangles {
            let i = t as usize;
            let front = geometry.area_normal(t).normalize_or(Vec3::Y);
            let [a, b, c] = geometry.positions[i];
            let centroid = (a + b + c) / 3.0;
            let sides = if geometry.material_of(t).double_sided { 2 } else { 1 };
            for back in 0..sides {
                let sign = if back == 0 { 1.0 } else { -1.0 };
                let mut ids = [0; 3];
                for (corner, id) in ids.iter_mut().enumerate() {
                    let p = geometry.positions[i][corner];
                    let shading = geometry.normals[i][corner];
                    let shading = if shading.dot(front) > 0.2 { shading } else { front };
                    let key = (
                        geometry.object[i],
                        geometry.material[i],
                        back == 1,
                        (p / cell).floor().to_array().map(|x| x as i64),
                        normal_bucket(shading),
                    );
                    *id = *found.entry(key).or_insert_with(|| {
                        self.elements.push(Element {
                            position: p.lerp(centroid, 0.15),
                            geometric_normal: front * sign,
                            chart: u32::MAX,
                            object: geometry.object[i],
                            ..Element::default()
                        });
                        self.elements.len() as u32 - 1
                    });
                    self.elements[*id as usize].normal += shading * sign;
                }
                self.sides[2 * i + back] = SideMap::vertices(ids);
            }
        }
        for element in &mut self.elements[first..] {
            element.normal = element.normal.normalize_or(element.geometric_normal);
        }
    }

    /// Grid steps along u and v from a solved node of a chart to the next one on its coarser side.
    pub fn stride(&self, chart: usize, element: usize) -> [usize; 2] {
        let tree = self.trees[chart].as_ref();
        tree.map_or([1; 2], |tree| tree.span(self.levels[element]).map(|span| span as usize))
    }
}

/// A cell of a 4×4 grid on the octahedral map of directions.
fn normal_bucket(n: Vec3) -> [i32; 2] {
    let p = n.truncate() / n.abs().element_sum().max(f32::MIN_POSITIVE);
    let folded = (Vec2::ONE - Vec2::new(p.y, p.x).abs()) * Vec2::ONE.copysign(p);
    let square = if n.z < 0.0 { folded } else { p };
    // Half a cell aside, so that axis-aligned normals do not lie on a border.
    (square * 2.0 + Vec2::splat(0.5)).floor().to_array().map(|x| x as i32)
}
