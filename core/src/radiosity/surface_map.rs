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

use super::{
    RadiosityError,
    charts::{Region, alone, regions},
    lookup::{ElementBlend, SideMap, blend},
};
use crate::scene::{direct::Receiver, geometry::Geometry};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Node outside its region, or at the rim of what stands on it: not solved, filled from its neighbours.
pub const UNSOLVED: u32 = 1;

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
    /// 0 or [`UNSOLVED`].
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
    /// [`FOOTPRINT`] points an element, spread over the area it stands for.
    pub footprints: Vec<Receiver>,
    /// Spacing it was built with, m.
    pub spacing_m: f32,
}

/// Points that stand for an element's area.
pub const FOOTPRINT: usize = 8;

/// Spacing on the bodies of lamps, as a share of the spacing elsewhere.
const LAMP_FINENESS: f32 = 0.25;

/// Elements across the bounding diagonal where no spacing is given and the number of nodes allows it.
const ACROSS: f32 = 100.0;

/// Elements that a spacing chosen from the scene aims to stay below.
const WANTED_ELEMENTS: usize = 50_000;
/// Elements above which a scene is refused.
const MOST_ELEMENTS: usize = 4_000_000;

impl SurfaceMap {
    /// Lays out the elements of a scene, `spacing_m` apart; without one the spacing is chosen: a
    /// hundredth of the bounding diagonal, larger where that gives more than 50,000 nodes.
    ///
    /// # Errors
    /// [`RadiosityError::BadSpacing`], [`RadiosityError::TooManyElements`].
    pub fn new(geometry: &Geometry, spacing_m: Option<f32>) -> Result<Self, RadiosityError> {
        let (flat, mut curved) = faces(geometry);
        let spacing = match spacing_m {
            Some(spacing) if spacing > 0.0 && spacing.is_finite() => spacing,
            Some(spacing_m) => return Err(RadiosityError::BadSpacing { spacing_m }),
            None => chosen_spacing(geometry, &flat, finite_diagonal(geometry)),
        };
        let wanted = grid_nodes(geometry, &flat, spacing);
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
        curved.retain(|&t| {
            let region = fine[geometry.object[t as usize] as usize].then(|| alone(geometry, t));
            let refined = region.filter(|r| r.extent.max_element() > LAMP_FINENESS * spacing);
            if let Some(region) = &refined {
                map.add_grid(geometry, region, region.nodes(LAMP_FINENESS * spacing));
            }
            refined.is_none()
        });
        for region in &flat {
            let on_lamp = fine[geometry.object[region.triangles[0] as usize] as usize];
            let [nx, ny] = region.nodes(if on_lamp { LAMP_FINENESS * spacing } else { spacing });
            if nx * ny == 1 {
                curved.extend(&region.triangles);
            } else {
                map.add_grid(geometry, region, [nx, ny]);
            }
        }
        map.add_vertices(geometry, &curved);
        map.weigh(geometry);
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
    }

    fn add_grid(&mut self, geometry: &Geometry, region: &Region, [nx, ny]: [u32; 2]) {
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
        let mut nodes = Vec::with_capacity((nx * ny) as usize);
        for y in 0..ny {
            for x in 0..nx {
                let border = Vec2::splat(inset).min(0.5 * region.extent);
                let wanted = place(x, y).clamp(border, region.extent - border);
                let (inside, distance) = region.nearest_inside(&corners, wanted, inset);
                let flags = if distance > 1.01 * step.length() + 2.0 * inset { UNSOLVED } else { 0 };
                nodes.push((region.point(inside), flags));
            }
        }
        let sides = if geometry.material_of(first_triangle).double_sided { 2 } else { 1 };
        for back in 0..sides {
            let normal = if back == 0 { region.normal } else { -region.normal };
            let (chart, first) = (self.charts.len() as u32, self.elements.len() as u32);
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

    /// The points that stand for an element's area.
    pub fn footprint(&self, element: usize) -> &[Receiver] {
        &self.footprints[element * FOOTPRINT..][..FOOTPRINT]
    }

    /// Areas, mean reflectances and footprints, by points spread over every triangle.
    fn weigh(&mut self, geometry: &Geometry) {
        let mut weighted = vec![Vec3::ZERO; self.elements.len()];
        let mut points: Vec<Receiver> = Vec::new();
        let mut shares: Vec<(u32, f32, u32)> = Vec::new();
        let mut counts = vec![0u32; self.elements.len() + 1];
        for t in 0..geometry.len() as u32 {
            let area = 0.5 * geometry.area_normal(t).length();
            let textured = geometry.material_of(t).reflectance_texture.is_some();
            let taps = if textured { 4.0 } else { 3.0 };
            let barycentric = triangle_points(edges_in_nodes(&self.sides[2 * t as usize]).map(|e| taps * e));
            for back in [false, true] {
                let side = self.sides[2 * t as usize + usize::from(back)];
                if side == SideMap::NONE {
                    continue;
                }
                let share = area / barycentric.len() as f32;
                let towards = geometry.area_normal(t) * if back { 1.0 } else { -1.0 };
                for &barycentric in &barycentric {
                    let surface = geometry.surface(t, barycentric, towards);
                    let reflectance = geometry.material_of(t).diffuse_at(surface.uv, &geometry.textures);
                    let blend = blend(&side, barycentric);
                    for (&element, &weight) in blend.elements.iter().zip(&blend.weights) {
                        if weight > 0.0 {
                            self.elements[element as usize].area += share * weight;
                            weighted[element as usize] += reflectance * (share * weight);
                            counts[element as usize + 1] += 1;
                            shares.push((element, share * weight, points.len() as u32));
                        }
                    }
                    points.push(Receiver {
                        position: surface.position,
                        normal: surface.normal,
                        geometric_normal: surface.geometric_normal,
                    });
                }
            }
        }
        for (element, sum) in self.elements.iter_mut().zip(weighted) {
            element.reflectance = if element.area > 0.0 { sum / element.area } else { Vec3::ZERO };
        }
        self.footprints = self
            .elements
            .iter()
            .flat_map(|e| {
                let own =
                    Receiver { position: e.position, normal: e.normal, geometric_normal: e.geometric_normal };
                [own; FOOTPRINT]
            })
            .collect();
        // A counting sort by element; points keep the order of their triangles.
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let mut places = counts.clone();
        let mut sorted = vec![(0.0f32, 0u32); shares.len()];
        for (element, share, point) in shares {
            let place = &mut places[element as usize];
            sorted[*place as usize] = (share, point);
            *place += 1;
        }
        for (element, range) in counts.windows(2).enumerate() {
            let of_one = &sorted[range[0] as usize..range[1] as usize];
            let step = of_one.iter().map(|(share, _)| share).sum::<f32>() / FOOTPRINT as f32;
            let (mut passed, mut k) = (0.0, 0);
            for &(share, point) in of_one {
                passed += share;
                while k < FOOTPRINT && passed >= (k as f32 + 0.5) * step {
                    self.footprints[element * FOOTPRINT + k] = points[point as usize];
                    k += 1;
                }
            }
        }
    }
}

/// Edges of a triangle opposite to corners 0, 1 and 2, in grid steps; 1 for vertex elements.
fn edges_in_nodes(side: &SideMap) -> [f32; 3] {
    if side.size == 0 {
        return [1.0; 3];
    }
    let corner =
        |i: usize| Vec2::new(f32::from_bits(side.corners[2 * i]), f32::from_bits(side.corners[2 * i + 1]));
    [(1, 2), (2, 0), (0, 1)].map(|(i, k)| (corner(i) - corner(k)).abs().max_element())
}

/// Points that stand for equal shares of a triangle's area, as barycentric weights of corners 1 and 2;
/// `taps` wanted along the edges opposite to corners 0, 1 and 2.
///
/// The centroids of the n² equal triangles it splits into; for a sliver, the middles of cells of a square
/// mapped onto it with equal areas, many along it and few across.
fn triangle_points(taps: [f32; 3]) -> Vec<Vec2> {
    const SLIVER: f32 = 4.0;
    let count = |taps: f32| taps.ceil().clamp(2.0, 512.0) as u32;
    let [a, b, c] = taps;
    let (shortest, longest) = (a.min(b).min(c), a.max(b).max(c));
    let n = count(longest);
    if longest > SLIVER * shortest && n > 2 {
        let across = count(shortest);
        let apex = [a, b, c].iter().position(|e| *e == shortest).unwrap_or(0);
        let point = |x: u32, y: u32| {
            let root = ((x as f32 + 0.5) / n as f32).sqrt();
            let next = root * (y as f32 + 0.5) / across as f32;
            let mut weights = [0.0; 3];
            weights[apex] = 1.0 - root;
            weights[(apex + 1) % 3] = root - next;
            weights[(apex + 2) % 3] = next;
            Vec2::new(weights[1], weights[2])
        };
        return (0..n).flat_map(|x| (0..across).map(move |y| point(x, y))).collect();
    }
    let step = 1.0 / n as f32;
    (0..n)
        .flat_map(|y| {
            (0..n - y).flat_map(move |x| {
                let corner = Vec2::new(x as f32, y as f32) * step;
                let upright = Some(corner + Vec2::splat(step / 3.0));
                let inverted = (x + y + 1 < n).then(|| corner + Vec2::splat(step * 2.0 / 3.0));
                upright.into_iter().chain(inverted)
            })
        })
        .collect()
}

/// A cell of a 4×4 grid on the octahedral map of directions.
fn normal_bucket(n: Vec3) -> [i32; 2] {
    let p = n.truncate() / n.abs().element_sum().max(f32::MIN_POSITIVE);
    let folded = (Vec2::ONE - Vec2::new(p.y, p.x).abs()) * Vec2::ONE.copysign(p);
    let square = if n.z < 0.0 { folded } else { p };
    // Half a cell aside, so that axis-aligned normals do not lie on a border.
    (square * 2.0 + Vec2::splat(0.5)).floor().to_array().map(|x| x as i32)
}

fn finite_diagonal(geometry: &Geometry) -> f32 {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for p in geometry.positions.iter().flatten().filter(|p| p.is_finite()) {
        (low, high) = (low.min(*p), high.max(*p));
    }
    let diagonal = (high - low).length();
    if diagonal.is_finite() && diagonal > 0.0 { diagonal } else { 1.0 }
}

/// Which objects are small and emit: their own light falls on them from close by, a strong second
/// source where it is reflected, so their elements are finer.
fn lamp_bodies(geometry: &Geometry, spacing: f32) -> Vec<bool> {
    const MOST_AREA_SPACINGS: f32 = 100.0;
    let body = |range: &std::ops::Range<u32>| {
        let area: f32 = range.clone().map(|t| 0.5 * geometry.area_normal(t).length()).sum();
        area < MOST_AREA_SPACINGS * spacing * spacing
            && range.clone().any(|t| geometry.material_of(t).emission != Vec3::ZERO)
    };
    geometry.object_triangles.iter().map(body).collect()
}

fn grid_nodes(geometry: &Geometry, flat: &[Region], spacing: f32) -> usize {
    flat.iter()
        .map(|r| {
            let sides = if geometry.material_of(r.triangles[0]).double_sided { 2 } else { 1 };
            let [nx, ny] = r.nodes(spacing).map(|n| n as usize);
            if nx * ny == 1 { 0 } else { nx * ny * sides }
        })
        .sum()
}

/// What [`SurfaceMap::new`] will lay out, known before it is laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementLayout {
    /// Distance between grid nodes, m.
    pub spacing_m: f32,
    /// Distance that a hundredth of the bounding diagonal would be, m.
    pub hundredth_m: f32,
    /// Grid nodes on flat faces.
    pub grid_nodes: usize,
    /// Triangles lit at their corners, at most one element for each corner and fewer where corners
    /// are shared.
    pub curved_triangles: usize,
}

impl ElementLayout {
    /// The layout of a scene for a spacing, or for the one chosen from the scene.
    pub fn new(geometry: &Geometry, spacing_m: Option<f32>) -> Self {
        let (flat, curved) = faces(geometry);
        let diagonal = finite_diagonal(geometry);
        let spacing_m = spacing_m.unwrap_or_else(|| chosen_spacing(geometry, &flat, diagonal));
        let single = |r: &&Region| r.nodes(spacing_m) == [1, 1];
        let small: usize = flat.iter().filter(single).map(|r| r.triangles.len()).sum();
        Self {
            spacing_m,
            hundredth_m: diagonal / ACROSS,
            grid_nodes: grid_nodes(geometry, &flat, spacing_m),
            curved_triangles: curved.len() + small,
        }
    }
}

/// Flat regions of every object and material, and the triangles of curved meshes; without triangles
/// that have no area or are not finite.
fn faces(geometry: &Geometry) -> (Vec<Region>, Vec<u32>) {
    let finite = |t: &u32| {
        geometry.positions[*t as usize].iter().all(|p| p.is_finite())
            && geometry.area_normal(*t).length_squared() > 0.0
    };
    let weld = finite_diagonal(geometry) * 1e-6;
    let (mut flat, mut curved) = (Vec::new(), Vec::new());
    for range in &geometry.object_triangles {
        let mut of_object: Vec<u32> = range.clone().filter(finite).collect();
        of_object.sort_by_key(|&t| geometry.material[t as usize]);
        for same in
            of_object.chunk_by(|&a, &b| geometry.material[a as usize] == geometry.material[b as usize])
        {
            let (r, c) = regions(geometry, same, weld);
            flat.extend(r);
            curved.extend(c);
        }
    }
    (flat, curved)
}

fn chosen_spacing(geometry: &Geometry, flat: &[Region], diagonal: f32) -> f32 {
    let mut spacing = diagonal / ACROSS;
    while grid_nodes(geometry, flat, spacing) > WANTED_ELEMENTS && spacing < diagonal {
        spacing *= 1.1;
    }
    spacing
}
