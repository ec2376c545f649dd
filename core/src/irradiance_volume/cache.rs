//! What stays the same while light changes: what every ray met, by number; and light sent through it.
//!
//! Radiance is linear in the elements' radiosity, so new light, light without some surfaces, and the
//! split into direct and indirect are all sums over the same rays: nothing is traced twice.

use super::{
    Tables, VolumeSettings,
    codec::{Texel, encode_eight},
    direct::{Arrival, Arrivals},
    ignored::Ignored,
    probe::emission,
    quadrature::{BLOCK, LANES, Lanes, Quadrature},
    rays::{Extra, NO_ELEMENT, PointHits, Source},
    received::Centres,
    trust::Fills,
};
use crate::{math::sphere_map::DirectionBins, scene::world::World};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::{f32::consts::FRAC_1_PI, ops::Range, sync::Arc};

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
    /// Reflected radiance of each element, cd/m² and a zero; black where it is ignored, and after the last.
    radiance: Vec<[f32; 4]>,
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
        let shown = |(e, b): (usize, &Vec3)| if black(e) { Vec3::ZERO } else { *b * FRAC_1_PI };
        let radiance = radiosity.iter().enumerate().map(shown).chain([Vec3::ZERO]);
        let radiance = radiance.map(|l| l.max(Vec3::ZERO).extend(0.0).to_array()).collect();
        SeenLight { world, radiance, ignored }
    }

    /// Radiance that comes to a sample from each bin after at least one bounce, cd/m² per channel.
    pub fn reflected(&self, sample: usize, light: &SeenLight, out: &mut [Vec3]) {
        let seen = &self.elements[sample * out.len() * self.rays..][..out.len() * self.rays];
        light.reflected(seen, &self.extras[sample], out);
    }

    /// [`Self::reflected`] of up to [`BLOCK`] samples, side by side.
    pub fn reflected_of(&self, samples: Range<usize>, light: &SeenLight, out: &mut [Lanes]) {
        let bins = out.len();
        let seen_by = |s: usize| &self.elements[s * bins * self.rays..][..bins * self.rays];
        if self.rays > 1 {
            let mut one = vec![Vec3::ZERO; bins];
            for (lane, sample) in samples.enumerate() {
                light.reflected(seen_by(sample), &self.extras[sample], &mut one);
                spread(&one, lane, out);
            }
            return;
        }
        // Of all in turn for each bin, so that lanes are written once.
        let seen: [&[u32]; BLOCK] =
            std::array::from_fn(|i| seen_by((samples.start + i).min(samples.end - 1)));
        for (bin, lanes) in out.iter_mut().enumerate() {
            for (lane, seen) in seen.iter().enumerate() {
                let [r, g, b, _] = light.of(seen[bin]);
                (lanes[lane], lanes[BLOCK + lane], lanes[2 * BLOCK + lane]) = (r, g, b);
            }
        }
        for (lane, extras) in self.extras[samples].iter().enumerate() {
            for extra in extras {
                let (lanes, radiance) = (&mut out[extra.bin as usize], light.extra(extra));
                (0..3).for_each(|c| lanes[c * BLOCK + lane] += radiance[c]);
            }
            for extra in extras {
                let lanes = &mut out[extra.bin as usize];
                (0..3).for_each(|c| lanes[c * BLOCK + lane] = lanes[c * BLOCK + lane].max(0.0));
            }
        }
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
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.met.bytes() + self.solver.quadrature.bytes() + self.solver.centres.bytes()
    }

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
        let indirect =
            self.solver.indirect(met.points(), |samples, out| met.reflected_of(samples, light, out));
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
        for (out, seen) in out.iter_mut().zip(seen.chunks_exact(rays)) {
            *out = seen.iter().fold(Vec3::ZERO, |s, &e| s + self.element(e)) * share;
        }
        for extra in extras {
            out[extra.bin as usize] += self.extra(extra);
        }
        // A bright surface that an aimed ray takes over leaves a bin nothing, but for rounding.
        out.iter_mut().for_each(|l| *l = l.max(Vec3::ZERO));
    }

    #[inline(always)]
    fn of(&self, element: u32) -> [f32; 4] {
        self.radiance[(element as usize).min(self.radiance.len() - 1)]
    }

    fn element(&self, element: u32) -> Vec3 {
        Vec3::from_slice(&self.of(element))
    }

    fn extra(&self, extra: &Extra) -> Vec3 {
        extra.factor
            * match extra.source {
                Source::Element(e) => self.element(e),
                Source::Emission(triangle, uv) => self.emitted(triangle, uv),
            }
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

    /// Irradiance of `count` samples from the radiance, cd/m², that `radiance` writes of up to [`BLOCK`] of them.
    pub fn indirect(&self, count: usize, radiance: impl Fn(Range<usize>, &mut [Lanes]) + Sync) -> Vec<Texel> {
        let bins = self.bins().len();
        let mut table = vec![Texel::default(); count * bins];
        table.par_chunks_mut(BLOCK * bins).enumerate().for_each_init(
            || (vec![[0.0; LANES]; bins], self.quadrature.room()),
            |(seen, room), (block, texels)| {
                let (first, count) = (block * BLOCK, texels.len() / bins);
                radiance(first..first + count, seen);
                self.quadrature.each(seen, room, |bin, rgb| {
                    for (sample, texel) in encode_eight(rgb).into_iter().take(count).enumerate() {
                        texels[sample * bins + bin] = texel;
                    }
                });
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
            Vec::new,
            |all: &mut Vec<Arrival>, (sample, texels)| {
                if let Some(kept) = kept(sample) {
                    return texels.copy_from_slice(kept);
                }
                all.clear();
                arrivals.iter().for_each(|emitter| all.extend(emitter.of(sample)));
                if !all.is_empty() {
                    self.centres.texels(all, texels);
                }
            },
        );
        table
    }
}

/// Puts one sample's radiance beside that of others.
pub(super) fn spread(radiance: &[Vec3], lane: usize, out: &mut [Lanes]) {
    for (lanes, l) in out.iter_mut().zip(radiance) {
        (0..3).for_each(|c| lanes[c * BLOCK + lane] = l[c]);
    }
}
