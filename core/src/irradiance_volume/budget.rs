//! What a volume takes of memory, known before any of it is taken.
//!
//! A bound and not a measurement: what rays met is held twice while it is put together, and every aimed ray
//! is taken to leave an entry. [`IrradianceVolume::bytes`](super::IrradianceVolume::bytes) is what is held
//! in the end.

use super::{Sample, VolumeError, VolumeSettings, grid::BilevelGrid, pockets, rays::Extra};
use glam::UVec3;

/// Bytes that the guard takes a cell of the second level, about: its box, what stands in it, and who sees each
/// of its 8³ leaves.
const GUARD_BYTES: u64 = 2_304;

/// Bytes that a volume may take.
pub const MOST_BYTES: u64 = 4 << 30;

impl VolumeSettings {
    /// Bytes that a volume of so many samples takes while it is built: tables of both parts, of the irradiance
    /// and each moment; what rays met; nine coefficients; and the matrices of Eq. 4.3 (4 ⌈n/2⌉⁴ numbers) and
    /// 4.8 (8 ⌈n/2⌉⁴ an order).
    pub fn bytes(&self, samples: u64) -> u64 {
        let (n, orders) = (u64::from(self.bins_n), self.moments.len() as u64);
        let rays = 2 * size_of::<u32>() as u64 * u64::from(self.supersample);
        let tables = 2 * size_of::<super::codec::Texel>() as u64 * (1 + orders);
        let aimed = 2 * size_of::<Extra>() as u64 * u64::from(self.informed_rays);
        let sample = 2 * n * n * (tables + rays) + aimed + 256 + size_of::<Sample>() as u64;
        samples.saturating_mul(sample) + n.div_ceil(2).pow(4) * 4 * (4 + 8 * orders)
    }

    /// Whether a volume of so many samples fits.
    ///
    /// # Errors
    /// [`VolumeError::TooLarge`].
    pub fn check_samples(&self, samples: u64) -> Result<(), VolumeError> {
        self.fits(samples, self.bytes(samples))
    }

    /// Whether a volume whose first level has so many cells fits, however few of them are divided: its
    /// samples, the lattice of both levels that they are numbered on, and what guards queries.
    ///
    /// # Errors
    /// [`VolumeError::TooLarge`].
    pub fn check_cells(&self, size: UVec3) -> Result<(), VolumeError> {
        let inner = u64::from(self.second_level.max(2) - 1);
        let product = |of: &dyn Fn(u64) -> u64| {
            size.to_array().iter().map(|n| of(u64::from(*n))).fold(1u64, u64::saturating_mul)
        };
        let lattice = product(&|n| n * inner + 1).saturating_mul(size_of::<u32>() as u64);
        self.check_parts(product(&|n| n + 1), product(&|n| n * inner), lattice)
    }

    /// Whether a volume on a grid fits, with what guards its queries and what choosing pockets takes.
    ///
    /// # Errors
    /// [`VolumeError::TooLarge`].
    pub fn check_grid(&self, grid: &BilevelGrid) -> Result<(), VolumeError> {
        self.check_parts(grid.places().len() as u64, grid.cells().len() as u64, 0)
    }

    fn check_parts(&self, samples: u64, cells: u64, rest: u64) -> Result<(), VolumeError> {
        let most = u64::from(self.pocket_samples);
        let (guard, chosen) = match (self.guard, most) {
            (false, _) => (0, 0),
            (true, 0) => (cells.saturating_mul(GUARD_BYTES), 0),
            (true, most) => (cells.saturating_mul(GUARD_BYTES), pockets::bytes(cells, most)),
        };
        let samples = samples + if self.guard { most } else { 0 };
        let bytes = [guard, chosen, rest].into_iter().fold(self.bytes(samples), u64::saturating_add);
        self.fits(samples, bytes)
    }

    fn fits(&self, samples: u64, bytes: u64) -> Result<(), VolumeError> {
        if bytes <= MOST_BYTES {
            return Ok(());
        }
        let bins = 2 * self.bins_n * self.bins_n;
        Err(VolumeError::TooLarge {
            samples,
            bins,
            orders: self.moments.len(),
            gigabytes: bytes as f64 / 1e9,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::irradiance_volume::moments::Order;

    #[test]
    fn the_usual_volume_fits_and_absurd_ones_do_not() {
        let usual = VolumeSettings::default();
        assert!(usual.check_samples(2_287).is_ok());
        // 8 · 10⁶ samples of 578 bins at 24 bytes and more.
        assert!(usual.bytes(8_000_000) > 110_000_000_000);
        let fine = VolumeSettings { samples: Some([200; 3]), guard: false, ..usual.clone() };
        assert!(matches!(fine.check(), Err(VolumeError::TooLarge { samples: 8_000_000, bins: 578, .. })));
        // Two bins a sample, but a lattice of 1593³ places.
        let lattice = VolumeSettings { bins_n: 1, second_level: 9, ..fine.clone() };
        assert!(matches!(lattice.check(), Err(VolumeError::TooLarge { .. })));
        // A million pockets, and eighths of 8 · 10⁶ cells compared.
        let pockets = VolumeSettings { bins_n: 1, pocket_samples: 1_000_000, guard: true, ..fine.clone() };
        assert!(matches!(pockets.check_parts(1000, 8_000_000, 0), Err(VolumeError::TooLarge { .. })));
        let unguarded = VolumeSettings { guard: false, ..pockets };
        assert!(unguarded.check_parts(1000, 8_000_000, 0).is_ok());
        // Eight orders at n = 128: matrices of 8 · 64⁴ numbers each.
        let orders = (2..10).map(Order::Finite).collect();
        let moments = VolumeSettings { bins_n: 128, moments: orders, samples: Some([2; 3]), ..usual };
        let error = moments.check().unwrap_err().to_string();
        assert!(error.contains("8 moments") && !error.contains('\n'), "{error}");
    }
}
