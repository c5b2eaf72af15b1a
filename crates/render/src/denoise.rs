//! Denoising: non-local means over a picture whose pixels have known errors.
//!
//! A pixel becomes the mean of those around it that look alike, weighted by how alike the patches around both are. Patches are alike if
//! they differ by no more than their errors explain, so that edges and texture above the noise stay.
//!
//! # Source
//! F. Rousselle, C. Knaus, M. Zwicker, Adaptive rendering with non-local means filtering, ACM Trans. Graph. 31 (6), 195 (2012),
//! doi:10.1145/2366145.2366213, Eqs. 2 to 5, without their second buffer: the variance of a pixel, which few samples know badly, is
//! the median over its patch instead, and limited by that of the other pixel.

use std::ops::Range;

use asperity_io::Picture;
use asperity_numerics::elementary::exp;
use rayon::prelude::*;

/// Pixels from the centre of a patch to its sides.
const PATCH: isize = 1;

/// Pixels from the centre of the search window to its sides.
const WINDOW: isize = 7;

/// Damping factor `k` of the source; larger values smooth more.
const DAMPING: f64 = 0.7;

/// Denoises a picture by its errors, which are not changed. Exact pixels that differ are not mixed.
///
/// The radiance decides the weights, which hold for colours too. Equal pictures give equal results for any number of threads.
pub fn denoise(picture: &mut Picture) {
    let [columns, rows] = picture.size;
    let squares: Vec<f64> = picture.error.iter().map(|e| e * e).collect();
    let none = vec![[0.0; 3]; 0];
    let colour = picture.colour.as_ref().unwrap_or(&none);
    let value = |(i, y): (usize, &f64)| {
        let [r, g, b] = colour.get(i).copied().unwrap_or_default();
        [*y, r, g, b]
    };
    let noisy = Noisy {
        size: [columns, rows].map(usize::cast_signed),
        values: picture.radiance.iter().enumerate().map(value).collect(),
        variances: patch_medians(&squares, [columns, rows]),
    };
    let rows = (0..rows.cast_signed()).into_par_iter();
    let filtered: Vec<[f64; 4]> = rows.flat_map_iter(|y| noisy.row(y)).collect();
    for (i, [y, rgb @ ..]) in filtered.into_iter().enumerate() {
        picture.radiance[i] = y;
        if let Some(colour) = &mut picture.colour {
            colour[i] = rgb;
        }
    }
}

/// Pixels that have errors.
struct Noisy {
    /// Columns and rows.
    size: [isize; 2],
    /// Radiance, then colour.
    values: Vec<[f64; 4]>,
    /// Variances of the radiance.
    variances: Vec<f64>,
}

impl Noisy {
    /// A row, denoised.
    fn row(&self, y: isize) -> Vec<[f64; 4]> {
        let [columns, rows] = self.size;
        let begin = (y * columns).cast_unsigned();
        let here = &self.values[begin..begin + columns.cast_unsigned()];
        // Weights, and the sums of differences: a mean of equal values is then that value, to the last digit.
        let mut weights = vec![1.0; here.len()];
        let mut sums = vec![[0.0; 4]; here.len()];
        for dy in -WINDOW..=WINDOW {
            if !(0..rows).contains(&(y + dy)) {
                continue;
            }
            for dx in (-WINDOW..=WINDOW).filter(|dx| (*dx, dy) != (0, 0)) {
                let inside = (-dx).max(0)..columns.min(columns - dx);
                let distances = self.column_distances(y, [dx, dy], inside.clone());
                for (i, x) in inside.enumerate() {
                    let sides = i.saturating_sub(1)..(i + 2).min(distances.len());
                    let patch = &distances[sides];
                    let distance = patch.iter().sum::<f64>() / patch.len() as f64;
                    let weight = exp(-distance.max(0.0));
                    let x = x.cast_unsigned();
                    let there = self.values[self.index([x.cast_signed() + dx, y + dy])];
                    weights[x] += weight;
                    for (sum, (there, here)) in sums[x].iter_mut().zip(there.iter().zip(here[x])) {
                        *sum += weight * (there - here);
                    }
                }
            }
        }
        let denoised = here.iter().zip(sums.iter().zip(&weights));
        denoised
            .map(|(here, (sum, weight))| [0, 1, 2, 3].map(|i| here[i] + sum[i] / weight))
            .collect()
    }

    /// Distances of pixels of a row, at the `columns`, to those at an offset, averaged over the rows of a patch.
    fn column_distances(&self, y: isize, [dx, dy]: [isize; 2], columns: Range<isize>) -> Vec<f64> {
        let in_picture = |row: &isize| {
            [*row, row + dy]
                .iter()
                .all(|y| (0..self.size[1]).contains(y))
        };
        let rows: Vec<isize> = (y - PATCH..=y + PATCH).filter(in_picture).collect();
        columns
            .map(|x| {
                let distances = rows.iter().map(|row| {
                    let [p, q] = [[x, *row], [x + dx, row + dy]].map(|at| self.index(at));
                    self.distance(p, q)
                });
                distances.sum::<f64>() / rows.len() as f64
            })
            .collect()
    }

    /// Squared difference of two pixels beyond that expected of noise, over their variances. One variance counts as three times the other at
    /// most: a bright pixel that few paths have met shall not spread over others that know better.
    fn distance(&self, p: usize, q: usize) -> f64 {
        let difference = self.values[p][0] - self.values[q][0];
        let (here, there) = (self.variances[p], self.variances[q]);
        let least = here.min(there);
        let both = (here + there).min(4.0 * least);
        (difference * difference - 2.0 * least) / (f64::MIN_POSITIVE + DAMPING * DAMPING * both)
    }

    fn index(&self, [x, y]: [isize; 2]) -> usize {
        (y * self.size[0] + x).cast_unsigned()
    }
}

/// Medians over the patch around each pixel, as far as it is in the picture.
fn patch_medians(values: &[f64], [columns, rows]: [usize; 2]) -> Vec<f64> {
    let around = |i: usize, n: usize| {
        let reach = PATCH.cast_unsigned();
        i.saturating_sub(reach)..(i + reach + 1).min(n)
    };
    let median = |x: usize, y: usize| {
        let rows = around(y, rows).flat_map(|y| &values[y * columns..][around(x, columns)]);
        let mut patch: Vec<f64> = rows.copied().collect();
        patch.sort_unstable_by(f64::total_cmp);
        patch[patch.len() / 2]
    };
    (0..rows)
        .flat_map(|y| (0..columns).map(move |x| (x, y)))
        .map(|(x, y)| median(x, y))
        .collect()
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    use super::*;

    const SIZE: [usize; 2] = [48, 40];

    /// A picture of these means with noise of standard deviation `sigma`, and errors as estimated from four samples.
    fn noisy(mean: impl Fn(usize) -> f64, sigma: f64) -> Picture {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        // A sum of twelve uniform numbers has variance one.
        let mut normal = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
        let mut picture = Picture {
            size: SIZE,
            radiance: Vec::new(),
            error: Vec::new(),
            coverage: vec![1.0; SIZE[0] * SIZE[1]],
            colour: None,
        };
        for i in 0..SIZE[0] * SIZE[1] {
            let samples = [0; 4].map(|_| 2.0 * sigma * normal());
            let average = samples.iter().sum::<f64>() / 4.0;
            let squares = samples.iter().map(|s| (s - average).powi(2));
            picture.error.push((squares.sum::<f64>() / 12.0).sqrt());
            picture.radiance.push(mean(i % SIZE[0]) + average);
        }
        picture
    }

    fn rms(picture: &Picture, mean: impl Fn(usize) -> f64) -> f64 {
        let errors = picture.radiance.iter().enumerate();
        let squares = errors.map(|(i, value)| (value - mean(i % SIZE[0])).powi(2));
        (squares.sum::<f64>() / picture.radiance.len() as f64).sqrt()
    }

    #[test]
    fn a_uniform_picture_has_a_quarter_of_its_error_at_most() {
        let mut picture = noisy(|_| 3.0, 0.2);
        let before = rms(&picture, |_| 3.0);
        let errors = picture.error.clone();
        denoise(&mut picture);
        let after = rms(&picture, |_| 3.0);
        assert!(after < 0.25 * before, "{before} {after}");
        assert_eq!(picture.error, errors);
    }

    #[test]
    fn an_edge_of_ten_standard_deviations_stays() {
        let sigma = 0.1;
        let step = |x: usize| if x < 20 { 1.0 } else { 2.0 };
        let mut picture = noisy(step, sigma);
        denoise(&mut picture);
        for column in 18..22 {
            let rows = picture.radiance.chunks(SIZE[0]).map(|row| row[column]);
            let mean = rows.sum::<f64>() / SIZE[1] as f64;
            assert!((mean - step(column)).abs() < 0.3 * sigma, "{column} {mean}");
        }
        assert!(rms(&picture, step) < 0.6 * sigma);
        let edge = picture
            .radiance
            .chunks(SIZE[0])
            .flat_map(|row| [row[19] - 1.0, row[20] - 2.0]);
        let squares: f64 = edge.map(|difference| difference * difference).sum();
        assert!((squares / (2.0 * SIZE[1] as f64)).sqrt() < sigma);
    }

    #[test]
    fn a_bright_pixel_that_few_paths_have_met_stays_alone() {
        let mut picture = noisy(|_| 1.0, 0.0);
        let bright = 20 * SIZE[0] + 20;
        (picture.radiance[bright], picture.error[bright]) = (1000.0, 900.0);
        denoise(&mut picture);
        assert!(picture.radiance[bright] > 900.0);
        let sum = picture.radiance.iter().sum::<f64>() - picture.radiance[bright];
        assert!((sum / (picture.radiance.len() - 1) as f64 - 1.0).abs() < 0.01);
    }

    #[test]
    fn exact_pixels_and_colours_are_unchanged() {
        let mut picture = noisy(|x| 0.1 * (x / 7) as f64, 0.0);
        let colours = picture.radiance.iter().map(|y| [0.3 * y, *y, 1.7 * y]);
        picture.colour = Some(colours.collect());
        let before = picture.clone();
        denoise(&mut picture);
        assert!(picture == before);
    }

    #[test]
    fn colours_are_averaged_as_their_luminance_is() {
        let mut picture = noisy(|_| 1.0, 0.1);
        picture.colour = Some(
            picture
                .radiance
                .iter()
                .map(|y| [2.0 * y, *y, 0.0])
                .collect(),
        );
        denoise(&mut picture);
        for (rgb, y) in picture.colour.unwrap().iter().zip(&picture.radiance) {
            assert!((rgb[0] - 2.0 * y).abs() < 1e-12 && rgb[2] == 0.0);
        }
    }

    #[test]
    fn pictures_smaller_than_the_window_are_denoised() {
        let mut picture = noisy(|_| 1.0, 0.1);
        for size in [[1, 1], [3, 2], [1, 9]] {
            picture.size = size;
            for values in [
                &mut picture.radiance,
                &mut picture.error,
                &mut picture.coverage,
            ] {
                values.resize(size[0] * size[1], 1.0);
            }
            denoise(&mut picture);
            assert!(picture.radiance.iter().all(|value| value.is_finite()));
        }
    }
}
