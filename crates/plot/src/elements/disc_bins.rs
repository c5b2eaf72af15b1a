//! Bins of a disc: the edges of its rings and sectors.

use crate::PlotError;
use crate::error::Valid;

/// Edges of the bins of a hemisphere.
///
/// # Examples
/// ```
/// use asperity_plot::DiscBins;
///
/// let bins = DiscBins::equal([2, 4]);
/// assert_eq!(bins.rings_deg, [0.0, 45.0, 90.0]);
/// assert_eq!(bins.len(), 8);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DiscBins {
    /// Edges of the rings, degrees from the normal of the side on which the light leaves, ascending from 0 to 90.
    pub rings_deg: Vec<f64>,
    /// Edges of the sectors of azimuth, degrees, ascending over one turn.
    pub sectors_deg: Vec<f64>,
}

impl DiscBins {
    /// Rings and sectors of equal angles, azimuth from 0.
    #[must_use]
    pub fn equal([rings, sectors]: [usize; 2]) -> Self {
        let edges = |n: usize, all: f64| {
            (0..=n)
                .map(|i| all * i as f64 / n as f64)
                .collect::<Vec<_>>()
        };
        Self {
            rings_deg: edges(rings, 90.0),
            sectors_deg: edges(sectors, 360.0),
        }
    }

    /// Number of rings.
    #[must_use]
    pub const fn rings(&self) -> usize {
        self.rings_deg.len().saturating_sub(1)
    }

    /// Number of sectors.
    #[must_use]
    pub const fn sectors(&self) -> usize {
        self.sectors_deg.len().saturating_sub(1)
    }

    /// Number of bins.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.rings() * self.sectors()
    }

    /// Returns `true` if there are no bins.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Refuses edges without meaning.
    pub(crate) fn check(&self) -> Result<(), PlotError> {
        if self.is_empty() {
            return Err(PlotError::nothing_to_draw("hemispheres without bins"));
        }
        let edges = self.rings_deg.iter().chain(&self.sectors_deg);
        Valid::Finite.check_all("edge of a bin", edges.copied())
    }

    /// The bin that holds a direction, `theta` and `phi` in radians from the normal and from azimuth 0.
    pub(crate) fn bin_of(&self, theta: f64, phi: f64) -> usize {
        let first = self.sectors_deg[0];
        let phi = first + (phi.to_degrees() - first).rem_euclid(360.0);
        let place = |edges: &[f64], angle: f64| {
            let after = edges.partition_point(|edge| *edge <= angle);
            after.clamp(1, edges.len() - 1) - 1
        };
        place(&self.rings_deg, theta.to_degrees()) * self.sectors() + place(&self.sectors_deg, phi)
    }

    /// Solid angle of a bin, steradians.
    pub(crate) fn solid_angle(&self, bin: usize) -> f64 {
        let (ring, sector) = (bin / self.sectors(), bin % self.sectors());
        let cos = |i: usize| self.rings_deg[i].to_radians().cos();
        let width = self.sectors_deg[sector + 1] - self.sectors_deg[sector];
        (cos(ring) - cos(ring + 1)) * width.to_radians()
    }
}
