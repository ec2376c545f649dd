//! Curved reflectors by environment maps, and flat glossy ones where a mirror shows them: the radiance at their
//! place, read along the mirrored direction.
//!
//! A flat reflector has one mirrored view, a curved one has none; and what a mirrored view shows of a flat glossy
//! one is not blurred. What such a reflector shows is taken from the light around
//! its middle, as a radiance sphere holds it (Bastos 1999, §8.2.1 proposes environment maps for it; Blinn and
//! Newell 1976 made the first), blurred beforehand by the lobe (Miller and Hoffman 1984). The light does not
//! come from infinity: with each texel goes the distance of what it shows, and the direction that is looked up
//! is the one from the middle to what the mirrored ray meets, in two steps.
//!
//! Rays are cast once for where the objects stand; when lamps change only their ends are read again.
//!
//! What one map shows of a reflector that has a map is taken from that map, as often as the plan's `glossy_depth`
//! says: the light after n glossy reflections is that of the maps made with n − 1, L_n = Lₑ + L_d + F ⟨L_{n−1}⟩, in
//! which the last reflect as if dull, L_0 = F E / π. No ray is cast for it.
//!
//! Limits: what has one material on one object has one map, of the light in the middle of all its curved parts, each
//! of the sixteen largest flat glossy reflectors has one (how many are left out, [`left_out`] says), and none where that lies within something else, which mirrors
//! then show as if dull; the reflector does not see itself and, moved, shows the map of
//! where it stood; near things shift as if on a sphere of their own distance; a lobe
//! is as wide at every angle as it is at normal incidence, and a lobe's light is not dimmed by its own shadowing.

use crate::{
    irradiance_volume::panorama::{direction, place},
    math::{frame::frame_from_normal, part::Part, random::r2_point},
    mirror::reflectors::{BLURRED_ALPHA, NO_REFLECTOR, Reflectors},
    radiosity::RadiositySolution,
    scene::{
        accel::Ray,
        brdf::{Lobe, Specular},
        file::PlanOverrides,
        geometry::Geometry,
        world::World,
    },
};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::{collections::BTreeMap, f32::consts::FRAC_1_PI, sync::Arc};

/// Reflectors with a map, at most: the largest flat ones, for the others the largest curved ones.
pub const MOST_MAPS: usize = 32;

/// Flat reflectors with a map, at most: they are seen in mirrors alone, but have nothing else to be seen by there.
const MOST_FLAT_MAPS: usize = 16;

/// Rows of the map of an ideal mirror, of a curved reflector with a wider lobe, and of a flat one; columns are
/// twice as many.
const ROWS: [u32; 3] = [128, 64, 32];

/// Mirrors that a ray is followed through.
const MOST_REFLECTIONS: u32 = 8;

/// Directions of a lobe that a texel is the mean of.
pub const LOBE_DIRECTIONS: u32 = 128;

/// Glossy reflections, one seen in the other, that a map holds, if the plan does not say.
pub const GLOSSY_DEPTH: u32 = 2;

/// The same, at most.
pub const MOST_GLOSSY_DEPTH: u32 = 16;

/// Glossy reflections that a plan asks for.
pub fn depth_of(plan: &PlanOverrides) -> u32 {
    plan.glossy_depth.unwrap_or(GLOSSY_DEPTH).clamp(1, MOST_GLOSSY_DEPTH)
}

/// What a ray from the middle of a reflector met.
#[derive(Clone, Copy, Debug)]
struct End {
    triangle: u32,
    barycentric: Vec2,
    direction: Vec3,
    /// What mirrors on the way left of it.
    left: Vec3,
}

/// What a map belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MapOwner {
    /// What is curved of a material on an object.
    Curved {
        /// The object.
        object: u32,
        /// The material.
        material: u32,
    },
    /// A flat reflector.
    Flat {
        /// Its first triangle.
        triangle: u32,
    },
}

/// The light around one reflector.
#[derive(Clone, Debug)]
pub struct Environment {
    /// The reflector.
    pub of: MapOwner,
    /// Where the light was gathered, m.
    pub centre: Vec3,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Radiance in cd/m² and distance in m, row by row from +y, columns from −z to +x.
    pub texels: Vec<Vec4>,
    /// None of an ideal mirror.
    lobe: Option<Lobe>,
    /// For each texel what its ray met, lit or not.
    ends: Arc<Vec<(f32, Option<End>)>>,
}

/// The maps of a scene.
#[derive(Clone, Debug, Default)]
pub struct Environments {
    /// One a reflector.
    pub list: Vec<Environment>,
    /// Number of each triangle's map, where it has one.
    of_triangle: Arc<BTreeMap<u32, u32>>,
    /// Whether one shows a reflector that has another.
    meet: bool,
}

/// A reflector that a map is made for.
struct Mapped {
    of: MapOwner,
    triangles: Vec<u32>,
    area: f32,
    /// None of an ideal mirror.
    lobe: Option<Lobe>,
    /// Normal of the only side that reflects, if it has one.
    side: Option<Vec3>,
}

impl Mapped {
    /// Whether a triangle is the reflector's own; flat parts of what is else curved are.
    fn holds(&self, geometry: &Geometry, triangle: u32) -> bool {
        match self.of {
            MapOwner::Curved { object, material } => {
                let t = triangle as usize;
                (geometry.object[t], geometry.material[t]) == (object, material)
            }
            MapOwner::Flat { .. } => self.triangles.contains(&triangle),
        }
    }
}

impl Environments {
    /// Casts the rays of the largest curved reflectors and reads the light at their ends, after so many glossy
    /// reflections.
    pub fn new(world: &World, radiosity: &RadiositySolution, depth: u32) -> Self {
        let geometry = &world.geometry;
        if !geometry.is_specular() {
            return Self::default();
        }
        let (mapped, _) = mapped(geometry);
        let mut list = Vec::new();
        let mut of_triangle = BTreeMap::new();
        for reflector in mapped {
            let map = Environment::new(world, &reflector);
            if map.is_in_the_open(world, reflector.side) {
                of_triangle.extend(reflector.triangles.iter().map(|&t| (t, list.len() as u32)));
                list.push(map);
            }
        }
        let mut ends =
            list.iter().flat_map(|map: &Environment| map.ends.iter().filter_map(|(_, end)| end.as_ref()));
        let meet = ends.any(|end| of_triangle.contains_key(&end.triangle));
        let traced = Self { list, of_triangle: Arc::new(of_triangle), meet };
        traced.relit(world, radiosity, LOBE_DIRECTIONS, depth)
    }

    /// The same rays under the light of another solution, after so many glossy reflections; a texel is the mean of at
    /// most `directions` of a lobe.
    pub fn relit(&self, world: &World, radiosity: &RadiositySolution, directions: u32, depth: u32) -> Self {
        let after = |before: Option<&Self>| Self {
            list: self.list.iter().map(|e| e.relit(world, radiosity, directions, before)).collect(),
            of_triangle: self.of_triangle.clone(),
            meet: self.meet,
        };
        let more = if self.meet { 1..depth } else { 0..0 };
        more.fold(after(None), |before, _| after(Some(&before)))
    }

    /// The number of the map of a triangle, if it has one.
    pub fn number(&self, triangle: u32) -> Option<u32> {
        self.of_triangle.get(&triangle).copied()
    }
}

/// Reflectors that should have a map and have none, since there are more than [`MOST_MAPS`] or more flat ones than
/// half as many: they look as if they were dull, the flat ones in mirrors alone.
pub fn left_out(geometry: &Geometry) -> usize {
    if geometry.is_specular() { mapped(geometry).1 } else { 0 }
}

/// The reflectors that maps are made for: what is curved, and what is flat and so glossy that it is blurred in
/// mirrors, where there is another reflector to show it. And how many of them there is no room for.
fn mapped(geometry: &Geometry) -> (Vec<Mapped>, usize) {
    let reflectors = Reflectors::new(geometry);
    let lobe_of = |t: u32| geometry.material_of(t).lobe();
    let is_blurred = |t: u32| geometry.material_of(t).alpha().is_some_and(|alpha| alpha >= BLURRED_ALPHA);
    let mut curved: BTreeMap<MapOwner, Mapped> = BTreeMap::new();
    for t in 0..geometry.len() as u32 {
        if !geometry.material_of(t).is_specular() || reflectors.of(t) != NO_REFLECTOR {
            continue;
        }
        let (object, material) = (geometry.object[t as usize], geometry.material[t as usize]);
        let of = MapOwner::Curved { object, material };
        let (lobe, triangles) = (lobe_of(t), Vec::new());
        let found = curved.entry(of).or_insert(Mapped { of, triangles, area: 0.0, lobe, side: None });
        found.area += 0.5 * geometry.area_normal(t).length();
        found.triangles.push(t);
    }
    let mut list: Vec<Mapped> = curved.into_values().collect();
    list.sort_by(|a, b| b.area.total_cmp(&a.area).then(a.of.cmp(&b.of)));
    let flat = reflectors.list.iter().filter(|r| reflectors.list.len() > 1 && is_blurred(r.triangles[0]));
    let flat = flat.map(|r| Mapped {
        of: MapOwner::Flat { triangle: r.triangles[0] },
        triangles: r.triangles.clone(),
        area: r.area,
        lobe: lobe_of(r.triangles[0]),
        side: (!r.double_sided).then_some(r.normal),
    });
    let mut flat: Vec<Mapped> = flat.collect();
    let wanted = list.len() + flat.len();
    flat.truncate(MOST_FLAT_MAPS);
    list.truncate(MOST_MAPS - flat.len());
    list.extend(flat);
    let left_out = wanted - list.len();
    (list, left_out)
}

impl Environment {
    /// Casts the rays of a reflector from the middle of its box.
    fn new(world: &World, reflector: &Mapped) -> Self {
        let corners = reflector.triangles.iter().flat_map(|&t| world.geometry.positions[t as usize]);
        let (low, high) =
            corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        let rows = match reflector.of {
            _ if reflector.lobe.is_none() => ROWS[0],
            MapOwner::Curved { .. } => ROWS[1],
            MapOwner::Flat { .. } => ROWS[2],
        };
        let (centre, size) = (0.5 * (low + high), [2 * rows, rows]);
        let ends = (0..2 * rows * rows)
            .into_par_iter()
            .map(|i| end(world, reflector, Ray::new(centre, texel_direction(i, size))))
            .collect();
        let (of, lobe) = (reflector.of, reflector.lobe);
        Self { of, centre, size, texels: Vec::new(), lobe, ends: Arc::new(ends) }
    }

    /// Whether its middle is not within something else: whether less than half of what the rays met before its
    /// `side`, or all around, is dark backs.
    fn is_in_the_open(&self, world: &World, side: Option<Vec3>) -> bool {
        let lit = |end: &End| {
            let surface = world.geometry.surface(end.triangle, end.barycentric, end.direction);
            world.geometry.is_lit(&surface)
        };
        let before = |i: &usize| side.is_none_or(|n| n.dot(texel_direction(*i as u32, self.size)) > 0.0);
        let (mut rays, mut backs) = (0, 0);
        for i in (0..self.ends.len()).filter(before) {
            rays += 1;
            backs += usize::from(self.ends[i].1.as_ref().is_some_and(|e| !lit(e)));
        }
        2 * backs < rays
    }

    fn relit(
        &self,
        world: &World,
        radiosity: &RadiositySolution,
        directions: u32,
        before: Option<&Environments>,
    ) -> Self {
        let sharp: Vec<Vec4> = self
            .ends
            .par_iter()
            .map(|(distance, end)| {
                end.map_or(Vec3::ZERO, |e| light(world, radiosity, &e, before)).extend(*distance)
            })
            .collect();
        let sharp = Self { texels: sharp, ..self.clone() };
        let Some(lobe) = self.lobe else { return sharp };
        // The lobe seen along the normal, F = 1, turned to each texel.
        let drawn = (0..directions.min(LOBE_DIRECTIONS)).filter_map(|i| {
            let wi = lobe.sample(Vec3::Z, Vec3::Z, r2_point(i, 5))?;
            let weight = lobe.value(Vec3::Z, wi, Vec3::Z) * wi.z / lobe.density(Vec3::Z, wi, Vec3::Z);
            weight.is_finite().then_some((wi, weight))
        });
        let drawn: Vec<(Vec3, f32)> = drawn.collect();
        let total: f32 = drawn.iter().map(|d| d.1).sum();
        let texels = (0..self.texel_count())
            .into_par_iter()
            .map(|i| {
                let frame = frame_from_normal(texel_direction(i, self.size));
                let sum =
                    drawn.iter().fold(Vec4::ZERO, |sum, (wi, w)| sum + sharp.texel_at(frame * *wi) * *w);
                let mean = sum / total;
                mean.truncate().extend(sharp.texels[i as usize].w)
            })
            .collect();
        Self { texels, ..sharp }
    }

    fn texel_count(&self) -> u32 {
        self.size[0] * self.size[1]
    }

    /// Radiance and distance between the texels around a unit direction. Has a twin in
    /// `shaders/glossy/environment.wgsl`, as has [`Self::radiance`].
    fn texel_at(&self, direction: Vec3) -> Vec4 {
        let [w, h] = self.size;
        let Vec2 { x, y } = place(direction) * Vec2::new(w as f32, h as f32) - 0.5;
        let y = y.clamp(0.0, (h - 1) as f32);
        let (column, row) = (x.floor(), (y.floor() as u32).min(h - 2));
        let (fx, fy) = (x - column, y - row as f32);
        let left = (column as i32).rem_euclid(w as i32) as u32;
        let right = (left + 1) % w;
        let at = |x: u32, y: u32| self.texels[(y * w + x) as usize];
        let along = |y: u32| at(left, y).lerp(at(right, y), fx);
        along(row).lerp(along(row + 1), fy)
    }

    /// Radiance and distance of what lies in a unit direction from the middle, cd/m² and m.
    pub fn towards(&self, direction: Vec3) -> Vec4 {
        self.texel_at(direction)
    }

    /// Radiance that arrives at a point of the reflector along −`direction`, the lobe's mean, cd/m².
    pub fn radiance(&self, position: Vec3, direction: Vec3) -> Vec3 {
        let from = position - self.centre;
        let mut along = direction;
        for _ in 0..2 {
            let distance = self.texel_at(along).w;
            let b = from.dot(direction);
            let inside = b * b - from.length_squared() + distance * distance;
            if inside > 0.0 {
                along = (from + direction * (inside.sqrt() - b)).normalize_or(direction);
            }
        }
        self.texel_at(along).truncate()
    }

    /// What the reflector's lobe sends towards `wo`, cd/m²: what it keeps of uniform light times the lobe's mean.
    pub fn reflected(&self, position: Vec3, normal: Vec3, wo: Vec3, specular: &Specular) -> Vec3 {
        let cosine = normal.dot(wo);
        specular.of_uniform_light(cosine) * self.radiance(position, 2.0 * cosine * normal - wo)
    }
}

/// Direction through the middle of a texel.
fn texel_direction(i: u32, [w, h]: [u32; 2]) -> Vec3 {
    direction(Vec2::new((i % w) as f32 + 0.5, (i / w) as f32 + 0.5) / Vec2::new(w as f32, h as f32))
}

/// Where a ray from within a reflector ends, past its own triangles, by way of mirrors and through clear glass; its
/// distance is that to what it met first, or to far away.
fn end(world: &World, from: &Mapped, ray: Ray) -> (f32, Option<End>) {
    const FAR: f32 = 1e6;
    let geometry = &world.geometry;
    let (mut ray, mut left, mut distance) = (ray, Vec3::ONE, None);
    for _ in 0..MOST_REFLECTIONS {
        let hit = loop {
            let Some(hit) = world.accel.trace(&ray) else { return (distance.unwrap_or(FAR), None) };
            if !from.holds(geometry, hit.triangle) {
                break hit;
            }
            ray.t_min = hit.t * (1.0 + 1e-5) + 1e-6;
        };
        distance = distance.or(Some(hit.t));
        let surface = geometry.surface(hit.triangle, hit.barycentric, ray.direction);
        // A coat over something dull is not followed: what lies beneath gives most of the light.
        let brdf = geometry.brdf(&surface);
        if let Some(glass) = brdf.glass.filter(|_| brdf.diffuse == Vec3::ZERO) {
            let passed = glass.pass_or_reflect(&surface, ray.direction);
            (ray, left) = (passed.ray, left * passed.share);
            continue;
        }
        let mirror = brdf.specular.filter(|s| s.is_mirror() && brdf.diffuse == Vec3::ZERO);
        let Some(mirror) = mirror else {
            let (triangle, barycentric, direction) = (hit.triangle, hit.barycentric, ray.direction);
            return (distance.unwrap_or(FAR), Some(End { triangle, barycentric, direction, left }));
        };
        left *= mirror.reflectance(-ray.direction.dot(surface.normal));
        ray = surface.mirrored(ray.direction);
    }
    (distance.unwrap_or(FAR), None)
}

/// Radiance that leaves the end of a ray towards where it came from, cd/m²: emitted, reflected diffusely, and by a
/// lobe from the map of what is met, of those made before, else as if it were as wide as the hemisphere.
fn light(world: &World, radiosity: &RadiositySolution, end: &End, before: Option<&Environments>) -> Vec3 {
    let surface = world.geometry.surface(end.triangle, end.barycentric, end.direction);
    let brdf = world.geometry.brdf(&surface);
    let e = radiosity.irradiance(end.triangle, end.barycentric, surface.back, Part::All);
    let map = before.and_then(|maps| Some(&maps.list[maps.number(end.triangle)? as usize]));
    let lobe = brdf.specular.map_or(Vec3::ZERO, |s| match map {
        Some(map) => map.reflected(surface.position, surface.normal, -end.direction, &s),
        None => s.of_uniform_light(-end.direction.dot(surface.normal)) * e * FRAC_1_PI,
    });
    end.left * (world.geometry.emission(&surface) + brdf.diffuse * e * FRAC_1_PI + lobe)
}
