//! Isotropy: tells whether the slopes of one surface are those of an isotropic one, as far as they are known.
//!
//! The slope covariance of a surface that was drawn or measured never has equal eigenvalues. Half their difference,
//! `d = |((xx - yy) / 2, xy)|`, is called nothing if it is below 5 % of their mean, or if the two components are within what their standard
//! errors explain in 95 % of all cases: the sum of their squares over those of the errors is at most 5.99, the quantile of chi-squared with
//! two degrees of freedom.

use asperity_numerics::elementary::hypot;
use asperity_simulate::short;
use asperity_tally::Estimate;

/// Half the difference of the variances, over their mean, that is no anisotropy.
const NO_ANISOTROPY: f64 = 0.05;

/// Quantile 0.95 of chi-squared with two degrees of freedom.
const CHI_SQUARED: f64 = 5.99;

/// Slope variances along the principal axes, the larger first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Isotropy {
    pub(crate) variances: [f64; 2],
    pub(crate) is_near: bool,
}

impl Isotropy {
    /// Isotropy of the elements xx, xy and yy of a slope covariance.
    pub(crate) fn of([xx, xy, yy]: [Estimate; 3]) -> Self {
        let mean = 0.5 * (xx.mean + yy.mean);
        let (along, across) = (0.5 * (xx.mean - yy.mean), xy.mean);
        let half = hypot(along, across);
        let error = |estimate: Estimate| estimate.se.unwrap_or(0.0);
        let squared = |value: f64, error: f64| match value == 0.0 {
            true => 0.0,
            false => (value / error).powi(2),
        };
        let sum = squared(along, 0.5 * hypot(error(xx), error(yy))) + squared(across, error(xy));
        Self {
            variances: [mean + half, mean - half],
            is_near: half <= NO_ANISOTROPY * mean || sum <= CHI_SQUARED,
        }
    }

    /// Said where these models, which are of isotropic surfaces, take the mean of both variances.
    pub(crate) fn note(&self, models: &[&str]) -> String {
        let [larger, smaller] = self.variances.map(short);
        format!(
            "slope variances along the principal axes, {larger} and {smaller}, differ by no more than their errors or 5 %: isotropic models ({}) are made for their mean",
            models.join(", ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(means: [f64; 3], error: f64) -> bool {
        let elements = means.map(|mean| Estimate {
            mean,
            se: Some(error),
        });
        Isotropy::of(elements).is_near
    }

    #[test]
    fn variances_that_differ_by_their_errors_are_isotropic() {
        // Half the difference is 0.1, with the errors 0.042 and 0.035
        assert!(near([1.1, 0.0, 0.9], 0.06));
        assert!(!near([1.1, 0.0, 0.9], 0.05));
        assert!(!near([1.0, 0.1, 1.0], 0.04));
        assert!(near([1.0, 0.1, 1.0], 0.05));
        // A few per cent, whatever the errors
        assert!(near([1.04, 0.0, 0.96], 1e-9));
        assert!(!near([1.06, 0.0, 0.94], 1e-9));
        let turned = Isotropy::of([1.0, 0.3, 1.0].map(|mean| Estimate { mean, se: None }));
        assert_eq!(turned.variances, [1.3, 0.7]);
    }
}
