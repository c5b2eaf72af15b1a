//! Absorbed cells: the flux that the facets of each cell of a grid absorb, added from any thread.

use std::sync::atomic::{AtomicI64, Ordering};

/// Unit of the sums, as a power of two: 4.5e-13 of rounding per addition at the most, and room for the `2^20` rays of a batch in one cell.
const UNIT: f64 = 1.0 / (1_u64 << 40) as f64;

/// Sums of absorbed flux, one per cell of a height field or of a smooth surface.
///
/// Sums are whole numbers of a fixed unit, so that they do not depend on the order in which rays add to them.
#[derive(Debug)]
pub struct AbsorbedCells(Vec<AtomicI64>);

impl AbsorbedCells {
    /// Sums of zero for `count` cells.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self((0..count).map(|_| AtomicI64::new(0)).collect())
    }

    /// Flux absorbed by cell number `cell`, in incident rays.
    ///
    /// # Panics
    /// If there is no such cell.
    #[must_use]
    pub fn flux(&self, cell: usize) -> f64 {
        self.0[cell].load(Ordering::Relaxed) as f64 * UNIT
    }

    /// Adds flux that cell number `cell` absorbs.
    pub(crate) fn add(&self, cell: usize, flux: f64) {
        let units = (flux / UNIT).round() as i64;
        self.0[cell].fetch_add(units, Ordering::Relaxed);
    }
}
