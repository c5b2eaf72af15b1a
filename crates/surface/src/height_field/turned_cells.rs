//! Turned cells: cells that are split along their other diagonal.

use rayon::prelude::*;

/// The cells of a grid that are split along the diagonal from their corner 10 to 01, as their surface has an edge there; all
/// others are split from 00 to 11.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedCells {
    /// One bit per cell; rows begin with a word.
    bits: Vec<u64>,
    words_per_row: usize,
}

impl TurnedCells {
    /// The cells `(ix, iy)` of a periodic grid of shape `[ny, nx]` for which `is_turned` holds; `None` if it holds for none.
    pub fn new(
        [ny, nx]: [usize; 2],
        is_turned: impl Fn(usize, usize) -> bool + Sync,
    ) -> Option<Self> {
        let words_per_row = nx.div_ceil(64);
        let mut bits = vec![0_u64; words_per_row * ny];
        let rows = bits.par_chunks_mut(words_per_row).enumerate();
        rows.for_each(|(iy, row)| {
            for ix in (0..nx).filter(|&ix| is_turned(ix, iy)) {
                row[ix / 64] |= 1 << (ix % 64);
            }
        });
        bits.iter().any(|word| *word != 0).then_some(Self {
            bits,
            words_per_row,
        })
    }

    /// Returns `true` if the cell `(ix, iy)`, which must lie in the grid, is one of them.
    #[inline]
    #[must_use]
    pub fn contains(&self, ix: usize, iy: usize) -> bool {
        self.bits[iy * self.words_per_row + ix / 64] >> (ix % 64) & 1 != 0
    }
}
