//! Asking the volume: cell, bin, eight samples (Greger §4.3).

use super::{
    Basis, IrradianceVolume,
    codec::{SCALE, Texel, decode_rgb, unscaled},
    directions::BinWeights,
    grid::trilinear,
    harmonics,
    moments::Order,
    sight::Look,
    visibility::{PointState, shared},
};
use crate::{
    math::part::Part,
    scene::{
        direct::{Receiver, total_irradiance},
        world::World,
    },
};
use glam::{Vec3, Vec4, Vec4Swizzles};
use wide::{f32x8, u32x8};

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

impl IrradianceVolume {
    /// Irradiance at a point on a surface facing the unit vector `normal`, lx per channel.
    ///
    /// Trilinear between eight samples, by the basis of the settings. A point outside the grid is moved
    /// to the nearest one inside, and fades to the nearest sample from a quarter of a cell to a cell and
    /// a quarter beyond.
    pub fn irradiance(&self, position: Vec3, normal: Vec3, part: Part) -> Vec3 {
        let [e] = self.at_corners(&self.corners(position), normal, [part], self.settings.basis);
        e
    }

    /// Direct and indirect light at once: [`Self::irradiance`] of each, with the samples found once.
    pub fn irradiance_parts(&self, position: Vec3, normal: Vec3) -> [Vec3; 2] {
        let parts = [Part::Direct, Part::Indirect];
        self.at_corners(&self.corners(position), normal, parts, self.settings.basis)
    }

    /// As [`Self::irradiance`], bilinear between the four bins around the normal.
    pub fn irradiance_bins(&self, position: Vec3, normal: Vec3, part: Part) -> Vec3 {
        let bins = self.directions.interpolated(normal);
        self.between_bins(self.tables_of(part), &self.corners(position), &bins)
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

    /// Which samples light a point.
    pub fn weights(&self, position: Vec3) -> SampleWeights {
        let at = self.grid.locate(position);
        let cell = &self.grid.cells()[at.cell as usize];
        let trilinear = trilinear(at.offset);
        let corners = Corners { ids: cell.samples, weights: usable(trilinear, cell.valid) };
        let mut careful = self.careful(position, corners, at.cell, cell.valid);
        if careful.state == PointState::Borrowed
            && self.grid.pocket(at.cell, position) == Some(careful.corners.ids[0])
        {
            careful.state = PointState::Inside;
        }
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
        let [e] = self.at_corners(&Corners::alone(sample), normal, [part], basis);
        e
    }

    /// Parts of the irradiance from weighted samples, by a basis.
    #[inline(always)]
    fn at_corners<const N: usize>(
        &self,
        corners: &Corners,
        normal: Vec3,
        parts: [Part; N],
        basis: Basis,
    ) -> [Vec3; N] {
        match basis {
            Basis::Bins => {
                let bins = self.directions.interpolated(normal);
                parts.map(|part| self.between_bins(self.tables_of(part), corners, &bins))
            }
            Basis::NearestBin => {
                let bin = self.directions.nearest(normal);
                parts.map(|part| self.of_bin(self.tables_of(part), corners, bin))
            }
            Basis::Harmonics => parts.map(|part| self.of_harmonics(corners, normal, part)),
        }
    }

    fn corners(&self, position: Vec3) -> Corners {
        let at = self.grid.locate(position);
        let cell = &self.grid.cells()[at.cell as usize];
        let corners = Corners { ids: cell.samples, weights: trilinear(at.offset) };
        if self.is_plain(position, at.cell) { corners } else { self.corrected(position, at.cell, corners) }
    }

    /// Whether trilinear weights hold at a point of a cell as they are: inside the grid, with all samples in free
    /// air, and nothing in the cell that could hide one.
    #[inline(always)]
    pub(super) fn is_plain(&self, position: Vec3, cell: u32) -> bool {
        let (low, high) = self.grid.bounds();
        self.grid.cells()[cell as usize].valid == u8::MAX
            && self.guard.as_ref().is_none_or(|g| g.is_open(cell))
            && (position.cmpge(low) & position.cmple(high)).all()
    }

    /// Trilinear weights without the samples that may not be used and those that are hidden.
    #[inline(never)]
    pub(super) fn corrected(&self, position: Vec3, cell: u32, corners: Corners) -> Corners {
        let valid = self.grid.cells()[cell as usize].valid;
        let weights = if valid == u8::MAX { corners.weights } else { usable(corners.weights, valid) };
        let corners = Corners { weights, ..corners };
        let (low, high) = self.grid.bounds();
        if (position.cmpge(low) & position.cmple(high)).all() {
            match self.guard.as_ref().filter(|g| !g.is_open(cell)) {
                None => return corners,
                Some(guard) => match guard.known(cell, position) {
                    Look::Samples(seen) => {
                        return Corners { weights: shared(corners.weights, seen, valid), ..corners };
                    }
                    Look::Lender(sample) => return Corners::alone(sample),
                    Look::Nothing => return Corners { weights: [0.0; 8], ..corners },
                    Look::Ask => {}
                },
            }
        }
        self.careful(position, corners, cell, valid).corners
    }

    /// Moment of an order at a point towards a unit direction, lx per channel (Greger Eq. 4.8): for a glossy
    /// surface the view vector mirrored at its normal, [`crate::math::frame::mirrored`]. Bilinear between
    /// bins. `None` where the volume does not hold the order; order 1 is [`Self::irradiance`].
    pub fn moment(&self, position: Vec3, direction: Vec3, order: Order, part: Part) -> Option<Vec3> {
        if order == Order::IRRADIANCE {
            return Some(self.irradiance(position, direction, part));
        }
        let table = self.tables.moments.iter().find(|m| m.order == order)?;
        let tables = of_part([&table.direct, &table.indirect], part);
        Some(self.between_bins(tables, &self.corners(position), &self.directions.interpolated(direction)))
    }

    /// Direct and indirect light at once: [`Self::moment`] of each, with the samples found once.
    pub fn moment_parts(&self, position: Vec3, direction: Vec3, order: Order) -> Option<[Vec3; 2]> {
        if order == Order::IRRADIANCE {
            return Some(self.irradiance_parts(position, direction));
        }
        let table = self.tables.moments.iter().find(|m| m.order == order)?;
        let (corners, bins) = (self.corners(position), self.directions.interpolated(direction));
        let of = |part| self.between_bins(of_part([&table.direct, &table.indirect], part), &corners, &bins);
        Some([Part::Direct, Part::Indirect].map(of))
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

    /// The tables whose sum is a part of the light.
    pub(super) fn tables_of(&self, part: Part) -> Summed<'_> {
        of_part([&self.tables.direct, &self.tables.indirect], part)
    }

    /// Between four bins of eight samples.
    #[inline(always)]
    pub(super) fn between_bins(&self, tables: Summed, corners: &Corners, between: &BinWeights) -> Vec3 {
        let stride = self.bins().len();
        let bins = between.bins.map(usize::from);
        assert!(bins.iter().all(|b| *b < stride), "a bin of its own");
        let shares = Vec4::from_array(between.weights) * SCALE;
        let shares: f32x8 = bytemuck::cast([shares.xxyy(), shares.zzww()]);
        let mut total = Vec3::ZERO;
        for table in tables.into_iter().flatten() {
            let mut sums = [f32x8::ZERO; 2];
            for (id, weight) in corners.ids.iter().zip(corners.weights) {
                let sample = &table[*id as usize * stride..][..stride];
                let [red_blue, green] = unscaled(bins.map(|b| sample[b]));
                let weight = f32x8::splat(weight);
                sums = [red_blue.mul_add(weight, sums[0]), green.mul_add(weight, sums[1])];
            }
            total += added(sums.map(|sum| sum * shares));
        }
        total
    }

    /// One bin of eight samples.
    #[inline(always)]
    pub(super) fn of_bin(&self, tables: Summed, corners: &Corners, bin: usize) -> Vec3 {
        let stride = self.bins().len();
        let mut total = Vec3::ZERO;
        for table in tables.into_iter().flatten() {
            let mut sums = [f32x8::ZERO; 2];
            for half in [0, 4] {
                let sample = |i: usize| table[corners.ids[half + i] as usize * stride + bin];
                let [red_blue, green] = unscaled(std::array::from_fn(sample));
                let weights = Vec4::from_slice(&corners.weights[half..]);
                let weight: f32x8 = bytemuck::cast([weights.xxyy(), weights.zzww()]);
                sums = [red_blue.mul_add(weight, sums[0]), green.mul_add(weight, sums[1])];
            }
            total += added(sums) * SCALE;
        }
        total
    }

    #[inline(always)]
    pub(super) fn of_harmonics(&self, Corners { ids, weights }: &Corners, normal: Vec3, part: Part) -> Vec3 {
        harmonics::evaluate(self.tables.harmonics().of(part), ids, weights, &harmonics::towards(normal))
    }
}

/// Sum of four texels, of red and blue and of green, as [`unscaled`] has them.
#[inline(always)]
fn added(sums: [f32x8; 2]) -> Vec3 {
    let [rb, g] = sums.map(|sum| {
        let [low, high]: [Vec4; 2] = bytemuck::cast(sum);
        let both = low + high;
        both + both.zwxy()
    });
    Vec3::new(rb.x, g.x, rb.y)
}

/// One table or two, whose values are added.
pub(super) type Summed<'a> = [Option<&'a [Texel]>; 2];

fn of_part<'a>([direct, indirect]: [&'a [Texel]; 2], part: Part) -> Summed<'a> {
    [(part != Part::Indirect).then_some(direct), (part != Part::Direct).then_some(indirect)]
}

/// Weights without the samples that are not valid, summing to 1 again; all of them where none is.
pub(super) fn usable(weights: [f32; 8], valid: u8) -> [f32; 8] {
    // The point may lie on a face, edge or corner whose samples are all inside solids: the others, alike.
    kept(&weights, valid).unwrap_or_else(|| if valid == 0 { weights } else { alike(valid) })
}

/// Weights of the samples named by a bit each, summing to 1: unchanged where the others weigh nothing. `None` where
/// the named weigh nothing.
#[inline(always)]
pub(super) fn kept(weights: &[f32; 8], named: u8) -> Option<[f32; 8]> {
    let bits = u32x8::new([1, 2, 4, 8, 16, 32, 64, 128]);
    let weights = f32x8::new(*weights);
    let mask: f32x8 = bytemuck::cast((u32x8::splat(named.into()) & bits).simd_eq(bits));
    let kept = mask & weights;
    if !kept.simd_ne(weights).any() {
        return Some(weights.to_array());
    }
    let sum = kept.reduce_add();
    (sum > 0.0).then(|| (kept / f32x8::splat(sum)).to_array())
}

/// The same weight for every sample named by a bit.
pub(super) fn alike(named: u8) -> [f32; 8] {
    std::array::from_fn(|i| f32::from(named >> i & 1) / named.count_ones() as f32)
}
