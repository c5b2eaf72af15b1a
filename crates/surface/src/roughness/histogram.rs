//! Histogram: how the heights and slopes of a surface are distributed.

mod bins;
mod levels;

use rayon::prelude::*;

use self::bins::Bins;
use self::levels::Levels;
use crate::HeightField;
use crate::height_field::mean_height;

/// Bins of a histogram of heights.
const HEIGHT_BINS: usize = 100;

/// Bins of a histogram of slopes; odd, so that the middle of one is zero.
const SLOPE_BINS: usize = 121;

/// Slopes beyond this multiple of their root mean square are counted, but not shown.
const MAX_SLOPE_DEVIATIONS: f64 = 6.0;

/// Facets of which the levels of slopes are told.
const FACETS_FOR_LEVELS: usize = 1 << 17;

/// A probability density over equal bins.
///
/// # Examples
/// ```
/// use asperity_surface::{HeightField, Histogram};
///
/// let heights = (0..100).map(f64::from).collect();
/// let field = HeightField::new(heights, [10, 10], [1.0, 1.0])?;
/// let histogram = Histogram::of_heights(&field).expect("heights differ");
/// assert_eq!(histogram.lowest, -49.5);
/// let within: f64 = histogram.densities.iter().map(|density| density * histogram.width).sum();
/// assert!((within - 1.0).abs() < 1e-12);
/// # Ok::<(), asperity_surface::HeightFieldError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Lower edge of the first bin.
    pub lowest: f64,
    /// Width of a bin.
    pub width: f64,
    /// Fraction of all values in each bin over its width.
    pub densities: Vec<f64>,
    /// Fraction of all values beyond the first and the last bin.
    pub outside: f64,
}

impl Histogram {
    /// Histogram of the heights of all samples about their mean, from the lowest to the highest, in 100 bins; `None` if all are equal.
    #[must_use]
    pub fn of_heights(field: &HeightField) -> Option<Self> {
        let mean = mean_height(field);
        let heights = field.heights();
        let [lowest, highest] = field.range();
        let bins = Bins::new([lowest - mean, highest - mean], HEIGHT_BINS)?;
        let counts = heights.par_chunks(field.nx()).map(|row| {
            let values = row.iter().map(|h| h - mean);
            bins.count(values)
        });
        Some(Self::of_counts(
            &bins,
            &counts.reduce(|| bins.none(), added),
        ))
    }

    /// Histograms of the slopes of all facets along x and along y, in the same 121 bins about zero. These reach to the largest slope, or to six
    /// times the root mean square of the larger pair, whichever is less; `None` if all slopes are zero.
    ///
    /// If heights, and so slopes, are whole multiples of a step, each slope counts as spread evenly over one step.
    #[must_use]
    pub fn of_slopes(field: &HeightField) -> Option<[Self; 2]> {
        let largest = |slopes: Vec<f64>| slopes.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
        let steepest = (0..field.ny()).into_par_iter().map(|iy| {
            let along_y = (iy < field.cells()[1]).then(|| field.slopes_along_y(iy));
            largest(field.slopes_along_x(iy)).max(along_y.map_or(0.0, largest))
        });
        let steepest = steepest.reduce(|| 0.0, f64::max);
        let [xx, _, yy] = field.slope_moments().second;
        let reach = steepest.min(MAX_SLOPE_DEVIATIONS * xx.max(yy).sqrt());
        let width = 2.0 * reach / SLOPE_BINS as f64;
        let levels = [0, 1].map(|axis| slope_levels(field, axis, width));
        // The steepest slope may be half a step steeper
        let steps = levels.iter().flatten().map(|levels| levels.step);
        let reach = reach + 0.5 * steps.fold(0.0, f64::max);
        let range = [-reach, reach];
        let bins = Bins::new(range, SLOPE_BINS)?;
        let of_axis = |axis: usize| {
            let of_levels = levels[axis].and_then(|levels| levels.bins(range));
            match of_levels {
                None => Self::of_counts(&bins, &slope_counts(field, axis, &bins)),
                Some(of_levels) => {
                    let counts = slope_counts(field, axis, &of_levels);
                    Self::spread(&bins, &of_levels, &counts)
                }
            }
        };
        Some([of_axis(0), of_axis(1)])
    }

    /// The histogram of `counts` of finer bins, each of which counts as even.
    fn spread(bins: &Bins, finer: &Bins, counts: &[u64]) -> Self {
        let total = counts.iter().sum::<u64>() as f64;
        let mut densities = vec![0.0; bins.count];
        let mut inside = 0.0;
        for (i, count) in counts[..finer.count].iter().enumerate() {
            let from = (finer.lowest + i as f64 * finer.width - bins.lowest) / bins.width;
            let to = from + finer.width / bins.width;
            let first = from.max(0.0) as usize;
            let reached = (to.ceil().max(0.0) as usize).saturating_sub(first);
            let reached_bins = densities.iter_mut().enumerate();
            for (bin, density) in reached_bins.skip(first).take(reached) {
                let overlap = to.min(bin as f64 + 1.0) - from.max(bin as f64);
                let part = *count as f64 * overlap.max(0.0) / (to - from) / total;
                *density += part / bins.width;
                inside += part;
            }
        }
        Self {
            lowest: bins.lowest,
            width: bins.width,
            densities,
            outside: (1.0_f64 - inside).max(0.0),
        }
    }

    /// The histogram of `counts` of `bins`.
    fn of_counts(bins: &Bins, counts: &[u64]) -> Self {
        let total = counts.iter().sum::<u64>() as f64;
        let (inside, outside) = counts.split_at(bins.count);
        let density = |count: &u64| *count as f64 / (total * bins.width);
        Self {
            lowest: bins.lowest,
            width: bins.width,
            densities: inside.iter().map(density).collect(),
            outside: outside.iter().sum::<u64>() as f64 / total,
        }
    }

    /// Middle of each bin, and its density.
    pub fn middles(&self) -> impl Iterator<Item = (f64, f64)> {
        let middle = |i: usize| self.lowest + (i as f64 + 0.5) * self.width;
        let densities = self.densities.iter().enumerate();
        densities.map(move |(i, density)| (middle(i), *density))
    }
}

/// Slopes of the facets of a row of cells.
fn slopes_of_row(field: &HeightField, iy: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..field.cells()[0]).flat_map(move |ix| field.facet_slopes(ix, iy))
}

/// Levels of the slopes along an axis, by rows that are spread over the surface.
fn slope_levels(field: &HeightField, axis: usize, width: f64) -> Option<Levels> {
    let [cx, cy] = field.cells();
    let rows = FACETS_FOR_LEVELS.div_ceil(2 * cx);
    let rows = (0..cy).step_by(cy.div_ceil(rows));
    let slopes = rows.flat_map(|iy| slopes_of_row(field, iy));
    Levels::of(slopes.map(|slope| slope[axis]).collect(), width)
}

/// Counts of the slopes of all facets along an axis. Facets on both sides of a line of the grid share the slope along it.
fn slope_counts(field: &HeightField, axis: usize, bins: &Bins) -> Vec<u64> {
    let ([nx, ny], [cx, cy]) = ([field.nx(), field.ny()], field.cells());
    let times = |counts: Vec<u64>, factor: u64| counts.into_iter().map(move |n| factor * n);
    let counts = (0..if axis == 0 { ny } else { cy })
        .into_par_iter()
        .map(|iy| {
            if axis == 0 {
                let is_edge = cy < ny && (iy == 0 || iy == ny - 1);
                let counts = bins.count(field.slopes_along_x(iy).into_iter());
                return times(counts, if is_edge { 1 } else { 2 }).collect();
            }
            let slopes = &field.slopes_along_y(iy)[..nx];
            let twice = times(bins.count(slopes.iter().copied()), 2);
            let ends = if cx < nx {
                vec![slopes[0], slopes[nx - 1]]
            } else {
                Vec::new()
            };
            let once = bins.count(ends.into_iter());
            twice.zip(once).map(|(all, ends)| all - ends).collect()
        });
    counts.reduce(|| bins.none(), added)
}

fn added(mut sum: Vec<u64>, other: Vec<u64>) -> Vec<u64> {
    for (a, b) in sum.iter_mut().zip(other) {
        *a += b;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Border;
    use asperity_synthesis::{Psd, Synthesis};

    /// Heights are counted one by one here, with the edges that the histogram states.
    #[test]
    fn bins_hold_what_lies_between_their_edges() {
        let heights: Vec<f64> = (0..35 * 21)
            .map(|i| (f64::from(i * i) * 0.37).sin())
            .collect();
        let field = HeightField::new(heights.clone(), [21, 35], [1.0, 2.0]).unwrap();
        let histogram = Histogram::of_heights(&field).unwrap();
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        assert_eq!(histogram.outside, 0.0);
        for (i, density) in histogram.densities.iter().enumerate() {
            let from = histogram.lowest + i as f64 * histogram.width;
            // An edge that rounding may move is given a margin
            let between = |margin: f64| {
                let is_in = |h: &&f64| {
                    **h - mean >= from - margin && **h - mean < from + histogram.width + margin
                };
                heights.iter().filter(is_in).count()
            };
            let found = (density * histogram.width * heights.len() as f64).round() as usize;
            assert!((between(-1e-9)..=between(1e-9)).contains(&found), "bin {i}");
        }
    }

    /// A ramp `x` along x with a wrap: nine slopes of 1 and one of -9 per row, and none along y. Their root mean square is 3, so that all are within
    /// the 6-fold of it.
    #[test]
    fn slopes_are_those_of_facets() {
        let heights = (0..40).map(|i| f64::from(i % 10)).collect();
        let field = HeightField::new(heights, [4, 10], [1.0, 1.0]).unwrap();
        let [x, y] = Histogram::of_slopes(&field).unwrap();
        let fraction = |histogram: &Histogram, slope: f64| {
            let bin = ((slope - histogram.lowest) / histogram.width) as usize;
            histogram.densities[bin.min(120)] * histogram.width
        };
        for (found, expected) in [
            (fraction(&x, 1.0), 0.9),
            (fraction(&x, -9.0), 0.1),
            (fraction(&y, 0.0), 1.0),
        ] {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let open = field.with_border(Border::Open);
        assert!((fraction(&Histogram::of_slopes(&open).unwrap()[0], 1.0) - 1.0).abs() < 1e-12);
    }

    /// Heights in steps of 1 at a spacing of 2, tilted: slopes are 0.5 apart, some 3 to a bin. Neighbouring bins of slopes of a smooth distribution
    /// differ by a few per cent of the peak; where bins beat they differ by a third of it.
    #[test]
    fn slopes_of_rounded_heights_do_not_beat_with_the_bins() {
        let psd = Psd::gaussian(90.0, 6.0).unwrap();
        let synthesis = Synthesis::new(psd, [512, 512], [2.0, 2.0], true).unwrap();
        let smooth = synthesis.draw(5, 0).unwrap();
        let tilt = |k: usize| 0.3 * (k % 512) as f64;
        let heights = smooth.heights().iter().map(|h| h.round()).enumerate();
        let heights = heights.map(|(k, height)| height + tilt(k)).collect();
        let rounded = HeightField::new(heights, [512, 512], [2.0, 2.0]).unwrap();
        let rounded = rounded.with_border(Border::Open);
        for histogram in Histogram::of_slopes(&rounded).unwrap() {
            let peak = histogram.densities.iter().fold(0.0_f64, |a, b| a.max(*b));
            let steps = histogram.densities.windows(2);
            let largest = steps
                .map(|pair| (pair[1] - pair[0]).abs())
                .fold(0.0, f64::max);
            assert!(largest < 0.12 * peak, "{largest} of {peak}");
            let inside = histogram.densities.iter().sum::<f64>() * histogram.width;
            assert!((inside + histogram.outside - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_flat_surface_has_no_histogram() {
        let flat = HeightField::new(vec![3.0; 6], [2, 3], [1.0, 1.0]).unwrap();
        assert_eq!(Histogram::of_heights(&flat), None);
        assert_eq!(Histogram::of_slopes(&flat), None);
    }

    /// The cumulative distribution of the slopes of a Gaussian surface is normal: a tile of 256^2 holds 256^2 / (pi 6^2) = 579 correlation areas, so that
    /// fractions scatter by at most 0.5 / sqrt(579) = 0.021 (1 / sqrt 12 of slopes hold about as many areas); four of these.
    #[test]
    fn slopes_of_a_gaussian_surface_are_normal() {
        let psd = Psd::gaussian(2.0, 6.0).unwrap();
        let field = Synthesis::new(psd, [256, 256], [1.0, 1.0], false).unwrap();
        let heights = field.draw(5, 0).unwrap().into_heights();
        let field = HeightField::new(heights, [256, 256], [1.0, 1.0]).unwrap();
        let [xx, _, yy] = field.slope_moments().second;
        let histograms = Histogram::of_slopes(&field).unwrap();
        for (histogram, variance) in histograms.iter().zip([xx, yy]) {
            let mut below = 0.0;
            for (middle, density) in histogram.middles() {
                below += density * histogram.width;
                let edge = middle + 0.5 * histogram.width;
                let normal =
                    0.5 * asperity_numerics::elementary::erfc(-edge / (2.0 * variance).sqrt());
                assert!((below - normal).abs() < 0.085, "{edge}: {below} {normal}");
            }
        }
    }
}
