//! Grid: where samples lie, and heights computed row by row.

use rayon::prelude::*;

/// The samples of a periodic tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    /// Samples `[ny, nx]`.
    pub(super) shape: [usize; 2],
    /// `[dx, dy]`, length units.
    pub(super) spacing: [f64; 2],
    /// Place of the first sample along x and y, in samples: from 0 to below 1.
    pub(super) first: [f64; 2],
}

impl Grid {
    /// Sides of the tile along x and y, length units.
    pub(super) fn lengths(&self) -> [f64; 2] {
        let ([ny, nx], [dx, dy]) = (self.shape, self.spacing);
        [nx as f64 * dx, ny as f64 * dy]
    }

    /// Area of the tile, length units squared.
    pub(super) fn area(&self) -> f64 {
        let [x, y] = self.lengths();
        x * y
    }

    /// The larger spacing, length units.
    pub(super) fn coarser_spacing(&self) -> f64 {
        self.spacing[0].max(self.spacing[1])
    }

    /// Heights `[ny, nx]`, row-major, of `height(scratch, [x, y])`. Each row has a scratch value of its own.
    pub(super) fn heights<S: Default>(
        &self,
        height: impl Fn(&mut S, [f64; 2]) -> f64 + Sync,
    ) -> Vec<f64> {
        let ([ny, nx], [dx, dy], [x0, y0]) = (self.shape, self.spacing, self.first);
        let mut heights = vec![0.0; nx * ny];
        heights
            .par_chunks_exact_mut(nx)
            .enumerate()
            .for_each(|(iy, row)| {
                let mut scratch = S::default();
                for (ix, h) in row.iter_mut().enumerate() {
                    *h = height(&mut scratch, [(ix as f64 + x0) * dx, (iy as f64 + y0) * dy]);
                }
            });
        heights
    }
}
