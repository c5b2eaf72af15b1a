//! Height bounds: lowest and highest points of a surface, block by block, by which a short stretch of a ray passes
//! without a search.
//!
//! Many rays over long distances are searched together, by an accelerator. Free flights inside a medium are
//! short, and follow one another: for these the bounds of a few blocks are faster.

use crate::ray::HalfSpace;

/// Cells along the side of the smallest blocks.
const SMALLEST: usize = 4;

/// Lowest and highest point over blocks of 4, 8, 16, ... cells per side, down to one block.
#[derive(Clone, Debug)]
pub(crate) struct HeightBounds {
    levels: Vec<Level>,
}

/// Blocks of one size, row by row.
#[derive(Clone, Debug)]
struct Level {
    columns: usize,
    rows: usize,
    bounds: Vec<[f64; 2]>,
}

/// A rectangle of cells: first and last column, first and last row.
pub(crate) type Cells = [[u32; 2]; 2];

impl HeightBounds {
    /// Bounds over `[columns, rows]` cells; `ranges` gives the lowest and the highest points of those of a row.
    pub(crate) fn new([cx, cy]: [usize; 2], ranges: impl Fn(usize, &mut Vec<[f64; 2]>)) -> Self {
        let (columns, rows) = (cx.div_ceil(SMALLEST), cy.div_ceil(SMALLEST));
        let mut bounds = vec![[f64::INFINITY, f64::NEG_INFINITY]; columns * rows];
        let mut of_row = Vec::new();
        for iy in 0..cy {
            ranges(iy, &mut of_row);
            let bounds = &mut bounds[iy / SMALLEST * columns..][..columns];
            for ([low, high], cells) in bounds.iter_mut().zip(of_row.chunks(SMALLEST)) {
                for [lowest, highest] in cells {
                    (*low, *high) = (low.min(*lowest), high.max(*highest));
                }
            }
        }
        let mut levels = vec![Level {
            columns,
            rows,
            bounds,
        }];
        while let Some(last) = levels.last()
            && last.bounds.len() > 1
        {
            let next = last.joined_by_four();
            levels.push(next);
        }
        Self { levels }
    }

    /// Returns `true` if no height over `cells` comes as near as `z` to a ray in `half_space`: all are higher than `z`
    /// for a ray below, and lower for a ray above.
    #[inline]
    pub(crate) fn is_clear(&self, cells: Cells, half_space: HalfSpace, z: f64) -> bool {
        let [[x0, x1], [y0, y1]] = cells.map(|range| range.map(|i| i as usize / SMALLEST));
        // Blocks of which two or three cover the rectangle along each axis.
        let longest = (x1 - x0).max(y1 - y0);
        let level = (usize::BITS - longest.leading_zeros()).saturating_sub(1);
        let Some(blocks) = self.levels.get(level as usize) else {
            return false;
        };
        (y0 >> level..=y1 >> level).all(|row| {
            (x0 >> level..=x1 >> level).all(|column| {
                let [low, high] = blocks.bounds[row * blocks.columns + column];
                match half_space {
                    HalfSpace::Above => high < z,
                    HalfSpace::Below => low > z,
                }
            })
        })
    }
}

impl Level {
    fn joined_by_four(&self) -> Self {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let mut bounds = vec![[f64::INFINITY, f64::NEG_INFINITY]; columns * rows];
        for (i, [low, high]) in self.bounds.iter().enumerate() {
            let (row, column) = (i / self.columns, i % self.columns);
            let joined = &mut bounds[row / 2 * columns + column / 2];
            *joined = [joined[0].min(*low), joined[1].max(*high)];
        }
        Self {
            columns,
            rows,
            bounds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_those_of_all_points_of_the_cells() {
        // A bowl with a peak: heights that differ everywhere.
        let z = |ix: usize, iy: usize| {
            let (x, y) = (ix as f64 - 8.3, iy as f64 - 5.7);
            0.1 * (x * x + y * y) + if (ix, iy) == (13, 9) { 50.0 } else { 0.0 }
        };
        let [cx, cy] = [19, 13];
        let range = |[ix, iy]: [u32; 2]| {
            let (ix, iy) = (ix as usize, iy as usize);
            let corners = [z(ix, iy), z(ix + 1, iy), z(ix, iy + 1), z(ix + 1, iy + 1)];
            let fold = |first, of: fn(f64, f64) -> f64| corners.into_iter().fold(first, of);
            [
                fold(f64::INFINITY, f64::min),
                fold(f64::NEG_INFINITY, f64::max),
            ]
        };
        let height_bounds = HeightBounds::new([cx, cy], |iy, ranges| {
            ranges.clear();
            ranges.extend((0..cx as u32).map(|ix| range([ix, iy as u32])));
        });
        for y0 in 0..cy {
            for y1 in y0..cy {
                for x0 in 0..cx {
                    for x1 in x0..cx {
                        let cells = [[x0, x1], [y0, y1]].map(|r| r.map(|i| i as u32));
                        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
                        for iy in y0..=y1 + 1 {
                            for ix in x0..=x1 + 1 {
                                (low, high) = (low.min(z(ix, iy)), high.max(z(ix, iy)));
                            }
                        }
                        // Never clear of what lies there, and clear of all that is.
                        assert!(!height_bounds.is_clear(cells, HalfSpace::Below, low));
                        assert!(!height_bounds.is_clear(cells, HalfSpace::Above, high));
                        assert!(height_bounds.is_clear(cells, HalfSpace::Below, -1e-5));
                        assert!(height_bounds.is_clear(cells, HalfSpace::Above, 100.0));
                    }
                }
            }
        }
        // Away from the peak the bound is that of the blocks around.
        let valley = [[5, 6], [4, 5]];
        assert!(height_bounds.is_clear(valley, HalfSpace::Above, 4.0));
    }
}
