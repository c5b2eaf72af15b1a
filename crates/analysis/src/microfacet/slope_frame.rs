//! Slope frame: splits Gaussian slopes into the slope along an azimuth and the slope across it.
//!
//! The slope along is Gaussian. The slope across, given the slope along, is Gaussian about a line.

use glam::{DVec2, DVec3};

use crate::microfacet::slopes::SlopeCovariance;

/// Slopes along an azimuth and across it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlopeFrame {
    /// Unit vector of the azimuth.
    pub(crate) along: DVec2,
    /// Unit vector to the left of it.
    pub(crate) across: DVec2,
    /// Variance of the slope along.
    pub(crate) variance: f64,
    /// Standard deviation of the slope along.
    pub(crate) deviation: f64,
    /// Mean of the slope across, per unit slope along.
    pub(crate) regression: f64,
    /// One over the variance of the slope across about that mean.
    pub(crate) inverse_variance_across: f64,
}

impl SlopeFrame {
    /// The frame whose first axis is the unit vector `along`.
    #[inline(always)]
    pub(crate) fn new(slopes: &SlopeCovariance, along: DVec2) -> Self {
        let across = along.perp();
        let variance = slopes.variance_along(along);
        Self {
            along,
            across,
            variance,
            deviation: variance.sqrt(),
            regression: across.dot(slopes.times(along)) / variance,
            inverse_variance_across: slopes.inverse_form(across, across),
        }
    }

    /// The frame along the azimuth of `w`; that of x for a vertical direction.
    #[inline(always)]
    pub(crate) fn of_direction(slopes: &SlopeCovariance, w: DVec3) -> Self {
        let length = (w.x * w.x + w.y * w.y).sqrt();
        // Selected, not branched to, so that loops over many directions take vector instructions.
        let is_vertical = length < 1e-150;
        let x = if is_vertical { 1.0 } else { w.x / length };
        let y = if is_vertical { 0.0 } else { w.y / length };
        Self::new(slopes, DVec2::new(x, y))
    }

    /// Unit normal of the facet with the given slope along, and slope across about its mean, both in
    /// standard deviations.
    #[inline(always)]
    pub(crate) fn normal(&self, along: f64, across: f64) -> DVec3 {
        let p = self.deviation * along;
        let q = self.regression * p + self.inverse_variance_across.sqrt().recip() * across;
        (-p * self.along - q * self.across).extend(1.0).normalize()
    }
}
