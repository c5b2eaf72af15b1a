//! Slope samples: slopes of equal areas of the mean plane, region by region.

use rayon::prelude::*;

use crate::{HeightField, SplineSurface};

/// Places per cell of a spline along each axis, at most: the middles of as many parts.
const MAX_PER_CELL: usize = 3;

/// Samples of a spline above which a cell has fewer places.
const ENOUGH: usize = 1 << 22;

impl HeightField {
    /// Slopes `[dh/dx, dh/dy]` of all facets, each of which stands for half a cell, in `[columns, rows]` regions, row by row. A cell
    /// counts for the region that its middle is in. Numbers do not depend on the number of threads.
    ///
    /// # Examples
    /// ```
    /// use asperity_surface::HeightField;
    ///
    /// // A ridge: slopes of 1, then of -1
    /// let field = HeightField::new(vec![0.0, 1.0, 0.0, 1.0], [2, 2], [1.0, 1.0])?;
    /// let regions = field.slope_samples([2, 1]);
    /// assert_eq!(regions[0], [[1.0, 0.0]; 4]);
    /// # Ok::<(), asperity_surface::HeightFieldError>(())
    /// ```
    #[must_use]
    pub fn slope_samples(&self, regions: [usize; 2]) -> Vec<Vec<[f64; 2]>> {
        by_region(self.cells(), regions, |ix, iy, samples| {
            samples.extend(self.facet_slopes(ix, iy));
        })
    }
}

impl SplineSurface {
    /// Slopes `[dh/dx, dh/dy]` at the middles of 3 x 3 equal parts of each cell, of fewer above some million samples, in regions as of [`HeightField::slope_samples`].
    #[must_use]
    pub fn slope_samples(&self, regions: [usize; 2]) -> Vec<Vec<[f64; 2]>> {
        let [dx, dy] = self.spacing();
        let [cx, cy] = self.cells();
        let enough = |per: &usize| per * per * cx * cy <= ENOUGH;
        let per = (1..=MAX_PER_CELL).rev().find(enough).unwrap_or(1);
        let at = |i: usize, k: usize| i as f64 + (k as f64 + 0.5) / per as f64;
        by_region([cx, cy], regions, |ix, iy, samples| {
            let places = (0..per * per).map(|k| (k % per, k / per));
            samples.extend(places.map(|(i, j)| self.gradient(at(ix, i) * dx, at(iy, j) * dy)));
        })
    }
}

/// `add`: appends the samples of a cell.
fn by_region(
    [cx, cy]: [usize; 2],
    [columns, rows]: [usize; 2],
    add: impl Fn(usize, usize, &mut Vec<[f64; 2]>) + Sync,
) -> Vec<Vec<[f64; 2]>> {
    let region = |cell: usize, cells: usize, regions: usize| (2 * cell + 1) * regions / (2 * cells);
    (0..columns * rows)
        .into_par_iter()
        .map(|number| {
            let (column, row) = (number % columns, number / columns);
            let mut samples = Vec::new();
            for iy in (0..cy).filter(|&iy| region(iy, cy, rows) == row) {
                for ix in (0..cx).filter(|&ix| region(ix, cx, columns) == column) {
                    add(ix, iy, &mut samples);
                }
            }
            samples
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::{HeightField, SplineRoughness, SplineSurface};
    use asperity_synthesis::{Psd, Synthesis};

    /// Regions hold all samples, and their mean squares are those of the surface: exactly of facets; to the midpoint rule of a spline, which
    /// errs by a part `pi^2 / (6 n^2)` of the shortest wave of `n = 15` places, some tenth of a percent of what waves there are.
    #[test]
    fn samples_have_the_slopes_of_the_surface() {
        let psd = Psd::gaussian(2.0, 5.0).unwrap();
        let synthesis = Synthesis::new(psd, [41, 50], [1.0, 0.8], true).unwrap();
        let heights = synthesis.draw(3, 0).unwrap().into_heights();
        let field = HeightField::new(heights, [41, 50], [1.0, 0.8]).unwrap();
        let squares = |regions: &[Vec<[f64; 2]>]| {
            let all = regions.concat();
            let n = all.len() as f64;
            (
                all.len(),
                [0, 1].map(|k| all.iter().map(|s| s[k] * s[k]).sum::<f64>() / n),
            )
        };
        let (count, found) = squares(&field.slope_samples([7, 4]));
        let [xx, _, yy] = field.slope_moments().second;
        assert_eq!(count, 2 * 41 * 50);
        assert!((found[0] / xx - 1.0).abs() < 1e-12 && (found[1] / yy - 1.0).abs() < 1e-12);
        let spline = SplineSurface::through(&field);
        let (count, found) = squares(&spline.slope_samples([7, 4]));
        let expected = SplineRoughness::of(&spline).slope_variance;
        println!("{found:?} {expected:?}");
        assert_eq!(count, 9 * 41 * 50);
        assert!((0..2).all(|k| (found[k] / expected[k] - 1.0).abs() < 2e-3));
    }
}
