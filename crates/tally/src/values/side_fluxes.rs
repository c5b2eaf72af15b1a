//! Side fluxes: the expectation of a model for one component on one side.

use crate::{BinFilter, Score};

/// Fluxes that a model expects of one component on one side.
#[derive(Clone, Debug, PartialEq)]
pub struct SideFluxes {
    /// All flux of the component on the side.
    pub total: f64,
    /// Flux into the bins, in the order of [`BinFilter`].
    pub bins: Vec<f64>,
    /// Flux into the rings, from +z.
    pub rings: Vec<f64>,
    /// Flux into the in-plane bins.
    pub in_plane: Vec<f64>,
}

impl SideFluxes {
    /// Rings and total of bins that hold all light of a side.
    #[must_use]
    pub fn from_bins(filter: &BinFilter, bins: Vec<f64>, in_plane: Vec<f64>) -> Self {
        let [_, n_phi] = filter.shape();
        let rings = bins.chunks_exact(n_phi).map(|ring| ring.iter().sum());
        Self {
            total: bins.iter().sum(),
            rings: rings.collect(),
            bins,
            in_plane,
        }
    }

    /// No flux in as many bins.
    #[must_use]
    pub fn zeros_like(&self) -> Self {
        Self {
            total: 0.0,
            bins: vec![0.0; self.bins.len()],
            rings: vec![0.0; self.rings.len()],
            in_plane: vec![0.0; self.in_plane.len()],
        }
    }

    /// These fluxes less those of `part`, bin by bin.
    #[must_use]
    pub fn without(&self, part: &Self) -> Self {
        let less = |all: &[f64], part: &[f64]| all.iter().zip(part).map(|(a, b)| a - b).collect();
        Self {
            total: self.total - part.total,
            bins: less(&self.bins, &part.bins),
            rings: less(&self.rings, &part.rings),
            in_plane: less(&self.in_plane, &part.in_plane),
        }
    }

    /// Fluxes by score, each in the order of its entries.
    pub(crate) fn by_score(&self) -> [(Score, &[f64]); 4] {
        [
            (Score::Flux, std::slice::from_ref(&self.total)),
            (Score::BinFlux, &self.bins),
            (Score::RingFlux, &self.rings),
            (Score::InPlaneFlux, &self.in_plane),
        ]
    }
}
