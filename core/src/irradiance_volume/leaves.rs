//! A luminous triangle, seen from a point, cut into leaves.
//!
//! A leaf is narrow enough for one direction to stand for it, and its vector irradiance is exact; shadow rays go
//! to the middles of its parts. A leaf seen whole gives one arrival, one seen in part gives one for each part
//! that is seen.

use super::direct::Arrival;
use crate::scene::{
    accel::{Ray, Shaft},
    emitters::AreaEmitter,
    world::World,
};
use glam::{DVec3, Vec2, Vec3};

/// A part of a luminous triangle: corners, m, and their barycentric weights.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    corners: [Vec3; 3],
    weights: [Vec2; 3],
}

impl Piece {
    /// The whole of a triangle.
    pub fn whole(corners: [Vec3; 3]) -> Self {
        Self { corners, weights: [Vec2::ZERO, Vec2::X, Vec2::Y] }
    }

    /// Its four like parts.
    fn parts(&self) -> [Self; 4] {
        let ([a, b, c], [p, q, r]) = (self.corners, self.weights);
        let (ab, bc, ca) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
        let (pq, qr, rp) = (0.5 * (p + q), 0.5 * (q + r), 0.5 * (r + p));
        [
            Self { corners: [a, ab, ca], weights: [p, pq, rp] },
            Self { corners: [ab, b, bc], weights: [pq, q, qr] },
            Self { corners: [ca, bc, c], weights: [rp, qr, r] },
            Self { corners: [ab, bc, ca], weights: [pq, qr, rp] },
        ]
    }

    fn middle(&self) -> Vec3 {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }
}

/// A luminous triangle being cut into leaves.
pub(super) struct Leaves<'a> {
    pub world: &'a World,
    pub area: &'a AreaEmitter,
    pub triangle: u32,
    pub position: Vec3,
    /// Widest leaf, m of edge a metre of distance.
    pub widest: f32,
    pub list: &'a mut Vec<Arrival>,
    /// Looked from the position at the emitter.
    pub shaft: &'a mut Shaft,
    /// Room for what shadow rays found.
    pub hidden: &'a mut Vec<bool>,
}

impl Leaves<'_> {
    /// Cuts a piece into four until no leaf looks wide, at most `spare` times more than `depth`; parts are cut
    /// `depth` times altogether.
    pub fn cut(&mut self, piece: &Piece, depth: u32, spare: u32) {
        let [a, b, c] = piece.corners;
        let square = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let distance = piece.middle().distance_squared(self.position);
        if depth + spare > 0 && square > self.widest.powi(2) * distance {
            let (depth, spare) = if depth > 0 { (depth - 1, spare) } else { (0, spare - 1) };
            return piece.parts().iter().for_each(|part| self.cut(part, depth, spare));
        }
        if depth == 0 || self.area.textured || self.world.glass {
            return self.each_part(piece, depth, &mut |leaves, part| {
                let radiance = leaves.radiance(part);
                if radiance != Vec3::ZERO {
                    let seen = leaves.seen(part);
                    leaves.add(part, radiance * seen);
                }
            });
        }
        self.hidden.clear();
        self.each_part(piece, depth, &mut |leaves, part| {
            let hidden = leaves.seen(part) == Vec3::ZERO;
            leaves.hidden.push(hidden);
        });
        let radiance = self.area.radiance;
        if !self.hidden.contains(&true) {
            self.add(piece, radiance);
        } else if self.hidden.contains(&false) {
            let mut asked = 0;
            self.each_part(piece, depth, &mut |leaves, part| {
                if !leaves.hidden[asked] {
                    leaves.add(part, radiance);
                }
                asked += 1;
            });
        }
    }

    fn each_part(&mut self, piece: &Piece, depth: u32, act: &mut dyn FnMut(&mut Self, &Piece)) {
        if depth == 0 {
            return act(self, piece);
        }
        piece.parts().iter().for_each(|part| self.each_part(part, depth - 1, act));
    }

    /// Share of the light that comes from the middle of a part.
    fn seen(&mut self, part: &Piece) -> Vec3 {
        let ray = Ray::between(self.position, part.middle());
        if self.world.glass {
            self.world.transmittance(&ray)
        } else if self.world.accel.occluded_in(&ray, self.shaft) {
            Vec3::ZERO
        } else {
            Vec3::ONE
        }
    }

    fn add(&mut self, part: &Piece, radiance: Vec3) {
        if radiance == Vec3::ZERO {
            return;
        }
        let vector = vector_irradiance(part.corners.map(|p| p - self.position));
        let outwards = (part.middle() - self.position).as_dvec3();
        let vector = if vector.dot(outwards) < 0.0 { -vector } else { vector };
        let length = vector.length();
        let direction = (vector / length).as_vec3();
        let normal_irradiance = radiance * length as f32;
        if direction.is_finite() && normal_irradiance.is_finite() && normal_irradiance != Vec3::ZERO {
            self.list.push(Arrival { direction, normal_irradiance });
        }
    }

    fn radiance(&self, part: &Piece) -> Vec3 {
        if !self.area.textured {
            return self.area.radiance;
        }
        let geometry = &self.world.geometry;
        let w = (part.weights[0] + part.weights[1] + part.weights[2]) / 3.0;
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
