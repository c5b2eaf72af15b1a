//! Cosine-weighted means over the hemisphere, `E_avg = 2 int E(mu) mu dmu`, of a material and roughness.
//!
//! Each cosine counts for the interval nearest to it, whose weight is `2 int mu dmu` between its ends: the midpoint rule.
//!
//! # Source
//! Kulla and Conty 2017, whose compensation for lost light takes such means.

use asperity_tally::{Estimate, Side};

use super::outcome::{AlbedoOutcome, AlbedoPoint};
use crate::report::spectrum::weighted_sum;

/// Means of one material and roughness.
pub(super) struct MeanAlbedo<'a> {
    /// A point of this material and roughness.
    pub(super) point: AlbedoPoint<'a>,
    weights: Vec<f64>,
    row: Vec<AlbedoPoint<'a>>,
}

impl<'a> MeanAlbedo<'a> {
    /// The means of each material and roughness, table by table.
    pub(super) fn all(outcome: &'a AlbedoOutcome<'_>) -> impl Iterator<Item = Self> {
        let weights = hemisphere_weights(&outcome.axes.cosines);
        let of = move |material| {
            let weights = weights.clone();
            (0..outcome.axes.alphas.len()).map(move |alpha| Self {
                point: outcome.point(material, alpha, 0),
                weights: weights.clone(),
                row: outcome.row(material, alpha).collect(),
            })
        };
        (0..outcome.materials()).flat_map(of)
    }

    /// Mean albedo of all orders on `side`; `None` where the run ended before. Standard errors add, since cosines share their surfaces.
    pub(super) fn flux(&self, side: Side) -> Option<Estimate> {
        let fluxes = self.row.iter().map(|point| point.flux(side));
        let fluxes = fluxes.collect::<Option<Vec<_>>>()?;
        Some(weighted_sum(self.weights.iter().copied().zip(fluxes)))
    }

    /// Mean albedo of single scattering on `side`.
    pub(super) fn single(&self, side: Side) -> f64 {
        let parts = self.row.iter().zip(&self.weights);
        parts
            .map(|(point, weight)| weight * point.single(side))
            .sum()
    }
}

/// Weights of cosines, in any order, in a mean over `mu^2`, with edges in the middle between neighbours.
fn hemisphere_weights(cosines: &[f64]) -> Vec<f64> {
    let mut sorted = cosines.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middles = sorted.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let edges: Vec<f64> = [0.0].into_iter().chain(middles).chain([1.0]).collect();
    let weight = |cos: &f64| {
        let place = sorted.partition_point(|other| other < cos);
        edges[place + 1].powi(2) - edges[place].powi(2)
    };
    cosines.iter().map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of `mu` over `mu^2`: 2/3. Within an interval of width h about m, `int mu^2 dmu - m int mu dmu = h^3 / 12`, so the rule is low
    /// by `2 n h^3 / 12 = 1 / (6 n^2)`.
    #[test]
    fn the_midpoint_rule_has_the_error_of_its_order() {
        for n in [4_usize, 16, 32] {
            // In any order
            let cosines = (0..n).rev().map(|i| (i as f64 + 0.5) / n as f64);
            let cosines: Vec<f64> = cosines.collect();
            let weights = hemisphere_weights(&cosines);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            let mean: f64 = weights.iter().zip(&cosines).map(|(w, mu)| w * mu).sum();
            let expected = 2.0 / 3.0 - 1.0 / (6.0 * (n * n) as f64);
            assert!((mean - expected).abs() < 1e-14, "{mean} {expected}");
        }
    }
}
