//! Roughness of a random surface, as theories take it.

use asperity_analysis::SlopeCovariance;

/// The roughness of the surfaces of one sigma.
#[derive(Clone, Copy)]
pub(super) struct RoughSurface<'a> {
    /// Root mean square height, length units.
    pub(super) sigma: f64,
    /// Correlation length, length units.
    pub(super) tau: f64,
    pub(super) slopes: &'a SlopeCovariance,
}
