//! Slopes of a spline surface by region, by integrals over its patches.

use super::regions::{RegionSlopes, by_region};
use crate::SplineSurface;
use crate::spline::{Place, RULE, dot};

impl SplineSurface {
    /// Slopes in each of `[columns, rows]` regions, row by row, exact but for rounding where edges of regions are edges of cells. A
    /// cell on an edge counts for the regions on both sides by its area. Numbers do not depend on the number of threads.
    #[must_use]
    pub fn region_slopes(&self, regions: [usize; 2]) -> Vec<RegionSlopes> {
        by_region(self.cells(), regions, |iy| self.slopes_of_row(iy))
    }

    /// Means over each cell of a row.
    fn slopes_of_row(&self, iy: usize) -> Vec<RegionSlopes> {
        let ([cx, _], stride, [dx, dy]) = (self.cells(), self.stride(), self.spacing());
        let rows = &self.coefficients()[iy * stride..];
        let blended = |weights: [f64; 4]| -> Vec<f64> {
            (0..stride)
                .map(|ix| dot(&[0, 1, 2, 3].map(|j| rows[j * stride + ix]), weights))
                .collect()
        };
        let along_x = RULE.map(|(u, weight)| {
            let place = Place::within_cell(u);
            (place.weights(), place.slope_weights(), weight)
        });
        let mut means = vec![RegionSlopes::default(); cx];
        for (v, weight_y) in RULE {
            let place = Place::within_cell(v);
            let (heights, rises) = (blended(place.weights()), blended(place.slope_weights()));
            for (ix, mean) in means.iter_mut().enumerate() {
                for (weights, slope_weights, weight_x) in along_x {
                    let slopes = [
                        dot(&heights[ix..], slope_weights) / dx,
                        dot(&rises[ix..], weights) / dy,
                    ];
                    mean.add(weight_x * weight_y, &RegionSlopes::of(slopes));
                }
            }
        }
        means
    }
}
