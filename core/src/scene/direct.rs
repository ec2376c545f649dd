//! Direct light: the irradiance at a point that comes from an emitter without a bounce.
//!
//! Point, spot and directional lamps are closed forms times visibility. A plain area emitter of few
//! triangles is Lambert's closed form for polygons times the visible share, so that the unshadowed
//! part carries no noise; a textured or finely meshed one is sampled over its area.

use super::{
    accel::Ray,
    emitters::{AreaEmitter, Emitter, Facing},
    geometry::{Surface, offset_origin},
    world::World,
};
use crate::math::random::r2_point;
use glam::{DVec3, Vec3};

/// Area emitters of at most this many triangles are integrated in closed form.
pub const ANALYTIC_TRIANGLES: usize = 16;

/// Triangles up to this edge a metre of distance are integrated by three points each.
pub const LARGEST_SIZE: f32 = 0.08;

/// How many times as many points are drawn at most, where all of the first lie where the light does not come from.
pub const SEARCH: u32 = 16;

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
            if e == Vec3::ZERO { e } else { e * world.transmittance(&lamp.ray_from(receiver.origin())) }
        }
        Emitter::Area(area) if below_horizon(area, receiver) => Vec3::ZERO,
        Emitter::Area(area) => {
            let one = [(receiver, scramble)];
            of_area(world, area, one.into_iter(), samples, |r| *r, |r, target| arrives(world, r, target))
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
    let sum = match emitter {
        Emitter::Area(area) => {
            let facing = receivers.filter(|(r, _)| !below_horizon(area, r));
            of_area(world, area, facing, samples, |r| *r, |r, target| arrives(world, r, target))
        }
        Emitter::Lamp { .. } => receivers
            .fold(Vec3::ZERO, |sum, (r, scramble)| sum + irradiance(world, emitter, r, samples, scramble)),
    };
    sum / count
}

/// Share of the light of a point of an emitter that arrives.
fn arrives(world: &World, receiver: &Receiver, target: Vec3) -> Vec3 {
    world.transmittance(&Ray::between(receiver.origin(), target))
}

/// Sum over receivers of the irradiance from an area emitter, lx per channel, by `samples` points of it at each;
/// `seen` is the share of a point's light that arrives.
///
/// Plain and of few triangles: E ≈ L F Σ wᵢ Vᵢ / Σ wᵢ with F the closed form of all receivers and w = cos θ cos θ′ / d².
/// Where all points fell on what faces away or lies below the horizon, nothing is known of the rest yet: more are drawn
/// until one does not, up to [`SEARCH`] times as many, and then each triangle is asked at the middle of what is above
/// the horizon. Any other: E ≈ A / N Σ Lᵢ wᵢ Vᵢ.
pub(crate) fn of_area<R>(
    world: &World,
    area: &AreaEmitter,
    receivers: impl Iterator<Item = (R, u32)> + Clone,
    samples: u32,
    receiver: impl Fn(&R) -> &Receiver,
    seen: impl Fn(&R, Vec3) -> Vec3,
) -> Vec3 {
    if area.radiance == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let samples = samples.max(1);
    let point = |from: &R, j: u32, scramble: u32| {
        let sample = area_sample(world, area, receiver(from), j, scramble)?;
        Some((seen(from, sample.target) * sample.weight, sample))
    };
    if area.textured || area.triangles.len() > ANALYTIC_TRIANGLES {
        let sum = receivers.fold(Vec3::ZERO, |sum, (from, scramble)| {
            let points = (0..samples).filter_map(|j| point(&from, j, scramble));
            points.fold(sum, |sum, (light, sample)| sum + sample.radiance * light)
        });
        return sum * (area.area() / samples as f32);
    }
    let (mut unshadowed, mut visible, mut total) = (0.0, Vec3::ZERO, 0.0);
    for (from, scramble) in receivers.clone() {
        let factor = area_factor(world, area, receiver(&from));
        if factor == 0.0 {
            continue;
        }
        unshadowed += factor;
        for (light, sample) in (0..samples).filter_map(|j| point(&from, j, scramble)) {
            visible += light;
            total += sample.weight;
        }
    }
    for j in samples..SEARCH * samples {
        if total > 0.0 || unshadowed == 0.0 {
            break;
        }
        for (light, sample) in receivers.clone().filter_map(|(from, scramble)| point(&from, j, scramble)) {
            visible += light;
            total += sample.weight;
        }
    }
    if total == 0.0 && unshadowed > 0.0 {
        for (from, _) in receivers {
            for (factor, middle) in factors(world, area, receiver(&from)) {
                visible += seen(&from, middle) * factor;
                total += factor;
            }
        }
    }
    if total > 0.0 { area.radiance * visible * (unshadowed / total) } else { Vec3::ZERO }
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
    let (wi, light) = lamp.arriving(receiver.position);
    light * receiver.normal.dot(wi).max(0.0)
}

/// Irradiance a unit radiance over the whole emitter would give, sr projected, unshadowed.
fn area_factor(world: &World, area: &AreaEmitter, receiver: &Receiver) -> f32 {
    facing_triangles(world, area, receiver)
        .map(|(corners, area_normal)| {
            let Receiver { position, normal, .. } = *receiver;
            distant_irradiance(position, normal, corners, area_normal)
                .map_or_else(|| polygon_irradiance(position, normal, &corners), f64::from)
        })
        .sum::<f64>() as f32
}

/// Of each triangle its part of [`area_factor`], and the middle of what is above the horizon, off the surface.
fn factors<'a>(
    world: &'a World,
    area: &'a AreaEmitter,
    receiver: &'a Receiver,
) -> impl Iterator<Item = (f32, Vec3)> + 'a {
    facing_triangles(world, area, receiver).filter_map(|(corners, area_normal)| {
        let (clipped, count) = above_horizon(receiver.position, receiver.normal, &corners);
        let middle = clipped[..count].iter().sum::<DVec3>() / count.max(1) as f64;
        let factor = polygon_irradiance(receiver.position, receiver.normal, &corners) as f32;
        let towards = area_normal.normalize_or_zero();
        (factor > 0.0).then(|| (factor, offset_origin(receiver.position + middle.as_vec3(), towards)))
    })
}

/// Triangles of an area emitter that shine on a receiver's place, counter-clockwise from there, with the cross product
/// of two edges.
fn facing_triangles<'a>(
    world: &'a World,
    area: &'a AreaEmitter,
    receiver: &'a Receiver,
) -> impl Iterator<Item = ([Vec3; 3], Vec3)> + 'a {
    area.triangles.iter().filter_map(|&t| {
        let [a, b, c] = world.geometry.positions[t as usize];
        let area_normal = world.geometry.area_normal(t);
        let faces = area_normal.dot(receiver.position - a) > 0.0;
        match faces {
            true => Some(([a, b, c], area_normal)),
            false => area.double_sided.then_some(([a, c, b], -area_normal)),
        }
    })
}

/// A point of an area emitter that faces a receiver.
struct AreaSample {
    /// cos θ cos θ′ / d², 1/m² sr.
    weight: f32,
    /// Its radiance, cd/m².
    radiance: Vec3,
    /// The point, off the emitter's surface.
    target: Vec3,
}

/// The `j`-th point of an area emitter for a receiver; `None` where they do not face each other.
fn area_sample(
    world: &World,
    area: &AreaEmitter,
    receiver: &Receiver,
    j: u32,
    scramble: u32,
) -> Option<AreaSample> {
    let point = area.point(&world.geometry, r2_point(j, scramble));
    let Facing { wi, d2, cosine: cosine_light, target } = area.facing(&point, receiver.position)?;
    let cosine = receiver.normal.dot(wi);
    let sample = AreaSample { weight: cosine * cosine_light / d2, radiance: point.radiance, target };
    (cosine > 0.0).then_some(sample)
}

/// [`polygon_irradiance`] of a triangle that is small for its distance and above the horizon, by the
/// mean of cos θ cos θ′ / d² over the middles of its edges; `None` for any other triangle.
///
/// `area_normal` is the cross product of two edges. The rule is exact for quadratics, so its error is of
/// third order in size over distance: here below 2e-4 of what a receiver that faces the triangle gets, at
/// a tenth of the closed form's cost.
fn distant_irradiance(position: Vec3, normal: Vec3, corners: [Vec3; 3], area_normal: Vec3) -> Option<f32> {
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
    let (clipped, count) = above_horizon(position, normal, corners);
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

/// Corners, from the receiver, of what is above its horizon of a triangle, and their number.
fn above_horizon(position: Vec3, normal: Vec3, corners: &[Vec3; 3]) -> ([DVec3; 4], usize) {
    let relative = corners.map(|c| c.as_dvec3() - position.as_dvec3());
    let height = relative.map(|r| r.dot(normal.as_dvec3()));
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
    (clipped, count)
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
