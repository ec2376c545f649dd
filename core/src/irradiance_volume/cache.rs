//! What stays the same while light changes: what every ray met, by number; and light sent through it.
//!
//! Radiance is linear in the elements' radiosity, so new light, light without some surfaces, and the
//! split into direct and indirect are all sums over the same rays: nothing is traced twice.

use super::{
    Tables, VolumeSettings,
    codec::{Texel, encode_eight},
    direct::Arrivals,
    ignored::Ignored,
    probe::emission,
    quadrature::{BLOCK, LANES, Quadrature},
    rays::{Extra, NO_ELEMENT, PointHits, Source},
    received::{Centres, Received},
    trust::Fills,
};
use crate::{math::sphere_map::DirectionBins, scene::world::World};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::{f32::consts::FRAC_1_PI, sync::Arc};
use wide::f32x8;

/// What the rays of some points met.
#[derive(Clone, Debug)]
pub(super) struct Met {
    /// Element of every ray: sample by sample, bin by bin.
    elements: Vec<u32>,
    /// What bins of each sample see beside whole rays of their own.
    extras: Vec<Vec<Extra>>,
    /// Rays of each sample that met an emitting side: number, triangle, texture coordinates.
    emitters_seen: Vec<Vec<(u32, u32, Vec2)>>,
    /// A triangle that each element lies on, or [`NO_ELEMENT`] for those that no ray met.
    owners: Vec<u32>,
    /// Rays a bin.
    rays: usize,
}

/// What a volume keeps to be lit again.
#[derive(Clone, Debug)]
pub(super) struct Transport {
    /// What the rays of every sample met.
    pub met: Met,
    /// From radiance to irradiance.
    pub solver: Solver,
}

/// From radiance in the bins to irradiance in the bins.
#[derive(Clone, Debug)]
pub(super) struct Solver {
    quadrature: Quadrature,
    centres: Centres,
}

/// Light as the rays of a cache see it.
pub(super) struct SeenLight<'a> {
    world: &'a World,
    /// Reflected radiance of each element, cd/m²; black where it is ignored.
    radiance: Vec<Vec3>,
    ignored: &'a Ignored,
}

impl Met {
    /// Gathers what was met from every point.
    pub fn new(bins: DirectionBins, settings: &VolumeSettings, hits: Vec<PointHits>) -> Self {
        let rays = settings.supersample as usize;
        let count = hits.len();
        let mut met = Self {
            elements: Vec::with_capacity(count * bins.len() * rays),
            extras: Vec::with_capacity(count),
            emitters_seen: Vec::with_capacity(count),
            owners: Vec::new(),
            rays,
        };
        for hit in hits {
            met.elements.extend(hit.elements);
            met.extras.push(hit.extras);
            met.emitters_seen.push(hit.emitters);
            for (element, triangle) in hit.owners {
                let element = element as usize;
                if met.owners.len() <= element {
                    met.owners.resize(element + 1, NO_ELEMENT);
                }
                met.owners[element] = triangle;
            }
        }
        met
    }

    /// Adds points after these.
    pub fn append(&mut self, other: Self) {
        self.elements.extend(other.elements);
        self.extras.extend(other.extras);
        self.emitters_seen.extend(other.emitters_seen);
        self.owners.resize(self.owners.len().max(other.owners.len()), NO_ELEMENT);
        for (owner, triangle) in self.owners.iter_mut().zip(other.owners) {
            if *owner == NO_ELEMENT {
                *owner = triangle;
            }
        }
    }

    /// Light as this cache sees it, without what is ignored.
    pub fn seen<'a>(&self, world: &'a World, radiosity: &[Vec3], ignored: &'a Ignored) -> SeenLight<'a> {
        let black = |element: usize| {
            !ignored.is_empty()
                && self
                    .owners
                    .get(element)
                    .is_some_and(|&t| t != NO_ELEMENT && ignored.holds_triangle(&world.geometry, t))
        };
        let radiance = radiosity
            .iter()
            .enumerate()
            .map(|(e, b)| if black(e) { Vec3::ZERO } else { *b * FRAC_1_PI })
            .collect();
        SeenLight { world, radiance, ignored }
    }

    /// Radiance that comes to a sample from each bin after at least one bounce, cd/m² per channel.
    pub fn reflected(&self, sample: usize, light: &SeenLight, out: &mut [Vec3]) {
        let seen = &self.elements[sample * out.len() * self.rays..][..out.len() * self.rays];
        light.reflected(seen, &self.extras[sample], out);
    }

    /// Adds the radiance of emitters that a sample's rays met, cd/m² per channel.
    pub fn add_emitted(&self, sample: usize, light: &SeenLight, out: &mut [Vec3]) {
        let share = 1.0 / self.rays as f32;
        for &(ray, triangle, uv) in &self.emitters_seen[sample] {
            out[ray as usize / self.rays] += light.emitted(triangle, uv) * share;
        }
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.extras.len()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let lists = |bytes: usize| bytes + size_of::<Vec<u32>>();
        size_of_val(&self.elements[..])
            + size_of_val(&self.owners[..])
            + self.emitters_seen.iter().map(|s| lists(size_of_val(&s[..]))).sum::<usize>()
            + self.extras.iter().map(|s| lists(size_of_val(&s[..]))).sum::<usize>()
    }
}

impl Transport {
    /// Irradiance of every bin of every sample from what they see and what arrives. Of the direct light
    /// `before`, samples to which the same arrives keep theirs.
    pub fn tables(
        &self,
        light: &SeenLight,
        arrivals: &[Arc<Arrivals>],
        fills: &Fills,
        before: Option<Before>,
    ) -> Tables {
        let (met, bins) = (&self.met, self.solver.bins());
        let filled = |mut table: Vec<Texel>| {
            fills.apply(&mut table, bins.len());
            Arc::new(table)
        };
        let indirect = self.solver.indirect(met.points(), |sample, out| met.reflected(sample, light, out));
        let direct = match before {
            Some(before) if before.holds_all(arrivals) => before.direct.clone(),
            _ => filled(self.solver.direct(met.points(), &light.heard(arrivals), |sample| {
                let before = before.as_ref().filter(|b| b.holds(arrivals, sample))?;
                Some(&before.direct[sample * bins.len()..][..bins.len()])
            })),
        };
        Tables::new(bins, direct, filled(indirect))
    }
}

/// Direct light as it was, and the arrivals that it was summed from.
pub(super) struct Before<'a> {
    /// One entry an emitter.
    pub arrivals: &'a [Arc<Arrivals>],
    /// Texels of every sample.
    pub direct: &'a Arc<Vec<Texel>>,
}

impl Before<'_> {
    /// Whether these arrivals are the ones of before.
    fn holds_all(&self, arrivals: &[Arc<Arrivals>]) -> bool {
        self.arrivals.len() == arrivals.len()
            && self.arrivals.iter().zip(arrivals).all(|(a, b)| Arc::ptr_eq(a, b))
    }

    /// Whether the same arrives at a sample.
    fn holds(&self, arrivals: &[Arc<Arrivals>], sample: usize) -> bool {
        self.arrivals.len() == arrivals.len()
            && self
                .arrivals
                .iter()
                .zip(arrivals)
                .all(|(a, b)| Arc::ptr_eq(a, b) || a.of(sample) == b.of(sample))
    }
}

impl SeenLight<'_> {
    /// What arrives from the emitters that are not ignored.
    pub fn heard<'a>(&self, arrivals: &'a [Arc<Arrivals>]) -> Vec<&'a Arrivals> {
        let emitters = self.world.emitters.list.iter().zip(arrivals);
        let heard = emitters.filter(|(e, _)| !self.ignored.holds_emitter(&self.world.geometry, e));
        heard.map(|(_, a)| &**a).collect()
    }

    /// Radiance from each bin after at least one bounce, cd/m² per channel, of what rays met: `seen` by all bins in
    /// turn, alike many each, and `extras`.
    pub fn reflected(&self, seen: &[u32], extras: &[Extra], out: &mut [Vec3]) {
        let rays = seen.len() / out.len();
        let share = 1.0 / rays as f32;
        if rays == 1 {
            for (out, &e) in out.iter_mut().zip(seen) {
                *out = self.radiance.get(e as usize).map_or(Vec3::ZERO, |l| *l);
            }
        } else {
            for (out, seen) in out.iter_mut().zip(seen.chunks_exact(rays)) {
                *out = seen.iter().fold(Vec3::ZERO, |s, &e| s + self.element(e)) * share;
            }
        }
        for extra in extras {
            let radiance = match extra.source {
                Source::Element(e) => self.element(e),
                Source::Emission(triangle, uv) => self.emitted(triangle, uv),
            };
            out[extra.bin as usize] += extra.factor * radiance;
        }
        // A bright surface that an aimed ray takes over leaves a bin nothing, but for rounding.
        out.iter_mut().for_each(|l| *l = l.max(Vec3::ZERO));
    }

    fn element(&self, element: u32) -> Vec3 {
        self.radiance.get(element as usize).copied().unwrap_or_default()
    }

    fn emitted(&self, triangle: u32, uv: Vec2) -> Vec3 {
        if self.ignored.holds_triangle(&self.world.geometry, triangle) {
            return Vec3::ZERO;
        }
        emission(self.world, triangle, uv)
    }
}

impl Solver {
    /// For a number of bins.
    pub fn new(bins: DirectionBins) -> Self {
        Self { quadrature: Quadrature::new(bins), centres: Centres::new(bins) }
    }

    /// The bins it is for.
    pub fn bins(&self) -> DirectionBins {
        self.quadrature.bins()
    }

    /// Irradiance of `count` samples from the radiance that `radiance` writes, cd/m² one a bin.
    pub fn indirect(&self, count: usize, radiance: impl Fn(usize, &mut [Vec3]) + Sync) -> Vec<Texel> {
        let bins = self.bins().len();
        let mut table = vec![Texel::default(); count * bins];
        table.par_chunks_mut(BLOCK * bins).enumerate().for_each_init(
            || (vec![Vec3::ZERO; bins], vec![[0.0; LANES]; bins], vec![[0.0; LANES]; bins]),
            |(one, seen, irradiance), (block, texels)| {
                for s in 0..texels.len() / bins {
                    radiance(block * BLOCK + s, one);
                    for (lanes, l) in seen.iter_mut().zip(&*one) {
                        (lanes[s], lanes[BLOCK + s], lanes[2 * BLOCK + s]) = (l.x, l.y, l.z);
                    }
                }
                self.quadrature.irradiance(seen, irradiance);
                for (bin, lanes) in irradiance.iter().enumerate() {
                    let encoded = encode_eight(bytemuck::cast(*lanes));
                    for (texels, encoded) in texels.chunks_exact_mut(bins).zip(encoded) {
                        texels[bin] = encoded;
                    }
                }
            },
        );
        table
    }

    /// Irradiance of `count` samples from what arrives, but for those whose texels are `kept`.
    pub fn direct<'a>(
        &self,
        count: usize,
        arrivals: &[&Arrivals],
        kept: impl Fn(usize) -> Option<&'a [Texel]> + Sync,
    ) -> Vec<Texel> {
        let bins = self.bins().len();
        let mut table = vec![Texel::default(); count * bins];
        table.par_chunks_mut(bins).enumerate().for_each_init(
            || (Received::new(&self.centres), [(); 3].map(|()| vec![0.0; bins.next_multiple_of(8)])),
            |(received, irradiance), (sample, texels)| {
                if let Some(kept) = kept(sample) {
                    return texels.copy_from_slice(kept);
                }
                if arrivals.iter().all(|a| a.of(sample).is_empty()) {
                    return;
                }
                received.clear();
                arrivals.iter().for_each(|emitter| received.add(emitter.of(sample)));
                for (channel, irradiance) in irradiance.iter_mut().enumerate() {
                    received.irradiance(channel, &mut irradiance[..bins]);
                }
                for (i, texels) in texels.chunks_mut(8).enumerate() {
                    let eight = irradiance.each_ref().map(|channel| f32x8::from(&channel[8 * i..][..8]));
                    texels.copy_from_slice(&encode_eight(eight)[..texels.len()]);
                }
            },
        );
        table
    }
}
