//! Turned cells: cells that are split along their other diagonal.

use rayon::prelude::*;

/// The cells of a grid that are split along the diagonal from their corner 10 to 01, as their surface has an edge there; all
/// others are split from 00 to 11.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedCells {
    /// One bit per cell; rows begin with a word.
    bits: Vec<u64>,
    words_per_row: usize,
    /// `[ny, nx]`.
    shape: [usize; 2],
}

impl TurnedCells {
    /// The cells `(ix, iy)` of a periodic grid of shape `[ny, nx]` for which `is_turned` holds.
    pub fn new([ny, nx]: [usize; 2], is_turned: impl Fn(usize, usize) -> bool + Sync) -> Self {
        let words_per_row = nx.div_ceil(64);
        let mut bits = vec![0_u64; words_per_row * ny];
        let rows = bits.par_chunks_mut(words_per_row).enumerate();
        rows.for_each(|(iy, row)| {
            for ix in (0..nx).filter(|&ix| is_turned(ix, iy)) {
                row[ix / 64] |= 1 << (ix % 64);
            }
        });
        Self {
            bits,
            words_per_row,
            shape: [ny, nx],
        }
    }

    /// Returns `true` if no cell is one of them.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bits.iter().all(|word| *word == 0)
    }

    /// The turned cells of the mirror image with rows in reverse order, which turns every diagonal.
    pub(crate) fn flipped(&self) -> Self {
        let [ny, _] = self.shape;
        // The last row of cells lies between the last row of samples and the first
        Self::new(self.shape, |ix, iy| {
            !self.contains(ix, (2 * ny - 2 - iy) % ny)
        })
    }

    /// Returns `true` if the cell `(ix, iy)`, which must lie in the grid, is one of them.
    #[inline]
    #[must_use]
    pub fn contains(&self, ix: usize, iy: usize) -> bool {
        self.bits[iy * self.words_per_row + ix / 64] >> (ix % 64) & 1 != 0
    }
}
