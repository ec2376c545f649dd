//! Irradiance of every bin from what arrives: Σ e max(0, ω·d), at half its cost.
//!
//! As in [`super::quadrature`], max(0, x) = (x + |x|) / 2: the x half of all arrivals together is a dot product
//! with their vector irradiance Σ e d, and the |x| half is the same for opposite bins.

use super::direct::Arrival;
use crate::math::sphere_map::DirectionBins;
use glam::Vec3;

/// Centres of the upper bins, one array an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Centres([Vec<f32>; 3]);

impl Centres {
    /// Of some bins.
    pub fn new(bins: DirectionBins) -> Self {
        let upper = bins.len() / 2;
        Self(std::array::from_fn(|axis| (0..upper).map(|b| bins.centre(b)[axis]).collect()))
    }
}

/// What arrives at a point, being summed.
pub(super) struct Received<'a> {
    centres: &'a Centres,
    /// Σ e d of each channel, lx.
    vectors: [Vec3; 3],
    /// Σ e |ω·d| of each channel in the upper bins, lx.
    even: [Vec<f32>; 3],
}

/// Share of all that arrives below which a bin holds nothing but rounding.
const ROUNDING: f32 = 1e-6;

impl<'a> Received<'a> {
    /// Nothing yet.
    pub fn new(centres: &'a Centres) -> Self {
        let even = [(); 3].map(|()| vec![0.0; centres.0[0].len()]);
        Self { centres, vectors: [Vec3::ZERO; 3], even }
    }

    /// Nothing again.
    pub fn clear(&mut self) {
        self.vectors = [Vec3::ZERO; 3];
        self.even.iter_mut().for_each(|channel| channel.fill(0.0));
    }

    /// Adds what arrives.
    pub fn add(&mut self, arrivals: &[Arrival]) {
        let Centres([x, y, z]) = self.centres;
        let [red, green, blue] = &mut self.even;
        let count = x.len();
        let (x, y, z) = (&x[..count], &y[..count], &z[..count]);
        let (red, green, blue) = (&mut red[..count], &mut green[..count], &mut blue[..count]);
        for Arrival { direction: d, normal_irradiance: e } in arrivals {
            for (channel, vector) in self.vectors.iter_mut().enumerate() {
                *vector += e[channel] * *d;
            }
            for i in 0..count {
                let cosine = d.x.mul_add(x[i], d.y.mul_add(y[i], d.z * z[i])).abs();
                red[i] = e.x.mul_add(cosine, red[i]);
                green[i] = e.y.mul_add(cosine, green[i]);
                blue[i] = e.z.mul_add(cosine, blue[i]);
            }
        }
    }

    /// Irradiance of every bin, lx, in one channel.
    pub fn irradiance(&self, channel: usize, out: &mut [f32]) {
        let Centres([x, y, z]) = self.centres;
        let (even, v) = (&self.even[channel], self.vectors[channel]);
        let (upper, lower) = out.split_at_mut(even.len());
        let whole = v.length();
        for (((upper, lower), even), ((x, y), z)) in
            upper.iter_mut().zip(lower.iter_mut().rev()).zip(even).zip(x.iter().zip(y).zip(z))
        {
            let odd = v.x.mul_add(*x, v.y.mul_add(*y, v.z * z));
            let least = ROUNDING * (even + whole);
            let [here, opposite] = [0.5 * (even + odd), 0.5 * (even - odd)];
            *upper = if here > least { here } else { 0.0 };
            *lower = if opposite > least { opposite } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{frame::uniform_direction, random::Rng};

    #[test]
    fn irradiance_of_bins_is_the_sum_of_clamped_cosines() {
        for n in [1, 2, 9, 17] {
            let bins = DirectionBins::new(n);
            let centres = Centres::new(bins);
            let mut received = Received::new(&centres);
            for count in [1, 12] {
                let arrivals: Vec<Arrival> = (0..count)
                    .map(|i| {
                        let mut rng = Rng::new(5, i);
                        let direction = uniform_direction(rng.next_vec2());
                        let normal_irradiance = Vec3::from_array([(); 3].map(|()| rng.next_f32()));
                        Arrival { direction, normal_irradiance }
                    })
                    .collect();
                received.clear();
                received.add(&arrivals);
                for channel in 0..3 {
                    let mut out = vec![f32::NAN; bins.len()];
                    received.irradiance(channel, &mut out);
                    for (bin, found) in out.into_iter().enumerate() {
                        let of = |a: &Arrival| {
                            a.normal_irradiance[channel] * bins.centre(bin).dot(a.direction).max(0.0)
                        };
                        let wanted: f32 = arrivals.iter().map(of).sum();
                        assert!((found - wanted).abs() < 2e-6 * count as f32, "{n} {bin}: {found} {wanted}");
                        assert!(wanted > 0.0 || found == 0.0, "light in the dark: {n} {bin} {found}");
                    }
                }
            }
        }
    }
}
