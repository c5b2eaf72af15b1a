//! Means over realisations with their errors.

use asperity_tally::{BatchStatistics, Estimate};

/// The ratio of two sums over realisations, each `[over, under]`, with the error that their scatter makes.
///
/// Points of one surface are correlated, so that surfaces are what is independent. The error is that of the
/// mean of `(over - ratio under) / mean(under)`: exact for many surfaces, and `None` of one.
pub(super) fn ratio(realisations: impl Iterator<Item = [f64; 2]> + Clone) -> Estimate {
    let sum = |i: usize| realisations.clone().map(|pair| pair[i]).sum::<f64>();
    let (over, under) = (sum(0), sum(1));
    let (ratio, count) = (over / under, realisations.clone().count() as f64);
    let residual = |[over, here]: [f64; 2]| (over - ratio * here) * count / under;
    Estimate {
        mean: ratio,
        ..mean(realisations.map(residual))
    }
}

/// The mean of values, one per realisation.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> Estimate {
    let mut statistics = BatchStatistics::new(1);
    values.for_each(|value| statistics.push(&[value]));
    statistics.estimate(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_weighs_realisations_and_scatters_by_its_residuals() {
        let pairs = [[1.0, 2.0], [4.0, 4.0], [1.0, 2.0]];
        let found = ratio(pairs.into_iter());
        assert!((found.mean - 0.75).abs() < 1e-15);
        // Residuals -0.5, 1, -0.5 over a mean of 8/3: variance 0.75 (3/8)^2, over three.
        let expected = (0.75_f64 / 3.0).sqrt() * 3.0 / 8.0;
        assert!((found.se.unwrap() - expected).abs() < 1e-15);
        assert_eq!(ratio([[1.0, 2.0]].into_iter()).se, None);
        // What is the same fraction of every surface has no error, however their sizes scatter.
        let same = ratio([[1.0, 2.0], [2.0, 4.0]].into_iter());
        assert_eq!((same.mean, same.se), (0.5, Some(0.0)));
    }
}
