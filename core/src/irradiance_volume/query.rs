//! Asking the volume: cell, bin, eight samples (Greger §4.3).

use super::{
    IrradianceVolume,
    codec::{SCALE, Texel, decode_rgb},
    grid::trilinear,
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
    /// Weights in use; they sum to 1 and are 0 for samples inside solids, unless all eight are.
    pub weights: [f32; 8],
    /// Trilinear weights before samples inside solids were left out.
    pub trilinear: [f32; 8],
    /// Which samples may be used.
    pub valid: [bool; 8],
    /// Level of the cell, 1 or 2.
    pub level: u8,
}

impl IrradianceVolume {
    /// Irradiance at a point on a surface facing the unit vector `normal`, lx per channel.
    ///
    /// Trilinear between eight samples and bilinear between the four bins around the normal. A point
    /// outside the grid is moved to the nearest one inside.
    pub fn irradiance(&self, position: Vec3, normal: Vec3, part: Part) -> Vec3 {
        let (ids, weights) = self.corners(position);
        let b = self.directions.interpolated(normal);
        self.sum(part, |table, stride| {
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

    /// As [`Self::irradiance`] but from the one bin that holds the normal, as the thesis has it: faster,
    /// and off by up to half a bin's width in direction.
    pub fn irradiance_nearest_bin(&self, position: Vec3, normal: Vec3, part: Part) -> Vec3 {
        let (ids, weights) = self.corners(position);
        let bin = self.directions.nearest(normal);
        self.sum(part, |table, stride| {
            let mut sum = [0.0f32; 4];
            for i in 0..8 {
                add(&mut sum, &table[ids[i] as usize * stride + bin], weights[i] * SCALE);
            }
            sum
        })
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
        queries.par_chunks(1024).zip(out.par_chunks_mut(1024)).for_each(|(queries, out)| {
            for ((position, normal), out) in queries.iter().zip(out) {
                *out = self.irradiance(*position, *normal, part);
            }
        });
    }

    /// Which samples light a point.
    pub fn weights(&self, position: Vec3) -> SampleWeights {
        let at = self.grid.locate(position);
        let cell = &self.grid.cells()[at.cell as usize];
        let trilinear = trilinear(at.offset);
        SampleWeights {
            ids: cell.samples,
            weights: usable(trilinear, cell.valid),
            trilinear,
            valid: std::array::from_fn(|i| cell.valid >> i & 1 == 1),
            level: at.level,
        }
    }

    /// Irradiance of every bin of one sample, lx per channel.
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn sample_irradiance(&self, sample: usize, part: Part) -> Vec<Vec3> {
        let bins = self.bins().len();
        let of = |table: &[Texel]| -> Vec<Vec3> {
            table[sample * bins..][..bins].iter().map(|t| decode_rgb(*t)).collect()
        };
        match part {
            Part::Direct => of(&self.tables.direct),
            Part::Indirect => of(&self.tables.indirect),
            Part::All => {
                of(&self.tables.direct).iter().zip(of(&self.tables.indirect)).map(|(d, i)| *d + i).collect()
            }
        }
    }

    fn corners(&self, position: Vec3) -> ([u32; 8], [f32; 8]) {
        let at = self.grid.locate(position);
        let cell = &self.grid.cells()[at.cell as usize];
        let weights = trilinear(at.offset);
        (cell.samples, if cell.valid == u8::MAX { weights } else { usable(weights, cell.valid) })
    }

    #[inline(always)]
    fn sum(&self, part: Part, lookup: impl Fn(&[Texel], usize) -> [f32; 4]) -> Vec3 {
        let stride = self.bins().len();
        let vector = |v: [f32; 4]| Vec3::new(v[0], v[1], v[2]);
        match part {
            Part::Direct => vector(lookup(&self.tables.direct, stride)),
            Part::Indirect => vector(lookup(&self.tables.indirect, stride)),
            Part::All => {
                vector(lookup(&self.tables.direct, stride)) + vector(lookup(&self.tables.indirect, stride))
            }
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
