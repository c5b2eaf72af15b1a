//! Slopes by region: means and mean products of the slopes in equal rectangles of a tile.

use rayon::prelude::*;

use crate::HeightField;

/// Means over one region of a surface, each place of the mean plane counted once; dimensionless.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RegionSlopes {
    /// Means of the slopes `sx` and `sy` along x and y.
    pub mean: [f64; 2],
    /// Means of `sx sx`, `sx sy` and `sy sy`.
    pub second: [f64; 3],
}

impl RegionSlopes {
    /// The mean of several, such as of all regions of a surface; zeros of none.
    #[must_use]
    pub fn mean_of(regions: &[Self]) -> Self {
        let mut sum = Self::default();
        regions.iter().for_each(|region| sum.add(1.0, region));
        sum.scaled(1.0 / (regions.len() as f64).max(1.0))
    }

    /// The slopes of one place.
    pub(super) const fn of([x, y]: [f64; 2]) -> Self {
        Self {
            mean: [x, y],
            second: [x * x, x * y, y * y],
        }
    }

    /// Adds `weight` times another.
    pub(super) fn add(&mut self, weight: f64, other: &Self) {
        for (sum, value) in self.mean.iter_mut().zip(other.mean) {
            *sum += weight * value;
        }
        for (sum, value) in self.second.iter_mut().zip(other.second) {
            *sum += weight * value;
        }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            mean: self.mean.map(|value| factor * value),
            second: self.second.map(|value| factor * value),
        }
    }
}

impl HeightField {
    /// Slopes of the facets in each of `[columns, rows]` regions, row by row. A cell on an edge counts for the regions on both
    /// sides by its area. Numbers do not depend on the number of threads.
    ///
    /// # Examples
    /// ```
    /// use asperity_surface::{HeightField, RegionSlopes};
    ///
    /// // A ridge: slopes of 1, then of -1
    /// let field = HeightField::new(vec![0.0, 1.0, 0.0, 1.0], [2, 2], [1.0, 1.0])?;
    /// let regions = field.region_slopes([2, 1]);
    /// assert_eq!([regions[0].mean, regions[1].mean], [[1.0, 0.0], [-1.0, 0.0]]);
    /// assert_eq!(RegionSlopes::mean_of(&regions).second, [1.0, 0.0, 0.0]);
    /// # Ok::<(), asperity_surface::HeightFieldError>(())
    /// ```
    #[must_use]
    pub fn region_slopes(&self, regions: [usize; 2]) -> Vec<RegionSlopes> {
        let [cx, cy] = self.cells();
        let of_cell = |ix: usize, iy: usize| {
            let mut mean = RegionSlopes::default();
            for slopes in self.facet_slopes(ix, iy) {
                mean.add(0.5, &RegionSlopes::of(slopes));
            }
            mean
        };
        let of_row = |iy: usize| (0..cx).map(|ix| of_cell(ix, iy)).collect();
        by_region([cx, cy], regions, of_row)
    }
}

/// Means over regions, of means over the cells of each row.
pub(super) fn by_region(
    [cx, cy]: [usize; 2],
    [columns, rows]: [usize; 2],
    of_row: impl Fn(usize) -> Vec<RegionSlopes> + Sync,
) -> Vec<RegionSlopes> {
    let sums_of_row = |iy: usize| {
        let mut sums = vec![RegionSlopes::default(); columns];
        for (ix, of_cell) in of_row(iy).iter().enumerate() {
            for (column, length) in overlaps(ix, cx, columns) {
                sums[column].add(length, of_cell);
            }
        }
        sums
    };
    let of_rows: Vec<_> = (0..cy).into_par_iter().map(sums_of_row).collect();
    let mut sums = vec![RegionSlopes::default(); columns * rows];
    for (iy, of_row) in of_rows.iter().enumerate() {
        for (row, length) in overlaps(iy, cy, rows) {
            for (sum, of_column) in sums[row * columns..].iter_mut().zip(of_row) {
                sum.add(length, of_column);
            }
        }
    }
    let cells = (cx as f64 / columns as f64) * (cy as f64 / rows as f64);
    sums.into_iter()
        .map(|sum| sum.scaled(1.0 / cells))
        .collect()
}

/// The regions that cell number `cell` of `cells` along an axis lies in, with its length in each, in cells.
fn overlaps(cell: usize, cells: usize, regions: usize) -> impl Iterator<Item = (usize, f64)> {
    let size = cells as f64 / regions as f64;
    let edge = move |region: usize| (region * cells) as f64 / regions as f64;
    let first = (cell * regions / cells).min(regions - 1);
    let last = ((cell as f64 + 1.0) / size).ceil() as usize;
    (first..last.min(regions)).filter_map(move |region| {
        let from = edge(region).max(cell as f64);
        let to = edge(region + 1).min(cell as f64 + 1.0);
        (to > from).then_some((region, to - from))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Border, SplineRoughness, SplineSurface};
    use asperity_synthesis::{Psd, Synthesis};

    fn field() -> HeightField {
        let psd = Psd::gaussian(2.0, 5.0).unwrap();
        let synthesis = Synthesis::new(psd, [41, 50], [1.0, 0.8], true).unwrap();
        let heights = synthesis.draw(3, 0).unwrap().into_heights();
        HeightField::new(heights, [41, 50], [1.0, 0.8]).unwrap()
    }

    #[test]
    fn overlaps_divide_every_cell() {
        for (cells, regions) in [(50, 7), (8, 8), (3, 7), (41, 1)] {
            let mut of_region = vec![0.0; regions];
            for cell in 0..cells {
                let of_cell: f64 = overlaps(cell, cells, regions)
                    .map(|(_, length)| length)
                    .sum();
                assert!(
                    (of_cell - 1.0).abs() < 1e-12,
                    "{cell} of {cells}: {of_cell}"
                );
                overlaps(cell, cells, regions).for_each(|(i, length)| of_region[i] += length);
            }
            let size = cells as f64 / regions as f64;
            assert!(of_region.iter().all(|sum| (sum - size).abs() < 1e-12));
        }
    }

    /// However cells are cut, the mean over regions is that of the surface: the sums differ by the rounding of 4,000 terms.
    #[test]
    fn the_mean_of_all_regions_is_that_of_the_surface() {
        for border in [Border::Periodic, Border::Open] {
            let field = field().with_border(border);
            let whole = field.slope_moments().second;
            let regions = field.region_slopes([7, 4]);
            assert_eq!(regions.len(), 28);
            let mean = RegionSlopes::mean_of(&regions).second;
            for (a, b) in mean.iter().zip(whole) {
                assert!((a - b).abs() < 1e-12, "{border}: {a} against {b}");
            }
            assert!(regions[0].second != regions[1].second);
        }
    }

    /// A cell in a region counts for it alone: regions of whole cells are means over these.
    #[test]
    fn regions_of_whole_cells_are_means_over_them() {
        let field = field();
        let regions = field.region_slopes([10, 41]);
        let cells = (5..10).flat_map(|ix| field.facet_slopes(ix, 2));
        let expected = cells.map(|[x, y]| x * y).sum::<f64>() / 10.0;
        assert!((regions[2 * 10 + 1].second[1] - expected).abs() < 1e-13);
    }

    #[test]
    fn regions_of_a_spline_have_its_variance() {
        let spline = SplineSurface::through(&field());
        let expected = SplineRoughness::of(&spline).slope_variance;
        let regions = spline.region_slopes([7, 4]);
        let mean = RegionSlopes::mean_of(&regions);
        println!("{mean:?} {expected:?}");
        for (a, b) in [mean.second[0], mean.second[2]].iter().zip(expected) {
            assert!((a / b - 1.0).abs() < 1e-12);
        }
        // Facets have slopes of their own, differences over a fifth of tau, and regions have few cells.
        let facets = field().region_slopes([7, 4]);
        for (a, b) in regions.iter().zip(&facets) {
            assert!(
                (a.second[0] / b.second[0] - 1.0).abs() < 0.25,
                "{a:?} {b:?}"
            );
        }
    }
}
