//! Hermite series: how a function of a Gaussian process changes its autocorrelation.

use asperity_numerics::quadrature::normal_nodes;

/// Terms of a series.
const TERMS: usize = 32;

/// For a function `g` of mean zero and variance one, the correlation of `g(z)` at two positions where that of the normal numbers `z` is
/// `rho`: `sum_n c_n^2 rho^n`, where `c_n` are the coefficients of `g` in normalised Hermite polynomials.
///
/// # Source
/// H. G. Mehler, J. Reine Angew. Math. 66 (1866) 161; M. Grigoriu, *Applied Non-Gaussian Processes* (1995), section 3.1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HermiteSeries {
    /// `c_n^2` from `n = 1`, whose sum is one; terms beyond are added to the last.
    squares: [f64; TERMS],
}

impl HermiteSeries {
    /// Series of a function, by the trapezium rule.
    pub(super) fn of(function: impl Fn(f64) -> f64) -> Self {
        let mut sums = [0.0; TERMS];
        let mut total = 0.0;
        for [z, weight] in normal_nodes(64, 12) {
            total += weight;
            let value = weight * function(z);
            // sqrt(n) p_n = z p_(n-1) - sqrt(n - 1) p_(n-2)
            let (mut before, mut now) = (0.0, 1.0);
            for (n, sum) in (1_u32..).zip(&mut sums) {
                let n = f64::from(n);
                let next = (z * now - (n - 1.0).sqrt() * before) / n.sqrt();
                (before, now) = (now, next);
                *sum += value * now;
            }
        }
        let mut squares = sums.map(|sum| (sum / total).powi(2));
        let rest = 1.0 - squares.iter().sum::<f64>();
        squares[TERMS - 1] += rest.max(0.0);
        let all: f64 = squares.iter().sum();
        Self {
            squares: squares.map(|square| square / all),
        }
    }

    /// The correlation of function values, and its derivative.
    fn at(&self, rho: f64) -> [f64; 2] {
        let terms = self.squares.iter().rev();
        let [sum, slope] = terms.fold([0.0, 0.0], |[sum, slope], square| {
            [sum * rho + square, slope * rho + sum]
        });
        [sum * rho, sum + slope * rho]
    }

    /// The correlation of function values where that of normal numbers is `rho`.
    pub(super) fn correlation(&self, rho: f64) -> f64 {
        self.at(rho)[0]
    }

    /// The correlation of normal numbers at which function values have the correlation `value`; -1 where none has.
    pub(super) fn inverse(&self, value: f64) -> f64 {
        if value >= 1.0 {
            return 1.0;
        }
        if value <= self.correlation(-1.0) {
            return -1.0;
        }
        // The correlation rises from -1 to 1: bisection guards Newton's steps
        let (mut low, mut high) = (-1.0, 1.0);
        let mut rho = value.clamp(-1.0, 1.0);
        for _ in 0..60 {
            let [found, slope] = self.at(rho);
            let off = found - value;
            if off > 0.0 {
                high = rho;
            } else {
                low = rho;
            }
            let next = rho - off / slope;
            let next = match next > low && next < high {
                true => next,
                false => 0.5 * (low + high),
            };
            if (next - rho).abs() < 1e-15 {
                return next;
            }
            rho = next;
        }
        rho
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The correlation of the lognormal distribution with `w = exp(1 / delta^2)` is `(w^rho - 1) / (w - 1)`.
    #[test]
    fn lognormal_correlations_are_closed() {
        let delta: f64 = 2.0;
        let w = (1.0 / (delta * delta)).exp();
        let scale = (w * (w - 1.0)).sqrt();
        let series = HermiteSeries::of(|z| ((z / delta).exp() - w.sqrt()) / scale);
        for i in -10..=10 {
            let rho = 0.1 * f64::from(i);
            let expected = (w.powf(rho) - 1.0) / (w - 1.0);
            let found = series.correlation(rho);
            assert!((found - expected).abs() < 1e-12, "{rho}: {found}");
            assert!((series.inverse(found) - rho).abs() < 1e-12, "{rho}");
        }
        assert_eq!(series.inverse(-1.0), -1.0);
        assert!(HermiteSeries::of(|z| z).correlation(0.3) - 0.3 < 1e-12);
    }
}
