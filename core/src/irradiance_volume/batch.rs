//! Many queries at once: some dozen at a time, stage by stage.
//!
//! Cells, weights and bins of all of them are found by vector arithmetic before the first is answered, so that
//! the loads of their samples overlap. Many queries without order are answered cell by cell: samples are asked
//! while they are near, where each for itself would fetch eight of them from afar. Each answer is to the last bit
//! that of a query alone.

use super::{Basis, IrradianceVolume, grid::trilinear, query::Corners};
use crate::math::part::Part;
use glam::Vec3;
use rayon::prelude::*;

/// Queries of a stage.
const AHEAD: usize = 64;

/// Queries from which on an order of their cells pays.
const MANY: usize = 4096;

/// A position and a unit normal.
type Query = (Vec3, Vec3);

impl IrradianceVolume {
    /// Many queries (position, unit normal) at once, on all threads: [`Self::irradiance`] of each.
    ///
    /// # Panics
    /// If `out` has another length than `queries`.
    pub fn irradiance_many(&self, queries: &[(Vec3, Vec3)], part: Part, out: &mut [Vec3]) {
        self.parts_many(queries, [part], bytemuck::cast_slice_mut(out));
    }

    /// As [`Self::irradiance_many`] on one thread.
    ///
    /// # Panics
    /// If `out` has another length than `queries`.
    pub fn irradiance_batch(&self, queries: &[(Vec3, Vec3)], part: Part, out: &mut [Vec3]) {
        self.parts_batch(queries, [part], bytemuck::cast_slice_mut(out));
    }

    /// Direct and indirect light of many queries, on all threads: [`Self::irradiance_parts`] of each.
    pub fn irradiance_parts_many(&self, queries: &[(Vec3, Vec3)]) -> Vec<[Vec3; 2]> {
        let mut out = vec![[Vec3::ZERO; 2]; queries.len()];
        self.parts_many(queries, [Part::Direct, Part::Indirect], &mut out);
        out
    }

    fn parts_many<const N: usize>(&self, queries: &[Query], parts: [Part; N], out: &mut [[Vec3; N]]) {
        assert_eq!(queries.len(), out.len(), "one result a query");
        let share = queries.len().div_ceil(4 * rayon::current_num_threads()).clamp(256, 16 * MANY);
        let chunks = queries.par_chunks(share).zip(out.par_chunks_mut(share));
        chunks.for_each(|(queries, out)| self.parts_batch(queries, parts, out));
    }

    fn parts_batch<const N: usize>(&self, queries: &[Query], parts: [Part; N], out: &mut [[Vec3; N]]) {
        assert_eq!(queries.len(), out.len(), "one result a query");
        let Some(order) = self.cell_by_cell(queries) else {
            for (queries, out) in queries.chunks(AHEAD).zip(out.chunks_mut(AHEAD)) {
                self.few(queries, parts, out);
            }
            return;
        };
        let (mut asked, mut found) = ([(Vec3::ZERO, Vec3::ZERO); AHEAD], [[Vec3::ZERO; N]; AHEAD]);
        for order in order.chunks(AHEAD) {
            for (asked, i) in asked.iter_mut().zip(order) {
                *asked = queries[*i as usize];
            }
            self.few(&asked[..order.len()], parts, &mut found);
            for (found, i) in found.iter().zip(order) {
                out[*i as usize] = *found;
            }
        }
    }

    /// The order in which queries come cell by cell; `None` where they are few, mostly do already, or ask so little
    /// that all of it is near.
    fn cell_by_cell(&self, queries: &[Query]) -> Option<Vec<u32>> {
        let little = self.settings.basis != Basis::Bins && self.guard.is_none();
        if queries.len() < MANY || little {
            return None;
        }
        let mut cells = Vec::with_capacity(queries.len());
        for queries in queries.chunks(AHEAD) {
            let at = self.grid.locate_each(&by_axis(queries, |q| q.0));
            cells.extend_from_slice(&at.cell[..queries.len()]);
        }
        let changes = cells.iter().zip(&cells[1..]).filter(|(a, b)| a != b).count();
        if 4 * changes < cells.len() {
            return None;
        }
        // A counting sort: where the queries of each cell begin, then where the next one goes.
        let mut next = vec![0u32; self.grid.cells().len() + 1];
        cells.iter().for_each(|cell| next[*cell as usize + 1] += 1);
        let mut sum = 0;
        for n in &mut next {
            sum += *n;
            *n = sum;
        }
        let mut order = vec![0; queries.len()];
        for (i, cell) in (0..).zip(cells) {
            let place = &mut next[cell as usize];
            order[*place as usize] = i;
            *place += 1;
        }
        Some(order)
    }

    /// At most [`AHEAD`] queries.
    #[inline(always)]
    fn few<const N: usize>(&self, queries: &[Query], parts: [Part; N], out: &mut [[Vec3; N]]) {
        let mut corners = [Corners::default(); AHEAD];
        self.corners_of(queries, &by_axis(queries, |q| q.0), &mut corners);
        let located = out.iter_mut().zip(&corners).take(queries.len());
        match self.settings.basis {
            Basis::Bins => {
                let bins = self.directions.interpolated_each(&by_axis(queries, |q| q.1));
                for ((out, c), b) in located.zip(&bins) {
                    *out = parts.map(|part| self.between_bins(self.tables_of(part), c, b));
                }
            }
            Basis::NearestBin => {
                let bins = self.directions.nearest_each(&by_axis(queries, |q| q.1));
                for ((out, c), b) in located.zip(bins) {
                    *out = parts.map(|part| self.of_bin(self.tables_of(part), c, b as usize));
                }
            }
            Basis::Harmonics => {
                for ((out, c), q) in located.zip(queries) {
                    *out = parts.map(|part| self.of_harmonics(c, q.1, part));
                }
            }
        }
    }

    /// Samples and weights of some queries.
    #[inline]
    fn corners_of(&self, queries: &[Query], points: &[[f32; AHEAD]; 3], out: &mut [Corners; AHEAD]) {
        let at = self.grid.locate_each(points);
        let cells = self.grid.cells();
        for (i, (corners, (position, _))) in out.iter_mut().zip(queries).enumerate() {
            let cell = at.cell[i];
            corners.ids = cells[cell as usize].samples;
            corners.weights = trilinear(at.of(i).offset);
            if !self.is_plain(*position, cell) {
                *corners = self.corrected(*position, cell, *corners);
            }
        }
    }
}

/// Vectors of some queries, axis by axis.
#[inline(always)]
fn by_axis(queries: &[Query], vector: impl Fn(&Query) -> Vec3) -> [[f32; AHEAD]; 3] {
    let mut axes = [[0.0; AHEAD]; 3];
    for (i, query) in queries.iter().enumerate() {
        let v = vector(query);
        (axes[0][i], axes[1][i], axes[2][i]) = (v.x, v.y, v.z);
    }
    axes
}
