//! Irradiance moments of order n: what a glossy surface reflects, without knowing the surface.
//!
//! Hⁿ(ω) = (n + 1)/2 ∫ L(ω') max(0, ω·ω')ⁿ dω' (Greger 1996, Eq. 4.8). The weight's integral over the
//! sphere is π for every n, so order 1 is the irradiance of Eq. 4.3, constant radiance L gives πL at every
//! order, and ρHⁿ/π is the radiance of a surface that reflects a Phong lobe of exponent n without loss. As
//! n grows the lobe narrows to one direction, and H^∞ = πL(ω) (we keep the factor π, so that orders can be
//! compared and exchanged without rescaling). A query goes along the mirrored view vector (Fig. 4.17).
//!
//! Over bins, each row of weights is scaled to π as in [`super::quadrature`]; without that, order 100 over
//! 578 bins would be off by as much as its lobe misses of the bin centres. Emitters go in one by one, each
//! arrival with its normal irradiance E: (n + 1)/2 E max(0, cos)ⁿ. At order ∞ they are what rays saw of
//! them: a lamp without a surface is then invisible, as in a mirror.
//!
//! Limits, measured in the tests: a lobe cannot be narrower than a bin. At n = 17 (8°) order 100, half as
//! high 6.7° from its middle, is already coarse, and interpolation between samples blurs what it sees like
//! a reflection at infinity. The thesis says the same (§4.4).

use super::{
    IrradianceVolume, SurfaceLight, VolumeSettings,
    codec::{Texel, encode_rgb},
    direct::Arrivals,
    quadrature::{BLOCK, LANES, Lanes, product},
    trust::Fills,
};
use crate::{math::sphere_map::DirectionBins, scene::world::World};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::{f32::consts::PI, sync::Arc};

pub use crate::math::moment::Order;

/// Eq. 4.8 over bins with rows scaled to π, written as it stands: the moment towards every bin, lx, of
/// radiance in cd/m², one a bin.
///
/// # Panics
/// If there is not one radiance a bin.
pub fn moment_by_definition(bins: DirectionBins, radiance: &[Vec3], order: Order) -> Vec<Vec3> {
    assert_eq!(radiance.len(), bins.len(), "one radiance a bin");
    let Order::Finite(_) = order else { return radiance.iter().map(|l| *l * PI).collect() };
    let centres: Vec<Vec3> = (0..bins.len()).map(|b| bins.centre(b)).collect();
    centres
        .par_iter()
        .map(|wi| {
            let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
            for (wj, l) in centres.iter().zip(radiance) {
                let weight = f64::from(order.weight(wi.dot(*wj)));
                weights += weight;
                sum += l.as_dvec3() * weight;
            }
            (sum * (std::f64::consts::PI / weights)).as_vec3()
        })
        .collect()
}

/// Moment of what arrives from emitters, towards every bin, lx; finite orders alone.
pub fn moment_of_arrivals<'a>(
    bins: DirectionBins,
    arrivals: impl Iterator<Item = &'a super::direct::Arrival> + Clone,
    order: Order,
) -> Vec<Vec3> {
    (0..bins.len())
        .map(|b| {
            let centre = bins.centre(b);
            arrivals.clone().map(|a| a.normal_irradiance * order.weight(centre.dot(a.direction))).sum()
        })
        .collect()
}

/// The matrix of Eq. 4.8 for one order, factored by the mirrors in x, y and z that map bins onto bins.
///
/// The weight depends on ω·ω' alone, so data even or odd under each mirror stay so: eight products of
/// ⌈n/2⌉² unknowns in place of one of 2n², an eighth of the work at even n.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentKernel {
    /// Of which order.
    pub order: Order,
    bins: DirectionBins,
    half: usize,
    /// Row-major, for each parity: x odd + 2 × z odd + 4 × y odd. Empty at order ∞.
    kernels: Vec<Vec<f32>>,
}

impl MomentKernel {
    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.kernels.iter().map(|k| size_of_val(&k[..])).sum()
    }

    /// Factors the matrix.
    pub fn new(bins: DirectionBins, order: Order) -> Self {
        let half = (bins.n() as usize).div_ceil(2);
        if order == Order::Infinite {
            return Self { order, bins, half, kernels: Vec::new() };
        }
        let quarter = half * half;
        let centres: Vec<Vec3> = (0..bins.len()).map(|b| bins.centre(b)).collect();
        // The sum of a row is the same at all images of a bin.
        let scale: Vec<f64> = (0..quarter)
            .into_par_iter()
            .map(|a| {
                let wa = centres[images(a, half, bins)[0]];
                let sum: f64 = centres.iter().map(|wb| f64::from(order.weight(wa.dot(*wb)))).sum();
                std::f64::consts::PI / sum
            })
            .collect();
        let kernels = (0..8)
            .map(|parity: usize| {
                (0..quarter * quarter)
                    .into_par_iter()
                    .map(|i| {
                        let (a, b) = (i / quarter, i % quarter);
                        let wa = centres[images(a, half, bins)[0]];
                        let targets = images(b, half, bins);
                        let mut sum = 0.0;
                        for (k, &image) in targets.iter().enumerate() {
                            if !targets[..k].contains(&image) {
                                sum += f64::from(sign(parity, k) * order.weight(wa.dot(centres[image])));
                            }
                        }
                        (sum * scale[a]) as f32
                    })
                    .collect()
            })
            .collect();
        Self { order, bins, half, kernels }
    }

    /// The moment of a block of samples towards every bin, lx, from their radiance, cd/m².
    ///
    /// # Panics
    /// If there is not one entry a bin on both sides.
    pub fn apply(&self, radiance: &[Lanes], out: &mut [Lanes]) {
        let count = self.bins.len();
        assert!(radiance.len() == count && out.len() == count, "one entry a bin");
        if self.kernels.is_empty() {
            for (out, l) in out.iter_mut().zip(radiance) {
                *out = l.map(|v| v * PI);
            }
            return;
        }
        let (half, quarter) = (self.half, self.half * self.half);
        out.iter_mut().for_each(|o| *o = [0.0; LANES]);
        let mut split = vec![[0.0; LANES]; quarter];
        let mut part = split.clone();
        for (parity, kernel) in self.kernels.iter().enumerate() {
            for (b, split) in split.iter_mut().enumerate() {
                let images = images(b, half, self.bins);
                for (lane, value) in split.iter_mut().enumerate() {
                    *value = 0.125 * (0..8).map(|k| sign(parity, k) * radiance[images[k]][lane]).sum::<f32>();
                }
            }
            product(kernel, &split, &mut part);
            for (a, part) in part.iter().enumerate() {
                let images = images(a, half, self.bins);
                for (k, &image) in images.iter().enumerate() {
                    if !images[..k].contains(&image) {
                        for (o, p) in out[image].iter_mut().zip(part) {
                            *o += sign(parity, k) * p;
                        }
                    }
                }
            }
        }
        out.iter_mut().flatten().for_each(|v| *v = v.max(0.0));
    }
}

/// A bin of a quarter of the upper square and its images: bit 0 mirrors x, bit 1 z, bit 2 y.
fn images(b: usize, half: usize, bins: DirectionBins) -> [usize; 8] {
    let n = bins.n() as usize;
    let (column, row) = (b % half, b / half);
    std::array::from_fn(|k| {
        let c = if k & 1 == 1 { n - 1 - column } else { column };
        let r = if k & 2 == 2 { n - 1 - row } else { row };
        (k >> 2) * n * n + r * n + c
    })
}

/// Sign that image `k` has in a part of the given parity.
fn sign(parity: usize, k: usize) -> f32 {
    if (parity & k).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// One order's table of a volume: as the irradiance, encoded, bin b of sample s at s · 2n² + b.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentTable {
    /// Which order.
    pub order: Order,
    pub(super) direct: Arc<Vec<Texel>>,
    pub(super) indirect: Arc<Vec<Texel>>,
}

impl MomentTable {
    /// With the samples filled that hold the light of others.
    pub(super) fn filled(mut self, fills: &Fills, bins: DirectionBins) -> Self {
        for texels in [&mut self.direct, &mut self.indirect] {
            let texels: &mut Vec<Texel> = Arc::make_mut(texels);
            fills.apply(texels, bins.len());
        }
        self
    }
}

impl IrradianceVolume {
    /// The same volume holding these orders beside the irradiance; no ray is traced. A volume from a file
    /// keeps those it has.
    pub fn with_moments(&self, orders: &[Order], world: &World, light: &impl SurfaceLight) -> Self {
        let Some(transport) = &self.transport else { return self.clone() };
        let wanted = beside_irradiance(orders);
        let kernels: Vec<MomentKernel> = wanted
            .iter()
            .map(|&order| match self.kernels.iter().find(|k| k.order == order) {
                Some(kernel) => kernel.clone(),
                None => MomentKernel::new(self.bins(), order),
            })
            .collect();
        if kernels.is_empty() && self.tables.moments.is_empty() {
            let settings = VolumeSettings { moments: wanted, ..self.settings.clone() };
            return Self { kernels: Arc::default(), settings, ..self.clone() };
        }
        let seen = transport.met.seen(world, light.radiosity(), &self.settings.ignored);
        let heard = seen.heard(&self.arrivals);
        let mut volume = self.clone();
        volume.tables.moments = kernels
            .iter()
            .map(|kernel| {
                let met = &transport.met;
                let reflected = |s: usize, out: &mut [Vec3]| met.reflected(s, &seen, out);
                let emitted = |s: usize, out: &mut [Vec3]| met.add_emitted(s, &seen, out);
                light_moment(kernel, met.points(), reflected, emitted, &heard)
                    .filled(&self.fills, self.bins())
            })
            .collect();
        volume.kernels = Arc::new(kernels);
        volume.settings = VolumeSettings { moments: wanted, ..self.settings.clone() };
        volume
    }

    /// Orders that it can be asked for, 1 among them.
    pub fn orders(&self) -> Vec<Order> {
        std::iter::once(Order::IRRADIANCE).chain(self.tables.moments.iter().map(|m| m.order)).collect()
    }
}

/// Orders that have a table of their own, each once, lowest first.
pub fn beside_irradiance(orders: &[Order]) -> Vec<Order> {
    let mut wanted = orders.to_vec();
    wanted.sort_unstable();
    wanted.dedup();
    wanted.retain(|o| *o != Order::IRRADIANCE);
    wanted
}

/// Lights `count` samples at one order: `reflected` writes the radiance that comes to a sample from each bin
/// after a bounce, `emitted` adds that of emitters seen there (both cd/m²), and `arrivals` are what arrives.
pub(super) fn light_moment(
    kernel: &MomentKernel,
    count: usize,
    reflected: impl Fn(usize, &mut [Vec3]) + Sync,
    emitted: impl Fn(usize, &mut [Vec3]) + Sync,
    arrivals: &[&Arrivals],
) -> MomentTable {
    let bins = kernel.bins;
    let mut indirect = vec![Texel::default(); count * bins.len()];
    indirect.par_chunks_mut(BLOCK * bins.len()).enumerate().for_each(|(block, texels)| {
        let mut one = vec![Vec3::ZERO; bins.len()];
        let mut lanes = vec![[0.0; LANES]; bins.len()];
        let mut out = lanes.clone();
        for s in 0..texels.len() / bins.len() {
            reflected(block * BLOCK + s, &mut one);
            for (lanes, l) in lanes.iter_mut().zip(&one) {
                (0..3).for_each(|c| lanes[c * BLOCK + s] = l[c]);
            }
        }
        kernel.apply(&lanes, &mut out);
        for (s, texels) in texels.chunks_exact_mut(bins.len()).enumerate() {
            for (texel, o) in texels.iter_mut().zip(&out) {
                *texel = encode_rgb(Vec3::new(o[s], o[BLOCK + s], o[2 * BLOCK + s]));
            }
        }
    });
    let mut direct = vec![Texel::default(); count * bins.len()];
    direct.par_chunks_mut(bins.len()).enumerate().for_each(|(s, texels)| {
        let values = if kernel.order == Order::Infinite {
            let mut values = vec![Vec3::ZERO; bins.len()];
            emitted(s, &mut values);
            values.iter_mut().for_each(|v| *v *= PI);
            values
        } else {
            moment_of_arrivals(bins, arrivals.iter().flat_map(|a| a.of(s)), kernel.order)
        };
        for (texel, value) in texels.iter_mut().zip(values) {
            *texel = encode_rgb(value);
        }
    });
    MomentTable { order: kernel.order, direct: Arc::new(direct), indirect: Arc::new(indirect) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Rng;

    #[test]
    fn factored_product_is_the_definition() {
        for n in [1, 2, 3, 8, 9] {
            let bins = DirectionBins::new(n);
            for order in [1, 2, 10, 100].map(Order::Finite).into_iter().chain([Order::Infinite]) {
                let mut rng = Rng::new(5, u64::from(n));
                let lanes: Vec<Lanes> =
                    (0..bins.len()).map(|_| std::array::from_fn(|_| rng.next_f32())).collect();
                let mut out = vec![[0.0; LANES]; bins.len()];
                MomentKernel::new(bins, order).apply(&lanes, &mut out);
                for lane in [0, 7, LANES - 1] {
                    let radiance: Vec<Vec3> = lanes.iter().map(|l| Vec3::splat(l[lane])).collect();
                    let wanted = moment_by_definition(bins, &radiance, order);
                    for (o, w) in out.iter().zip(wanted) {
                        // Sums of some hundred terms of at most π in f32.
                        assert!((o[lane] - w.x).abs() < 3e-5, "n = {n}, order {order}: {} {w}", o[lane]);
                    }
                }
            }
        }
    }
}
