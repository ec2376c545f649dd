//! Asking the volume: cell, bin, eight samples (Greger §4.3).

use super::{
    Basis, IrradianceVolume,
    codec::{SCALE, Texel, decode_rgb},
    grid::trilinear,
    harmonics,
    moments::Order,
    visibility::PointState,
};
use crate::{
    math::part::Part,
    scene::{
        direct::{Receiver, total_irradiance},
        world::World,
    },
};
use glam::Vec3;
use rayon::prelude::*;

/// Which samples light a point, and by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleWeights {
    /// Sample numbers; corner bit 0 is x, bit 1 y, bit 2 z.
    pub ids: [u32; 8],
    /// Weights in use; they sum to 1 and are 0 for samples inside solids, unless all eight are, and for
    /// hidden ones in a guarded volume. All are 0 where no sample sees the point.
    pub weights: [f32; 8],
    /// Trilinear weights before samples inside solids were left out.
    pub trilinear: [f32; 8],
    /// Which samples may be used.
    pub valid: [bool; 8],
    /// Which samples see the point; all of them without a guard.
    pub seen: [bool; 8],
    /// How far the answer can be trusted.
    pub state: PointState,
    /// Level of the cell, 1 or 2.
    pub level: u8,
}

/// Samples and weights of a query.
#[derive(Clone, Copy, Default)]
pub(super) struct Corners {
    pub ids: [u32; 8],
    pub weights: [f32; 8],
}

impl Corners {
    /// One sample and no other.
    pub fn alone(sample: u32) -> Self {
        Self { ids: [sample; 8], weights: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] }
    }
}

/// Queries of a batch that are located before the first is answered, so that their loads overlap.
const AHEAD: usize = 64;

impl IrradianceVolume {
    /// Irradiance at a point on a surface facing the unit vector `normal`, lx per channel.
    ///
    /// Trilinear between eight samples, by the basis of the settings. A point outside the grid is moved
    /// to the nearest one inside, and fades to the nearest sample from a quarter of a cell to a cell and
    /// a quarter beyond.
    pub fn irradiance(&self, position: Vec3, normal: Vec3, part: Part) -> Vec3 {
        match self.settings.basis {
            Basis::Bins => self.irradiance_bins(position, normal, part),
            Basis::NearestBin => self.irradiance_nearest_bin(position, normal, part),
            Basis::Harmonics => self.irradiance_harmonics(position, normal, part),
        }
    }

    /// As [`Self::irradiance`], bilinear between the four bins around the normal.
    pub fn irradiance_bins(&self, position: Vec3, normal: Vec3, part: Part) -> Vec3 {
        self.between_bins(&self.corners(position), normal, part)
    }

    /// As [`Self::irradiance`] but from the one bin that holds the normal, as the thesis has it: faster,
    /// and off by up to half a bin's width in direction.
    pub fn irradiance_nearest_bin(&self, position: Vec3, normal: Vec3, part: Part) -> Vec3 {
        self.of_nearest_bin(&self.corners(position), normal, part)
    }

    /// As [`Self::irradiance`] but from nine spherical-harmonic coefficients: fastest, and without what
    /// lies above band 2. Ringing below zero is cut off.
    pub fn irradiance_harmonics(&self, position: Vec3, normal: Vec3, part: Part) -> Vec3 {
        self.of_harmonics(&self.corners(position), normal, part)
    }

    /// Irradiance with the direct light evaluated at the point itself by `shadow_rays` rays an emitter, and
    /// only the indirect part from the volume, lx per channel: how moved objects are lit in the picture.
    ///
    /// Interpolation blurs shadow edges over a cell and misses the 1/d² of a lamp nearby; this does neither.
    pub fn irradiance_exact_direct(
        &self,
        world: &World,
        receiver: &Receiver,
        part: Part,
        shadow_rays: u32,
        scramble: u32,
    ) -> Vec3 {
        let indirect = || self.irradiance(receiver.position, receiver.normal, Part::Indirect);
        let direct = || total_irradiance(world, receiver, shadow_rays, scramble);
        match part {
            Part::Direct => direct(),
            Part::Indirect => indirect(),
            Part::All => direct() + indirect(),
        }
    }

    /// Many queries (position, unit normal) at once, on all threads.
    ///
    /// # Panics
    /// If `out` has another length than `queries`.
    pub fn irradiance_many(&self, queries: &[(Vec3, Vec3)], part: Part, out: &mut [Vec3]) {
        assert_eq!(queries.len(), out.len(), "one result a query");
        let chunks = queries.par_chunks(1024).zip(out.par_chunks_mut(1024));
        chunks.for_each(|(queries, out)| self.irradiance_batch(queries, part, out));
    }

    /// As [`Self::irradiance_many`] on one thread. Cells are found for some dozen queries before the first
    /// is answered: a third faster than one query after the other.
    ///
    /// # Panics
    /// If `out` has another length than `queries`.
    pub fn irradiance_batch(&self, queries: &[(Vec3, Vec3)], part: Part, out: &mut [Vec3]) {
        assert_eq!(queries.len(), out.len(), "one result a query");
        let mut corners = [Corners::default(); AHEAD];
        for (queries, out) in queries.chunks(AHEAD).zip(out.chunks_mut(AHEAD)) {
            for (corners, (position, _)) in corners.iter_mut().zip(queries) {
                *corners = self.corners(*position);
            }
            let located = corners.iter().zip(queries).zip(out);
            match self.settings.basis {
                Basis::Bins => located.for_each(|((c, q), out)| *out = self.between_bins(c, q.1, part)),
                Basis::NearestBin => {
                    located.for_each(|((c, q), out)| *out = self.of_nearest_bin(c, q.1, part));
                }
                Basis::Harmonics => located.for_each(|((c, q), out)| *out = self.of_harmonics(c, q.1, part)),
            }
        }
    }

    /// Which samples light a point.
    pub fn weights(&self, position: Vec3) -> SampleWeights {
        let at = self.grid.locate(position);
        let cell = &self.grid.cells()[at.cell as usize];
        let trilinear = trilinear(at.offset);
        let corners = Corners { ids: cell.samples, weights: usable(trilinear, cell.valid) };
        let careful = self.careful(position, corners, at.cell, cell.valid);
        SampleWeights {
            ids: careful.corners.ids,
            weights: careful.corners.weights,
            trilinear,
            valid: careful.corners.ids.map(|s| self.samples[s as usize].valid),
            seen: careful.seen,
            state: careful.state,
            level: at.level,
        }
    }

    /// Irradiance of every bin of one sample, lx per channel.
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn sample_irradiance(&self, sample: usize, part: Part) -> Vec<Vec3> {
        self.decoded([&self.tables.direct, &self.tables.indirect], sample, part)
    }

    fn decoded(&self, [direct, indirect]: [&[Texel]; 2], sample: usize, part: Part) -> Vec<Vec3> {
        let bins = self.bins().len();
        let of = |table: &[Texel]| -> Vec<Vec3> {
            table[sample * bins..][..bins].iter().map(|t| decode_rgb(*t)).collect()
        };
        match part {
            Part::Direct => of(direct),
            Part::Indirect => of(indirect),
            Part::All => of(direct).iter().zip(of(indirect)).map(|(d, i)| *d + i).collect(),
        }
    }

    /// Irradiance at one sample alone, by a basis.
    pub(super) fn at_sample(&self, sample: u32, normal: Vec3, part: Part, basis: Basis) -> Vec3 {
        let corners = Corners::alone(sample);
        match basis {
            Basis::Bins => self.between_bins(&corners, normal, part),
            Basis::NearestBin => self.of_nearest_bin(&corners, normal, part),
            Basis::Harmonics => self.of_harmonics(&corners, normal, part),
        }
    }

    #[inline(always)]
    fn corners(&self, position: Vec3) -> Corners {
        let at = self.grid.locate(position);
        let cell = &self.grid.cells()[at.cell as usize];
        let weights = trilinear(at.offset);
        let weights = if cell.valid == u8::MAX { weights } else { usable(weights, cell.valid) };
        let corners = Corners { ids: cell.samples, weights };
        let guarded = self.guard.as_ref().is_some_and(|g| !g.is_open(at.cell));
        let (low, high) = self.grid.bounds();
        if guarded || !(position.cmpge(low).all() && position.cmple(high).all()) {
            return self.careful(position, corners, at.cell, cell.valid).corners;
        }
        corners
    }

    /// Moment of an order at a point towards a unit direction, lx per channel (Greger Eq. 4.8): for a glossy
    /// surface the view vector mirrored at its normal, [`crate::math::frame::mirrored`]. Bilinear between
    /// bins. `None` where the volume does not hold the order; order 1 is [`Self::irradiance`].
    pub fn moment(&self, position: Vec3, direction: Vec3, order: Order, part: Part) -> Option<Vec3> {
        if order == Order::IRRADIANCE {
            return Some(self.irradiance(position, direction, part));
        }
        let table = self.tables.moments.iter().find(|m| m.order == order)?;
        let tables = [&table.direct[..], &table.indirect[..]];
        Some(self.between_bins_of(tables, &self.corners(position), direction, part))
    }

    /// Moment of every bin of one sample, lx per channel; `None` where the volume does not hold the order.
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn sample_moment(&self, sample: usize, order: Order, part: Part) -> Option<Vec<Vec3>> {
        if order == Order::IRRADIANCE {
            return Some(self.sample_irradiance(sample, part));
        }
        let table = self.tables.moments.iter().find(|m| m.order == order)?;
        Some(self.decoded([&table.direct, &table.indirect], sample, part))
    }

    #[inline(always)]
    fn between_bins(&self, corners: &Corners, normal: Vec3, part: Part) -> Vec3 {
        self.between_bins_of([&self.tables.direct, &self.tables.indirect], corners, normal, part)
    }

    #[inline(always)]
    fn between_bins_of(
        &self,
        tables: [&[Texel]; 2],
        Corners { ids, weights }: &Corners,
        normal: Vec3,
        part: Part,
    ) -> Vec3 {
        let b = self.directions.interpolated(normal);
        self.sum(tables, part, |table, stride| {
            let mut sum = [0.0f32; 4];
            for i in 0..8 {
                let sample = &table[ids[i] as usize * stride..][..stride];
                let w = weights[i] * SCALE;
                for k in 0..4 {
                    add(&mut sum, &sample[b.bins[k] as usize], w * b.weights[k]);
                }
            }
            sum
        })
    }

    #[inline(always)]
    fn of_nearest_bin(&self, Corners { ids, weights }: &Corners, normal: Vec3, part: Part) -> Vec3 {
        let bin = self.directions.nearest(normal);
        let tables = [&self.tables.direct[..], &self.tables.indirect[..]];
        self.sum(tables, part, |table, stride| {
            let mut sum = [0.0f32; 4];
            for i in 0..8 {
                add(&mut sum, &table[ids[i] as usize * stride + bin], weights[i] * SCALE);
            }
            sum
        })
    }

    #[inline(always)]
    fn of_harmonics(&self, Corners { ids, weights }: &Corners, normal: Vec3, part: Part) -> Vec3 {
        harmonics::evaluate(self.tables.harmonics().of(part), ids, weights, &harmonics::towards(normal))
    }

    #[inline(always)]
    fn sum(
        &self,
        [direct, indirect]: [&[Texel]; 2],
        part: Part,
        lookup: impl Fn(&[Texel], usize) -> [f32; 4],
    ) -> Vec3 {
        let stride = self.bins().len();
        let vector = |v: [f32; 4]| Vec3::new(v[0], v[1], v[2]);
        match part {
            Part::Direct => vector(lookup(direct, stride)),
            Part::Indirect => vector(lookup(indirect, stride)),
            Part::All => vector(lookup(direct, stride)) + vector(lookup(indirect, stride)),
        }
    }
}

/// Adds a weighted texel; the weight carries the codec's scale.
#[inline(always)]
fn add(sum: &mut [f32; 4], texel: &Texel, weight: f32) {
    for (s, code) in sum.iter_mut().zip(texel) {
        *s = f32::from_bits(u32::from(*code) << 13).mul_add(weight, *s);
    }
}

/// Weights without the samples that are not valid, summing to 1 again; all of them where none is.
fn usable(weights: [f32; 8], valid: u8) -> [f32; 8] {
    let kept: [f32; 8] = std::array::from_fn(|i| if valid >> i & 1 == 1 { weights[i] } else { 0.0 });
    let sum: f32 = kept.iter().sum();
    if sum > 0.0 {
        return kept.map(|w| w / sum);
    }
    // The point lies on a face, edge or corner whose samples are all inside solids: the others, alike.
    match valid.count_ones() {
        0 => weights,
        n => std::array::from_fn(|i| f32::from(valid >> i & 1) / n as f32),
    }
}
