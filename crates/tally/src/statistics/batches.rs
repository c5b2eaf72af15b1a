//! Batches: means and standard errors of quantities over independent batches.

use serde::{Deserialize, Serialize};

/// A mean with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Standard error of the mean; `None` where fewer than two batches were seen and nothing else is
    /// known.
    pub se: Option<f64>,
}

/// Running mean and variance of several quantities over equally weighted batches; of tallies,
/// [`TallyStatistics`](crate::TallyStatistics).
///
/// Welford's recurrence, so that nothing cancels; batches are added in the order of their index, so
/// that the bytes of the result do not depend on the number of threads.
#[derive(Clone, Debug, Default)]
pub struct BatchStatistics {
    batches: u64,
    mean: Vec<f64>,
    squares: Vec<f64>,
}

impl BatchStatistics {
    /// Statistics of `len` quantities, without a batch yet.
    #[must_use]
    pub fn new(len: usize) -> Self {
        Self {
            batches: 0,
            mean: vec![0.0; len],
            squares: vec![0.0; len],
        }
    }

    /// Adds one batch.
    ///
    /// # Panics
    /// If the number of quantities is another.
    pub fn push(&mut self, batch: &[f64]) {
        assert_eq!(
            batch.len(),
            self.mean.len(),
            "a batch of another tally spec"
        );
        self.batches += 1;
        add_batch(self.batches, &mut self.mean, &mut self.squares, batch);
    }

    /// Number of batches.
    #[must_use]
    pub const fn batches(&self) -> u64 {
        self.batches
    }

    /// Means of all quantities.
    #[must_use]
    pub fn means(&self) -> &[f64] {
        &self.mean
    }

    /// Squares of the standard errors of all means, by the scatter of the batches alone; not a number with
    /// fewer than two batches.
    pub fn error_squares(&self) -> impl Iterator<Item = f64> {
        let n = self.batches as f64;
        self.squares.iter().map(move |s| s / (n * (n - 1.0)))
    }

    /// Mean and standard error of quantity `i`.
    #[must_use]
    pub fn estimate(&self, i: usize) -> Estimate {
        Estimate {
            mean: self.mean[i],
            se: standard_error(self.batches, self.squares[i], None),
        }
    }
}

/// Adds a batch, the `count`th, to means and sums of squared deviations: Welford's recurrence.
pub(crate) fn add_batch(count: u64, means: &mut [f64], squares: &mut [f64], batch: &[f64]) {
    let n = count as f64;
    for ((mean, squares), &value) in means.iter_mut().zip(squares).zip(batch) {
        let before = value - *mean;
        *mean += before / n;
        *squares += before * (value - *mean);
    }
}

/// Standard error of the mean of `batches` batches whose squared deviations add to `squares`, and no
/// less than `least`; without any batch `least` itself.
pub(crate) fn standard_error(batches: u64, squares: f64, least: Option<f64>) -> Option<f64> {
    if batches == 0 {
        return least;
    }
    let n = batches as f64;
    (batches > 1).then(|| {
        let scatter = (squares / (n * (n - 1.0))).sqrt();
        least.map_or(scatter, |least| scatter.max(least))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_textbook_formula() {
        let mut statistics = BatchStatistics::new(2);
        for x in [1.0, 2.0, 4.0] {
            statistics.push(&[x, 5.0]);
        }
        let estimate = statistics.estimate(0);
        assert!((estimate.mean - 7.0 / 3.0).abs() < 1e-15);
        // Sample variance 7/3, standard error sqrt(7/9).
        assert!((estimate.se.unwrap() - (7.0_f64 / 9.0).sqrt()).abs() < 1e-15);
        assert_eq!(
            statistics.estimate(1),
            Estimate {
                mean: 5.0,
                se: Some(0.0)
            }
        );
    }

    #[test]
    fn one_batch_has_no_error() {
        let mut statistics = BatchStatistics::new(1);
        statistics.push(&[3.0]);
        assert_eq!(
            statistics.estimate(0),
            Estimate {
                mean: 3.0,
                se: None
            }
        );
    }

    #[test]
    fn small_spread_on_a_large_mean_survives() {
        let mut statistics = BatchStatistics::new(1);
        for i in 0..1000 {
            statistics.push(&[1e9 + f64::from(i % 2)]);
        }
        let se = statistics.estimate(0).se.unwrap();
        let expected = (0.25_f64 / 999.0).sqrt();
        assert!((se / expected - 1.0).abs() < 1e-6);
    }
}
