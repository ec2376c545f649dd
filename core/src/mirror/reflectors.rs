//! Flat reflectors, found from materials: coplanar triangles of one polished material on one object.
//!
//! Finely tessellated, a ball is made of facets that are each as good as flat. What tells them from mirrors is how
//! they are joined: where triangles of other planes share a corner and its normal, the surface is bent.

use crate::scene::geometry::Geometry;
use glam::{DVec3, Vec3};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Number of no reflector.
pub const NO_REFLECTOR: u32 = u32::MAX;

/// Reflectors of a scene, at most; the largest are kept.
pub const MOST_REFLECTORS: usize = 256;

/// Width α of a lobe from which on a reflector seen in another is not followed, but shown by the map of the light
/// around it, blurred: roughness 0.2. A narrower one is nearer to its own mirrored view than to so coarse a map.
pub const BLURRED_ALPHA: f32 = 0.04;

/// Sine of the angle between shading normal and plane up to which a triangle counts as flat, if it is not joined
/// smoothly to one of another plane.
const FLAT: f32 = 0.01;

/// Sine of the angle between normals that is left to rounding, in files too: a flat piece with rounded edges has
/// normals as exact as that, a facet of a ball of less than ten million triangles has not.
const ROUNDING: f32 = 2e-4;

/// A flat piece of a polished material.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflector {
    /// Object it belongs to.
    pub object: u32,
    /// Its material.
    pub material: u32,
    /// Unit normal of its front.
    pub normal: Vec3,
    /// Its plane: n·x = `offset`, m.
    pub offset: f32,
    /// Its triangles.
    pub triangles: Vec<u32>,
    /// Area, m².
    pub area: f32,
    /// Whether its back reflects too.
    pub double_sided: bool,
}

impl Reflector {
    /// A point mirrored at its plane (Bastos 1999, Eq. 6.3): x − 2 (n·x − d) n.
    pub fn mirror_point(&self, x: Vec3) -> Vec3 {
        x - 2.0 * (self.normal.dot(x) - self.offset) * self.normal
    }

    /// A direction mirrored at its plane: v − 2 (n·v) n. Eq. 6.4 of Bastos 1999 gives its opposite.
    pub fn mirror_direction(&self, v: Vec3) -> Vec3 {
        v - 2.0 * self.normal.dot(v) * self.normal
    }

    /// The unit normal on the side from which a point sees it reflect, if it does.
    pub fn facing(&self, point: Vec3) -> Option<Vec3> {
        let height = self.normal.dot(point) - self.offset;
        match height {
            h if h > 0.0 => Some(self.normal),
            h if h < 0.0 && self.double_sided => Some(-self.normal),
            _ => None,
        }
    }
}

/// The flat reflectors of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reflectors {
    /// The reflectors, largest first.
    pub list: Vec<Reflector>,
    of_triangle: HashMap<u32, u32>,
    /// Polished triangles that are not flat or belong to none of them.
    pub curved: usize,
    /// Diagonal of the scene's box, m; 0 where nothing is polished.
    pub scene_size: f32,
}

impl Reflectors {
    /// Finds them; costs nothing where no material is polished.
    pub fn new(geometry: &Geometry) -> Self {
        if !geometry.is_specular() {
            return Self::default();
        }
        let (low, high) = geometry.bounds();
        let scene_size = (high - low).length();
        let tolerance = 1e-5 * scene_size.max(f32::MIN_POSITIVE);
        let mut planes: BTreeMap<(u32, u32, [i64; 4]), Vec<u32>> = BTreeMap::new();
        let bent = bent(geometry, low.abs().max(high.abs()).max_element());
        let curved = bent.len();
        for t in 0..geometry.len() as u32 {
            if !geometry.material_of(t).is_specular() || bent.contains(&t) {
                continue;
            }
            let normal = geometry.area_normal(t).normalize_or_zero();
            let offset = normal.dot(geometry.positions[t as usize][0]);
            let part = [geometry.object[t as usize], geometry.material[t as usize]];
            let cells = |v: f32, size: f32| (f64::from(v) / f64::from(size)).round() as i64;
            let key = [normal.x, normal.y, normal.z].map(|c| cells(c, 1e-3));
            let place = cells(offset, 4.0 * tolerance);
            // A plane on the border of two cells is looked for in both.
            let known = [0, -1, 1]
                .map(|step| (part[0], part[1], [key[0], key[1], key[2], place + step]))
                .into_iter()
                .find(|k| planes.contains_key(k));
            let key = known.unwrap_or((part[0], part[1], [key[0], key[1], key[2], place]));
            planes.entry(key).or_default().push(t);
        }
        let mut list: Vec<Reflector> =
            planes.into_iter().map(|((o, m, _), triangles)| reflector(geometry, o, m, triangles)).collect();
        list.sort_by(|a, b| b.area.total_cmp(&a.area).then(a.triangles[0].cmp(&b.triangles[0])));
        let curved = curved + list.iter().skip(MOST_REFLECTORS).map(|r| r.triangles.len()).sum::<usize>();
        list.truncate(MOST_REFLECTORS);
        let numbered = list.iter().enumerate();
        let of_triangle =
            numbered.flat_map(|(i, r)| r.triangles.iter().map(move |&t| (t, i as u32))).collect();
        Self { list, of_triangle, curved, scene_size }
    }

    /// Reflector of a triangle, or [`NO_REFLECTOR`].
    pub fn of(&self, triangle: u32) -> u32 {
        self.of_triangle.get(&triangle).copied().unwrap_or(NO_REFLECTOR)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

/// The polished triangles that are part of a bent surface: whose normals turn away from their plane by [`FLAT`], or
/// by more than rounding where a corner is shared, normal and all, with a triangle of another plane. Coordinates
/// are at most `farthest`, m.
fn bent(geometry: &Geometry, farthest: f32) -> HashSet<u32> {
    let mut bent = HashSet::new();
    let mut doubtful = Vec::new();
    // For each corner of the doubtful the first plane's normal there, and whether another one turns away from it.
    let mut joints: HashMap<CornerKey, (Vec3, bool)> = HashMap::new();
    for t in (0..geometry.len() as u32).filter(|&t| geometry.material_of(t).is_specular()) {
        let area_normal = geometry.area_normal(t);
        let normal = area_normal.normalize_or_zero();
        let normals = &geometry.normals[t as usize];
        let off = |n: &Vec3| if n.dot(normal) > 0.0 { n.cross(normal).length() } else { f32::INFINITY };
        let turned = normals.iter().map(off).fold(0.0, f32::max);
        let corners = &geometry.positions[t as usize];
        let longest = (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3])).fold(0.0, f32::max);
        // Rounded corners tilt a triangle by their rounding over its height.
        let tolerance =
            ROUNDING.max(4.0 * f32::EPSILON * farthest * longest / area_normal.length()).min(FLAT);
        if turned <= tolerance {
            continue;
        }
        // A triangle without area is off by infinity.
        if turned < FLAT {
            doubtful.push(t);
        } else {
            bent.insert(t);
        }
        for key in corner_keys(geometry, t) {
            let joint = joints.entry(key).or_insert((normal, false));
            joint.1 |= joint.0.cross(normal).length() > tolerance;
        }
    }
    let joined = |t: &u32| corner_keys(geometry, *t).iter().any(|key| joints.get(key).is_some_and(|j| j.1));
    bent.extend(doubtful.into_iter().filter(joined));
    bent
}

/// Object, material, place and normal of a corner, to the bit: what smoothly joined triangles share.
type CornerKey = (u32, u32, [[u32; 3]; 2]);

fn corner_keys(geometry: &Geometry, t: u32) -> [CornerKey; 3] {
    let t = t as usize;
    // Plus zero: −0 is 0.
    let bits = |v: Vec3| (v + Vec3::ZERO).to_array().map(f32::to_bits);
    std::array::from_fn(|i| {
        let place = [bits(geometry.positions[t][i]), bits(geometry.normals[t][i])];
        (geometry.object[t], geometry.material[t], place)
    })
}

fn reflector(geometry: &Geometry, object: u32, material: u32, triangles: Vec<u32>) -> Reflector {
    let mut sum = DVec3::ZERO;
    let mut offset = 0.0;
    for &t in &triangles {
        sum += 0.5 * geometry.area_normal(t).as_dvec3();
    }
    let normal = sum.normalize_or_zero();
    for &t in &triangles {
        let corners = geometry.positions[t as usize].map(|p| normal.dot(p.as_dvec3()));
        offset += corners.iter().sum::<f64>() / 3.0;
    }
    Reflector {
        object,
        material,
        normal: normal.as_vec3(),
        offset: (offset / triangles.len() as f64) as f32,
        area: sum.length() as f32,
        double_sided: geometry.materials[material as usize].double_sided,
        triangles,
    }
}
