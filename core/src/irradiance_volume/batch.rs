//! Many queries at once: some dozen at a time, stage by stage.
//!
//! Cells, weights and bins of all of them are found by vector arithmetic before the first is answered, so that
//! the loads of their samples overlap. Each answer is to the last bit that of a query alone.

use super::{Basis, IrradianceVolume, query::Corners};
use crate::math::part::Part;
use glam::Vec3;
use rayon::prelude::*;

/// Queries of a stage.
const AHEAD: usize = 64;

impl IrradianceVolume {
    /// Many queries (position, unit normal) at once, on all threads: [`Self::irradiance`] of each.
    ///
    /// # Panics
    /// If `out` has another length than `queries`.
    pub fn irradiance_many(&self, queries: &[(Vec3, Vec3)], part: Part, out: &mut [Vec3]) {
        assert_eq!(queries.len(), out.len(), "one result a query");
        let chunks = queries.par_chunks(1024).zip(out.par_chunks_mut(1024));
        chunks.for_each(|(queries, out)| self.irradiance_batch(queries, part, out));
    }

    /// As [`Self::irradiance_many`] on one thread.
    ///
    /// # Panics
    /// If `out` has another length than `queries`.
    pub fn irradiance_batch(&self, queries: &[(Vec3, Vec3)], part: Part, out: &mut [Vec3]) {
        assert_eq!(queries.len(), out.len(), "one result a query");
        for (queries, out) in queries.chunks(AHEAD).zip(out.chunks_mut(AHEAD)) {
            self.irradiance_few(queries, part, out);
        }
    }

    /// At most [`AHEAD`] queries.
    #[inline(always)]
    fn irradiance_few(&self, queries: &[(Vec3, Vec3)], part: Part, out: &mut [Vec3]) {
        let mut corners = [Corners::default(); AHEAD];
        self.corners_of(queries, &by_axis(queries, |q| q.0), &mut corners);
        let tables = self.tables_of(part);
        let located = out.iter_mut().zip(&corners);
        match self.settings.basis {
            Basis::Bins => {
                let bins = self.directions.interpolated_each(&by_axis(queries, |q| q.1));
                located.zip(&bins).for_each(|((out, c), b)| *out = self.between_bins(tables, c, b));
            }
            Basis::NearestBin => {
                let bins = self.directions.nearest_each(&by_axis(queries, |q| q.1));
                located.zip(bins).for_each(|((out, c), b)| *out = self.of_bin(tables, c, b as usize));
            }
            Basis::Harmonics => {
                located.zip(queries).for_each(|((out, c), q)| *out = self.of_harmonics(c, q.1, part));
            }
        }
    }

    /// Samples and weights of some queries.
    #[inline]
    fn corners_of(&self, queries: &[(Vec3, Vec3)], points: &[[f32; AHEAD]; 3], out: &mut [Corners; AHEAD]) {
        let at = self.grid.locate_each(points);
        let cells = self.grid.cells();
        let weights = at.trilinear();
        for (i, (corners, (position, _))) in out.iter_mut().zip(queries).enumerate() {
            let cell = at.cell[i];
            corners.ids = cells[cell as usize].samples;
            corners.weights = weights.each_ref().map(|w| w[i]);
            if !self.is_plain(*position, cell) {
                *corners = self.corrected(*position, cell, *corners);
            }
        }
    }
}

/// Vectors of some queries, axis by axis.
#[inline(always)]
fn by_axis(queries: &[(Vec3, Vec3)], vector: impl Fn(&(Vec3, Vec3)) -> Vec3) -> [[f32; AHEAD]; 3] {
    let mut axes = [[0.0; AHEAD]; 3];
    for (i, query) in queries.iter().enumerate() {
        let v = vector(query);
        (axes[0][i], axes[1][i], axes[2][i]) = (v.x, v.y, v.z);
    }
    axes
}
