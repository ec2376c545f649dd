//! Direct light: the irradiance at a point that comes from an emitter without a bounce.
//!
//! Point, spot and directional lamps are closed forms times visibility. A plain area emitter of few
//! triangles is Lambert's closed form for polygons times the visible share, so that the unshadowed
//! part carries no noise; a textured or finely meshed one is sampled over its area.

use super::{
    accel::Ray,
    emitters::{AreaEmitter, Emitter},
    geometry::{Surface, offset_origin},
    lamp::LampKind,
    world::World,
};
use crate::math::random::r2_point;
use glam::{DVec3, Vec3};

/// Area emitters of at most this many triangles are integrated in closed form.
pub const ANALYTIC_TRIANGLES: usize = 16;

/// How many times as many points are drawn at most, where all of the first lie where the light does not come from.
const SEARCH: u32 = 16;

/// A place to receive light, on one side of a surface or in the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Position, m.
    pub position: Vec3,
    /// Unit normal that cosines refer to.
    pub normal: Vec3,
    /// Unit normal of the plane that rays start from; equal to `normal` in the air.
    pub geometric_normal: Vec3,
}

impl Receiver {
    /// A receiver whose two normals agree.
    pub fn new(position: Vec3, normal: Vec3) -> Self {
        Self { position, normal, geometric_normal: normal }
    }

    /// The receiver at a surface, on the side seen.
    pub fn of(surface: &Surface) -> Self {
        Self {
            position: surface.position,
            normal: surface.normal,
            geometric_normal: surface.geometric_normal,
        }
    }

    /// Where shadow rays start.
    pub fn origin(&self) -> Vec3 {
        offset_origin(self.position, self.geometric_normal)
    }
}

/// Irradiance from one emitter, lx per channel, by at most `samples` shadow rays.
///
/// `scramble` decorrelates neighbouring receivers; equal arguments give equal results.
pub fn irradiance(
    world: &World,
    emitter: &Emitter,
    receiver: &Receiver,
    samples: u32,
    scramble: u32,
) -> Vec3 {
    match emitter {
        Emitter::Lamp { lamp, .. } => {
            let e = unshadowed_lamp(lamp, receiver);
            let ray = match lamp.kind {
                LampKind::Directional { .. } => Ray::new(receiver.origin(), -lamp.axis()),
                _ => Ray::between(receiver.origin(), lamp.position()),
            };
            if e == Vec3::ZERO { e } else { e * world.transmittance(&ray) }
        }
        Emitter::Area(area) if area.radiance == Vec3::ZERO || below_horizon(area, receiver) => Vec3::ZERO,
        Emitter::Area(area) if has_closed_form(area) => {
            let one = [(receiver, scramble)];
            partly_hidden(world, area, one.into_iter(), samples, |r| *r, |r, s| s.seen(world, r))
        }
        Emitter::Area(area) => {
            let mut sum = Vec3::ZERO;
            for j in 0..samples.max(1) {
                let sample = area_sample(world, area, receiver, j, scramble);
                if let Some(sample) = sample {
                    sum += sample.radiance * sample.seen(world, receiver) * sample.weight;
                }
            }
            sum * (area.area() / samples.max(1) as f32)
        }
    }
}

/// Mean irradiance from one emitter over the receivers of a footprint, lx per channel, `samples` shadow
/// rays at each; `scramble` gives each its own.
///
/// The visible share of an emitter is estimated from the rays of all receivers together: a ratio of few
/// samples is biased, by some 7 % at two where the emitter is large and near.
pub fn mean_irradiance<'a>(
    world: &World,
    emitter: &Emitter,
    receivers: impl ExactSizeIterator<Item = (&'a Receiver, u32)> + Clone,
    samples: u32,
) -> Vec3 {
    let count = receivers.len().max(1) as f32;
    if let Emitter::Area(area) = emitter
        && has_closed_form(area)
    {
        let facing = receivers.filter(|(r, _)| !below_horizon(area, r));
        return partly_hidden(world, area, facing, samples, |r| *r, |r, s| s.seen(world, r)) / count;
    }
    receivers.fold(Vec3::ZERO, |sum, (r, scramble)| sum + irradiance(world, emitter, r, samples, scramble))
        / count
}

/// Sum over receivers of the closed-form irradiance from one emitter, lx per channel, times the share of it that
/// `seen` lets arrive at `samples` points.
///
/// Where all points fell on what faces away or lies below the horizon, nothing is known of the rest yet: more are
/// drawn, until one does not.
pub(crate) fn partly_hidden<R>(
    world: &World,
    area: &AreaEmitter,
    receivers: impl Iterator<Item = (R, u32)> + Clone,
    samples: u32,
    receiver: impl Fn(&R) -> &Receiver,
    seen: impl Fn(&R, &AreaSample) -> Vec3,
) -> Vec3 {
    if area.radiance == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let samples = samples.max(1);
    let (mut unshadowed, mut visible, mut total) = (0.0, Vec3::ZERO, 0.0);
    let point = |from: &R, j: u32, scramble: u32| {
        let sample = area_sample(world, area, receiver(from), j, scramble)?;
        Some((seen(from, &sample) * sample.weight, sample.weight))
    };
    for (from, scramble) in receivers.clone() {
        let factor = area_factor(world, area, receiver(&from));
        if factor == 0.0 {
            continue;
        }
        unshadowed += factor;
        for (light, weight) in (0..samples).filter_map(|j| point(&from, j, scramble)) {
            visible += light;
            total += weight;
        }
    }
    for j in samples..SEARCH * samples {
        if total > 0.0 || unshadowed == 0.0 {
            break;
        }
        for (light, weight) in receivers.clone().filter_map(|(from, scramble)| point(&from, j, scramble)) {
            visible += light;
            total += weight;
        }
    }
    if total > 0.0 { area.radiance * visible * (unshadowed / total) } else { Vec3::ZERO }
}

/// Whether light of an area emitter is the closed form times the share that is seen, or sampled as a whole.
pub(crate) fn has_closed_form(area: &AreaEmitter) -> bool {
    !area.textured && area.triangles.len() <= ANALYTIC_TRIANGLES
}

/// Whether a receiver faces away from the whole of an emitter.
fn below_horizon(area: &AreaEmitter, receiver: &Receiver) -> bool {
    let (centre, radius) = area.bounds;
    (centre - receiver.position).dot(receiver.normal) < -1.001 * radius
}

/// Irradiance from every emitter, lx per channel.
pub fn total_irradiance(world: &World, receiver: &Receiver, samples: u32, scramble: u32) -> Vec3 {
    world
        .emitters
        .list
        .iter()
        .fold(Vec3::ZERO, |sum, e| sum + irradiance(world, e, receiver, samples, scramble))
}

/// Light of a lamp if nothing is between, lx: I cos θ / d² of a point or spot lamp.
pub(crate) fn unshadowed_lamp(lamp: &super::lamp::Lamp, receiver: &Receiver) -> Vec3 {
    if let LampKind::Directional { illuminance } = lamp.kind {
        return illuminance * (lamp.dimmer * receiver.normal.dot(-lamp.axis()).max(0.0));
    }
    let to_lamp = lamp.position() - receiver.position;
    let d2 = to_lamp.length_squared();
    let wi = to_lamp / d2.sqrt();
    let cosine = receiver.normal.dot(wi);
    if d2 == 0.0 || !wi.is_finite() || cosine <= 0.0 {
        return Vec3::ZERO;
    }
    lamp.intensity_towards(-wi) * (cosine / d2)
}

/// Irradiance a unit radiance over the whole emitter would give, sr projected, unshadowed.
pub(crate) fn area_factor(world: &World, area: &AreaEmitter, receiver: &Receiver) -> f32 {
    let mut factor = 0.0;
    for &t in &area.triangles {
        let [a, b, c] = world.geometry.positions[t as usize];
        let area_normal = world.geometry.area_normal(t);
        let faces = area_normal.dot(receiver.position - a) > 0.0;
        if !faces && !area.double_sided {
            continue;
        }
        factor += match distant_irradiance(receiver.position, receiver.normal, [a, b, c], area_normal) {
            Some(e) => f64::from(e),
            None if faces => polygon_irradiance(receiver.position, receiver.normal, &[a, b, c]),
            None => polygon_irradiance(receiver.position, receiver.normal, &[a, c, b]),
        };
    }
    factor as f32
}

/// A point of an area emitter that faces a receiver.
pub(crate) struct AreaSample {
    /// cos θ cos θ′ / d², 1/m² sr.
    pub weight: f32,
    /// Its radiance, cd/m².
    pub radiance: Vec3,
    /// The point, off the emitter's surface.
    pub target: Vec3,
}

impl AreaSample {
    /// Share of it that arrives.
    fn seen(&self, world: &World, receiver: &Receiver) -> Vec3 {
        world.transmittance(&Ray::between(receiver.origin(), self.target))
    }
}

/// The `j`-th point of an area emitter for a receiver; `None` where they do not face each other.
pub(crate) fn area_sample(
    world: &World,
    area: &AreaEmitter,
    receiver: &Receiver,
    j: u32,
    scramble: u32,
) -> Option<AreaSample> {
    let point = area.point(&world.geometry, r2_point(j, scramble));
    let to_light = point.position - receiver.position;
    let d2 = to_light.length_squared();
    let wi = to_light / d2.sqrt();
    let cosine = receiver.normal.dot(wi);
    let facing = -point.normal.dot(wi);
    let cosine_light = if area.double_sided { facing.abs() } else { facing };
    if d2 == 0.0 || !wi.is_finite() || cosine <= 0.0 || cosine_light <= 0.0 {
        return None;
    }
    let target = offset_origin(point.position, point.normal * facing.signum());
    Some(AreaSample { weight: cosine * cosine_light / d2, radiance: point.radiance, target })
}

/// [`polygon_irradiance`] of a triangle that is small for its distance and above the horizon, by the
/// mean of cos θ cos θ′ / d² over the middles of its edges; `None` for any other triangle.
///
/// `area_normal` is the cross product of two edges. The rule is exact for quadratics, so its error is of
/// third order in size over distance: here below 2e-4 of what a receiver that faces the triangle gets, at
/// a tenth of the closed form's cost.
fn distant_irradiance(position: Vec3, normal: Vec3, corners: [Vec3; 3], area_normal: Vec3) -> Option<f32> {
    const LARGEST_SIZE: f32 = 0.08;
    let [a, b, c] = corners.map(|corner| corner - position);
    let distance_squared = (a + b + c).length_squared() / 9.0;
    let size_squared = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    let lowest = a.dot(normal).min(b.dot(normal)).min(c.dot(normal));
    if size_squared > LARGEST_SIZE * LARGEST_SIZE * distance_squared || lowest < 0.0 {
        return None;
    }
    let at = |q: Vec3| {
        let squared = q.length_squared();
        q.dot(normal) * q.dot(area_normal).abs() / (squared * squared)
    };
    // Half the cross product is the area; a third each.
    Some((at(0.5 * (a + b)) + at(0.5 * (b + c)) + at(0.5 * (c + a))) / 6.0)
}

/// Irradiance at a point from a polygon of unit radiance, unshadowed: ½ Σ Θᵢ Γᵢ·n, after clipping
/// the polygon to the receiver's horizon (Lambert; Baum, Rushmeier and Winget 1989). Corners run
/// counter-clockwise seen from the receiver's side. Unit: projected solid angle, sr.
pub fn polygon_irradiance(position: Vec3, normal: Vec3, corners: &[Vec3; 3]) -> f64 {
    let n = normal.as_dvec3();
    let relative = corners.map(|c| c.as_dvec3() - position.as_dvec3());
    let height = relative.map(|r| r.dot(n));
    let mut clipped = [DVec3::ZERO; 4];
    let mut count = 0;
    for i in 0..3 {
        let k = (i + 1) % 3;
        if height[i] >= 0.0 {
            clipped[count] = relative[i];
            count += 1;
        }
        if (height[i] < 0.0) != (height[k] < 0.0) && count < 4 {
            clipped[count] = relative[i].lerp(relative[k], height[i] / (height[i] - height[k]));
            count += 1;
        }
    }
    let mut sum = 0.0;
    for i in 0..count {
        let (a, b) = (clipped[i], clipped[(i + 1) % count]);
        let cross = a.cross(b);
        let sine = cross.length();
        if sine > 1e-300 {
            sum += sine.atan2(a.dot(b)) * cross.dot(n) / sine;
        }
    }
    (0.5 * sum).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{frame::uniform_direction, random::Rng};

    #[test]
    fn distant_triangles_agree_with_the_closed_form() {
        let mut used = 0;
        for i in 0..20_000 {
            let mut rng = Rng::new(3, i);
            let mut point = || uniform_direction(rng.next_vec2()) * rng.next_f32();
            let corners = [point() * 0.2, point() * 0.2, point() * 0.2];
            let position = point() * 4.0;
            let normal = point().normalize();
            let area_normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let Some(found) = distant_irradiance(position, normal, corners, area_normal) else { continue };
            used += 1;
            let faces = area_normal.dot(position - corners[0]) > 0.0;
            let [a, b, c] = corners;
            let corners = if faces { [a, b, c] } else { [a, c, b] };
            let exact = polygon_irradiance(position, normal, &corners);
            let facing = polygon_irradiance(position, ((a + b + c) / 3.0 - position).normalize(), &corners);
            // The rule's own bound, and what f32 loses where the triangle is seen edge-on.
            let edge_on = 0.5 * area_normal.length() / position.length_squared() * 1e-6;
            let error = (f64::from(found) - exact).abs();
            assert!(error <= 2e-4 * facing + f64::from(edge_on), "{found} for {exact}, triangle {i}");
        }
        assert!(used > 2_000, "{used}");
    }
}
