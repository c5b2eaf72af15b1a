//! Peak of the BRDF or BTDF of one direction: the brightest bin of a side.

use asperity_numerics::elementary::log10;
use asperity_tally::{BinFilter, Estimate, Side};
use serde::Serialize;

use super::outcome::Direction;
use crate::output::{in_steps, with_error};
use crate::report::disc_bins::disc_bins;

/// Standard deviations of chi-squared within which bins count as equal.
const STANDARD_DEVIATIONS: f64 = 3.0;

/// The brightest bin of a side. Of bins that are nearly equal the one with the smallest error counts: the largest value of
/// the mean less two standard errors, so that noise in small bins makes no peak.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Peak {
    /// Edges of the bin in polar angle.
    theta_deg: [f64; 2],
    /// Edges of the bin in azimuth; `None` if the bins of its ring differ by no more than noise.
    phi_deg: Option<[f64; 2]>,
    /// Mean BSDF of the bin, 1/sr.
    bsdf: Estimate,
}

impl Peak {
    /// Peak of all light that leaves on `side`; `None` if none does, or the direction was not measured.
    pub(super) fn of(direction: &Direction<'_>, side: Side) -> Option<Self> {
        let spec = &direction.spec;
        let grid = spec.grid();
        let bins = disc_bins(spec, side);
        let bins = bins.filter_map(|bin| Some((bin, direction.bsdf(bin)?)));
        let least = |bsdf: Estimate| bsdf.mean - 2.0 * bsdf.se.unwrap_or(0.0);
        let (bin, bsdf) = bins.max_by(|(_, a), (_, b)| least(*a).total_cmp(&least(*b)))?;
        let filter = BinFilter::new(grid, side);
        let number = bin % grid.bins_per_side();
        let first = bin - number % grid.n_phi();
        let ring = (first..first + grid.n_phi()).filter_map(|bin| direction.bsdf(bin));
        (bsdf.mean > 0.0).then(|| Self {
            theta_deg: filter.theta_deg(number),
            phi_deg: (!is_even(&ring.collect::<Vec<_>>())).then(|| filter.phi_deg(number)),
            bsdf,
        })
    }

    /// Mean BSDF, 1/sr.
    pub(super) const fn mean(&self) -> f64 {
        self.bsdf.mean
    }

    /// Its BSDF at the middle of its bin, as in "0.302 +- 0.031 at 29.8, 180".
    pub(super) fn text(&self) -> String {
        format!("{} at {}", with_error(self.bsdf), self.place())
    }

    /// The middle of the bin, "29.8, 180"; "2.5, any" if light is spread evenly over azimuth.
    fn place(&self) -> String {
        let middle = |[from, to]: [f64; 2]| {
            let digit = 10_f64.powi(log10(to - from).floor() as i32 - 1);
            in_steps(0.5 * (from + to), digit)
        };
        let phi = self.phi_deg.map_or_else(|| "any".to_owned(), middle);
        format!("{}, {phi}", middle(self.theta_deg))
    }
}

/// Returns `true` if these differ by no more than their errors: if their chi-squared about their mean is less than three standard deviations
/// above its expectation. Chi-squared of `f` degrees of freedom has the mean `f` and the variance `2 f`. Bins that are averaged with their
/// mirror images are equal in pairs, so that half as many vary and count twice: the mean is `f` and the variance `4 f`, whose root is
/// `2 sqrt(f)`. Three of these are taken for all bins; of bins that vary apart it is 4.2 standard deviations.
fn is_even(bins: &[Estimate]) -> bool {
    let freedom = bins.len() as f64 - 1.0;
    let mean = bins.iter().map(|bin| bin.mean).sum::<f64>() / bins.len() as f64;
    let square = |bin: &Estimate| {
        let deviation = bin.mean - mean;
        // Equal bins are even, whatever their errors, and all others are not if they have none.
        match bin.se {
            _ if deviation.abs() <= 1e-9 * mean => 0.0,
            Some(se) => (deviation / se).powi(2),
            None => f64::INFINITY,
        }
    };
    bins.iter().map(square).sum::<f64>() < freedom + STANDARD_DEVIATIONS * 2.0 * freedom.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_azimuth_is_told_where_bins_differ_by_more_than_noise() {
        let bins = |means: [f64; 4], se: Option<f64>| means.map(|mean| Estimate { mean, se });
        assert!(is_even(&bins([1.0, 1.1, 0.9, 1.05], Some(0.1))));
        assert!(!is_even(&bins([1.0, 1.1, 0.9, 3.0], Some(0.1))));
        assert!(is_even(&bins([1.0; 4], None)));
        assert!(!is_even(&bins([1.0, 1.1, 0.9, 1.05], None)));
        assert!(!is_even(&bins([0.0, 0.0, 0.0, 1.0], Some(0.0))));
        let peak = |phi_deg| Peak {
            theta_deg: [0.0, 5.0],
            phi_deg,
            bsdf: Estimate {
                mean: 1.0,
                se: None,
            },
        };
        assert_eq!(peak(None).place(), "2.5, any");
        assert_eq!(peak(Some([110.0, 120.0])).place(), "2.5, 115");
        assert_eq!(peak(Some([110.0, 111.4634])).place(), "2.5, 110.7");
    }
}
