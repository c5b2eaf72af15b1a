//! Basis of an estimate: gives a zero-variance estimate, whose samples all agree, its confidence limit.

use asperity_simulate::short;
use asperity_tally::{Estimate, is_of_few_rays, zero_variance_limit};
use serde::{Deserialize, Serialize};

use super::number::{NO_SCATTER, two_digits, with_error};

/// Means this near to one are of samples that are all one, but for rounding.
const ROUNDING: f64 = 1e-9;

/// Basis of an estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Basis {
    /// A proof.
    Proven,
    /// Quadrature, whose error is far below the digits that are printed.
    Quadrature,
    /// None: it is not computed, and zero stands in its place.
    NotComputed,
    /// The number of independent samples, each between zero and one.
    Samples(f64),
    /// None that gives a limit.
    #[default]
    Unknown,
}

/// A mean with its standard error, or with its confidence limit if its variance is zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EstimateWithLimit {
    #[serde(flatten)]
    estimate: Estimate,
    /// Upper confidence limit, 95 %, of a mean of zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    /// Lower confidence limit, 95 %, of a mean of one.
    #[serde(skip_serializing_if = "Option::is_none")]
    above: Option<f64>,
    /// `true` if the mean is proven.
    #[serde(rename = "exact", default, skip_serializing_if = "is_false")]
    is_exact: bool,
    /// `true` if fewer than 20 surfaces or rays carry the flux: its error is a lower bound.
    #[serde(default, skip_serializing_if = "is_false")]
    few_samples: bool,
    #[serde(skip)]
    basis: Basis,
}

impl From<Estimate> for EstimateWithLimit {
    fn from(estimate: Estimate) -> Self {
        Self::new(estimate, Basis::Unknown)
    }
}

impl EstimateWithLimit {
    pub(crate) fn new(estimate: Estimate, basis: Basis) -> Self {
        let agree = estimate.se.is_some_and(|se| se <= NO_SCATTER);
        let limit = match basis {
            Basis::Samples(count) if agree => Some(zero_variance_limit(count).min(1.0)),
            _ => None,
        };
        let is_one = (estimate.mean - 1.0).abs() < ROUNDING;
        Self {
            estimate,
            below: limit.filter(|_| estimate.mean == 0.0),
            above: limit.filter(|_| is_one).map(|limit| 1.0 - limit),
            is_exact: agree && basis == Basis::Proven,
            few_samples: is_of_few_rays(estimate),
            basis,
        }
    }

    /// The estimate in another unit, of which `factor` make one.
    pub(crate) fn times(self, factor: f64) -> Self {
        let Estimate { mean, se } = self.estimate;
        Self {
            estimate: Estimate {
                mean: factor * mean,
                se: se.map(|se| factor * se),
            },
            below: self.below.map(|below| factor * below),
            above: None,
            ..self
        }
    }

    /// Returns `true` if all samples are zero.
    pub(crate) fn is_nothing(&self) -> bool {
        self.estimate.mean == 0.0 && self.estimate.se == Some(0.0)
    }

    pub(crate) const fn estimate(&self) -> Estimate {
        self.estimate
    }

    /// Text: with an error, as exact, as integrated, or with a limit.
    #[must_use]
    pub fn text(&self) -> String {
        let Estimate { mean, se } = self.estimate;
        match (se.filter(|se| *se > NO_SCATTER), self.below, self.above) {
            (None, Some(limit), _) => format!("0 (< {}, 95 %)", two_digits(limit)),
            (None, _, Some(limit)) => format!("1 (> 1 - {}, 95 %)", two_digits(1.0 - limit)),
            (None, ..) if self.is_exact => format!("{} (exact)", short(mean)),
            (None, ..) if se.is_some() => match self.basis {
                Basis::Quadrature => format!("{} (quadrature)", short(mean)),
                Basis::NotComputed => "not computed".to_owned(),
                Basis::Proven | Basis::Samples(_) | Basis::Unknown => with_error(self.estimate),
            },
            _ => with_error(self.estimate),
        }
    }
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "the signature that serde calls"
)]
const fn is_false(value: &bool) -> bool {
    !*value
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn agreed(mean: f64, basis: Basis) -> EstimateWithLimit {
        let se = Some(0.0);
        EstimateWithLimit::new(Estimate { mean, se }, basis)
    }

    #[test]
    fn only_what_is_proven_is_exact() {
        let texts = |mean| {
            let bases = [Basis::Proven, Basis::Samples(1e4), Basis::Unknown];
            bases.map(|basis| agreed(mean, basis).text())
        };
        assert_eq!(
            texts(0.0),
            ["0 (exact)", "0 (< 3.0e-4, 95 %)", "0 (no scatter)"]
        );
        assert_eq!(
            texts(1.0),
            ["1 (exact)", "1 (> 1 - 3.0e-4, 95 %)", "1 (no scatter)"]
        );
        assert_eq!(
            texts(0.04),
            ["0.04 (exact)", "0.04 (no scatter)", "0.04 (no scatter)"]
        );
        assert_eq!(agreed(0.04, Basis::Quadrature).text(), "0.04 (quadrature)");
        // Rounding of a mean is no scatter
        let rounded = Estimate {
            mean: 1.0 - 1e-15,
            se: Some(3e-14),
        };
        let found = EstimateWithLimit::new(rounded, Basis::Samples(1e4));
        assert_eq!(found.text(), "1 (> 1 - 3.0e-4, 95 %)");
        let scattered = Estimate {
            mean: 0.5,
            se: Some(0.1),
        };
        for basis in [Basis::Proven, Basis::Quadrature, Basis::Samples(1e4)] {
            let found = EstimateWithLimit::new(scattered, basis);
            assert_eq!(found.text(), "0.50 +- 0.10");
            assert_eq!(json!(found), json!({ "mean": 0.5, "se": 0.1 }));
        }
        let mean = 0.4;
        let of_few = EstimateWithLimit::new(Estimate { mean, ..scattered }, Basis::Samples(1e4));
        let marked = json!({ "mean": 0.4, "se": 0.1, "few_samples": true });
        assert_eq!(json!(of_few), marked);
    }

    #[test]
    fn limits_are_numbers_too_and_never_beyond_what_is_possible() {
        let value = |mean, basis| json!(agreed(mean, basis));
        assert_eq!(
            value(0.0, Basis::Samples(1e4)),
            json!({ "mean": 0.0, "se": 0.0, "below": 3e-4 })
        );
        assert_eq!(
            value(1.0, Basis::Samples(1e4)),
            json!({ "mean": 1.0, "se": 0.0, "above": 1.0 - 3e-4 })
        );
        assert_eq!(value(0.0, Basis::Samples(2.0))["below"], 1.0);
        assert_eq!(
            value(0.0, Basis::Proven),
            json!({ "mean": 0.0, "se": 0.0, "exact": true })
        );
        // Neither zero nor one, and without scatter
        assert_eq!(
            value(0.5, Basis::Samples(1e4)),
            json!({ "mean": 0.5, "se": 0.0 })
        );
        let unknown = Estimate {
            mean: 0.0,
            se: None,
        };
        let unknown = json!(EstimateWithLimit::new(unknown, Basis::Samples(9.0)));
        assert_eq!(unknown, json!({ "mean": 0.0, "se": null }));
    }

    /// If three events are expected, one run in twenty sees none.
    #[test]
    fn the_limit_holds_in_nineteen_of_twenty_runs() {
        let none_seen = (1.0 - zero_variance_limit(1e4)).powf(1e4);
        assert!((0.045..0.05).contains(&none_seen), "{none_seen}");
    }
}
