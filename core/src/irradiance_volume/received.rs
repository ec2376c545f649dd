//! Irradiance of every bin from what arrives: Σ e max(0, ω·d), at half its cost.
//!
//! As in [`super::quadrature`], max(0, x) = (x + |x|) / 2: the x half of all arrivals together is a dot product
//! with their vector irradiance Σ e d, and the |x| half is the same for opposite bins.

use super::{
    codec::{Texel, encode_eight},
    direct::Arrival,
};
use crate::math::sphere_map::DirectionBins;
use glam::Vec3;
use wide::f32x8;

/// Centres of the upper bins, eight together.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Centres {
    /// Coordinates; zeros past the last bin.
    eights: Vec<[f32x8; 3]>,
    /// Upper bins.
    count: usize,
}

/// Share of all that arrives below which a bin holds nothing but rounding.
const ROUNDING: f32 = 1e-6;

impl Centres {
    /// Of some bins.
    pub fn new(bins: DirectionBins) -> Self {
        let count = bins.len() / 2;
        let coordinate = |bin: usize, axis: usize| if bin < count { bins.centre(bin)[axis] } else { 0.0 };
        let eight = |i: usize| {
            [0, 1, 2].map(|axis| f32x8::new(std::array::from_fn(|lane| coordinate(8 * i + lane, axis))))
        };
        Self { eights: (0..count.div_ceil(8)).map(eight).collect(), count }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.eights[..])
    }

    /// Irradiance of every bin, lx per channel.
    pub fn irradiance(&self, arrivals: &[Arrival]) -> Vec<Vec3> {
        let mut out = vec![Vec3::ZERO; 2 * self.count];
        self.each(arrivals, |first, sides| {
            for (rgb, opposite) in sides.into_iter().zip([false, true]) {
                let rgb = rgb.map(f32x8::to_array);
                for i in 0..(self.count - first).min(8) {
                    let bin = if opposite { 2 * self.count - 1 - first - i } else { first + i };
                    out[bin] = Vec3::from_array(rgb.map(|channel| channel[i]));
                }
            }
        });
        out
    }

    /// [`Self::irradiance`], encoded.
    ///
    /// # Panics
    /// If there is not one texel a bin.
    pub fn texels(&self, arrivals: &[Arrival], out: &mut [Texel]) {
        assert_eq!(out.len(), 2 * self.count, "one texel a bin");
        let (upper, lower) = out.split_at_mut(self.count);
        self.each(arrivals, |first, [here, opposite]| {
            let count = (self.count - first).min(8);
            upper[first..][..count].copy_from_slice(&encode_eight(here)[..count]);
            let lower = &mut lower[self.count - first - count..][..count];
            lower.iter_mut().rev().zip(encode_eight(opposite)).for_each(|(texel, e)| *texel = e);
        });
    }

    /// Irradiance by channel of eight bins from the `first` on, and of the bins opposite to these.
    #[inline(always)]
    fn each(&self, arrivals: &[Arrival], mut put: impl FnMut(usize, [[f32x8; 3]; 2])) {
        let mut vectors = [Vec3::ZERO; 3];
        for Arrival { direction, normal_irradiance } in arrivals {
            for (channel, vector) in vectors.iter_mut().enumerate() {
                *vector += normal_irradiance[channel] * *direction;
            }
        }
        let by = f32x8::splat;
        let wholes = vectors.map(|v| by(v.length()));
        let dot = |v: &Vec3, [x, y, z]: &[f32x8; 3]| by(v.x).mul_add(*x, by(v.y).mul_add(*y, by(v.z) * *z));
        for (i, centres) in self.eights.iter().enumerate() {
            let mut even = [f32x8::ZERO; 3];
            for Arrival { direction, normal_irradiance: e } in arrivals {
                let cosine = dot(direction, centres).abs();
                even = [0, 1, 2].map(|c| by(e[c]).mul_add(cosine, even[c]));
            }
            let odd = vectors.each_ref().map(|v| dot(v, centres));
            let least = [0, 1, 2].map(|c| by(ROUNDING) * (even[c] + wholes[c]));
            let above = |v: f32x8, least: f32x8| v.simd_gt(least).select(v, f32x8::ZERO);
            let side =
                |sign: f32| [0, 1, 2].map(|c| above(by(0.5) * by(sign).mul_add(odd[c], even[c]), least[c]));
            put(8 * i, [side(1.0), side(-1.0)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        irradiance_volume::codec::encode_rgb,
        math::{frame::uniform_direction, random::Rng},
    };

    #[test]
    fn irradiance_of_bins_is_the_sum_of_clamped_cosines() {
        for n in [1, 2, 9, 17] {
            let bins = DirectionBins::new(n);
            let centres = Centres::new(bins);
            for count in [1, 12] {
                let arrivals: Vec<Arrival> = (0..count)
                    .map(|i| {
                        let mut rng = Rng::new(5, i);
                        let direction = uniform_direction(rng.next_vec2());
                        let normal_irradiance = Vec3::from_array([(); 3].map(|()| rng.next_f32()));
                        Arrival { direction, normal_irradiance }
                    })
                    .collect();
                let found = centres.irradiance(&arrivals);
                let mut texels = vec![[u16::MAX; 4]; bins.len()];
                centres.texels(&arrivals, &mut texels);
                for (bin, found) in found.into_iter().enumerate() {
                    assert_eq!(texels[bin], encode_rgb(found), "{n} {bin}");
                    for channel in 0..3 {
                        let of = |a: &Arrival| {
                            a.normal_irradiance[channel] * bins.centre(bin).dot(a.direction).max(0.0)
                        };
                        let (found, wanted) = (found[channel], arrivals.iter().map(of).sum::<f32>());
                        assert!((found - wanted).abs() < 2e-6 * count as f32, "{n} {bin}: {found} {wanted}");
                        assert!(wanted > 0.0 || found == 0.0, "light in the dark: {n} {bin} {found}");
                    }
                }
            }
        }
    }
}
