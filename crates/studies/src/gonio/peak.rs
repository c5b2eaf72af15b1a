//! Peak of the BRDF or BTDF of one direction: the brightest bin of a side.

use asperity_simulate::short;
use asperity_tally::{BinFilter, Estimate, Side};
use serde::Serialize;

use super::outcome::Direction;
use crate::report::disc_bins::disc_bins;

/// The brightest bin of a side. Of bins that are nearly equal the one with the smallest error counts: the largest value of
/// the mean less two standard errors, so that noise in small bins makes no peak.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Peak {
    /// Edges of the bin in polar angle.
    theta_deg: [f64; 2],
    /// Edges of the bin in azimuth.
    phi_deg: [f64; 2],
    /// Mean BSDF of the bin, 1/sr.
    pub(super) bsdf: Estimate,
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
        (bsdf.mean > 0.0).then(|| Self {
            theta_deg: filter.theta_deg(number),
            phi_deg: filter.phi_deg(number),
            bsdf,
        })
    }

    /// The middle of the bin, "29.8, 180".
    pub(super) fn place(&self) -> String {
        let middle = |[from, to]: [f64; 2]| short(0.5 * (from + to));
        format!("{}, {}", middle(self.theta_deg), middle(self.phi_deg))
    }
}
