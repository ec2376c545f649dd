//! Direct light at a sample, as a short list of directions with how much comes from each.
//!
//! Emitters are not left to the radiance bins: a bin is 8° wide at n = 17, and a small luminaire would be
//! missed or counted whole (Greger §4.2.2 names this the one large error). Every emitter is asked by
//! itself instead. A lamp gives one [`Arrival`]; a luminous surface is cut into leaves, each with its
//! exact vector irradiance and one shadow ray. The irradiance of a bin is then
//! Σ weight · max(0, ω·direction), and a lamp that moves touches nobody else's list.

use super::VolumeSettings;
use crate::{
    math::{colour::luminance, random::r2_point},
    scene::{
        accel::{Blockers, Ray},
        emitters::{AreaEmitter, Emitter},
        lamp::LampKind,
        world::World,
    },
};
use glam::{DVec3, IVec2, Vec2, Vec3};
use rayon::prelude::*;

/// Light that reaches a sample from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Unit direction it comes from.
    pub direction: Vec3,
    /// Irradiance on a surface facing it, lx per channel.
    pub normal_irradiance: Vec3,
}

/// What every sample receives from one emitter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrivals {
    /// First entry of each sample, and one past the last.
    pub offsets: Vec<u32>,
    /// The entries, sample by sample.
    pub entries: Vec<Arrival>,
}

impl Arrivals {
    /// Asks one emitter from every position.
    pub fn gather(world: &World, emitter: &Emitter, positions: &[Vec3], settings: &VolumeSettings) -> Self {
        Self::gather_by(world, emitter, positions, &Asking::at_rest(settings))
    }

    /// Asks one emitter from every position, as closely as said.
    pub(super) fn gather_by(world: &World, emitter: &Emitter, positions: &[Vec3], asking: &Asking) -> Self {
        let lists: Vec<Vec<Arrival>> =
            positions.par_iter().map(|&p| arrivals_by(world, emitter, p, asking)).collect();
        let mut offsets = Vec::with_capacity(lists.len() + 1);
        offsets.push(0);
        let mut entries = Vec::with_capacity(lists.iter().map(Vec::len).sum());
        for list in lists {
            entries.extend(list);
            offsets.push(entries.len() as u32);
        }
        Self { offsets, entries }
    }

    /// Adds samples after these.
    pub(super) fn append(&mut self, other: &Self) {
        let first = self.entries.len() as u32;
        self.offsets.extend(other.offsets[1..].iter().map(|offset| first + offset));
        self.entries.extend(&other.entries);
    }

    /// Entries of one sample.
    pub fn of(&self, sample: usize) -> &[Arrival] {
        &self.entries[self.offsets[sample] as usize..self.offsets[sample + 1] as usize]
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.offsets[..]) + size_of_val(&self.entries[..])
    }
}

/// How closely an emitter is asked.
pub(super) struct Asking {
    /// Shadow rays to a luminous surface, at least.
    rays: u32,
    /// Widest leaf, m of edge a metre of distance.
    widest: f32,
    seed: u64,
}

impl Asking {
    /// As the settings have it.
    pub fn at_rest(settings: &VolumeSettings) -> Self {
        Self { rays: settings.direct_samples, widest: WIDEST, seed: settings.seed }
    }

    /// While the emitter is being moved: by a quarter of the leaves and shadow rays. What a leaf in full
    /// view sends stays exact above its horizon; edges of shadows come in steps twice as wide.
    pub fn moving(settings: &VolumeSettings) -> Self {
        Self { rays: settings.direct_samples.div_ceil(4), widest: 2.0 * WIDEST, seed: settings.seed }
    }
}

/// Arrivals from nearly the same direction as one: 20 cells along an axis of the octahedral map, 8° each.
///
/// The vector irradiance stays what it was, so every normal with the whole cell above its horizon gets the
/// same light; it takes two thirds of the arrivals away, whose cosines with all the bins are what a drag
/// waits for.
fn merged(list: Vec<Arrival>) -> Vec<Arrival> {
    const CELLS: f32 = 10.0;
    let cell = |d: Vec3| {
        let p = d.truncate() / d.abs().element_sum();
        let folded = (Vec2::ONE - Vec2::new(p.y, p.x).abs()) * Vec2::ONE.copysign(p);
        ((if d.z < 0.0 { folded } else { p } + Vec2::ONE) * CELLS).as_ivec2()
    };
    let mut cells: Vec<(IVec2, Arrival)> = Vec::with_capacity(list.len());
    let mut of: Vec<usize> = Vec::with_capacity(list.len());
    for arrival in &list {
        let key = cell(arrival.direction);
        let weighted = arrival.direction * luminance(arrival.normal_irradiance);
        let found = cells.iter().position(|c| c.0 == key).unwrap_or_else(|| {
            cells.push((key, Arrival { direction: Vec3::ZERO, normal_irradiance: Vec3::ZERO }));
            cells.len() - 1
        });
        cells[found].1.direction += weighted;
        of.push(found);
    }
    // In the first pass the sum of weighted directions; in the second the direction and what comes from it.
    for (i, (_, merged)) in cells.iter_mut().enumerate() {
        let first = of.iter().position(|&o| o == i).map_or(Vec3::ZERO, |first| list[first].direction);
        merged.direction = merged.direction.normalize_or(first);
    }
    for (arrival, of) in list.iter().zip(of) {
        let merged = &mut cells[of].1;
        merged.normal_irradiance += arrival.normal_irradiance * arrival.direction.dot(merged.direction);
    }
    cells.into_iter().map(|c| c.1).collect()
}

/// Visible light from one emitter at a point in the air.
pub fn arrivals(world: &World, emitter: &Emitter, position: Vec3, settings: &VolumeSettings) -> Vec<Arrival> {
    arrivals_by(world, emitter, position, &Asking::at_rest(settings))
}

fn arrivals_by(world: &World, emitter: &Emitter, position: Vec3, asking: &Asking) -> Vec<Arrival> {
    match emitter {
        Emitter::Lamp { lamp, .. } => {
            let (direction, normal_irradiance, ray) = match lamp.kind {
                LampKind::Directional { illuminance } => {
                    let wi = -lamp.axis();
                    (wi, illuminance * lamp.dimmer, Ray::new(position, wi))
                }
                _ => {
                    let to_lamp = lamp.position() - position;
                    let d2 = to_lamp.length_squared();
                    let wi = to_lamp / d2.sqrt();
                    (wi, lamp.intensity_towards(-wi) / d2, Ray::between(position, lamp.position()))
                }
            };
            if normal_irradiance == Vec3::ZERO || !normal_irradiance.is_finite() {
                return Vec::new();
            }
            let normal_irradiance = normal_irradiance * world.transmittance(&ray);
            if normal_irradiance == Vec3::ZERO {
                Vec::new()
            } else {
                vec![Arrival { direction, normal_irradiance }]
            }
        }
        Emitter::Area(area) if area.radiance == Vec3::ZERO => Vec::new(),
        Emitter::Area(area) if area.triangles.len() > MESHED => {
            merged(sampled(world, area, position, asking))
        }
        Emitter::Area(area) => {
            let (mut list, mut blockers) = (Vec::new(), Blockers::default());
            let leaves = asking.rays.max(1);
            let mut depth = 0;
            while (area.triangles.len() as u32) << (2 * depth) < leaves && depth < 4 {
                depth += 1;
            }
            for &triangle in &area.triangles {
                let facing = world
                    .geometry
                    .area_normal(triangle)
                    .dot(position - world.geometry.positions[triangle as usize][0]);
                if facing > 0.0 || (area.double_sided && facing < 0.0) {
                    let whole = [Vec2::ZERO, Vec2::X, Vec2::Y];
                    let (list, blockers) = (&mut list, &mut blockers);
                    let widest = asking.widest;
                    Leaves { world, area, triangle, position, widest, list, blockers }.cut(whole, depth, 6);
                }
            }
            merged(list)
        }
    }
}

/// Luminous surfaces of more triangles than this are sampled over their area, not cut.
const MESHED: usize = 64;

/// Points spread over a finely meshed emitter, weighted so that together they have its exact solid angle.
fn sampled(world: &World, area: &AreaEmitter, position: Vec3, asking: &Asking) -> Vec<Arrival> {
    let count = 2 * asking.rays.max(4);
    let mut raw = Vec::with_capacity(count as usize);
    let mut total = 0.0f64;
    for j in 0..count {
        let point = area.point(&world.geometry, r2_point(j, asking.seed as u32));
        let to_light = point.position - position;
        let d2 = to_light.length_squared();
        let direction = to_light / d2.sqrt();
        let facing = -point.normal.dot(direction);
        let facing = if area.double_sided { facing.abs() } else { facing };
        if facing > 0.0 && d2 > 0.0 {
            total += f64::from(facing / d2);
            raw.push((direction, facing / d2, point));
        }
    }
    let exact: f64 = area
        .triangles
        .iter()
        .map(|&t| world.geometry.positions[t as usize].map(|p| p - position))
        .filter(|c| area.double_sided || (c[1] - c[0]).cross(c[2] - c[0]).dot(c[0]) < 0.0)
        .map(solid_angle)
        .sum();
    let scale = if total > 0.0 { (exact / total) as f32 } else { 0.0 };
    raw.into_iter()
        .map(|(direction, weight, point)| Arrival {
            direction,
            normal_irradiance: point.radiance
                * world.transmittance(&Ray::between(position, point.position))
                * (weight * scale),
        })
        .filter(|arrival| arrival.normal_irradiance != Vec3::ZERO)
        .collect()
}

/// Solid angle of a triangle seen from the origin, sr (van Oosterom and Strackee 1983).
pub fn solid_angle(corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let below = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
    2.0 * a.dot(b.cross(c)).abs().atan2(below)
}

/// A luminous triangle being cut into leaves.
struct Leaves<'a> {
    world: &'a World,
    area: &'a AreaEmitter,
    triangle: u32,
    position: Vec3,
    widest: f32,
    list: &'a mut Vec<Arrival>,
    blockers: &'a mut Blockers,
}

/// Widest leaf, m of edge a metre of distance: the mid-point cosine then errs by under 1 %.
const WIDEST: f32 = 0.35;

impl Leaves<'_> {
    /// Cuts at least `depth` times into four, and up to `spare` times more while a leaf looks wide.
    fn cut(&mut self, corners: [Vec2; 3], depth: u32, spare: u32) {
        let [a, b, c] = corners.map(|w| self.at(w));
        let centre = (a + b + c) / 3.0 - self.position;
        let distance = centre.length();
        let edge = (b - a).length().max((c - b).length()).max((a - c).length());
        if depth > 0 || (spare > 0 && edge > self.widest * distance) {
            let [p, q, r] = corners;
            let (pq, qr, rp) = (0.5 * (p + q), 0.5 * (q + r), 0.5 * (r + p));
            let (depth, spare) = if depth > 0 { (depth - 1, spare) } else { (0, spare - 1) };
            for part in [[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]] {
                self.cut(part, depth, spare);
            }
            return;
        }
        let radiance = self.radiance((corners[0] + corners[1] + corners[2]) / 3.0);
        let ray = Ray::between(self.position, self.position + centre);
        if radiance == Vec3::ZERO {
            return;
        }
        let radiance = if self.world.glass {
            radiance * self.world.transmittance(&ray)
        } else if self.world.accel.occluded_past(&ray, self.blockers) {
            Vec3::ZERO
        } else {
            radiance
        };
        let vector = vector_irradiance([a, b, c].map(|p| p - self.position));
        let vector = if vector.dot(centre.as_dvec3()) < 0.0 { -vector } else { vector };
        let direction = vector.normalize_or_zero().as_vec3();
        let normal_irradiance = radiance * vector.length() as f32;
        if direction.is_finite() && normal_irradiance.is_finite() && normal_irradiance != Vec3::ZERO {
            self.list.push(Arrival { direction, normal_irradiance });
        }
    }

    fn at(&self, w: Vec2) -> Vec3 {
        let [a, b, c] = self.world.geometry.positions[self.triangle as usize];
        a * (1.0 - w.x - w.y) + b * w.x + c * w.y
    }

    fn radiance(&self, w: Vec2) -> Vec3 {
        if !self.area.textured {
            return self.area.radiance;
        }
        let geometry = &self.world.geometry;
        let [a, b, c] = geometry.uvs[self.triangle as usize];
        let uv = a * (1.0 - w.x - w.y) + b * w.x + c * w.y;
        geometry.material_of(self.triangle).emission_at(uv, &geometry.textures)
            * geometry.dimmer[self.area.object as usize]
    }
}

/// Vector irradiance of a triangle of unit radiance at the origin, sr: ½ Σ Θᵢ Γᵢ over its edges (Lambert).
/// Its dot product with a normal is the exact irradiance wherever the triangle is above that horizon.
pub fn vector_irradiance(corners: [Vec3; 3]) -> DVec3 {
    let v = corners.map(|p| p.as_dvec3());
    let squares = v.map(|p| p.length_squared());
    let edge = |a: usize, b: usize| {
        let (cross, lengths) = (v[a].cross(v[b]), squares[a] * squares[b]);
        let square = cross.length_squared();
        if square > SHORT * lengths || v[a].dot(v[b]) < 0.0 {
            let sine = square.sqrt();
            let arc = sine.atan2(v[a].dot(v[b])) / sine;
            return if sine > 0.0 { cross * arc } else { DVec3::ZERO };
        }
        // An angle over its sine, in powers of the sine's square.
        let s = square / lengths;
        let arc = ARC.iter().rev().fold(0.0, |p, c| p * s + c) / lengths.sqrt();
        if s.is_finite() { cross * arc } else { DVec3::ZERO }
    };
    0.5 * (edge(0, 1) + edge(1, 2) + edge(2, 0))
}

/// Square of the sine up to which [`ARC`] is used: 18°.
const SHORT: f64 = 0.1;

/// asin(x) / x in powers of x², to 2e-10 up to [`SHORT`].
const ARC: [f64; 8] = [
    1.0,
    1.0 / 6.0,
    3.0 / 40.0,
    15.0 / 336.0,
    105.0 / 3_456.0,
    945.0 / 42_240.0,
    10_395.0 / 599_040.0,
    135_135.0 / 9_676_800.0,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Rng;

    #[test]
    fn short_edges_by_a_series_are_those_by_arc_tangent() {
        let by_arc_tangent = |corners: [Vec3; 3]| -> DVec3 {
            let v = corners.map(|p| p.as_dvec3());
            let edge = |a: DVec3, b: DVec3| a.cross(b).normalize_or_zero() * a.angle_between(b);
            0.5 * (edge(v[0], v[1]) + edge(v[1], v[2]) + edge(v[2], v[0]))
        };
        for i in 0..20_000 {
            let mut rng = Rng::new(8, i);
            let mut point = || Vec3::from_array([(); 3].map(|()| rng.next_f32() - 0.5));
            // Edges of all lengths, half of them so short that the series is used.
            let (centre, size) = (4.0 * point(), 2.0 * point().x);
            let corners = [(); 3].map(|()| centre + size * point());
            let error = (vector_irradiance(corners) - by_arc_tangent(corners)).length();
            // 2e-10 of the angle, and what the arc cosine of the comparison loses near 1.
            assert!(error < 1e-7, "{corners:?}: {error}");
        }
        let flat = [Vec3::X, -Vec3::X, Vec3::ZERO];
        assert_eq!(vector_irradiance(flat), DVec3::ZERO);
    }
}
